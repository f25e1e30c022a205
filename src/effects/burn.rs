//! Programmed burn: when a front lights which place, and how much has burnt since.
//!
//! ```text
//! t_l = start + (distance from the nearest point, or from the plane)/D
//! F = (t - t_l) D/width, within 0 and 1
//! ```
//!
//! Source: Wilkins (1999), Computer Simulation of Dynamic Phenomena, section 5. The places are those
//! of the start; the front goes straight, through whatever lies between.

use crate::scene::{BurnFront, Eos};

/// A burning front.
#[derive(Clone, Debug)]
pub struct Front<'a>(&'a BurnFront);

impl<'a> Front<'a> {
    /// That of an explosive; none of other materials, or where all has burnt.
    pub fn of(eos: &'a Eos) -> Option<Self> {
        eos.burn()?.front().map(Front)
    }

    /// When the front reaches the place `x` [s].
    pub fn lighting_time(&self, x: &[f64]) -> f64 {
        let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|d| d * d).sum::<f64>().sqrt();
        let apart = |p: &[f64]| norm(&mut x.iter().zip(p).map(|(x, p)| x - p));
        let distance = match (&self.0.plane, &self.0.points) {
            (Some(plane), _) => {
                let along = x.iter().zip(&plane.point).zip(&plane.normal);
                let along: f64 = along.map(|((x, p), n)| (x - p) * n).sum();
                along.abs() / norm(&mut plane.normal.iter().copied())
            }
            (None, points) => {
                let points = points.iter().flatten();
                points.map(|p| apart(p)).fold(f64::INFINITY, f64::min)
            }
        };
        self.0.start + distance / self.0.detonation_velocity
    }
}

/// The burnt fraction at `time` of what was lit at `lighting_time` [s], as the front passes it over
/// `duration` [s].
#[inline(always)]
pub fn burnt(time: f64, lighting_time: f64, duration: f64) -> f64 {
    ((time - lighting_time) / duration).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Burn, BurnPlane};

    fn front(points: Option<Vec<Vec<f64>>>, plane: Option<BurnPlane>) -> BurnFront {
        BurnFront {
            points,
            plane,
            detonation_velocity: 5000.0,
            width: 1e-3,
            start: 1e-6,
            compression: false,
        }
    }

    #[test]
    fn the_nearest_point_lights() {
        let front = front(Some(vec![vec![0.0, 0.0], vec![1.0, 0.0]]), None);
        let time = |x: f64, y: f64| Front(&front).lighting_time(&[x, y]);
        assert!((time(0.3, 0.4) - (1e-6 + 0.5 / 5000.0)).abs() < 1e-18);
        assert!((time(0.9, 0.0) - (1e-6 + 0.1 / 5000.0)).abs() < 1e-18);
    }

    #[test]
    fn a_plane_lights_to_both_sides() {
        let plane = BurnPlane { point: vec![0.0, 1.0], normal: vec![0.0, -2.0] };
        let front = Burn::Front(front(None, Some(plane)));
        let time = |y: f64| Front(front.front().unwrap()).lighting_time(&[7.0, y]);
        assert!((time(1.5) - (1e-6 + 1e-4)).abs() < 1e-18 && time(0.5) == time(1.5));
    }

    #[test]
    fn it_burns_over_the_width() {
        assert_eq!(
            [burnt(0.9, 1.0, 0.5), burnt(1.25, 1.0, 0.5), burnt(2.0, 1.0, 0.5)],
            [0.0, 0.5, 1.0]
        );
    }
}
