//! The folder of results. It is written in a temporary place and put in place as a whole.
//!
//! All files are written into a temporary folder beside the target, on the same file system.
//! [`OutputFolder::commit`] renames an earlier result, renames the new result to the target, and
//! deletes the earlier one. A run that fails before that leaves the earlier result unchanged.
//! Independent of MPI: called on one rank only.

use std::fs;
use std::io::{self, ErrorKind::AlreadyExists, ErrorKind::NotFound};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::error::OutputError;
use super::origin::{ExistingResult, Maker, Origin, check_outside_results};
use super::paths::resolve;

/// Checks, before the run, whether a result can be written at `target`; leaves no files behind. An
/// empty folder is always accepted. An earlier result is refused if `keep` is set or if `maker` may
/// not replace it.
///
/// # Errors
///
/// If the path cannot be used, or if it holds files that this run may not replace.
pub fn check_writable(target: &Path, keep: bool, maker: &Maker) -> Result<(), OutputError> {
    OutputFolder::create(target, keep, maker).map(drop)
}

/// A folder of results during writing.
///
/// If dropped without [`OutputFolder::commit`], it is removed.
#[derive(Debug)]
pub struct OutputFolder {
    /// Target as named by the user.
    target: PathBuf,
    /// Absolute path of the target, with links resolved.
    place: PathBuf,
    /// Temporary folder.
    partial: PathBuf,
    /// Parent folders that were created for it, outermost first.
    made: Vec<PathBuf>,
    keep: bool,
    maker: Maker,
    committed: bool,
}

impl OutputFolder {
    /// Creates the temporary folder beside `target`, and missing parent folders. An earlier result
    /// at `target` must be one that `maker` may replace.
    ///
    /// # Errors
    ///
    /// If the folder cannot be created, or if the target holds files that `maker` may not replace.
    pub fn create(target: &Path, keep: bool, maker: &Maker) -> Result<OutputFolder, OutputError> {
        let absolute = resolve(target)?;
        if let Some(parent) = absolute.parent() {
            recover(parent, &absolute);
        }
        check_outside_results(target)?;
        check_replaceable(target, &absolute, keep, maker)?;
        let Some(parent) = absolute.parent() else {
            return Err(OutputError::Fixed { path: target.into(), why: "the root folder" });
        };
        let mut folder = OutputFolder {
            target: target.to_path_buf(),
            partial: parent.join(aside_name(&absolute, "partial")),
            place: absolute.clone(),
            made: Vec::new(),
            keep,
            maker: maker.clone(),
            committed: false,
        };
        let what = ("write into the folder", parent);
        within(parent, &mut folder.made, what, || fs::create_dir(&folder.partial))?;
        Ok(folder)
    }

    /// The temporary folder, in which files are written.
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Path of a file in the temporary folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.partial.join(name)
    }

    /// The target as named by the user.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// The origin to record in the result.
    pub fn origin(&self) -> Origin {
        self.maker.origin.seen_from(&self.place)
    }

    /// Replaces an earlier result by this one, as a whole; returns the target as named by the user.
    ///
    /// # Errors
    ///
    /// If the target has become one that may not be replaced, or if a folder cannot be renamed.
    pub fn commit(mut self) -> Result<PathBuf, OutputError> {
        check_replaceable(&self.target, &self.place, self.keep, &self.maker)?;
        let parent = self.place.parent().unwrap_or(Path::new("/"));
        let earlier = parent.join(aside_name(&self.place, "earlier"));
        let replaces = self.place.exists();
        if replaces {
            fs::rename(&self.place, &earlier)
                .map_err(OutputError::io("set the earlier result aside", &self.target))?;
        }
        if let Err(error) = fs::rename(&self.partial, &self.place) {
            if replaces {
                fs::rename(&earlier, &self.place)
                    .map_err(OutputError::io("put the earlier result back", &earlier))?;
            }
            return Err(OutputError::io("put the result in place", &self.target)(error));
        }
        self.committed = true;
        if replaces {
            remove(&earlier)?;
        }
        Ok(self.target.clone())
    }
}

