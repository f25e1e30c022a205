//! Signs of life of the ranks of one machine, through files. They are used at the start and the end
//! of a run, when ranks wait for each other but cannot send or answer messages. Independent of MPI.
//!
//! A thread of each rank regularly touches the rank's file. While the rank waits, the thread checks
//! the files of the other ranks. If a file is missing or has not been touched for long, its rank
//! hangs or was stopped. The lowest rank that is alive names it and ends its own process; the
//! launcher then ends the others.

use std::fs::{self, File};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use super::watch::{GRACE, hanging};

/// Exit code of a run that a rank has ended because another rank hangs.
pub(crate) const STALLED: i32 = 7;

/// Location of the files with the signs of life, and the ranks that write them.
#[derive(Clone, Debug)]
pub(crate) struct HeartbeatFiles {
    /// A folder that all ranks of this machine can access.
    pub folder: PathBuf,
    /// Part of the file names, unique to this run.
    pub job: String,
    /// Number of this rank on this machine, from 0, and number of ranks on this machine.
    pub local: [usize; 2],
    /// Number of this rank in the run, from 0, and number of ranks in the run.
    pub rank: [usize; 2],
}

impl HeartbeatFiles {
    fn file(&self, local: usize) -> PathBuf {
        self.folder.join(format!("alive-{}-{local}", self.job))
    }

    /// Rank in the run of a local rank. Its file states it; if all ranks run on one machine, it is
    /// known without the file.
    fn name(&self, local: usize) -> Option<usize> {
        let said = fs::read_to_string(self.file(local)).ok();
        let said = said.and_then(|text| text.split(' ').next()?.parse().ok());
        said.or((self.local[1] == self.rank[1]).then_some(local))
    }
}

/// Phase of a rank.
const STARTS: u8 = 0;
const RUNS: u8 = 1;
const ENDS: u8 = 2;

/// Text in the file of a rank that has ended.
const ENDED: &str = "ended";

/// The signs of life of this rank. Dropping it waits until the other ranks have ended.
pub(crate) struct Life {
    place: HeartbeatFiles,
    timeout: Duration,
    phase: Arc<AtomicU8>,
    over: Option<std::sync::mpsc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Life {
    /// Starts to give signs of life, and to check those of the others while this rank starts.
    /// `None` if the folder is not writable.
    pub fn start(place: HeartbeatFiles, timeout: Duration) -> Option<Life> {
        fs::write(place.file(place.local[0]), format!("{} ", place.rank[0])).ok()?;
        let mine = File::options().append(true).open(place.file(place.local[0])).ok()?;
        let phase = Arc::new(AtomicU8::new(STARTS));
        let (over, ended) = std::sync::mpsc::channel();
        let mut look = LifeWatch::new(place.clone(), timeout);
        let seen = phase.clone();
        let thread = std::thread::spawn(move || {
            let period = period(timeout);
            while let Err(std::sync::mpsc::RecvTimeoutError::Timeout) = ended.recv_timeout(period) {
                let _ = mine.set_modified(SystemTime::now());
                let verdict = look.at(seen.load(Ordering::Relaxed), Instant::now());
                if let Some(why) = verdict {
                    end(&why);
                }
            }
        });
        Some(Life { place, timeout, phase, over: Some(over), thread: Some(thread) })
    }

    /// Records that the rank has started: from now on, messages show whether ranks are alive.
    pub fn runs(&self) {
        self.phase.store(RUNS, Ordering::Relaxed);
    }

    /// Records that the rank is about to end: no messages from here on.
    pub fn ends(&self) {
        self.phase.store(ENDS, Ordering::Relaxed);
    }
}

impl Drop for Life {
    fn drop(&mut self) {
        let place = &self.place;
        let mine = place.file(place.local[0]);
        let _ = fs::write(&mine, format!("{} {ENDED}", place.rank[0]));
        self.ends();
        let ended = |local: usize| match fs::read_to_string(place.file(local)) {
            Ok(text) => text.ends_with(ENDED),
            // the rank has seen the end of all others and has removed its file
            Err(_) => true,
        };
        let since = Instant::now();
        // the thread names a rank that does not end
        while !(0..place.local[1]).all(ended) && since.elapsed() < 4 * self.timeout {
            std::thread::sleep(Duration::from_millis(1));
        }
        drop(self.over.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        let _ = fs::remove_file(mine);
    }
}

/// Time between two signs of life.
fn period(timeout: Duration) -> Duration {
    (timeout / 16).clamp(Duration::from_millis(5), Duration::from_secs(1))
}

/// Prints the reason and ends this process at once; no other code may run, because the process is
/// blocked.
fn end(why: &str) -> ! {
    if !why.is_empty() {
        eprintln!("error: {why}");
    }
    // SAFETY: it ends the process without a return; no handler runs that could wait in turn.
    unsafe { libc::_exit(STALLED) }
}

/// State of this rank's checks of the other ranks.
struct LifeWatch {
    place: HeartbeatFiles,
    timeout: Duration,
    /// Time for which this rank has waited. A jump of the clock counts little, because this rank
    /// itself may have been stopped.
    clock: Duration,
    seen: Instant,
    /// Modification time of each file, and the time by `clock` at which it was seen.
    touched: Vec<(Option<SystemTime>, Duration)>,
    /// Time by `clock` at which this rank left the report to another rank.
    left: Option<Duration>,
    phase: u8,
}

impl LifeWatch {
    fn new(place: HeartbeatFiles, timeout: Duration) -> Self {
        let touched = vec![(None, Duration::ZERO); place.local[1]];
        let (clock, seen) = (Duration::ZERO, Instant::now());
        LifeWatch { place, timeout, clock, seen, touched, left: None, phase: STARTS }
    }

