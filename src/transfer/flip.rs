//! FLIP: adds the change of the nodal velocity to the particle velocity. Source: Brackbill & Ruppel
//! (1986).

use super::{TransferPlan, VelocityUpdate};

pub(super) fn plan() -> TransferPlan {
    TransferPlan {
        update: VelocityUpdate::Blend(1.0),
        order: 1,
        full_mass_matrix: false,
        filters: false,
    }
}

pub(super) fn courant_limit(row: &[f64; 9]) -> f64 {
    row[0]
}