impl Drop for OutputFolder {
    /// Best effort: an error that is already being returned is more useful.
    fn drop(&mut self) {
        if !self.committed {
            let _ = fs::remove_dir_all(&self.partial);
            for parent in self.made.iter().rev() {
                let _ = fs::remove_dir(parent);
            }
        }
    }
}

/// Number of attempts if another process removes a folder that is needed.
const TRIES: usize = 100;

/// Creates `folder` and its missing parents, then calls `act` in it and returns its result. Created
/// folders are added to `made`, outermost first. If another process removes the folder before `act`
/// is done, both are repeated. `doing` and `path` describe the action in error messages.
pub(super) fn within<T>(
    folder: &Path,
    made: &mut Vec<PathBuf>,
    (doing, path): (&'static str, &Path),
    mut act: impl FnMut() -> io::Result<T>,
) -> Result<T, OutputError> {
    for left in (0..TRIES).rev() {
        let vanished = |e: &io::Error| left > 0 && e.kind() == NotFound;
        match make_parents(folder, made) {
            Err((_, e)) if vanished(&e) => continue,
            Err((at, e)) => return Err(OutputError::io("create the folder", &at)(e)),
            Ok(()) => {}
        }
        match act() {
            Err(e) if vanished(&e) => {}
            done => return done.map_err(OutputError::io(doing, path)),
        }
    }
    unreachable!("the last try returns");
}

/// Creates `folder` and its missing parents; an error comes with the path that failed.
fn make_parents(folder: &Path, made: &mut Vec<PathBuf>) -> Result<(), (PathBuf, io::Error)> {
    let missing: Vec<&Path> = folder.ancestors().take_while(|p| !p.exists()).collect();
    for path in missing.into_iter().rev() {
        match fs::create_dir(path) {
            Ok(()) if made.iter().any(|p| p == path) => {}
            Ok(()) => made.push(path.to_path_buf()),
            // created by another process, which may have removed it again
            Err(e) if e.kind() == AlreadyExists && (path.is_dir() || !path.exists()) => {}
            Err(e) => return Err((path.to_path_buf(), e)),
        }
    }
    Ok(())
}

fn remove(folder: &Path) -> Result<(), OutputError> {
    fs::remove_dir_all(folder).map_err(OutputError::io("remove the folder", folder))
}

/// Folder of the checkpoints of results at `target`. It is beside the target, so that it remains if
/// the run has no result.
///
/// # Errors
///
/// If the target cannot be resolved to an absolute path.
pub fn checkpoint_folder(target: &Path) -> Result<PathBuf, OutputError> {
    let place = resolve(target)?;
    let mut name = place.file_name().unwrap_or_default().to_os_string();
    name.push(CHECKPOINTS);
    Ok(place.with_file_name(name))
}

/// Suffix of the name of a checkpoint folder.
pub const CHECKPOINTS: &str = ".checkpoints";

/// Refuses a target that is not a folder, or whose parent is not a folder.
pub(super) fn check_folder(named: &Path, target: &Path) -> Result<(), OutputError> {
    match target.ancestors().find(|p| p.exists()).filter(|p| !p.is_dir()) {
        Some(file) => {
            Err(OutputError::NotAFolder(if file == target { named } else { file }.into()))
        }
        None => Ok(()),
    }
}

/// Refuses a target that is not a folder, that `maker` may not replace, or that cannot be renamed.
fn check_replaceable(
    named: &Path,
    target: &Path,
    keep: bool,
    maker: &Maker,
) -> Result<(), OutputError> {
    check_folder(named, target)?;
    if !target.exists() {
        return Ok(());
    }
    if std::env::current_dir().is_ok_and(|here| here.starts_with(target)) {
        return Err(OutputError::Fixed { path: named.into(), why: "the current folder" });
    }
    if is_mount_point(target) {
        return Err(OutputError::Fixed { path: named.into(), why: "a mount point" });
    }
    let mut entries = fs::read_dir(target).map_err(OutputError::io("read the folder", named))?;
    if entries.next().is_none() {
        return Ok(());
    }
    if keep {
        return Err(OutputError::Exists(named.into()));
    }
    let Some(made) = ExistingResult::read(target) else {
        return Err(OutputError::NotOurs(named.into()));
    };
    if !maker.may_replace(&made.origin, &made.scene, target) {
        let (theirs, ours) = (made.origin.to_string(), maker.origin.to_string());
        return Err(OutputError::Foreign { path: named.into(), theirs, ours });
    }
    match result_inside(target) {
        Some(result) => Err(OutputError::Around { path: named.into(), result }),
        None => Ok(()),
    }
}

/// A result in a subfolder of this folder.
fn result_inside(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    // links are removed, not their targets
    let folders = entries.filter(|e| e.file_type().is_ok_and(|kind| kind.is_dir()));
    let mut paths = folders.map(|e| e.path());
    paths.find_map(|path| match ExistingResult::read(&path) {
        Some(_) => Some(path),
        None => result_inside(&path),
    })
}

/// Whether the folder is a mount point; false if unknown.
fn is_mount_point(folder: &Path) -> bool {
    let mounts = fs::read_to_string("/proc/self/mountinfo").unwrap_or_default();
    mounts.lines().any(|line| line.split(' ').nth(4).map(Path::new) == Some(folder))
}

/// Name of this machine, to distinguish processes of other machines in names of folders.
pub(in crate::driver) fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').collect()
}

