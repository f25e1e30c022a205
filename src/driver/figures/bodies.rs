//! Colours and surfaces of the bodies of a scene.

use crate::material::failure::DAMAGE;
use crate::plot::{Color, MaterialBand};
use crate::scene::CheckedScene;
use crate::simulation::ParticleTable;

/// The colour of each body: that of its material.
pub(super) fn colors(scene: &CheckedScene) -> Vec<Color> {
    let names: Vec<&str> = scene.scene.bodies.iter().map(|body| body.material.as_str()).collect();
    Color::of_materials(&names)
}

/// Bands of the bodies of a scene on a line, from their `ends` [m].
pub(super) fn bands(scene: &CheckedScene, ends: &[[f64; 2]]) -> Vec<MaterialBand> {
    let bodies = scene.scene.bodies.iter().zip(colors(scene)).zip(closed(scene, ends));
    let there = bodies.filter(|(_, [low, high])| low <= high);
    there
        .map(|((body, color), [low, high])| MaterialBand::new(&body.material, (low, high), color))
        .collect()
}

/// Positions where bodies touch [m].
pub(super) fn interfaces(scene: &CheckedScene, ends: &[[f64; 2]]) -> Vec<f64> {
    let ends = closed(scene, ends);
    let touches = |at: f64| ends.iter().any(|[low, _]| *low == at);
    ends.iter().map(|[_, high]| *high).filter(|high| touches(*high)).collect()
}

/// The ends of bodies that touch, moved to the middle between their last particles: these are
/// less than two cells apart.
fn closed(scene: &CheckedScene, ends: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let near = 2.0 * scene.cell_size[0];
    let mut closed = ends.to_vec();
    for (a, of_a) in ends.iter().enumerate() {
        for (b, of_b) in ends.iter().enumerate() {
            if a != b && of_b[0] > of_a[0] && (of_b[0] - of_a[1]).abs() < near {
                let middle = 0.5 * (of_a[1] + of_b[0]);
                closed[a][1] = middle;
                closed[b][0] = middle;
            }
        }
    }
    closed
}

/// First and last position of the particles of each body [m]; infinite if none is left.
pub(super) fn ends_of(scene: &CheckedScene, table: &ParticleTable) -> Vec<[f64; 2]> {
    let x = table.column("x").unwrap_or(&[]);
    let mut ends = vec![[f64::INFINITY, f64::NEG_INFINITY]; scene.bodies.len()];
    for (x, body) in x.iter().zip(&table.body) {
        let end = &mut ends[*body as usize];
        *end = [end[0].min(*x), end[1].max(*x)];
    }
    ends
}

/// Rows of the particles that have failed.
pub(super) fn failed(table: &ParticleTable) -> impl Iterator<Item = usize> {
    let damage = table.column(DAMAGE).unwrap_or(&[]);
    damage.iter().enumerate().filter(|(_, damage)| **damage >= 1.0).map(|(row, _)| row)
}

/// A line about the particles that are no longer there; `None` if all are.
pub(super) fn removed(scene: &CheckedScene, table: &ParticleTable) -> Option<String> {
    let count = scene.particles.saturating_sub(table.len() as u64);
    let how = match (scene.erodes(), scene.has_side(|side| side.lets_out)) {
        (true, false) => "eroded",
        (false, true) => "have left the domain",
        _ => "eroded or have left the domain",
    };
    (count > 0).then(|| format!("{count} of {} particles {how}", scene.particles))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> CheckedScene {
        let text = include_bytes!("../../../inputs/three_plates.json");
        crate::input::parse(text, "three_plates.json", &[]).unwrap()
    }

    #[test]
    fn bodies_meet_in_the_middle_between_their_particles() {
        let scene = scene();
        let h = scene.cell_size[0];
        let ends = [[0.0, 10.0 * h], [11.0 * h, 20.0 * h], [25.0 * h, 30.0 * h]];
        assert_eq!(interfaces(&scene, &ends), [10.5 * h]);
        let bands = bands(&scene, &ends);
        let spans: Vec<(f64, f64)> = bands.iter().map(|band| (band.low, band.high)).collect();
        assert_eq!(spans, [(0.0, 10.5 * h), (10.5 * h, 20.0 * h), (25.0 * h, 30.0 * h)]);
        // a body without particles has no band
        let gone = [ends[0], [f64::INFINITY, f64::NEG_INFINITY], ends[2]];
        assert_eq!(super::bands(&scene, &gone).len(), 2);
        assert!(interfaces(&scene, &gone).is_empty());
    }
}
