//! Format of a checkpoint on disk: HDF5 data behind a sealed head.
//!
//! `rows` holds id, cell and each state column of every particle; `profiles`, `histories` and
//! `waves` hold the records; `scene` and `books` are JSON text. Each dataset carries the SHA-256 of
//! its values, computed before they are passed to HDF5.

use std::path::Path;

use decomp::{Census, StoredParticles};
use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{Dataset, File, Group, H5Type};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::seal::{FORMAT, HEAD, hexadecimal, seal, verify};
use super::{Checkpoint, CheckpointContents, CheckpointError, Due, Record, StateColumn};
use crate::driver::figures::PressureRow;
use crate::driver::output::OutputError;
use crate::driver::output::histories::HistoryTable;
use crate::driver::output::origin::Origin;
use crate::scene::MethodChoice;
use crate::simulation::monitor::Peaks;
use crate::simulation::{BodyRow, ParticleTable, Saved, TableColumn};

/// All scalar values.
#[derive(Serialize, Deserialize)]
struct Books {
    version: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<Origin>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    method_choice: Option<MethodChoice>,
    dimension: usize,
    time: f64,
    step: u64,
    /// `None` if no particle is left to bound the time step.
    stable: Option<f64>,
    longest: f64,
    #[serde(default)]
    redone_steps: u64,
    left: [u64; 2],
    /// Integers of 128 bits as text, because few JSON readers support them.
    sums: Vec<String>,
    #[serde(default)]
    peaks: Peaks,
    due: Due,
    materials: Vec<String>,
    profiles: usize,
    has_histories: bool,
}

/// A type of value that a dataset may hold.
trait Plain: H5Type + Copy {
    fn bytes(self) -> impl AsRef<[u8]>;
}

macro_rules! plain {
    ($($kind:ty),*) => {$(
        impl Plain for $kind {
            fn bytes(self) -> impl AsRef<[u8]> {
                self.to_le_bytes()
            }
        }
    )*};
}
plain!(u8, u32, i32, u64, f64);

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

/// Writes a checkpoint at `path`, sealed and flushed to disk; `alive` is called regularly.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write(
    path: &Path,
    contents: &CheckpointContents,
    alive: &dyn Fn(),
) -> Result<(), CheckpointError> {
    write_as(path, contents, alive, FORMAT)
}

/// As `write`, with any format number.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write_as(
    path: &Path,
    contents: &CheckpointContents,
    alive: &dyn Fn(),
    format: u32,
) -> Result<(), CheckpointError> {
    let write = || -> hdf5::Result<()> {
        let file = File::with_options().with_fcpl(|plist| plist.userblock(HEAD)).create(path)?;
        write_root(&file, contents, alive)?;
        file.flush()?;
        file.close()
    };
    write().map_err(|e| refused(path, e))?;
    seal(path, contents, format)
}

fn refused(path: &Path, error: hdf5::Error) -> CheckpointError {
    let said = error.to_string().replace('\n', "; ");
    // if a write failed, only the system's reason in the text of HDF5 is useful
    let system = said.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\''));
    let message = match system {
        Some((reason, _)) => format!("{reason}: make room, or choose another --output"),
        None => said,
    };
    OutputError::Hdf5 { path: path.into(), message }.into()
}

fn write_root(file: &Group, contents: &CheckpointContents, alive: &dyn Fn()) -> hdf5::Result<()> {
    let CheckpointContents { saved, tables, .. } = contents;
    let books = Books {
        version: env!("CARGO_PKG_VERSION").into(),
        origin: contents.origin.cloned(),
        method_choice: contents.method_choice.cloned(),
        dimension: contents.dimension,
        time: saved.time,
        step: saved.step,
        stable: saved.stable.is_finite().then_some(saved.stable),
        longest: saved.longest,
        redone_steps: saved.redone_steps,
        left: [saved.left.particles, saved.left.marks],
        sums: saved.sums.iter().map(i128::to_string).collect(),
        peaks: saved.peaks,
        due: contents.due.clone(),
        materials: tables.first().map_or(Vec::new(), |t| t.0.materials.clone()),
        profiles: tables.len(),
        has_histories: contents.histories.is_some(),
    };
    let books = serde_json::to_string(&books).map_err(|e| e.to_string())?;
    put(file, "scene", contents.scene.as_bytes())?;
    put(file, "books", books.as_bytes())?;
    let rows = file.create_group("rows")?;
    put(&rows, "id", &saved.particles.ids)?;
    put(&rows, "cell", &saved.particles.cells)?;
    let state = rows.create_group("state")?;
    for (k, (column, values)) in contents.columns.iter().zip(&saved.particles.columns).enumerate() {
        put_column(&state, k, &column.name, &column.unit, values)?;
        alive();
    }
    let profiles = file.create_group("profiles")?;
    for (k, (table, state)) in tables.iter().enumerate() {
        write_table(&profiles.create_group(&format!("{k:04}"))?, table, state)?;
        alive();
    }
    let waves = file.create_group("waves")?;
    let times: Vec<f64> = contents.waves.iter().map(|w| w.time).collect();
    let counts: Vec<u64> = contents.waves.iter().map(|w| w.points.len() as u64).collect();
    let points = contents.waves.iter().flat_map(|w| &w.points);
    let points: Vec<f64> = points.flat_map(|p| [p.0, p.1]).collect();
    put(&waves, "time", &times)?;
    put(&waves, "points", &counts)?;
    put(&waves, "x_and_pressure", &points)?;
    put_bodies(&file.create_group("bodies")?, contents.bodies)?;
    let histories = file.create_group("histories")?;
    let columns = contents.histories.map_or(&[][..], |h| h.columns());
    for (k, column) in columns.iter().enumerate() {
        put_column(&histories, k, &column.name, &column.unit, &column.values)?;
    }
    alive();
    Ok(())
}

