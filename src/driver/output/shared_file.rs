//! Files that all ranks write together: rank 0 lays out an HDF5 file with contiguous datasets, then
//! each rank writes its share of the values to their places in the file. HDF5 itself runs on rank 0
//! alone, so that it needs no MPI; one rank writes in the same way as many.

use std::fs::{self, OpenOptions};
use std::io;
use std::os::unix::fs::FileExt;
use std::path::Path;

use decomp::{Comm, bytes_of, words_of};
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::{Dataset, Extents, Group, H5Type};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::OutputError;

/// Bytes that are written or read at a time.
const CHUNK: usize = 1 << 20;

/// A type of value that a dataset may hold, in the byte order of the machine.
pub trait Plain: H5Type + Copy {
    /// Bytes of the value.
    fn bytes(self) -> impl AsRef<[u8]>;

    /// The value of the bytes, of which there must be as many as the type has.
    fn of_bytes(bytes: &[u8]) -> Self;
}

macro_rules! plain {
    ($($kind:ty),*) => {$(
        impl Plain for $kind {
            fn bytes(self) -> impl AsRef<[u8]> {
                self.to_ne_bytes()
            }

            fn of_bytes(bytes: &[u8]) -> Self {
                <$kind>::from_ne_bytes(bytes.try_into().expect("as many bytes as the type has"))
            }
        }
    )*};
}
plain!(u8, u32, i32, u64, i64, f64);

/// Place of the values of a dataset in its file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Extent {
    /// Name of the dataset.
    pub name: String,
    /// First byte.
    pub offset: u64,
    /// Number of bytes.
    pub bytes: u64,
}

impl Extent {
    /// Place of the values of a contiguous dataset, under a name; a dataset without values has no
    /// bytes.
    pub fn of(name: String, dataset: &Dataset) -> Extent {
        match dataset.offset() {
            Some(offset) => Extent { name, offset, bytes: dataset.storage_size() },
            None => Extent { name, ..Extent::default() },
        }
    }
}

/// Creates a dataset with room in the file for its values, which are written later.
///
/// # Errors
///
/// If HDF5 refuses.
pub fn reserve<T: H5Type>(
    group: &Group,
    name: &str,
    shape: impl Into<Extents>,
) -> hdf5::Result<Dataset> {
    let dataset = group.new_dataset::<T>().shape(shape).obj_track_times(false);
    dataset.alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never).create(name)
}

/// This rank's access to a file that rank 0 has laid out.
pub struct SharedFile<'a> {
    comm: &'a dyn Comm,
    file: fs::File,
}

impl<'a> SharedFile<'a> {
    /// Opens the file to write a share.
    ///
    /// # Errors
    ///
    /// If the file cannot be opened.
    pub fn open(comm: &'a dyn Comm, path: &Path) -> io::Result<Self> {
        Ok(SharedFile { comm, file: OpenOptions::new().write(true).open(path)? })
    }

    /// Writes values of a dataset, beginning with its value number `first`.
    ///
    /// # Errors
    ///
    /// If the disk is full or the file cannot be written.
    pub fn put<T: Plain>(
        &self,
        extent: &Extent,
        first: u64,
        values: impl IntoIterator<Item = T>,
    ) -> io::Result<()> {
        let mut at = extent.offset + first * size_of::<T>() as u64;
        let mut bytes = Vec::with_capacity(CHUNK);
        let mut values = values.into_iter().peekable();
        while values.peek().is_some() {
            bytes.clear();
            let some = values.by_ref().take(CHUNK / size_of::<T>());
            some.for_each(|value| bytes.extend_from_slice(value.bytes().as_ref()));
            self.file.write_all_at(&bytes, at)?;
            at += bytes.len() as u64;
            self.comm.heartbeat();
        }
        Ok(())
    }

    /// Flushes all that this rank has written to the disk.
    ///
    /// # Errors
    ///
    /// If the disk is full or fails.
    pub fn flush(self) -> io::Result<()> {
        self.file.sync_all()
    }
}

/// Reads `count` values of a dataset, beginning with its value number `first`.
///
/// # Errors
///
/// If the dataset has fewer values, or the file cannot be read.
pub fn read_values<T: Plain>(
    comm: &dyn Comm,
    file: &fs::File,
    extent: &Extent,
    first: u64,
    count: usize,
) -> io::Result<Vec<T>> {
    let width = size_of::<T>();
    let end = (first + count as u64) * width as u64;
    if end > extent.bytes {
        return Err(io::Error::other(format!("{} has fewer values", extent.name)));
    }
    let mut values = Vec::with_capacity(count);
    let mut bytes = vec![0; CHUNK.min(count * width)];
    let mut at = extent.offset + first * width as u64;
    while values.len() < count {
        let some = (CHUNK / width).min(count - values.len());
        let bytes = &mut bytes[..some * width];
        file.read_exact_at(bytes, at)?;
        values.extend(bytes.chunks_exact(width).map(T::of_bytes));
        at += bytes.len() as u64;
        comm.heartbeat();
    }
    Ok(values)
}

