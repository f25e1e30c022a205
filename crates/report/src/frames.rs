//! Frames of a result: all particles at some times, from its VTKHDF files.

use std::path::{Path, PathBuf};

use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File, Group};

use crate::error::ReportError;

/// Files with frames in a folder of results; the first that exists is read.
const FILES: [&str; 2] = ["fields.vtkhdf", "results.hdf5"];

/// Arrays that are no quantities.
const INDICES: [&str; 5] = ["x", "y", "particle_id", "material", "body"];

/// A quantity of the particles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name, such as `pressure` or `stress_xx`.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Array in the file.
    array: String,
    /// Component of a vector or tensor; `None`: a scalar.
    component: Option<usize>,
}

/// All particles at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Time [s].
    pub time: f64,
    /// Positions [m]; y is 0 on a line.
    pub points: Vec<[f64; 2]>,
    /// Number of the body of each particle.
    pub body: Vec<u32>,
    /// Whether each particle has failed.
    pub failed: Vec<bool>,
    /// Values of each column, in SI units.
    pub values: Vec<Vec<f64>>,
}

/// A file of frames.
#[derive(Debug)]
pub struct FrameFile {
    path: PathBuf,
    root: Group,
    /// Times of the frames [s].
    pub times: Vec<f64>,
    /// Quantities of the particles.
    pub columns: Vec<Column>,
    counts: Vec<usize>,
    starts: Vec<usize>,
}

impl FrameFile {
    /// Opens the frames in a folder of results; `None` if it has none.
    ///
    /// # Errors
    ///
    /// If a file exists and cannot be read.
    pub fn open(folder: &Path, dimension: usize) -> Result<Option<FrameFile>, ReportError> {
        let Some(path) = FILES.iter().map(|name| folder.join(name)).find(|path| path.exists())
        else {
            return Ok(None);
        };
        let opened = FrameFile::read_head(&path, dimension).map_err(|e| unreadable(&path, &e))?;
        Ok(Some(opened))
    }

    fn read_head(path: &Path, dimension: usize) -> hdf5::Result<FrameFile> {
        let root = File::open(path)?.group("VTKHDF")?;
        let integers = |name: &str| -> hdf5::Result<Vec<usize>> {
            let values = root.dataset(name)?.read_raw::<i64>()?;
            Ok(values.into_iter().map(|value| value as usize).collect())
        };
        let (all, parts) = (integers("NumberOfPoints")?, integers("Steps/PartOffsets")?);
        let counts = parts.iter().map(|&part| all.get(part).copied().unwrap_or(0)).collect();
        let mut columns = Vec::new();
        for dataset in root.group("PointData")?.datasets()? {
            columns.extend(columns_of(&dataset, dimension)?);
        }
        // pressure first
        columns.sort_by_key(|column| (column.name != "pressure", column.name.clone()));
        Ok(FrameFile {
            path: path.into(),
            times: root.dataset("Steps/Values")?.read_raw()?,
            starts: integers("Steps/PointOffsets")?,
            root,
            columns,
            counts,
        })
    }

    /// Reads frame number `number`.
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn read(&self, number: usize) -> Result<Frame, ReportError> {
        self.read_frame(number).map_err(|e| unreadable(&self.path, &e))
    }

    fn read_frame(&self, number: usize) -> hdf5::Result<Frame> {
        let (start, count) = (self.starts[number], self.counts[number]);
        let points = self.rows("Points", start, count)?;
        let offset = |array: &str| -> hdf5::Result<usize> {
            let offsets = self.root.dataset(&format!("Steps/PointDataOffsets/{array}"))?;
            Ok(offsets.read_raw::<i64>()?[number] as usize)
        };
        let scalar = |array: &str| self.rows(&format!("PointData/{array}"), offset(array)?, count);
        let mut values = Vec::new();
        for column in &self.columns {
            let rows = scalar(&column.array)?;
            let width = rows.len() / count.max(1);
            let part = rows.iter().skip(column.component.unwrap_or(0)).step_by(width.max(1));
            values.push(part.copied().collect());
        }
        let failed = |name: &str, least: f64| {
            let column = self.columns.iter().position(|column| column.name == name)?;
            let values: &Vec<f64> = &values[column];
            Some(values.iter().map(|value| *value >= least).collect())
        };
        let failed = failed("failed", 0.5).or_else(|| failed("damage", 1.0));
        Ok(Frame {
            time: self.times[number],
            points: points.chunks(3).map(|point| [point[0], point[1]]).collect(),
            body: scalar("body")?.into_iter().map(|body| body as u32).collect(),
            failed: failed.unwrap_or_else(|| vec![false; count]),
            values,
        })
    }

    /// Rows of a dataset, one after the other.
    fn rows(&self, name: &str, start: usize, count: usize) -> hdf5::Result<Vec<f64>> {
        let (dataset, rows) = (self.root.dataset(name)?, start..start + count);
        match dataset.ndim() {
            1 => Ok(dataset.read_slice_1d::<f64, _>(rows)?.to_vec()),
            _ => Ok(dataset.read_slice_2d::<f64, _>((rows, ..))?.iter().copied().collect()),
        }
    }
}

/// The quantities of an array: a scalar, or the components that the dimension has.
fn columns_of(dataset: &Dataset, dimension: usize) -> hdf5::Result<Vec<Column>> {
    let name = dataset.name().rsplit('/').next().unwrap_or_default().to_owned();
    if INDICES.contains(&name.as_str()) {
        return Ok(Vec::new());
    }
    let unit = dataset.attr("units").and_then(|a| a.read_scalar::<VarLenUnicode>());
    let unit = unit.map_or_else(|_| String::new(), |unit| unit.to_string());
    let width = dataset.shape().get(1).copied().unwrap_or(1);
    let parts: &[(&str, usize)] = match (width, dimension) {
        (1, _) => &[],
        (3, 1) => &[("", 0)],
        (3, _) => &[("_x", 0), ("_y", 1)],
        (_, 1) => &[("_xx", 0)],
        (_, _) => &[("_xx", 0), ("_yy", 1), ("_xy", 3)],
    };
    let column = |end: &str, component| Column {
        name: format!("{name}{end}"),
        unit: unit.clone(),
        array: name.clone(),
        component,
    };
    if parts.is_empty() {
        return Ok(vec![column("", None)]);
    }
    Ok(parts.iter().map(|&(end, part)| column(end, Some(part))).collect())
}

fn unreadable(path: &Path, error: &hdf5::Error) -> ReportError {
    ReportError::Hdf5 { path: path.into(), message: error.to_string().replace('\n', "; ") }
}
