//! Counts by callgrind per particle and step: the same numbers on a busy machine.

use std::process::{Command, Stdio};

use crate::program;
use crate::runs::{Job, Outcome};

/// The reason why this machine cannot count, if there is one.
pub fn can_count() -> Result<(), &'static str> {
    let valgrind = Command::new("valgrind").arg("--version").stdout(Stdio::null()).status();
    if !valgrind.is_ok_and(|status| status.success()) {
        return Err("no valgrind");
    }
    if !program::has_shipped_profile() {
        return Err("CARGO_PROFILE_* set");
    }
    Ok(())
}

/// Instructions per particle and step between two ends \[s\]: the set-up cancels.
pub fn instructions(job: &Job, ends: [f64; 2]) -> Result<f64, String> {
    per_particle_step(&job.clone().counted(), ends, |run| run.instructions)
}

/// Bytes per particle and step, between two ends \[s\], that move between L2 cache and memory.
pub fn memory_bytes(job: &Job, ends: [f64; 2]) -> Result<f64, String> {
    per_particle_step(&job.clone().with_memory_counted(), ends, |run| run.memory_bytes)
}

fn per_particle_step(
    job: &Job,
    ends: [f64; 2],
    count: impl Fn(&Outcome) -> Option<u64>,
) -> Result<f64, String> {
    let run = |end: f64| {
        let run = until(job.clone(), end).run()?;
        let counted = count(&run).ok_or("callgrind has printed no number")? as f64;
        Ok::<_, String>([run.summary.steps as f64, run.summary.particles as f64, counted])
    };
    let ([steps, particles, count], [more_steps, _, more]) = (run(ends[0])?, run(ends[1])?);
    Ok((more - count) / ((more_steps - steps) * particles))
}

/// A run to `end` \[s\] in which all particles are computed, without pictures and checkpoints.
pub fn until(job: Job, end: f64) -> Job {
    job.set(format!("time.end={end:e}"))
        .set(format!("output={{\"profiles\":{{\"times\":[{end:e}]}},\"pictures\":false}}"))
        .set("output.checkpoint.keep=0")
        .set("decomposition.skip_quiescent=false")
}
