//! Checks of the relations between keys, all done before anything is built.
//!
//! The bounds of single numbers are part of the model and are checked on reading.

mod bodies;
mod boundary;
mod common;
mod courant;
mod domain;
mod effects;
mod estimate;
mod frame;
mod front;
mod impact;
mod materials;
mod memory;
mod method;
mod motion;
mod output;
mod plane_reference;
mod plausibility;
mod reference;

use super::errors::{SceneFault, one_line};
use crate::scene::{CheckedScene, Scene};
use common::check_printable;

pub(super) use memory::tiles;
pub use memory::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};

/// Checks `scene`, read from `file`.
pub(super) fn check(scene: Scene, file: &str) -> Result<CheckedScene, SceneFault> {
    let mut warnings = Vec::new();
    check_printable("title", &scene.title)?;
    let domain::Grid { dimension, cell_size, cells } = domain::check(&scene.domain)?;
    method::check(&scene, &mut warnings)?;
    boundary::check(&scene)?;
    effects::check(&scene)?;
    let bodies = bodies::check(&scene, &cell_size, &mut warnings)?;
    let mut checked = CheckedScene {
        dimension,
        cell_size,
        cells,
        particles: bodies.iter().fold(0, |sum, body| sum.saturating_add(body.particles)),
        bodies,
        profile_times: output::profile_times(&scene)?,
        history_interval: output::history_interval(&scene),
        warnings,
        file: file.to_string(),
        scene,
        method_choice: None,
    };
    memory::check_counts(&checked)?;
    method::check_bodies(&checked)?;
    method::check_positions(&checked)?;
    frame::check(&checked)?;
    boundary::check_transmitting(&mut checked)?;
    boundary::check_loads(&mut checked)?;
    courant::check(&mut checked)?;
    motion::check_body_force(&checked)?;
    output::check_tracers(&checked)?;
    output::check_checkpoints(&checked.scene)?;
    for key in crate::effects::keys() {
        (key.check)(&checked).map_err(|e| SceneFault::of_parameter(e, key.name))?;
    }
    reference::check(&mut checked)?;
    estimate::check(&checked)?;
    if dimension == 1 {
        impact::check(&mut checked)?;
    }
    checked.warnings.extend(plausibility::warnings(&checked));
    for warning in &mut checked.warnings {
        *warning = one_line(warning);
    }
    Ok(checked)
}
