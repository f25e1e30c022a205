//! Fields of the particles at many times, as VTKHDF that grows as the run goes.
//!
//! `fields/` holds data files, each with room for some frames; rank 0 lays out a data file, and all
//! ranks write their shares of each frame into it, in order of id. `fields.vtkhdf` presents all frames
//! as one temporal PolyData (VTK file formats, "VTKHDF File Format"), whose arrays are views of the
//! data files (HDF5 virtual datasets). It is small; rank 0 writes it anew after each frame and renames
//! it, so that a run that is killed at any moment leaves a file with all frames until then.

use std::fs;
use std::path::{Path, PathBuf};

use decomp::Comm;
use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{Dataset, File, Group, H5Type};
use serde::{Deserialize, Serialize};

use super::error::OutputError;
use super::field_arrays::{FieldArray, Kind};
use super::shared_file::{Extent, SharedFile, agree, from_first, reserve};
use super::vtkhdf::{RunInfo, text_attribute, vector};
use crate::simulation::ParticleTable;

/// Name of the file that presents all frames.
pub const FIELDS_FILE: &str = "fields.vtkhdf";

/// Folder of the data files, beside [`FIELDS_FILE`].
pub const FIELDS_FOLDER: &str = "fields";

/// Frames of a data file.
const FRAMES_PER_FILE: usize = 16;

/// Data file of the vertices, which are the same for all frames.
const VERTICES: &str = "vertices.hdf5";

/// Name of the points in a data file.
const POINTS: &str = "Points";

/// A data file: its first frame, the frames for which it has room, and the places of its arrays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct DataFile {
    name: String,
    first: usize,
    room: usize,
    extents: Vec<Extent>,
}

/// A frame that is complete.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FieldFrame {
    /// Time [s].
    time: f64,
    particles: usize,
}

/// The files of the frames. All ranks know them; rank 0 writes the index.
#[derive(Debug)]
pub struct FieldFiles {
    folder: PathBuf,
    /// Rows of a frame in a data file: particles at the start.
    rows: usize,
    files: Vec<DataFile>,
    frames: Vec<FieldFrame>,
}

