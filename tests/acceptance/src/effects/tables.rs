//! A run of a table made from Mie-Grueneisen against the run of what it was made of.

use flyer_mpm::material::{EquationOfState, MieGruneisen};
use serde_json::json;

use crate::bounds::effects as bounds;
use crate::runs::Job;
use crate::table::Table;

const ALUMINIUM: MieGruneisen = MieGruneisen { rho0: 2785.0, c0: 5386.0, s: 1.339, gamma0: 2.1 };

/// A table of `densities` and `energies` even nodes.
fn material(densities: usize, energies: usize) -> String {
    let even = |from: f64, to: f64, n: usize| -> Vec<f64> {
        (0..n).map(|k| from + (to - from) * k as f64 / (n - 1) as f64).collect()
    };
    let (density, energy) = (even(2585.0, 3785.0, densities), even(-1e5, 1.4e6, energies));
    let row = |rho: &f64| -> Vec<f64> {
        // ten digits keep the line short
        let p = energy.iter().map(|&e| ALUMINIUM.pressure(2785.0 / rho, e));
        p.map(|p| format!("{p:.9e}").parse().unwrap_or(p)).collect()
    };
    let pressure: Vec<Vec<f64>> = density.iter().map(row).collect();
    let table =
        json!({"density": density, "specific_internal_energy": energy, "pressure": pressure});
    json!({"density": 2785.0, "eos": {"type": "tabular", "table": table}}).to_string()
}

/// L1 differences of pressure, density and energy.
pub fn check(table: &mut Table) {
    for (densities, energies) in [(49, 7), (97, 7)] {
        // each run's folder is replaced by the next: the plain one is read before
        let plain = Job::new("piston").run().and_then(|run| run.tables());
        let Some(plain) = table.take("piston.json", plain) else { return };
        let set = format!("materials.aluminium={}", material(densities, energies));
        let run = Job::new("piston").set(set).run();
        let Some(run) = table.take("table", run) else { return };
        for name in ["pressure", "density", "specific_internal_energy"] {
            let value = run.tables().ok().and_then(|made| {
                let (a, b) = (made.last()?.numbers(name)?, plain.last()?.numbers(name)?);
                let size: f64 = b.iter().map(|b| b.abs()).sum();
                Some(a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / size)
            });
            let figure = format!("{densities} x {energies} table: L1 of {name}");
            table.check(&figure, value, bounds::tables::L1);
        }
        let drift = run.summary.energy.drift;
        table.check("table: energy drift", drift, bounds::tables::ENERGY_DRIFT);
    }
}
