//! Detonation products with the equation of state of Jones, Wilkins and Lee.
//!
//! V = v/v0 = J, and E0 is the energy of detonation per initial volume, which the material carries
//! from the start, e = E0/rho0:
//!
//! ```text
//! p = A (1 - w/(R1 V)) exp(-R1 V) + B (1 - w/(R2 V)) exp(-R2 V) + w rho0 e/V
//! ```
//!
//! Source: Lee, Hornig & Kury (1968), UCRL-50422; Dobratz & Crawford (1985), LLNL Explosives
//! Handbook, UCRL-52997. [`Jwl::detonation`] is the Chapman-Jouguet state, where the Rayleigh line
//! touches the Hugoniot of the products, so that D^2 = v0^2 p/(v0 - v) is smallest.
//!
//! Programmed burn ([`Burning`]) multiplies the pressure by the burnt fraction F: p = F p_jwl,
//! Wilkins (1999), Computer Simulation of Dynamic Phenomena, section 5. The material ahead of the
//! front has no stiffness: it should not be struck before it burns. Its sound speed is at
//! least the detonation velocity until it is fully burnt, so that no time step overtakes the front.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    Eos, EosContext, EosParameters, EosPoint, EosVisitor, EquationOfState, HistoryEos,
    LinearPressure, Made, PlainEosVisitor,
};
use crate::material::ParameterError;

/// Detonation products of an explosive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jwl {
    /// Density of the explosive [kg/m3].
    pub rho0: f64,
    /// A [Pa].
    pub a: f64,
    /// B [Pa].
    pub b: f64,
    /// R1 [-].
    pub r1: f64,
    /// R2 [-].
    pub r2: f64,
    /// Omega, the Grueneisen coefficient of the products [-].
    pub omega: f64,
    /// Energy of detonation per initial volume E0 [J/m3].
    pub energy: f64,
}

/// Self-sustained detonation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detonation {
    /// Detonation velocity D [m/s].
    pub speed: f64,
    /// Pressure behind the front [Pa].
    pub pressure: f64,
    /// Volume ratio behind the front [-].
    pub jacobian: f64,
    /// Specific internal energy behind the front [J/kg].
    pub energy: f64,
}

impl Jwl {
    /// Initial specific internal energy, E0/rho0 [J/kg].
    pub fn first_energy(&self) -> f64 {
        self.energy / self.rho0
    }

    /// Pressure without its energy part, and its derivative by V [Pa].
    #[inline(always)]
    fn cold(&self, v: f64) -> [f64; 2] {
        let term = |a: f64, r: f64| {
            let (exp, share) = (a * (-r * v).exp(), self.omega / (r * v));
            [exp * (1.0 - share), exp * (share / v - r * (1.0 - share))]
        };
        let ([p, dp], [q, dq]) = (term(self.a, self.r1), term(self.b, self.r2));
        [p + q, dp + dq]
    }

    /// Pressure of the products on their Hugoniot, from the unburnt explosive at p = 0 [Pa].
    fn hugoniot(&self, v: f64) -> f64 {
        let [cold, _] = self.cold(v);
        (cold + self.omega * self.energy / v) / (1.0 - 0.5 * self.omega * (1.0 - v) / v)
    }

    /// Chapman-Jouguet state, by golden-section search on p/(1 - V); V is between 1/2 and 1.
    pub fn detonation(&self) -> Detonation {
        let rate = |v: f64| self.hugoniot(v) / (1.0 - v);
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut low, mut high) = (0.5, 0.999);
        while high - low > 1e-9 {
            let (a, b) = (high - golden * (high - low), low + golden * (high - low));
            if rate(a) < rate(b) {
                high = b;
            } else {
                low = a;
            }
        }
        let v = 0.5 * (low + high);
        let p = self.hugoniot(v);
        Detonation {
            speed: (rate(v) / self.rho0).sqrt(),
            pressure: p,
            jacobian: v,
            energy: self.first_energy() + 0.5 * p * (1.0 - v) / self.rho0,
        }
    }
}

impl EquationOfState for Jwl {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    #[inline(always)]
    fn linear(&self, jacobian: f64) -> LinearPressure {
        let [cold, _] = self.cold(jacobian);
        LinearPressure {
            reference_pressure: cold,
            gruneisen_rho: self.omega * self.rho0 / jacobian,
        }
    }

    #[inline(always)]
    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        let v = jacobian;
        let [cold, slope] = self.cold(v);
        // w rho0 e/V = p - cold
        v * v / self.rho0 * ((pressure - cold) / v + self.omega * pressure / v - slope)
    }

    #[inline(always)]
    fn check_validity(&self, _jacobian: f64, pressure: f64) -> Option<&'static str> {
        (pressure < 0.0).then_some("products of an explosive under tension, which they cannot bear")
    }

    fn energy_at(&self, _jacobian: f64, _pressure: f64) -> f64 {
        self.first_energy()
    }
}

