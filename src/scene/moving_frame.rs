//! Frame of the grid, which moves with a piston: its position and velocity.
//!
//! Particle columns are relative to the grid: a position is x - X(t) and a velocity u - V(t), where
//! X is the integral of V. If the velocity of the piston changes, the frame accelerates. With E',
//! P' relative to the grid, E, P in the scene and the mass M,
//!
//! ```text
//! E = E' + V.P' + M V^2/2,  P = P' + M V
//! ```
//!
//! Independent of particles and grid.

use super::model::{Course, SideProperties};

/// The frame of the grid.
#[derive(Clone, Debug)]
pub struct Frame<const D: usize> {
    courses: [Course; D],
}

impl<const D: usize> Frame<D> {
    /// Frame of a scene with these `sides`: in each direction it moves with the piston on a side
    /// across this direction.
    pub fn new(sides: [[SideProperties; 2]; D]) -> Self {
        let piston = |ends: [SideProperties; 2]| ends.into_iter().find(|side| side.moves_grid);
        let course = |ends| piston(ends)?.rigid_velocity;
        Frame { courses: sides.map(|ends| course(ends).unwrap_or(Course::Constant(0.0))) }
    }

    /// Whether the velocity of the frame changes.
    pub fn accelerates(&self) -> bool {
        self.courses.iter().any(Course::changes)
    }

    /// Velocity at `time` [m/s].
    pub fn velocity(&self, time: f64) -> [f64; D] {
        std::array::from_fn(|a| self.courses[a].at(time))
    }

    /// Displacement by `time` [m].
    pub fn travel(&self, time: f64) -> [f64; D] {
        std::array::from_fn(|a| self.courses[a].integral(time))
    }

    /// Mean acceleration over a step of `dt` from `time` [m/s2]. The change of velocity over the
    /// step is exact for any course in between.
    pub fn acceleration(&self, time: f64, dt: f64) -> [f64; D] {
        let (from, to) = (self.velocity(time), self.velocity(time + dt));
        std::array::from_fn(|a| if dt > 0.0 { (to[a] - from[a]) / dt } else { 0.0 })
    }

    /// Smallest and largest velocity in each direction [m/s].
    pub fn extremes(&self) -> [[f64; D]; 2] {
        [0, 1].map(|k| std::array::from_fn(|a| self.courses[a].range()[k]))
    }

    /// Largest change of the velocity between any two times [m/s].
    pub fn greatest_change(&self) -> f64 {
        let changes = self.courses.iter().map(|c| c.range()).map(|[least, most]| most - least);
        changes.fold(0.0, f64::max)
    }

    /// V.p - m V^2/2 at `time` for the mass `m` and the momentum `p` in the scene [J]: energy in
    /// the scene minus energy relative to the grid.
    pub fn energy_ahead(&self, time: f64, m: f64, p: &[f64; D]) -> f64 {
        let v = self.velocity(time);
        (0..D).map(|a| v[a] * (p[a] - 0.5 * m * v[a])).sum()
    }
}
