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
mod tension;

use super::errors::{SceneFault, one_line};
use super::faults::Faults;
use crate::scene::{CheckedScene, Scene};
use common::check_printable;

pub(super) use memory::tiles;
pub use memory::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};

/// Checks `scene`, read from `file`. As far as possible, checks of one group do not depend on each
/// other; a group is only judged if the one before has no fault.
pub(super) fn check(scene: Scene, file: &str) -> Result<CheckedScene, Faults> {
    let mut checked = build(scene, file)?;
    check_whole(&mut checked)?;
    reference::check(&mut checked)?;
    estimate::check(&checked)?;
    impact::check_smoothing(&checked)?;
    if checked.dimension == 1 {
        impact::check(&mut checked)?;
    }
    checked.warnings.extend(plausibility::warnings(&checked));
    for warning in &mut checked.warnings {
        *warning = one_line(warning);
    }
    Ok(checked)
}

/// Checks the parts of a scene, each by itself.
fn build(scene: Scene, file: &str) -> Result<CheckedScene, Faults> {
    let mut warnings = Vec::new();
    let mut faults = Faults::default();
    faults.take(check_printable("title", &scene.title));
    let grid = faults.take(domain::check(&scene.domain));
    // the other parts have the dimension of the domain
    let Some(domain::Grid { dimension, cell_size, cells }) = grid else {
        return Err(faults);
    };
    faults.take(method::check(&scene, &mut warnings));
    faults.take(boundary::check(&scene));
    faults.extend(effects::check(&scene));
    let profile_times = faults.take(output::profile_times(&scene));
    let bodies = faults.take(bodies::check(&scene, &cell_size, &mut warnings));
    let (Some(bodies), Some(profile_times)) = (bodies, profile_times) else {
        return Err(faults);
    };
    faults.ok_or_faults(CheckedScene {
        dimension,
        cell_size,
        cells,
        particles: bodies.iter().fold(0, |sum, body| sum.saturating_add(body.particles)),
        bodies,
        profile_times,
        history_interval: output::history_interval(&scene),
        warnings,
        file: file.to_string(),
        scene,
        method_choice: None,
    })
}

/// Checks the parts of a scene against each other.
fn check_whole(checked: &mut CheckedScene) -> Result<(), Faults> {
    memory::check_counts(checked)?;
    let mut faults = Faults::default();
    faults.take(method::check_bodies(checked));
    faults.take(method::check_positions(checked));
    faults.take(frame::check(checked));
    faults.take(boundary::check_transmitting(checked));
    faults.take(boundary::check_loads(checked));
    faults.take(courant::check(checked));
    faults.take(motion::check_body_force(checked));
    faults.take(output::check_tracers(checked));
    faults.take(output::check_checkpoints(&checked.scene));
    faults.take(output::check_fields(checked));
    faults.take(output::check_diagrams(checked));
    for key in crate::effects::keys() {
        let fault = (key.check)(checked).map_err(|e| SceneFault::of_parameter(e, key.name));
        faults.take(fault);
    }
    faults.ok_or_faults(())
}
