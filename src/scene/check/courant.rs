//! The Courant numbers up to which schemes were measured to be stable.
//!
//! The numbers are data: `cargo run --release --example courant_limits` measures them anew and
//! prints this table. It runs the standard problem cut short, at Courant numbers from 0.1 to 1 in
//! steps of 0.1, with the options of `inputs/flyer.json` (mid-point; with its viscosity and with one
//! that does not grow) and `inputs/flyer_defaults.json` (leapfrog) that the transfer allows. A number is
//! stable where the run ends under the watch, its pressures stay below twice that of the impact, and
//! so at every smaller number.

use super::super::errors::Fault;
use super::super::model::{AboveLimit, ShapeKind, Stepping, Transfer};
use super::CheckedScene;

/// Columns of the table: each row has a limit for FLIP, PIC, APIC, XPIC(2), XPIC(5),
/// FMPM(2), FMPM(4), FMPM(6), FMPM(8).
const TRANSFERS: usize = 9;

/// Limits of a shape function [-], in leapfrog and mid-point steps.
type Row = (ShapeKind, [f64; TRANSFERS], [f64; TRANSFERS]);

/// The measured limits.
const LIMITS: [Row; 6] = [
    (
        ShapeKind::Linear,
        [1.0, 1.0, 0.3, 1.0, 1.0, 0.8, 0.4, 0.3, 0.2],
        [0.8, 1.0, 1.0, 1.0, 0.9, 0.9, 0.7, 0.7, 0.7],
    ),
    (
        ShapeKind::Gimp,
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8, 0.6, 0.5],
        [1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.8, 0.8, 0.8],
    ),
    (
        ShapeKind::Cpdi,
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8, 0.7, 0.7],
        [1.0, 1.0, 1.0, 1.0, 1.0, 0.9, 0.9, 0.7, 0.7],
    ),
    (
        ShapeKind::BsplineQuadratic,
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.8],
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    ),
    (
        ShapeKind::BsplineCubic,
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    ),
    (
        ShapeKind::CpdiBsplineQuadratic,
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    ),
];

/// Limit of FMPM beyond order 2 with a transmitting side, whose impedance acts on single nodes [-].
const TRANSMITTING: f64 = 0.8;

/// Schemes that were seen to fail at less than this fail at any number, only later: what they lack
/// is no shorter step [-].
const LEAST: f64 = 0.4;

impl CheckedScene {
    /// The greatest Courant number at which the scene's scheme was measured to be stable [-].
    pub fn courant_limit(&self) -> f64 {
        let method = &self.scene.method;
        let own = of(method.shape, method.transfer, method.stepping);
        let long = matches!(method.transfer, Transfer::Fmpm(m) if m > 2);
        if long && self.transmits() { own.min(TRANSMITTING) } else { own }
    }
}

/// Refuses a Courant number above the limit, or takes the limit, or warns, as the scene says.
pub(super) fn check(checked: &mut CheckedScene) -> Result<(), Fault> {
    let (courant, limit) = (checked.scene.time.courant, checked.courant_limit());
    if courant <= limit {
        return Ok(());
    }
    let warning = match checked.scene.watch.above_limit {
        _ if courant <= LEAST => format!(
            "method.shape, method.transfer: this method was seen to fail from a Courant number of \
             {limit} on, in time at any; the watch ends the run where it does"
        ),
        AboveLimit::Refuse => {
            let limit = limit.max(LEAST);
            let reason = format!(
                "above {limit}, up to which this method was measured to be stable; allowed: at \
                 most {limit}, or watch.above_limit = \"reduce\" to take that or \"allow\""
            );
            return Err(Fault::new("time.courant", courant, reason));
        }
        AboveLimit::Reduce => {
            let limit = limit.max(LEAST);
            checked.scene.time.courant = limit;
            format!(
                "time.courant = {courant}: reduced to {limit}, up to which this method was measured \
                 to be stable"
            )
        }
        AboveLimit::Allow => format!(
            "time.courant = {courant}: above {limit}, up to which this method was measured to be \
             stable; watch.above_limit allows it"
        ),
    };
    checked.warnings.push(warning);
    Ok(())
}

/// The limit of a scheme [-]; of an order between two that were measured the less of theirs.
fn of(shape: ShapeKind, transfer: Transfer, stepping: Stepping) -> f64 {
    let rows = LIMITS.iter().find(|row| row.0 == shape);
    let (_, leapfrog, midpoint) = rows.expect("every shape function has a row");
    let row = if stepping == Stepping::Leapfrog { leapfrog } else { midpoint };
    let least = |columns: std::ops::RangeInclusive<usize>| {
        row[columns].iter().copied().fold(f64::INFINITY, f64::min)
    };
    match transfer {
        Transfer::Flip => row[0],
        Transfer::Pic | Transfer::Xpic(0..=1) | Transfer::Fmpm(0..=1) => row[1],
        Transfer::Apic => row[2],
        Transfer::FlipPic(_) => least(0..=1),
        Transfer::Xpic(2) => row[3],
        Transfer::Xpic(3..=4) => least(3..=4),
        Transfer::Xpic(_) => row[4],
        Transfer::Fmpm(2) => row[5],
        Transfer::Fmpm(3) => least(5..=6),
        Transfer::Fmpm(4) => row[6],
        Transfer::Fmpm(5) => least(6..=7),
        Transfer::Fmpm(6) => row[7],
        Transfer::Fmpm(7) => least(7..=8),
        Transfer::Fmpm(_) => row[8],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_between_two_that_were_measured_take_the_less() {
        for (shape, leapfrog, midpoint) in LIMITS {
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
