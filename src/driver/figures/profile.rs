//! Pressure over the bodies of a scene on a line at one time.

use std::path::Path;

use super::{bodies, burghardt};
use crate::accuracy::reference::ReferenceSolution;
use crate::exact::Profile;
use crate::plot::{self, Color, PictureError, Points, ProfileFigure, ProfilePart};
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Draws the pressure at profile time number `k` into `folder`. `time` is the time in file names, such
/// as `0.500us`. For the impact of Burghardt (2010) this is his figure 4, with the target alone; for
/// all other scenes it shows all bodies.
///
/// # Errors
///
/// If a picture cannot be drawn or written.
///
/// # Panics
///
/// If the table lacks a column that the figure shows.
pub fn draw_profile(
    scene: &CheckedScene,
    reference: Option<&ReferenceSolution>,
    k: usize,
    table: &ParticleTable,
    mut notes: Vec<String>,
    (folder, time): (&Path, &str),
) -> Result<(), PictureError> {
    let impact = match reference {
        Some(ReferenceSolution::Impact(all)) => Some(all),
        _ => None,
    };
    let paper = impact.filter(|all| burghardt::is_burghardts(&all.impact));
    let exact = match (paper, impact) {
        (None, Some(all)) => all.solution.snapshots[k].whole.clone(),
        _ => reference.and_then(|r| r.profile(scene, k)),
    };
    if let (None, Some(all)) = (&exact, impact)
        && let Some((stopped, _)) = &all.solution.stopped
    {
        notes.push(format!("exact solution known until {:.4} µs", stopped * 1e6));
    }
    notes.extend(bodies::removed(scene, table));
    let ends = bodies::ends_of(scene, table);
    let failed: Vec<usize> = bodies::failed(table).collect();
    let figure = ProfileFigure {
        title: scene.scene.title.clone(),
        time: scene.profile_times[k],
        approximation: impact
            .and_then(|all| all.impact.chain_profile(&all.chain, scene.profile_times[k]).map(line)),
        exact: exact.map(line),
        computed: match paper {
            Some(all) => {
                let rows = (0..table.len()).filter(|&r| table.body[r] as usize == all.target);
                vec![part("MPM", Color::GREEN, points(table, rows))]
            }
            None => parts(scene, table),
        },
        failed: points(table, failed.into_iter()),
        bands: if paper.is_some() { Vec::new() } else { bodies::bands(scene, &ends) },
        interfaces: if paper.is_some() { Vec::new() } else { bodies::interfaces(scene, &ends) },
        notes,
        close_up: impact.and_then(|all| around_the_shock(scene, all, k)),
    };
    let name = if paper.is_some() { "figure_4" } else { "pressure" };
    plot::draw(&figure.figure(), &folder.join(format!("{name}_{time}")))?;
    Ok(())
}

fn part(name: &str, color: Color, points: Points) -> ProfilePart {
    ProfilePart { name: name.into(), color, points }
}

/// The computed points of each material, named by the material.
fn parts(scene: &CheckedScene, table: &ParticleTable) -> Vec<ProfilePart> {
    let colors = bodies::colors(scene);
    let bodies = &scene.scene.bodies;
    let mut parts: Vec<ProfilePart> = Vec::new();
    for (body, color) in bodies.iter().zip(colors) {
        if parts.iter().any(|part| part.name == body.material) {
            continue;
        }
        let is_of = |r: &usize| bodies[table.body[*r] as usize].material == body.material;
        parts.push(part(&body.material, color, points(table, (0..table.len()).filter(is_of))));
    }
    parts
}

fn points(table: &ParticleTable, rows: impl Iterator<Item = usize> + Clone) -> Points {
    let pick = |name: &str| {
        let column = table.column(name).expect("the table has its own columns");
        rows.clone().map(|r| column[r]).collect::<Vec<f64>>()
    };
    Points::new(pick("x"), pick("pressure"))
}

fn line(profile: Profile) -> Points {
    let points = profile.points;
    Points::new(
        points.iter().map(|p| p.x).collect::<Vec<f64>>(),
        points.iter().map(|p| p.p).collect::<Vec<f64>>(),
    )
}

/// The part of the x axis around the shock front in the target [m].
fn around_the_shock(
    scene: &CheckedScene,
    all: &crate::accuracy::reference::ImpactReference,
    k: usize,
) -> Option<(f64, f64)> {
    let marks = all.solution.snapshots[k].landmarks.as_ref()?;
    let (shock, h) = (marks.shock?, scene.cell_size[0]);
    let (behind, ahead) = (shock - 15.0 * h * marks.direction, shock + 10.0 * h * marks.direction);
    Some((behind.min(ahead), behind.max(ahead)))
}
