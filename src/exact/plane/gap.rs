//! Two plates with a gap between them: nothing happens before the gap has closed.
//!
//! ```text
//! g(t) = g0 - V t,   closed at t_c = g0/V
//! ```
//!
//! After t_c the solution is the impact at V, shifted by t_c. If bodies interact through the grid
//! before their faces touch, the computed contact is too early; [`Gap::lead_cells`] gives by how
//! many cells.

use crate::exact::{ExactError, Impact, ImpactBody, positive};

/// A gap and the speed that closes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Width at t = 0 [m].
    pub width: f64,
    /// Closing speed V [m/s].
    pub speed: f64,
}

impl Gap {
    /// A gap of `width` [m] that closes at `speed` [m/s].
    ///
    /// # Errors
    ///
    /// If the width or the speed is not positive and finite.
    pub fn new(width: f64, speed: f64) -> Result<Gap, ExactError> {
        positive("the width of the gap", width)?;
        positive("the closing speed", speed)?;
        Ok(Gap { width, speed })
    }

    /// The gap between two bodies, either of them on the left; `None` if they touch.
    ///
    /// # Errors
    ///
    /// As [`Impact::new`].
    pub fn between(flyer: ImpactBody, target: ImpactBody) -> Result<Option<Gap>, ExactError> {
        let impact = Impact::new(flyer, target)?;
        let width = impact.contact_time * impact.speed;
        Ok((width > 0.0).then_some(Gap { width, speed: impact.speed }))
    }

    /// Time at which the gap is closed [s].
    pub fn closing_time(&self) -> f64 {
        self.width / self.speed
    }

    /// Width of the gap at `t` [m]; 0 after closing.
    pub fn at(&self, t: f64) -> f64 {
        (self.width - self.speed * t).max(0.0)
    }

    /// Distance between the faces at a computed time of contact, in cells of size `h` [m]; positive
    /// if the contact is too early [-].
    pub fn lead_cells(&self, computed: f64, h: f64) -> f64 {
        (self.closing_time() - computed) * self.speed / h
    }

    /// The impact of a flyer of `thickness` [m] that comes from the side of -x, starts at this gap
    /// from the face that it strikes, and moves at this speed relative to the target.
    ///
    /// # Errors
    ///
    /// As [`Impact::new`].
    pub fn impact(
        &self,
        flyer: crate::material::MieGruneisen,
        thickness: f64,
        target: ImpactBody,
    ) -> Result<Impact, ExactError> {
        let upper = target.lower - self.width;
        let velocity = target.velocity + self.speed;
        Impact::new(
            ImpactBody { material: flyer, lower: upper - thickness, upper, velocity },
            target,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};
    use crate::exact::{Accuracy, ProfilePoint};

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    #[test]
    fn closes_on_time() {
        let gap = Gap::new(0.1037e-3, 1000.0).unwrap();
        close(gap.closing_time(), 0.1037e-6, 1e-20);
        close(gap.at(0.05e-6), 0.0537e-3, 1e-18);
        assert_eq!(gap.at(0.2e-6), 0.0);
        // with a criterion on velocity alone, contact was detected at 0.0747 us: 2.9 cells of 10 um
        // early
        close(gap.lead_cells(0.0747e-6, 10e-6), 2.9, 1e-9);
        assert!(Gap::new(0.0, 1.0).is_err() && Gap::new(1.0, -1.0).is_err());
    }

    #[test]
    fn the_impact_afterwards_is_the_shifted_one() {
        let gap = Gap::new(0.1037e-3, 1000.0).unwrap();
        let target = ImpactBody { material: ALUMINIUM, lower: 0.0, upper: 8e-3, velocity: 0.0 };
        let late = gap.impact(COPPER, 0.5e-3, target).unwrap();
        let flyer = ImpactBody { material: COPPER, lower: -0.5e-3, upper: 0.0, velocity: 1000.0 };
        let prompt = Impact::new(flyer, target).unwrap();
        close(late.contact_time, gap.closing_time(), 1e-18);
        let found = Gap::between(late.flyer, late.target).unwrap().unwrap();
        close(found.width, gap.width, 1e-18);
        assert_eq!(Gap::between(flyer, target), Ok(None));
        let accuracy = Accuracy { wavelets: 60 };
        let a = prompt.solve(&[0.5e-6], &[], accuracy).unwrap();
        let b = late.solve(&[0.5e-6 + gap.closing_time(), 0.1e-6], &[], accuracy).unwrap();
        let points = |s: &crate::exact::Snapshot| s.profile.as_ref().unwrap().points.clone();
        for (p, q) in points(&a.snapshots[0]).iter().zip(&points(&b.snapshots[0])) {
            close(p.x, q.x, 1e-14);
            close(p.p, q.p, 1e-2);
        }
        let quiet = |q: &ProfilePoint| q.p == 0.0;
        assert!(points(&b.snapshots[1]).iter().all(quiet));
    }
}
