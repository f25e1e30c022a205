//! A rigid wall at rest without friction.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties::wall()
}
