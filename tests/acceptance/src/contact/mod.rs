//! Bodies with corners and round bodies in contact.

mod cost;
mod friction;
mod measure;
mod normals;
mod scenes;
mod sliding;

use crate::section::{Section, quick, usual};

/// Subject of the group.
pub const TITLE: &str = "Contact between bodies: normals, sliding, friction";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 5] = [
    usual("normals", normals::check),
    usual("cost", cost::check),
    quick("sliding", sliding::check),
    quick("friction", friction::check),
    usual("incline", friction::incline),
];
