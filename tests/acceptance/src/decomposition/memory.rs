//! Memory of a particle and of a cell, of a large run, and of a long one.

use crate::bounds::{Unit, decomposition as bounds};
use crate::runs::{Job, Outcome};
use crate::section::Extent;
use crate::table::Table;

/// Room for a target of up to 10 million particles, at one a cell or ten [m].
const CELL: f64 = 1e-8;

/// A target at rest and a flyer of ten cells, up to time `end` [s]: six steps in 2.5e-12 s. All
/// particles are computed.
fn block(cells: usize, particles: usize, a_cell: usize, end: f64) -> Job {
    let length = |cells: usize| cells as f64 * CELL;
    // tiled without a remainder
    let target = length(particles / a_cell);
    let sets = [
        "decomposition.skip_quiescent=false".into(),
        "output.histories=null".into(),
        "reference=null".into(),
        format!("domain.cell_size={CELL:e}"),
        format!("domain.lower=[{:e}]", -length(1000)),
        format!("domain.upper=[{:e}]", length(cells - 1000)),
        format!("bodies.flyer.box.lower=[{:e}]", -length(10)),
        format!("bodies.target.box.upper=[{target:e}]"),
        format!("bodies.target.particles_per_cell=[{a_cell}]"),
        format!("time.end={end:e}"),
        format!("output.profiles.times=[{end:e}]"),
    ];
    sets.into_iter().fold(Job::new("flyer"), Job::set).watched()
}

/// What a run takes in its time loop: the median of what was seen, if most of it is that [bytes].
fn stepping(run: &Outcome) -> f64 {
    let mut seen = run.resident.clone();
    seen.sort_unstable();
    seen.get(seen.len() / 2).map_or(f64::NAN, |&bytes| bytes as f64)
}

/// Bytes a particle and a cell, a run of 10 million particles; where all is measured, 100 000 steps.
pub fn check(table: &mut Table) {
    const MILLION: usize = 1_000_000;
    // cells, particles, particles a cell
    let cases =
        [(2 * MILLION, MILLION, 2), (2 * MILLION, 2 * MILLION, 4), (4 * MILLION, MILLION, 2)];
    let runs: Vec<_> = cases
        .iter()
        .filter_map(|&(cells, particles, a_cell)| {
            let name = format!("{particles} particles on {cells} cells");
            // so many steps that most looks see them
            let run = table.take(&name, block(cells, particles, a_cell, 1e-11).run())?;
            table.beside(&name, Some(run.peak_bytes as f64), "", Unit::Bytes);
            Some(run)
        })
        .collect();
    if let [base, particles, cells] = &runs[..] {
        let more = |run: &Outcome, of: fn(&Outcome) -> f64| Some(of(run) - of(base));
        let counts = |run: &Outcome| [run.summary.particles as f64, run.summary.cells as f64];
        let [[p0, c0], [p1, _], [_, c1]] = [base, particles, cells].map(counts);
        let peak = |run: &Outcome| run.peak_bytes as f64;
        for (what, of) in [("in all", peak as fn(&Outcome) -> f64), ("in the steps", stepping)] {
            let a_particle = more(particles, of).map(|bytes| bytes / (p1 - p0));
            let a_cell = more(cells, of).map(|bytes| bytes / (c1 - c0));
            table.beside(&format!("bytes per particle, {what}"), a_particle, "", Unit::One);
            table.beside(&format!("bytes a cell, {what}"), a_cell, "", Unit::One);
        }
    }
    let name = "10 million particles";
    if let Some(run) = table.take(name, block(5 * MILLION + 2000, 10 * MILLION, 2, 2.5e-12).run()) {
        let (steps, seconds) = (run.summary.steps, run.summary.loop_wall_seconds);
        let name = format!("{name}: time loop of {steps} steps, whole run");
        let whole = format!("{:.3} s", run.summary.wall_seconds);
        table.beside(&name, Some(seconds), &whole, Unit::Seconds);
        table.beside("  memory at its peak", Some(run.peak_bytes as f64), "", Unit::Bytes);
    }
    if table.extent == Extent::Full {
        long(table);
    }
}

/// Memory of a gas that swings to and fro for 100 000 steps.
fn long(table: &mut Table) {
    for ranks in [1, 2] {
        let sets = [
            "domain.cell_size=0.02",
            "domain.patches=[10]",
            "reference=null",
            "output.histories=null",
            "time.end=480",
            "output.profiles.times=[480]",
            r#"decomposition.balance={"every":20,"cost":"particles"}"#,
        ];
        let job = sets.into_iter().fold(Job::new("sod"), Job::set).ranks(ranks).watched();
        let name = format!("a long run on {ranks} ranks");
        let Some(run) = table.take(&name, job.run()) else { continue };
        let steps = run.summary.steps as f64;
        table.check(&format!("{name}: steps"), Some(steps), bounds::memory::LONG_RUN_STEPS);
        // the last looks see what the outputs take
        let seen = &run.resident[run.resident.len() / 10..run.resident.len() * 19 / 20];
        let growth = seen.first().zip(seen.last()).map(|(&a, &b)| b as f64 - a as f64);
        let grown = growth.map(|bytes| bytes.max(0.0));
        table.check(&format!("{name}: memory gained"), grown, bounds::memory::GROWTH);
    }
}