/// Prefix of the names of all temporary folders beside `target`; it makes them hidden.
pub(super) fn aside_prefix(target: &Path) -> String {
    format!(".{}.flyer.", target.file_name().unwrap_or_default().to_string_lossy())
}

/// A folder name beside `target` that is unique over processes and within this process.
fn aside_name(target: &Path, role: &str) -> String {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("{}{role}-{}-{}.{count}", aside_prefix(target), host(), std::process::id())
}

/// Cleans up beside `target` after processes of this machine that ended early. An earlier result is
/// put back if no new one is there; incomplete results are removed. Best effort: remaining folders
/// do no harm.
fn recover(parent: &Path, target: &Path) {
    let Ok(entries) = fs::read_dir(parent) else { return };
    let (prefix, host) = (aside_prefix(target), format!("{}-", host()));
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some((role, owner)) = name.strip_prefix(&prefix).and_then(|s| s.split_once('-')) else {
            continue;
        };
        let process = owner.strip_prefix(&host).and_then(|s| s.split_once('.')).map(|(p, _)| p);
        match role {
            _ if !process.is_some_and(is_dead) => {}
            "earlier" if !target.exists() => {
                let _ = fs::rename(entry.path(), target);
            }
            "earlier" | "partial" => {
                let _ = fs::remove_dir_all(entry.path());
            }
            _ => {}
        }
    }
}

/// Whether this machine has no process with this number; false if unknown.
pub(super) fn is_dead(process: &str) -> bool {
    let is_number = !process.is_empty() && process.bytes().all(|b| b.is_ascii_digit());
    is_number && Path::new("/proc/self").exists() && !Path::new("/proc").join(process).exists()
}

#[cfg(test)]
mod tests {
    use super::super::file_names::SUMMARY_FILE;
    use super::*;

    /// The maker of the results of [`write`].
    fn maker() -> Maker {
        Maker {
            origin: Origin { command: "run".into(), ..Origin::default() },
            scene: serde_json::json!({}),
        }
    }

