//! Checks of the domain: a whole number of cells, and no more patches than cells.

use super::super::errors::SceneFault;
use super::common::{MOST, check_box, check_length};
use crate::scene::{CellSize, Domain, Geometry};

/// Allowed deviation of the domain from a whole number of cells [cells].
const WHOLE: f64 = 1e-6;

/// Relative deviation up to which the given cell size is used, rather than the domain's edge over
/// its number of cells [-].
const ROUNDING: f64 = 1e-12;

/// Grid of a domain.
pub(super) struct Grid {
    /// Edges of a cell, one per direction [m].
    pub cell_size: Vec<f64>,
    /// Number of cells in each direction.
    pub cells: Vec<usize>,
}

impl Grid {
    /// A single cell, which stands in where the cells are not known.
    pub(super) fn of_whole_domain(domain: &Domain) -> Self {
        let lengths = domain.lower.iter().zip(&domain.upper).map(|(lower, upper)| upper - lower);
        Grid { cell_size: lengths.collect(), cells: vec![1; domain.lower.len()] }
    }
}

/// Checks the corners of a domain; returns its dimension.
pub(super) fn check_corners(domain: &Domain) -> Result<usize, SceneFault> {
    let dimension = domain.lower.len();
    check_length("domain.upper", &domain.upper, dimension)?;
    if dimension > 2 {
        let reason = "more than two dimensions; allowed: one number or two";
        return Err(SceneFault::new("domain.lower", &domain.lower, reason));
    }
    check_box("domain", &domain.lower, &domain.upper)?;
    if domain.geometry == Geometry::Axisymmetric {
        if dimension != 2 {
            let reason = "needs a radius and an axis; allowed: \"plane_strain\", or two dimensions";
            return Err(SceneFault::new("domain.geometry", domain.geometry, reason));
        }
        if domain.lower[0] < 0.0 {
            let reason = "crosses the axis at radius 0, which domain.geometry = \"axisymmetric\" \
                          has along x; allowed: domain.lower[0] at least 0";
            return Err(SceneFault::new("domain.lower", &domain.lower, reason));
        }
    }
    Ok(dimension)
}

/// Checks the cells of a domain with valid corners.
pub(super) fn check(domain: &Domain, dimension: usize) -> Result<Grid, SceneFault> {
    let asked = match &domain.cell_size {
        CellSize::Uniform(size) => vec![*size; dimension],
        CellSize::PerDirection(sizes) => {
            check_length("domain.cell_size", sizes, dimension)?;
            sizes.clone()
        }
    };
    let mut grid = Grid { cell_size: Vec::new(), cells: Vec::new() };
    for (d, &size) in asked.iter().enumerate() {
        let (lower, upper) = (domain.lower[d], domain.upper[d]);
        let cells = whole_cells(domain, lower, upper, size)?;
        grid.cells.push(cells as usize);
        let exact = (upper - lower) / cells;
        let same = (size - exact).abs() <= ROUNDING * exact;
        grid.cell_size.push(if same { size } else { exact });
    }
    let total: f64 = grid.cells.iter().map(|&n| n as f64).product();
    if total > MOST {
        return Err(too_many(domain, total));
    }
    Ok(grid)
}

/// Checks the patches of a domain with this number of cells in each direction.
pub(super) fn check_patches(domain: &Domain, cells: &[usize]) -> Result<(), SceneFault> {
    let Some(patches) = &domain.patches else { return Ok(()) };
    check_length("domain.patches", patches, cells.len())?;
    for (&count, &cells) in patches.iter().zip(cells) {
        if count > cells {
            let reason = format!("more patches than cells; allowed: 1 to {cells}");
            return Err(SceneFault::new("domain.patches", patches, reason));
        }
    }
    Ok(())
}

fn whole_cells(domain: &Domain, lower: f64, upper: f64, size: f64) -> Result<f64, SceneFault> {
    let length = upper - lower;
    let cells = length / size;
    if cells.is_nan() || cells > MOST {
        return Err(too_many(domain, cells));
    }
    let whole = cells.round().max(1.0);
    if (cells - whole).abs() > WHOLE.max(4.0 * f64::EPSILON * whole) {
        let reason = format!(
            "divides the domain into {} cells; allowed: a whole number of cells, the nearest \
             is {} for {whole} cells",
            tidy(cells),
            tidy(length / whole)
        );
        return Err(SceneFault::new("domain.cell_size", &domain.cell_size, reason));
    }
    // positions must resolve a millionth of a cell
    let least = lower.abs().max(upper.abs()) * f64::EPSILON / WHOLE;
    if size < least {
        let reason = format!(
            "too small for doubles at coordinates up to {}; allowed: at least {least:e}",
            lower.abs().max(upper.abs())
        );
        return Err(SceneFault::new("domain.cell_size", &domain.cell_size, reason));
    }
    Ok(whole)
}

/// A number rounded to 15 digits for messages, which hides rounding errors.
fn tidy(number: f64) -> f64 {
    format!("{number:.14e}").parse().unwrap_or(number)
}

fn too_many(domain: &Domain, cells: f64) -> SceneFault {
    let reason = format!(
        "divides the domain into {cells:e} cells; allowed: at most {MOST:e}, and what the \
         machine's memory holds"
    );
    SceneFault::new("domain.cell_size", &domain.cell_size, reason)
}
