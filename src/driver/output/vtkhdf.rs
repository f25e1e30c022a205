//! `results.hdf5`: the profiles as VTKHDF, for ParaView.
//!
//! The layout is VTKHDF 2.0 (VTK file formats, "VTKHDF File Format"): PolyData with time steps, a
//! vertex for each particle, and the columns of the CSV as point data under the same names, with
//! `particle_id`, `material` and `body` as indices. The arrays span the whole file; each step is
//! one part of them. The contents do not depend on the time or place of writing.

use std::path::Path;

use hdf5::types::{FixedAscii, VarLenUnicode};
use hdf5::{Dataset, File, Group, H5Type, Location};
use serde_json::Value;

use super::error::OutputError;
use crate::simulation::ParticleTable;

/// Name of the file in the folder of results.
pub const RESULTS_FILE: &str = "results.hdf5";

/// Data of the whole run in the file.
#[derive(Clone, Copy, Debug)]
pub struct RunInfo<'a> {
    /// Title of the scene.
    pub title: &'a str,
    /// The scene as run.
    pub scene: &'a Value,
    /// Names of the materials; the column `material` holds indices into them.
    pub materials: &'a [String],
    /// Names of the bodies; the column `body` holds indices into them.
    pub bodies: &'a [String],
    /// Whether x is the radius, and y runs along the axis.
    pub axisymmetric: bool,
}

/// Writes the tables in their order, one time step each.
///
/// Values of a column that a table lacks are NaN.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write_vtkhdf(
    path: &Path,
    tables: &[&ParticleTable],
    info: &RunInfo,
) -> Result<(), OutputError> {
    let write = || -> hdf5::Result<()> {
        let file = File::create(path)?;
        write_root(&file.create_group("VTKHDF")?, tables, info)?;
        file.close()
    };
    write().map_err(|e| OutputError::Hdf5 {
        path: path.into(),
        message: e.to_string().replace('\n', "; "),
    })
}

fn write_root(root: &Group, tables: &[&ParticleTable], info: &RunInfo) -> hdf5::Result<()> {
    let kind = FixedAscii::<8>::from_ascii("PolyData").map_err(|e| e.to_string())?;
    root.new_attr::<FixedAscii<8>>().create("Type")?.write_scalar(&kind)?;
    root.new_attr_builder().with_data(&[2_i64, 0]).create("Version")?;
    text_attribute(root, "title", info.title)?;
    text_attribute(root, "scene", &info.scene.to_string())?;
    text_attribute(root, "materials", &Value::from(info.materials).to_string())?;
    text_attribute(root, "bodies", &Value::from(info.bodies).to_string())?;

    let counts: Vec<i64> = tables.iter().map(|t| t.len() as i64).collect();
    let starts = starts(&counts);
    vector(root, "NumberOfPoints", &counts)?;
    let points: Vec<f64> = tables.iter().flat_map(|table| points(table)).collect();
    let points = matrix(root, "Points", &points, 3)?;
    text_attribute(&points, "units", "m")?;
    write_topology(root, &counts)?;

    let steps = root.create_group("Steps")?;
    steps.new_attr::<i64>().create("NSteps")?.write_scalar(&(tables.len() as i64))?;
    let times: Vec<f64> = tables.iter().map(|t| t.time).collect();
    let values = vector(&steps, "Values", &times)?;
    text_attribute(&values, "units", "s")?;
    let parts: Vec<i64> = (0..tables.len() as i64).collect();
    vector(&steps, "PartOffsets", &parts)?;
    vector(&steps, "NumberOfParts", &vec![1_i64; parts.len()])?;
    vector(&steps, "PointOffsets", &starts)?;
    // one column per kind of cell: vertices, lines, polygons, strips
    let vertices: Vec<i64> = starts.iter().flat_map(|&start| [start, 0, 0, 0]).collect();
    matrix(&steps, "CellOffsets", &vertices, 4)?;
    matrix(&steps, "ConnectivityIdOffsets", &vertices, 4)?;

    let offsets = steps.create_group("PointDataOffsets")?;
    let data = root.create_group("PointData")?;
    for name in write_point_data(&data, tables)? {
        vector(&offsets, &name, &starts)?;
    }
    Ok(())
}

