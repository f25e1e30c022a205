//! Start of a run: each rank makes the particles of its own patches alone.

use std::fs;

use flyer_mpm::effects;
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::initial_particles;

use crate::bounds::{Unit, scale as bounds};
use crate::counts;
use crate::program;
use crate::runs::Job;
use crate::table::Table;

/// Two disks of 1 m2 with about this many particles each.
fn disks(particles: f64) -> Vec<String> {
    let per_edge = 4.0 * (particles / std::f64::consts::PI).sqrt();
    // a whole number of cells of four particles over 1 m, and disks of a radius of 0.2 m
    let cells = (per_edge * 1.25 / 2.0).round();
    vec![format!("domain.cell_size={:?}", 1.0 / cells)]
}

/// `disks.json` with these changes.
fn scene(sets: &[String]) -> Result<CheckedScene, String> {
    let path = program::root().join("inputs/disks.json");
    let bytes = input::read(&path).map_err(|e| e.to_string())?;
    input::parse(&bytes, "disks.json", sets).map_err(|e| e.to_string())
}

/// Patches of disks, a rank of a thousand, and the check of a billion particles.
pub fn check(table: &mut Table) {
    patches(table);
    one_rank(table);
    described(table);
}

/// Instructions of a start on one rank with few and with many patches.
fn patches(table: &mut Table) {
    if let Err(reason) = counts::can_count() {
        return table.not_measured("start with many patches", reason);
    }
    let counted = |patches: usize, end: f64| {
        let job = disks(2e5).into_iter().fold(Job::new("disks"), Job::set);
        let job = job.set(format!("domain.patches=[{patches},{patches}]")).counted();
        let run = counts::until(job, end).run()?;
        let count = run.instructions.ok_or("callgrind has printed no number")?;
        Ok::<_, String>([run.summary.steps as f64, count as f64])
    };
    // without the steps: what a run to its second step takes beyond a run to its first one
    let started = |patches: usize| {
        let ([steps, count], [more_steps, more]) =
            (counted(patches, 2.5e-4)?, counted(patches, 7.5e-4)?);
        Ok::<_, String>(count - steps * (more - count) / (more_steps - steps))
    };
    let name = "disks: instructions of a start with 48 x 48 patches over 4 x 4";
    let ratio = started(4).and_then(|few| Ok(started(48)? / few));
    if let Some(ratio) = table.take(name, ratio) {
        table.check(name, Some(ratio), bounds::startup::MANY_PATCHES);
    }
}

/// Rank 500 of 1000 of a scene of 1e8 particles, by itself.
fn one_rank(table: &mut Table) {
    const RANKS: usize = 1000;
    let name = "rank 500 of 1000, 1e8 particles";
    // mapped code is shared by the ranks of a node, and the system maps more of it than is used
    let kinds = ["RssAnon:", "RssFile:"];
    let (before, start) = (kinds.map(memory), cpu_seconds());
    let Some(scene) = table.take(name, scene(&disks(5e7))) else { return };
    let stepper = effects::stepper::<2>(&scene);
    let blocks = initial_particles(&scene, &stepper, RANKS / 2, RANKS);
    let seconds = cpu_seconds() - start;
    let [bytes, of_program] = std::array::from_fn(|k| memory(kinds[k]) - before[k]);
    let own: usize = blocks.iter().map(|block| block.own()).sum();
    // ids, cells and columns of its particles
    let share = (own * (16 + 8 * stepper.columns.specs.len())) as f64;
    let mean = scene.particles as f64 / RANKS as f64;
    table.beside(
        &format!("{name}: particles over the mean"),
        Some(own as f64 / mean),
        "",
        Unit::One,
    );
    table.check(&format!("{name}: CPU time"), Some(seconds), bounds::startup::RANK_SECONDS);
    let over = Some(bytes / share);
    table.check(&format!("{name}: own memory over its share"), over, bounds::startup::RANK_MEMORY);
    table.beside(
        "  mapped code of the program, not counted",
        Some(of_program / share),
        "",
        Unit::One,
    );
}

/// `flyer-mpm check` of a billion particles.
fn described(table: &mut Table) {
    let name = "check of 1e9 particles";
    let job = disks(5e8).into_iter().fold(Job::new("disks"), Job::set).watched();
    let Some(run) = table.take(name, job.check()) else { return };
    let line = run.said.lines().find_map(|line| line.strip_prefix("particles "));
    let count = line.and_then(|count| count.trim().parse().ok());
    table.beside(&format!("{name}: particles"), count, "", Unit::Count);
    table.check(
        &format!("{name}: CPU time"),
        Some(run.user_seconds),
        bounds::startup::CHECK_SECONDS,
    );
    // a process that was never seen has no figure
    let peak = (run.peak_bytes > 0).then_some(run.peak_bytes as f64);
    table.check(&format!("{name}: memory"), peak, bounds::startup::CHECK_MEMORY);
}

/// The entry `kind` of this process's status, such as `RssAnon:` [bytes].
fn memory(kind: &str) -> f64 {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(kind));
    let kib = line.and_then(|l| l.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    kib.map_or(f64::NAN, |kib| 1024.0 * kib)
}

/// CPU time of this thread [s].
fn cpu_seconds() -> f64 {
    let text = fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds = text.split(' ').next().and_then(|n| n.parse::<f64>().ok());
    nanoseconds.map_or(f64::NAN, |n| 1e-9 * n)
}
