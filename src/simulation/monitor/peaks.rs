//! Peak values of a run relative to the values that impacts and detonations of the scene can
//! explain. They stop no run: the run prints warnings at its end.

use serde::{Deserialize, Serialize};

/// Ratio of a particle's heat to that of the strongest shock of its body above which the run warns
/// [-]. The start of a plane impact heats the particles at its interface to 2.1 times that heat.
const HOT: f64 = 3.0;

/// Ratio of the pressure at a detonation front to the Chapman-Jouguet pressure above which the run
/// warns [-].
const FRONT: f64 = 1.15;

/// Ratio of the speed ahead of a detonation front to the velocity behind it above which the run
/// warns [-].
const AHEAD: f64 = 0.1;

/// Tension, and velocity against the wave, ahead of the first wave, over the pressure and velocity
/// of the strongest impact: the run warns above this ratio [-]. Shipped scenes reach 0.10, the
/// standard problem without viscosity 0.21.
const RINGS: f64 = 0.15;

/// Peak values so far, relative to the values that the scene explains [-]; the temperature in K.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Peaks {
    /// Increase of specific internal energy since the start, less elastic energy, heat of friction,
    /// plastic work and the elastic energy that failure released, over the energy from one shock in
    /// the body that the impacts heat most [-].
    pub heat: f64,
    /// Increase of specific internal energy of that particle since the start [J/kg].
    pub energy: f64,
    /// Pressure just behind a detonation front, over the Chapman-Jouguet pressure [-].
    pub front: f64,
    /// Speed of unburnt explosive relative to its body, over the Chapman-Jouguet velocity [-].
    pub ahead: f64,
    /// Lowest temperature below absolute zero, with opposite sign [K].
    pub frozen: f64,
    /// Tension of particles that no wave has reached yet, over rho c up of the strongest impact of
    /// the body [-].
    pub tension: f64,
    /// Speed of such particles against the approaching wave, over the particle velocity up of that
    /// impact [-].
    pub against: f64,
}

impl Peaks {
    /// Values of the fields in order, each in its own unit, for a reduction over ranks.
    pub fn values(&self) -> [f64; 7] {
        let Peaks { heat, energy, front, ahead, frozen, tension, against } = *self;
        [heat, energy, front, ahead, frozen, tension, against]
    }

    /// Inverse of [`Peaks::values`].
    pub fn of([heat, energy, front, ahead, frozen, tension, against]: [f64; 7]) -> Peaks {
        Peaks { heat, energy, front, ahead, frozen, tension, against }
    }

    /// The greater value of each pair; NaN is ignored.
    pub fn max(&self, other: &Peaks) -> Peaks {
        let (a, b) = (self.values(), other.values());
        Peaks::of(std::array::from_fn(|k| a[k].max(b[k])))
    }

    /// Warnings at the end of a run, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.heat > HOT {
            all.push(format!(
                "some particles are hotter than one shock can make them: they have gained up to \
                 {:.3e} J/kg, without elastic energy, friction, plastic work and failure up to \
                 {:.1} times the energy of one shock of the strongest impact. Most such particles are at the \
                 interface of an impact, above all at the edge of a growing contact. There a part \
                 of the heat is real (Lesser 1981) and a part is an error of the method. Do not use \
                 their temperature. If the method has no heat_spreading, use it. To see whether \
                 other results depend on the heat, compare with a run with --set \
                 heat_mixing.coefficient=20",
                self.energy, self.heat
            ));
        }
        if self.front > FRONT {
            all.push(format!(
                "the pressure just behind a burning front has reached {:.2} times the \
                 Chapman-Jouguet pressure. If no other body reflects or drives the front, it is \
                 not stable. Use method.transfer {{\"fmpm\": 2}} or \"flip\"",
                self.front
            ));
        }
        if self.ahead > AHEAD {
            all.push(format!(
                "unburnt explosive has moved ahead of the front, at {:.2} of the velocity behind \
                 it. The front is not stable. Use method.transfer {{\"fmpm\": 2}} or \"flip\"",
                self.ahead
            ));
        }
        if self.frozen > 0.0 {
            all.push(format!(
                "particles have been colder than absolute zero, down to -{:.3e} K. Use \
                 more artificial_viscosity or finer cells, and do not use their temperature",
                self.frozen
            ));
        }
        if self.tension > RINGS || self.against > RINGS {
            all.push(format!(
                "particles ahead of the first wave, where nothing can have moved them yet, have \
                 been in tension up to {:.2} of the pressure of the strongest impact and have moved \
                 against the wave at up to {:.2} of its velocity. The scheme oscillates ahead of \
                 the shock. Use more artificial_viscosity, mainly a larger linear term, or \
                 method.transfer {{\"fmpm\": 2}}",
                self.tension, self.against
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
        let sound = Peaks {
            heat: HOT,
            energy: 1e6,
            front: FRONT,
            ahead: AHEAD,
            frozen: 0.0,
            tension: RINGS,
            against: RINGS,
        };
        assert_eq!(sound.warnings(), Vec::<String>::new());
        for k in [0, 2, 3, 4, 5, 6] {
            let mut values = sound.values();
            values[k] += 0.01;
            let warnings = Peaks::of(values).warnings();
            assert!(warnings.len() == 1 && warnings[0].lines().count() == 1, "{warnings:?}");
        }
    }

    #[test]
    fn the_greater_of_each_is_kept() {
        let a = Peaks::of([1.0, 2.0, 3.0, f64::NAN, 5.0, 0.0, 7.0]);
        let b = Peaks::of([2.0, 1.0, f64::NAN, 3.0, 4.0, 6.0, f64::NAN]);
        assert_eq!(a.max(&b), Peaks::of([2.0, 2.0, 3.0, 3.0, 5.0, 6.0, 7.0]));
    }
}
