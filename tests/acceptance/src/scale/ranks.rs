//! Memory of a rank on few and on many ranks, each with as many particles.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;

use crate::bounds::{Unit, scale as bounds};
use crate::heap;
use crate::program;
use crate::table::Table;

/// Cells of a rank.
const CELLS: usize = 500;

/// Growth of the bytes that a rank holds after two steps, from 16 to 256 ranks.
pub fn check(table: &mut Table) {
    let name = "flyer.json, bytes held by a rank: growth from 16 to 256 ranks";
    let (few, many) = (held(16), held(256));
    let (Some(few), Some(many)) = (table.take(name, few), table.take(name, many)) else { return };
    table.check(name, Some(many / few - 1.0), bounds::ranks::GROWTH);
    table.beside("  bytes held by one of 256", Some(many), "", Unit::Bytes);
}

/// Mean bytes that one of `ranks` ranks holds, as threads of this process.
fn held(ranks: usize) -> Result<f64, String> {
    let sets = [
        format!("domain.cell_size={:e}", 0.01 / (CELLS * ranks) as f64),
        format!("domain.patches=[{}]", 2 * ranks),
    ];
    let path = program::root().join("inputs/flyer.json");
    let bytes = input::read(&path).map_err(|e| e.to_string())?;
    let scene = input::parse(&bytes, "flyer.json", &sets).map_err(|e| e.to_string())?;
    let before = heap::held();
    let held = run_ranks(ranks, |comm| {
        let mut simulation = Simulation::<1>::new(&scene, comm, 1).map_err(|e| e.to_string())?;
        for _ in 0..2 {
            simulation.advance(scene.scene.time.end).map_err(|e| e.to_string())?;
        }
        // all ranks hold what they need while one looks
        comm.sum(&mut [0]);
        let held = heap::held();
        comm.sum(&mut [0]);
        Ok::<_, String>(held)
    });
    let held = held.into_iter().collect::<Result<Vec<f64>, String>>()?;
    Ok((held[0] - before) / ranks as f64)
}
