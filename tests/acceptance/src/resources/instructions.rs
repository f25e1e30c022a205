//! Instructions per particle and step, counted by callgrind: the same number on a busy machine.

use std::process::{Command, Stdio};

use crate::bounds::Bound;
use crate::bounds::resources::instructions as bounds;
use crate::program;
use crate::runs::Job;
use crate::table::Table;

/// Each scene against its number.
pub fn check(table: &mut Table) {
    let valgrind = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status();
    if !valgrind.is_ok_and(|status| status.success()) {
        return table.not_measured("instructions", "no valgrind");
    }
    if !program::has_shipped_profile() {
        return table.not_measured("instructions", "CARGO_PROFILE_* set");
    }
    let coarse = |scene, cell: f64| Job::new(scene).set(format!("domain.cell_size={cell:e}"));
    let windows = [
        ("flyer", Job::new("flyer"), [1.25e-8, 5e-8], bounds::FLYER),
        ("flyer_uintah", Job::new("flyer_uintah"), [1.25e-8, 5e-8], bounds::FLYER_UINTAH),
        ("flyer_2d", coarse("flyer_2d", 4e-5), [5e-9, 1.5e-8], bounds::FLYER_2D),
        ("taylor_bar", coarse("taylor_bar", 4e-4), [1e-6, 3e-6], bounds::TAYLOR_BAR),
    ];
    for (scene, job, ends, before) in windows {
        let figure = format!("{scene}.json: instructions per particle and step");
        let Some(count) = table.take(&figure, count(&job, ends)) else { continue };
        let most = before.number() * (1.0 + bounds::EXCESS.number());
        table.check(&figure, Some(count), Bound { at_most: Some(most), ..before });
    }
}

/// Instructions per particle and step between two ends \[s\]: the set-up cancels.
fn count(job: &Job, ends: [f64; 2]) -> Result<f64, String> {
    let [short, long] = ends.map(|end| run(job.clone(), end));
    let ([steps, particles, instructions], [more_steps, _, more]) = (short?, long?);
    Ok((more - instructions) / ((more_steps - steps) * particles))
}

/// Steps, particles and instructions of a run to `end` [s] in which all particles are computed.
fn run(job: Job, end: f64) -> Result<[f64; 3], String> {
    let job = job
        .set(format!("time.end={end:e}"))
        .set(format!("output={{\"profiles\":{{\"times\":[{end:e}]}},\"pictures\":false}}"))
        .set("output.checkpoint.keep=0")
        .set("decomposition.skip_quiescent=false")
        .set("domain.patches=null")
        .set("reference=null");
    let run = job.counted().run()?;
    let instructions = run.instructions.ok_or("callgrind has printed no number")?;
    Ok([run.summary.steps as f64, run.summary.particles as f64, instructions as f64])
}
