//! Porous solid: the p-alpha model.
//!
//! A solid with any equation of state p_solid(v, e) that contains pores. The distension alpha = v/v_solid
//! measures them. With density rho00 at rest, alpha0 = rho_s0/rho00 and V = J:
//!
//! ```text
//! p = p_solid(v/alpha, e)/alpha                              (Carroll & Holt 1972, eq. 1)
//! crushing:  alpha = 1 + (alpha0 - 1) ((p_s - p)/(p_s - p_e))^2,  p_e <= p <= p_s
//! else:      alpha stays                                       (Herrmann 1969, eq. 6)
//! ```
//!
//! Pores close while the pressure at the current alpha would exceed the crush curve, and they never
//! open again; at p_s all are closed. In the elastic range alpha is constant (Herrmann's h = 1), so
//! that material that is not yet crushed has the sound speed of its solid at every alpha. Pores
//! hold no gas. The porous material carries tension as its solid does.
//!
//! Sources: Herrmann (1969), J. Appl. Phys. 40, 2490; Carroll & Holt (1972), J. Appl. Phys. 43,
//! 1626.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use serde_json::json;

use super::bracket::{Bracket, MOST_STEPS};
use super::{
    Eos, EosContext, EosParameters, EosPoint, EosVisitor, EquationOfState, GeneralEos, HistoryEos,
    Made, PlainEosVisitor,
};
use crate::material::ParameterError;

/// Porous solid; its history variable is the distension alpha [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Porous<E> {
    /// Solid without pores, with density rho_s0 at J = 1.
    pub solid: E,
    /// Initial distension alpha0 [-], above 1.
    pub distension: f64,
    /// Pressure p_e at which pores begin to close [Pa].
    pub elastic_pressure: f64,
    /// Pressure p_s at which all pores are closed [Pa].
    pub full_compaction_pressure: f64,
}

impl<E: GeneralEos> Porous<E> {
    /// State of the mixture at the distension `alpha`, and dp/dalpha at fixed J and e [Pa].
    #[inline(always)]
    fn elastic_branch(&self, jacobian: f64, energy: f64, alpha: f64) -> (EosPoint, f64) {
        let j = jacobian * self.distension / alpha;
        let solid = self.solid.at(j, energy);
        let slope = solid.volume_slope(self.solid.reference_density(), j);
        let point = EosPoint {
            pressure: solid.pressure / alpha,
            energy_slope: solid.energy_slope / alpha,
            sound_speed_squared: solid.sound_speed_squared,
        };
        (point, -(slope * j + solid.pressure) / (alpha * alpha))
    }

    /// Pressure on the crush curve, linear in r = sqrt((alpha - 1)/(alpha0 - 1)) [Pa].
    #[inline(always)]
    fn compaction(&self, r: f64) -> f64 {
        self.full_compaction_pressure - (self.full_compaction_pressure - self.elastic_pressure) * r
    }

    /// Pressure at which material of this distension begins to crush [Pa].
    pub fn crushing_pressure(&self, alpha: f64) -> f64 {
        self.compaction(((alpha - 1.0) / (self.distension - 1.0)).sqrt())
    }
}

impl<E: GeneralEos> HistoryEos for Porous<E> {
    fn reference_density(&self) -> f64 {
        self.solid.reference_density() / self.distension
    }

    fn at(&self, jacobian: f64, energy: f64, history: f64) -> (EosPoint, f64) {
        let (held, _) = self.elastic_branch(jacobian, energy, history);
        let pores = self.distension - 1.0;
        let most = ((history - 1.0).max(0.0) / pores).sqrt();
        // a comparison with NaN is false
        let crushes = history > 1.0 && held.pressure > self.compaction(most);
        if !crushes {
            return (held, history);
        }
        let (closed, _) = self.elastic_branch(jacobian, energy, 1.0);
        if closed.pressure >= self.full_compaction_pressure {
            return (closed, 1.0);
        }
        // p(alpha(r)) - compaction(r) grows with r from below zero to above it
        let range = self.full_compaction_pressure - self.elastic_pressure;
        let (mut bracket, mut r) = (Bracket { ends: [0.0, most] }, most);
        let mut now = (held, 0.0);
        let mut slope = 0.0;
        for _ in 0..MOST_STEPS {
            let alpha = 1.0 + pores * r * r;
            let (point, by_alpha) = self.elastic_branch(jacobian, energy, alpha);
            slope = 2.0 * pores * r * by_alpha + range;
            let rest = point.pressure - self.compaction(r);
            now = (point, alpha);
            let next = bracket.next(r, rest, slope);
            if rest == 0.0 || (next - r).abs() <= f64::EPSILON * r {
                break;
            }
            r = next;
        }
        let (mut point, alpha) = now;
        // along the curve dp/de = range dp_held/de / (dp_held/dr + range)
        point.energy_slope *= range / slope;
        (point, alpha)
    }

