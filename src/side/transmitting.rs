//! An open side without reflection of waves: particles leave the run.

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { lets_out: true, absorbs_waves: true, ..SideProperties::open() }
}
