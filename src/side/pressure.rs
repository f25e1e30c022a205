//! A pressure on the surface of the bodies that touch the side at the start.

use super::{Course, SideProperties};

/// A side with the pressure `load` [Pa].
pub(super) fn properties(load: &Course) -> SideProperties {
    SideProperties { pressure: Some(load.clone()), ..SideProperties::open() }
}
