//! Greatest values that a run has reached, against what the scene's impacts and detonations can
//! bring. They end no run: the run warns of them at its end.

use serde::{Deserialize, Serialize};

/// Heat of a particle over that of the strongest shock of its body, beyond which a run warns [-].
/// The start of a plane impact heats the particles at its interface to 2.1 times that heat.
const HOT: f64 = 3.0;

/// Pressure at a burning front over the Chapman-Jouguet pressure, beyond which a run warns [-].
const FRONT: f64 = 1.15;

/// Speed ahead of a burning front over the velocity behind it, beyond which a run warns [-].
const AHEAD: f64 = 0.1;

/// Greatest values so far, over those that the scene explains [-]; the temperature in K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Peaks {
    /// Specific internal energy above that of the start, over the energy that the strongest impact
    /// of the body gives by one shock.
    pub heat: f64,
    /// The energy of that particle above that of the start [J/kg].
    pub energy: f64,
    /// Pressure just behind a burning front, over the Chapman-Jouguet pressure.
    pub front: f64,
    /// Speed of unburnt explosive against its body, over the Chapman-Jouguet velocity.
    pub ahead: f64,
    /// Least temperature below absolute zero, with the other sign [K].
    pub frozen: f64,
}

impl Peaks {
    /// The values, for a reduction over ranks.
    pub fn values(&self) -> [f64; 5] {
        [self.heat, self.energy, self.front, self.ahead, self.frozen]
    }

    /// From [`Peaks::values`].
    pub fn of([heat, energy, front, ahead, frozen]: [f64; 5]) -> Peaks {
        Peaks { heat, energy, front, ahead, frozen }
    }

    /// The greater of each value of both. What is not a number counts as nothing.
    pub fn max(&self, other: &Peaks) -> Peaks {
        let (a, b) = (self.values(), other.values());
        Peaks::of(std::array::from_fn(|k| a[k].max(b[k])))
    }

    /// What a run says of them at its end, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.heat > HOT {
            all.push(format!(
                "particles have been heated far beyond the Hugoniot: up to {:.3e} J/kg, {:.1} \
                 times the energy that one shock of the scene's strongest impact gives. The edge \
                 of a growing contact and jets heat so in nature (Lesser 1981); the start of an \
                 impact and schemes that ring add to it. Look where these particles are before \
                 their temperature is used",
                self.energy, self.heat
            ));
        }
        if self.front > FRONT {
            all.push(format!(
                "the pressure just behind a burning front has reached {:.2} times the \
                 Chapman-Jouguet pressure: where no other body reflects it or drives it, the \
                 front is not stable; method.transfer {{\"fmpm\": 2}} or \"flip\" is",
                self.front
            ));
        }
        if self.ahead > AHEAD {
            all.push(format!(
                "unburnt explosive has moved at {:.2} of the velocity behind the front, ahead of \
                 which nothing moves it: the front is not stable; method.transfer {{\"fmpm\": 2}} \
                 or \"flip\" is",
                self.ahead
            ));
        }
        if self.frozen > 0.0 {
            all.push(format!(
                "particles have been colder than absolute zero, down to -{:.3e} K: more \
                 artificial_viscosity or finer cells, and no use of their temperature",
                self.frozen
            ));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_value_past_its_bound_is_one_line() {
        let sound = Peaks { heat: HOT, energy: 1e6, front: FRONT, ahead: AHEAD, frozen: 0.0 };
        assert_eq!(sound.warnings(), Vec::<String>::new());
        for k in [0, 2, 3, 4] {
            let mut values = sound.values();
            values[k] += 0.01;
            let warnings = Peaks::of(values).warnings();
            assert!(warnings.len() == 1 && warnings[0].lines().count() == 1, "{warnings:?}");
        }
    }

    #[test]
    fn the_greater_of_each_is_kept() {
        let a = Peaks::of([1.0, 2.0, 3.0, f64::NAN, 5.0]);
        let b = Peaks::of([2.0, 1.0, f64::NAN, 3.0, 4.0]);
        assert_eq!(a.max(&b), Peaks::of([2.0, 2.0, 3.0, 3.0, 5.0]));
    }
}
