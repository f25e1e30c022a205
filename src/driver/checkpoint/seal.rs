//! The seal of a checkpoint: a text head before the HDF5 data (HDF5's user block, which HDF5's own
//! tools skip), and an index after them. The index names the parts of the file and holds the SHA-256
//! of each; the head identifies the file and ends with the SHA-256 of its own text and of the index.
//! The seal is verified before anything is read: a file with a missing byte or a changed bit is
//! refused, and the damaged part is named. Each rank digests some of the parts.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Write};
use std::os::unix::fs::FileExt;
use std::path::Path;

use decomp::{Comm, bytes_of, words_of};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::CheckpointError;
use crate::driver::output::OutputError;
use crate::driver::output::shared_file::{Extent, agree};
use crate::input::input_file::CHECKPOINT_START;
use crate::input::input_file::{self, InputFault};

/// Version of the checkpoint format.
pub const FORMAT: u32 = 5;

/// Length of the head [bytes].
pub const HEAD: u64 = 512;

/// Hexadecimal digits of the digest; a line break follows them.
const DIGITS: usize = 64;

/// Length of the part of the head that the digest covers: all but the digest itself [bytes].
const TEXT: usize = HEAD as usize - DIGITS - 1;

/// Largest part with a digest of its own [bytes].
const LARGEST_PART: u64 = 8 << 20;

/// Number of bytes read at a time.
const CHUNK: usize = 1 << 20;

/// Number of damaged parts that a message names.
const NAMED: usize = 3;

/// Name of the parts between the values of datasets.
const STRUCTURE: &str = "structure of the file";

/// A digest as hexadecimal text.
pub fn hexadecimal(digest: Sha256) -> String {
    digest.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// A part of a file and its digest.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Part {
    #[serde(flatten)]
    extent: Extent,
    sha256: String,
}

/// Cuts a file of `length` bytes after its head into parts: the values of datasets, and the rest
/// between them.
fn parts(extents: &[Extent], length: u64) -> Vec<Extent> {
    let mut sorted: Vec<&Extent> = extents.iter().filter(|e| e.bytes > 0).collect();
    sorted.sort_by_key(|e| e.offset);
    let (mut at, mut all) = (HEAD, Vec::new());
    let mut cut = |name: &str, from: u64, to: u64| {
        for offset in (from..to).step_by(LARGEST_PART as usize) {
            let bytes = LARGEST_PART.min(to - offset);
            all.push(Extent { name: name.into(), offset, bytes });
        }
    };
    for extent in sorted {
        cut(STRUCTURE, at, extent.offset);
        at = extent.offset + extent.bytes;
        cut(&extent.name, extent.offset, at);
    }
    cut(STRUCTURE, at, length);
    all
}

/// The digest of a part of a file.
fn digest_part(comm: &dyn Comm, file: &File, part: &Extent) -> io::Result<String> {
    let mut digest = Sha256::new();
    let mut chunk = vec![0; CHUNK.min(part.bytes as usize)];
    let mut done = 0;
    while done < part.bytes {
        let some = (part.bytes - done).min(CHUNK as u64) as usize;
        file.read_exact_at(&mut chunk[..some], part.offset + done)?;
        digest.update(&chunk[..some]);
        done += some as u64;
        comm.heartbeat();
    }
    Ok(hexadecimal(digest))
}

/// Seals a file that has reserved space for the head, whose datasets have the places `extents`, and
/// flushes it to disk. All ranks must have written and flushed their shares. Collective.
///
/// # Errors
///
/// If the file cannot be read or written; all ranks return an error.
pub fn seal(
    comm: &dyn Comm,
    path: &Path,
    extents: &[Extent],
    (step, time): (u64, f64),
    format: u32,
) -> Result<(), CheckpointError> {
    let fail = |e| CheckpointError::from(OutputError::io("write the checkpoint", path)(e));
    let digests = || -> io::Result<(Vec<Extent>, Vec<String>)> {
        let file = File::open(path)?;
        let parts = parts(extents, file.metadata()?.len());
        let mine = parts.iter().skip(comm.rank()).step_by(comm.size());
        let digests = mine.map(|part| digest_part(comm, &file, part)).collect::<io::Result<_>>()?;
        Ok((parts, digests))
    };
    let (parts, mine) = agree(comm, digests().map_err(fail))?;
    let all = comm.gather(&words_of(mine.concat().as_bytes()));
    let write = || -> io::Result<()> {
        let all: Vec<Vec<u8>> = all.iter().map(|words| bytes_of(words)).collect();
        let digest = |k: usize| {
            let at = k / comm.size() * DIGITS;
            String::from_utf8_lossy(&all[k % comm.size()][at..at + DIGITS]).into_owned()
        };
        let digests = (0..parts.len()).map(digest);
        let parts: Vec<Part> = parts
            .into_iter()
            .zip(digests)
            .map(|(extent, sha256)| Part { extent, sha256 })
            .collect();
        let index = serde_json::to_vec(&parts)?;
        let mut file = OpenOptions::new().append(true).open(path)?;
        let start = file.metadata()?.len();
        file.write_all(&index)?;
        let length = start + index.len() as u64;
        let version = env!("CARGO_PKG_VERSION");
        let mut head = format!(
            "{CHECKPOINT_START}\nformat {format}\nversion {version}\nbytes {length}\nindex {start}\n\
             step {step}\ntime {time:e} s\n"
        );
        head.extend(std::iter::repeat_n(' ', TEXT - head.len()));
        let digest = digest_of(head.as_bytes(), &index);
        let file = OpenOptions::new().write(true).open(path)?;
        file.write_all_at(format!("{head}{digest}\n").as_bytes(), 0)?;
        file.sync_all()
    };
    agree(comm, if comm.rank() == 0 { write().map_err(fail) } else { Ok(()) })
}