impl FieldFiles {
    /// The files in `folder`, which rank 0 names, with room for `rows` particles a frame. The first
    /// `keep` frames of a run that is continued stay, if all of them are there. Collective.
    ///
    /// # Errors
    ///
    /// If the folder cannot be written; all ranks return an error.
    pub fn open(
        comm: &dyn Comm,
        folder: &Path,
        rows: usize,
        keep: usize,
    ) -> Result<FieldFiles, OutputError> {
        let first = comm.rank() == 0;
        let make = || -> Result<PathBuf, OutputError> {
            let data = folder.join(FIELDS_FOLDER);
            fs::create_dir_all(&data).map_err(OutputError::io("create the folder", &data))?;
            write_vertices(&data.join(VERTICES), rows).map_err(|e| refused(&data, e))?;
            Ok(folder.to_path_buf())
        };
        let folder =
            from_first(comm, agree(comm, if first { make() } else { Ok(PathBuf::new()) })?);
        let mut files = FieldFiles { folder, rows, files: Vec::new(), frames: Vec::new() };
        let found = if first && keep > 0 { files.earlier(keep) } else { None };
        let found = from_first(
            comm,
            found.map(|(files, frames)| {
                let frames: Vec<(u64, usize)> =
                    frames.iter().map(|f| (f.time.to_bits(), f.particles)).collect();
                (files, frames)
            }),
        );
        if let Some((data, frames)) = found {
            files.files = data;
            let frame = |(time, particles)| FieldFrame { time: f64::from_bits(time), particles };
            files.frames = frames.into_iter().map(frame).collect();
        }
        Ok(files)
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// The first `keep` frames of an earlier run and their data files; `None` if they are not all
    /// there.
    fn earlier(&self, keep: usize) -> Option<(Vec<DataFile>, Vec<FieldFrame>)> {
        let read = || -> hdf5::Result<(Vec<DataFile>, Vec<FieldFrame>)> {
            let root = File::open(self.folder.join(FIELDS_FILE))?.group("VTKHDF")?;
            let times = root.dataset("Steps/Values")?.read_raw::<f64>()?;
            let counts = root.dataset("NumberOfPoints")?.read_raw::<i64>()?;
            let frame = |(time, n): (f64, i64)| FieldFrame { time, particles: n as usize };
            let frames = times.into_iter().zip(counts).map(frame).take(keep).collect();
            let text = root.attr("data_files")?.read_scalar::<VarLenUnicode>()?.to_string();
            let files: Vec<DataFile> = serde_json::from_str(&text).map_err(|e| e.to_string())?;
            Ok((files.into_iter().filter(|file| file.first < keep).collect(), frames))
        };
        let (files, frames) = read().ok()?;
        let whole =
            files.iter().all(|file| self.folder.join(FIELDS_FOLDER).join(&file.name).exists());
        (whole && frames.len() == keep).then_some((files, frames))
    }

    /// Adds a frame, of which `share` is the part of this rank, and updates the index. `left` is the
    /// number of frames that the run still plans, this one included. Collective.
    ///
    /// # Errors
    ///
    /// If the disk is full or a file cannot be written; all ranks return an error.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn add(
        &mut self,
        comm: &dyn Comm,
        share: &ParticleTable,
        left: usize,
        info: &RunInfo,
    ) -> Result<(), OutputError> {
        let arrays = FieldArray::of(share);
        let mut counts = vec![0; comm.size()];
        counts[comm.rank()] = share.len() as i64;
        comm.sum(&mut counts);
        let before: i64 = counts[..comm.rank()].iter().sum();
        let particles = counts.iter().sum::<i64>() as usize;
        let number = self.frames.len();
        self.make_room(comm, &arrays, left)?;
        let file = self.files.last().expect("a data file with room");
        let first = ((number - file.first) * self.rows) as u64 + before as u64;
        let path = self.folder.join(FIELDS_FOLDER).join(&file.name);
        let write = || -> std::io::Result<()> {
            let shared = SharedFile::open(comm, &path)?;
            let mut extents = file.extents.iter();
            let mut next = || extents.next().expect("as many arrays in each frame");
            shared.put(next(), 3 * first, points(share))?;
            for array in &arrays {
                let extent = next();
                match array.kind {
                    Kind::Number => {
                        shared.put(extent, array.width() as u64 * first, array.numbers(share))?;
                    }
                    Kind::Id => shared.put(extent, first, share.ids.iter().map(|&id| id as i64))?,
                    Kind::Material => {
                        shared.put(extent, first, share.material.iter().map(|&k| k as i32))?
                    }
                    Kind::Body => {
                        shared.put(extent, first, share.body.iter().map(|&k| k as i32))?
                    }
                }
            }
            Ok(())
        };
        agree(comm, write().map_err(OutputError::io("write the fields", &path)))?;
        self.frames.push(FieldFrame { time: share.time, particles });
        let index = match comm.rank() {
            0 => self.write_index(&arrays, share.dimension, info),
            _ => Ok(()),
        };
        let index = agree(comm, index);
        if index.is_err() {
            self.frames.pop();
        }
        index
    }

    /// Lays out a data file if the last one has no room for another frame. Collective.
    fn make_room(
        &mut self,
        comm: &dyn Comm,
        arrays: &[FieldArray],
        left: usize,
    ) -> Result<(), OutputError> {
        let number = self.frames.len();
        let fits = |file: &DataFile| {
            let same =
                file.extents.iter().skip(1).map(|e| &e.name).eq(arrays.iter().map(|a| &a.name));
            number < file.first + file.room && same
        };
        if self.files.last().is_some_and(fits) {
            return Ok(());
        }
        let (name, room) = (format!("frames_{number:06}.hdf5"), FRAMES_PER_FILE.min(left.max(1)));
        let path = self.folder.join(FIELDS_FOLDER).join(&name);
        let lay_out = || -> hdf5::Result<DataFile> {
            let _ = fs::remove_file(&path);
            let (file, rows) = (File::create(&path)?, room * self.rows);
            let place = |name: &str, dataset: &Dataset| Extent::of(name.into(), dataset);
            let mut extents = vec![place(POINTS, &reserve::<f64>(&file, POINTS, (rows, 3))?)];
            for array in arrays {
                let dataset = match (array.kind, array.width()) {
                    (Kind::Number, 1) => reserve::<f64>(&file, &array.name, rows)?,
                    (Kind::Number, width) => reserve::<f64>(&file, &array.name, (rows, width))?,
                    (Kind::Id, _) => reserve::<i64>(&file, &array.name, rows)?,
                    (Kind::Material | Kind::Body, _) => reserve::<i32>(&file, &array.name, rows)?,
                };
                extents.push(place(&array.name, &dataset));
            }
            file.close()?;
            Ok(DataFile { name: name.clone(), first: number, room, extents })
        };
        let made = if comm.rank() == 0 { lay_out() } else { Ok(DataFile::default()) };
        let made = from_first(comm, agree(comm, made.map_err(|e| refused(&path, e)))?);
        self.files.retain(|file| file.first < number);
        self.files.push(made);
        Ok(())
    }

