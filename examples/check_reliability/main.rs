//! Measures what checkpoints and faults promise, and prints each figure beside its bound.
//!
//! Started by `scripts/check_reliability.sh`, which builds the program first. Arguments: names of
//! sections to run them alone. Exit code 1 where a bound is missed.

mod cost;
mod damage;
mod full;
mod kills;
#[path = "../../tests/effects/metal.rs"]
mod metal;
mod program;
mod restarts;
#[path = "../common/sections.rs"]
mod sections;
#[path = "../common/table.rs"]
mod table;

use std::process::ExitCode;

use sections::Section;

const SECTIONS: [(&str, Section); 5] = [
    ("restarts", restarts::check),
    ("kills", kills::check),
    ("full", full::check),
    ("damage", damage::check),
    ("cost", cost::check),
];

fn main() -> ExitCode {
    sections::run(&SECTIONS, &[])
}
