//! Hard cases; the bounds are those of `tests/hard_cases`.

#[path = "../../../hard_cases/cases/mod.rs"]
mod cases;
mod schemes;

use crate::bounds::{Bound, Unit};
use crate::section::{Section, named, usual};
use crate::table::Table;
use cases::CASES;
pub use cases::scenes;

pub const TITLE: &str = "Hard cases: extreme values, rest, invariance and debris";

fn show(table: &mut Table, name: &str) {
    let (_, measure, _) = CASES.iter().find(|(known, ..)| *known == name).expect("a case");
    for figure in measure() {
        let bound = Bound { at_most: Some(figure.bound), at_least: None, unit: Unit::One };
        table.check(&figure.what, Some(figure.value), bound);
    }
}

macro_rules! sections {
    ($($name:literal),* $(,)?) => {
        [$(usual($name, |table| show(table, $name))),*, named("schemes", schemes::check)]
    };
}

pub const SECTIONS: [Section; CASES.len() + 1] = sections!(
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
