//! Families of schemes: each has error models of its own, since the same indicators stand for other
//! errors.

use serde::{Deserialize, Serialize};

use crate::scene::{FrameKind, Method};
use crate::shape::ShapeKind;
use crate::transfer::Transfer;

/// A family of schemes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SchemeFamily {
    /// FMPM in the total-Lagrangian frame.
    TotalLagrangian,
    /// FMPM with other shape functions than linear CPDI.
    SplineFmpm,
    /// FMPM with linear CPDI.
    CpdiFmpm,
    /// FLIP, also in part.
    Flip,
    /// The transfers that damp: APIC, PIC, XPIC.
    Damped,
}

impl SchemeFamily {
    /// All families.
    pub const ALL: [SchemeFamily; 5] = [
        SchemeFamily::TotalLagrangian,
        SchemeFamily::SplineFmpm,
        SchemeFamily::CpdiFmpm,
        SchemeFamily::Flip,
        SchemeFamily::Damped,
    ];

    /// The family of a method.
    pub fn of(method: &Method) -> SchemeFamily {
        match method.transfer {
            Transfer::Fmpm(_) if method.frame == FrameKind::TotalLagrangian => {
                SchemeFamily::TotalLagrangian
            }
            Transfer::Fmpm(_) if method.shape == ShapeKind::Cpdi => SchemeFamily::CpdiFmpm,
            Transfer::Fmpm(_) => SchemeFamily::SplineFmpm,
            Transfer::Flip | Transfer::FlipPic(_) => SchemeFamily::Flip,
            _ => SchemeFamily::Damped,
        }
    }
}
