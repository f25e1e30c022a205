//! A rigid wall at rest to which material sticks.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { no_slip: true, ..SideProperties::wall() }
}
