//! Strength: the shear stress of a material, in addition to the pressure of its equation of state.
//! One file per model.
//!
//! Hypoelastic and isotropic in the deviator s of the Cauchy stress (Wilkins 1964). s is rotated
//! with the material as in Hughes & Winget (1980) and returned to the yield surface along its
//! normal:
//!
//! ```text
//! s* = R s R^T + 2 G dt dev D        R = (1 - dt/2 W)^-1 (1 + dt/2 W)
//! s  = s* Y/|s*|  where |s*| > Y      |s| = (3/2 s : s)^(1/2)
//! |s*| - 3 G d = Y(ep + d, d/dt)      d: plastic strain of the step
//! ```
//!
//! D and W are the symmetric part and the spin of the velocity gradient at the middle of the step.
//! Pressures are positive in compression, the deviator in tension.
//!
//! Independent of particles, grid and dimension.

pub use johnson_cook::Softening;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::material::{ParameterError, Symmetric};

macro_rules! strength_laws {
    ($($module:ident::$law:ident),* $(,)?) => {
        $(mod $module;)*
        $(pub use $module::$law;)*

        /// Models of strength by type; each is documented by its parameters.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "type", rename_all = "snake_case")]
        pub enum Strength {
            // each is documented by its parameters
            $(#[expect(missing_docs)] $law($law),)*
        }

        impl Strength {
            /// Calls a visitor with the law itself, so that the compiler knows its type.
            pub fn visit<V: StrengthVisitor>(&self, visitor: V) -> V::Output {
                match *self {
                    $(Strength::$law(law) => visitor.visit(law),)*
                }
            }
        }
    };
}

strength_laws! {
    von_mises::VonMises,
    johnson_cook::JohnsonCook,
    steinberg_guinan::SteinbergGuinan,
    zerilli_armstrong::ZerilliArmstrong,
    preston_tonks_wallace::PrestonTonksWallace,
}

/// Visitor of a strength law of any type; see [`Strength::visit`].
pub trait StrengthVisitor {
    /// Result of the visit.
    type Output;

    /// Visits a strength law.
    fn visit<L: StrengthLaw>(self, law: L) -> Self::Output;
}

/// State on which the strength of a material depends, apart from its plastic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialState {
    /// Compression rho/rho0 [-].
    pub compression: f64,
    /// Pressure [Pa].
    pub pressure: f64,
    /// Temperature [K]; NaN if the scene has none.
    pub temperature: f64,
}

/// Strength law at one material point.
pub trait StrengthLaw: Copy + Send + Sync + 'static {
    /// Checks the parameters against each other.
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }

    /// Name of the first parameter that needs the temperature of the material, if one does.
    fn needs_temperature(&self) -> Option<&'static str> {
        None
    }

    /// Temperatures between which the material softens and melts [K], if the law has them.
    fn softening_range(&self) -> Option<[f64; 2]> {
        None
    }

    /// The same law for a material of density `density` at rest [kg/m3].
    fn with_density(self, density: f64) -> Self {
        let _ = density;
        self
    }

    /// Shear modulus G [Pa].
    fn shear_modulus(&self, at: &MaterialState) -> f64;

    /// Yield stress Y [Pa] at the equivalent plastic strain `strain` [-] and its rate `rate` [1/s].
    /// It does not decrease with the rate.
    fn yield_stress(&self, strain: f64, rate: f64, at: &MaterialState) -> f64;
}

/// Velocity gradient L in the plane, and strain rate across it [1/s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// L in the plane by rows: xx, xy, yx, yy [1/s].
    pub plane: [f64; 4],
    /// Strain rate across the plane [1/s]: 0 in plane strain, v_x/x in axisymmetry.
    pub across: f64,
}

/// Deviator and plastic strain after a step, and plastic work of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReturnMapping {
    /// Deviator of the Cauchy stress [Pa].
    pub deviator: Symmetric,
    /// Equivalent plastic strain [-].
    pub plastic_strain: f64,
    /// Plastic work per current volume [J/m3].
    pub plastic_work: f64,
}

/// Equivalent stress (3/2 s : s)^(1/2) of a deviator [Pa].
#[inline(always)]
pub fn equivalent(s: &Symmetric) -> f64 {
    (1.5 * s.double_dot(s)).sqrt()
}

/// `scale` times s.
#[inline(always)]
fn scaled(s: &Symmetric, scale: f64) -> Symmetric {
    Symmetric { xx: scale * s.xx, yy: scale * s.yy, xy: scale * s.xy, zz: scale * s.zz }
}

