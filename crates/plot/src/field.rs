//! A quantity over a plane at one time, drawn as colour.

use std::borrow::Cow;

use super::color::Color;
use super::error::PictureError;
use super::limits::Shading;
use super::series::Series;

/// A quantity over x and y, drawn with equal scales in both directions. A plane that would be too
/// thin to see is stretched, and the picture states the factor.
///
/// The last fields have defaults in [`Field::new`]:
/// `Field { outlines: true, ..Field::new("Title", time, quantity, data) }`.
#[derive(Debug, Clone)]
pub struct Field {
    /// Title of the picture; the time is appended.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// The quantity and its colours.
    pub quantity: FieldQuantity,
    /// Values and their positions.
    pub data: FieldData,
    /// Lower and upper corner of the shown part \[m\]; by default the grid, or the bounding box of
    /// the particles.
    pub extent: Option<[[f64; 2]; 2]>,
    /// Names of the two directions; by default "x" and "y".
    pub axes: [String; 2],
    /// Symmetry plane; if given, the mirrored half is shown too.
    pub mirror: Option<SymmetryPlane>,
    /// Whether to draw a thin line where bodies touch and a fainter one at their free edges.
    pub outlines: bool,
    /// Colour of each body, in place of the colours of the values: the picture then has no colour bar.
    pub fills: Option<Vec<Color>>,
    /// Curves over the field, both coordinates \[m\].
    pub overlays: Vec<Series>,
    /// Short texts under the title.
    pub notes: Vec<String>,
}

/// A quantity and its colours.
#[derive(Debug, Clone)]
pub struct FieldQuantity {
    /// Name: "Pressure".
    pub label: String,
    /// SI unit: "Pa"; the picture may show GPa.
    pub unit: String,
    /// Type of colour scale.
    pub shading: Shading,
    /// Values \[`unit`\] at the ends of the colour scale, for the same scale in a series of
    /// pictures. By default, it covers nearly all values. A diverging scale is symmetric about
    /// zero.
    pub limits: Option<(f64, f64)>,
}

/// Values with their positions. A value that is not finite is not drawn.
#[derive(Debug, Clone)]
pub enum FieldData {
    /// Particles as parallelograms. A pixel that several particles cover shows their mean value.
    Particles(Vec<FieldTile>),
    /// Cells of a uniform grid.
    Cells(Cells),
}

/// A particle: a parallelogram with one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldTile {
    /// Centre \[m\].
    pub centre: [f64; 2],
    /// Vectors r1 and r2 from the centre to the midpoints of two adjacent sides \[m\].
    pub half_edges: [[f64; 2]; 2],
    /// Value, in the unit of the quantity.
    pub value: f64,
    /// Index of the body, for outlines.
    pub body: u32,
}

/// A grid of equal cells; each cell has a mean value or is empty.
#[derive(Debug, Clone)]
pub struct Cells {
    /// Lower corner of the grid \[m\].
    pub lower: [f64; 2],
    /// Upper corner of the grid \[m\].
    pub upper: [f64; 2],
    /// Number of cells along x and along y.
    pub counts: [usize; 2],
    /// Mean values in the unit of the quantity; cell (i, j) has the index i + counts\[0\] j.
    pub values: Vec<Option<f64>>,
}

/// Symmetry plane (axis, in axisymmetry) at the edge of the computed half.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetryPlane {
    /// The direction normal to the plane.
    pub across: Direction,
    /// Coordinate of the plane \[m\].
    pub at: f64,
    /// Whether values change sign across the plane, as the normal velocity does.
    pub changes_sign: bool,
}

/// One of the two directions of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Horizontal.
    X,
    /// Vertical.
    Y,
}

impl FieldQuantity {
    /// A quantity whose colour scale covers nearly all values.
    pub fn new(label: impl Into<String>, unit: impl Into<String>, shading: Shading) -> Self {
        Self { label: label.into(), unit: unit.into(), shading, limits: None }
    }
}

impl Field {
    /// A field that shows the whole extent of its data, without overlays, notes or mirror.
    pub fn new(
        title: impl Into<String>,
        time: f64,
        quantity: FieldQuantity,
        data: FieldData,
    ) -> Self {
        let (title, axes) = (title.into(), ["x".into(), "y".into()]);
        let (overlays, notes) = (Vec::new(), Vec::new());
        let (extent, mirror, outlines, fills) = (None, None, false, None);
        Self { title, time, quantity, data, extent, axes, mirror, outlines, fills, overlays, notes }
    }

    /// Tiles of the computed half: particles, or cells that have a value.
    pub(super) fn tiles(&self, figure: &str) -> Result<Cow<'_, [FieldTile]>, PictureError> {
        match &self.data {
            FieldData::Particles(tiles) => Ok(tiles.into()),
            FieldData::Cells(cells) => {
                let count = cells.counts[0].saturating_mul(cells.counts[1]);
                if count == cells.values.len() {
                    return Ok(cells.tiles().into());
                }
                let (figure, values) = (figure.into(), cells.values.len());
                Err(PictureError::Cells { figure, cells: count, values })
            }
        }
    }
}

impl Cells {
    fn tiles(&self) -> Vec<FieldTile> {
        let half =
            [0, 1].map(|d| 0.5 * (self.upper[d] - self.lower[d]) / self.counts[d].max(1) as f64);
        let place = |d: usize, index: usize| self.lower[d] + (2 * index + 1) as f64 * half[d];
        let filled =
            self.values.iter().enumerate().filter_map(|(index, &value)| Some((index, value?)));
        filled
            .map(|(index, value)| FieldTile {
                centre: [place(0, index % self.counts[0]), place(1, index / self.counts[0])],
                half_edges: [[half[0], 0.0], [0.0, half[1]]],
                value,
                body: 0,
            })
            .collect()
    }
}

impl FieldTile {
    /// Mirror image of the tile.
    pub(super) fn mirrored(&self, mirror: &SymmetryPlane) -> Self {
        let d = mirror.across as usize;
        let mut image = *self;
        image.centre[d] = 2.0 * mirror.at - image.centre[d];
        image.half_edges.iter_mut().for_each(|edge| edge[d] = -edge[d]);
        if mirror.changes_sign {
            image.value = -image.value;
        }
        image
    }
}
