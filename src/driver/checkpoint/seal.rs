//! The seal of a checkpoint: a text head before the HDF5 data (HDF5's user block, which HDF5's own
//! tools skip). It identifies the file and ends with the SHA-256 of all other bytes of the file.
//! The seal is verified before anything is read: a file with a missing byte or a changed bit is
//! refused. The head also names the maker of the checkpoint, for [`owner`].

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

use super::{CheckpointContents, CheckpointError, unknown_origin};
use crate::driver::output::OutputError;
use crate::driver::output::origin::Origin;
use crate::input::input_file::CHECKPOINT_START;
use crate::input::input_file::{self, InputFault};

/// Version of the checkpoint format.
pub const FORMAT: u32 = 4;

/// Length of the head, a power of two as HDF5 requires [bytes].
pub const HEAD: u64 = 4096;

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

/// The maker of a checkpoint, as its head records it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SealedOwner {
    /// The command and the scene file of the run.
    pub origin: Origin,
    /// Digest of the scene, see [`scene_digest`].
    pub scene: String,
}

/// SHA-256 of the JSON text of a scene, in which order and spaces are those of this program.
pub fn scene_digest(scene: &Value) -> String {
    hexadecimal(Sha256::new_with_prefix(scene.to_string()))
}

/// Writes the head of a file that has reserved space for it, and flushes the file to disk.
///
/// # Errors
///
/// If the file cannot be written.
pub fn seal(
    path: &Path,
    contents: &CheckpointContents,
    format: u32,
) -> Result<(), CheckpointError> {
    let write = || -> io::Result<()> {
        let mut file = OpenOptions::new().read(true).write(true).open(path)?;
        let head = head_text(contents, file.metadata()?.len(), format);
        let digest = digest_of(&mut file, head.as_bytes())?;
        file.seek(SeekFrom::Start(0))?;
        file.write_all(format!("{head}{digest}\n").as_bytes())?;
        file.sync_all()
    };
    write().map_err(|e| OutputError::io("write the checkpoint", path)(e).into())
}

