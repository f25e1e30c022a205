//! APIC: particles take the nodal velocity and its affine part. Source: Jiang et al. (2015).

use super::{TransferPlan, VelocityUpdate};

pub(super) fn plan() -> TransferPlan {
    TransferPlan {
        update: VelocityUpdate::Affine,
        order: 1,
        full_mass_matrix: false,
        filters: false,
    }
}

pub(super) fn courant_limit(row: &[f64; 9]) -> f64 {
    row[2]
}
