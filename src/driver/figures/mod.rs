//! Pictures of a run, drawn from its tables and the exact solution.

mod bodies;
mod burghardt;
mod plane;
mod profile;
mod waves;

pub use plane::{draw_along, draw_fields};
pub use profile::draw_profile;
pub use waves::{draw_run_waves, draw_waves};

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::accuracy::reference::{ImpactReference, ReferenceSolution};
use crate::driver::output::histories::HistoryTable;
use crate::exact::wave_interactions::{centre_left, centre_right, hugoniot_left, hugoniot_right};
use crate::exact::{Chain, History, Impact, Plate};
use crate::plot::{self, Color, PictureError, Points};
use crate::scene::CheckedScene;

/// Particles along x at one time, for the x-t diagrams.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WaveRow {
    /// Time [s].
    pub time: f64,
    /// Positions [m], ascending.
    pub x: Vec<f64>,
    /// Pressures [Pa].
    pub pressure: Vec<f64>,
    /// Values of each further quantity in its SI unit, one per particle; empty if they are not
    /// known at this time.
    pub others: Vec<Vec<f64>>,
}

/// A quantity of an x-t diagram.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagramQuantity {
    /// Name as in the scene.
    pub name: String,
    /// SI unit.
    pub unit: String,
}

/// Draws the Hugoniots with the states of the chain into `folder`. For the impact of Burghardt (2010)
/// these are his figures 1 to 3, and titles and files have their numbers.
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
    let body_colors = bodies::colors(scene);
    let (flyer_color, target_color) = match target_name == flyer_name {
        true => (Color::of_material(&flyer_name, 0), Color::BLACK),
        false => (body_colors[bodies[0]], body_colors[bodies[1]]),
    };
    // one name per curve, also where both plates are of one material
    let plate = |material: &str, plate: Plate| match target_name == flyer_name {
        true => format!("{material}, {}", plate_name(plate)),
        false => material.to_string(),
    };
    let (flyer_label, target_label) =
        (plate(&flyer_name, Plate::Flyer), plate(&target_name, Plate::Target));
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
        "impact",
        plot::HugoniotFigure {
            title: format!("Initial impact: {flyer_name} on {target_name}"),
            curves: vec![
                curve(&flyer_label, flyer_color, 0.0, top, &|u| hugoniot_left(&flyer, top, u)),
                curve(&target_label, target_color, 0.0, top, &|u| hugoniot_right(&target, 0.0, u)),
            ],
            states: [0, 1, 2].into_iter().filter_map(mark).collect(),
        },
    )];
    if let (Some(two), Some(three)) = (state(2), state(3)) {
        let centre = centre_right(&flyer, two.p, two.u);
        let (from, to) = (three.u.min(0.0), two.u + 0.3 * (two.u - three.u));
        figures.push((
            "free_surface",
            plot::HugoniotFigure {
                title: format!("Release at the free surface of the {flyer_name} flyer"),
                curves: vec![curve(&flyer_label, flyer_color, from, to, &|u| {
                    hugoniot_right(&flyer, centre, u)
                })],
                states: [2, 3].into_iter().filter_map(mark).collect(),
            },
        ));
        if let Some(four) = state(4) {
            let centre = centre_left(&flyer, three.p, three.u);
            let to = three.u.max(two.u);
            figures.push((
                "second_interface",
                plot::HugoniotFigure {
                    title: "Second interaction at the interface".into(),
                    curves: vec![
                        curve(&flyer_label, flyer_color, four.u.min(0.0), centre, &|u| {
                            hugoniot_left(&flyer, centre, u)
                        }),
                        curve(&target_label, target_color, 0.0, to, &|u| {
                            hugoniot_right(&target, 0.0, u)
                        }),
                    ],
                    states: [0, 2, 3, 4].into_iter().filter_map(mark).collect(),
                },
            ));
        }
    }
    let mut names = Vec::new();
    let numbered = burghardt::is_burghardts(impact);
    for (k, (name, mut figure)) in figures.into_iter().enumerate() {
        let name = match numbered {
            true => format!("figure_{}_{name}", k + 1),
            false => format!("hugoniot_{name}"),
        };
        if numbered {
            figure.title = format!("Figure {}. {}", k + 1, figure.title);
        }
        plot::draw(&figure.figure(), &folder.join(&name))?;
        names.push(name);
    }
    Ok(names)
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
