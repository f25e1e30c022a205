//! Format of a checkpoint on disk: HDF5 data behind a sealed head.
//!
//! `rows` holds id, cell and each state column of every particle, rank after rank: each rank writes
//! those of its patches. `histories` and `waves` hold the records; `scene` and `books` are JSON text.
//! Rank 0 writes these; each of their datasets carries the SHA-256 of its values. The particles have the
//! digest in `books`, which a restart compares with that of its patches. `books` names the files of the
//! profiles, which lie beside the checkpoint.

use std::cell::RefCell;
use std::fs;
use std::io;
use std::path::Path;

use decomp::{Census, Comm, Serial, StoredParticles};
use hdf5::{Dataset, File, Group};
use serde::{Deserialize, Serialize};

use super::datasets::{Reader, Writer, name_column, refused, text};
use super::seal::{FORMAT, HEAD, seal, verify};
use super::{Checkpoint, CheckpointContents, CheckpointError, Due, Record, StateColumn, profiles};
use crate::driver::figures::WaveRow;
use crate::driver::output::OutputError;
use crate::driver::output::histories::HistoryTable;
use crate::driver::output::origin::Origin;
use crate::driver::output::shared_file::{
    Extent, SharedFile, agree, from_first, read_values, reserve,
};
use crate::scene::MethodChoice;
use crate::simulation::monitor::{Peaks, SelfContactEvent};
use crate::simulation::{BodyRow, Saved};

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
    #[serde(default, skip_serializing_if = "Option::is_none")]
    self_contact: Option<SelfContactEvent>,
    /// Digest of the particles.
    state_sha256: String,
    due: Due,
    materials: Vec<String>,
    /// Names of the files of the profiles.
    profiles: Vec<String>,
    has_histories: bool,
}

impl Books {
    fn of(contents: &CheckpointContents) -> Books {
        let CheckpointContents { saved, tables, .. } = contents;
        Books {
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
            self_contact: saved.self_contact,
            state_sha256: saved.digest.clone(),
            due: contents.due.clone(),
            materials: tables.first().map_or(Vec::new(), |t| t.0.materials.clone()),
            profiles: tables
                .iter()
                .map(|(table, state)| profiles::file_name(table, state))
                .collect(),
            has_histories: contents.histories.is_some(),
        }
    }
}

/// First word of the names of the parts of a file with particles.
const PARTICLES: &str = "particles:";

/// Places of the particles in a file.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Rows {
    ids: Extent,
    cells: Extent,
    columns: Vec<Extent>,
}

/// A file that rank 0 has laid out.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct FileLayout {
    rows: Rows,
    /// Number of the first particle of each rank.
    firsts: Vec<u64>,
    /// Places of all datasets.
    extents: Vec<Extent>,
}

/// Writes a checkpoint at `path`, sealed and flushed to disk: the particles of each rank by that
/// rank, the rest by rank 0. Collective.
///
/// # Errors
///
/// If the file cannot be written; all ranks return an error.
pub fn write(
    comm: &dyn Comm,
    path: &Path,
    contents: &CheckpointContents,
) -> Result<(), CheckpointError> {
    write_as(comm, path, contents, FORMAT)
}

/// As `write`, with any format number.
///
/// # Errors
///
/// If the file cannot be written; all ranks return an error.
pub fn write_as(
    comm: &dyn Comm,
    path: &Path,
    contents: &CheckpointContents,
    format: u32,
) -> Result<(), CheckpointError> {
    let counts = comm.gather(&[contents.saved.particles.ids.len() as u64]).concat();
    let laid_out = match comm.rank() {
        0 => profiles::store(path, contents.tables, &|| comm.heartbeat()).and_then(|()| {
            lay_out(path, contents, &counts, &|| comm.heartbeat()).map_err(|e| refused(path, e))
        }),
        _ => Ok(FileLayout::default()),
    };
    let plan = from_first(comm, agree(comm, laid_out)?);
    let share = || -> io::Result<()> {
        let (file, particles) = (SharedFile::open(comm, path)?, &contents.saved.particles);
        let first = plan.firsts[comm.rank()];
        file.put(&plan.rows.ids, first, particles.ids.iter().copied())?;
        let first_cell = first * contents.dimension as u64;
        file.put(&plan.rows.cells, first_cell, particles.cells.iter().copied())?;
        for (extent, column) in plan.rows.columns.iter().zip(&particles.columns) {
            file.put(extent, first, column.iter().copied())?;
        }
        file.flush()
    };
    agree(comm, share().map_err(|e| unwritten(path, e)))?;
    seal(comm, path, &plan.extents, (contents.saved.step, contents.saved.time), format)
}