    fn write(folder: &Path, mark: &str) {
        let text = format!(r#"{{"version": "{mark}", "scene": {{}}, "profiles": []}}"#);
        fs::write(folder.join(SUMMARY_FILE), text).unwrap();
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name());
        let mut names: Vec<_> = entries.map(|n| n.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn replaces_as_a_whole_and_only_on_commit() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("a/b/run");
        for mark in ["1", "2"] {
            let folder = OutputFolder::create(&target, false, &maker()).unwrap();
            write(folder.path(), mark);
            fs::write(folder.file(mark), "").unwrap();
            assert_eq!(folder.commit().unwrap(), target);
            assert_eq!(names(&target), [mark, SUMMARY_FILE]);
            assert_eq!(names(target.parent().unwrap()), ["run"]);
        }
        let failed = OutputFolder::create(&target, false, &maker()).unwrap();
        write(failed.path(), "3");
        assert_eq!(names(&target), ["2", SUMMARY_FILE]);
        drop(failed);
        assert_eq!(names(&target), ["2", SUMMARY_FILE]);
        assert_eq!(names(target.parent().unwrap()), ["run"]);
    }

    #[test]
    fn leaves_no_trace_of_parents_that_it_made() {
        let home = tempfile::tempdir().unwrap();
        check_writable(&home.path().join("a/b/run"), false, &maker()).unwrap();
        assert!(names(home.path()).is_empty());
    }

    #[test]
    fn keep_refuses_a_result_but_not_an_empty_folder() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        fs::create_dir(&target).unwrap();
        OutputFolder::create(&target, true, &maker()).unwrap().commit().unwrap();
        write(&target, "1");
        assert!(matches!(check_writable(&target, true, &maker()), Err(OutputError::Exists(_))));
        check_writable(&target, false, &maker()).unwrap();
        // a result written during this run is kept as well
        fs::remove_file(target.join(SUMMARY_FILE)).unwrap();
        let folder = OutputFolder::create(&target, true, &maker()).unwrap();
        write(&target, "2");
        assert!(matches!(folder.commit(), Err(OutputError::Exists(_))));
        assert_eq!(names(&target), [SUMMARY_FILE]);
    }

    #[test]
    fn refuses_what_is_not_a_result() {
        let home = tempfile::tempdir().unwrap();
        let folder = home.path().join("mine");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("thesis.tex"), "").unwrap();
        let error = check_writable(&folder, false, &maker()).unwrap_err();
        assert!(error.to_string().contains("mine: holds files but no summary.json"), "{error}");
        fs::write(folder.join(SUMMARY_FILE), "{}").unwrap();
        assert!(matches!(check_writable(&folder, false, &maker()), Err(OutputError::NotOurs(_))));
        let file = folder.join("thesis.tex");
        assert!(
            matches!(check_writable(&file, false, &maker()), Err(OutputError::NotAFolder(p)) if p == file)
        );
        let below = file.join("run");
        assert!(matches!(check_writable(&below, false, &maker()), Err(OutputError::NotAFolder(_))));
        let here = std::env::current_dir().unwrap();
        assert!(matches!(check_writable(&here, false, &maker()), Err(OutputError::Fixed { .. })));
        let error = check_writable(Path::new("/proc/run"), false, &maker()).unwrap_err();
        assert!(error.to_string().starts_with("/proc: cannot write into the folder"), "{error}");
        assert_eq!(names(&folder), [SUMMARY_FILE, "thesis.tex"]);
    }

    #[test]
    fn a_link_stays_a_link() {
        let home = tempfile::tempdir().unwrap();
        let (real, link) = (home.path().join("real"), home.path().join("link"));
        fs::create_dir(&real).unwrap();
        std::os::unix::fs::symlink(&real, &link).unwrap();
        let folder = OutputFolder::create(&link, false, &maker()).unwrap();
        write(folder.path(), "1");
        folder.commit().unwrap();
        assert!(link.is_symlink());
        assert_eq!(names(&real), [SUMMARY_FILE]);
    }

    #[test]
    fn puts_back_what_a_dead_process_had_set_aside() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("run");
        let dead = format!("{}-4999999.0", host());
        let aside = home.path().join(format!(".run.flyer.earlier-{dead}"));
        fs::create_dir(&aside).unwrap();
        write(&aside, "1");
        fs::create_dir(home.path().join(format!(".run.flyer.partial-{dead}"))).unwrap();
        check_writable(&target, false, &maker()).unwrap();
        assert_eq!(names(home.path()), ["run"]);
        assert!(ExistingResult::read(&target).is_some());
    }
}
