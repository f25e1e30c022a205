//! A quantity over a plane at one time, as colour.

use std::borrow::Cow;

use super::PictureError;
use super::figure::{Axis, Figure, Panel, Series};
use super::limits::Shading;
use super::profile::readable;

/// A quantity over x and y, drawn with equal scales in both directions. A plane so thin that it
/// would hardly be seen is stretched across, and the picture says so.
///
/// The last fields have defaults in [`Field::new`]:
/// `Field { outlines: true, ..Field::new("Title", time, quantity, data) }`.
#[derive(Debug, Clone)]
pub struct Field {
    /// The line at the top, to which the time is added.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// What the colours mean.
    pub quantity: Quantity,
    /// Values and where they are painted.
    pub data: FieldData,
    /// Lower and upper corner of what is shown \[m\]; by default the grid, or what the particles
    /// take.
    pub extent: Option<[[f64; 2]; 2]>,
    /// Names of the two directions; by default "x" and "y".
    pub axes: [String; 2],
    /// Shows the other half of a symmetric model too.
    pub mirror: Option<Mirror>,
    /// Draws a hairline where bodies touch and a fainter one where they end.
    pub outlines: bool,
    /// Curves over the field, both coordinates in \[m\].
    pub overlays: Vec<Series>,
    /// Short texts under the title.
    pub notes: Vec<String>,
}

/// A quantity and its colours.
#[derive(Debug, Clone)]
pub struct Quantity {
    /// Its name: "Pressure".
    pub label: String,
    /// Its SI unit: "Pa"; the picture may show GPa.
    pub unit: String,
    /// Its colours.
    pub shading: Shading,
    /// Values \[`unit`\] at the ends of the colours, the same for all pictures of a series; by
    /// default ends that hold nearly all values. Diverging colours go as far both ways.
    pub limits: Option<(f64, f64)>,
}

/// Values with their places. Values that are not finite leave their place empty.
#[derive(Debug, Clone)]
pub enum FieldData {
    /// Particles as parallelograms; where several lie on a pixel, the mean of their values.
    Particles(Vec<Tile>),
    /// Cells of an even grid.
    Cells(Cells),
}

/// A particle: a parallelogram of one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    /// Its middle \[m\].
    pub centre: [f64; 2],
    /// Vectors r1 and r2 from its middle to the middles of two adjacent sides \[m\].
    pub half_edges: [[f64; 2]; 2],
    /// The value, in the quantity's unit.
    pub value: f64,
    /// Index of its body, for outlines.
    pub body: u32,
}

/// A grid of equal cells, each with a mean value or empty.
#[derive(Debug, Clone)]
pub struct Cells {
    /// Lower corner of the grid \[m\].
    pub lower: [f64; 2],
    /// Upper corner of the grid \[m\].
    pub upper: [f64; 2],
    /// Number of cells along x and along y.
    pub counts: [usize; 2],
    /// Mean values in the quantity's unit; cell (i, j) stands at i + counts\[0\] j.
    pub values: Vec<Option<f64>>,
}

/// The plane, in axisymmetry the axis, that bounds the half which was computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// The coordinate that changes across it.
    pub across: Direction,
    /// Where it stands \[m\].
    pub at: f64,
    /// Whether values change their sign across it, as the velocity towards it does.
    pub changes_sign: bool,
}

/// One of the two directions of a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// To the right.
    X,
    /// Upwards.
    Y,
}

impl Quantity {
    /// A quantity whose colours end where nearly all values do.
    pub fn new(label: impl Into<String>, unit: impl Into<String>, shading: Shading) -> Self {
        Self { label: label.into(), unit: unit.into(), shading, limits: None }
    }
}

impl Field {
    /// A field alone, as far as its data reach.
    pub fn new(title: impl Into<String>, time: f64, quantity: Quantity, data: FieldData) -> Self {
        let (title, axes) = (title.into(), ["x".into(), "y".into()]);
        let (overlays, notes) = (Vec::new(), Vec::new());
        let (extent, mirror, outlines) = (None, None, false);
        Self { title, time, quantity, data, extent, axes, mirror, outlines, overlays, notes }
    }

    /// The figure, which takes the data; it fills its page and has room for no other panel.
    pub fn figure(mut self) -> Figure {
        let title = format!("{}, t = {}", self.title, readable(self.time));
        let [x, y] = self.axes.each_ref().map(|name| Axis::linear(name, "m"));
        let mut panel = Panel::new(y);
        panel.series = std::mem::take(&mut self.overlays);
        panel.notes = std::mem::take(&mut self.notes);
        panel.field = Some(self);
        Figure::new(title, x).panel(panel)
    }

    /// What is painted on the computed side: particles, or cells that have a value.
    pub(super) fn tiles(&self, figure: &str) -> Result<Cow<'_, [Tile]>, PictureError> {
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
    fn tiles(&self) -> Vec<Tile> {
        let half =
            [0, 1].map(|d| 0.5 * (self.upper[d] - self.lower[d]) / self.counts[d].max(1) as f64);
        let place = |d: usize, index: usize| self.lower[d] + (2 * index + 1) as f64 * half[d];
        let filled =
            self.values.iter().enumerate().filter_map(|(index, &value)| Some((index, value?)));
        filled
            .map(|(index, value)| Tile {
                centre: [place(0, index % self.counts[0]), place(1, index / self.counts[0])],
                half_edges: [[half[0], 0.0], [0.0, half[1]]],
                value,
                body: 0,
            })
            .collect()
    }
}

impl Tile {
    /// Its image across a plane.
    pub(super) fn mirrored(&self, mirror: &Mirror) -> Self {
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
