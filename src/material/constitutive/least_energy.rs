//! Smallest specific internal energy that a material can reach in adiabatic flow.

use super::model::{ConstitutiveModel, FluidModel};

/// Largest step of ln J along the isentrope.
const STEP: f64 = 0.01;

/// Fraction of the distance to zero pressure, estimated from the current stiffness, that one step
/// covers.
const SHARE: f64 = 0.1;

/// Ratio of pressure to stiffness rho c^2 at which the elastic energy counts as spent: the
/// remaining energy over c^2 is half the square of this ratio, which is rounding. In a gas the
/// ratio stays at 1/gamma.
const SPENT: f64 = 1e-6;

/// Greatest |ln J| of the search: a gas has spent nearly all of its energy there.
const RANGE: f64 = 9.0;

/// Smallest specific internal energy [J/kg] that a material of density `rho0` [kg/m3] can reach
/// from `start` [J/kg] at J = 1 without losing heat. Since de = -p dv, it is the energy at zero
/// pressure on the isentrope through the start. At most `start`.
///
/// A material with a history (pores, a detonation) has no single isentrope; the result is then the
/// smaller of `start` and 0. An elastic solid starts without stress, so `start` is its smallest
/// energy.
pub fn least_energy(matter: &ConstitutiveModel, rho0: f64, start: f64) -> f64 {
    match matter {
        ConstitutiveModel::Solid(_) => start,
        ConstitutiveModel::Fluid(model) if model.first_history().is_some() => start.min(0.0),
        ConstitutiveModel::Fluid(model) => along_isentrope(model.as_ref(), rho0, start),
    }
}

fn along_isentrope(model: &dyn FluidModel, rho0: f64, start: f64) -> f64 {
    // pressure and sound speed
    let state = |log: f64, e: f64| -> Option<[f64; 2]> {
        let (mut p, mut c) = ([0.0], [0.0]);
        model.refresh(&[log.exp()], &[e], None, &mut p, &mut c).is_none().then_some([p[0], c[0]])
    };
    let slope = |log: f64, p: f64| -p * log.exp() / rho0;
    let Some([first, mut c]) = state(0.0, start) else { return start };
    let (mut log, mut e, mut p) = (0.0f64, start, first);
    // compressed material expands to zero pressure, material in tension contracts
    loop {
        let strain = p * log.exp() / (rho0 * c * c);
        // NaN, from zero pressure without stiffness, also ends the loop
        if !(strain.abs() > SPENT && (p > 0.0) == (first > 0.0)) {
            break;
        }
        if log.abs() >= RANGE {
            // a gas: its pressure reaches zero only as its energy reaches zero
            return start.min(0.0);
        }
        let step = (SHARE * strain).clamp(-STEP, STEP);
        let Some([middle, _]) = state(log + 0.5 * step, e + 0.5 * step * slope(log, p)) else {
            break;
        };
        let next = e + step * slope(log + 0.5 * step, middle);
        let Some([pressure, speed]) = state(log + step, next) else { break };
        (log, e, p, c) = (log + step, next, pressure, speed);
    }
    e.min(start)
}

#[cfg(test)]
mod tests {
    use super::super::{general::NonlinearEosKernel, linear::LinearEosKernel};
    use super::*;
    use crate::material::{IdealGas, MieGruneisen, Porous};

    const COPPER: MieGruneisen = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };

    fn of_copper(start: f64) -> f64 {
        least_energy(&ConstitutiveModel::Fluid(Box::new(LinearEosKernel(COPPER))), 8930.0, start)
    }

    #[test]
    fn a_metal_without_pressure_has_its_least_energy() {
        assert_eq!(of_copper(0.0), 0.0);
    }

    #[test]
    fn a_metal_under_pressure_or_tension_gives_its_elastic_energy() {
        for start in [57e3, 57.0, -57.0, -57e3] {
            // p^2/(2 rho0^2 c0^2), to leading order
            let p = 1.96 * 8930.0 * start;
            let elastic = 0.5 * (p / (8930.0f64 * 3940.0)).powi(2);
            let given = start - of_copper(start);
            assert!((given / elastic - 1.0).abs() < 0.15, "{given} {elastic}");
        }
    }

    #[test]
    fn a_gas_can_spend_all_of_its_energy() {
        let gas = IdealGas { rho0: 2.0, gamma: 1.4 };
        assert_eq!(
            least_energy(&ConstitutiveModel::Fluid(Box::new(LinearEosKernel(gas))), 2.0, 3.0),
            0.0
        );
    }

    #[test]
    fn a_material_with_a_history_is_not_followed() {
        let pores = Porous {
            solid: COPPER,
            distension: 1.2,
            elastic_pressure: 0.1e9,
            full_compaction_pressure: 1.6e9,
        };
        let matter = ConstitutiveModel::Fluid(Box::new(NonlinearEosKernel(pores)));
        assert_eq!(least_energy(&matter, 8930.0 / 1.2, 1e3), 0.0);
        assert_eq!(least_energy(&matter, 8930.0 / 1.2, -1e3), -1e3);
    }
}
