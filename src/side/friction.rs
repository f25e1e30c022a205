//! A rigid wall at rest with Coulomb friction.

use super::SideProperties;

/// A wall with the Coulomb friction `coefficient` [-].
pub(super) fn properties(coefficient: &f64) -> SideProperties {
    SideProperties { friction: Some(*coefficient), ..SideProperties::wall() }
}