    /// Checks all files. Returns the reason to end the run, if this rank has to report it. The text
    /// is empty if this rank had left the report to another rank and ends as well.
    fn at(&mut self, phase: u8, now: Instant) -> Option<String> {
        let grace = GRACE.min(self.timeout / 2);
        let elapsed = (now - self.seen).min(grace / 4);
        self.seen = now;
        if phase != self.phase || phase == RUNS {
            self.phase = phase;
            self.clock = Duration::ZERO;
            self.touched.fill((None, Duration::ZERO));
            self.left = None;
            return None;
        }
        self.clock += elapsed;
        for (local, known) in self.touched.iter_mut().enumerate() {
            let path = self.place.file(local);
            let touched = fs::metadata(&path).and_then(|m| m.modified()).ok();
            if touched != known.0 {
                *known = (touched, self.clock);
            }
        }
        if self.clock < self.timeout {
            return None;
        }
        // the reporting rank ends and gives no more signs of life
        if let Some(left) = self.left {
            return (self.clock >= left + grace).then(String::new);
        }
        let me = self.place.local[0];
        let lives = |local: usize| {
            let (touched, at) = self.touched[local];
            let gone = phase == ENDS && (touched.is_none() || has_ended(&self.place.file(local)));
            local == me || gone || (touched.is_some() && self.clock - at < grace)
        };
        let silent: Vec<usize> = (0..self.place.local[1]).filter(|&l| !lives(l)).collect();
        let [rank, ranks] = self.place.rank;
        if silent.is_empty() {
            let elsewhere = self.place.local[1] < ranks && phase == STARTS;
            return elsewhere.then(|| {
                let here = (0..self.place.local[1]).filter_map(|l| self.place.name(l));
                let others = others(here.chain([rank]).collect(), ranks);
                not_started(&others, self.timeout, rank)
            });
        }
        // only one rank reports
        if (0..self.place.local[1]).find(|l| !silent.contains(l)) != Some(me) {
            self.left = Some(self.clock);
            return None;
        }
        let named: Option<Vec<usize>> = silent.iter().map(|&l| self.place.name(l)).collect();
        Some(match named {
            Some(named) => hanging(&named, self.timeout, rank),
            None => {
                let seconds = self.timeout.as_secs_f64();
                format!(
                    "{} ranks of this machine have not started within {seconds} s: they hang or \
                     were stopped (rank {rank} waited for them)",
                    silent.len()
                )
            }
        })
    }
}

/// The ranks from 0 to `ranks` - 1 that are not in `here`, as ranges such as 2-5.
fn others(mut here: Vec<usize>, ranks: usize) -> Vec<RangeInclusive<usize>> {
    here.sort_unstable();
    here.push(ranks);
    let starts = std::iter::once(0).chain(here.iter().map(|rank| rank + 1));
    let gaps = starts.zip(&here).filter(|(start, end)| start < *end);
    gaps.map(|(start, end)| start..=end - 1).collect()
}

/// Message for a run whose ranks on this machine have all started, but not the `others`.
fn not_started(others: &[RangeInclusive<usize>], waited: Duration, waiter: usize) -> String {
    let seconds = waited.as_secs_f64();
    let name = |ranks: &RangeInclusive<usize>| match ranks.end() - ranks.start() {
        0 => ranks.start().to_string(),
        _ => format!("{}-{}", ranks.start(), ranks.end()),
    };
    let who = match others {
        [one] if one.start() == one.end() => format!("rank {} on another machine", one.start()),
        _ => {
            let names: Vec<String> = others.iter().map(name).collect();
            format!("one of ranks {} on other machines", names.join(", "))
        }
    };
    format!(
        "the run has not started within {seconds} s: {who} hangs or was stopped (rank {waiter} \
         waited for it)"
    )
}

fn has_ended(file: &Path) -> bool {
    fs::read_to_string(file).is_ok_and(|text| text.ends_with(ENDED))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The checks of rank 0 of three on one machine, and a folder for their files.
    fn look(name: &str) -> (LifeWatch, PathBuf) {
        let folder = std::env::temp_dir().join(format!("decomp-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let place =
            HeartbeatFiles { folder: folder.clone(), job: "j".into(), local: [0, 3], rank: [0, 3] };
        (LifeWatch::new(place, Duration::from_secs(4)), folder)
    }

    /// The first verdict within eight simulated seconds and its time [s], with one check each
    /// quarter of a second. The ranks in `alive` touch their files before each check.
    fn first_verdict(look: &mut LifeWatch, phase: u8, alive: &[usize]) -> Option<(f64, String)> {
        let start = look.seen;
        (1..=32).find_map(|k| {
            for &local in alive {
                let file = File::options().append(true).create(true).open(look.place.file(local));
                let at = SystemTime::UNIX_EPOCH + Duration::from_secs(k);
                file.unwrap().set_modified(at).unwrap();
            }
            let clock = Duration::from_millis(250 * k);
            look.at(phase, start + clock).map(|why| (clock.as_secs_f64(), why))
        })
    }

    #[test]
    fn a_rank_without_a_sign_of_life_is_named() {
        let (mut one, folder) = look("missing");
        let (at, why) = first_verdict(&mut one, STARTS, &[0, 1]).unwrap();
        assert!(why.starts_with("rank 2 has made no progress for 4 s: it hangs"), "{why}");
        assert!((4.0..5.0).contains(&at), "{at}");
        // a rank that started and was then stopped, named by the text of its file
        fs::write(one.place.file(1), "1 ").unwrap();
        let mut again = LifeWatch::new(one.place.clone(), one.timeout);
        let (_, why) = first_verdict(&mut again, STARTS, &[0, 2]).unwrap();
        assert!(why.starts_with("rank 1 has made no progress"), "{why}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn one_rank_speaks_for_all() {
        let (mut one, folder) = look("speaker");
        one.place.local = [1, 3];
        let (at, why) = first_verdict(&mut one, STARTS, &[0, 1]).unwrap();
        assert!(why.is_empty() && at > 5.0, "{at} {why}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn ranks_that_live_are_waited_for() {
        let (mut one, folder) = look("alive");
        assert_eq!(first_verdict(&mut one, STARTS, &[0, 1, 2]), None);
        // no checks in the time loop
        assert_eq!(first_verdict(&mut one, RUNS, &[0]), None);
        // a rank that has ended is not waited for
        fs::write(one.place.file(1), "1 ended").unwrap();
        assert_eq!(first_verdict(&mut one, ENDS, &[0, 2]), None);
        let mut again = LifeWatch::new(one.place.clone(), one.timeout);
        again.phase = ENDS;
        let (_, why) = first_verdict(&mut again, ENDS, &[0]).unwrap();
        assert!(why.starts_with("rank 2 has made no progress"), "{why}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn where_ranks_of_other_machines_are_missing_none_is_named() {
        let (mut one, folder) = look("elsewhere");
        one.place.rank = [4, 9];
        let (_, why) = first_verdict(&mut one, STARTS, &[0, 1, 2]).unwrap();
        assert!(why.contains("one of ranks 0-3, 5-8 on other machines hangs"), "{why}");
        for (local, rank) in [4, 0, 5].into_iter().enumerate() {
            fs::write(one.place.file(local), format!("{rank} ")).unwrap();
        }
        let mut again = LifeWatch::new(one.place.clone(), one.timeout);
        let (_, why) = first_verdict(&mut again, STARTS, &[0, 1, 2]).unwrap();
        assert!(why.contains("s: one of ranks 1-3, 6-8 on other machines hangs"), "{why}");
        again = LifeWatch::new(HeartbeatFiles { rank: [4, 4], ..one.place.clone() }, one.timeout);
        fs::write(again.place.file(0), "1 ").unwrap();
        fs::write(again.place.file(2), "3 ").unwrap();
        let (_, why) = first_verdict(&mut again, STARTS, &[0, 1, 2]).unwrap();
        assert!(why.contains("s: rank 2 on another machine hangs"), "{why}");
        fs::remove_file(one.place.file(2)).unwrap();
        let mut again = LifeWatch::new(one.place.clone(), one.timeout);
        let (_, why) = first_verdict(&mut again, STARTS, &[0, 1]).unwrap();
        assert!(why.starts_with("1 ranks of this machine have not started"), "{why}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn ranks_end_together() {
        let (one, folder) = look("end");
        let place = |k: usize| HeartbeatFiles { local: [k, 3], rank: [k, 3], ..one.place.clone() };
        std::thread::scope(|scope| {
            for k in 0..3 {
                let place = place(k);
                scope.spawn(move || {
                    let life = Life::start(place, Duration::from_secs(20)).unwrap();
                    life.runs();
                    std::thread::sleep(Duration::from_millis(20 * k as u64));
                    life.ends();
                });
            }
        });
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir_all(folder).unwrap();
    }
}
