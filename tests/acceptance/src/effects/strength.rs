//! Strength: an elastic-plastic piston, plates with an elastic precursor, Taylor's bar, turning.

use flyer_mpm::driver::output::csv::CsvTable;
use flyer_mpm::exact::{Behind, ElasticPlastic, Plastic};
use flyer_mpm::material::strength::{MaterialState, Rate, VonMises, advance, equivalent};
use flyer_mpm::material::{MieGruneisen, Symmetric};

use crate::bounds::{Unit, effects as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Last place at which `values` pass `level`, by a straight line between particles.
fn crossing(x: &[f64], values: &[f64], level: f64) -> Option<f64> {
    let k = (1..x.len()).rev().find(|&k| values[k - 1] >= level && values[k] < level)?;
    let share = (values[k - 1] - level) / (values[k - 1] - values[k]);
    Some(x[k - 1] + share * (x[k] - x[k - 1]))
}

/// Mean of a column over the middle 60 % between two places.
fn mean(profile: &CsvTable, name: &str, [from, to]: [f64; 2]) -> Option<f64> {
    let (x, values) = (profile.numbers("x")?, profile.numbers(name)?);
    let (low, high) = (from + 0.2 * (to - from), to - 0.2 * (to - from));
    let rows: Vec<usize> = (0..x.len()).filter(|&r| (low..high).contains(&x[r])).collect();
    Some(rows.iter().map(|&r| values[r]).sum::<f64>() / rows.len() as f64)
}

/// Speeds and plateaus of the two waves.
pub fn piston(table: &mut Table) {
    const NAME: &str = "piston_elastic_plastic";
    let Some(run) = table.take(NAME, Job::new(NAME).run()) else { return };
    let Some(profiles) = table.take("profiles", run.tables()) else { return };
    let material = Plastic {
        eos: MieGruneisen { rho0: 2790.0, c0: 5330.0, s: 1.34, gamma0: 2.0 },
        shear_modulus: 28.6e9,
        yield_stress: 0.26e9,
    };
    let exact = ElasticPlastic::new(&material, 100.0).expect("it is in the tests");
    let first = exact.precursor.expect("it runs ahead");
    let last = exact.last;
    let times: Vec<f64> = run.summary.profiles.iter().map(|p| p.time).collect();
    // seen from the wall the metal comes in at 100 m/s
    let front = |k: usize, level: f64| {
        let (x, u) = (profiles[k].numbers("x")?, profiles[k].numbers("velocity")?);
        let u: Vec<f64> = u.iter().map(|u| u + 100.0).collect();
        crossing(x, &u, level)
    };
    let speed = |level: f64| Some((front(1, level)? - front(0, level)?) / (times[1] - times[0]));
    for (name, level, wanted) in [
        ("precursor", 0.5 * first.u, first.speed),
        ("plastic wave", 0.5 * (first.u + 100.0), last.speed),
    ] {
        let error = speed(level).map(|v| (v + 100.0) / wanted - 1.0);
        table.check(&format!("piston: speed of the {name}"), error, bounds::piston::WAVE_SPEED);
    }
    let [at_last, at_first] = [last, first].map(|b: Behind| (b.speed - 100.0) * times[1]);
    let of = |name: &str, between, wanted: f64, added: f64| {
        mean(&profiles[1], name, between).map(|v| (v + added) / wanted - 1.0)
    };
    for (what, error) in [
        ("final axial stress", of("stress_xx", [0.0, at_last], -last.stress, 0.0)),
        ("final pressure", of("pressure", [0.0, at_last], last.p, 0.0)),
        ("final velocity", of("velocity", [0.0, at_last], last.u, 100.0)),
        ("precursor's axial stress", of("stress_xx", [at_last, at_first], -first.stress, 0.0)),
        ("precursor's velocity", of("velocity", [at_last, at_first], first.u, 100.0)),
    ] {
        table.check(&format!("piston: {what}"), error, bounds::piston::PLATEAU);
    }
    table.check("piston: energy drift", run.summary.energy.drift, bounds::piston::ENERGY_DRIFT);
}

/// The precursor ahead of the standard problem's shock.
pub fn flyer(table: &mut Table) {
    const NAME: &str = "flyer_strength";
    let Some(run) = table.take(NAME, Job::new(NAME).run()) else { return };
    let Some(profiles) = table.take("profiles", run.tables()) else { return };
    let material = Plastic {
        eos: MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 },
        shear_modulus: 27.6e9,
        yield_stress: 0.29e9,
    };
    let exact = ElasticPlastic::new(&material, 690.0).ok().and_then(|e| e.precursor);
    let Some(first) = table.take("precursor", exact.ok_or("none".to_string())) else { return };
    let (profile, time) = (&profiles[2], run.summary.profiles[2].time);
    let columns = profile.numbers("x").zip(profile.numbers("velocity"));
    let place = columns.and_then(|(x, u)| crossing(x, u, 0.5 * first.u));
    let error = place.map(|x| x / (first.speed * time) - 1.0);
    table.check("flyer_strength: place of the precursor", error, bounds::flyer::PRECURSOR_PLACE);
    // behind its rise, ahead of the shock's foot
    let plateau = place.and_then(|x| mean(profile, "stress_xx", [x - 1.6e-4, x - 0.4e-4]));
    let error = plateau.map(|s| -s / first.stress - 1.0);
    table.check("flyer_strength: its axial stress", error, bounds::flyer::PRECURSOR_STRESS);
    table.check(
        "flyer_strength: energy drift",
        run.summary.energy.drift,
        bounds::flyer::ENERGY_DRIFT,
    );
}