/// The error that a share could not be written.
fn unwritten(path: &Path, error: io::Error) -> CheckpointError {
    match error.kind() {
        io::ErrorKind::StorageFull => {
            let message = format!("{error}: make room, or choose another --output");
            OutputError::Hdf5 { path: path.into(), message }.into()
        }
        _ => OutputError::io("write the checkpoint", path)(error).into(),
    }
}

/// Writes all but the particles, and makes room for these; rank number k has `counts[k]` of them.
fn lay_out(
    path: &Path,
    contents: &CheckpointContents,
    counts: &[u64],
    alive: &dyn Fn(),
) -> hdf5::Result<FileLayout> {
    let file = File::with_options().with_fcpl(|plist| plist.userblock(HEAD)).create(path)?;
    let writer = Writer { extents: RefCell::default(), alive };
    let rows = writer.rows(&file, contents, counts.iter().sum::<u64>() as usize)?;
    writer.root(&file, contents)?;
    file.flush()?;
    file.close()?;
    let mut next = 0;
    let first = |count: &u64| {
        next += count;
        next - count
    };
    let firsts = counts.iter().map(first).collect();
    Ok(FileLayout { rows, firsts, extents: writer.extents.into_inner() })
}

impl Writer<'_> {
    /// Makes room for `count` particles.
    fn rows(
        &self,
        file: &Group,
        contents: &CheckpointContents,
        count: usize,
    ) -> hdf5::Result<Rows> {
        let rows = file.create_group("rows")?;
        let note = |dataset: &Dataset, name: &str| {
            let extent = Extent::of(format!("{PARTICLES} {name}"), dataset);
            self.extents.borrow_mut().push(extent.clone());
            extent
        };
        let ids = note(&reserve::<u64>(&rows, "id", count)?, "id");
        let cells = note(&reserve::<i32>(&rows, "cell", contents.dimension * count)?, "cell");
        let state = rows.create_group("state")?;
        let mut columns = Vec::new();
        for (k, column) in contents.columns.iter().enumerate() {
            let dataset = reserve::<f64>(&state, &format!("{k:04}"), count)?;
            name_column(&dataset, &column.name, &column.unit)?;
            columns.push(note(&dataset, &column.name));
        }
        Ok(Rows { ids, cells, columns })
    }

    /// Writes the scene, all scalar values and the records.
    fn root(&self, file: &Group, contents: &CheckpointContents) -> hdf5::Result<()> {
        let books = serde_json::to_string(&Books::of(contents)).map_err(|e| e.to_string())?;
        self.put(file, "scene", contents.scene.as_bytes())?;
        self.put(file, "books", books.as_bytes())?;
        let waves = file.create_group("waves")?;
        let times: Vec<f64> = contents.waves.iter().map(|w| w.time).collect();
        let counts: Vec<u64> = contents.waves.iter().map(|w| w.x.len() as u64).collect();
        self.put(&waves, "time", &times)?;
        self.put(&waves, "points", &counts)?;
        let all = |of: &dyn Fn(&WaveRow) -> &[f64]| -> Vec<f64> {
            contents.waves.iter().flat_map(|row| of(row).iter().copied()).collect()
        };
        self.put(&waves, "x", &all(&|row| &row.x))?;
        self.put(&waves, "pressure", &all(&|row| &row.pressure))?;
        for k in 0..contents.due.quantities.len() {
            let known = contents.waves.iter().map(|w| w.others[k].len() as u64);
            self.put(&waves, &format!("points_{k:04}"), &known.collect::<Vec<u64>>())?;
            self.put(&waves, &format!("values_{k:04}"), &all(&|row| &row.others[k]))?;
        }
        self.bodies(&file.create_group("bodies")?, contents.bodies)?;
        let histories = file.create_group("histories")?;
        let columns = contents.histories.map_or(&[][..], |h| h.columns());
        for (k, column) in columns.iter().enumerate() {
            self.column(&histories, k, &column.name, &column.unit, &column.values)?;
        }
        (self.alive)();
        Ok(())
    }

    /// Writes the surfaces and the failed parts of bodies: ends in pairs, with their numbers per row.
    fn bodies(&self, group: &Group, rows: &[BodyRow]) -> hdf5::Result<()> {
        self.put(group, "time", &rows.iter().map(|row| row.time).collect::<Vec<f64>>())?;
        let put_parts = |name: &str, parts: Vec<&Vec<[f64; 2]>>| -> hdf5::Result<()> {
            let counts: Vec<u64> = parts.iter().map(|parts| parts.len() as u64).collect();
            let ends: Vec<f64> = parts.into_iter().flatten().flatten().copied().collect();
            self.put(group, &format!("{name}_counts"), &counts)?;
            self.put(group, name, &ends)?;
            Ok(())
        };
        put_parts("ends", rows.iter().map(|row| &row.ends).collect())?;
        put_parts("failed", rows.iter().map(|row| &row.failed).collect())
    }
}

