//! Earliest time at which a wave can arrive at a point of a body.
//!
//! Bodies that start without pressure are at rest in their own frame until a wave arrives. Waves
//! start where a body of another velocity, or a wall that moves towards it, touches it:
//!
//! ```text
//! t = g/w + (d - g)/U        U = max(c + up)
//! ```
//!
//! with d the distance from the initial position of the other body, g the gap that it has to cross
//! first and w the greatest speed at which it may cross it. U is the greatest value over the bodies
//! of the same velocity, as a wave may pass through any of them. Bodies are represented by their
//! bounding boxes, so that a real wave arrives later than this, never earlier. A shock is at least
//! as fast as c + up if s >= 1 in us = c + s up. If it is slower, as behind an elastic precursor,
//! the material counts as reached before the shock arrives.

use crate::scene::{CheckedScene, SideProperties};
use crate::solver::Stepper;

/// Margin in cells at the source of a wave and at the faces of a body, where the check is off: an
/// impact starts with oscillations, and at a free surface the velocity of an oscillation doubles.
const MARGIN: f64 = 8.0;

/// Sources and speed of the first waves in a body.
#[derive(Clone, Debug)]
pub(super) struct FirstArrival<const D: usize> {
    sources: Vec<Source<D>>,
    /// Wave speed U [m/s].
    speed: f64,
    /// Lower and upper corner of the body without its margin [m].
    inner: [[f64; D]; 2],
    /// Width of the margin [m].
    margin: f64,
}

/// A body or a wall in its initial position.
#[derive(Clone, Debug)]
struct Source<const D: usize> {
    /// Lower and upper corner [m]; for a wall the half space beyond it; infinite along a periodic
    /// direction.
    corners: [[f64; D]; 2],
    /// Distance to the nearest body that it may strike [m].
    gap: f64,
    /// Earliest time of impact on such a body [s].
    delay: f64,
}

impl<const D: usize> Source<D> {
    /// Vector from the nearest point of the source to `x` [m]; zero inside.
    fn to(&self, x: &[f64; D]) -> [f64; D] {
        let [lower, upper] = &self.corners;
        std::array::from_fn(|a| (x[a] - upper[a]).max(0.0) + (x[a] - lower[a]).min(0.0))
    }
}

fn norm<const D: usize>(v: &[f64; D]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn apart<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    norm(&std::array::from_fn::<f64, D, _>(|k| a[k] - b[k]))
}

/// Distance between two boxes [m].
fn gap<const D: usize>(a: &[[f64; D]; 2], b: &[[f64; D]; 2]) -> f64 {
    norm(&std::array::from_fn::<f64, D, _>(|k| (a[0][k] - b[1][k]).max(b[0][k] - a[1][k]).max(0.0)))
}

impl<const D: usize> FirstArrival<D> {
    /// First arrivals in body `i`; `up` is the particle velocity behind the strongest shock of each
    /// body [m/s]. None if something other than impacts may move the body, or if nothing strikes
    /// it.
    pub fn of(scene: &CheckedScene, stepper: &Stepper<D>, i: usize, up: &[f64]) -> Option<Self> {
        let bodies = &scene.scene.bodies;
        let count = bodies.len();
        let driven = scene.is_loaded()
            || bodies.iter().any(|b| b.pressure != 0.0 || b.temperature.is_some())
            || (0..count).any(|k| stepper.conducts_heat(k));
        if driven {
            return None;
        }
        let velocity =
            |k: usize| -> [f64; D] { std::array::from_fn(|a| scene.bodies[k].velocity[a]) };
        let sides = scene.side_properties::<D>();
        let corners = |k: usize| -> [[f64; D]; 2] {
            let body = &scene.bodies[k];
            let along = |a: usize| match sides[a].iter().any(SideProperties::is_periodic) {
                true => [f64::NEG_INFINITY, f64::INFINITY],
                false => [body.lower[a], body.upper[a]],
            };
            [0, 1].map(|end| std::array::from_fn(|a| along(a)[end]))
        };
        let own = velocity(i);
        let struck: Vec<usize> = (0..count).filter(|&k| velocity(k) == own).collect();
        let others = (0..count).filter(|k| !struck.contains(k));
        let others = others.map(|k| (corners(k), apart(&velocity(k), &own)));
        let walls = walls(scene, &own);
        let moving: Vec<_> = others.chain(walls).collect();
        // a body that is struck by another may arrive faster than it started
        let faster = if moving.len() > 1 { 2.0 } else { 1.0 };
        let closing = faster * moving.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
        let sources = moving.iter().map(|(source, _)| {
            let gaps = struck.iter().map(|&k| gap(source, &corners(k)));
            let gap = gaps.fold(f64::INFINITY, f64::min);
            Source { corners: *source, gap, delay: gap / closing }
        });
        let sources: Vec<Source<D>> = sources.collect();
        let speed = struck.iter().map(|&k| stepper.sound_speed_at_start(scene, k) + up[k]);
        let speed = speed.fold(0.0, f64::max);
        let margin = MARGIN * scene.cell_size.iter().copied().fold(0.0, f64::max);
        let [lower, upper] = corners(i);
        let inner = [lower.map(|x| x + margin), upper.map(|x| x - margin)];
        (!sources.is_empty()).then_some(FirstArrival { sources, speed, inner, margin })
    }

