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

use crate::section::{Section, usual};

pub const TITLE: &str = "Scenes in a plane, and bodies in contact";

pub const SECTIONS: [Section; 14] = [
    usual("column", column::check),
    usual("bits", bits::check),
    usual("finite", waves::finite_flyer),
    usual("oblique", waves::oblique),
    usual("sides", sides::check),
    usual("contact", contact::check),
    usual("vortex", turning::vortex),
    usual("disk", turning::disk),
    usual("shear", turning::shear),
    usual("gresho", turning::gresho),
    usual("disks", disks::check),
    usual("noh", gases::noh),
    usual("sod", gases::sod),
    usual("speed", speed::check),
];
