//! A value over two coordinates, drawn as coloured tiles.

use super::axis::Axis;
use super::color::Color;
use super::color_map::{ColorMap, DiagramRow};
use super::figure::{Figure, Panel};
use super::series::{Points, Series, Style};

/// A table of values over two coordinates, one tile per value.
#[derive(Debug, Clone)]
pub struct TileMap {
    /// Title of the picture.
    pub title: String,
    /// The x axis.
    pub x: Axis,
    /// The y axis.
    pub y: Axis,
    /// Coordinates of the tile centres along x and y, ascending, in the units of the axes.
    pub places: [Vec<f64>; 2],
    /// Values in the unit of the colour scale, one row per y coordinate; `None` leaves a tile
    /// empty.
    pub values: Vec<Vec<Option<f64>>>,
    /// Name of the quantity.
    pub label: String,
    /// Unit of the values.
    pub unit: String,
    /// Marked points: text, x and y in the units of the axes.
    pub marks: Vec<(String, f64, f64)>,
}

/// Points along x per row of tiles.
const POINTS: usize = 1200;

impl TileMap {
    /// The figure.
    pub fn figure(&self) -> Figure {
        let [xs, ys] = &self.places;
        let (x_ends, y_ends) = (edges(xs), edges(ys));
        let mut rows = Vec::new();
        // The colour map draws the nearest row: two rows at the edges of a tile fill it.
        for (values, ends) in self.values.iter().zip(y_ends.windows(2)) {
            let thin = 1e-6 * (ends[1] - ends[0]);
            for time in [ends[0] + thin, ends[1] - thin] {
                rows.push(row(time, values, &x_ends));
            }
        }
        let mut panel = Panel::new(ranged(self.y.clone(), &y_ends));
        // every tile is a result: the scale covers all of them
        let values = || self.values.iter().flatten().flatten().filter(|v| v.is_finite());
        let low = values().copied().fold(f64::INFINITY, f64::min);
        let limits = Some((low, values().copied().fold(f64::NEG_INFINITY, f64::max)));
        let (label, unit) = (self.label.clone(), self.unit.clone());
        panel.map = Some(ColorMap { label, unit, rows, limits });
        let looks = [Color::WHITE, Color(0xff, 0x6e, 0x6e), Color(0xff, 0xc8, 0x5a)];
        for ((text, x, y), color) in self.marks.iter().zip(looks.iter().cycle()) {
            let look = Style { mark: Some(10.0), outlined: true, ..Style::marks(*color) };
            panel.series.push(Series::new(text, Points::new([*x], [*y]), look));
        }
        Figure::new(&self.title, ranged(self.x.clone(), &x_ends)).panel(panel)
    }
}

fn ranged(axis: Axis, ends: &[f64]) -> Axis {
    match (ends.first(), ends.last()) {
        (Some(&low), Some(&high)) if low < high => axis.range(low, high),
        _ => axis,
    }
}

/// Edges of tiles: halfway between the ascending `places`.
fn edges(places: &[f64]) -> Vec<f64> {
    let mut edges: Vec<f64> = places.windows(2).map(|p| 0.5 * (p[0] + p[1])).collect();
    if let (Some(&first), Some(&last)) = (places.first(), places.last()) {
        let (low, high) = match (edges.first(), edges.last()) {
            (Some(a), Some(b)) => (2.0 * first - a, 2.0 * last - b),
            _ => (first - 0.5, last + 0.5),
        };
        edges.insert(0, low);
        edges.push(high);
    }
    edges
}

/// Evenly spaced points across a row of tiles; an empty tile has the value NaN.
fn row(time: f64, values: &[Option<f64>], edges: &[f64]) -> DiagramRow {
    let (low, high) = (edges[0], edges[edges.len() - 1]);
    let at = |k: usize| low + (high - low) * (k as f64 + 0.5) / POINTS as f64;
    let x: Vec<f64> = (0..POINTS).map(at).collect();
    let tile = |x: f64| edges.partition_point(|e| *e <= x).clamp(1, values.len()) - 1;
    let value = |&x: &f64| values[tile(x)].unwrap_or(f64::NAN);
    let pressure = x.iter().map(value).collect();
    DiagramRow { time, x, values: pressure }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_meet_halfway() {
        assert_eq!(edges(&[0.0, 1.0, 3.0]), [-0.5, 0.5, 2.0, 4.0]);
        assert_eq!(edges(&[2.0]), [1.5, 2.5]);
        let row = row(0.0, &[Some(1.0), None, Some(3.0)], &[0.0, 1.0, 2.0, 4.0]);
        let at = |x: f64| row.values[(x / 4.0 * POINTS as f64) as usize];
        assert_eq!((at(0.5), at(3.9)), (1.0, 3.0));
        assert!(at(1.5).is_nan());
    }
}
