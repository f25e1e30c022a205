//! Heat at the edge of a growing contact: a sphere that strikes a plate.

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;
use serde_json::json;

use crate::bounds::Unit;
use crate::program;
use crate::table::Table;

/// Energy behind the plane shock of copper on aluminium at 1 km/s \[J/kg\]: sphere and plate.
const SHOCK: [f64; 2] = [47_760.0, 238_696.0];

/// Ratio to that energy above which a particle counts as hot.
const HOT: f64 = 1.2;

/// Greatest energy of a particle over that of the plane shock, and mass fraction of hot particles,
/// of sphere and plate.
type Heat = [[f64; 2]; 2];

/// The template `sphere` without strength, with cells of `cell` \[mm\], to 0.5 us.
fn run(cell: f64, more: &[&str]) -> Result<Heat, String> {
    let path = program::root().join("inputs/templates/sphere.json");
    let text = std::fs::read(&path).map_err(|e| e.to_string())?;
    let metal = |density: f64, c0: f64, s: f64, gamma0: f64| {
        let eos = json!({"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0});
        json!({"density": density, "eos": eos})
    };
    let copper = metal(8930.0, 3940.0, 1.489, 1.96);
    let aluminium = metal(2785.0, 5386.0, 1.339, 2.1);
    let mut sets = vec![
        format!("materials={}", json!({"copper": copper, "aluminium": aluminium})),
        format!("domain.cell_size=\"{cell} mm\""),
        "time.end=\"0.5 us\"".to_string(),
        "output={}".to_string(),
    ];
    sets.extend(more.iter().map(|set| set.to_string()));
    let scene = input::parse(&text, "sphere.json", &sets).map_err(|e| e.to_string())?;
    let mut simulation = Simulation::<2>::new(&scene, &Serial, 1).map_err(|e| e.to_string())?;
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).map_err(|e| e.to_string())?;
    }
    let (table, _) = simulation.gather().ok_or("rank 0 gathers")?;
    let column = |name: &str| table.column(name).ok_or(format!("no column {name}"));
    let energy = column("specific_internal_energy")?;
    let (density, volume) = (column("density")?, column("volume")?);
    let mut heat = Heat::default();
    let mut all = [0.0; 2];
    for (r, &body) in table.body.iter().enumerate() {
        let body = body as usize;
        let (mass, ratio) = (density[r] * volume[r], energy[r] / SHOCK[body]);
        let [most, hot] = &mut heat[body];
        *most = most.max(ratio);
        *hot += if ratio > HOT { mass } else { 0.0 };
        all[body] += mass;
    }
    heat.iter_mut().zip(all).for_each(|([_, hot], all)| *hot /= all);
    Ok(heat)
}

/// Hottest particles and hot mass on cells of several sizes.
pub fn check(table: &mut Table) {
    let mixing = ["contact={\"type\": \"frictionless\"}", "heat_mixing.coefficient=20"];
    for (what, more) in [("one velocity field", &[][..]), ("frictionless, mixing 20", &mixing)] {
        for cell in [0.2, 0.1, 0.05] {
            let name = format!("{what}, cells of {cell} mm");
            let Some(heat) = table.take(&name, run(cell, more)) else { continue };
            for (body, [most, hot]) in ["sphere", "plate"].into_iter().zip(heat) {
                let figure = |what: &str| format!("{name}, {body}: {what}");
                table.beside(&figure("hottest over plane shock"), Some(most), "", Unit::One);
                table.beside(&figure("mass above 1.2 of it"), Some(hot), "", Unit::Fraction);
            }
        }
    }
}
