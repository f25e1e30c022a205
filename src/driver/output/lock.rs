//! Lock on a folder of results: a hidden file beside it that names the process that writes.
//!
//! The system's lock on the file ends with the process, however it ends, so that a remaining file
//! blocks no later run. If another machine wrote the file, its lock may be invisible here; then the
//! age of the file decides, because a live run touches the file regularly. Independent of MPI:
//! called on one rank only.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use super::error::OutputError;
use super::folder::{aside_prefix, check_folder, host, is_dead, within};
use super::origin::Origin;
use super::paths::resolve;

/// Time between two signs of life.
const TOUCHED: Duration = Duration::from_secs(15);

/// A run on another machine without a sign of life for this time is taken to have ended.
const STALE: Duration = Duration::from_secs(90);

/// Attempts to read the owner of a file that was just locked, and the pause between two of them.
const WRITTEN_TRIES: usize = 100;
const WRITTEN_PAUSE: Duration = Duration::from_millis(10);

/// Process that writes.
#[derive(Debug, Serialize, Deserialize)]
struct Owner {
    pid: u32,
    host: String,
    /// The command and the scene of a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
}

/// Exclusive right to write results at a path, until dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Open file that holds the system's lock.
    _file: File,
    /// Parent folders that were created for it, outermost first.
    made: Vec<PathBuf>,
    /// Ends the signs of life.
    end: Option<Sender<()>>,
    alive: Option<JoinHandle<()>>,
}

impl Lock {
    /// Locks the path `target` of results and creates its parent folders. Fails if another process
    /// holds the lock.
    ///
    /// # Errors
    ///
    /// If another process holds the lock, or if the path cannot be used.
    pub fn take(target: &Path) -> Result<Lock, OutputError> {
        Lock::take_with(target, None)
    }

    /// As [`Lock::take`], with the command and the scene for which the path is locked; [`holder`]
    /// reads them.
    ///
    /// # Errors
    ///
    /// As [`Lock::take`].
    pub fn take_for(target: &Path, origin: &Origin) -> Result<Lock, OutputError> {
        Lock::take_with(target, Some(origin))
    }

    fn take_with(target: &Path, origin: Option<&Origin>) -> Result<Lock, OutputError> {
        let place = resolve(target)?;
        let Some(parent) = place.parent() else {
            return Err(OutputError::Fixed { path: target.into(), why: "the root folder" });
        };
        check_folder(target, &place)?;
        let path = lock_file(&place, parent);
        let owner = Owner { pid: std::process::id(), host: host(), origin: origin.cloned() };
        let mut made = Vec::new();
        match Lock::open(target, (parent, &path), &mut made, &owner) {
            Ok(file) => Ok(Lock::keep(path, file, made)),
            Err(error) => {
                made.iter().rev().for_each(|parent| drop(fs::remove_dir(parent)));
                Err(error)
            }
        }
    }

    /// Opens and locks the file at `path` in `parent`, and writes the owner. Parent folders that are
    /// created are added to `made`.
    fn open(
        target: &Path,
        (parent, path): (&Path, &Path),
        made: &mut Vec<PathBuf>,
        mine: &Owner,
    ) -> Result<File, OutputError> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let what = ("write the lock file", path);
        loop {
            let mut file = within(parent, made, what, || options.open(path))?;
            let taken = match file.try_lock() {
                Ok(()) => false,
                Err(TryLockError::WouldBlock) => true,
                // on a file system without locks, the text of the file decides
                Err(TryLockError::Error(_)) => !said_by_dead(&mut file),
            };
            let owner = read_owner(&mut file);
            let elsewhere = owner.as_ref().is_some_and(|o| o.host != host());
            let age =
                file.metadata().and_then(|m| m.modified()).ok().and_then(|m| m.elapsed().ok());
            let fresh = age.is_none_or(|age| age < STALE);
            if taken || (elsewhere && fresh) {
                let (pid, host) = owner.map_or((0, "?".into()), |o| (o.pid, o.host));
                return Err(OutputError::Locked {
                    path: target.into(),
                    pid,
                    host,
                    lock: path.into(),
                });
            }
            // another process may have removed the file or its folder meanwhile
            let same = fs::metadata(path).is_ok_and(|now| {
                file.metadata().is_ok_and(|mine| (mine.dev(), mine.ino()) == (now.dev(), now.ino()))
            });
            if !same {
                continue;
            }
            let text = serde_json::to_string(mine).expect("an owner is plain data");
            file.set_len(0)
                .and_then(|()| std::io::Seek::rewind(&mut file))
                .and_then(|()| file.write_all(text.as_bytes()))
                .map_err(OutputError::io(what.0, path))?;
            return Ok(file);
        }
    }

    /// Keeps the file open and gives signs of life.
    fn keep(path: PathBuf, file: File, made: Vec<PathBuf>) -> Lock {
        let (end, ended) = channel::<()>();
        let touched = file.try_clone().ok();
        let alive = std::thread::spawn(move || {
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(TOUCHED) {
                if let Some(file) = &touched {
                    let _ = file.set_modified(SystemTime::now());
                }
            }
        });
        Lock { path, _file: file, made, end: Some(end), alive: Some(alive) }
    }
}

