//! Pictures: each figure is described once and drawn to PNG and to SVG.
//!
//! From data to pixels:
//! - [`HugoniotFigure`], [`ProfileFigure`], [`WaveDiagram`] and [`HistoriesFigure`] hold the data
//!   of the figures of Burghardt (2010) and make a [`Figure`]; other studies describe one directly.
//! - [`Field`] is a quantity over a plane with one value per particle or cell: `raster` paints it,
//!   `field_layout` chooses the page, `limits` the colours. [`LineOut`] is a quantity along a line.
//! - `layout` turns a figure into shapes on a page, with `ticks` (ends, units, round numbers),
//!   `legend`, `curves` (thinned beyond 5000 points, see `thin`), `annotations` and `bars`.
//! - `paint` draws the shapes with `plotters` into a bitmap and into SVG text.
//!
//! All input is in SI units; axes choose readable units (mm, us, GPa). Values that are not finite
//! break a line and are otherwise omitted, and a figure without data says so: bad data never stop a
//! run. The font is embedded, so machines without fonts draw text too; SVG text names common
//! fallbacks.
//!
//! This module does not depend on particles, scenes, materials or MPI.

mod annotations;
mod axes;
mod axis;
mod bars;
mod canvas;
mod color;
mod color_bar;
mod color_map;
mod curves;
mod error;
mod field;
mod field_figure;
mod field_layout;
mod field_map;
mod figure;
mod histories;
mod hugoniot;
mod layout;
mod legend;
mod limits;
mod line_out;
mod occupancy;
mod paint;
mod profile;
mod raster;
mod series;
mod shades;
mod stroke;
mod text;
mod thin;
mod ticks;
mod tile_map;
mod title;
mod wave_diagram;

#[cfg(test)]
mod field_tests;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

pub use axis::{Axis, AxisScale};
pub use bars::{Bar, BarPart, Bars};
pub use color::Color;
pub use color_map::DiagramRow;
pub use error::PictureError;
pub use field::{Cells, Direction, Field, FieldData, FieldQuantity, FieldTile, SymmetryPlane};
pub use figure::{Figure, Label, MaterialBand, Panel};
pub use histories::{HistoriesFigure, HistoryCurve, HistoryPanel};
pub use hugoniot::{HugoniotCurve, HugoniotFigure, HugoniotPoint};
pub use limits::Shading;
pub use line_out::{LineOut, LineOutCurve, LineStyle};
pub use profile::{ProfileFigure, ProfilePart};
pub use series::{Points, Series, Stroke, Style, Symbol};
pub use tile_map::TileMap;
pub use wave_diagram::{WaveDiagram, WavePath};

/// Paths of the two files of one picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// The bitmap.
    pub png: PathBuf,
    /// The vector drawing.
    pub svg: PathBuf,
}

/// Draws `figure` to `stem.png` and `stem.svg`, and returns their paths.
///
/// The extension is appended to the stem: `run/profile_0.5us` becomes `run/profile_0.5us.png`. The
/// folder must exist.
///
/// # Errors
/// If columns differ in length or a file cannot be written. Data without a finite value are not an
/// error.
pub fn draw(figure: &Figure, stem: &Path) -> Result<Files, PictureError> {
    let canvas = layout::lay_out(figure)?;
    let files = Files { png: with_ending(stem, ".png"), svg: with_ending(stem, ".svg") };
    write(&files.png, &paint::to_png(&canvas)?)?;
    write(&files.svg, paint::to_svg(&canvas)?.as_bytes())?;
    Ok(files)
}

fn with_ending(stem: &Path, ending: &str) -> PathBuf {
    let mut path = stem.as_os_str().to_owned();
    path.push(ending);
    path.into()
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), PictureError> {
    std::fs::write(path, bytes).map_err(|source| PictureError::Write { path: path.into(), source })
}
