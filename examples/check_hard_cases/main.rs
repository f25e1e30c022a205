//! Measures what hard cases must keep, and prints each figure beside its bound; writes the table
//! of schemes and cases of `docs/hard_cases.md`.
//!
//! Started by `scripts/check_hard_cases.sh`. Arguments: names of sections to run them alone. Exit
//! code 1 where a bound is missed.

#[path = "../../tests/hard_cases/cases/mod.rs"]
mod cases;
mod schemes;
#[path = "../common/sections.rs"]
mod sections;
#[path = "../common/table.rs"]
mod table;

use std::process::ExitCode;

use cases::CASES;
use sections::Section;
use table::{Show, Table};

fn show(table: &mut Table, name: &str) {
    let (_, measure, _) = CASES.iter().find(|(known, ..)| *known == name).expect("a case");
    for figure in measure() {
        table.at_most(&figure.what, Some(figure.value), figure.bound, Show::Tiny);
    }
}

macro_rules! sections {
    ($($name:literal),* $(,)?) => {
        [$(($name, (|table| show(table, $name)) as Section)),*, ("schemes", schemes::check as Section)]
    };
}

const SECTIONS: [(&str, Section); CASES.len() + 1] = sections!(
    "viscosity",
    "particles_a_cell",
    "irregular",
    "shifted_grid",
    "speeds",
    "impedances",
    "separation",
    "courant",
    "translation",
    "mirror_and_shift",
    "units",
    "galilean",
    "one_body_of_two",
    "fifty_transits",
    "borders",
    "odd_times",
    "tiny_bodies",
    "rarefaction",
    "cold_start",
    "standing_wave",
    "plane",
    "debris",
    "effects",
    "scales",
    "denormals",
);

/// Sections that write a file of the repository, run where they are named alone.
const LONG: [&str; 1] = ["schemes"];

fn main() -> ExitCode {
    sections::run(&SECTIONS, &LONG)
}
