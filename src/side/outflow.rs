//! An open side: particles leave the run.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { lets_out: true, ..SideProperties::open() }
}
