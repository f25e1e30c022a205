//! The bounds of `bounds.toml`: one module per group, in it one per section.

pub use crate::bound::{Bound, Unit};

include!(concat!(env!("OUT_DIR"), "/bounds.rs"));

impl Bound {
    /// The number of the bound, in its unit.
    pub const fn number(self) -> f64 {
        match (self.at_most, self.at_least) {
            (Some(number), _) | (None, Some(number)) => number,
            (None, None) => f64::NAN,
        }
    }

    /// Whether `value` is within the bound; one that is undefined is not.
    pub fn holds(self, value: Option<f64>) -> bool {
        value.is_some_and(|v| {
            self.at_most.is_none_or(|most| v.abs() <= most)
                && self.at_least.is_none_or(|least| v >= least)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: Bound = Bound { at_most: Some(2.0), at_least: None, unit: Unit::One };
    const LEAST: Bound = Bound { at_most: None, at_least: Some(2.0), unit: Unit::One };

    #[test]
    fn a_bound_holds_up_to_its_number() {
        assert!(MOST.holds(Some(2.0)) && MOST.holds(Some(-2.0)));
        assert!(!MOST.holds(Some(2.1)) && !MOST.holds(Some(-2.1)));
        assert!(LEAST.holds(Some(2.0)) && !LEAST.holds(Some(1.9)) && !LEAST.holds(Some(-3.0)));
    }

    #[test]
    fn an_undefined_figure_misses_its_bound() {
        for bound in [MOST, LEAST] {
            assert!(!bound.holds(None) && !bound.holds(Some(f64::NAN)));
        }
    }

    #[test]
    fn the_table_has_the_numbers_of_the_file() {
        let file: Bound = super::flyer::profiles::ENERGY_DRIFT;
        assert_eq!((file.number(), file.unit), (1e-12, Unit::One));
    }
}
