//! The seal of a checkpoint: a text head before the HDF5 data (HDF5's user block, which HDF5's own
//! tools skip). It identifies the file and ends with the SHA-256 of all other bytes of the file.
//! The seal is verified before anything is read: a file with a missing byte or a changed bit is
//! refused.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::CheckpointError;
use crate::driver::output::OutputError;
use crate::input::input_file::CHECKPOINT_START;
use crate::input::input_file::{self, InputFault};

/// Version of the checkpoint format.
pub const FORMAT: u32 = 3;

/// Length of the head [bytes].
pub const HEAD: u64 = 512;

/// Hexadecimal digits of the digest; a line break follows them.
const DIGITS: usize = 64;

/// Length of the part of the head that the digest covers: all but the digest itself [bytes].
const TEXT: usize = HEAD as usize - DIGITS - 1;

/// Number of bytes read at a time.
const CHUNK: usize = 1 << 20;

/// A digest as hexadecimal text.
pub fn hexadecimal(digest: Sha256) -> String {
    digest.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// Writes the head of a file that has reserved space for it, and flushes the file to disk.
///
/// # Errors
///
/// If the file cannot be written.
pub fn seal(path: &Path, step: u64, time: f64, format: u32) -> Result<(), CheckpointError> {
    let write = || -> io::Result<()> {
        let mut file = OpenOptions::new().read(true).write(true).open(path)?;
        let length = file.metadata()?.len();
        let version = env!("CARGO_PKG_VERSION");
        let mut head = format!(
            "{CHECKPOINT_START}\nformat {format}\nversion {version}\nbytes {length}\nstep {step}\ntime {time:e} s\n"
        );
        head.extend(std::iter::repeat_n(' ', TEXT - head.len()));
        let digest = digest_of(&mut file, head.as_bytes())?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(format!("{head}{digest}\n").as_bytes())?;
        file.sync_all()
    };
    write().map_err(|e| OutputError::io("write the checkpoint", path)(e).into())
}

/// The digest of the text of the head and of all bytes after the head.
fn digest_of(file: &mut File, head: &[u8]) -> io::Result<String> {
    let mut digest = Sha256::new();
    digest.update(head);
    file.seek(SeekFrom::Start(HEAD))?;
    let mut chunk = vec![0; CHUNK];
    loop {
        match file.read(&mut chunk)? {
            0 => return Ok(hexadecimal(digest)),
            n => digest.update(&chunk[..n]),
        }
    }
}

/// Refuses a file that has changed since it was sealed, or that has another format.
///
/// # Errors
///
/// If the file cannot be read, has changed since it was sealed, or has another format.
pub fn verify(path: &Path) -> Result<(), CheckpointError> {
    let damaged = |why: String| CheckpointError::Damaged { path: path.into(), why };
    let fail =
        |e: io::Error| CheckpointError::from(OutputError::io("read the checkpoint", path)(e));
    let mut file = input_file::open(path).map_err(|fault| match fault {
        InputFault::Io(e) => fail(e),
        other => damaged(other.to_string()),
    })?;
    let length = file.metadata().map_err(fail)?.len();
    let mut head = vec![0; HEAD as usize];
    if length < HEAD {
        return Err(damaged(format!("it has {length} bytes, less than its head")));
    }
    file.read_exact(&mut head).map_err(fail)?;
    let (text, digest) = head.split_at(TEXT);
    let said = String::from_utf8_lossy(text);
    let word = |name: &str| {
        said.lines()
            .find_map(|l| l.strip_prefix(name)?.strip_prefix(' '))
            .unwrap_or("?")
            .to_string()
    };
    if !said.starts_with(CHECKPOINT_START) {
        return Err(damaged("it does not begin as a checkpoint does".into()));
    }
    if word("bytes") != length.to_string() {
        return Err(damaged(format!("it has {length} bytes of {}", word("bytes"))));
    }
    let found = digest_of(&mut file, text).map_err(fail)?;
    if format!("{found}\n").as_bytes() != digest {
        return Err(damaged("its bytes are not those that were written (SHA-256)".into()));
    }
    if word("format") != FORMAT.to_string() {
        return Err(CheckpointError::Format {
            path: path.into(),
            found: word("format"),
            known: FORMAT,
            version: word("version"),
        });
    }
    Ok(())
}
