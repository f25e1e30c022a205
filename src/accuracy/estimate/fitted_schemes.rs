//! The schemes of the fit: shape functions, transfers, viscosities, Courant numbers and particles
//! per cell. A scheme need not be one of the fit, but each of its keys must be within its range.

use serde::{Deserialize, Serialize};

use super::within::check;
use crate::scene::{CheckedScene, EnergyUpdate, Stepping, StressUpdate};
use crate::shape::ShapeKind;
use crate::transfer::Transfer;

/// Largest share of the lumped mass, that of `robust` at a Courant number of 0.6 [-].
const LUMPING: f64 = 0.11;

/// Ranges of the keys of a scheme: names, or smallest and largest values.
///
/// Viscosity in expansion and the share of the lumped mass are not keys of the fit. The presets with
/// them are among the schemes on which the acceptance program tests the intervals
/// (`accuracy/estimate`).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedSchemes {
    /// Shape functions.
    pub shapes: Vec<ShapeKind>,
    /// Order of `fmpm` \[-\].
    pub fmpm: [f64; 2],
    /// Order of `xpic` \[-\].
    pub xpic: [f64; 2],
    /// Rate of the pressure relaxation over its interval, with `fmpm` \[-\].
    pub relaxation: [f64; 2],
    /// Linear coefficient of the artificial viscosity \[-\].
    pub linear: [f64; 2],
    /// Quadratic coefficient of the artificial viscosity \[-\].
    pub quadratic: [f64; 2],
    /// Courant number \[-\].
    pub courant: [f64; 2],
    /// Particles per cell.
    pub particles_per_cell: [f64; 2],
}

impl FittedSchemes {
    /// The keys of a scheme that are outside, one line each.
    pub(super) fn outside(&self, scene: &CheckedScene) -> Vec<String> {
        let mut found = self.method(scene);
        match scene.scene.artificial_viscosity {
            None => found.push("artificial_viscosity: none: not in the fit".into()),
            Some(viscosity) => {
                let (linear, quadratic) = (viscosity.linear, viscosity.quadratic);
                found.extend(check("artificial_viscosity.linear", linear, self.linear));
                found.extend(check("artificial_viscosity.quadratic", quadratic, self.quadratic));
            }
        }
        found.extend(check("time.courant", scene.scene.time.courant, self.courant));
        for body in &scene.scene.bodies {
            if body.positions.is_some() {
                found.push(format!("bodies.{}.positions: not in the fit", body.name));
                continue;
            }
            let key = format!("bodies.{}.particles_per_cell", body.name);
            for count in body.particles_per_cell(scene.dimension) {
                found.extend(check(&key, count as f64, self.particles_per_cell));
            }
        }
        found
    }

    fn method(&self, scene: &CheckedScene) -> Vec<String> {
        let method = &scene.scene.method;
        let mut found = Vec::new();
        let mut not = |is: bool, key: &str| {
            if is {
                found.push(format!("method.{key}: not in the fit"));
            }
        };
        not(!self.shapes.contains(&method.shape), "shape");
        not(method.flux_limiter.is_some(), "flux_limiter");
        not(method.mass_lumping.is_some_and(|share| share > LUMPING), "mass_lumping");
        not(method.heat_spreading.is_some(), "heat_spreading");
        not(method.volume_relaxation.is_some(), "volume_relaxation");
        not(method.domain_limit.is_some(), "domain_limit");
        let compatible = method.energy == EnergyUpdate::Compatible && method.filter_heat;
        match method.transfer {
            Transfer::Fmpm(order) => {
                let relaxation = method.pressure_relaxation;
                let rate = relaxation.map_or(0.0, |r| r.rate / f64::from(r.interval));
                not(method.stepping != Stepping::Midpoint, "stepping");
                not(!compatible, "energy");
                not(method.edge_mask.is_none(), "edge_mask");
                found.extend(check("order of method.transfer.fmpm", order.into(), self.fmpm));
                let key = "rate over interval of method.pressure_relaxation";
                found.extend(check(key, rate, self.relaxation));
            }
            transfer => {
                let fitted = matches!(
                    transfer,
                    Transfer::Flip | Transfer::Pic | Transfer::Apic | Transfer::Xpic(_)
                );
                not(!fitted, "transfer");
                not(method.stepping != Stepping::Leapfrog, "stepping");
                not(method.stress_update != StressUpdate::Last, "stress_update");
                not(method.energy != EnergyUpdate::Textbook, "energy");
                if let Transfer::Xpic(order) = transfer {
                    found.extend(check("order of method.transfer.xpic", order.into(), self.xpic));
                }
            }
        }
        found
    }
}
