//! Blend of FLIP and PIC.

use super::{TransferPlan, VelocityUpdate, least};

pub(super) fn plan(share: f64) -> TransferPlan {
    TransferPlan {
        update: VelocityUpdate::Blend(share),
        order: 1,
        full_mass_matrix: false,
        filters: true,
    }
}

pub(super) fn courant_limit(_share: f64, row: &[f64; 9]) -> f64 {
    least(row, 0..=1)
}