/// Writes the surfaces and the failed parts of bodies: ends in pairs, with their numbers per row.
fn put_bodies(group: &Group, rows: &[BodyRow]) -> hdf5::Result<()> {
    put(group, "time", &rows.iter().map(|row| row.time).collect::<Vec<f64>>())?;
    let put_parts = |name: &str, parts: Vec<&Vec<[f64; 2]>>| -> hdf5::Result<()> {
        let counts: Vec<u64> = parts.iter().map(|parts| parts.len() as u64).collect();
        let ends: Vec<f64> = parts.into_iter().flatten().flatten().copied().collect();
        put(group, &format!("{name}_counts"), &counts)?;
        put(group, name, &ends)?;
        Ok(())
    };
    put_parts("ends", rows.iter().map(|row| &row.ends).collect())?;
    put_parts("failed", rows.iter().map(|row| &row.failed).collect())
}

fn write_table(group: &Group, table: &ParticleTable, state: &str) -> hdf5::Result<()> {
    put(group, "time", &[table.time])?;
    put(group, "state_sha256", state.as_bytes())?;
    put(group, "id", &table.ids)?;
    put(group, "material", &table.material)?;
    put(group, "body", &table.body)?;
    let edges: Vec<f64> = table.half_edges.iter().flatten().flatten().copied().collect();
    put(group, "half_edges", &edges)?;
    let columns = group.create_group("columns")?;
    for (k, column) in table.columns.iter().enumerate() {
        put_column(&columns, k, &column.name, &column.unit, &column.values)?;
    }
    Ok(())
}

fn put<T: Plain>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<Dataset> {
    let dataset =
        group.new_dataset::<T>().shape(values.len()).obj_track_times(false).create(name)?;
    dataset.write_raw(values)?;
    let digest = FixedAscii::<64>::from_ascii(&digest(values)).map_err(|e| e.to_string())?;
    dataset.new_attr::<FixedAscii<64>>().create("sha256")?.write_scalar(&digest)?;
    Ok(dataset)
}

/// Writes a column with name and unit under its index, by which it is found.
fn put_column(
    group: &Group,
    place: usize,
    name: &str,
    unit: &str,
    values: &[f64],
) -> hdf5::Result<()> {
    let dataset = put(group, &format!("{place:04}"), values)?;
    for (key, text) in [("name", name), ("units", unit)] {
        let text: VarLenUnicode = text.parse().map_err(|_| format!("text of {key}"))?;
        dataset.new_attr::<VarLenUnicode>().create(key)?.write_scalar(&text)?;
    }
    Ok(())
}

/// Reads a checkpoint after verifying its seal.
///
/// # Errors
///
/// If the file cannot be read, is damaged, or has another format.
pub fn read(path: &Path) -> Result<Checkpoint, CheckpointError> {
    verify(path)?;
    let length = std::fs::metadata(path).map_or(0, |m| m.len());
    let read = || -> hdf5::Result<Checkpoint> {
        let file = File::open(path)?;
        read_root(&file, length)
    };
    read().map_err(|e| CheckpointError::Damaged {
        path: path.into(),
        why: e.to_string().replace('\n', "; "),
    })
}

