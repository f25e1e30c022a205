//! Readings of the gauges and probes of a run, from its histories.

use super::output::gauges::{GaugeReading, SurfaceMaterial, plane_readings, point_readings};
use super::probes::GaugeKind;
use super::recorder::Recorder;
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
    recorder: &Recorder<'_>,
    simulation: &Simulation<'_, D>,
) -> Vec<GaugeReading> {
    let Some((histories, gauges)) = recorder.histories().zip(recorder.gauges()) else {
        return Vec::new();
    };
    let readings = gauges.into_iter().flat_map(|(name, kind)| match kind {
        GaugeKind::Plane => plane_readings(histories, name),
        GaugeKind::Station => point_readings(histories, name, None),
        GaugeKind::Material { body, free } => {
            let surface = SurfaceMaterial {
                density: scene.material_of(body).density,
                sound_speed: simulation.sound_speed_at_rest(body),
            };
            point_readings(histories, name, free.then_some(surface))
        }
    });
    readings.collect()
}