    /// Writes the index aside and renames it.
    fn write_index(
        &self,
        arrays: &[FieldArray],
        dimension: usize,
        info: &RunInfo,
    ) -> Result<(), OutputError> {
        let (aside, path) = (self.folder.join(".fields.vtkhdf"), self.folder.join(FIELDS_FILE));
        let _ = fs::remove_file(&aside);
        let write = || -> hdf5::Result<()> {
            let file = File::create(&aside)?;
            self.write_root(&file.create_group("VTKHDF")?, arrays, dimension, info)?;
            file.close()
        };
        write().map_err(|e| refused(&path, e))?;
        fs::rename(&aside, &path).map_err(OutputError::io("put the fields in place", &path))
    }

    fn write_root(
        &self,
        root: &Group,
        arrays: &[FieldArray],
        dimension: usize,
        info: &RunInfo,
    ) -> hdf5::Result<()> {
        let kind = FixedAscii::<8>::from_ascii("PolyData").map_err(|e| e.to_string())?;
        root.new_attr::<FixedAscii<8>>().create("Type")?.write_scalar(&kind)?;
        root.new_attr_builder().with_data(&[2_i64, 0]).create("Version")?;
        text_attribute(root, "title", info.title)?;
        text_attribute(root, "scene", &info.scene.to_string())?;
        let files = serde_json::to_string(&self.files).map_err(|e| e.to_string())?;
        text_attribute(root, "data_files", &files)?;
        // texts in FieldData make VTK 9.7 fail on a file with time steps
        for (name, values) in [("materials", info.materials), ("bodies", info.bodies)] {
            text_attribute(root, name, &serde_json::Value::from(values).to_string())?;
        }
        let counts: Vec<i64> = self.frames.iter().map(|f| f.particles as i64).collect();
        let starts: Vec<i64> = (0..counts.len()).map(|k| (k * self.rows) as i64).collect();
        vector(root, "NumberOfPoints", &counts)?;
        let points = self.view::<f64>(root, POINTS, POINTS, 3, 0..3)?;
        text_attribute(&points, "units", "m")?;
        self.write_topology(root, &counts)?;
        let data = root.create_group("PointData")?;
        let steps = root.create_group("Steps")?;
        let offsets = steps.create_group("PointDataOffsets")?;
        for array in arrays {
            let (name, width) = (&array.name[..], array.width());
            let view = match array.kind {
                Kind::Number => self.view::<f64>(&data, name, name, width, 0..width)?,
                Kind::Id => self.view::<i64>(&data, name, name, 1, 0..1)?,
                Kind::Material | Kind::Body => self.view::<i32>(&data, name, name, 1, 0..1)?,
            };
            text_attribute(&view, "units", &array.unit)?;
            vector(&offsets, name, &starts)?;
        }
        if info.axisymmetric && dimension == 2 {
            for (axis, name) in ["r", "z"].into_iter().enumerate() {
                let view = self.view::<f64>(&data, name, POINTS, 3, axis..axis + 1)?;
                text_attribute(&view, "units", "m")?;
                vector(&offsets, name, &starts)?;
            }
        }
        steps.new_attr::<i64>().create("NSteps")?.write_scalar(&(counts.len() as i64))?;
        let times: Vec<f64> = self.frames.iter().map(|f| f.time).collect();
        let values = vector(&steps, "Values", &times)?;
        text_attribute(&values, "units", "s")?;
        vector(&steps, "PartOffsets", &(0..counts.len() as i64).collect::<Vec<_>>())?;
        vector(&steps, "NumberOfParts", &vec![1_i64; counts.len()])?;
        vector(&steps, "PointOffsets", &starts)?;
        for name in ["CellOffsets", "ConnectivityIdOffsets"] {
            // one column per kind of cell; the vertices of all frames begin at the same place
            let zeros = steps.new_dataset::<i64>().shape((counts.len(), 4));
            let zeros = zeros.obj_track_times(false).create(name)?;
            zeros.write_raw(&vec![0_i64; 4 * counts.len()])?;
        }
        Ok(())
    }