/// Length and greatest diameter of Taylor's bar; finer cells take long.
pub fn taylor(table: &mut Table) {
    for (cell, name) in [("4e-4", "0.4 mm"), ("2e-4", "0.2 mm")] {
        bar(table, cell, name);
    }
}

/// The same on cells of 0.1 and 0.05 mm: half an hour, and some three hours.
pub fn taylor_fine(table: &mut Table) {
    for (cell, name) in [("1e-4", "0.1 mm"), ("5e-5", "0.05 mm")] {
        bar(table, cell, name);
    }
}

fn bar(table: &mut Table, cell: &str, name: &str) {
    let job = Job::new("taylor_bar").set(format!("domain.cell_size={cell}"));
    let Some(run) = table.take(&format!("taylor_bar, {name}"), job.run()) else { return };
    let Some(profiles) = table.take("profiles", run.tables()) else { return };
    let Some(last) = profiles.last() else { return };
    let half: f64 = 0.25 * cell.parse::<f64>().unwrap_or(0.0);
    // particles end half of their length further out, stretched as the material is: a radius by
    // its own over its first, the length by what is left of it
    let most = |name: &str| last.numbers(name).map(|v| v.iter().copied().fold(0.0, f64::max));
    let length = most("y").map(|y| y + half);
    let diameter = most("x").map(|x| 2.0 * x * (1.0 + half / (3.2e-3 - half)));
    let within = |value: Option<f64>, [low, high]: [f64; 2]| {
        value.map(|v| if v < low { v / low - 1.0 } else { (v / high - 1.0).max(0.0) })
    };
    let apart = within(length, [26.52e-3, 26.56e-3]);
    table.check(&format!("taylor_bar, {name}: length"), apart, bounds::taylor::LENGTH);
    table.beside("  length [mm]", length.map(|l| l * 1e3), "26.52 to 26.56", Unit::One);
    let apart = within(diameter, [11.15e-3, 11.22e-3]);
    table.check(&format!("taylor_bar, {name}: diameter"), apart, bounds::taylor::DIAMETER);
    table.beside("  diameter [mm]", diameter.map(|d| d * 1e3), "11.15 to 11.22", Unit::One);
    table.check("  energy drift", run.summary.energy.drift, bounds::taylor::ENERGY_DRIFT);
}

/// Rate of strain over time.
type Path = fn(f64) -> Rate;

