//! Pictures of a run, drawn from its tables and the exact solution.

mod plane;

pub use plane::{draw_along, draw_fields};

use std::path::Path;

use crate::accuracy::reference::{ImpactReference, ReferenceSolution};
use crate::driver::output::histories::HistoryTable;
use crate::exact::wave_interactions::{centre_left, centre_right, hugoniot_left, hugoniot_right};
use crate::exact::{self, Chain, ExactError, History, Impact, PathKind, Plate};
use crate::plot::{self, Color, PictureError, Points, Stroke};
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// Pressure over all particles at one time, for the x-t diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureRow {
    /// Time [s].
    pub time: f64,
    /// Position [m] and pressure [Pa], sorted by position.
    pub points: Vec<(f64, f64)>,
}

/// Draws figures 1 to 3 of Burghardt (2010) into `folder`: the Hugoniots with the states of the
/// chain.
///
/// # Errors
///
/// If a picture cannot be drawn or written.
pub fn draw_hugoniots(
    scene: &CheckedScene,
    bodies: [usize; 2],
    impact: &Impact,
    chain: &Chain,
    folder: &Path,
) -> Result<Vec<String>, PictureError> {
    let [flyer_name, target_name] = bodies.map(|b| scene.scene.bodies[b].material.clone());
    let (flyer, target) = (impact.flyer.material, impact.target.material);
    let state = |n: usize| chain.states.iter().find(|s| s.number == n);
    let flyer_color = Color::of_material(&flyer_name, 0);
    let target_color = match target_name == flyer_name {
        true => Color::GRAY,
        false => Color::of_material(&target_name, 1),
    };
    let curve = |name: &str, color, from: f64, to: f64, p: &dyn Fn(f64) -> f64| {
        let u: Vec<f64> = (0..=200).map(|k| from + (to - from) * k as f64 / 200.0).collect();
        let p: Vec<f64> = u.iter().map(|&u| p(u)).collect();
        plot::HugoniotCurve { name: name.into(), color, points: Points::new(u, p) }
    };
    let mark = |n: usize| {
        state(n).map(|s| plot::HugoniotPoint { label: n.to_string(), velocity: s.u, pressure: s.p })
    };
    let top = impact.speed;
    let mut figures = vec![(
        "figure_1_hugoniots",
        plot::HugoniotFigure {
            title: format!("Figure 1. Initial impact: {flyer_name} on {target_name}"),
            curves: vec![
                curve(&flyer_name, flyer_color, 0.0, top, &|u| hugoniot_left(&flyer, top, u)),
                curve(&target_name, target_color, 0.0, top, &|u| hugoniot_right(&target, 0.0, u)),
            ],
            states: [0, 1, 2].into_iter().filter_map(mark).collect(),
        },
    )];
    if let (Some(two), Some(three)) = (state(2), state(3)) {
        let centre = centre_right(&flyer, two.p, two.u);
        let (from, to) = (three.u.min(0.0), two.u + 0.3 * (two.u - three.u));
        figures.push((
            "figure_2_free_surface",
            plot::HugoniotFigure {
                title: format!("Figure 2. Release at the free surface of the {flyer_name} flyer"),
                curves: vec![curve(&flyer_name, flyer_color, from, to, &|u| {
                    hugoniot_right(&flyer, centre, u)
                })],
                states: [2, 3].into_iter().filter_map(mark).collect(),
            },
        ));
        if let Some(four) = state(4) {
            let centre = centre_left(&flyer, three.p, three.u);
            let to = three.u.max(two.u);
            figures.push((
                "figure_3_second_interface",
                plot::HugoniotFigure {
                    title: "Figure 3. Second interaction at the interface".into(),
                    curves: vec![
                        curve(&flyer_name, flyer_color, four.u.min(0.0), centre, &|u| {
                            hugoniot_left(&flyer, centre, u)
                        }),
                        curve(&target_name, target_color, 0.0, to, &|u| {
                            hugoniot_right(&target, 0.0, u)
                        }),
                    ],
                    states: [0, 2, 3, 4].into_iter().filter_map(mark).collect(),
                },
            ));
        }
    }
    let mut names = Vec::new();
    for (name, figure) in figures {
        plot::draw(&figure.figure(), &folder.join(name))?;
        names.push(name.to_string());
    }
    Ok(names)
}