/// Makes an error of one rank an error of all: rank 0 returns its own error or that of the first
/// other rank, the others return their own or [`OutputError::Elsewhere`]. Collective.
///
/// # Errors
///
/// If a rank has an error.
pub fn agree<T, E: From<OutputError> + ToString>(
    comm: &dyn Comm,
    mine: Result<T, E>,
) -> Result<T, E> {
    if comm.size() == 1 {
        return mine;
    }
    let mut failed = [i64::from(mine.is_err())];
    comm.sum(&mut failed);
    if failed[0] == 0 {
        return mine;
    }
    let text = mine.as_ref().err().map_or(String::new(), E::to_string);
    let texts = comm.gather(&words_of(text.as_bytes()));
    let other = texts.iter().map(|words| bytes_of(words)).enumerate();
    let other = other.skip(1).find(|(_, text)| !text.is_empty());
    mine.and_then(|_| {
        Err(match other {
            Some((rank, text)) => {
                OutputError::OnRank { rank, text: String::from_utf8_lossy(&text).into() }
            }
            None => OutputError::Elsewhere,
        }
        .into())
    })
}

/// Hands what rank 0 has to all ranks; the argument of other ranks is ignored. Collective.
///
/// # Panics
///
/// If a value does not survive JSON.
pub fn from_first<T: Serialize + DeserializeOwned>(comm: &dyn Comm, value: T) -> T {
    if comm.size() == 1 {
        return value;
    }
    let text = serde_json::to_vec(&value).expect("plain data");
    let text = comm.broadcast(if comm.rank() == 0 { text } else { Vec::new() });
    if comm.rank() == 0 { value } else { serde_json::from_slice(&text).expect("rank 0 sends it") }
}

#[cfg(test)]
mod tests {
    use decomp::comm::local::run_ranks;

    use super::*;

    #[test]
    fn shares_of_all_ranks_make_one_dataset() {
        let home = tempfile::tempdir().unwrap();
        for ranks in [1, 3] {
            let path = home.path().join(format!("{ranks}.hdf5"));
            // more than one chunk for each rank
            let each = CHUNK / 8 + 5;
            run_ranks(ranks, |comm| {
                let lay_out = || -> hdf5::Result<Extent> {
                    let file = hdf5::File::create(&path)?;
                    let extent = Extent::of("a".into(), &reserve::<f64>(&file, "a", ranks * each)?);
                    file.close()?;
                    Ok(extent)
                };
                let mine = if comm.rank() == 0 { lay_out().unwrap() } else { Extent::default() };
                let extent = from_first(comm, mine);
                let first = comm.rank() * each;
                let file = SharedFile::open(comm, &path).unwrap();
                file.put(&extent, first as u64, (first..first + each).map(|k| k as f64)).unwrap();
                file.flush().unwrap();
                agree::<(), OutputError>(comm, Ok(())).unwrap();
                let file = fs::File::open(&path).unwrap();
                let back = read_values::<f64>(comm, &file, &extent, 3, each - 3).unwrap();
                assert!(back.iter().zip(3..).all(|(a, k)| *a == f64::from(k)));
                let beyond = extent.bytes / 8 - 1;
                assert!(read_values::<f64>(comm, &file, &extent, beyond, 2).is_err());
            });
            let file = hdf5::File::open(&path).unwrap();
            let all: Vec<f64> = file.dataset("a").unwrap().read_raw().unwrap();
            assert!(
                all.len() == ranks * each && all.iter().zip(0..).all(|(a, k)| *a == f64::from(k))
            );
        }
    }

    #[test]
    fn an_error_of_one_rank_is_one_of_all() {
        for failing in [0, 2] {
            let texts = run_ranks(3, |comm| {
                let mine = match comm.rank() == failing {
                    true => Err(OutputError::NotAFolder("there".into())),
                    false => Ok(()),
                };
                agree(comm, mine).unwrap_err().to_string()
            });
            assert!(texts[0].contains("there: is not a folder"), "{texts:?}");
            assert!(texts[1].contains("another rank"), "{texts:?}");
            assert_eq!(failing == 2, texts[0].contains("rank 2"), "{texts:?}");
        }
    }
}
