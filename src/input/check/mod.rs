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
use crate::scene::{CheckedBody, CheckedScene, Scene};
pub(super) use common::check_printable;

pub(super) use memory::{BYTES_PER_BORDER_TILE, border_tiles};
pub use memory::{BYTES_PER_CELL, BYTES_PER_PARTICLE, BYTES_PER_PATCH, available_memory};

/// Parts of a scene that its exact solution depends on.
const OF_REFERENCE: [&str; 6] =
    ["reference", "bodies", "materials", "boundary", "contact", "body_force"];

/// Checks `scene`, read from `file`; `faults` are those of its keys. A check is left out if a part of
/// the scene that it reads has a fault.
pub(super) fn check(scene: Scene, file: &str, mut faults: Faults) -> Result<CheckedScene, Faults> {
    let Some(mut checked) = build(scene, file, &mut faults) else { return Err(faults) };
    check_whole(&mut checked, &mut faults);
    faults.judge(&OF_REFERENCE, || reference::check(&mut checked));
    faults.judge(&["error_estimate", "reference", "bodies"], || estimate::check(&checked));
    faults.judge(&["impact_smoothing", "bodies"], || impact::check_smoothing(&checked));
    if checked.dimension == 1 {
        let reads = ["bodies", "materials", "boundary", "contact", "time.end"];
        faults.judge(&reads, || impact::check(&mut checked));
    }
    faults.ok_or_faults(())?;
    checked.warnings.extend(plausibility::warnings(&checked));
    for warning in &mut checked.warnings {
        *warning = one_line(warning);
    }
    Ok(checked)
}

/// Checks the parts of a scene, each by itself. The result has the bodies without a fault; `None` if
/// its domain is not known.
fn build(mut scene: Scene, file: &str, faults: &mut Faults) -> Option<CheckedScene> {
    let mut warnings = Vec::new();
    faults.judge(&["title"], || check_printable("title", &scene.title));
    let profile_times = faults
        .judge(&["output.profiles", "time.end"], || output::profile_times(&scene))
        .unwrap_or_default();
    faults.judge(&["output.checkpoint", "time.end"], || output::check_checkpoints(&scene));
    let corners = ["domain.lower", "domain.upper", "domain.geometry"];
    // the other parts have the dimension of the domain
    let dimension = faults.judge(&corners, || domain::check_corners(&scene.domain))?;
    let grid = domain::Grid::of_whole_domain(&scene.domain);
    let cells = faults.judge(&["domain.cell_size"], || domain::check(&scene.domain, dimension));
    let grid = cells.unwrap_or(grid);
    faults.judge(&["domain"], || domain::check_patches(&scene.domain, &grid.cells));
    method::check(&scene, faults, &mut warnings);
    boundary::check(&scene, faults);
    effects::check(&scene, faults);
    materials::check(&scene, faults, &mut warnings);
    let mut bodies = bodies::check(&scene, &grid.cell_size, faults);
    let mut known = bodies.iter().map(Option::is_some);
    scene.bodies.retain(|_| known.next() == Some(true));
    let bodies: Vec<CheckedBody> = bodies.drain(..).flatten().collect();
    faults.extend(bodies::check_overlap(&scene, &bodies, &grid.cell_size));
    bodies::warn_of_materials(&scene, &mut warnings);
    Some(CheckedScene {
        dimension,
        cell_size: grid.cell_size,
        cells: grid.cells,
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
fn check_whole(checked: &mut CheckedScene, faults: &mut Faults) {
    // particles are only made of a scene without a fault in its keys
    if faults.keys_are_valid() && !faults.concern("domain.cell_size") && !faults.concern("bodies") {
        faults.take(memory::check_counts(checked));
        faults.judge(&["method"], || method::check_positions(checked));
    }
    faults.judge(&["method", "bodies", "materials"], || method::check_bodies(checked));
    faults.judge(&["method", "bodies", "boundary", "contact"], || frame::check(checked));
    let sides = ["boundary", "bodies", "method"];
    faults.judge(&sides, || boundary::check_transmitting(checked));
    faults.judge(&sides, || boundary::check_loads(checked));
    let reads = ["time.courant", "method", "boundary", "monitor.on_courant_exceeded"];
    faults.judge(&reads, || courant::check(checked));
    let reads = ["body_force", "boundary", "bodies", "materials"];
    faults.judge(&reads, || motion::check_body_force(checked));
    faults.judge(&["output.histories", "bodies"], || output::check_tracers(checked));
    // quantities are those of the effects that act
    if OF_REFERENCE.iter().all(|path| !faults.concern(path)) {
        faults.judge(&["output.fields", "time.end"], || output::check_fields(checked));
        faults.judge(&["output.diagrams"], || output::check_diagrams(checked));
        faults.judge(&["error_estimate"], || estimate::check_fields(checked));
    }
    for key in crate::effects::keys() {
        let reads = [key.name, "bodies", "materials", "method", "contact"];
        faults.judge(&reads, || {
            (key.check)(checked).map_err(|e| SceneFault::of_parameter(e, key.name))
        });
    }
}
