//! From a field to an image: what is shown of the plane, and the colour of each pixel.

use super::canvas::{Image, Rect};
use super::color::Color;
use super::field::{Field, FieldData, Mirror, Tile};
use super::raster::{NOBODY, Placed, Raster};
use super::shades::Shades;
use super::ticks::Ruler;

/// Colour where there is no material: light gray is a value.
const NOTHING: Color = Color::WHITE;
/// Colour of hairlines.
const HAIR: Color = Color(0x18, 0x18, 0x20);
/// Pixels of the image a pixel of the page: as fine as the bitmap before it is averaged down.
const FINE: f64 = 2.0;

/// Part of a plane: lower and upper corner \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub lower: [f64; 2],
    pub upper: [f64; 2],
}

impl Extent {
    /// What a field shows: what it asks for, or else its grid or what its particles take, and the
    /// mirror image of that.
    pub fn of(field: &Field, tiles: &[Tile]) -> Self {
        let grid = match &field.data {
            FieldData::Cells(cells) => Some([cells.lower, cells.upper]),
            FieldData::Particles(_) => None,
        };
        let given = field.extent.or(grid).map(|[lower, upper]| Self { lower, upper });
        let mut extent = given.filter(Self::is_good).unwrap_or_else(|| Self::around(tiles));
        if let Some(Mirror { across, at, .. }) = field.mirror.filter(|m| m.at.is_finite()) {
            let d = across as usize;
            let (lower, upper) = (extent.lower[d], extent.upper[d]);
            extent.lower[d] = lower.min(2.0 * at - upper);
            extent.upper[d] = upper.max(2.0 * at - lower);
        }
        extent
    }

    /// Length in a direction \[m\].
    pub fn length(&self, d: usize) -> f64 {
        self.upper[d] - self.lower[d]
    }

    pub fn contains(&self, at: [f64; 2]) -> bool {
        (0..2).all(|d| (self.lower[d]..=self.upper[d]).contains(&at[d]))
    }

    fn is_good(&self) -> bool {
        (0..2).all(|d| {
            let (low, high) = (self.lower[d], self.upper[d]);
            // Less is lost in rounding.
            high - low > 1e-9 * low.abs().max(high.abs()) && (high - low) < 1e100
        })
    }

    fn around(tiles: &[Tile]) -> Self {
        let (mut lower, mut upper) = ([f64::MAX; 2], [f64::MIN; 2]);
        for Tile { centre, half_edges: [a, b], .. } in tiles.iter().filter(|t| is_drawable(t)) {
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
        // Points, or a line of points.
        let longest = found.length(0).max(found.length(1));
        let far = lower.iter().chain(&upper).fold(0.0f64, |most, v| most.max(v.abs()));
        let room = [0.05 * longest, 0.01 * far, 0.5];
        let room = room.into_iter().find(|room| *room > 1e-6 * far).unwrap_or(0.5);
        Self { lower: lower.map(|v| v - room), upper: upper.map(|v| v + room) }
    }
}

fn is_drawable(tile: &Tile) -> bool {
    let [a, b] = tile.half_edges;
    let places = tile.centre.into_iter().chain(a).chain(b);
    places.chain([tile.value]).all(|v| v.abs() < 1e99)
}

/// Tiles with their mirror images.
fn with_images(tiles: &[Tile], mirror: Option<Mirror>) -> impl Iterator<Item = Tile> {
    let images = mirror.into_iter().flat_map(|m| tiles.iter().map(move |tile| tile.mirrored(&m)));
    tiles.iter().copied().chain(images).filter(is_drawable)
}

/// Values of what is shown.
pub(super) fn values(field: &Field, tiles: &[Tile], extent: &Extent) -> Vec<f64> {
    let shown = with_images(tiles, field.mirror).filter(|tile| extent.contains(tile.centre));
    shown.map(|tile| tile.value).collect()
}

/// The field in `rect`.
pub(super) fn image(
    field: &Field,
    tiles: &[Tile],
    rect: Rect,
    extent: &Extent,
    (colors, shades): (&Ruler, Shades),
) -> Image {
    let [columns, rows] = [rect.width(), rect.height()].map(|v| (v * FINE).round().max(1.0));
    let scale = [columns / extent.length(0), -rows / extent.length(1)];
    let place = |tile: Tile| Placed {
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
    // A table: far more pixels than colours that the eye tells apart.
    let table: Vec<Color> = (0..1024).map(|i| shades.color(f64::from(i) / 1023.0)).collect();
    let shade = |value: f64| match colors.place(value) {
        Some(at) => table[(at.clamp(0.0, 1.0) * 1023.0).round() as usize],
        None => NOTHING,
    };
    let mut pixels: Vec<Color> =
        (0..columns * rows).map(|i| raster.value(i).map_or(NOTHING, shade)).collect();
    if field.outlines {
        outline(&raster, &mut pixels);
    }
    Image { rect, columns, rows, pixels }
}

/// Draws hairlines between bodies, also across a gap of one pixel, and fainter ones at their ends.
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
