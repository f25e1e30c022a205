//! Measures what sharing the work over ranks, patches and threads promises, and prints each figure
//! beside its bound.
//!
//! Started by `scripts/check_decomposition.sh`, which builds the program first. Arguments: `--full`
//! for all layouts and long runs; names of sections to run them alone. Exit code 1 where a bound
//! is missed.

mod balance;
mod bits;
#[path = "../../tests/common/covering.rs"]
mod covering;
mod hang;
#[path = "../../tests/common/in_process.rs"]
mod in_process;
#[path = "../../tests/common/layouts.rs"]
mod layouts;
mod memory;
mod quiet;
#[path = "../common/resident.rs"]
mod resident;
#[path = "../common/runs.rs"]
mod runs;
#[path = "../../tests/common/scenes.rs"]
mod scenes;
mod schemes;
mod speed;
#[path = "../common/table.rs"]
mod table;

use std::process::ExitCode;

use table::Table;

/// Checks one section; with all that it has, or with less.
type Section = fn(&mut Table, bool);

const SECTIONS: [(&str, Section); 7] = [
    ("bits", bits::check),
    ("schemes", |table, _| schemes::check(table)),
    ("speed", |table, _| speed::check(table)),
    ("balance", |table, _| balance::check(table)),
    ("quiet", |table, _| quiet::check(table)),
    ("memory", memory::check),
    ("hang", |table, _| hang::check(table)),
];

fn main() -> ExitCode {
    let (mut full, mut wanted) = (false, Vec::new());
    for argument in std::env::args().skip(1) {
        if argument == "--full" {
            full = true;
        } else if SECTIONS.iter().any(|(name, _)| *name == argument) {
            wanted.push(argument);
        } else {
            let names: Vec<_> = SECTIONS.iter().map(|(name, _)| *name).collect();
            eprintln!("{argument}: expected --full or one of {}", names.join(", "));
            return ExitCode::from(2);
        }
    }
    let mut table = Table::new();
    for (name, section) in SECTIONS {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            section(&mut table, full);
        }
    }
    println!("{} of {} bounds held", table.bounded - table.missed, table.bounded);
    if table.missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