/// R s R^T with Cayley's rotation R; `half` is dt/2 times the spin W_yx.
#[inline(always)]
fn rotated(s: &Symmetric, half: f64) -> Symmetric {
    let inverse = 1.0 / (1.0 + half * half);
    let (cos, sin) = ((1.0 - half * half) * inverse, 2.0 * half * inverse);
    let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
    Symmetric {
        xx: cc * s.xx - 2.0 * cs * s.xy + ss * s.yy,
        yy: ss * s.xx + 2.0 * cs * s.xy + cc * s.yy,
        xy: cs * (s.xx - s.yy) + (cc - ss) * s.xy,
        zz: s.zz,
    }
}

/// Advances the deviator `s` [Pa] and the plastic strain `strain` [-] by the time `dt` [s] at the
/// velocity gradient `rate` [1/s].
#[inline(always)]
pub fn advance(
    model: &impl StrengthLaw,
    s: &Symmetric,
    strain: f64,
    rate: &Rate,
    dt: f64,
    at: &MaterialState,
) -> ReturnMapping {
    let [xx, xy, yx, yy] = rate.plane;
    let shear = model.shear_modulus(at);
    let mean = (xx + yy + rate.across) / 3.0;
    let step = 2.0 * shear * dt;
    let before = rotated(s, 0.25 * dt * (yx - xy));
    let elastic = Symmetric {
        xx: step * (xx - mean),
        yy: step * (yy - mean),
        xy: step * 0.5 * (xy + yx),
        zz: step * (rate.across - mean),
    };
    let trial = Symmetric {
        xx: before.xx + elastic.xx,
        yy: before.yy + elastic.yy,
        xy: before.xy + elastic.xy,
        zz: before.zz + elastic.zz,
    };
    let size = equivalent(&trial);
    let still = model.yield_stress(strain, 0.0, at);
    // NaN is reported by the pressure or the velocity that caused it
    let yields = size > still && dt > 0.0;
    if !yields {
        return ReturnMapping { deviator: trial, plastic_strain: strain, plastic_work: 0.0 };
    }
    if shear == 0.0 {
        // molten: the shear stress of the solid is lost, without a plastic strain
        let deviator = scaled(&trial, still / size);
        return ReturnMapping { deviator, plastic_strain: strain, plastic_work: 0.0 };
    }
    let yields = |d: f64| model.yield_stress(strain + d, d / dt, at);
    // material that flows mostly keeps flowing: then the whole strain of a step is plastic
    let guess = equivalent(&elastic) / (3.0 * shear);
    let (increment, stress) = plastic_increment(size, still, 3.0 * shear, guess, yields);
    ReturnMapping {
        deviator: scaled(&trial, (stress / size).min(1.0)),
        plastic_strain: strain + increment,
        plastic_work: stress * increment,
    }
}

/// Solves `trial` - `stiffness` d = `yields`(d) for d, and returns d and `yields`(d); `still` is
/// the yield stress at d = 0. Secant method from `guess`, its first step along `stiffness`. False
/// position replaces a step that leaves the bracket, and every eighth step is a bisection. Without
/// hardening the first step finds d; otherwise it mostly takes six yield stresses.
///
/// Rate dependence makes the residual steep at d = 0, where nothing flows. A bracket whose lower
/// end stays there closes slowly, so the last two points must lead.
#[inline(always)]
fn plastic_increment(
    trial: f64,
    still: f64,
    stiffness: f64,
    guess: f64,
    yields: impl Fn(f64) -> f64,
) -> (f64, f64) {
    let enough = 4.0 * f64::EPSILON * trial;
    // no stress falls below zero; the residual at the upper end is not evaluated, its sign is known
    let (mut low, mut over) = (0.0, trial - still);
    let (mut high, mut under) = (trial / stiffness, -still);
    let mut d = guess.min(over / stiffness);
    let mut stress = yields(d);
    let mut left = trial - stiffness * d - stress;
    let mut slope = -stiffness;
    for k in 1..200 {
        // Illinois method: the end that stays counts half
        if left > 0.0 {
            (low, over) = (d, left);
            under *= 0.5;
        } else {
            (high, under) = (d, left);
            over *= 0.5;
        }
        if left.abs() <= enough || high - low <= f64::EPSILON * high {
            break;
        }
        let last = (d, left);
        d -= left / slope;
        if k % 8 == 0 {
            d = 0.5 * (low + high);
        } else if !(low < d && d < high) {
            d = ((low * under - high * over) / (under - over)).clamp(low, high);
        }
        stress = yields(d);
        left = trial - stiffness * d - stress;
        if d != last.0 {
            slope = (left - last.1) / (d - last.0);
        }
    }
    (d, stress)
}

