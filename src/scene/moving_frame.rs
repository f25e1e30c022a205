//! The frame of the grid, which travels with a piston: where it is, and how fast it moves.
//!
//! Particles' columns are those seen from the grid: a place is x - X(t) and a velocity u - V(t),
//! X the integral of V. A piston whose velocity changes makes the frame one that accelerates. With
//! E', P' what is seen from the grid and E, P from the scene, M the mass,
//!
//! ```text
//! E = E' + V.P' + M V^2/2,  P = P' + M V
//! ```
//!
//! Knows no particles and no grid.

use crate::scene::{CheckedScene, Course, Side};

/// The frame of the grid.
#[derive(Clone, Debug)]
pub struct Frame<const D: usize> {
    courses: [Course; D],
}

impl<const D: usize> Frame<D> {
    /// That of a scene: along each direction it travels with the piston that stands across it.
    pub fn new(scene: &CheckedScene) -> Self {
        let piston = |side: &Side| match side {
            Side::Velocity(course) => Some(course.clone()),
            _ => None,
        };
        let along = |ends: [Side; 2]| ends.iter().find_map(piston);
        let still = Course::Constant(0.0);
        Frame {
            courses: scene.sides::<D>().map(|ends| along(ends).unwrap_or_else(|| still.clone())),
        }
    }

    /// Whether its velocity changes.
    pub fn accelerates(&self) -> bool {
        self.courses.iter().any(Course::changes)
    }

    /// Its velocity at `time` [m/s].
    pub fn velocity(&self, time: f64) -> [f64; D] {
        std::array::from_fn(|a| self.courses[a].at(time))
    }

    /// How far it has travelled by `time` [m].
    pub fn travel(&self, time: f64) -> [f64; D] {
        std::array::from_fn(|a| self.courses[a].integral(time))
    }

    /// Its mean acceleration over a step of `dt` from `time` [m/s2]: what the velocity changes by
    /// is exact, whatever happens between.
    pub fn acceleration(&self, time: f64, dt: f64) -> [f64; D] {
        let (from, to) = (self.velocity(time), self.velocity(time + dt));
        std::array::from_fn(|a| if dt > 0.0 { (to[a] - from[a]) / dt } else { 0.0 })
    }

    /// Its least and its greatest velocity along each direction [m/s].
    pub fn extremes(&self) -> [[f64; D]; 2] {
        [0, 1].map(|k| std::array::from_fn(|a| self.courses[a].range()[k]))
    }

    /// The greatest change of its velocity between any two times [m/s].
    pub fn greatest_change(&self) -> f64 {
        let changes = self.courses.iter().map(|c| c.range()).map(|[least, most]| most - least);
        changes.fold(0.0, f64::max)
    }

    /// V.p - m V^2/2 at `time` of what has the mass `m` and the momentum `p` in the scene [J]: what
    /// its energy in the scene is more than seen from the grid.
    pub fn energy_ahead(&self, time: f64, m: f64, p: &[f64; D]) -> f64 {
        let v = self.velocity(time);
        (0..D).map(|a| v[a] * (p[a] - 0.5 * m * v[a])).sum()
    }
}
