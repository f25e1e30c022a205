//! A plane of symmetry.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { symmetric: true, ..SideProperties::wall() }
}
