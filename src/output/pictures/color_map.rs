//! Colour maps: a quantity over position and time as an image.

use super::canvas::{Image, Rect};
use super::color::Color;
use super::ticks::Ruler;
use super::wave_diagram::Row;

/// Colour where there is no material.
const NOTHING: Color = Color(0xf1, 0xf1, 0xf3);

/// A quantity over position and time.
#[derive(Debug, Clone)]
pub(super) struct ColorMap {
    pub label: String,
    pub unit: String,
    pub rows: Vec<Row>,
}

impl ColorMap {
    /// All values.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().flat_map(|row| row.pressure.iter().copied())
    }

    /// The map in `rect`: between the points of a row straight, between rows the nearest in time.
    pub fn image(&self, rect: Rect, x: &Ruler, t: &Ruler, colors: &Ruler) -> Image {
        // Two pixels of the page a value: fine enough for the eye, and four times as cheap.
        let columns = (rect.width() / 2.0).ceil().max(1.0) as usize;
        let rows = (rect.height() / 2.0).ceil().max(1.0) as usize;
        let mut order: Vec<&Row> = self.rows.iter().filter(|row| row.time.is_finite()).collect();
        order.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut pixels = Vec::with_capacity(columns * rows);
        let mut strip = (usize::MAX, Vec::new());
        for row in 0..rows {
            let time = t.value(1.0 - (row as f64 + 0.5) / rows as f64);
            match nearest(&order, time) {
                Some(index) if index == strip.0 => pixels.extend_from_slice(&strip.1),
                Some(index) => {
                    strip = (index, colors_of(order[index], columns, x, colors));
                    pixels.extend_from_slice(&strip.1);
                }
                None => pixels.resize(pixels.len() + columns, NOTHING),
            }
        }
        Image { rect, columns, rows, pixels }
    }

    /// The colours from the lowest, at the bottom, to the highest.
    pub fn bar(rect: Rect) -> Image {
        // As many columns as pixels, lest viewers blur its sides.
        let columns = rect.width().ceil().max(1.0) as usize;
        let shades = (0..256).rev().map(|level| color(f64::from(level) / 255.0));
        let pixels = shades.flat_map(|shade| std::iter::repeat_n(shade, columns)).collect();
        Image { rect, columns, rows: 256, pixels }
    }
}

/// Index of the row nearest in time; none beyond the first and last by more than half their
/// distance to the next.
fn nearest(rows: &[&Row], time: f64) -> Option<usize> {
    let after = rows.partition_point(|row| row.time < time);
    let distance = |index: usize| rows.get(index).map(|row| (row.time - time).abs());
    let (before, after) = (after.checked_sub(1), (after < rows.len()).then_some(after));
    let spacing = |a: usize, b: usize| (rows[a].time - rows[b].time).abs();
    match (before, after) {
        (Some(a), Some(b)) => Some(if distance(a) <= distance(b) { a } else { b }),
        (Some(last), None) => {
            (last == 0 || time - rows[last].time <= 0.5 * spacing(last, last - 1)).then_some(last)
        }
        (None, Some(first)) => {
            (rows.len() == 1 || rows[0].time - time <= 0.5 * spacing(0, 1)).then_some(first)
        }
        (None, None) => None,
    }
}

/// A row's colours in `columns` even steps of the x axis.
fn colors_of(row: &Row, columns: usize, x: &Ruler, colors: &Ruler) -> Vec<Color> {
    let mut points: Vec<(f64, f64)> = std::iter::zip(&row.x, &row.pressure)
        .filter(|(x, p)| x.is_finite() && p.is_finite())
        .map(|(&x, &p)| (x, p))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut gaps: Vec<f64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let middle = gaps.len() / 2;
    let usual =
        if gaps.is_empty() { 0.0 } else { *gaps.select_nth_unstable_by(middle, f64::total_cmp).1 };
    let shade = |p: f64| colors.place(p).map_or(NOTHING, color);
    let mut next = 0;
    let value = |column: usize| x.value((column as f64 + 0.5) / columns as f64);
    let pixel = (x.value(1.0) - x.value(0.0)) / columns as f64;
    (0..columns)
        .map(|column| {
            let x = value(column);
            while next < points.len() && points[next].0 < x {
                next += 1;
            }
            let before = next.checked_sub(1).and_then(|i| points.get(i));
            match (before, points.get(next)) {
                // Further apart than this there is a gap between bodies.
                (Some(a), Some(b)) if b.0 - a.0 <= (6.0 * usual).max(pixel) => {
                    let share = if b.0 > a.0 { (x - a.0) / (b.0 - a.0) } else { 0.0 };
                    shade(a.1 + share * (b.1 - a.1))
                }
                (Some(a), _) if x - a.0 <= usual.max(pixel) => shade(a.1),
                (_, Some(b)) if b.0 - x <= usual.max(pixel) => shade(b.1),
                _ => NOTHING,
            }
        })
        .collect()
}

/// The colour map "viridis" (van der Walt and Smith 2015, CC0), even to the eye: every 1/16.
const VIRIDIS: [Color; 17] = [
    Color(68, 1, 84),
    Color(72, 24, 106),
    Color(71, 45, 123),
    Color(66, 64, 134),
    Color(59, 82, 139),
    Color(51, 99, 141),
    Color(44, 114, 142),
    Color(38, 130, 142),
    Color(33, 145, 140),
    Color(31, 160, 136),
    Color(40, 174, 128),
    Color(63, 188, 115),
    Color(94, 201, 98),
    Color(132, 212, 75),
    Color(173, 220, 48),
    Color(216, 226, 25),
    Color(253, 231, 37),
];

/// The lowest colour.
pub(super) const DARKEST: Color = VIRIDIS[0];

/// The colour of a fraction from 0 to 1.
fn color(fraction: f64) -> Color {
    let place = fraction.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    VIRIDIS[below].mix(VIRIDIS[below + 1], place - below as f64)
}

#[cfg(test)]
mod tests {
    use super::super::figure::Axis;
    use super::*;

    #[test]
    fn gaps_between_bodies_stay_empty() {
        let axis = |label| Axis::linear(label, "").tight();
        let x = Ruler::new(&axis("x"), [0.0, 10.0].into_iter(), 5);
        let colors = Ruler::new(&axis("p"), [0.0, 1.0].into_iter(), 5);
        let positions = vec![0.0, 0.5, 1.0, 1.5, 2.0, 8.0, 8.5, 9.0, 9.5, 10.0];
        let row = Row { time: 0.0, x: positions, pressure: vec![1.0; 10] };
        let shades = colors_of(&row, 100, &x, &colors);
        assert_eq!(shades[5], color(1.0));
        assert_eq!(shades[50], NOTHING);
        assert_eq!(shades[95], color(1.0));
    }

    #[test]
    fn map_goes_from_dark_to_bright() {
        let light =
            |c: Color| 0.21 * f64::from(c.0) + 0.72 * f64::from(c.1) + 0.07 * f64::from(c.2);
        let shades: Vec<f64> = (0..=64).map(|i| light(color(f64::from(i) / 64.0))).collect();
        assert!(shades.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
