//! Pictures: each figure is described once and drawn to PNG and to SVG.
//!
//! The pieces, from data to pixels:
//! - [`Hugoniot`], [`Profile`], [`WaveDiagram`], [`Histories`] hold the data of the document's
//!   figures and turn themselves into a [`Figure`]; other studies describe a [`Figure`] directly.
//! - [`Field`] is a quantity over a plane, painted particle by particle or cell by cell through
//!   `raster` on a page that suits the plane (`field_layout`), in colours after `limits`;
//!   [`LineOut`] is a quantity along a line or a radius.
//! - `layout` turns a figure into shapes on a page, with `ticks` (ends, units, round numbers),
//!   `legend`, `curves` (beyond 5000 points thinned, see `thin`), `annotations` and `bars`.
//! - `paint` draws the shapes through `plotters` into a bitmap and into SVG text.
//!
//! All numbers come in SI; axes choose readable units (mm, us, GPa). Values that are not finite
//! break a line and are otherwise left out, and a figure without data says so: bad data never stop
//! a run. The font is part of the program, so a machine without fonts draws text all the same; SVG
//! text names common fallbacks.
//!
//! This module does not know particles, scenes, materials or MPI.

mod annotations;
mod axes;
mod bars;
mod base64;
mod canvas;
mod color;
mod color_bar;
mod color_map;
mod curves;
mod field;
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
mod shades;
mod stroke;
mod text;
mod thin;
mod ticks;
mod tile_map;
mod wave_diagram;

#[cfg(test)]
mod field_tests;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

pub use bars::{Bar, Bars, Part};
pub use color::Color;
pub use field::{Cells, Direction, Field, FieldData, Mirror, Quantity, Tile};
pub use figure::{Axis, Figure, Label, Panel, Points, Scale, Series, Stroke, Style};
pub use histories::{Histories, History, HistoryPanel};
pub use hugoniot::{Hugoniot, HugoniotCurve, State};
pub use limits::Shading;
pub use line_out::{LineOut, LineOutCurve, Look};
pub use profile::Profile;
pub use tile_map::TileMap;
pub use wave_diagram::{Row, WaveDiagram, WavePath};

/// What can go wrong with a picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// Two columns of one series differ in length.
    #[error("picture '{figure}': series '{series}' has {x} abscissae but {y} ordinates")]
    Lengths {
        /// Title of the figure.
        figure: String,
        /// Name of the series.
        series: String,
        /// Number of abscissae.
        x: usize,
        /// Number of ordinates.
        y: usize,
    },
    /// A field has not one value a cell.
    #[error("picture '{figure}': {cells} cells but {values} values")]
    Cells {
        /// Title of the figure.
        figure: String,
        /// Number of cells.
        cells: usize,
        /// Number of values.
        values: usize,
    },
    /// The picture could not be written.
    #[error("cannot write picture {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The pixels could not be made into PNG.
    #[error("cannot encode picture as PNG: {0}")]
    Encode(#[from] png::EncodingError),
    /// The drawing library refused a shape.
    #[error("cannot draw picture: {0}")]
    Draw(String),
}

/// The two files of one picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Files {
    /// The bitmap.
    pub png: PathBuf,
    /// The vector drawing.
    pub svg: PathBuf,
}

/// Draws `figure` to `stem.png` and `stem.svg`, and returns their paths.
///
/// Only these endings are added: the stem `run/profile_0.5us` becomes `run/profile_0.5us.png`. The
/// folder must exist.
///
/// # Errors
/// When columns differ in length or a file cannot be written. Data without a finite value are no
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