/// Draws figure 4 for profile time number `k`; `stem` is the file name without its extension.
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
    notes: Vec<String>,
    stem: &Path,
) -> Result<(), PictureError> {
    let column = |name| table.column(name).expect("the table has its own columns");
    let scored = match reference {
        Some(ReferenceSolution::Impact(all)) => Some(all.target),
        _ => None,
    };
    let rows: Vec<usize> =
        (0..table.len()).filter(|&r| scored.is_none_or(|b| table.body[r] as usize == b)).collect();
    let pick = |values: &[f64]| rows.iter().map(|&r| values[r]).collect::<Vec<f64>>();
    let line = |profile: crate::exact::Profile| {
        let points = profile.points;
        Points::new(
            points.iter().map(|p| p.x).collect::<Vec<f64>>(),
            points.iter().map(|p| p.p).collect::<Vec<f64>>(),
        )
    };
    let time = scene.profile_times[k];
    let (mut approximation, mut close_up) = (None, None);
    if let Some(ReferenceSolution::Impact(all)) = reference {
        approximation = all.impact.chain_profile(&all.chain, time).map(line);
        close_up = all.solution.snapshots[k].landmarks.as_ref().and_then(|marks| {
            let shock = marks.shock?;
            let h = scene.cell_size[0];
            let (behind, ahead) =
                (shock - 15.0 * h * marks.direction, shock + 10.0 * h * marks.direction);
            Some((behind.min(ahead), behind.max(ahead)))
        });
    }
    let figure = plot::ProfileFigure {
        title: scene.scene.title.clone(),
        time,
        approximation,
        exact: reference.and_then(|r| r.profile(scene, k)).map(line),
        computed: Points::new(pick(column("x")), pick(column("pressure"))),
        notes,
        close_up,
    };
    plot::draw(&figure.figure(), stem)?;
    Ok(())
}

/// The part of a line of the x-t diagram up to the time `end` [s]; the last segment is cut at
/// `end`.
fn until(points: &[[f64; 2]], end: f64) -> Vec<[f64; 2]> {
    let inside = points.partition_point(|q| q[0] <= end);
    let mut part = points[..inside].to_vec();
    if let (Some(&[t, x]), Some(&[later, x_later])) = (part.last(), points.get(inside)) {
        part.push([end, x + (x_later - x) * (end - t) / (later - t)]);
    }
    part
}

/// Draws the x-t diagram: computed pressure under the exact wave paths, up to the last row or to
/// `end` [s], if that is later. If the exact lines end earlier, a note in the picture says so.
///
/// # Errors
///
/// [`PictureError`] if a file cannot be written.
pub fn draw_waves(
    title: &str,
    rows: &[PressureRow],
    end: Option<f64>,
    reference: Option<&ReferenceSolution>,
    stem: &Path,
) -> Result<(), PictureError> {
    let end = rows.iter().map(|r| r.time).fold(end.unwrap_or(0.0), f64::max);
    let (mut paths, mut notes) = (Vec::new(), Vec::new());
    if let Some(ReferenceSolution::Impact(all)) = reference {
        for path in &all.solution.paths {
            let (name, stroke) = path_style(path.kind);
            let points = until(&path.points, end);
            paths.push(plot::WavePath {
                name: name.into(),
                points: Points::new(
                    points.iter().map(|q| q[1]).collect::<Vec<f64>>(),
                    points.iter().map(|q| q[0]).collect::<Vec<f64>>(),
                ),
                stroke,
            });
        }
        if let Some((stopped, why)) = &all.solution.stopped
            && *stopped < end
        {
            notes.push(format!("exact lines end at {:.4} µs:", stopped * 1e6));
            let why = match why {
                ExactError::RearNotFree => "the target's rear is not free",
                ExactError::TooManyWaves { .. } => "too many waves",
                _ => "more tension than the equation of state has",
            };
            notes.push(why.into());
        }
        let inside = |p: &exact::Path| p.steepened && p.points.last().is_some_and(|q| q[0] < end);
        if all.solution.paths.iter().any(inside) {
            notes.push("a fan's line ends where the fan steepens".into());
        }
    }
    let rows = rows
        .iter()
        .map(|row| plot::DiagramRow {
            time: row.time,
            x: row.points.iter().map(|p| p.0).collect(),
            pressure: row.points.iter().map(|p| p.1).collect(),
        })
        .collect();
    let diagram = plot::WaveDiagram { title: title.into(), rows, paths, end: Some(end), notes };
    plot::draw(&diagram.figure(), stem)?;
    Ok(())
}

