//! Scenes in a plane, and bodies in contact.

mod bits;
mod column;
mod contact;
mod disks;
mod gases;
mod schemes;
mod sides;
mod speed;
mod turning;
mod waves;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Scenes in a plane, and bodies in contact";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 14] = [
    quick("column", column::check),
    usual("bits", bits::check),
    usual("finite", waves::finite_flyer),
    usual("oblique", waves::oblique),
    quick("sides", sides::check),
    quick("contact", contact::check),
    usual("vortex", turning::vortex),
    usual("disk", turning::disk),
    quick("shear", turning::shear),
    quick("gresho", turning::gresho),
    usual("disks", disks::check),
    usual("noh", gases::noh),
    usual("sod", gases::sod),
    usual("speed", speed::check),
];
