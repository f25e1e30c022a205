//! Image of a field: the shown part of the plane and the colour of each pixel.

use super::canvas::{CanvasImage, Rect};
use super::color::Color;
use super::field::{Field, FieldData, FieldTile, SymmetryPlane};
use super::raster::{NOBODY, Placed, Raster};
use super::shades::Shades;
use super::ticks::Ruler;

/// Background colour: no material. White, because light gray stands for a value.
const NOTHING: Color = Color::WHITE;
/// Colour of outlines.
const HAIR: Color = Color(0x18, 0x18, 0x20);
/// Image pixels per page pixel: the resolution of the bitmap before it is averaged down.
const FINE: f64 = 2.0;

/// A part of the plane: lower and upper corner \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub lower: [f64; 2],
    pub upper: [f64; 2],
}

impl Extent {
    /// The shown part of a field: its `extent`, else its grid, else the bounding box of its
    /// particles; extended by the mirror image.
    pub fn of(field: &Field, tiles: &[FieldTile]) -> Self {
        let grid = match &field.data {
            FieldData::Cells(cells) => Some([cells.lower, cells.upper]),
            FieldData::Particles(_) => None,
        };
        let given = field.extent.or(grid).map(|[lower, upper]| Self { lower, upper });
        let mut extent = given.filter(Self::is_good).unwrap_or_else(|| Self::around(tiles));
        if let Some(SymmetryPlane { across, at, .. }) = field.mirror.filter(|m| m.at.is_finite()) {
            let d = across as usize;
            let (lower, upper) = (extent.lower[d], extent.upper[d]);
            extent.lower[d] = lower.min(2.0 * at - upper);
            extent.upper[d] = upper.max(2.0 * at - lower);
        }
        extent
    }

    /// Length in direction `d` \[m\].
    pub fn length(&self, d: usize) -> f64 {
        self.upper[d] - self.lower[d]
    }

    pub fn contains(&self, at: [f64; 2]) -> bool {
        (0..2).all(|d| (self.lower[d]..=self.upper[d]).contains(&at[d]))
    }

    fn is_good(&self) -> bool {
        (0..2).all(|d| {
            let (low, high) = (self.lower[d], self.upper[d]);
            // A smaller extent would be lost in rounding.
            high - low > 1e-9 * low.abs().max(high.abs()) && (high - low) < 1e100
        })
    }

    fn around(tiles: &[FieldTile]) -> Self {
        let (mut lower, mut upper) = ([f64::MAX; 2], [f64::MIN; 2]);
        for FieldTile { centre, half_edges: [a, b], .. } in tiles.iter().filter(|t| is_drawable(t))
        {
            for d in 0..2 {
                let reach = a[d].abs() + b[d].abs();
                lower[d] = lower[d].min(centre[d] - reach);
                upper[d] = upper[d].max(centre[d] + reach);
            }
        }
        let found = Self { lower, upper };
        if found.is_good() {
            return found;
        }
        if lower[0] > upper[0] {
            return Self { lower: [0.0; 2], upper: [1.0; 2] };
        }
        // All tiles are points, or lie on one line.
        let longest = found.length(0).max(found.length(1));
        let far = lower.iter().chain(&upper).fold(0.0f64, |most, v| most.max(v.abs()));
        let room = [0.05 * longest, 0.01 * far, 0.5];
        let room = room.into_iter().find(|room| *room > 1e-6 * far).unwrap_or(0.5);
        Self { lower: lower.map(|v| v - room), upper: upper.map(|v| v + room) }
    }
}

fn is_drawable(tile: &FieldTile) -> bool {
    let [a, b] = tile.half_edges;
    let places = tile.centre.into_iter().chain(a).chain(b);
    places.chain([tile.value]).all(|v| v.abs() < 1e99)
}

/// Tiles with their mirror images.
fn with_images(
    tiles: &[FieldTile],
    mirror: Option<SymmetryPlane>,
) -> impl Iterator<Item = FieldTile> {
    let images = mirror.into_iter().flat_map(|m| tiles.iter().map(move |tile| tile.mirrored(&m)));
    tiles.iter().copied().chain(images).filter(is_drawable)
}

/// Values of all shown tiles.
pub(super) fn values(field: &Field, tiles: &[FieldTile], extent: &Extent) -> Vec<f64> {
    let shown = with_images(tiles, field.mirror).filter(|tile| extent.contains(tile.centre));
    shown.map(|tile| tile.value).collect()
}

/// Image of the field in `rect`.
pub(super) fn image(
    field: &Field,
    tiles: &[FieldTile],
    rect: Rect,
    extent: &Extent,
    (colors, shades): (&Ruler, Shades),
) -> CanvasImage {
    let [columns, rows] = [rect.width(), rect.height()].map(|v| (v * FINE).round().max(1.0));
    let scale = [columns / extent.length(0), -rows / extent.length(1)];
    let place = |tile: FieldTile| Placed {
        centre: [
            (tile.centre[0] - extent.lower[0]) * scale[0],
            (tile.centre[1] - extent.upper[1]) * scale[1],
        ],
        half_edges: tile.half_edges.map(|edge| [edge[0] * scale[0], edge[1] * scale[1]]),
        value: tile.value,
        body: tile.body,
    };
    let (columns, rows) = (columns as usize, rows as usize);
    let raster = Raster::of(columns, rows, || with_images(tiles, field.mirror).map(place));
    // A table of 1024 colours is enough: the eye cannot distinguish more.
    let table: Vec<Color> = (0..1024).map(|i| shades.color(f64::from(i) / 1023.0)).collect();
    let shade = |value: f64| match colors.place(value) {
        Some(at) => table[(at.clamp(0.0, 1.0) * 1023.0).round() as usize],
        None => NOTHING,
    };
    let fill = |i: usize| match &field.fills {
        Some(fills) => fills.get(raster.body(i) as usize).copied().unwrap_or(NOTHING),
        None => raster.value(i).map_or(NOTHING, shade),
    };
    let mut pixels: Vec<Color> = (0..columns * rows).map(fill).collect();
    if field.outlines {
        outline(&raster, &mut pixels);
    }
    CanvasImage { rect, columns, rows, pixels }
}

/// Draws thin lines between bodies, also across a gap of one pixel, and fainter ones at free edges.
fn outline(raster: &Raster, pixels: &mut [Color]) {
    let mut strength = vec![0.0f64; pixels.len()];
    let mut compare = |a: usize, between: Option<usize>, b: usize| {
        let bodies = [a, b].map(|index| raster.body(index));
        if bodies[0] == bodies[1] {
            return;
        }
        let touching = bodies.iter().all(|&body| body != NOBODY);
        if let Some(gap) = between {
            if touching && raster.body(gap) == NOBODY {
                [a, gap, b].iter().for_each(|&index| strength[index] = 0.85);
            }
        } else if touching {
            [a, b].iter().for_each(|&index| strength[index] = 0.85);
        } else {
            let inside = if bodies[0] == NOBODY { b } else { a };
            strength[inside] = strength[inside].max(0.5);
        }
    };
    for row in 0..raster.rows {
        for column in 0..raster.columns {
            let here = row * raster.columns + column;
            for (room, step) in [(raster.columns - column, 1), (raster.rows - row, raster.columns)]
            {
                if room > 1 {
                    compare(here, None, here + step);
                }
                if room > 2 {
                    compare(here, Some(here + step), here + 2 * step);
                }
            }
        }
    }
    for (pixel, share) in pixels.iter_mut().zip(strength).filter(|(_, share)| *share > 0.0) {
        *pixel = pixel.mix(HAIR, share);
    }
}