    fn first_history(&self) -> Option<f64> {
        Some(self.distension)
    }

    fn check_validity(
        &self,
        jacobian: f64,
        energy: f64,
        alpha: f64,
        p: f64,
    ) -> Option<&'static str> {
        self.solid.check_validity(jacobian * self.distension / alpha, energy, p * alpha)
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        self.solid.energy_at(pressure * self.distension)
    }
}

/// Porous solid that crushes (p-alpha model); the density includes the pores.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PAlphaParameters {
    /// Equation of state of the solid without pores.
    pub solid: Box<Eos>,
    /// Density of the solid without pores at rest [kg/m3], above the material's density.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub solid_density: f64,
    /// Pressure at which the pores begin to close [Pa]. Below it the material is elastic; a larger
    /// value gives a stronger elastic precursor.
    #[schemars(extend("minimum" = 0.0))]
    pub elastic_pressure: f64,
    /// Pressure at which all pores are closed [Pa], above `elastic_pressure`. With a larger value
    /// the pores close more gradually.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub full_compaction_pressure: f64,
}

impl EosParameters for PAlphaParameters {
    fn check(&self, at: &EosContext) -> Result<(), ParameterError> {
        let solid_density = self.solid_density;
        if solid_density <= at.density {
            let density = json!(at.density);
            let reason = format!(
                "allowed: above the material's density = {density}, which is that with pores"
            );
            return Err(ParameterError::new("solid_density", solid_density, reason));
        }
        if self.full_compaction_pressure <= self.elastic_pressure {
            let elastic = json!(self.elastic_pressure);
            let reason = format!("allowed: above elastic_pressure = {elastic}");
            let key = "full_compaction_pressure";
            return Err(ParameterError::new(key, self.full_compaction_pressure, reason));
        }
        let solid_type = || json!(self.solid)["type"].clone();
        if self.solid.is_solid() || matches!(*self.solid, Eos::Jwl(_) | Eos::PAlpha(_)) {
            let reason = "no solid that pores are in; allowed: \"mie_gruneisen\", \"tillotson\", \
                          \"tabular\" or another equation of state of one state";
            return Err(ParameterError::new("solid.type", solid_type(), reason));
        }
        if self.solid.is_gas() {
            let reason = "a gas has no pores; allowed: \"mie_gruneisen\", \"tillotson\", \
                          \"tabular\" or another equation of state that supports tension";
            return Err(ParameterError::new("solid.type", solid_type(), reason));
        }
        self.solid
            .check(&EosContext { density: solid_density, ..*at })
            .map_err(|e| e.below("solid"))
    }

    fn check_initial_pressure(&self, _density: f64, pressure: f64) -> Result<(), String> {
        if pressure > self.elastic_pressure {
            let elastic = json!(self.elastic_pressure);
            return Err(format!(
                "a porous body starts uncrushed; allowed: at most eos.elastic_pressure = {elastic}"
            ));
        }
        Ok(())
    }

    fn has_history(&self) -> bool {
        true
    }

    fn visit<V: EosVisitor>(&self, rho0: f64, visitor: V) -> Made<V> {
        let (parameters, distension) = (self, self.solid_density / rho0);
        self.solid.visit_plain(self.solid_density, WithPores { visitor, parameters, distension })
    }
}

/// Visitor that adds pores to a solid.
struct WithPores<'a, V> {
    visitor: V,
    parameters: &'a PAlphaParameters,
    distension: f64,
}

impl<V: EosVisitor> WithPores<'_, V> {
    fn over<E: GeneralEos>(self, solid: E) -> V::Output {
        let &PAlphaParameters { elastic_pressure, full_compaction_pressure, .. } = self.parameters;
        let distension = self.distension;
        self.visitor.history(Porous {
            solid,
            distension,
            elastic_pressure,
            full_compaction_pressure,
        })
    }
}