impl Strength {
    /// See [`StrengthLaw::check`].
    ///
    /// # Errors
    ///
    /// The first parameter that does not fit.
    pub fn check(&self) -> Result<(), ParameterError> {
        struct Check;
        impl StrengthVisitor for Check {
            type Output = Result<(), ParameterError>;

            fn visit<L: StrengthLaw>(self, law: L) -> Self::Output {
                law.check()
            }
        }
        self.visit(Check)
    }

    /// See [`StrengthLaw::needs_temperature`].
    pub fn needs_temperature(&self) -> Option<&'static str> {
        struct Needs;
        impl StrengthVisitor for Needs {
            type Output = Option<&'static str>;

            fn visit<L: StrengthLaw>(self, law: L) -> Self::Output {
                law.needs_temperature()
            }
        }
        self.visit(Needs)
    }

    /// Temperatures between which the material softens and melts [K], if the law has them.
    pub fn softening_range(&self) -> Option<[f64; 2]> {
        struct Range;
        impl StrengthVisitor for Range {
            type Output = Option<[f64; 2]>;

            fn visit<L: StrengthLaw>(self, law: L) -> Self::Output {
                law.softening_range()
            }
        }
        self.visit(Range)
    }
}

fn one() -> f64 {
    1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: MaterialState =
        MaterialState { compression: 1.0, pressure: 0.0, temperature: 300.0 };
    const SOFT: VonMises = VonMises { shear_modulus: 28e9, yield_stress: 0.3e9, hardening: 1e9 };
    const STEEL: JohnsonCook = JohnsonCook {
        shear_modulus: 80e9,
        a: 806e6,
        b: 614e6,
        n: 0.168,
        c: 0.0089,
        reference_rate: 1.0,
        softening: None,
    };

    #[test]
    fn a_turn_of_any_size_only_turns_the_deviator() {
        let s = Symmetric { xx: 2.0, yy: -3.0, xy: 0.7, zz: 1.0 };
        // a body that rotates by `angle` in one step has the mid-point gradient 2 tan(angle/2)/dt
        for angle in [1e-3f64, 0.4, 2.0] {
            let w = 2.0 * (0.5 * angle).tan() / 0.1;
            let rate = Rate { plane: [0.0, -w, w, 0.0], across: 0.0 };
            let after = advance(&SOFT, &s, 0.0, &rate, 0.1, &REST).deviator;
            let (sin, cos) = angle.sin_cos();
            let xx = cos * cos * s.xx - 2.0 * cos * sin * s.xy + sin * sin * s.yy;
            let xy = cos * sin * (s.xx - s.yy) + (cos * cos - sin * sin) * s.xy;
            assert!((after.xx - xx).abs() < 1e-14 && (after.xy - xy).abs() < 1e-14);
            assert!((equivalent(&after) / equivalent(&s) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn yield_is_never_exceeded_and_plastic_strain_is_what_the_trial_lacks() {
        let rate = Rate { plane: [-2e5, 4e4, -1e4, 1e5], across: 3e4 };
        let run = |model: &dyn Fn(&Symmetric, f64) -> (ReturnMapping, f64, f64)| {
            let (mut s, mut strain) = (Symmetric::default(), 0.0);
            for _ in 0..100 {
                let (after, limit, trial) = model(&s, strain);
                let size = equivalent(&after.deviator);
                assert!(size <= limit * (1.0 + 1e-12), "{size:e} {limit:e}");
                if after.plastic_strain > strain {
                    assert!((size / limit - 1.0).abs() < 1e-12, "{size:e} {limit:e}");
                    assert!(trial > limit);
                }
                (s, strain) = (after.deviator, after.plastic_strain);
            }
            assert!(strain > 0.05);
        };
        let dt = 1e-8;
        run(&|s, strain| {
            let after = advance(&SOFT, s, strain, &rate, dt, &REST);
            (after, SOFT.yield_stress(after.plastic_strain, 0.0, &REST), f64::INFINITY)
        });
        run(&|s, strain| {
            let after = advance(&STEEL, s, strain, &rate, dt, &REST);
            let speed = (after.plastic_strain - strain) / dt;
            (after, STEEL.yield_stress(after.plastic_strain, speed, &REST), f64::INFINITY)
        });
    }

    #[test]
    fn plastic_work_is_that_of_the_stress_after() {
        let rate = Rate { plane: [-1e6, 0.0, 0.0, 0.0], across: 0.0 };
        let start = advance(&SOFT, &Symmetric::default(), 0.0, &rate, 1e-8, &REST);
        let after = advance(&SOFT, &start.deviator, start.plastic_strain, &rate, 1e-8, &REST);
        let strain = after.plastic_strain - start.plastic_strain;
        let work = SOFT.yield_stress(after.plastic_strain, 0.0, &REST) * strain;
        assert!(strain > 0.0 && (after.plastic_work / work - 1.0).abs() < 1e-12);
    }

    #[test]
    fn uniaxial_strain_ends_two_thirds_of_the_yield_stress_apart() {
        let hard = VonMises { hardening: 0.0, ..SOFT };
        let rate = Rate { plane: [-1e6, 0.0, 0.0, 0.0], across: 0.0 };
        let mut s = Symmetric::default();
        for _ in 0..30 {
            s = advance(&hard, &s, 0.0, &rate, 1e-9, &REST).deviator;
        }
        assert!((s.xx / (-2.0 / 3.0 * 0.3e9) - 1.0).abs() < 1e-14, "{:e}", s.xx);
        assert_eq!(s.yy, s.zz);
        assert!((s.xx + s.yy + s.zz).abs() < 1e-6);
    }

    #[test]
    fn a_melt_bears_no_shear() {
        let melting = JohnsonCook {
            softening: Some(Softening {
                m: 1.0,
                reference_temperature: 300.0,
                melt_temperature: 1000.0,
            }),
            ..STEEL
        };
        let at = MaterialState { temperature: 1200.0, ..REST };
        let rate = Rate { plane: [-1e6, 0.0, 0.0, 0.0], across: 0.0 };
        let after = advance(&melting, &Symmetric::default(), 0.0, &rate, 1e-9, &at);
        assert_eq!(equivalent(&after.deviator), 0.0);
        assert!(after.plastic_work == 0.0 && after.plastic_strain > 0.0);
    }

    /// In Steinberg & Guinan's model, shear modulus and yield stress fall to zero together.
    #[test]
    fn what_melts_loses_the_shear_that_it_bore() {
        let model = steinberg_guinan::COPPER;
        let hot = MaterialState { temperature: 9000.0, ..REST };
        let borne = Symmetric { xx: 1e8, yy: -4e7, xy: 3e7, zz: -6e7 };
        let rate = Rate { plane: [-1e6, 0.0, 2e5, 0.0], across: 0.0 };
        let after = advance(&model, &borne, 0.2, &rate, 1e-9, &hot);
        assert_eq!(equivalent(&after.deviator), 0.0);
        assert_eq!((after.plastic_strain, after.plastic_work), (0.2, 0.0));
    }

    #[test]
    fn plastic_increments_are_found_to_rounding() {
        // a steep start and a long range, from distant guesses
        for (trial, n) in [(1.0001e9, 0.02), (5e9, 0.168), (1.2e9, 0.9), (8e11, 0.3)] {
            for guess in [0.0, 1e-9, 1e-4, 1e9] {
                let yields = |d: f64| 1e9 + 6e8 * d.powf(n);
                let (d, stress) = plastic_increment(trial, 1e9, 240e9, guess, yields);
                assert_eq!(stress, yields(d));
                let left = trial - 240e9 * d - yields(d);
                assert!(left.abs() <= 1e-12 * trial, "{trial:e} {n} {guess:e}: {left:e}");
            }
        }
        // a yield stress that falls faster than the material unloads
        let yields = |d: f64| 1e9 * (1.0 - 1e4 * d).max(0.1);
        let (d, stress) = plastic_increment(1.1e9, 1e9, 240e9, 1e-6, yields);
        assert!((1.1e9 - 240e9 * d - stress).abs() <= 1e-3 && stress == yields(d));
    }

    #[test]
    fn a_rate_that_counts_costs_few_yield_stresses() {
        let calls = std::cell::Cell::new(0);
        let (dt, mut worst) = (1e-8, 0);
        for rate in [1e2, 1e3, 1e4, 1e5] {
            for strain in [1e-3, 0.03, 1.0] {
                let flow = |d: f64| STEEL.yield_stress(strain + d, d / dt, &REST);
                let (still, old) = (STEEL.yield_stress(strain, 0.0, &REST), flow(rate * dt));
                let trial = 0.9999 * old + 3.0 * 80e9 * rate * dt;
                calls.set(0);
                let yields = |d: f64| {
                    calls.set(calls.get() + 1);
                    flow(d)
                };
                let (d, stress) = plastic_increment(trial, still, 240e9, rate * dt, yields);
                assert!((trial - 240e9 * d - stress).abs() <= 1e-12 * trial);
                worst = worst.max(calls.get());
            }
        }
        assert!(worst <= 12, "{worst}");
    }
}
