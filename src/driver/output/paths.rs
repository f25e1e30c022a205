//! Absolute paths of results.

use std::io::ErrorKind::{NotADirectory, NotFound};
use std::path::{Component, Path, PathBuf};

use super::error::OutputError;

/// The absolute path with `.` and `..` resolved, and links resolved as far as the path exists.
pub(super) fn resolve(target: &Path) -> Result<PathBuf, OutputError> {
    let absolute = std::path::absolute(target).map_err(OutputError::io("find the path", target))?;
    let mut path = PathBuf::new();
    for component in absolute.components() {
        match component {
            Component::ParentDir => {
                path.pop();
            }
            Component::CurDir => {}
            other => path.push(other),
        }
        match path.canonicalize() {
            Ok(real) => path = real,
            Err(e) if path.is_symlink() => {
                return Err(OutputError::io("follow the link", &path)(e));
            }
            Err(e) if matches!(e.kind(), NotFound | NotADirectory) => {}
            Err(e) => return Err(OutputError::io("reach the folder", &path)(e)),
        }
    }
    Ok(path)
}
