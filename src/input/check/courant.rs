//! Courant numbers up to which methods were measured to be stable. The measured values are next to
//! each shape function ([`crate::shape::CourantLimits`]).

use super::super::errors::SceneFault;
use crate::scene::CheckedScene;
use crate::scene::{OnCourantExceeded, ShapeKind, Stepping, Transfer};

/// Limit of FMPM beyond order 2 with a transmitting side, whose impedance acts on individual nodes
/// [-].
const TRANSMITTING: f64 = 0.8;

/// Limit of any method with a transmitting side in a plane [-]. The impedance of shear waves acts on
/// individual nodes too: behind a shear wave, a disturbance at the side grows at 0.45 with FMPM and
/// at 0.5 with FLIP, and decays at 0.4.
const TRANSMITTING_IN_PLANE: f64 = 0.4;

/// A method that failed below this Courant number fails at any, only later: a smaller time step is
/// no remedy [-].
const LEAST: f64 = 0.4;

impl CheckedScene {
    /// Largest Courant number at which the scene's method was measured to be stable [-].
    pub fn courant_limit(&self) -> f64 {
        let method = &self.scene.method;
        let own = of(method.shape, method.transfer, method.stepping);
        let limit = match self.transmits() {
            true if self.dimension > 1 => TRANSMITTING_IN_PLANE,
            true if method.transfer.plan().is_sharp() => TRANSMITTING,
            _ => own,
        };
        own.min(limit)
    }
}

/// Rejects a Courant number above the limit, reduces it or warns, as `monitor.on_courant_exceeded`
/// says.
pub(super) fn check(checked: &mut CheckedScene) -> Result<(), SceneFault> {
    let (courant, limit) = (checked.scene.time.courant, checked.courant_limit());
    if courant <= limit {
        return Ok(());
    }
    let warning = match checked.scene.monitor.on_courant_exceeded {
        _ if courant <= LEAST => format!(
            "method.shape, method.transfer: this method was seen to fail from a Courant number of \
             {limit} on, in time at any; the monitor ends the run where it does"
        ),
        OnCourantExceeded::Refuse => {
            let limit = limit.max(LEAST);
            let reason = format!(
                "above {limit}, up to which this method was measured to be stable; allowed: at \
                 most {limit}, or monitor.on_courant_exceeded = \"reduce\" to take that or \"allow\""
            );
            return Err(SceneFault::new("time.courant", courant, reason));
        }
        OnCourantExceeded::Reduce => {
            let limit = limit.max(LEAST);
            checked.scene.time.courant = limit;
            format!(
                "time.courant = {courant}: reduced to {limit}, up to which this method was measured \
                 to be stable"
            )
        }
        OnCourantExceeded::Allow => format!(
            "time.courant = {courant}: above {limit}, up to which this method was measured to be \
             stable; monitor.on_courant_exceeded allows it"
        ),
    };
    checked.warnings.push(warning);
    Ok(())
}

/// Courant limit of a method [-].
fn of(shape: ShapeKind, transfer: Transfer, stepping: Stepping) -> f64 {
    let limits = shape.courant_limits();
    let row = if stepping == Stepping::Leapfrog { &limits.leapfrog } else { &limits.midpoint };
    transfer.courant_limit(row)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::CourantLimits;

    #[test]
    fn orders_between_two_that_were_measured_take_the_less() {
        for &shape in ShapeKind::ALL {
            let CourantLimits { leapfrog, midpoint } = *shape.courant_limits();
            for (stepping, row) in [(Stepping::Leapfrog, leapfrog), (Stepping::Midpoint, midpoint)]
            {
                let limit = |transfer| of(shape, transfer, stepping);
                assert_eq!(limit(Transfer::Fmpm(6)), row[7]);
                assert_eq!(limit(Transfer::Fmpm(5)), row[6].min(row[7]));
                assert_eq!(limit(Transfer::Fmpm(50)), row[8]);
                assert_eq!(limit(Transfer::Xpic(4)), row[3].min(row[4]));
                assert_eq!(limit(Transfer::FlipPic(0.5)), row[0].min(row[1]));
                assert!(row.iter().all(|limit| (0.0..=1.0).contains(limit)));
            }
        }
    }
}
