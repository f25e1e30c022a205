//! Tables of equations of state in separate files: CSV, or HDF5 with the one-dimensional data sets
//! `density` and `specific_internal_energy` and the two-dimensional `pressure`, one row per
//! density.

use std::path::Path;

use crate::material::Table;

/// Maximum number of nodes of a table, at about a hundred bytes of text each.
const MOST_NODES: usize = 1 << 22;

/// Whether a file name denotes HDF5.
pub(super) fn is_hdf5(file: &Path) -> bool {
    let ends = |known: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(known));
    ["h5", "hdf5", "hdf"].into_iter().any(ends)
}

/// Reads a table from HDF5; the error is the reason.
pub(super) fn read_hdf5(file: &Path) -> Result<Table, String> {
    let open = || -> hdf5::Result<Result<Table, String>> {
        let file = hdf5::File::open(file)?;
        let data = |name: &str| file.dataset(name);
        let line = |name: &str| data(name)?.read_1d::<f64>();
        // check the declared size, which takes memory before any value is read
        for name in ["density", "specific_internal_energy", "pressure"] {
            let shape = data(name)?.shape();
            let values = shape.iter().fold(1, |product: usize, &n| product.saturating_mul(n));
            if values > MOST_NODES {
                return Ok(Err(format!(
                    "{name} has {values} values; allowed: at most {MOST_NODES}"
                )));
            }
        }
        let pressure = data("pressure")?.read_2d::<f64>()?;
        Ok(Ok(Table {
            density: line("density")?.to_vec(),
            energy: line("specific_internal_energy")?.to_vec(),
            pressure: pressure.outer_iter().map(|row| row.to_vec()).collect(),
        }))
    };
    let table = open().map_err(|error| {
        format!(
            "{error}; allowed: data sets density and specific_internal_energy of one dimension, \
             and pressure of two"
        )
    })??;
    let rows = table.pressure.iter().map(Vec::as_slice);
    let odd = rows
        .chain([&table.density[..], &table.energy[..]])
        .flatten()
        .copied()
        .find(|value| !value.is_finite());
    match odd {
        Some(value) => Err(format!("{value} is no number; allowed: finite numbers")),
        None => Ok(table),
    }
}
