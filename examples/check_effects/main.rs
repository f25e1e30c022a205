//! Measures what materials and effects promise, and prints each figure beside its bound.
//!
//! Started by `scripts/check_effects.sh`, which builds the program first. Arguments: names of
//! sections to run them alone. Exit code 1 where a bound is missed.

mod equations;
mod explosives;
mod heat;
mod motion;
mod objectivity;
mod paths;
mod plates;
#[path = "../common/resident.rs"]
mod resident;
#[path = "../common/runs.rs"]
mod runs;
#[path = "../common/sections.rs"]
mod sections;
mod spall;
mod strength;
#[path = "../common/table.rs"]
mod table;
mod tables;

use std::process::ExitCode;

use sections::Section;

const SECTIONS: [(&str, Section); 18] = [
    ("equations", equations::check),
    ("porous", equations::porous),
    ("tables", tables::check),
    ("products", explosives::products),
    ("burn", explosives::burn),
    ("paths", paths::check),
    ("strength_paths", strength::paths),
    ("objectivity", objectivity::check),
    ("piston", strength::piston),
    ("flyer", strength::flyer),
    ("taylor", strength::taylor),
    ("taylor_fine", strength::taylor_fine),
    ("spall", spall::check),
    ("heat", heat::check),
    ("plates", plates::check),
    ("window", plates::window),
    ("wave", motion::wave),
    ("books", motion::books),
];

/// Sections that take long, run where they are named alone.
const LONG: [&str; 1] = ["taylor_fine"];

fn main() -> ExitCode {
    sections::run(&SECTIONS, &LONG)
}
