//! A plane of symmetry.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { on_axis: true, ..SideProperties::wall() }
}
