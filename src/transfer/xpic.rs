//! XPIC: filters the particle velocity by a series. Source: Hammerquist & Nairn (2017).

use super::{TransferPlan, VelocityUpdate, least};

pub(super) fn plan(order: u32) -> TransferPlan {
    TransferPlan { update: VelocityUpdate::Filtered, order, full_mass_matrix: false, filters: true }
}

/// Courant limit; between two measured orders the smaller of their limits.
pub(super) fn courant_limit(order: u32, row: &[f64; 9]) -> f64 {
    match order {
        0..=1 => row[1],
        2 => row[3],
        3..=4 => least(row, 3..=4),
        _ => row[4],
    }
}
