//! Bytes that rank 0 receives for outputs: of a profile sums over blocks of cells, of a checkpoint next
//! to nothing, of fields an even share.

use crate::bounds::{Unit, decomposition as bounds};
use crate::runs::Job;
use crate::table::Table;

/// Bytes received for outputs by each of four ranks, and the number of particles, in a plane with
/// cells of this size [m] and a profile of blocks of cells.
fn received(table: &mut Table, cell: f64, output: &str) -> Option<(Vec<f64>, f64)> {
    let sets = [
        "output.histories=null",
        "time.end=4e-9",
        r#"output.profiles={"times":[4e-9],"max_particles":2000}"#,
        &format!("domain.cell_size={cell:e}"),
        output,
    ];
    let job = sets.into_iter().fold(Job::new("flyer_2d"), Job::set).ranks(4);
    let run = table.take(&format!("cells of {cell:e} m, {output}"), job.run())?;
    let bytes = run.summary.decomposition.ranks.iter().map(|r| r.output_bytes_received as f64);
    Some((bytes.collect(), run.summary.particles as f64))
}

/// A profile alone, with checkpoints at every step, and with fields; two sizes of cells.
pub fn check(table: &mut Table) {
    let mut of_profiles = Vec::new();
    for cell in [4e-5, 2e-5] {
        let mut run = |output: &str| received(table, cell, output);
        let plain = run("output.fields=null");
        let kept = run(r#"output.checkpoint={"every_steps":1}"#);
        let fields = run(r#"output.fields={"times":[4e-9],"quantities":["velocity","pressure"]}"#);
        let Some((((plain, particles), (kept, _)), (fields, _))) = plain.zip(kept).zip(fields)
        else {
            continue;
        };
        of_profiles.push(plain[0]);
        let name = format!("{particles} particles: bytes of a profile");
        table.beside(&name, Some(plain[0]), "", Unit::Bytes);
        let name = "  bytes of checkpoints at every step";
        table.check(name, Some(kept[0] - plain[0]), bounds::received::CHECKPOINTS);
        let own = |rank: usize| fields[rank] - plain[rank];
        let others = (1..fields.len()).map(own).sum::<f64>() / (fields.len() - 1) as f64;
        let name = "  bytes of fields over the mean of the other ranks";
        table.check(name, Some(own(0) / others), bounds::received::FIELDS_OVER_OTHERS);
        table.beside("  bytes of fields", Some(own(0)), "", Unit::Bytes);
    }
    let growth = match of_profiles[..] {
        [few, many] => Some(many / few),
        _ => None,
    };
    let name = "bytes of a profile of as many blocks, four times the particles";
    table.check(name, growth, bounds::received::PROFILE_GROWTH);
}
