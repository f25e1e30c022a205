//! Materials and effects against exact solutions and integrations of their own.

mod equations;
mod explosives;
mod gauges;
mod heat;
mod motion;
mod objectivity;
mod paths;
mod plates;
mod spall;
mod strength;
mod tables;

use crate::section::{Section, named, quick, usual};

/// Subject of the group.
pub const TITLE: &str =
    "Materials and effects against exact solutions and integrations of their own";

/// Sections in the order in which they run.
pub const SECTIONS: [Section; 19] = [
    usual("equations", equations::check),
    usual("porous", equations::porous),
    quick("tables", tables::check),
    quick("products", explosives::products),
    quick("burn", explosives::burn),
    quick("paths", paths::check),
    quick("strength_paths", strength::paths),
    usual("objectivity", objectivity::check),
    quick("piston", strength::piston),
    quick("flyer", strength::flyer),
    usual("taylor", strength::taylor),
    // half an hour, and some three hours
    named("taylor_fine", strength::taylor_fine),
    usual("spall", spall::check),
    quick("heat", heat::check),
    quick("plates", plates::check),
    quick("window", plates::window),
    quick("gauges", gauges::check),
    quick("wave", motion::wave),
    quick("conservation", motion::conservation),
];