    /// Earliest time at which a wave can reach a box with these corners [m], in [s].
    pub fn earliest(&self, corners: &[[f64; D]; 2]) -> f64 {
        let from = |source: &Source<D>| {
            let way = gap(&source.corners, corners) - source.gap;
            if way <= 0.0 { source.delay } else { source.delay + way / self.speed }
        };
        self.sources.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// Velocity against all approaching waves [m/s] of a point at the initial position `x` [m] that
    /// moves at `velocity` relative to the body [m/s]; negative if it moves with one of the waves.
    /// None if a wave may have arrived by `time` [s], and in the margins.
    pub fn against(&self, x: &[f64; D], velocity: &[f64; D], time: f64) -> Option<f64> {
        let [lower, upper] = &self.inner;
        if (0..D).any(|a| x[a] < lower[a] || x[a] > upper[a]) {
            return None;
        }
        self.sources.iter().try_fold(f64::INFINITY, |least, source| {
            let to = source.to(x);
            let distance = norm(&to);
            let arrival = source.delay + (distance - source.gap) / self.speed;
            let along = (0..D).map(|a| velocity[a] * to[a]).sum::<f64>() / distance;
            let near = distance <= source.gap + self.margin;
            (!near && arrival > time).then(|| least.min(-along))
        })
    }
}

/// Sides that start waves in a body of this velocity, as boxes beyond the domain, and the closing
/// speed of the body and each side [m/s].
fn walls<const D: usize>(scene: &CheckedScene, own: &[f64; D]) -> Vec<([[f64; D]; 2], f64)> {
    let (sides, extremes) = (scene.side_properties::<D>(), scene.frame::<D>().extremes());
    let domain = &scene.scene.domain;
    let mut all = Vec::new();
    for (a, ends) in sides.iter().enumerate() {
        for (end, side) in ends.iter().enumerate() {
            let across = |wall: &[f64; D]| match side {
                _ if side.resists_sliding() => apart(own, wall),
                // it takes material at rest for undisturbed
                _ if side.absorbs_waves => norm(own),
                _ if side.is_rigid() => (own[a] - wall[a]).abs(),
                _ => 0.0,
            };
            let speed = extremes.iter().map(across).fold(0.0, f64::max);
            if speed > 0.0 {
                let mut corners = [[f64::NEG_INFINITY; D], [f64::INFINITY; D]];
                match end {
                    0 => corners[1][a] = domain.lower[a],
                    _ => corners[0][a] = domain.upper[a],
                }
                all.push((corners, speed));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_comes_from_the_nearest_point() {
        let plate = Source { corners: [[-1.0, 0.0], [0.0, 1.0]], gap: 0.0, delay: 0.0 };
        let inner = [[-9.0; 2], [9.0; 2]];
        let arrival = FirstArrival { sources: vec![plate], speed: 2.0, inner, margin: 1.0 };
        // 5 m from the corner
        let at = [3.0, 5.0];
        assert_eq!(arrival.against(&at, &[0.0, -10.0], 2.4), Some(8.0));
        assert_eq!(arrival.against(&at, &[3.0, 4.0], 2.4), Some(-5.0));
        assert_eq!(arrival.against(&at, &[0.0, -10.0], 2.6), None);
        // inside the margins: in the source, next to it, next to a face
        for x in [[-0.5, 0.5], [0.9, 0.5], [3.0, 9.1]] {
            assert_eq!(arrival.against(&x, &[0.0, -10.0], 0.0), None);
        }
        assert_eq!(arrival.against(&[1.1, 0.5], &[0.0, -10.0], 0.0), Some(0.0));
    }

    #[test]
    fn a_gap_is_crossed_first() {
        let far = Source { corners: [[-2.0], [-1.0]], gap: 1.0, delay: 4.0 };
        let inner = [[0.0], [4.0]];
        let arrival = FirstArrival { sources: vec![far], speed: 2.0, inner, margin: 1.0 };
        assert_eq!(arrival.against(&[3.0], &[-1.0], 5.4), Some(1.0));
        assert_eq!(arrival.against(&[3.0], &[-1.0], 5.6), None);
        assert_eq!(arrival.earliest(&[[3.0], [9.0]]), 5.5);
        assert_eq!(arrival.earliest(&[[-1.5], [9.0]]), 4.0);
        assert_eq!(gap(&[[0.0, 0.0], [1.0, 1.0]], &[[4.0, 5.0], [6.0, 6.0]]), 5.0);
        assert_eq!(gap(&[[0.0], [2.0]], &[[1.0], [3.0]]), 0.0);
    }

    #[test]
    fn between_two_waves_nothing_moves_against_both() {
        let at = |x: f64| Source { corners: [[x], [x]], gap: 0.0, delay: 0.0 };
        let (sources, inner) = (vec![at(0.0), at(10.0)], [[0.0], [10.0]]);
        let arrival = FirstArrival { sources, speed: 1.0, inner, margin: 1.0 };
        assert_eq!(arrival.against(&[4.0], &[-1.0], 3.9), Some(-1.0));
        assert_eq!(arrival.against(&[4.0], &[0.0], 3.9), Some(0.0));
        assert_eq!(arrival.against(&[7.0], &[0.0], 3.9), None);
    }
}