fn read_root(file: &Group, length: u64) -> hdf5::Result<Checkpoint> {
    let get = Reader { length };
    let books: Books = serde_json::from_slice(&get.values::<u8>(file, "books")?)
        .map_err(|e| format!("books: {e}"))?;
    let sums = books.sums.iter().map(|s| s.parse::<i128>().map_err(|e| format!("sums: {e}")));
    let rows = file.group("rows")?;
    let state = get.columns(&rows.group("state")?)?;
    let names = state.iter().map(|c| StateColumn { name: c.name.clone(), unit: c.unit.clone() });
    let columns: Vec<StateColumn> = names.collect();
    let mut record = Record::default();
    for k in 0..books.profiles {
        let group = file.group(&format!("profiles/{k:04}"))?;
        record.tables.push(get.table(&group, &books)?);
    }
    let waves = file.group("waves")?;
    let points: Vec<f64> = get.values(&waves, "x_and_pressure")?;
    let mut points = points.chunks_exact(2).map(|p| (p[0], p[1]));
    let counts: Vec<u64> = get.values(&waves, "points")?;
    for (time, count) in get.values::<f64>(&waves, "time")?.into_iter().zip(counts) {
        let points = points.by_ref().take(count as usize).collect();
        record.waves.push(PressureRow { time, points });
    }
    record.bodies = get.bodies(&file.group("bodies")?)?;
    if record.bodies.len() != record.waves.len() {
        return Err("as many rows of bodies as of pressure are needed".into());
    }
    if books.has_histories {
        record.histories = Some(HistoryTable::of(get.columns(&file.group("histories")?)?));
    }
    let scene = String::from_utf8(get.values(file, "scene")?).map_err(|e| e.to_string())?;
    Ok(Checkpoint {
        version: books.version,
        origin: books.origin,
        method_choice: books.method_choice,
        scene,
        dimension: books.dimension,
        saved: Saved {
            time: books.time,
            step: books.step,
            stable: books.stable.unwrap_or(f64::INFINITY),
            longest: books.longest,
            redone_steps: books.redone_steps,
            left: Census { particles: books.left[0], marks: books.left[1] },
            sums: sums.collect::<Result<_, _>>()?,
            peaks: books.peaks,
            particles: StoredParticles {
                ids: get.values(&rows, "id")?,
                cells: get.values(&rows, "cell")?,
                columns: state.into_iter().map(|c| c.values).collect(),
            },
        },
        columns,
        due: books.due,
        record,
    })
}

/// Reads datasets of a file of `length` bytes, which no dataset can exceed.
struct Reader {
    length: u64,
}

impl Reader {
    fn values<T: Plain>(&self, group: &Group, name: &str) -> hdf5::Result<Vec<T>> {
        let dataset = group.dataset(name)?;
        if (dataset.size() * size_of::<T>()) as u64 > self.length {
            return Err(format!("{name} is longer than the file").into());
        }
        let values: Vec<T> = dataset.read_raw()?;
        let recorded: FixedAscii<64> = dataset.attr("sha256")?.read_scalar()?;
        match recorded.as_str() == digest(&values) {
            true => Ok(values),
            false => Err(format!("the values of {name} are not those that were written").into()),
        }
    }

    fn bodies(&self, group: &Group) -> hdf5::Result<Vec<BodyRow>> {
        let times: Vec<f64> = self.values(group, "time")?;
        let parts = |name: &str| -> hdf5::Result<Vec<Vec<[f64; 2]>>> {
            let ends: Vec<f64> = self.values(group, name)?;
            let mut ends = ends.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
            let counts: Vec<u64> = self.values(group, &format!("{name}_counts"))?;
            Ok(counts.into_iter().map(|n| ends.by_ref().take(n as usize).collect()).collect())
        };
        let (ends, failed) = (parts("ends")?, parts("failed")?);
        if [ends.len(), failed.len()] != [times.len(); 2] {
            return Err("rows of bodies of different numbers".into());
        }
        let rows = times.into_iter().zip(ends.into_iter().zip(failed));
        Ok(rows.map(|(time, (ends, failed))| BodyRow { time, ends, failed }).collect())
    }

    fn columns(&self, group: &Group) -> hdf5::Result<Vec<TableColumn>> {
        let column = |k: u64| -> hdf5::Result<TableColumn> {
            let name = format!("{k:04}");
            let values = self.values(group, &name)?;
            let dataset = group.dataset(&name)?;
            let text = |key: &str| -> hdf5::Result<String> {
                Ok(dataset.attr(key)?.read_scalar::<VarLenUnicode>()?.to_string())
            };
            Ok(TableColumn { name: text("name")?, unit: text("units")?, values })
        };
        (0..group.len()).map(column).collect()
    }

    fn table(&self, group: &Group, books: &Books) -> hdf5::Result<(ParticleTable, String)> {
        let time: Vec<f64> = self.values(group, "time")?;
        let state = String::from_utf8(self.values(group, "state_sha256")?);
        let edges: Vec<f64> = self.values(group, "half_edges")?;
        let table = ParticleTable {
            time: *time.first().ok_or("a profile without its time")?,
            dimension: books.dimension,
            ids: self.values(group, "id")?,
            material: self.values(group, "material")?,
            materials: books.materials.clone(),
            body: self.values(group, "body")?,
            columns: self.columns(&group.group("columns")?)?,
            half_edges: edges.chunks_exact(4).map(|e| [[e[0], e[1]], [e[2], e[3]]]).collect(),
        };
        let lengths = table.columns.iter().map(|c| c.values.len());
        let mut lengths = lengths.chain([table.material.len(), table.body.len()]);
        if lengths.any(|n| n != table.len()) {
            return Err("a profile whose columns are not alike in length".into());
        }
        Ok((table, state.map_err(|e| e.to_string())?))
    }
}