/// Writes one vertex per point, and no other cells.
fn write_topology(root: &Group, counts: &[i64]) -> hdf5::Result<()> {
    let none = vec![0_i64; counts.len()];
    for kind in ["Vertices", "Lines", "Polygons", "Strips"] {
        let group = root.create_group(kind)?;
        let counts = if kind == "Vertices" { counts } else { &none };
        vector(&group, "NumberOfCells", counts)?;
        vector(&group, "NumberOfConnectivityIds", counts)?;
        let offsets: Vec<i64> = counts.iter().flat_map(|&n| 0..=n).collect();
        vector(&group, "Offsets", &offsets)?;
        let connectivity: Vec<i64> = counts.iter().flat_map(|&n| 0..n).collect();
        vector(&group, "Connectivity", &connectivity)?;
    }
    Ok(())
}

/// Writes every column and index of the particles; returns their names.
fn write_point_data(data: &Group, tables: &[&ParticleTable]) -> hdf5::Result<Vec<String>> {
    let mut columns: Vec<(&str, &str)> = Vec::new();
    for column in tables.iter().flat_map(|t| &t.columns) {
        if !columns.iter().any(|(name, _)| *name == column.name) {
            columns.push((&column.name, &column.unit));
        }
    }
    for (name, unit) in &columns {
        let mut values = Vec::with_capacity(tables.iter().map(|t| t.len()).sum());
        for table in tables {
            match table.column(name) {
                Some(column) => values.extend_from_slice(column),
                None => values.resize(values.len() + table.len(), f64::NAN),
            }
        }
        let dataset = vector(data, name, &values)?;
        text_attribute(&dataset, "units", unit)?;
    }
    let ids: Vec<i64> = tables.iter().flat_map(|t| &t.ids).map(|&id| id as i64).collect();
    let material: Vec<i32> = tables.iter().flat_map(|t| &t.material).map(|&i| i as i32).collect();
    let body: Vec<i32> = tables.iter().flat_map(|t| &t.body).map(|&i| i as i32).collect();
    for dataset in [
        vector(data, "particle_id", &ids)?,
        vector(data, "material", &material)?,
        vector(data, "body", &body)?,
    ] {
        text_attribute(&dataset, "units", "-")?;
    }
    let names = columns.iter().map(|(name, _)| *name).chain(["particle_id", "material", "body"]);
    Ok(names.map(str::to_owned).collect())
}

/// Coordinates of every particle, padded with zeros to three.
fn points(table: &ParticleTable) -> impl Iterator<Item = f64> {
    let axes = &table.columns[..table.dimension];
    (0..table.len())
        .flat_map(move |row| (0..3).map(move |axis| axes.get(axis).map_or(0.0, |c| c.values[row])))
}

/// Offset of each step in the arrays of the file.
fn starts(counts: &[i64]) -> Vec<i64> {
    let mut start = 0;
    let next = |n: &i64| {
        start += n;
        start - n
    };
    counts.iter().map(next).collect()
}

/// Writes a dataset of numbers or texts.
pub(super) fn vector<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5::Result<Dataset> {
    let dataset =
        group.new_dataset::<T>().shape(values.len()).obj_track_times(false).create(name)?;
    dataset.write_raw(values)?;
    Ok(dataset)
}

fn matrix<T: H5Type>(
    group: &Group,
    name: &str,
    values: &[T],
    width: usize,
) -> hdf5::Result<Dataset> {
    let shape = (values.len() / width, width);
    let dataset = group.new_dataset::<T>().shape(shape).obj_track_times(false).create(name)?;
    dataset.write_raw(values)?;
    Ok(dataset)
}

