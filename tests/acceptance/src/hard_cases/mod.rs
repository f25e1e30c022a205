//! Hard cases; the bounds are those of `tests/hard_cases`.

#[path = "../../../hard_cases/cases/mod.rs"]
mod cases;
mod schemes;

use crate::bounds::{Bound, Unit};
use crate::section::{Section, named, quick, usual};
use crate::table::Table;
use cases::CASES;
pub use cases::scenes;

/// Subject of the group.
pub const TITLE: &str = "Hard cases: extreme values, rest, invariance and debris";

fn show(table: &mut Table, name: &str) {
    let (_, measure, _) = CASES.iter().find(|(known, ..)| *known == name).expect("a case");
    for figure in measure() {
        let bound = Bound { at_most: Some(figure.bound), at_least: None, unit: Unit::One };
        table.check(&figure.what, Some(figure.value), bound);
    }
}

macro_rules! sections {
    ($($when:ident $name:literal),* $(,)?) => {
        [$($when($name, |table| show(table, $name))),*, named("schemes", schemes::check)]
    };
}

/// Sections in the order in which they run.
pub const SECTIONS: [Section; CASES.len() + 1] = sections!(
    quick "viscosity",
    quick "particles_a_cell",
    quick "irregular",
    quick "shifted_grid",
    quick "speeds",
    quick "impedances",
    quick "separation",
    quick "courant",
    quick "translation",
    quick "mirror_and_shift",
    quick "units",
    quick "galilean",
    quick "one_body_of_two",
    quick "fifty_transits",
    quick "borders",
    quick "odd_times",
    quick "tiny_bodies",
    quick "rarefaction",
    quick "cold_start",
    usual "standing_wave",
    quick "plane",
    quick "debris",
    quick "effects",
    quick "scales",
    quick "denormals",
);
