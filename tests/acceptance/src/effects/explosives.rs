//! Products that expand along their isentrope, and fronts that arrive in time.

use flyer_mpm::exact::hugoniot::{HugoniotState, isentrope};
use flyer_mpm::material::Jwl;

use crate::bounds::{Unit, effects as bounds};
use crate::runs::Job;
use crate::table::Table;

const TNT: Jwl =
    Jwl { rho0: 1630.0, a: 371.2e9, b: 3.231e9, r1: 4.15, r2: 0.95, omega: 0.3, energy: 7e9 };

/// p on the isentrope through p1 at V = 1, in closed form.
fn on_isentrope(p1: f64, v: f64) -> f64 {
    let cold = |v: f64| TNT.a * (-TNT.r1 * v).exp() + TNT.b * (-TNT.r2 * v).exp();
    cold(v) + (p1 - cold(1.0)) * v.powf(-1.0 - TNT.omega)
}

/// p(V) of all products at each profile time.
pub fn products(table: &mut Table) {
    let Some(run) = table.take("jwl_expansion.json", Job::new("jwl_expansion").run()) else {
        return;
    };
    let start = HugoniotState::at_rest(&TNT, 0.0, 0.0).p;
    let Some(profiles) = table.take("profiles", run.tables()) else { return };
    for (profile, summary) in profiles.iter().zip(&run.summary.profiles) {
        let at = format!("products at {:.0} us", summary.time * 1e6);
        let columns = profile.numbers("density").zip(profile.numbers("pressure"));
        let errors: Option<Vec<f64>> = columns.map(|(rho, p)| {
            let products = rho.iter().zip(p).filter(|(rho, _)| **rho < 3000.0);
            products.map(|(rho, p)| p / on_isentrope(start, TNT.rho0 / rho) - 1.0).collect()
        });
        let rms = |e: &Vec<f64>| (e.iter().map(|e| e * e).sum::<f64>() / e.len() as f64).sqrt();
        let most = |e: &Vec<f64>| e.iter().fold(0.0f64, |m, e| m.max(e.abs()));
        table.check(
            &format!("{at}: p(V) against the isentrope, rms"),
            errors.as_ref().map(rms),
            bounds::products::ISENTROPE,
        );
        table.beside(&format!("{at}: greatest"), errors.as_ref().map(most), "", Unit::Fraction);
    }
    table.check("products: energy drift", run.summary.energy.drift, bounds::products::ENERGY_DRIFT);
}

/// The front's arrival, and the state of rest behind Taylor's wave.
pub fn burn(table: &mut Table) {
    let Some(run) = table.take("detonation.json", Job::new("detonation").run()) else { return };
    let Some(profiles) = table.take("profiles", run.tables()) else { return };
    for (profile, summary) in profiles.iter().zip(&run.summary.profiles) {
        let columns = profile.numbers("x").zip(profile.numbers("burn_fraction"));
        let front = columns.map(|(x, f)| {
            let lit = x.iter().zip(f).filter(|(_, f)| **f >= 0.5);
            lit.map(|(x, _)| *x).fold(f64::NEG_INFINITY, f64::max)
        });
        // half is burnt half the width behind it
        let exact = 6930.0 * summary.time - 1e-4;
        table.check(
            &format!("front at {:.1} us [cells]", summary.time * 1e6),
            front.map(|x| (x - exact) / 5e-5),
            bounds::burn::FRONT,
        );
    }
    // from Chapman and Jouguet's state along its isentrope until the products rest
    let cj = TNT.detonation();
    let state = |u: f64| HugoniotState {
        jacobian: cj.jacobian,
        p: cj.pressure,
        e: cj.energy,
        u,
        history: 0.0,
        sound_speed: cj.speed * cj.jacobian,
    };
    let behind = cj.speed * (1.0 - cj.jacobian);
    // isentrope() adds velocity in expansion as in a wave towards -x; here it takes it away
    let (mut low, mut high) = (cj.jacobian, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let gained = isentrope(&TNT, state(0.0), middle, 400).u.abs();
        if gained < behind { low = middle } else { high = middle }
    }
    let rest = isentrope(&TNT, state(0.0), low, 400).p;
    let wall = profiles.last().and_then(|profile| {
        let (x, p) = profile.numbers("x").zip(profile.numbers("pressure"))?;
        let still: Vec<f64> =
            x.iter().zip(p).filter(|(x, _)| (2e-3..8e-3).contains(*x)).map(|(_, p)| *p).collect();
        Some(still.iter().sum::<f64>() / still.len() as f64 / rest - 1.0)
    });
    table.check("pressure of rest behind the Taylor wave", wall, bounds::burn::PRESSURE_AT_REST);
    table.check("detonation: energy drift", run.summary.energy.drift, bounds::burn::ENERGY_DRIFT);
}
