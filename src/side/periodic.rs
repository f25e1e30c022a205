//! A side joined to the opposite one.

use decomp::SideKind;

use super::SideProperties;

pub(super) fn properties() -> SideProperties {
    SideProperties { ghosts: SideKind::Wrap, ..SideProperties::open() }
}