/// Explosive under programmed burn; its history variable is the burnt fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burning {
    /// Detonation products.
    pub products: Jwl,
    /// Speed of the burn front [m/s].
    pub detonation_velocity: f64,
}

impl HistoryEos for Burning {
    fn reference_density(&self) -> f64 {
        self.products.rho0
    }

    #[inline(always)]
    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64) {
        let LinearPressure { reference_pressure: cold, gruneisen_rho } =
            self.products.linear(jacobian);
        let whole = cold + gruneisen_rho * energy;
        let c2 = self.products.sound_speed_squared(jacobian, whole);
        // for p = F p_jwl: the work on the material is the fraction F of the work on the products
        let share = gruneisen_rho * whole / self.products.rho0;
        let c2 =
            history * (c2 - (1.0 - history) * jacobian * jacobian / self.products.rho0 * share);
        let ahead = self.detonation_velocity * self.detonation_velocity;
        let point = EosPoint {
            pressure: history * whole,
            energy_slope: history * gruneisen_rho,
            sound_speed_squared: if history < 1.0 { c2.max(ahead) } else { c2 },
        };
        (point, history)
    }

    fn first_history(&self) -> Option<f64> {
        Some(0.0)
    }

    fn check_validity(
        &self,
        jacobian: f64,
        _: f64,
        history: f64,
        pressure: f64,
    ) -> Option<&'static str> {
        if history > 0.0 {
            EquationOfState::check_validity(&self.products, jacobian, pressure)
        } else {
            None
        }
    }

    fn energy_at(&self, _pressure: f64) -> f64 {
        self.products.first_energy()
    }
}

/// Detonation products with the equation of state of Jones, Wilkins and Lee, p = A (1 - omega/(R1
/// V)) exp(-R1 V) + B (1 - omega/(R2 V)) exp(-R2 V) + omega rho0 e/V with the volume ratio V; the
/// density is that of the explosive.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JwlParameters {
    /// Coefficient A of the first exponential term, which gives most of the pressure near the
    /// initial volume [Pa].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub a: f64,
    /// Coefficient B of the second exponential term, which acts at medium expansion [Pa].
    pub b: f64,
    /// Exponent R1 of the first term [-]. With a larger value this term fades at a smaller
    /// expansion.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub r1: f64,
    /// Exponent R2 of the second term [-], usually smaller than R1. With a larger value this term
    /// fades at a smaller expansion.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub r2: f64,
    /// Grueneisen coefficient omega of the products [-]: the pressure of strongly expanded products
    /// is omega rho e. A larger value gives more pressure per energy.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub omega: f64,
    /// Energy of detonation E0 per initial volume of the explosive [J/m3]. A larger value gives
    /// more pressure at every volume.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub energy: f64,
    /// Way in which the explosive burns: `"complete"` before the start, or a burn front.
    pub burn: Burn,
}

/// How an explosive burns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Burn {
    /// A front that passes through the explosive.
    Front(BurnFront),
    /// The whole explosive at once.
    Whole(BurnWhole),
}

/// Burn of an explosive without a front.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BurnWhole {
    /// The whole explosive is burnt before the start.
    Complete,
}

/// Burn front that starts from points or from a plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnFront {
    /// Points from which the front spreads [m]; each particle is ignited from the nearest one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub points: Option<Vec<Vec<f64>>>,
    /// Plane from which the front starts, to both sides, instead of points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<BurnPlane>,
    /// Speed of the front through the explosive in its initial position [m/s].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub detonation_velocity: f64,
    /// Length behind the front over which the burnt fraction grows from 0 to 1 [m].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub width: f64,
    /// Time at which the front starts [s]; default 0.
    #[serde(default)]
    #[schemars(extend("minimum" = 0.0))]
    pub start: f64,
    /// Whether compression burns the explosive too: the burnt fraction is then at least (1 - V)/(1
    /// - V_CJ), with the volume ratio V and that of the Chapman-Jouguet state; default false.
    #[serde(default)]
    pub compression: bool,
}

/// Plane from which a burn front starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurnPlane {
    /// Coordinates of any point of the plane [m].
    pub point: Vec<f64>,
    /// Normal of the plane, of any length.
    pub normal: Vec<f64>,
}

impl Burn {
    /// Burn front; `None` if the explosive is fully burnt before the start.
    pub fn front(&self) -> Option<&BurnFront> {
        if let Burn::Front(front) = self { Some(front) } else { None }
    }
}