/// One point along a given path: shear that turns, against its own equation in tiny steps.
pub fn paths(table: &mut Table) {
    let model = VonMises { shear_modulus: 28e9, yield_stress: 0.3e9, hardening: 1e9 };
    let rest = MaterialState { compression: 1.0, pressure: 0.0, temperature: f64::NAN };
    let kinds: [(&str, Path); 4] = [
        ("uniaxial strain", |_| Rate { plane: [-1e5, 0.0, 0.0, 0.0], across: 0.0 }),
        ("simple shear", |_| Rate { plane: [0.0, 3e5, 0.0, 0.0], across: 0.0 }),
        ("a cycle", |t| {
            let rate = 2e5 * (std::f64::consts::TAU * t / 1e-6).cos();
            Rate { plane: [rate, 0.0, 0.0, -0.5 * rate], across: -0.5 * rate }
        }),
        ("stretch under a turn", |_| Rate { plane: [1e5, -2e6, 2e6, -1e5], across: 0.0 }),
    ];
    for (name, rate) in kinds {
        let end = |steps: usize| {
            let dt = 1e-6 / steps as f64;
            let mut at = (Symmetric::default(), 0.0);
            for k in 0..steps {
                let rate = rate((k as f64 + 0.5) * dt);
                let after = advance(&model, &at.0, at.1, &rate, dt, &rest);
                at = (after.deviator, after.plastic_strain);
            }
            at
        };
        let (exact, strain) = by_rates(&model, Symmetric::default(), &rate, 1e-6);
        let (s, plastic) = end(400);
        let apart = Symmetric {
            xx: s.xx - exact.xx,
            yy: s.yy - exact.yy,
            xy: s.xy - exact.xy,
            zz: s.zz - exact.zz,
        };
        let error = equivalent(&apart) / equivalent(&exact);
        table.check(
            &format!("{name}: stress, 400 steps"),
            Some(error),
            bounds::strength_paths::STRESS,
        );
        let error = if strain > 0.0 { plastic / strain - 1.0 } else { plastic };
        table.check(
            &format!("{name}: plastic strain"),
            Some(error),
            bounds::strength_paths::PLASTIC_STRAIN,
        );
        let limit = model.yield_stress + model.hardening * plastic;
        let over = (equivalent(&s) / limit - 1.0).max(0.0);
        table.check(
            &format!("{name}: over the yield stress"),
            Some(over),
            bounds::strength_paths::OVER_YIELD_STRESS,
        );
    }
    // a whole turn in exact increments
    let s = Symmetric { xx: 1e8, yy: -0.5e8, xy: 0.5e8, zz: -0.5e8 };
    let w = 2.0 * (0.5 * std::f64::consts::TAU / 16.0).tan() / 1e-8;
    let turn = Rate { plane: [0.0, -w, w, 0.0], across: 0.0 };
    let after = (0..16).fold(s, |s, _| advance(&model, &s, 0.0, &turn, 1e-8, &rest).deviator);
    let error = (after.xx - s.xx).abs().max((after.xy - s.xy).abs()) / 1e8;
    table.check(
        "a whole turn in 16 exact increments",
        Some(error),
        bounds::strength_paths::WHOLE_TURN,
    );
}

/// Deviator and plastic strain after `time` from the deviator `start` by the rate equations themselves with Jaumann's rate,
/// in steps of the first order so small that it does not matter.
pub fn by_rates(
    model: &VonMises,
    start: Symmetric,
    rate: &dyn Fn(f64) -> Rate,
    time: f64,
) -> (Symmetric, f64) {
    let steps = 4_000_000;
    let dt = time / steps as f64;
    let (mut s, mut strain) = (start, 0.0f64);
    for k in 0..steps {
        let Rate { plane: [xx, xy, yx, yy], across } = rate(k as f64 * dt);
        let (w, mean) = (0.5 * (yx - xy), (xx + yy + across) / 3.0);
        let d = Symmetric { xx: xx - mean, yy: yy - mean, xy: 0.5 * (xy + yx), zz: across - mean };
        let size = equivalent(&s);
        let limit = model.yield_stress + model.hardening * strain;
        let pushing = s.double_dot(&d);
        // on the surface plastic flow takes what would leave it: 3 G (s:d)/|s| = (3 G + H) dep
        let flow = if size >= limit && pushing > 0.0 {
            3.0 * model.shear_modulus * pushing
                / size
                / (3.0 * model.shear_modulus + model.hardening)
        } else {
            0.0
        };
        let taken = if size > 0.0 { 1.5 * flow / size } else { 0.0 };
        let g = 2.0 * model.shear_modulus;
        let change = |s: f64, d: f64, turned: f64| s + dt * (g * (d - taken * s) + turned);
        s = Symmetric {
            xx: change(s.xx, d.xx, -2.0 * w * s.xy),
            yy: change(s.yy, d.yy, 2.0 * w * s.xy),
            xy: change(s.xy, d.xy, w * (s.xx - s.yy)),
            zz: change(s.zz, d.zz, 0.0),
        };
        strain += dt * flow;
    }
    (s, strain)
}
