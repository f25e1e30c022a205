//! Measures what runs in a plane and bodies in contact promise, and prints each figure beside its bound.
//!
//! Started by `scripts/check_2d.sh`, which builds the program first. Arguments: names of sections to
//! run them alone. Exit code 1 where a bound is missed.

mod bits;
mod column;
mod contact;
mod disks;
mod gases;
#[path = "../common/resident.rs"]
mod resident;
#[path = "../common/runs.rs"]
mod runs;
mod schemes;
#[path = "../common/sections.rs"]
mod sections;
mod sides;
mod speed;
#[path = "../common/table.rs"]
mod table;
mod turning;
mod waves;

use std::process::ExitCode;

use sections::Section;

const SECTIONS: [(&str, Section); 14] = [
    ("column", column::check),
    ("bits", bits::check),
    ("finite", waves::finite_flyer),
    ("oblique", waves::oblique),
    ("sides", sides::check),
    ("contact", contact::check),
    ("vortex", turning::vortex),
    ("disk", turning::disk),
    ("shear", turning::shear),
    ("gresho", turning::gresho),
    ("disks", disks::check),
    ("noh", gases::noh),
    ("sod", gases::sod),
    ("speed", speed::check),
];

fn main() -> ExitCode {
    sections::run(&SECTIONS, &[])
}
