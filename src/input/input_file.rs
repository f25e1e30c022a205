//! Input files named by the user: only regular files, read whole, up to a maximum size.
//!
//! A FIFO or a device has no end and may never answer. The kind of a file is therefore checked
//! before it is opened for reading, and again after opening because it may have been replaced in
//! between.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::Path;

use nix::fcntl::OFlag;

/// Start of the first line of a checkpoint.
pub const CHECKPOINT_START: &str = "flyer-mpm checkpoint";

/// Maximum size of a file of keys and values, such as a scene, a study or a material [bytes].
pub const LARGEST_JSON: u64 = 16 << 20;

/// Maximum size of a file of numbers, such as positions, a table or a pressure over time [bytes].
pub const LARGEST_NUMBERS: u64 = 1 << 30;

/// Maximum size of a file written by a run, such as a profile [bytes].
pub const LARGEST_RESULT: u64 = 4 << 30;

/// Reason why a file cannot be used as an input.
#[derive(Debug, thiserror::Error)]
pub enum InputFault {
    /// Error of the operating system on reading.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Error of the operating system on writing.
    #[error("cannot be written: {0}")]
    Write(io::Error),
    /// The path is a folder, a FIFO or a device.
    #[error("is {0}; allowed: a regular file")]
    Kind(&'static str),
    /// The file is too long.
    #[error("is {} long; allowed: at most {most} bytes", at_least(*length, *most))]
    Length {
        /// Known length [bytes].
        length: u64,
        /// Maximum length [bytes].
        most: u64,
    },
    /// The file is not UTF-8 text.
    #[error("is not UTF-8 from byte {0} on; allowed: text in UTF-8")]
    Text(usize),
}

/// A length in words; the length of a file that is longer than it reports is not known.
fn at_least(length: u64, most: u64) -> String {
    if length > most { format!("{length} bytes") } else { format!("more than {most} bytes") }
}

/// Kind of a file that is not a regular one; `None` for a regular file.
fn other_kind(metadata: &Metadata) -> Option<&'static str> {
    let kind = metadata.file_type();
    Some(match () {
        () if kind.is_file() => return None,
        () if kind.is_dir() => "a directory",
        () if kind.is_fifo() => "no regular file but a FIFO",
        () if kind.is_char_device() || kind.is_block_device() => "no regular file but a device",
        () if kind.is_socket() => "no regular file but a socket",
        () => "no regular file",
    })
}

/// Checks that `path` is a regular file or does not exist.
///
/// # Errors
///
/// The kind of the file if it is not a regular one.
pub fn check_kind(path: &Path) -> Result<(), InputFault> {
    match std::fs::metadata(path).ok().and_then(|found| other_kind(&found)) {
        Some(kind) => Err(InputFault::Kind(kind)),
        None => Ok(()),
    }
}

/// Checks that a file can be written at `path`, as far as this is possible without writing.
///
/// # Errors
///
/// As [`check_kind`], or the error of the operating system for the file or its folder.
pub fn check_place(path: &Path) -> Result<(), InputFault> {
    check_kind(path)?;
    if path.exists() {
        let file = OpenOptions::new().append(true).open(path);
        return file.map(|_| ()).map_err(InputFault::Write);
    }
    let here = Path::new(".");
    let folder = path.ancestors().skip(1).find(|p| p.exists()).unwrap_or(here);
    match folder.is_dir() {
        true => Ok(()),
        false => Err(InputFault::Write(io::ErrorKind::NotADirectory.into())),
    }
}

/// Opens a regular file for reading, without ever blocking.
///
/// # Errors
///
/// The error of the operating system, or the kind of a file that is not a regular one.
pub fn open(path: &Path) -> Result<File, InputFault> {
    // opening a device may have side effects
    if let Some(kind) = other_kind(&std::fs::metadata(path)?) {
        return Err(InputFault::Kind(kind));
    }
    let flags = (OFlag::O_NONBLOCK | OFlag::O_NOCTTY).bits();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    match other_kind(&file.metadata()?) {
        Some(kind) => Err(InputFault::Kind(kind)),
        None => Ok(file),
    }
}

