//! Ranks and whole runs that are killed at random moments: what is left can be gone on with.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use calibration::random::Random;
use flyer_mpm::driver::checkpoint::folder::list;

use super::runs::{command, folder, good, left, scene, steps, wait, with};
use crate::bounds::{Unit, reliability as bounds};
use crate::program;
use crate::table::Table;

/// Kills that are wanted.
const KILLS: u64 = bounds::kills::SAME_BITS.number() as u64;

/// Steps from one checkpoint to the next.
const EVERY: u64 = 20;

/// Most time from a kill to the end of all processes.
const SOON: Duration = Duration::from_secs(bounds::kills::LONGEST_END.number() as u64);

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
        let file = fs::read_link(format!("/proc/{id}/exe"));
        file.is_ok_and(|file| file.file_name() == program::path().file_name())
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

/// Whether a checkpoint or a profile for it is being written.
fn writes(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.into_iter().any(|e| e.file_name().to_string_lossy().starts_with('.'))
}

/// When a run is killed.
struct Moment<'a> {
    checkpoints: &'a Path,
    /// Once so many checkpoints have been written, ...
    after: u64,
    /// ... so much later, ...
    delay: Duration,
    /// ... and if wanted as the next one is being written.
    writing: bool,
}

/// Kills a run on two ranks: seconds until all its processes had ended, and whether it was writing
/// a checkpoint; `None` if it had come to its end before.
fn killed(args: &[String], victim: Victim, moment: &Moment) -> Option<(f64, bool)> {
    let mut run = command(2, args).spawn().ok()?;
    let said = run.stderr.take();
    let reader = std::thread::spawn(move || said.map(std::io::read_to_string));
    let ends = |run: &mut std::process::Child| run.try_wait().is_ok_and(|s| s.is_some());
    let mut ranks = Vec::new();
    let written = || list(moment.checkpoints).first().map_or(0, |(number, _)| *number);
    while written() < moment.after && !ends(&mut run) {
        std::thread::sleep(Duration::from_millis(1));
    }
    let since = Instant::now();
    while since.elapsed() < moment.delay && !ends(&mut run) {
        std::thread::sleep(Duration::from_millis(1));
    }
    while ranks.len() < 2 && !ends(&mut run) {
        ranks = ranks_of(run.id());
    }
    while moment.writing && !writes(moment.checkpoints) && !ends(&mut run) {}
    let writing = moment.writing.then_some(moment.checkpoints);
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
    let mut random = Random::new(2);
    let home = folder("kills");
    let place = |role: &str| home.join(role).display().to_string();
    let sets = [
        "domain.cell_size=4e-6",
        "time.end=2e-7",
        "output.profiles.times=[5e-8,2e-7]",
        &format!("output.checkpoint={{\"every_steps\":{EVERY}}}"),
    ];
    let args = scene("flyer", &sets);
    let whole = good(2, &with(&args, &["--output", &place("whole")]));
    let whole = whole.and_then(|()| left(&home.join("whole")));
    let Some(whole) = table.take("kills: a whole run", whole) else { return };
    let all = steps(&home.join("whole")) / EVERY;
    let (mut same, mut longest, mut hits, mut restarted, mut clean) = (0, 0.0f64, 0, 0, 0);
    let mut ends = [0; 3];
    let (mut k, mut tries) = (0, 0);
    while k < KILLS && tries < 3 * KILLS {
        tries += 1;
        let output = place("run");
        let checkpoints = home.join("run.checkpoints");
        let run = with(&args, &["--output", &output]);
        let kind = k % 3;
        let victim = if kind == 2 { Victim::All } else { Victim::Rank(kind as usize) };
        // one in ten as it starts, the rest all along the run, half of those within a writing
        let after = if k % 10 == 0 { 0 } else { 1 + random.below(all - 2) };
        let most = if after == 0 { 600 } else { 40 };
        let moment = Moment {
            checkpoints: &checkpoints,
            after,
            delay: Duration::from_millis(random.below(most)),
            writing: after > 0 && k % 2 == 1,
        };
        let Some((seconds, hit)) = killed(&run, victim, &moment) else {
            // it had ended: no kill, and another try
            let _ = fs::remove_dir_all(home.join("run"));
            let _ = fs::remove_dir_all(&checkpoints);
            continue;
        };
        k += 1;
        ends[kind as usize] += 1;
        hits += u64::from(hit);
        longest = longest.max(seconds);
        // a user continues if there is a checkpoint
        let again = list(&checkpoints).is_empty();
        restarted += u64::from(again);
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
    let figure = "kills after which the run ends with the same bits";
    table.all(figure, same, bounds::kills::SAME_BITS);
    table.all("the same: nothing is left behind after that", clean, bounds::kills::CLEAN);
    let figure = "longest from a kill to the end of all ranks";
    table.check(figure, Some(longest), bounds::kills::LONGEST_END);
    for (what, count) in ["rank 0", "rank 1", "all at once"].into_iter().zip(ends) {
        table.beside(&format!("kills of {what}"), Some(f64::from(count)), "", Unit::Count);
    }
    table.beside("kills while a checkpoint was written", Some(hits as f64), "", Unit::Count);
    table.beside("kills before the first checkpoint", Some(restarted as f64), "", Unit::Count);
}