impl BurnFront {
    /// Checks the points or the plane of the front in a scene of `dimension` dimensions.
    fn check(&self, dimension: usize) -> Result<(), ParameterError> {
        let in_space = |key: String, values: &[f64]| super::check_length(key, values, dimension);
        match (&self.points, &self.plane) {
            (Some(points), None) => points
                .iter()
                .enumerate()
                .try_for_each(|(i, point)| in_space(format!("burn.points[{i}]"), point)),
            (None, Some(plane)) => {
                in_space("burn.plane.point".into(), &plane.point)?;
                in_space("burn.plane.normal".into(), &plane.normal)?;
                if plane.normal.iter().all(|n| *n == 0.0) {
                    let reason = "has no direction; allowed: a vector that is not zero";
                    return Err(ParameterError::new("burn.plane.normal", &plane.normal, reason));
                }
                Ok(())
            }
            (Some(_), Some(_)) => {
                let reason = "beside burn.points; allowed: one of them";
                Err(ParameterError::new("burn.plane", true, reason))
            }
            (None, None) => {
                let reason = "missing key; allowed: where it starts, \"points\" or \"plane\"";
                Err(ParameterError::missing("burn.points", reason))
            }
        }
    }
}

impl JwlParameters {
    fn products(&self, rho0: f64) -> Jwl {
        let &JwlParameters { a, b, r1, r2, omega, energy, .. } = self;
        Jwl { rho0, a, b, r1, r2, omega, energy }
    }
}

impl EosParameters for JwlParameters {
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        self.burn.front().map_or(Ok(()), |front| front.check(at.dimension))
    }

    fn no_initial_pressure(&self) -> Option<&'static str> {
        Some("an explosive starts with its own energy")
    }

    fn has_history(&self) -> bool {
        self.burn.front().is_some()
    }

    fn visit<V: EosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let Some(front) = self.burn.front() else { return self.visit_plain(rho0, visitor) };
        let detonation_velocity = front.detonation_velocity;
        let products = self.products(rho0);
        Ok(Some(visitor.history(Burning { products, detonation_velocity })))
    }

    fn visit_plain<V: PlainEosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        match self.burn {
            Burn::Front(_) => Ok(None),
            Burn::Whole(_) => Ok(Some(visitor.linear(self.products(rho0)))),
        }
    }
}

impl Eos {
    /// Burn of an explosive; `None` for other materials.
    pub fn burn(&self) -> Option<&Burn> {
        if let Eos::Jwl(explosive) = self { Some(&explosive.burn) } else { None }
    }

    /// Detonation products of an explosive of density `rho0` [kg/m3]; `None` for other materials.
    pub fn products(&self, rho0: f64) -> Option<Jwl> {
        if let Eos::Jwl(explosive) = self { Some(explosive.products(rho0)) } else { None }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::general::tests::check_derivatives;
    use super::*;

    /// TNT: Dobratz & Crawford (1985).
    pub const TNT: Jwl = Jwl {
        rho0: 1630.0,
        a: 371.2e9,
        b: 3.231e9,
        r1: 4.15,
        r2: 0.95,
        omega: 0.30,
        energy: 7.0e9,
    };

    #[test]
    fn derivatives() {
        let e = TNT.first_energy();
        let states =
            [[0.6, 1.2 * e, 0.0], [1.0, e, 0.0], [3.0, 0.5 * e, 0.0], [20.0, 0.2 * e, 0.0]];
        check_derivatives(&TNT, &states, 1e-6);
        let burning = Burning { products: TNT, detonation_velocity: 1.0 };
        let burnt = states.map(|[j, e, _]| [[j, e, 0.3], [j, e, 1.0]]);
        check_derivatives(&burning, burnt.as_flattened(), 1e-6);
    }

    #[test]
    fn tnt_detonates_as_its_handbook_says() {
        // D = 6930 m/s, 21 GPa
        let cj = TNT.detonation();
        assert!((cj.speed / 6930.0 - 1.0).abs() < 5e-3, "{cj:?}");
        assert!((cj.pressure / 21e9 - 1.0).abs() < 1e-2, "{cj:?}");
        // the front moves at the speed of sound behind it, relative to the products
        let c = TNT.sound_speed_squared(cj.jacobian, cj.pressure).sqrt();
        assert!((c / (cj.speed * cj.jacobian) - 1.0).abs() < 1e-4, "{c} {cj:?}");
        assert!((TNT.pressure(cj.jacobian, cj.energy) / cj.pressure - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_isentrope_has_its_closed_form() {
        // p_s = A exp(-R1 V) + B exp(-R2 V) + C V^-(1 + w)
        let form = |c: f64, v: f64| {
            TNT.a * (-TNT.r1 * v).exp() + TNT.b * (-TNT.r2 * v).exp() + c * v.powf(-1.0 - TNT.omega)
        };
        let start = TNT.pressure(1.0, TNT.first_energy());
        let c = start - form(0.0, 1.0);
        let (mut v, mut e, n) = (1.0, TNT.first_energy(), 20000);
        for _ in 0..n {
            let dv = 4.0 / f64::from(n);
            let p = TNT.pressure(v, e);
            e -= TNT.pressure(v + 0.5 * dv, e - 0.5 * p * dv / 1630.0) * dv / 1630.0;
            v += dv;
        }
        assert!((TNT.pressure(v, e) / form(c, v) - 1.0).abs() < 1e-6);
    }
}