/// Reads a checkpoint after verifying its seal: on each rank a share of the particles, on rank 0 the
/// records. Collective.
///
/// # Errors
///
/// If the file cannot be read, is damaged, or has another format; all ranks return an error.
pub fn read(comm: &dyn Comm, path: &Path) -> Result<Checkpoint, CheckpointError> {
    verify(comm, path, &|_| true)?;
    agree(comm, read_verified(comm, path))
}

/// Reads a checkpoint without its particles and records. Called on one rank.
///
/// # Errors
///
/// As [`read`].
pub fn read_head_alone(path: &Path) -> Result<Checkpoint, CheckpointError> {
    verify(&Serial, path, &|name| !name.starts_with(PARTICLES))?;
    read_head(path, false).map(|(checkpoint, _)| checkpoint)
}

fn read_verified(comm: &dyn Comm, path: &Path) -> Result<Checkpoint, CheckpointError> {
    let (mut checkpoint, rows) = read_head(path, comm.rank() == 0)?;
    let share = || -> io::Result<StoredParticles> {
        let file = fs::File::open(path)?;
        let count = rows.ids.bytes / size_of::<u64>() as u64;
        let bound = |rank: usize| count * rank as u64 / comm.size() as u64;
        let (first, end) = (bound(comm.rank()), bound(comm.rank() + 1));
        let (n, dimension) = ((end - first) as usize, checkpoint.dimension);
        let cells = read_values(comm, &file, &rows.cells, first * dimension as u64, n * dimension)?;
        let column = |extent: &Extent| read_values(comm, &file, extent, first, n);
        Ok(StoredParticles {
            ids: read_values(comm, &file, &rows.ids, first, n)?,
            cells,
            columns: rows.columns.iter().map(column).collect::<io::Result<_>>()?,
        })
    };
    checkpoint.saved.particles =
        share().map_err(OutputError::io("read the particles of the checkpoint", path))?;
    Ok(checkpoint)
}