/// Writes text of any length. A NUL is replaced, because HDF5 ends text at it.
pub(super) fn text_attribute(location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    let text: VarLenUnicode =
        text.replace('\0', "\u{fffd}").parse().map_err(|_| format!("text of {name}"))?;
    location.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&text)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::simulation::TableColumn;

    fn info(scene: &Value) -> RunInfo<'_> {
        RunInfo { title: "t", scene, materials: &[], bodies: &[], axisymmetric: false }
    }

    fn table(time: f64, rows: usize, extra: bool) -> ParticleTable {
        let column = |name: &str, unit: &str, scale: f64| TableColumn {
            name: name.into(),
            unit: unit.into(),
            values: (0..rows).map(|i| scale * i as f64 + time).collect(),
        };
        let mut columns = vec![column("x", "m", 1e-6), column("pressure", "Pa", 1e9)];
        if extra {
            columns.push(column("temperature", "K", 300.0));
        }
        ParticleTable {
            time,
            dimension: 1,
            ids: (0..rows as u64).rev().collect(),
            material: vec![1; rows],
            materials: vec!["copper".into(), "aluminium".into()],
            body: vec![0; rows],
            columns,
            half_edges: Vec::new(),
        }
    }

    #[test]
    fn every_step_is_found_by_its_offsets() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join(RESULTS_FILE);
        // more than the 64 KiB that an attribute can store inline
        let scene = json!({ "description": "x".repeat(100_000) });
        let materials = ["copper".into(), "aluminium".into()];
        let info = RunInfo { materials: &materials, bodies: &["flyer".into()], ..info(&scene) };
        let info = RunInfo { title: "nul \0", ..info };
        let tables = [table(0.0, 5, false), table(1.0, 3, true), table(2.0, 0, true)];
        write_vtkhdf(&path, &tables.each_ref(), &info).unwrap();
        let root = File::open(&path).unwrap().group("VTKHDF").unwrap();
        let read = |name: &str| root.dataset(name).unwrap().read_raw::<f64>().unwrap();
        let starts = root.dataset("Steps/PointDataOffsets/pressure").unwrap();
        assert_eq!(starts.read_raw::<i64>().unwrap(), [0, 5, 8]);
        assert_eq!(read("PointData/pressure")[5..], tables[1].columns[1].values);
        assert!(read("PointData/temperature")[..5].iter().all(|v| v.is_nan()));
        assert_eq!(read("Points")[15..18], [1.0, 0.0, 0.0]);
        assert_eq!(read("Steps/Values"), [0.0, 1.0, 2.0]);
        let offsets = root.dataset("Vertices/Offsets").unwrap().read_raw::<i64>().unwrap();
        assert_eq!(offsets, [0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 0]);
        let text = |location: &Location, name: &str| {
            location.attr(name).unwrap().read_scalar::<VarLenUnicode>().unwrap().to_string()
        };
        assert_eq!(text(&root, "scene"), scene.to_string());
        assert_eq!(text(&root, "title"), "nul \u{fffd}");
        assert_eq!(text(&root, "materials"), r#"["copper","aluminium"]"#);
        assert_eq!(text(&root.dataset("PointData/pressure").unwrap(), "units"), "Pa");
    }

    #[test]
    fn bytes_do_not_depend_on_the_clock() {
        let home = tempfile::tempdir().unwrap();
        let scene = json!({});
        let info = info(&scene);
        let bytes = |name: &str| {
            let path = home.path().join(name);
            write_vtkhdf(&path, &[&table(0.0, 5, true)], &info).unwrap();
            std::fs::read(path).unwrap()
        };
        let first = bytes("a");
        // HDF5 stores times in whole seconds
        std::thread::sleep(std::time::Duration::from_millis(1100));
        assert!(first == bytes("b"));
    }

    #[test]
    fn a_fault_is_one_line_with_the_path() {
        let scene = json!({});
        let info = info(&scene);
        let error = write_vtkhdf(Path::new("/nowhere/results.hdf5"), &[], &info).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with("/nowhere/results.hdf5: cannot write HDF5: "), "{text}");
        assert!(!text.contains('\n'), "{text}");
    }
}
