//! Memory of a run against its estimate, which is made before anything else.

use flyer_mpm::driver::memory::needed_memory;
use flyer_mpm::input;

use crate::bounds::{Unit, scale as bounds};
use crate::program;
use crate::runs::Job;
use crate::section::Extent;
use crate::table::Table;

/// A run of some steps.
struct Case {
    scene: &'static str,
    cell_size: &'static str,
    end: &'static str,
    ranks: usize,
    patches: &'static str,
}

/// Most memory of a rank over its estimate, in a plane and on a line.
pub fn check(table: &mut Table) {
    let case =
        |scene, cell_size, end, ranks, patches| Case { scene, cell_size, end, ranks, patches };
    let mut cases = vec![
        case("flyer_2d", "2e-5", "1.5e-8", 1, "[1,1]"),
        case("flyer_2d", "2e-5", "1.5e-8", 1, "[10,6]"),
        case("flyer_2d", "2e-5", "1.5e-8", 2, "[4,2]"),
        case("disks", "2e-3", "2e-3", 1, "[1,1]"),
        case("flyer", "2e-8", "1e-10", 1, "[1]"),
    ];
    if table.extent >= Extent::Usual {
        cases.push(case("flyer_2d", "1e-5", "4e-9", 1, "[1,1]"));
    }
    for Case { scene, cell_size, end, ranks, patches } in cases {
        let sets = [
            format!("domain.cell_size={cell_size}"),
            format!("domain.patches={patches}"),
            format!("time.end={end}"),
            format!("output={{\"profiles\":{{\"times\":[{end}]}},\"pictures\":false}}"),
            "output.checkpoint.keep=0".into(),
            "decomposition.skip_quiescent=false".into(),
            "reference=null".into(),
        ];
        let name =
            format!("{scene}.json, cells of {cell_size} m, patches {patches}, {ranks} ranks");
        let job = sets.iter().fold(Job::new(scene), |job, set| job.set(set)).ranks(ranks).watched();
        let estimate = estimate(scene, &sets, ranks);
        let (Some(run), Some(estimate)) =
            (table.take(&name, job.run()), table.take(&name, estimate))
        else {
            continue;
        };
        let over = run.peak_bytes as f64 / estimate - 1.0;
        table.check(
            &format!("{name}: memory over its estimate, less 1"),
            Some(over),
            bounds::memory::MISSED,
        );
        let a_particle = run.peak_bytes as f64 * ranks as f64 / run.summary.particles as f64;
        table.beside("  bytes per particle", Some(a_particle), "", Unit::Count);
    }
}

/// The greatest estimate of a rank [bytes].
fn estimate(scene: &str, sets: &[String], ranks: usize) -> Result<f64, String> {
    let path = program::root().join(format!("inputs/{scene}.json"));
    let bytes = input::read(&path).map_err(|e| e.to_string())?;
    let scene = input::parse(&bytes, scene, sets).map_err(|e| e.to_string())?;
    let of = |rank| needed_memory(&scene, rank, ranks, 1) as f64;
    Ok((0..ranks).map(of).fold(0.0, f64::max))
}