/// Checks that `path` is a regular file of at most `most` bytes, for a library that opens it by
/// name.
///
/// # Errors
///
/// As [`open`], or the length of the file.
pub fn check(path: &Path, most: u64) -> Result<(), InputFault> {
    let length = open(path)?.metadata()?.len();
    if length > most { Err(InputFault::Length { length, most }) } else { Ok(()) }
}

/// Bytes of a regular file, at most `most`.
///
/// # Errors
///
/// As [`open`], or the length of the file. If a file is longer than it reports, reading stops just
/// after `most` bytes.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, InputFault> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(InputFault::Length { length, most });
    }
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(InputFault::Length { length, most }) } else { Ok(bytes) }
}

/// Whether a regular file begins with `text`; false if it cannot be read.
pub fn begins_with(path: &Path, text: &str) -> bool {
    let mut head = vec![0; text.len()];
    let read = open(path).ok().and_then(|mut file| file.read_exact(&mut head).ok());
    read.is_some() && head == text.as_bytes()
}

/// Text of a regular file of at most `most` bytes.
///
/// # Errors
///
/// As [`read`], or the position of the first byte that is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String, InputFault> {
    String::from_utf8(read(path, most)?)
        .map_err(|fault| InputFault::Text(fault.utf8_error().valid_up_to()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_files_up_to_a_size() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("f");
        std::fs::write(&path, "abc").unwrap();
        assert_eq!(read(&path, 3).unwrap(), b"abc");
        assert_eq!(read_text(&path, 3).unwrap(), "abc");
        let message = |fault: InputFault| fault.to_string();
        assert_eq!(
            message(read(&path, 2).unwrap_err()),
            "is 3 bytes long; allowed: at most 2 bytes"
        );
        std::fs::write(&path, b"a\xff").unwrap();
        assert!(message(read_text(&path, 9).unwrap_err()).contains("not UTF-8 from byte 1"));
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(message(read(&path, LARGEST_NUMBERS).unwrap_err()).contains("1099511627776 bytes"));
        assert!(message(check(&path, LARGEST_JSON).unwrap_err()).contains("16777216"));
        // the system reports a length of 0, but the file has contents
        assert!(matches!(read(Path::new("/proc/self/status"), 9), Err(InputFault::Length { .. })));
        assert!(!read(Path::new("/proc/self/status"), 1 << 20).unwrap().is_empty());
    }

    #[test]
    fn other_kinds_are_refused_at_once() {
        let home = tempfile::tempdir().unwrap();
        let fifo = home.path().join("fifo");
        nix::unistd::mkfifo(&fifo, nix::sys::stat::Mode::S_IRWXU).unwrap();
        let message = |path: &Path| read(path, 9).unwrap_err().to_string();
        assert!(message(&fifo).contains("no regular file but a FIFO; allowed"));
        for device in ["/dev/zero", "/dev/null", "/dev/random", "/dev/full"] {
            assert!(message(Path::new(device)).contains("no regular file but a device"));
        }
        assert!(message(home.path()).contains("is a directory"));
        assert!(message(&home.path().join("none")).starts_with("cannot be read: No such file"));
        std::fs::write(home.path().join("file"), "").unwrap();
        let below = check_place(&home.path().join("file/x")).unwrap_err().to_string();
        assert!(below.starts_with("cannot be written: not a directory"), "{below}");
        assert!(check_place(&home.path().join("new/x")).is_ok());
        assert!(check_kind(&fifo).is_err() && check_kind(&home.path().join("none")).is_ok());
        std::os::unix::fs::symlink(&fifo, home.path().join("link")).unwrap();
        assert!(message(&home.path().join("link")).contains("FIFO"));
    }
}
