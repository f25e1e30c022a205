//! Rigid sides of the domain and the bodies beside them.

use super::checked::CheckedScene;
use super::model::{Course, Side};

/// A rigid side of the domain: a plane of symmetry, a wall or a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Whether it is at the upper end of x.
    pub upper: bool,
    /// Initial position [m].
    pub position: f64,
    /// Initial velocity along x [m/s].
    pub velocity: f64,
}

/// A moving side.
#[derive(Clone, Debug, PartialEq)]
pub struct Piston {
    /// Whether it is at the upper end of x.
    pub upper: bool,
    /// Velocity along x over time [m/s].
    pub course: Course,
}

impl Wall {
    /// Path of the key that defines it.
    pub(crate) fn path(&self) -> &'static str {
        if self.upper { "boundary.x_upper" } else { "boundary.x_lower" }
    }
}

impl CheckedScene {
    /// The rigid sides of the domain, the lower one first.
    pub fn walls(&self) -> Vec<Wall> {
        let Some(boundary) = &self.scene.boundary else { return Vec::new() };
        let domain = &self.scene.domain;
        let wall = |side: &Side, position, upper| {
            let course = side.properties().rigid_velocity?;
            Some(Wall { upper, position, velocity: course.at(0.0) })
        };
        let lower = wall(&boundary.x_lower, domain.lower[0], false);
        let upper = wall(&boundary.x_upper, domain.upper[0], true);
        lower.into_iter().chain(upper).collect()
    }

    /// The rigid side that body `i` touches and moves into, if any.
    pub fn wall_struck_by(&self, i: usize) -> Option<Wall> {
        self.walls()
            .into_iter()
            .find(|w| self.gap_to(w, i) <= self.tolerance(0) && self.closing_speed(w, i) > 0.0)
    }

    /// The piston that body `i` touches, if any.
    pub fn piston_at(&self, i: usize) -> Option<Piston> {
        let boundary = self.scene.boundary.as_ref()?;
        let ends = [(&boundary.x_lower, false), (&boundary.x_upper, true)];
        let domain = &self.scene.domain;
        ends.into_iter().find_map(|(side, upper)| {
            let course = Some(side.properties()).filter(|side| side.moves_grid)?.rigid_velocity?;
            let position = if upper { domain.upper[0] } else { domain.lower[0] };
            let wall = Wall { upper, position, velocity: course.at(0.0) };
            let touches = self.gap_to(&wall, i) <= self.tolerance(0);
            touches.then_some(Piston { upper, course })
        })
    }

    /// Distance from body `i` to a wall [m].
    pub(crate) fn gap_to(&self, wall: &Wall, i: usize) -> f64 {
        let extent = &self.bodies[i];
        if wall.upper { wall.position - extent.upper[0] } else { extent.lower[0] - wall.position }
    }

    /// Closing speed of body `i` and a wall [m/s].
    pub fn closing_speed(&self, wall: &Wall, i: usize) -> f64 {
        let relative = self.bodies[i].velocity[0] - wall.velocity;
        if wall.upper { relative } else { -relative }
    }
}
