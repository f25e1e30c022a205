//! Materials and effects against exact solutions and integrations of their own.

mod equations;
mod explosives;
mod heat;
mod motion;
mod objectivity;
mod paths;
mod plates;
mod spall;
mod strength;
mod tables;

use crate::section::{Section, named, usual};

pub const TITLE: &str =
    "Materials and effects against exact solutions and integrations of their own";

pub const SECTIONS: [Section; 18] = [
    usual("equations", equations::check),
    usual("porous", equations::porous),
    usual("tables", tables::check),
    usual("products", explosives::products),
    usual("burn", explosives::burn),
    usual("paths", paths::check),
    usual("strength_paths", strength::paths),
    usual("objectivity", objectivity::check),
    usual("piston", strength::piston),
    usual("flyer", strength::flyer),
    usual("taylor", strength::taylor),
    // half an hour, and some three hours
    named("taylor_fine", strength::taylor_fine),
    usual("spall", spall::check),
    usual("heat", heat::check),
    usual("plates", plates::check),
    usual("window", plates::window),
    usual("wave", motion::wave),
    usual("books", motion::books),
];
