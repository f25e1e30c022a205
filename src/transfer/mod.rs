//! Transfers of velocity from the grid to the particles: one file per transfer, one line per
//! transfer in the list below.
//!
//! A transfer is defined by its [`TransferPlan`], which lists the terms that a step computes. This
//! module does not depend on particles, fields or messages.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Defines the transfers from a list of `module::Name(parameter: attribute type),`: their names in
/// scenes and the functions `plan` and `courant_limit` of their modules.
macro_rules! transfers {
    ($($(#[doc = $doc:literal])+ $module:ident::$name:ident $(($value:ident: #[$range:meta] $type:ty))?,)+) => {
        $(mod $module;)+

        /// Transfers of velocity.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum Transfer {
            $($(#[doc = $doc])+ $name $((#[$range] $type))?,)+
        }

        impl Transfer {
            /// Terms that a step computes for the transfer.
            pub fn plan(self) -> TransferPlan {
                match self { $(Transfer::$name $(($value))? => $module::plan($($value)?),)+ }
            }

            /// Greatest Courant number at which it was measured to be stable [-], from the row of a
            /// shape function ([`crate::shape::CourantLimits`]).
            pub fn courant_limit(self, row: &[f64; 9]) -> f64 {
                match self {
                    $(Transfer::$name $(($value))? => $module::courant_limit($($value,)? row),)+
                }
            }
        }
    };
}

transfers! {
    /// Adds the nodal change of velocity to the particle's (Brackbill & Ruppel 1986).
    flip::Flip,
    /// Takes the nodal velocity (Harlow 1964).
    pic::Pic,
    /// Takes the nodal velocity and its affine part (Jiang et al. 2015).
    apic::Apic,
    /// This share of FLIP, the rest PIC [-].
    flip_pic::FlipPic(share: #[schemars(range(min = 0.0, max = 1.0))] f64),
    /// Filters the particle's velocity, by this order (Hammerquist & Nairn 2017).
    xpic::Xpic(order: #[schemars(range(min = 1, max = 50))] u32),
    /// Full mass matrix by a series of this order, for velocity and force (Nairn & Hammerquist 2021).
    fmpm::Fmpm(order: #[schemars(range(min = 1, max = 50))] u32),
}

/// How the velocity of a particle is updated from the nodal velocities vL (lumped), v (filtered)
/// at the start of the step and v' at its end; N: weights of the particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VelocityUpdate {
    /// v_p' = a v_p + (1 - a) N vL + N (v' - vL), with the share a [-].
    Blend(f64),
    /// v_p' = N v', with the affine part of the velocity kept on the particle.
    Affine,
    /// v_p' = N v', with v filtered by the series v = sum_(l<k) K^l vL, K = 1 - m^-1 M.
    Filtered,
}

/// Terms that a step computes for a transfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferPlan {
    /// Update of the particle velocities.
    pub update: VelocityUpdate,
    /// Number of terms of the series that filters the velocity; 1: no filter.
    pub order: u32,
    /// Whether the series also applies to the force (full mass matrix).
    pub full_mass_matrix: bool,
    /// Whether the filter removes kinetic energy that `method.filter_heat` can return as heat.
    pub filters: bool,
}

impl TransferPlan {
    /// Number of terms of the series of the force; 1: lumped mass matrix.
    pub fn force_order(&self) -> u32 {
        if self.full_mass_matrix { self.order } else { 1 }
    }

    /// Whether particles store the affine part of their velocity.
    pub fn is_affine(&self) -> bool {
        self.update == VelocityUpdate::Affine
    }

    /// Whether the series filters the velocity.
    pub fn is_filtered(&self) -> bool {
        self.update == VelocityUpdate::Filtered
    }

    /// Whether the approximate inverse of the mass matrix is accurate enough to amplify forces at
    /// nodes with little material.
    pub fn is_sharp(&self) -> bool {
        self.full_mass_matrix && self.order > 2
    }

    /// Whether it needs the mass matrix, with or without `compatible` energy.
    pub fn needs_matrix(&self, compatible: bool) -> bool {
        match self.update {
            VelocityUpdate::Filtered => self.order > 1 || compatible,
            VelocityUpdate::Blend(_) => compatible,
            VelocityUpdate::Affine => false,
        }
    }

    /// Number of products with the mass matrix between the nodal sums of a step and the new
    /// particle velocities.
    pub fn products(&self, compatible: bool) -> u32 {
        match self.update {
            VelocityUpdate::Filtered => {
                self.order - 1 + if compatible { self.force_order() } else { 0 }
            }
            VelocityUpdate::Blend(_) if compatible => 1,
            VelocityUpdate::Blend(_) | VelocityUpdate::Affine => 0,
        }
    }

    /// Number of series of vectors.
    pub fn series(&self) -> usize {
        if self.is_filtered() { 1 + usize::from(self.full_mass_matrix) } else { 0 }
    }

    /// Share of a jump of the nodal velocity that particles adopt [-]: a blend keeps a part of the
    /// particle velocity.
    pub fn taken_share(&self) -> f64 {
        match self.update {
            VelocityUpdate::Blend(share) => 1.0 - share,
            VelocityUpdate::Filtered | VelocityUpdate::Affine => 1.0,
        }
    }
}

/// Smallest limit among some columns of a row [-].
fn least(row: &[f64; 9], columns: std::ops::RangeInclusive<usize>) -> f64 {
    row[columns].iter().copied().fold(f64::INFINITY, f64::min)
}