/// Reads all but the particles, with the records if they are `wanted`, and the places of the
/// particles.
fn read_head(path: &Path, wanted: bool) -> Result<(Checkpoint, Rows), CheckpointError> {
    let length = fs::metadata(path).map_or(0, |m| m.len());
    let read = || -> hdf5::Result<(Checkpoint, Rows, ProfileNames)> {
        let file = File::open(path)?;
        read_root(&file, length, wanted)
    };
    let (mut checkpoint, rows, (names, materials)) = read().map_err(|e| {
        CheckpointError::Damaged { path: path.into(), why: e.to_string().replace('\n', "; ") }
    })?;
    if wanted {
        let of = |name: &String| profiles::read(path, name, checkpoint.dimension, &materials);
        checkpoint.record.tables = names.iter().map(of).collect::<Result<_, _>>()?;
    }
    Ok((checkpoint, rows))
}

/// Names of the files of profiles, and of the materials in them.
type ProfileNames = (Vec<String>, Vec<String>);

fn read_root(
    file: &Group,
    length: u64,
    wanted: bool,
) -> hdf5::Result<(Checkpoint, Rows, ProfileNames)> {
    let get = Reader { length };
    let books: Books = serde_json::from_slice(&get.values::<u8>(file, "books")?)
        .map_err(|e| format!("books: {e}"))?;
    let sums = books.sums.iter().map(|s| s.parse::<i128>().map_err(|e| format!("sums: {e}")));
    let rows = file.group("rows")?;
    let state = rows.group("state")?;
    let (mut columns, mut extents) = (Vec::new(), Vec::new());
    for k in 0..state.len() {
        let dataset = state.dataset(&format!("{k:04}"))?;
        let [name, unit] = ["name", "units"].map(|key| text(&dataset, key));
        columns.push(StateColumn { name: name?, unit: unit? });
        extents.push(Extent::of(columns[columns.len() - 1].name.clone(), &dataset));
    }
    let [ids, cells] = ["id", "cell"].map(|name| rows.dataset(name));
    let rows = Rows {
        ids: Extent::of("id".into(), &ids?),
        cells: Extent::of("cell".into(), &cells?),
        columns: extents,
    };
    let record = if wanted { get.record(file, &books)? } else { Record::default() };
    let scene = String::from_utf8(get.values(file, "scene")?).map_err(|e| e.to_string())?;
    let checkpoint = Checkpoint {
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
            self_contact: books.self_contact,
            digest: books.state_sha256,
            particles: StoredParticles::default(),
        },
        columns,
        due: books.due,
        record,
    };
    Ok((checkpoint, rows, (books.profiles, books.materials)))
}

impl Reader {
    fn record(&self, file: &Group, books: &Books) -> hdf5::Result<Record> {
        let mut record = Record::default();
        let waves = file.group("waves")?;
        let times: Vec<f64> = self.values(&waves, "time")?;
        let rows = |counts: &str, values: &str| -> hdf5::Result<Vec<Vec<f64>>> {
            let counts: Vec<u64> = self.values(&waves, counts)?;
            let mut values = self.values::<f64>(&waves, values)?.into_iter();
            if counts.len() != times.len() {
                return Err("as many rows as times are needed".into());
            }
            Ok(counts.iter().map(|&n| values.by_ref().take(n as usize).collect()).collect())
        };
        let (x, pressure) = (rows("points", "x")?, rows("points", "pressure")?);
        for (&time, (x, pressure)) in times.iter().zip(x.into_iter().zip(pressure)) {
            record.waves.push(WaveRow { time, x, pressure, others: Vec::new() });
        }
        for k in 0..books.due.quantities.len() {
            let of_rows = rows(&format!("points_{k:04}"), &format!("values_{k:04}"))?;
            let of_rows = record.waves.iter_mut().zip(of_rows);
            of_rows.for_each(|(row, values)| row.others.push(values));
        }
        record.bodies = self.bodies(&file.group("bodies")?)?;
        if record.bodies.len() != record.waves.len() {
            return Err("as many rows of bodies as of pressure are needed".into());
        }
        if books.has_histories {
            record.histories = Some(HistoryTable::of(self.columns(&file.group("histories")?)?));
        }
        Ok(record)
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
}
