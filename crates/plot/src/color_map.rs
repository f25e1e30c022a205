//! Colour maps: a quantity over position and time, drawn as an image.

use super::canvas::{CanvasImage, Rect};
use super::color::Color;
use super::limits::{AxisLimits, Shading};
use super::shades::Shades;
use super::ticks::Ruler;

/// Background colour: no material. White, because light gray stands for a value.
const NOTHING: Color = Color::WHITE;

/// A quantity along x at one time.
#[derive(Debug, Clone)]
pub struct DiagramRow {
    /// Time \[s\].
    pub time: f64,
    /// Positions \[m\].
    pub x: Vec<f64>,
    /// Values, in the unit of the diagram.
    pub values: Vec<f64>,
}

/// A quantity over position and time.
#[derive(Debug, Clone)]
pub(super) struct ColorMap {
    pub label: String,
    pub unit: String,
    pub rows: Vec<DiagramRow>,
    /// Ends of the colour scale [`unit`]; by default, it covers nearly all values.
    pub limits: Option<(f64, f64)>,
}

impl ColorMap {
    /// The colour scale: with zero in the middle if there are significant negative values.
    pub fn scale(&self) -> AxisLimits {
        AxisLimits::of(self.values().collect(), Shading::BySign, self.limits)
    }

    /// All values.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        self.rows.iter().flat_map(|row| row.values.iter().copied())
    }

    /// The image of the map in `rect`: linear between the points of a row, nearest row in time.
    pub fn image(
        &self,
        rect: Rect,
        (x, t): (&Ruler, &Ruler),
        (colors, shades): (&Ruler, Shades),
    ) -> CanvasImage {
        // One value per two pixels of the page: fine enough for the eye, and four times cheaper.
        let columns = (rect.width() / 2.0).ceil().max(1.0) as usize;
        let rows = (rect.height() / 2.0).ceil().max(1.0) as usize;
        let mut order: Vec<&DiagramRow> =
            self.rows.iter().filter(|row| row.time.is_finite()).collect();
        order.sort_by(|a, b| a.time.total_cmp(&b.time));
        let mut pixels = Vec::with_capacity(columns * rows);
        let mut strip = (usize::MAX, Vec::new());
        for row in 0..rows {
            let time = t.value(1.0 - (row as f64 + 0.5) / rows as f64);
            match nearest(&order, time) {
                Some(index) if index == strip.0 => pixels.extend_from_slice(&strip.1),
                Some(index) => {
                    strip = (index, colors_of(order[index], columns, x, (colors, shades)));
                    pixels.extend_from_slice(&strip.1);
                }
                None => pixels.resize(pixels.len() + columns, NOTHING),
            }
        }
        CanvasImage { rect, columns, rows, pixels }
    }
}

/// Index of the row nearest in time. `None` if `time` is outside of the rows by more than half of
/// the spacing there.
fn nearest(rows: &[&DiagramRow], time: f64) -> Option<usize> {
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

/// Colours of a row at `columns` even steps of the x axis.
fn colors_of(
    row: &DiagramRow,
    columns: usize,
    x: &Ruler,
    (colors, shades): (&Ruler, Shades),
) -> Vec<Color> {
    let mut points: Vec<(f64, f64)> = std::iter::zip(&row.x, &row.values)
        .filter(|(x, p)| x.is_finite() && p.is_finite())
        .map(|(&x, &p)| (x, p))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut gaps: Vec<f64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let middle = gaps.len() / 2;
    let usual =
        if gaps.is_empty() { 0.0 } else { *gaps.select_nth_unstable_by(middle, f64::total_cmp).1 };
    let shade = |p: f64| colors.place(p).map_or(NOTHING, |place| shades.color(place));
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
                // A larger distance between points is a gap between bodies.
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

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::*;

    #[test]
    fn zero_is_in_the_middle_of_signed_values() {
        let map = |values: Vec<f64>| {
            let rows = vec![DiagramRow { time: 0.0, x: vec![0.0, 1.0, 2.0], values }];
            let scale =
                ColorMap { label: "p".into(), unit: "Pa".into(), rows, limits: None }.scale();
            (scale.shades, scale.low, scale.high)
        };
        assert_eq!(map(vec![-1e9, 0.0, 3e9]), (Shades::Diverging, -3e9, 3e9));
        assert_eq!(map(vec![0.0, 1e9, 3e9]), (Shades::Sequential, 0.0, 3e9));
    }

    #[test]
    fn gaps_between_bodies_stay_empty() {
        let axis = |label| Axis::linear(label, "").tight();
        let x = Ruler::new(&axis("x"), [0.0, 10.0].into_iter(), 5);
        let colors = Ruler::new(&axis("p"), [0.0, 1.0].into_iter(), 5);
        let positions = vec![0.0, 0.5, 1.0, 1.5, 2.0, 8.0, 8.5, 9.0, 9.5, 10.0];
        let row = DiagramRow { time: 0.0, x: positions, values: vec![1.0; 10] };
        let shades = colors_of(&row, 100, &x, (&colors, Shades::Sequential));
        assert_eq!(shades[5], Shades::Sequential.color(1.0));
        assert_eq!(shades[50], NOTHING);
        assert_eq!(shades[95], Shades::Sequential.color(1.0));
    }
}