/// The digest of the text of the head and of the index.
fn digest_of(head: &[u8], index: &[u8]) -> String {
    let mut digest = Sha256::new();
    digest.update(head);
    digest.update(index);
    hexadecimal(digest)
}

/// Refuses a file that has changed since it was sealed, or that has another format. Only parts with
/// a name that `wanted` accepts are looked at. Collective.
///
/// # Errors
///
/// If the file cannot be read, has changed since it was sealed, or has another format; all ranks
/// return an error.
pub fn verify(
    comm: &dyn Comm,
    path: &Path,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<(), CheckpointError> {
    let (file, parts) = agree(comm, read_index(path))?;
    let mine = parts.iter().filter(|part| wanted(&part.extent.name));
    let mut mine = mine.skip(comm.rank()).step_by(comm.size());
    let damaged = mine.try_fold(Vec::new(), |mut damaged, part| {
        let extent = &part.extent;
        if digest_part(comm, &file, extent)? != part.sha256 {
            let end = extent.offset + extent.bytes;
            damaged.push(format!("{} (bytes {} to {end})", extent.name, extent.offset));
        }
        Ok(damaged)
    });
    let fail = |e| CheckpointError::from(OutputError::io("read the checkpoint", path)(e));
    let damaged = agree(comm, damaged.map_err(fail))?;
    let mut count = [damaged.len() as i64];
    comm.sum(&mut count);
    if count[0] == 0 {
        return Ok(());
    }
    let all = comm.gather(&words_of(damaged.join("\n").as_bytes()));
    if comm.rank() != 0 {
        return Err(OutputError::Elsewhere.into());
    }
    let texts = all.iter().map(|words| String::from_utf8_lossy(&bytes_of(words)).into_owned());
    let texts: Vec<String> = texts.filter(|text| !text.is_empty()).collect();
    let mut names: Vec<&str> = texts.iter().flat_map(|text| text.lines()).take(NAMED).collect();
    let rest = format!("{} more", count[0] - names.len() as i64);
    if count[0] > names.len() as i64 {
        names.push(&rest);
    }
    let why = format!("these parts are not as they were written (SHA-256): {}", names.join(", "));
    Err(CheckpointError::Damaged { path: path.into(), why })
}

/// Reads and verifies the head and the index of a file.
fn read_index(path: &Path) -> Result<(File, Vec<Part>), CheckpointError> {
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
    let other_format = || match word("format") == FORMAT.to_string() {
        true => None,
        false => Some(CheckpointError::Format {
            path: path.into(),
            found: word("format"),
            known: FORMAT,
            version: word("version"),
        }),
    };
    let start = word("index").parse().ok().filter(|start| (HEAD..=length).contains(start));
    let Some(start) = start else {
        // earlier formats have no index
        return Err(other_format().unwrap_or(damaged("its head names no index".into())));
    };
    let mut index = vec![0; (length - start) as usize];
    file.read_exact_at(&mut index, start).map_err(fail)?;
    if format!("{}\n", digest_of(text, &index)).as_bytes() != digest {
        let why = "its head or its index is not the one that was written (SHA-256)";
        return Err(damaged(why.into()));
    }
    if let Some(error) = other_format() {
        return Err(error);
    }
    let parts = serde_json::from_slice(&index).map_err(|e| damaged(format!("its index: {e}")))?;
    Ok((file, parts))
}
