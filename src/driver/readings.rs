//! Readings of the gauges and probes of a run, from its histories.

use super::output::gauges::{GaugeReading, SurfaceMaterial, plane_readings, point_readings};
use super::probes::{GaugeKind, Probes, SurfacePart};
use crate::accuracy::estimate::GaugeRecords;
use crate::accuracy::estimate::gauge_records::{GaugeHistory, Reading, ReadingKind};
use crate::scene::CheckedScene;
use crate::simulation::Simulation;

/// The readings of the report: those of the gauges that the scene names, and in the long report of all
/// probes.
pub(super) fn report_readings(
    scene: &CheckedScene,
    all: &[GaugeReading],
    verbose: bool,
) -> Vec<GaugeReading> {
    let Some(histories) = &scene.scene.output.histories else { return Vec::new() };
    let stations = histories.stations.iter().map(|gauge| &gauge.name);
    let planes = histories.planes.iter().map(|gauge| &gauge.name);
    let named = histories.velocimeters.iter().map(|gauge| &gauge.name);
    let named: Vec<&String> = named.chain(stations).chain(planes).collect();
    let shown = all.iter().filter(|reading| verbose || named.contains(&&reading.gauge));
    shown.cloned().collect()
}

/// Readings of all gauges and probes.
pub(super) fn gauge_readings<const D: usize>(
    scene: &CheckedScene,
    probes: &Probes,
    simulation: &Simulation<'_, D>,
) -> Vec<GaugeReading> {
    let histories = probes.histories();
    let readings = probes.gauges().into_iter().flat_map(|(name, kind)| match kind {
        GaugeKind::Plane => plane_readings(histories, name),
        GaugeKind::Station => point_readings(histories, name, None),
        GaugeKind::Material { body, surface } => {
            let is_free = surface == SurfacePart::Free;
            let material = surface_material(scene, body, simulation);
            point_readings(histories, name, is_free.then_some(material))
        }
    });
    readings.collect()
}

/// State at rest from which the velocity of the surface of a body is interpreted.
fn surface_material<const D: usize>(
    scene: &CheckedScene,
    body: usize,
    simulation: &Simulation<'_, D>,
) -> SurfaceMaterial {
    SurfaceMaterial {
        density: scene.material_of(body).density,
        sound_speed: simulation.sound_speed_at_rest(body),
    }
}

/// Histories of all gauges and probes, and the values that are read from them.
pub(super) fn gauge_records<const D: usize>(
    scene: &CheckedScene,
    probes: &Probes,
    simulation: &Simulation<'_, D>,
) -> GaugeRecords {
    let table = probes.histories();
    let times = table.column("time").unwrap_or_default();
    let mut histories = Vec::new();
    for (gauge, kind) in probes.gauges() {
        let quantities: &[(&str, &[&str])] = match kind {
            GaugeKind::Plane => &[("momentum", &["momentum"])],
            _ if D == 1 => &[("velocity", &["velocity"]), ("pressure", &["pressure"])],
            _ => &[("velocity", &["velocity_x", "velocity_y"]), ("pressure", &["pressure"])],
        };
        for (quantity, names) in quantities {
            let column = |name| Some(table.column(&format!("{gauge}_{name}"))?.to_vec());
            let components = names.iter().map(column).collect::<Option<Vec<Vec<f64>>>>();
            histories.extend(components.map(|components| GaugeHistory {
                gauge: gauge.into(),
                quantity: (*quantity).into(),
                times: times.to_vec(),
                components,
            }));
        }
    }
    let gauges = probes.gauges();
    let kind_of =
        |name: &str| gauges.iter().find(|(gauge, _)| *gauge == name).map(|(_, kind)| kind);
    let readings = gauge_readings(scene, probes, simulation).into_iter().map(|reading| {
        let mut scale = 1.0;
        let (history, kind) = match &reading.quantity[..] {
            "peak pressure" | "peak tension" => ("pressure", ReadingKind::Extreme),
            "impulse" => ("momentum", ReadingKind::Level),
            "arrival" => ("velocity", ReadingKind::Arrival),
            "plateau velocity" => ("velocity", ReadingKind::Level),
            "spall strength" => {
                if let Some(GaugeKind::Material { body, .. }) = kind_of(&reading.gauge) {
                    scale = surface_material(scene, *body, simulation).strength_per_velocity();
                }
                ("velocity", ReadingKind::Extreme)
            }
            _ => ("velocity", ReadingKind::Extreme),
        };
        let GaugeReading { gauge, quantity, unit, value, .. } = reading;
        Reading { gauge, quantity, history: history.into(), kind, scale, unit, value }
    });
    // At a face that meets a side or another body, the pressure of the outermost particle has a start-up
    // peak that does not shrink with the cell size. Such readings get no estimate.
    let is_startup = |r: &Reading| {
        r.history == "pressure" && kind_of(&r.gauge).is_some_and(GaugeKind::is_loaded)
    };
    let readings = readings.filter(|reading| !is_startup(reading)).collect();
    GaugeRecords { histories, readings }
}