/// The text of the head. Its line `head` is the digest of the lines before, so that they can be
/// trusted without the rest of the file.
fn head_text(contents: &CheckpointContents, length: u64, format: u32) -> String {
    let (version, saved) = (env!("CARGO_PKG_VERSION"), contents.saved);
    let mut head = format!(
        "{CHECKPOINT_START}\nformat {format}\nversion {version}\nbytes {length}\nstep {}\ntime {:e} s\n",
        saved.step, saved.time
    );
    let scene = serde_json::from_str(contents.scene).unwrap_or_default();
    let origin = contents.origin.cloned().unwrap_or_else(unknown_origin);
    let origin = serde_json::to_string(&origin).expect("an origin is plain data");
    let owner = format!("origin {origin}\nscene {}\n", scene_digest(&scene));
    let digest_line = "head \n".len() + DIGITS;
    // a very long path is left out; then the whole file has to be read
    if head.len() + owner.len() + digest_line <= TEXT {
        head += &owner;
    }
    head += &format!("head {}\n", hexadecimal(Sha256::new_with_prefix(&head)));
    head.extend(std::iter::repeat_n(' ', TEXT - head.len()));
    head
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

/// Head of a checkpoint.
struct Head {
    /// The file, behind its head.
    file: File,
    /// The text that the digest covers.
    text: Vec<u8>,
    /// The digest with a line break.
    digest: Vec<u8>,
}

impl Head {
    /// Reads the head of a file, and refuses one that has lost or gained bytes since it was sealed.
    fn read(path: &Path) -> Result<Head, CheckpointError> {
        let damaged = |why: String| CheckpointError::Damaged { path: path.into(), why };
        let fail =
            |e: io::Error| CheckpointError::from(OutputError::io("read the checkpoint", path)(e));
        let mut file = input_file::open(path).map_err(|fault| match fault {
            InputFault::Io(e) => fail(e),
            other => damaged(other.to_string()),
        })?;
        let length = file.metadata().map_err(fail)?.len();
        if length < HEAD {
            return Err(damaged(format!("it has {length} bytes, less than its head")));
        }
        let mut text = vec![0; HEAD as usize];
        file.read_exact(&mut text).map_err(fail)?;
        let digest = text.split_off(TEXT);
        let head = Head { file, text, digest };
        if !head.text.starts_with(CHECKPOINT_START.as_bytes()) {
            return Err(damaged("it does not begin as a checkpoint does".into()));
        }
        let bytes = head.word("bytes");
        if bytes != length.to_string() {
            return Err(damaged(format!("it has {length} bytes of {bytes}")));
        }
        Ok(head)
    }

    /// The rest of the line that starts with `name`; `?` if there is none.
    fn word(&self, name: &str) -> String {
        let text = String::from_utf8_lossy(&self.text);
        let mut lines = text.lines();
        let word = lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        word.unwrap_or("?").to_string()
    }

    /// Refuses a checkpoint of another format.
    fn check_format(&self, path: &Path) -> Result<(), CheckpointError> {
        if self.word("format") == FORMAT.to_string() {
            return Ok(());
        }
        Err(CheckpointError::Format {
            path: path.into(),
            found: self.word("format"),
            known: FORMAT,
            version: self.word("version"),
        })
    }
}

/// Refuses a file that has changed since it was sealed, or that has another format.
///
/// # Errors
///
/// If the file cannot be read, has changed since it was sealed, or has another format.
pub fn verify(path: &Path) -> Result<(), CheckpointError> {
    let mut head = Head::read(path)?;
    let found = digest_of(&mut head.file, &head.text)
        .map_err(|e| CheckpointError::from(OutputError::io("read the checkpoint", path)(e)))?;
    if format!("{found}\n").as_bytes() != head.digest {
        let why = "its bytes are not those that were written (SHA-256)".into();
        return Err(CheckpointError::Damaged { path: path.into(), why });
    }
    head.check_format(path)
}

/// The maker of a checkpoint, from its head alone; `None` if the head had no room for it.
///
/// # Errors
///
/// If the file cannot be read, if its head is damaged, or if it has another format.
pub fn owner(path: &Path) -> Result<Option<SealedOwner>, CheckpointError> {
    let head = Head::read(path)?;
    head.check_format(path)?;
    let text = String::from_utf8_lossy(&head.text);
    let sealed = text.split_once("\nhead ").map(|(lines, _)| format!("{lines}\n"));
    let digest = sealed.map(|lines| hexadecimal(Sha256::new_with_prefix(lines)));
    if digest.as_ref() != Some(&head.word("head")) {
        let why = "its head is not the one that was written (SHA-256)".into();
        return Err(CheckpointError::Damaged { path: path.into(), why });
    }
    let origin = serde_json::from_str(&head.word("origin")).ok();
    Ok(origin.map(|origin| SealedOwner { origin, scene: head.word("scene") }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Saved;

    /// A sealed file without data, and its head.
    fn sealed(file: &str, scene: &str) -> tempfile::NamedTempFile {
        let origin = Origin { command: "run".into(), file: Some(file.into()), relative: None };
        let saved = Saved::default();
        let contents = CheckpointContents {
            origin: Some(&origin),
            method_choice: None,
            scene,
            dimension: 1,
            saved: &saved,
            columns: &[],
            due: Default::default(),
            tables: &[],
            waves: &[],
            bodies: &[],
            histories: None,
        };
        let place = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(place.path(), vec![b'x'; HEAD as usize + 9]).unwrap();
        seal(place.path(), &contents, FORMAT).unwrap();
        place
    }

    #[test]
    fn the_head_alone_names_the_maker() {
        let place = sealed("/scenes/a.json", "{\"b\": 1, \"a\": 2}");
        verify(place.path()).unwrap();
        let read = || owner(place.path());
        let found = read().unwrap().unwrap();
        assert_eq!(found.origin.file.as_deref(), Some("/scenes/a.json"));
        assert_eq!(found.scene, scene_digest(&serde_json::json!({"b": 1, "a": 2})));
        // bytes behind the head are not read, those of the head are checked
        let mut bytes = std::fs::read(place.path()).unwrap();
        bytes[HEAD as usize + 1] = b'y';
        std::fs::write(place.path(), &bytes).unwrap();
        assert!(verify(place.path()).is_err());
        assert_eq!(read().unwrap().unwrap(), found);
        let at = String::from_utf8_lossy(&bytes).find("/scenes").unwrap();
        bytes[at] = b'-';
        std::fs::write(place.path(), &bytes).unwrap();
        assert!(matches!(read(), Err(CheckpointError::Damaged { .. })));
    }

    #[test]
    fn a_path_that_is_too_long_for_the_head_is_left_out() {
        let place = sealed(&"/a".repeat(HEAD as usize), "{}");
        verify(place.path()).unwrap();
        assert_eq!(owner(place.path()).unwrap(), None);
    }
}
