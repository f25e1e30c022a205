//! Measures what is promised of accuracy and its price, and prints each figure beside its bound.
//!
//! Started by `scripts/check_accuracy.sh`, which builds the program first. Arguments: names of
//! sections to run them alone. Exit code 1 where a bound is missed.

mod estimate;
#[path = "../common/estimates.rs"]
mod estimates;
mod plan;
#[path = "../common/random_impacts.rs"]
mod random_impacts;
#[path = "../common/resident.rs"]
mod resident;
#[path = "../common/runs.rs"]
mod runs;
mod schemes;
#[path = "../common/sections.rs"]
mod sections;
#[path = "../common/table.rs"]
mod table;

use std::process::ExitCode;

use sections::Section;

const SECTIONS: [(&str, Section); 8] = [
    ("standard", schemes::standard),
    ("order", schemes::order),
    ("impacts", schemes::impacts),
    ("noh", schemes::noh),
    ("smooth", schemes::smooth),
    ("cost", schemes::cost),
    ("estimate", estimate::check),
    ("plan", plan::check),
];

/// Sections that take long, run where they are named alone.
const LONG: [&str; 0] = [];

fn main() -> ExitCode {
    sections::run(&SECTIONS, &LONG)
}
