//! Datasets of checkpoints that rank 0 writes and reads: each carries the SHA-256 of its values, computed
//! before they are passed to HDF5.

use std::cell::RefCell;
use std::path::Path;

use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{Dataset, Group};
use sha2::{Digest, Sha256};

use super::CheckpointError;
use super::seal::hexadecimal;
use crate::driver::output::OutputError;
use crate::driver::output::shared_file::{Extent, Plain};
use crate::simulation::TableColumn;

fn digest<T: Plain>(values: &[T]) -> String {
    let mut digest = Sha256::new();
    let mut bytes = Vec::with_capacity(1 << 16);
    for chunk in values.chunks(1 << 12) {
        bytes.clear();
        chunk.iter().for_each(|v| bytes.extend_from_slice(v.bytes().as_ref()));
        digest.update(&bytes);
    }
    hexadecimal(digest)
}

/// The error that HDF5 has refused to write a file.
pub(super) fn refused(path: &Path, error: hdf5::Error) -> CheckpointError {
    let said = error.to_string().replace('\n', "; ");
    // if a write failed, only the system's reason in the text of HDF5 is useful
    let system = said.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\''));
    let message = match system {
        Some((reason, _)) => format!("{reason}: make room, or choose another --output"),
        None => said,
    };
    OutputError::Hdf5 { path: path.into(), message }.into()
}

/// Writes datasets and notes their places.
pub(super) struct Writer<'a> {
    /// Places of the datasets written so far.
    pub extents: RefCell<Vec<Extent>>,
    /// Called regularly.
    pub alive: &'a dyn Fn(),
}

impl Writer<'_> {
    /// Writes the values of a dataset with their digest.
    ///
    /// # Errors
    ///
    /// If HDF5 cannot write the dataset.
    pub fn put<T: Plain>(&self, group: &Group, name: &str, values: &[T]) -> hdf5::Result<Dataset> {
        let dataset =
            group.new_dataset::<T>().shape(values.len()).obj_track_times(false).create(name)?;
        dataset.write_raw(values)?;
        let digest = FixedAscii::<64>::from_ascii(&digest(values)).map_err(|e| e.to_string())?;
        dataset.new_attr::<FixedAscii<64>>().create("sha256")?.write_scalar(&digest)?;
        let path = dataset.name();
        self.extents.borrow_mut().push(Extent::of(path.trim_start_matches('/').into(), &dataset));
        Ok(dataset)
    }

    /// Writes a column with name and unit under its index, by which it is found. The values are in
    /// `unit`.
    ///
    /// # Errors
    ///
    /// If HDF5 cannot write the column.
    pub fn column(
        &self,
        group: &Group,
        place: usize,
        name: &str,
        unit: &str,
        values: &[f64],
    ) -> hdf5::Result<()> {
        name_column(&self.put(group, &format!("{place:04}"), values)?, name, unit)
    }
}

/// Adds the name and the unit of a column.
pub(super) fn name_column(dataset: &Dataset, name: &str, unit: &str) -> hdf5::Result<()> {
    for (key, text) in [("name", name), ("units", unit)] {
        let text: VarLenUnicode = text.parse().map_err(|_| format!("text of {key}"))?;
        dataset.new_attr::<VarLenUnicode>().create(key)?.write_scalar(&text)?;
    }
    Ok(())
}

/// Text of an attribute.
pub(super) fn text(dataset: &Dataset, key: &str) -> hdf5::Result<String> {
    Ok(dataset.attr(key)?.read_scalar::<VarLenUnicode>()?.to_string())
}

/// Reads datasets of a file of `length` bytes, which no dataset can exceed.
pub(super) struct Reader {
    /// Length of the file [B].
    pub length: u64,
}

impl Reader {
    /// The values of a dataset, which must have their digest.
    ///
    /// # Errors
    ///
    /// If the dataset is missing, is longer than the file, or differs from its digest.
    pub fn values<T: Plain>(&self, group: &Group, name: &str) -> hdf5::Result<Vec<T>> {
        let dataset = group.dataset(name)?;
        if (dataset.size() * size_of::<T>()) as u64 > self.length {
            return Err(format!("{name} is longer than the file").into());
        }
        let values: Vec<T> = dataset.read_raw()?;
        let stored: FixedAscii<64> = dataset.attr("sha256")?.read_scalar()?;
        match stored.as_str() == digest(&values) {
            true => Ok(values),
            false => Err(format!("the values of {name} are not those that were written").into()),
        }
    }

    /// The columns of a group, with names and units.
    ///
    /// # Errors
    ///
    /// If a dataset cannot be read, as in [`Reader::values`].
    pub fn columns(&self, group: &Group) -> hdf5::Result<Vec<TableColumn>> {
        let column = |k: u64| -> hdf5::Result<TableColumn> {
            let name = format!("{k:04}");
            let values = self.values(group, &name)?;
            let dataset = group.dataset(&name)?;
            Ok(TableColumn {
                name: text(&dataset, "name")?,
                unit: text(&dataset, "units")?,
                values,
            })
        };
        (0..group.len()).map(column).collect()
    }
}
