//! Errors of drawing a picture.

use std::path::PathBuf;

/// Errors of drawing a picture.
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
    /// The number of values of a field differs from the number of its cells.
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
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The pixels could not be encoded as PNG.
    #[error("cannot encode picture as PNG: {0}")]
    Encode(#[from] png::EncodingError),
    /// The drawing library refused a shape.
    #[error("cannot draw picture: {0}")]
    Draw(String),
}
