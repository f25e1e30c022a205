//! Bodies with corners and round bodies in contact.

mod bounce;
mod cost;
mod crater;
mod friction;
mod heat;
mod hertz;
mod measure;
mod normals;
mod parting;
mod scenes;
mod sliding;

use crate::section::{Section, quick, usual};
pub use measure::{Measured, run};
pub use normals::{flat as slide, lost as speed_lost};
pub use sliding::{pass, passing_pressure};

/// Subject of the group.
pub const TITLE: &str = "Contact between bodies: normals, sliding, friction";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 10] = [
    usual("normals", normals::check),
    usual("cost", cost::check),
    quick("sliding", sliding::check),
    quick("friction", friction::check),
    usual("incline", friction::incline),
    usual("bounce", bounce::check),
    usual("hertz", hertz::check),
    usual("heat", heat::check),
    usual("crater", crater::check),
    usual("parting", parting::check),
];