impl Drop for Lock {
    /// Best effort: a remaining file blocks no later run.
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(alive) = self.alive.take() {
            let _ = alive.join();
        }
        let _ = fs::remove_file(&self.path);
        for parent in self.made.iter().rev() {
            let _ = fs::remove_dir(parent);
        }
    }
}

/// Path of the lock file for results at `place` in `parent`.
fn lock_file(place: &Path, parent: &Path) -> PathBuf {
    parent.join(format!("{}lock", aside_prefix(place)))
}

/// The command and the scene for which a live process has locked the path `target`; `None` if it has
/// not named them. Waits a moment for a process that has just locked the path.
pub fn holder(target: &Path) -> Option<Origin> {
    let place = resolve(target).ok()?;
    let path = lock_file(&place, place.parent()?);
    for _ in 0..WRITTEN_TRIES {
        let mut file = File::open(&path).ok()?;
        // text of a process that has ended is about to be replaced
        let owner = read_owner(&mut file);
        match owner.filter(|owner| owner.host != host() || !is_dead(&owner.pid.to_string())) {
            Some(owner) => return owner.origin,
            None => std::thread::sleep(WRITTEN_PAUSE),
        }
    }
    None
}

fn read_owner(file: &mut File) -> Option<Owner> {
    let mut text = String::new();
    std::io::Seek::rewind(file).ok()?;
    file.take(1 << 14).read_to_string(&mut text).ok()?;
    serde_json::from_str(&text).ok()
}

/// Whether the file names no process that may be alive.
fn said_by_dead(file: &mut File) -> bool {
    read_owner(file).is_none_or(|o| o.host == host() && is_dead(&o.pid.to_string()))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

    use super::*;

    fn entries(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn the_second_is_refused_until_the_first_has_ended() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("a/run");
        let first = Lock::take(&target).unwrap();
        let error = Lock::take(&target).unwrap_err().to_string();
        let me = std::process::id().to_string();
        assert!(error.contains(&me) && error.contains(&host()), "{error}");
        assert!(error.contains("another --output"), "{error}");
        Lock::take(&home.path().join("a/other")).unwrap();
        drop(first);
        assert_eq!(entries(home.path()), 0);
        drop(Lock::take(&target).unwrap());
        assert_eq!(entries(home.path()), 0);
    }

    /// Folders are removed while runs start: no run is refused because of it.
    #[test]
    fn a_folder_that_is_taken_away_meanwhile_is_made_anew() {
        let home = tempfile::tempdir().unwrap();
        let above = home.path().join("a");
        let target = above.join("b/run");
        let ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !ended.load(Relaxed) {
                    let _ = fs::remove_dir_all(&above);
                }
            });
            let refused = (0..300).find_map(|_| Lock::take(&target).err());
            ended.store(true, Relaxed);
            assert!(refused.is_none(), "{}", refused.unwrap());
        });
    }

    #[test]
    fn a_file_left_behind_holds_nobody_up() {
        let home = tempfile::tempdir().unwrap();
        let (target, path) = (home.path().join("run"), home.path().join(".run.flyer.lock"));
        for text in ["", "torn {", r#"{"pid": 1, "host": "HERE"}"#] {
            fs::write(&path, text.replace("HERE", &host())).unwrap();
            drop(Lock::take(&target).unwrap_or_else(|e| panic!("{text}: {e}")));
            assert!(!path.exists());
        }
    }

    #[test]
    fn a_run_on_another_machine_lives_while_it_gives_signs() {
        let home = tempfile::tempdir().unwrap();
        let (target, path) = (home.path().join("run"), home.path().join(".run.flyer.lock"));
        fs::write(&path, r#"{"pid": 1, "host": "elsewhere-7"}"#).unwrap();
        let error = Lock::take(&target).unwrap_err().to_string();
        assert!(error.contains("process 1 on elsewhere-7"), "{error}");
        let old = SystemTime::now() - 2 * STALE;
        File::options().write(true).open(&path).unwrap().set_modified(old).unwrap();
        Lock::take(&target).unwrap();
    }
}