    /// One vertex per point, and no other cells.
    fn write_topology(&self, root: &Group, counts: &[i64]) -> hdf5::Result<()> {
        let none = vec![0_i64; counts.len()];
        for kind in ["Vertices", "Lines", "Polygons", "Strips"] {
            let group = root.create_group(kind)?;
            let of_vertices = kind == "Vertices";
            let counts = if of_vertices { counts } else { &none };
            vector(&group, "NumberOfCells", counts)?;
            vector(&group, "NumberOfConnectivityIds", counts)?;
            if !of_vertices {
                vector(&group, "Offsets", &[0_i64])?;
                vector::<i64>(&group, "Connectivity", &[])?;
                continue;
            }
            let path = format!("{FIELDS_FOLDER}/{VERTICES}");
            for (name, count) in [("Offsets", self.rows + 1), ("Connectivity", self.rows)] {
                let view = group.new_dataset::<i64>().shape(count).obj_track_times(false);
                view.virtual_map(&path, "numbers", self.rows + 1, 0..count, count, 0..count)
                    .create(name)?;
            }
        }
        Ok(())
    }

    /// A dataset that shows the columns `columns` of an array of `width` columns in the data files.
    fn view<T: H5Type>(
        &self,
        group: &Group,
        name: &str,
        source: &str,
        width: usize,
        columns: std::ops::Range<usize>,
    ) -> hdf5::Result<Dataset> {
        let rows = self.frames.len() * self.rows;
        let shown = columns.len();
        let mut view = match shown {
            1 => group.new_dataset::<T>().shape(rows),
            _ => group.new_dataset::<T>().shape((rows, shown)),
        };
        view = view.obj_track_times(false);
        for (k, file) in self.files.iter().enumerate() {
            let end = self.files.get(k + 1).map_or(self.frames.len(), |next| next.first);
            let end = end.min(self.frames.len());
            let (first, used, room) =
                (file.first * self.rows, (end - file.first) * self.rows, file.room * self.rows);
            let path = format!("{FIELDS_FOLDER}/{}", file.name);
            let shows = first..first + used;
            view = match (width, shown) {
                (1, _) => view.virtual_map(path, source, room, 0..used, rows, shows),
                (_, 1) => view.virtual_map(
                    path,
                    source,
                    (room, width),
                    (0..used, columns.clone()),
                    rows,
                    shows,
                ),
                _ => view.virtual_map(
                    path,
                    source,
                    (room, width),
                    (0..used, columns.clone()),
                    (rows, shown),
                    (shows, 0..shown),
                ),
            };
        }
        view.create(name)
    }
}

/// Writes the numbers from 0 that serve as offsets and as points of the vertices of each frame.
fn write_vertices(path: &Path, rows: usize) -> hdf5::Result<()> {
    let _ = fs::remove_file(path);
    let file = File::create(path)?;
    vector(&file, "numbers", &(0..=rows as i64).collect::<Vec<i64>>())?;
    file.close()
}

fn refused(path: &Path, error: hdf5::Error) -> OutputError {
    OutputError::Hdf5 { path: path.into(), message: error.to_string().replace('\n', "; ") }
}

/// Coordinates of every particle, padded with zeros to three.
fn points(table: &ParticleTable) -> impl Iterator<Item = f64> {
    let axes = &table.columns[..table.dimension];
    (0..table.len())
        .flat_map(move |row| (0..3).map(move |axis| axes.get(axis).map_or(0.0, |c| c.values[row])))
}
