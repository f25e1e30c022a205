//! What a second rank or thread gains, and what more patches cost: time loops, medians of runs
//! taken in turn, with every particle computed.

use flyer_mpm::study::scaling::statistics::median;

use crate::bounds::{Unit, decomposition as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Runs of each kind.
const ROUNDS: usize = 5;

/// Medians of a job's runs [s].
struct Times {
    wall: f64,
    user: f64,
}

/// Speed-up of two workers on a large and on the shipped small problem.
pub fn check(table: &mut Table) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    if cores < 2 {
        table.not_measured("speed-up of two workers", "two cores needed");
        return;
    }
    for (what, job, bound) in [
        ("106 000 particles", large(), bounds::speed::LARGE_GAIN),
        ("1700 particles", small(), bounds::speed::SMALL_GAIN),
    ] {
        let job = job.set("decomposition.skip_quiescent=false").set("output.histories=null");
        let ranks = |n| job.clone().ranks(n).on_own_cores();
        let threads = |n| job.clone().threads(n);
        let patches = |n: usize| threads(1).set(format!("domain.patches=[{n}]"));
        let jobs = [ranks(1), ranks(2), threads(1), threads(2), patches(1), patches(16)];
        let Some(times) = table.take(what, in_turn(&jobs)) else { continue };
        let gain = |a: usize, b: usize| Some(times[a].wall / times[b].wall);
        let mut user = |workers: &str, time: &Times| {
            let name = format!("  {workers}: time loop, user CPU of the process");
            table.beside(&name, Some(time.wall), &format!("{:.3} s", time.user), Unit::Seconds);
        };
        let names = ["1 rank", "2 ranks", "1 thread", "2 threads", "1 patch", "16 patches"];
        names.iter().zip(&times).for_each(|(name, time)| user(name, time));
        let name = format!("{what}: 2 ranks against 1");
        table.check(&name, gain(0, 1), bound);
        let name = format!("{what}: 2 threads against 1");
        table.check(&name, gain(2, 3), bound);
        let name = format!("{what}: time with 16 patches over 1");
        table.check(&name, gain(5, 4), bounds::speed::SIXTEEN_PATCHES);
    }
}

/// Cells so small that 100 000 particles are in the domain, for a second or two.
fn large() -> Job {
    let job = Job::new("flyer").set("domain.cell_size=1.6e-7");
    job.set("time.end=1.4e-9").set("output.profiles.times=[1.4e-9]")
}

fn small() -> Job {
    Job::new("flyer").set("output.profiles.times=[1e-6]")
}

/// Runs the jobs in turn, so that what else the machine does falls on all alike.
fn in_turn(jobs: &[Job]) -> Result<Vec<Times>, String> {
    let mut runs: Vec<Vec<Outcome>> = jobs.iter().map(|_| Vec::new()).collect();
    for _ in 0..ROUNDS {
        for (runs, job) in runs.iter_mut().zip(jobs) {
            runs.push(job.run()?);
        }
    }
    let of_runs = |runs: &Vec<Outcome>, seconds: fn(&Outcome) -> f64| {
        median(runs.iter().map(seconds)).expect("a job has runs")
    };
    let times = runs.iter().map(|runs| Times {
        wall: of_runs(runs, |r| r.summary.loop_wall_seconds),
        user: of_runs(runs, |r| r.user_seconds),
    });
    Ok(times.collect())
}
