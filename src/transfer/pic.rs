//! PIC: particles take the nodal velocity. Source: Harlow (1964).

use super::{TransferPlan, VelocityUpdate};

pub(super) fn plan() -> TransferPlan {
    TransferPlan {
        update: VelocityUpdate::Blend(0.0),
        order: 1,
        full_mass_matrix: false,
        filters: true,
    }
}

pub(super) fn courant_limit(row: &[f64; 9]) -> f64 {
    row[1]
}