fn path_style(kind: PathKind) -> (&'static str, Stroke) {
    match kind {
        PathKind::Shock => ("shock", Stroke::Solid),
        PathKind::FanHead => ("head of a fan", Stroke::Dashed),
        PathKind::FanTail => ("tail of a fan", Stroke::Dotted),
        PathKind::Interface => ("interface", Stroke::Solid),
        PathKind::FreeSurface => ("free surface", Stroke::Solid),
    }
}

/// Draws velocity and pressure of the probes, with the exact histories.
///
/// # Errors
///
/// If a picture cannot be drawn or written.
pub fn draw_histories(
    scene: &CheckedScene,
    histories: &HistoryTable,
    reference: Option<&ReferenceSolution>,
    stem: &Path,
) -> Result<(), PictureError> {
    let Some(time) = histories.column("time") else { return Ok(()) };
    let impact = match reference {
        Some(ReferenceSolution::Impact(all)) => Some(all),
        _ => None,
    };
    let names: Vec<&str> =
        histories.columns().iter().filter_map(|c| c.name.strip_suffix("_velocity")).collect();
    let panel = |suffix: &str, label: &str, unit: &str| plot::HistoryPanel {
        label: label.into(),
        unit: unit.into(),
        series: names
            .iter()
            .filter_map(|name| {
                let values = histories.column(&format!("{name}_{suffix}"))?;
                let exact = impact.and_then(|all| exact_history(scene, all, name)).map(|history| {
                    let value = |p: &crate::exact::HistoryPoint| match suffix {
                        "velocity" => p.u,
                        _ => p.p,
                    };
                    Points::new(
                        history.points.iter().map(|p| p.t).collect::<Vec<f64>>(),
                        history.points.iter().map(value).collect::<Vec<f64>>(),
                    )
                });
                Some(plot::HistoryCurve {
                    name: name.replace('_', " "),
                    computed: Points::new(time.to_vec(), values.to_vec()),
                    exact,
                })
            })
            .collect(),
    };
    let figure = plot::HistoriesFigure {
        title: format!("{}: histories", scene.scene.title),
        panels: vec![panel("velocity", "Velocity", "m/s"), panel("pressure", "Pressure", "Pa")],
    };
    plot::draw(&figure.figure(), stem)?;
    Ok(())
}

/// The exact history of the probe `name`.
fn exact_history<'a>(
    scene: &CheckedScene,
    all: &'a ImpactReference,
    name: &str,
) -> Option<&'a History> {
    match name {
        "interface" => Some(&all.solution.interface),
        "free_surface" => Some(&all.solution.target_rear),
        "flyer_rear" => Some(&all.solution.flyer_rear),
        _ => {
            let bodies = [all.flyer, all.target].map(|b| scene.scene.bodies[b].name.as_str());
            let tracers = &scene.scene.output.histories.as_ref()?.tracers;
            let mut followed = tracers.iter().filter(|t| bodies.contains(&t.body.as_str()));
            all.solution.tracers.get(followed.position(|t| t.name == name)?)
        }
    }
}

/// Name of the plate in which a wave runs.
pub fn plate_name(plate: Plate) -> &'static str {
    match plate {
        Plate::Flyer => "flyer",
        Plate::Target => "target",
    }
}
