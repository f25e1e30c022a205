//! Hard cases and what each must keep: figures beside their bounds, the same for the tests and for
//! the acceptance program.
//!
//! The scheme is that of `inputs/flyer.json`, read when a case is run.

mod effects;
mod impacts;
mod invariance;
mod particles;
mod plane;
mod rests;
#[path = "../../common/scenes.rs"]
pub mod scenes;
pub mod tools;

/// Something measured, and what it may be.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What it is.
    pub what: String,
    /// Its size; NaN where there is none.
    pub value: f64,
    /// Its greatest size.
    pub bound: f64,
}

/// `what` with its `value` and `bound`.
pub fn figure(what: impl Into<String>, value: f64, bound: f64) -> Figure {
    Figure { what: what.into(), value, bound }
}

/// A case: its name, what it measures, and whether it takes long.
pub type Case = (&'static str, fn() -> Vec<Figure>, bool);

/// All cases, in the order of the report.
pub const CASES: [Case; 25] = [
    ("viscosity", impacts::viscosity, false),
    ("particles_a_cell", particles::counts, true),
    ("irregular", particles::irregular, false),
    ("shifted_grid", particles::shifted, true),
    ("speeds", impacts::speeds, true),
    ("impedances", impacts::impedances, true),
    ("separation", impacts::separation, false),
    ("courant", impacts::courant, true),
    ("translation", invariance::translation, false),
    ("mirror_and_shift", invariance::mirror_and_shift, false),
    ("units", invariance::units, false),
    ("galilean", invariance::galilean, true),
    ("one_body_of_two", impacts::two_as_one, false),
    ("fifty_transits", rests::fifty_transits, true),
    ("borders", invariance::borders, false),
    ("odd_times", invariance::odd_times, false),
    ("tiny_bodies", particles::tiny, false),
    ("rarefaction", rests::rarefaction, false),
    ("cold_start", rests::cold, false),
    ("standing_wave", rests::standing_wave, true),
    ("plane", plane::check, false),
    ("debris", plane::debris, false),
    ("effects", effects::check, false),
    ("scales", invariance::scales, false),
    ("denormals", rests::denormals, false),
];
