//! The least specific internal energy that adiabatic flow can bring a material to.

use super::{Matter, Model};

/// Longest step of ln J along the isentrope.
const STEP: f64 = 0.01;

/// Share of the way to zero pressure, by the stiffness at hand, that a step takes.
const SHARE: f64 = 0.1;

/// Pressure over the stiffness rho c^2 at which the elastic energy is spent: what is left of it is
/// half of the square of this, over c^2, which is rounding. In a gas the ratio stays at 1/gamma.
const SPENT: f64 = 1e-6;

/// Greatest |ln J| of the search: a gas has spent nearly all of its energy there.
const RANGE: f64 = 9.0;

/// The least specific internal energy [J/kg] that a material of density `rho0` [kg/m3] can reach
/// from `start` [J/kg] at J = 1 without losing heat: the energy at zero pressure on the isentrope
/// through the start, since de = -p dv. At most `start`.
///
/// A material with a history (pores, a detonation) has no single isentrope; the lesser of `start`
/// and 0 stands for it. An elastic solid starts without stress, so `start` is its least energy.
pub fn least_energy(matter: &Matter, rho0: f64, start: f64) -> f64 {
    match matter {
        Matter::Solid(_) => start,
        Matter::Fluid(model) if model.first_history().is_some() => start.min(0.0),
        Matter::Fluid(model) => along_isentrope(model.as_ref(), rho0, start),
    }
}

fn along_isentrope(model: &dyn Model, rho0: f64, start: f64) -> f64 {
    // pressure and sound speed
    let state = |log: f64, e: f64| -> Option<[f64; 2]> {
        let (mut p, mut c) = ([0.0], [0.0]);
        model.refresh(&[log.exp()], &[e], None, &mut p, &mut c).is_none().then_some([p[0], c[0]])
    };
    let slope = |log: f64, p: f64| -p * log.exp() / rho0;
    let Some([first, mut c]) = state(0.0, start) else { return start };
    let (mut log, mut e, mut p) = (0.0f64, start, first);
    // material in compression expands to zero pressure, material in tension contracts
    loop {
        let strain = p * log.exp() / (rho0 * c * c);
        // NaN, of no pressure without stiffness, ends it too
        if !(strain.abs() > SPENT && (p > 0.0) == (first > 0.0)) {
            break;
        }
        if log.abs() >= RANGE {
            // a gas: it comes to zero pressure only as its energy comes to zero
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
    use super::super::{Point, general::Implicit};
    use super::*;
    use crate::material::{IdealGas, MieGruneisen, Porous};

    const COPPER: MieGruneisen = MieGruneisen { rho0: 8930.0, c0: 3940.0, s: 1.489, gamma0: 1.96 };

    fn of_copper(start: f64) -> f64 {
        least_energy(&Matter::Fluid(Box::new(Point(COPPER))), 8930.0, start)
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
        assert_eq!(least_energy(&Matter::Fluid(Box::new(Point(gas))), 2.0, 3.0), 0.0);
    }

    #[test]
    fn a_material_with_a_history_is_not_followed() {
        let pores = Porous {
            solid: COPPER,
            distension: 1.2,
            elastic_pressure: 0.1e9,
            compaction_pressure: 1.6e9,
        };
        let matter = Matter::Fluid(Box::new(Implicit(pores)));
        assert_eq!(least_energy(&matter, 8930.0 / 1.2, 1e3), 0.0);
        assert_eq!(least_energy(&matter, 8930.0 / 1.2, -1e3), -1e3);
    }
}
