//! Predicted messages, bytes and memory of the performance model, compared with the counters of runs.

use decomp::Comm;
use decomp::comm::local::run_ranks;
use flyer_mpm::driver::memory::needed_memory;
use flyer_mpm::input;
use flyer_mpm::perf_model::{Sent, Work};
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Simulation, WantedLayout};
use flyer_mpm::solver::Stepper;

use crate::bounds::{Unit, scale as bounds};
use crate::program;
use crate::runs::Job;
use crate::section::Extent;
use crate::table::Table;

/// Steps that are counted: fewer than from one look at the balance of the loads to the next.
const STEPS: u64 = 20;

/// Scenes on a line and in a plane, with patches for 64 ranks and with those that a run chooses.
const SCENES: [(&str, &[&str]); 4] = [
    ("flyer", &["domain.cell_size=1e-6"]),
    ("flyer", &["domain.cell_size=1e-6", "decomposition.filter_halo=exchange"]),
    ("flyer_2d", &["domain.cell_size=4e-5", "domain.patches=[12,8]"]),
    ("disks", &["domain.cell_size=1e-2"]),
];

/// Numbers of ranks, and the quick ones.
const RANKS: [usize; 6] = [2, 4, 8, 16, 32, 64];
const QUICK: [usize; 2] = [2, 8];

/// Messages, bytes and memory of ranks in runs over those of the model.
pub fn check(table: &mut Table) {
    let usual = table.extent >= Extent::Usual;
    for ((name, sets), end) in [(SCENES[0], "2e-9"), (SCENES[2], "3e-8")] {
        let ranks = if usual { &[1, 8, 64][..] } else { &[2] };
        ranks.iter().for_each(|&ranks| memory(table, (name, sets), end, ranks));
    }
    for (name, sets) in SCENES {
        let ranks: &[usize] = if usual { &RANKS } else { &QUICK };
        for &ranks in ranks {
            let case = format!("{name}.json, {}, {ranks} ranks", sets.join(" "));
            let Some(scene) = table.take(&case, scene(name, sets)) else { continue };
            let Some((counted, _)) = table.take(&case, counted(&scene, ranks, 0)) else { continue };
            traffic(table, &case, (&scene, None), &counted);
        }
    }
    // particles at an edge of the flyer have stretched, and each reaches more nodes
    let (name, sets) = SCENES[2];
    let case = format!("{name}.json, {}, 8 ranks, from step 40", sets.join(" "));
    let Some(scene) = table.take(&case, scene(name, sets)) else { return };
    let Some((counted, longest)) = table.take(&case, counted(&scene, 8, 40)) else { return };
    traffic(table, &case, (&scene, Some(longest)), &counted);
}

fn scene(name: &str, sets: &[&str]) -> Result<CheckedScene, String> {
    let path = program::root().join(format!("inputs/{name}.json"));
    let bytes = input::read(&path).map_err(|e| e.to_string())?;
    let sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
    input::parse(&bytes, name, &sets).map_err(|e| e.to_string())
}

/// Messages and bytes that each rank sends in a step, counted by its communicator after some steps,
/// and the longest particle then [cells].
type Counted = Result<(Vec<Sent>, f64), String>;

fn counted(scene: &CheckedScene, ranks: usize, after: u64) -> Counted {
    match scene.dimension {
        1 => counted_in::<1>(scene, ranks, after),
        _ => counted_in::<2>(scene, ranks, after),
    }
}

fn counted_in<const D: usize>(scene: &CheckedScene, ranks: usize, after: u64) -> Counted
where
    Stepper<D>: Compiled<D>,
{
    let all = run_ranks(ranks, |comm| {
        let mut simulation =
            Simulation::<D>::new(scene, comm, 1).map_err(|error| error.to_string())?;
        let steps = |simulation: &mut Simulation<'_, D>, count: u64| {
            let end = scene.scene.time.end;
            (0..count).try_for_each(|_| simulation.advance(end)).map_err(|error| error.to_string())
        };
        steps(&mut simulation, after)?;
        let before = comm.traffic();
        steps(&mut simulation, STEPS)?;
        let (after, per_step) = (comm.traffic(), 1.0 / STEPS as f64);
        let sent = Sent {
            messages: (after.messages - before.messages) as f64 * per_step,
            bytes: (after.bytes - before.bytes) as f64 * per_step,
        };
        Ok((sent, simulation.longest()))
    });
    let all = all.into_iter().collect::<Result<Vec<(Sent, f64)>, String>>()?;
    let longest = all[0].1;
    Ok((all.into_iter().map(|(sent, _)| sent).collect(), longest))
}

/// The greatest deviation of a rank, for a longest particle [cells], if it is not that of the start.
fn traffic(
    table: &mut Table,
    case: &str,
    (scene, longest): (&CheckedScene, Option<f64>),
    counted: &[Sent],
) {
    let ranks = counted.len();
    let wanted = WantedLayout { ranks, threads: 1, halo: None, longest, time: 0.0 };
    let work = Work::new(scene);
    let share = Work::share_of(scene, &wanted).ok_or("a particle is too long".to_string());
    let Some(share) = table.take(case, share) else { return };
    let predicted = work.sent(&share);
    let numbers = share.layout.ranks.iter().map(|rank| rank.rank);
    let pairs: Vec<(Sent, Sent)> =
        numbers.zip(predicted).map(|(rank, sent)| (sent, counted[rank])).collect();
    let worst = |of: fn(&Sent) -> f64| {
        let deviation = |(predicted, counted): &(Sent, Sent)| of(predicted) / of(counted) - 1.0;
        pairs.iter().map(|pair| deviation(pair).abs()).fold(0.0, f64::max)
    };
    let of_all = |of: fn(&Sent) -> f64| counted.iter().map(of).sum::<f64>() / ranks as f64;
    table.check(
        &format!("{case}: predicted over counted messages of a rank, less 1"),
        Some(worst(|sent| sent.messages)),
        bounds::prediction::MESSAGES,
    );
    table.beside("  messages of a rank and step", Some(of_all(|s| s.messages)), "", Unit::One);
    table.check(
        "  predicted over counted bytes of a rank, less 1",
        Some(worst(|sent| sent.bytes)),
        bounds::prediction::BYTES,
    );
    table.beside("  bytes of a rank and step", Some(of_all(|s| s.bytes)), "", Unit::Bytes);
}

/// Memory of the fullest process of a run to `end` \[s\] over that of the model.
fn memory(table: &mut Table, (name, sets): (&'static str, &[&str]), end: &str, ranks: usize) {
    let case = format!("{name}.json, {}, {ranks} ranks: memory", sets.join(" "));
    let end = format!("time.end={end}");
    let output = r#"output={"pictures":false}"#;
    let short = [&end[..], output, "output.checkpoint.keep=0", "reference=null"];
    let sets = [sets, &short].concat();
    let job = sets.iter().fold(Job::new(name), |job, set| job.set(*set)).ranks(ranks).watched();
    let (run, scene) = (table.take(&case, job.run()), table.take(&case, scene(name, &sets)));
    let (Some(run), Some(scene)) = (run, scene) else { return };
    let of = |rank| needed_memory(&scene, rank, ranks, 1) as f64;
    let predicted = (0..ranks).map(of).fold(0.0, f64::max);
    let over = predicted / run.peak_bytes as f64 - 1.0;
    let figure = format!("{case} of the fullest process, predicted, less 1");
    table.check(&figure, Some(over), bounds::prediction::MEMORY);
    table.beside("  memory", Some(run.peak_bytes as f64), "", Unit::Bytes);
}
