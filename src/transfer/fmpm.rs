//! FMPM: inverse of the full mass matrix by a series, for velocity and force. Source: Nairn &
//! Hammerquist (2021).

use super::{TransferPlan, VelocityUpdate, least};

pub(super) fn plan(order: u32) -> TransferPlan {
    TransferPlan { update: VelocityUpdate::Filtered, order, full_mass_matrix: true, filters: true }
}

/// Courant limit; between two measured orders the smaller of their limits.
pub(super) fn courant_limit(order: u32, row: &[f64; 9]) -> f64 {
    match order {
        0..=1 => row[1],
        2 => row[5],
        3 => least(row, 5..=6),
        4 => row[6],
        5 => least(row, 6..=7),
        6 => row[7],
        7 => least(row, 7..=8),
        _ => row[8],
    }
}
