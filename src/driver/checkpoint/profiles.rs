//! Files of finished profiles beside the checkpoints. A profile is written once, sealed as a checkpoint
//! is, and each later checkpoint names its file.

use std::cell::RefCell;
use std::fs;
use std::path::Path;

use decomp::Serial;
use hdf5::{File, Group};
use sha2::{Digest, Sha256};

use super::CheckpointError;
use super::datasets::{Reader, Writer, refused};
use super::seal::{FORMAT, HEAD, hexadecimal, seal, verify};
use crate::driver::output::OutputError;
use crate::driver::output::shared_file::Extent;
use crate::simulation::ParticleTable;

/// Start and end of the name of a file.
const NAME: [&str; 2] = ["profile-", ".hdf5"];

/// Prefix of the hidden name of a file during writing.
const PARTIAL: &str = ".profile-";

/// Whether a file is a profile of checkpoints, whole or partial.
pub fn is_profile(name: &str) -> bool {
    name.starts_with(PARTIAL) || (name.starts_with(NAME[0]) && name.ends_with(NAME[1]))
}

/// Name of the file of a profile and of the digest of its state; other profiles have other names.
pub fn file_name(table: &ParticleTable, state: &str) -> String {
    let mut digest = Sha256::new();
    let size = [table.time.to_bits(), table.len() as u64, table.dimension as u64];
    size.iter().for_each(|word| digest.update(word.to_le_bytes()));
    digest.update(state);
    for column in &table.columns {
        digest.update(&column.name);
        digest.update(b"\n");
    }
    format!("{}{}{}", NAME[0], &hexadecimal(digest)[..16], NAME[1])
}

/// Approximate size of the files that `folder` lacks [bytes].
pub fn missing_bytes(folder: &Path, tables: &[(ParticleTable, String)]) -> u64 {
    let missing = tables.iter().filter(|(t, state)| !folder.join(file_name(t, state)).exists());
    let bytes = |table: &ParticleTable| table.len() * (16 + 8 * (table.columns.len() + 4));
    // with the overhead of HDF5
    missing.map(|(table, _)| (bytes(table) + (16 << 10)) as u64).sum()
}

/// Writes the profiles that have no file beside `checkpoint` yet. Called on rank 0.
///
/// # Errors
///
/// If a file cannot be written.
pub(super) fn store(
    checkpoint: &Path,
    tables: &[(ParticleTable, String)],
    alive: &dyn Fn(),
) -> Result<(), CheckpointError> {
    for (table, state) in tables {
        let name = file_name(table, state);
        let path = checkpoint.with_file_name(&name);
        if path.exists() {
            continue;
        }
        let aside = checkpoint.with_file_name(name.replacen(NAME[0], PARTIAL, 1));
        // the file of an earlier process
        let _ = fs::remove_file(&aside);
        let written = write(&aside, table, state, alive).and_then(|()| {
            fs::rename(&aside, &path)
                .map_err(|e| OutputError::io("put the profile in place", &path)(e).into())
        });
        if written.is_err() {
            let _ = fs::remove_file(&aside);
        }
        written?;
        alive();
    }
    Ok(())
}

/// Writes a profile, sealed and flushed to disk.
fn write(
    path: &Path,
    table: &ParticleTable,
    state: &str,
    alive: &dyn Fn(),
) -> Result<(), CheckpointError> {
    let writer = Writer { extents: RefCell::default(), alive };
    let write = || -> hdf5::Result<Vec<Extent>> {
        let file = File::with_options().with_fcpl(|plist| plist.userblock(HEAD)).create(path)?;
        put(&writer, &file, table, state)?;
        file.flush()?;
        file.close()?;
        Ok(writer.extents.take())
    };
    let extents = write().map_err(|e| refused(path, e))?;
    seal(&Serial, path, &extents, (0, table.time), FORMAT)
}

fn put(to: &Writer, group: &Group, table: &ParticleTable, state: &str) -> hdf5::Result<()> {
    to.put(group, "time", &[table.time])?;
    to.put(group, "state_sha256", state.as_bytes())?;
    to.put(group, "id", &table.ids)?;
    to.put(group, "material", &table.material)?;
    to.put(group, "body", &table.body)?;
    let edges: Vec<f64> = table.half_edges.iter().flatten().flatten().copied().collect();
    to.put(group, "half_edges", &edges)?;
    let columns = group.create_group("columns")?;
    for (k, column) in table.columns.iter().enumerate() {
        to.column(&columns, k, &column.name, &column.unit, &column.values)?;
    }
    Ok(())
}

/// Reads the profile `name` beside `checkpoint`, with the digest of its state.
///
/// # Errors
///
/// If the file is missing, is damaged, or is another profile.
pub(super) fn read(
    checkpoint: &Path,
    name: &str,
    dimension: usize,
    materials: &[String],
) -> Result<(ParticleTable, String), CheckpointError> {
    let path = checkpoint.with_file_name(name);
    let damaged = |path: &Path, why: String| CheckpointError::Damaged { path: path.into(), why };
    if !path.exists() {
        let why = format!("the profile that it names, {name}, is no longer beside it");
        return Err(damaged(checkpoint, why));
    }
    verify(&Serial, &path, &|_| true)?;
    let length = fs::metadata(&path).map_or(0, |m| m.len());
    let read = || {
        let file = File::open(&path)?;
        get(&Reader { length }, &file, dimension, materials)
    };
    let (table, state) = read().map_err(|e| damaged(&path, e.to_string().replace('\n', "; ")))?;
    match file_name(&table, &state) == name {
        true => Ok((table, state)),
        false => Err(damaged(&path, "it is another profile".into())),
    }
}

fn get(
    from: &Reader,
    group: &Group,
    dimension: usize,
    materials: &[String],
) -> hdf5::Result<(ParticleTable, String)> {
    let time: Vec<f64> = from.values(group, "time")?;
    let state = String::from_utf8(from.values(group, "state_sha256")?);
    let edges: Vec<f64> = from.values(group, "half_edges")?;
    let table = ParticleTable {
        time: *time.first().ok_or("a profile without its time")?,
        dimension,
        ids: from.values(group, "id")?,
        material: from.values(group, "material")?,
        materials: materials.to_vec(),
        body: from.values(group, "body")?,
        columns: from.columns(&group.group("columns")?)?,
        half_edges: edges.chunks_exact(4).map(|e| [[e[0], e[1]], [e[2], e[3]]]).collect(),
    };
    let lengths = table.columns.iter().map(|c| c.values.len());
    let mut lengths = lengths.chain([table.material.len(), table.body.len()]);
    if lengths.any(|n| n != table.len()) {
        return Err("a profile whose columns are not alike in length".into());
    }
    Ok((table, state.map_err(|e| e.to_string())?))
}
