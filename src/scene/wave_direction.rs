//! Plane waves at an angle: positions and velocities of bodies along the direction of the waves.

use super::checked::CheckedScene;
use super::model::{Front, Reference, Region, Rotation};

/// Allowed difference between the angles of a body and of a front [degrees].
const SAME_ANGLE: f64 = 1e-9;

impl CheckedScene {
    /// Direction of the waves of the scene's exact solution, if given.
    pub fn front(&self) -> Option<&Front> {
        match self.scene.reference.as_ref()? {
            Reference::FlyerImpact(impact) => impact.front.as_ref(),
            Reference::Riemann(riemann) => riemann.front.as_ref(),
            _ => None,
        }
    }

    /// Unit vector of the direction of the waves.
    fn direction(&self) -> [f64; 2] {
        let angle = self.front().map_or(0.0, |front| front.angle.to_radians());
        [angle.cos(), angle.sin()]
    }

    /// Start and end of body `i` along the direction of the waves [m]: x coordinates, or distances
    /// from the point `about` of a front at an angle. `None` for a body without defined ends along
    /// it.
    pub fn span(&self, i: usize) -> Option<[f64; 2]> {
        let body = &self.bodies[i];
        let Some(front) = self.front().filter(|front| front.angle != 0.0) else {
            return Some([body.lower[0], body.upper[0]]);
        };
        let regions = self.scene.regions_of(&self.scene.bodies[i]);
        let (_, Region::Rotation(Rotation { angle, about, of })) = regions.first()? else {
            return None;
        };
        let same = (angle - front.angle).abs() <= SAME_ANGLE && *about == front.about;
        match &**of {
            Region::Box(extent) if same => {
                Some([extent.lower[0] - about[0], extent.upper[0] - about[0]])
            }
            _ => None,
        }
    }

    /// Distance from the line of the waves to the nearest lateral edge of body `i` [m]; infinite if
    /// both lateral ends are at reflecting or periodic sides of the domain.
    pub fn edge_distance(&self, i: usize) -> f64 {
        let [_, ends] = self.side_properties::<2>();
        let y = self.front().map_or(self.scene.domain.lower[1], |front| front.about[1]);
        let turned = self.front().is_some_and(|front| front.angle != 0.0);
        let regions = self.scene.regions_of(&self.scene.bodies[i]);
        let extent = match regions.first() {
            Some((_, Region::Box(extent))) if !turned => extent,
            Some((_, Region::Rotation(Rotation { of, .. }))) => match &**of {
                Region::Box(extent) => extent,
                _ => return 0.0,
            },
            _ => return 0.0,
        };
        let domain = &self.scene.domain;
        let closed = |end: usize, at: f64| {
            let (side, place) = (&ends[end], [domain.lower[1], domain.upper[1]][end]);
            let reflects = side.is_rigid() && !side.moves_grid && !side.resists_sliding();
            !turned && (reflects || side.is_periodic()) && (at - place).abs() <= self.tolerance(1)
        };
        let distance = |end: usize, at: f64| {
            if closed(end, at) { f64::INFINITY } else { (at - y).abs() }
        };
        distance(0, extent.lower[1]).min(distance(1, extent.upper[1]))
    }

    /// Initial velocity of body `i` along the direction of the waves [m/s].
    pub fn speed_along(&self, i: usize) -> f64 {
        let velocity = &self.bodies[i].velocity;
        match self.front().filter(|front| front.angle != 0.0) {
            Some(_) => self.direction().iter().zip(velocity).map(|(n, v)| n * v).sum(),
            None => velocity[0],
        }
    }
}
