//! Ranks and whole runs that are killed at random moments: what is left can be gone on with.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::program::{Random, command, folder, good, left, scene, wait, with};
use crate::table::{Show, Table};

const KILLS: u64 = 50;

/// Most time from a kill to the end of all processes.
const SOON: Duration = Duration::from_secs(10);

/// Who is killed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Victim {
    Rank(usize),
    All,
}

/// The ranks that mpirun has started.
fn ranks_of(mpirun: u32) -> Vec<u32> {
    let text = fs::read_to_string(format!("/proc/{mpirun}/task/{mpirun}/children"));
    let all = text.unwrap_or_default();
    let children = all.split_whitespace().filter_map(|id| id.parse().ok());
    let is_ours = |id: &u32| {
        fs::read_to_string(format!("/proc/{id}/comm")).is_ok_and(|c| c.starts_with("flyer-mpm"))
    };
    children.filter(is_ours).collect()
}

fn kill(process: u32) {
    let _ = Command::new("kill").args(["-KILL", &process.to_string()]).status();
}

fn lives(process: u32) -> bool {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // a zombie that nobody has asked for is no process
    stat.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with('Z'))
}

/// Whether a checkpoint is being written.
fn writes(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.into_iter().any(|e| e.file_name().to_string_lossy().starts_with(".checkpoint-"))
}

/// Kills a run on two ranks after `delay`, if wanted while it writes a checkpoint: seconds until
/// all its processes had ended, and whether it was writing; `None` if it had ended before.
fn killed(
    args: &[String],
    victim: Victim,
    delay: Duration,
    writing: Option<&Path>,
) -> Option<(f64, bool)> {
    let mut run = command(2, args).spawn().ok()?;
    let said = run.stderr.take();
    let reader = std::thread::spawn(move || said.map(std::io::read_to_string));
    let ends = |run: &mut std::process::Child| run.try_wait().is_ok_and(|s| s.is_some());
    let (since, mut ranks) = (Instant::now(), Vec::new());
    while since.elapsed() < delay && !ends(&mut run) {
        std::thread::sleep(Duration::from_millis(1));
    }
    while writing.is_some_and(|folder| !writes(folder)) && !ends(&mut run) {}
    while ranks.len() < 2 && !ends(&mut run) {
        ranks = ranks_of(run.id());
    }
    let hit = writing.is_some_and(writes);
    if ends(&mut run) {
        return None;
    }
    let at = Instant::now();
    match victim {
        Victim::Rank(rank) => kill(ranks[rank]),
        Victim::All => {
            // all at once, before one can hear of another's end
            let all: Vec<String> = ranks.iter().chain([&run.id()]).map(u32::to_string).collect();
            let _ = Command::new("kill").arg("-KILL").args(&all).status();
        }
    }
    wait(&mut run, 2 * SOON);
    while ranks.iter().any(|&r| lives(r)) && at.elapsed() < 2 * SOON {
        std::thread::sleep(Duration::from_millis(2));
    }
    let seconds = at.elapsed().as_secs_f64();
    ranks.iter().filter(|&&r| lives(r)).for_each(|&r| kill(r));
    let _ = reader.join();
    Some((seconds, hit))
}

/// Kills at random moments, half of them while a checkpoint is written.
pub fn check(table: &mut Table) {
    let mut random = Random(2);
    let home = folder("kills");
    let place = |role: &str| home.join(role).display().to_string();
    let sets = [
        "domain.cell_size=2e-6",
        "time.end=2e-7",
        "output.profiles.times=[5e-8,2e-7]",
        "output.checkpoint={\"every_steps\":20}",
    ];
    let args = scene("flyer", &sets);
    let started = Instant::now();
    let whole = good(2, &with(&args, &["--output", &place("whole")]));
    let whole = whole.and_then(|()| left(&home.join("whole")));
    let Some(whole) = table.take("kills: a whole run", whole) else { return };
    let length = started.elapsed();
    let (mut same, mut longest, mut hits, mut anew, mut clean) = (0, 0.0f64, 0, 0, 0);
    let mut ends = [0; 3];
    for k in 0..KILLS {
        let output = place("run");
        let checkpoints = home.join("run.checkpoints");
        let run = with(&args, &["--output", &output]);
        let (kind, writing) = (k % 3, k % 2 == 1);
        let victim = if kind == 2 { Victim::All } else { Victim::Rank(kind as usize) };
        let delay = length.mul_f64(random.below(1000) as f64 / 1100.0);
        let folder = writing.then_some(&checkpoints as &Path);
        let Some((seconds, hit)) = killed(&run, victim, delay, folder) else {
            // it was over before: a moment of its own
            same += 1;
            clean += 1;
            continue;
        };
        ends[kind as usize] += 1;
        hits += u64::from(hit);
        longest = longest.max(seconds);
        // a user goes on if there is something to go on from
        let again = flyer_mpm::checkpoint::folder::list(&checkpoints).is_empty();
        anew += u64::from(again);
        let on = if again { run } else { with(&[], &["--restart", &output]) };
        let outcome = good(2, &on).and_then(|()| left(&home.join("run")));
        match outcome.map(|left| left.differs(&whole)) {
            Ok(None) => same += 1,
            Ok(Some(what)) => println!("  kill {k} of {victim:?}: other {what}"),
            Err(message) => println!("  kill {k} of {victim:?}: {message}"),
        }
        let names: Vec<_> = fs::read_dir(&home).into_iter().flatten().flatten().collect();
        let hidden = names.iter().any(|e| e.file_name().to_string_lossy().starts_with('.'));
        let partial = writes(&checkpoints);
        clean += u64::from(!hidden && !partial && names.len() <= 4);
        let _ = fs::remove_dir_all(home.join("run"));
        let _ = fs::remove_dir_all(&checkpoints);
    }
    let bound = format!("all {KILLS}");
    table.holds(
        "kills after which the run ends with the same bits",
        &same.to_string(),
        &bound,
        same == KILLS,
    );
    table.holds(
        "the same: nothing is left behind after that",
        &clean.to_string(),
        &bound,
        clean == KILLS,
    );
    table.at_most(
        "longest from a kill to the end of all ranks",
        Some(longest),
        SOON.as_secs_f64(),
        Show::Seconds,
    );
    let kinds = format!("{}, {}, {}", ends[0], ends[1], ends[2]);
    table.beside("kills of rank 0", Some(ends[0] as f64), &kinds, Show::Number);
    table.beside("kills while a checkpoint was written", Some(hits as f64), "", Show::Number);
    table.beside("kills before the first checkpoint", Some(anew as f64), "", Show::Number);
}