impl<V: EosVisitor> PlainEosVisitor for WithPores<'_, V> {
    type Output = V::Output;

    fn linear<E: EquationOfState>(self, eos: E) -> Self::Output {
        self.over(eos)
    }

    fn general<E: GeneralEos>(self, eos: E) -> Self::Output {
        self.over(eos)
    }
}

impl Eos {
    /// Initial distension v/v_solid of a material of density `rho0` [-]: 1 for all but porous
    /// solids.
    pub fn distension(&self, rho0: f64) -> f64 {
        if let Eos::PAlpha(pores) = self { pores.solid_density / rho0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::general::tests::check_derivatives;
    use super::super::tillotson::tests::ALUMINIUM as TILLOTSON;
    use super::super::{EquationOfState, MieGruneisen};
    use super::*;

    const SOLID: MieGruneisen = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };

    const COPPER: Porous<MieGruneisen> = Porous {
        solid: SOLID,
        distension: 1.25,
        elastic_pressure: 0.1e9,
        full_compaction_pressure: 1.6e9,
    };

    #[test]
    fn derivatives_where_pores_stay() {
        check_derivatives(&COPPER, &[[0.79, 1e4, 1.25], [0.7, 1e5, 1.0], [1.01, 0.0, 1.25]], 1e-6);
    }

    #[test]
    fn pores_close_on_the_curve_and_stay_closed() {
        let mut alpha = COPPER.first_history().unwrap();
        assert_eq!(alpha, 1.25);
        let (rest, same) = COPPER.at(1.0, 0.0, alpha);
        assert!(rest.pressure == 0.0 && same == alpha);
        let (mut last, mut crushed) = (0.0, 0);
        for k in 1..=60 {
            let j = 1.0 - 0.005 * f64::from(k);
            let (point, now) = COPPER.at(j, 0.0, alpha);
            assert!(now <= alpha && point.pressure >= last);
            if now < alpha && now > 1.0 {
                crushed += 1;
                let share = (1.6e9 - point.pressure) / 1.5e9;
                assert!((now - (1.0 + 0.25 * share * share)).abs() < 1e-14, "{j}: {now}");
                let whole = SOLID.pressure(j * 1.25 / now, 0.0) / now;
                assert!((whole - point.pressure).abs() < 1e-5 * 1e9 * 1e-5, "{whole}");
            }
            (alpha, last) = (now, point.pressure);
        }
        assert!(crushed > 20 && alpha == 1.0, "{crushed} {alpha}");
        // unloading follows the solid, with the pores gone
        let (point, now) = COPPER.at(0.81, 0.0, alpha);
        assert!(now == 1.0 && point.pressure == SOLID.pressure(0.81 * 1.25, 0.0));
    }

    #[test]
    fn half_crushed_it_unloads_at_its_distension() {
        let (loaded, alpha) = COPPER.at(0.88, 1e3, 1.25);
        assert!(alpha > 1.0 && alpha < 1.25);
        let (point, now) = COPPER.at(0.881, 1e3, alpha);
        assert!(now == alpha && point.pressure < loaded.pressure);
        // reloading meets the curve again where unloading left it
        let (again, now) = COPPER.at(0.88, 1e3, alpha);
        assert!(
            (again.pressure / loaded.pressure - 1.0).abs() < 1e-12 && (now - alpha).abs() < 1e-14
        );
        assert!((COPPER.crushing_pressure(alpha) / loaded.pressure - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_energy_slope_on_the_curve_is_that_of_the_pressure() {
        let p = |e: f64| COPPER.at(0.88, e, 1.25).0.pressure;
        let slope = (p(1e4 + 10.0) - p(1e4 - 10.0)) / 20.0;
        let returned = COPPER.at(0.88, 1e4, 1.25).0.energy_slope;
        assert!((returned / slope - 1.0).abs() < 1e-5, "{returned} {slope}");
    }

    #[test]
    fn over_any_solid() {
        let porous = Porous {
            solid: TILLOTSON,
            distension: 1.5,
            elastic_pressure: 0.0,
            full_compaction_pressure: 1e9,
        };
        let (point, alpha) = porous.at(0.6, 1e5, 1.5);
        assert_eq!(alpha, 1.0);
        assert_eq!(point, GeneralEos::at(&TILLOTSON, 0.6 * 1.5, 1e5));
    }
}
