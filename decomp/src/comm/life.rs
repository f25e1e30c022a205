//! Signs of life of the ranks of one machine, in files: for the start and the end of a run, when
//! ranks wait for each other where no message can be sent and none answers. Knows no MPI.
//!
//! A thread of each rank touches the rank's file again and again. While the rank is held up, it
//! looks at the files of the others: one that is missing, or that nobody has touched for long, is
//! that of a rank that hangs or was stopped. The lowest rank that lives names it and ends its own
//! process; the launcher ends the others.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use super::watch::{GRACE, hanging};

/// Exit code of a run that a rank has ended because another hangs.
pub(crate) const STALLED: i32 = 7;

/// Which ranks give signs of life, and where.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// A folder that the ranks of this machine share.
    pub folder: PathBuf,
    /// What the names of the files begin with: the ranks of no other run have it.
    pub job: String,
    /// The number of this rank on this machine, from 0, and that of all of them.
    pub local: [usize; 2],
    /// The number of this rank in the run, from 0, and that of all of them.
    pub rank: [usize; 2],
}

impl Place {
    fn file(&self, local: usize) -> PathBuf {
        self.folder.join(format!("alive-{}-{local}", self.job))
    }

    /// The rank of a number on this machine: its own file says it, and on one machine it is known
    /// before that.
    fn name(&self, local: usize) -> Option<usize> {
        let said = fs::read_to_string(self.file(local)).ok();
        let said = said.and_then(|text| text.split(' ').next()?.parse().ok());
        said.or((self.local[1] == self.rank[1]).then_some(local))
    }
}

/// What a rank does.
const STARTS: u8 = 0;
const RUNS: u8 = 1;
const ENDS: u8 = 2;

/// What the file of a rank that has come to its end says.
const ENDED: &str = "ended";

/// The signs of life of this rank; to drop it is to wait until the others have come to their end.
pub(crate) struct Life {
    place: Place,
    timeout: Duration,
    phase: Arc<AtomicU8>,
    over: Option<std::sync::mpsc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Life {
    /// Begins to give signs of life, and to look at those of the others as long as this rank
    /// starts; none where the folder cannot be written.
    pub fn start(place: Place, timeout: Duration) -> Option<Life> {
        fs::write(place.file(place.local[0]), format!("{} ", place.rank[0])).ok()?;
        let mine = File::options().append(true).open(place.file(place.local[0])).ok()?;
        let phase = Arc::new(AtomicU8::new(STARTS));
        let (over, ended) = std::sync::mpsc::channel();
        let mut look = Look::new(place.clone(), timeout);
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

    /// The rank has started: it waits for others where they answer.
    pub fn runs(&self) {
        self.phase.store(RUNS, Ordering::Relaxed);
    }

    /// The rank is about to end: no messages from here on.
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
            // it has seen the end of all others, and has gone
            Err(_) => true,
        };
        let since = Instant::now();
        // the thread names who does not come
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

/// Ends this process and tells why; nothing else of it may run, for it is held up.
fn end(why: &str) -> ! {
    if !why.is_empty() {
        eprintln!("error: {why}");
    }
    // SAFETY: it ends the process without a return; no handler runs that could wait in turn.
    unsafe { libc::_exit(STALLED) }
}

/// What a rank has seen of the others.
struct Look {
    place: Place,
    timeout: Duration,
    /// Time for which the rank has been held up. A jump counts little: the rank itself may have
    /// been stopped.
    clock: Duration,
    seen: Instant,
    /// When each file was touched, and when that was seen, by the clock.
    touched: Vec<(Option<SystemTime>, Duration)>,
    /// When another rank was left to tell that some are silent, by the clock.
    left: Option<Duration>,
    phase: u8,
}

impl Look {
    fn new(place: Place, timeout: Duration) -> Self {
        let touched = vec![(None, Duration::ZERO); place.local[1]];
        let (clock, seen) = (Duration::ZERO, Instant::now());
        Look { place, timeout, clock, seen, touched, left: None, phase: STARTS }
    }

    /// Looks at all files; why the run has to end, if it has and this rank is the one to tell. The
    /// text is empty where another rank was left to tell it, and this one ends as well.
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
        // the one that was left to tell ends as it does, and is silent from then on
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
                let seconds = self.timeout.as_secs_f64();
                format!(
                    "the run has not started within {seconds} s: a rank on another machine hangs \
                     or was stopped (rank {rank} waited for it)"
                )
            });
        }
        // one speaks for all
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

fn has_ended(file: &Path) -> bool {
    fs::read_to_string(file).is_ok_and(|text| text.ends_with(ENDED))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A look of rank 0 of three on one machine, and a folder for their files.
    fn look(name: &str) -> (Look, PathBuf) {
        let folder = std::env::temp_dir().join(format!("decomp-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let place = Place { folder: folder.clone(), job: "j".into(), local: [0, 3], rank: [0, 3] };
        (Look::new(place, Duration::from_secs(4)), folder)
    }

    /// The first verdict within eight simulated seconds and its time [s], with one look each quarter
    /// of a second; the ranks in `alive` touch their files before each look.
    fn first_verdict(look: &mut Look, phase: u8, alive: &[usize]) -> Option<(f64, String)> {
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
        // one that has started and was stopped, by what its file says
        fs::write(one.place.file(1), "1 ").unwrap();
        let mut again = Look::new(one.place.clone(), one.timeout);
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
        // in the time loop nobody looks
        assert_eq!(first_verdict(&mut one, RUNS, &[0]), None);
        // who has ended is not waited for
        fs::write(one.place.file(1), "1 ended").unwrap();
        assert_eq!(first_verdict(&mut one, ENDS, &[0, 2]), None);
        let mut again = Look::new(one.place.clone(), one.timeout);
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
        assert!(why.contains("a rank on another machine hangs"), "{why}");
        fs::remove_file(one.place.file(2)).unwrap();
        let mut again = Look::new(one.place.clone(), one.timeout);
        let (_, why) = first_verdict(&mut again, STARTS, &[0, 1]).unwrap();
        assert!(why.starts_with("1 ranks of this machine have not started"), "{why}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn ranks_end_together() {
        let (one, folder) = look("end");
        let place = |k: usize| Place { local: [k, 3], rank: [k, 3], ..one.place.clone() };
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
