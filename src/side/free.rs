//! A free side: no condition.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties::open()
}
