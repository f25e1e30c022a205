//! Files and pictures of the recorded profiles.

use std::path::Path;

use decomp::Comm;

use crate::accuracy::reference::ReferenceSolution;
use crate::driver::RunFailure;
use crate::driver::figures;
use crate::driver::output::csv::{profile_names, write_profile};
use crate::driver::output::summary::ProfileSummary;
use crate::driver::recorder::Recorder;
use crate::plot::PictureError;
use crate::scene::CheckedScene;

/// Writes each profile and evaluates its errors.
pub(super) fn write_profiles(
    comm: &dyn Comm,
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    recorded: &Recorder<'_>,
    folder: &Path,
) -> Result<Vec<ProfileSummary>, RunFailure> {
    let times: Vec<f64> = recorded.tables.iter().map(|(table, _)| table.time).collect();
    let names = match times.iter().all(|time| scene.profile_times.contains(time)) {
        // the same names whether or not the run has ended
        true => profile_names(&scene.profile_times),
        false => profile_names(&times),
    };
    let mut profiles = Vec::new();
    for (k, ((table, digest), file)) in recorded.tables.iter().zip(names).enumerate() {
        write_profile(&folder.join(&file), table)?;
        let as_json = |e| serde_json::to_value(e).expect("errors are plain data");
        let (errors, errors_cell_averaged) = match reference {
            Some(ReferenceSolution::Plane(plane)) => {
                (plane.score(scene, table, recorded.start.as_ref()), None)
            }
            _ => match reference.and_then(|r| r.score(scene, k, table)) {
                Some((raw, cell)) => (Some(as_json(raw)), Some(as_json(cell))),
                None => (None, None),
            },
        };
        profiles.push(ProfileSummary {
            time: table.time,
            file,
            state_sha256: digest.clone(),
            errors,
            errors_cell_averaged,
        });
        comm.heartbeat();
    }
    Ok(profiles)
}

/// Draws all pictures of a run.
pub(super) fn draw(
    comm: &dyn Comm,
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    recorded: &Recorder<'_>,
    profiles: &[ProfileSummary],
    folder: &Path,
) -> Result<(), PictureError> {
    if let (1, Some(ReferenceSolution::Impact(all))) = (scene.dimension, reference) {
        let bodies = [all.flyer, all.target];
        figures::draw_hugoniots(scene, bodies, &all.impact, &all.chain, folder)?;
    }
    for (k, ((table, _), profile)) in recorded.tables.iter().zip(profiles).enumerate() {
        let mut notes = Vec::new();
        if let Some(l1) = profile.error("l1") {
            notes.push(format!("L1 {:.2} % of the true solution", 100.0 * l1));
        }
        if let Some(plateau) = profile.error("plateau") {
            notes.push(format!("plateau {:+.3} %", 100.0 * plateau));
        }
        let stem = Path::new(&profile.file).with_extension("");
        if scene.dimension > 1 {
            let name = stem.to_string_lossy();
            figures::draw_fields(scene, table, &notes, &name, folder)?;
            if let Some(reference) = reference {
                let along = folder.join(name.replace("profile", "along"));
                figures::draw_along(scene, reference, k, table, notes, &along)?;
            }
            comm.heartbeat();
            continue;
        }
        let stem = stem.to_string_lossy();
        let place = (folder, stem.trim_start_matches("profile_"));
        figures::draw_profile(scene, reference, k, table, notes, place)?;
        comm.heartbeat();
    }
    if scene.dimension > 1 {
        return Ok(());
    }
    let stem = folder.join("x_t_diagram");
    let (rows, bodies) = (&recorded.waves, &recorded.bodies);
    figures::draw_run_waves(scene, rows, bodies, &recorded.quantities, reference, &stem)?;
    comm.heartbeat();
    if let Some(histories) = recorded.histories() {
        figures::draw_histories(scene, histories, reference, &folder.join("histories"))?;
    }
    Ok(())
}
