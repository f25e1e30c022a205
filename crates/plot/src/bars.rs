//! Stacked bars, one below the other, in the right half of a page.

use super::axes::{self, GRID, INK, LABEL_EM, TICK_EM};
use super::axis::Axis;
use super::canvas::{Align, Canvas, Rect};
use super::color::Color;
use super::legend;
use super::series::{Stroke, Style};
use super::text;
use super::ticks::Ruler;

const NUMBER_EM: f64 = 16.0;
/// Largest thickness of a bar \[pixel\].
const WIDEST: f64 = 64.0;

/// Stacked horizontal bars over one axis; all bars have the same parts.
#[derive(Debug, Clone)]
pub struct Bars {
    /// Name of the quantity: "Share of time".
    pub label: String,
    /// Unit of the quantity.
    pub unit: String,
    /// Parts of a bar, from left to right.
    pub parts: Vec<BarPart>,
    /// Bars, from top to bottom.
    pub bars: Vec<Bar>,
}

/// One part of every bar.
#[derive(Debug, Clone)]
pub struct BarPart {
    /// Name in the legend.
    pub name: String,
    /// Colour.
    pub color: Color,
}

/// One bar.
#[derive(Debug, Clone)]
pub struct Bar {
    /// Text to the left of the bar.
    pub label: String,
    /// Sizes of the parts, not negative. A bar without values is drawn as "no data".
    pub values: Vec<f64>,
}

impl Bars {
    /// Draws the legend of the parts from `top` downwards; returns its lower end.
    pub(super) fn draw_legend(&self, canvas: &mut Canvas, ends: (f64, f64), top: f64) -> f64 {
        let looks: Vec<Style> =
            self.parts.iter().map(|part| Style::line(part.color).width(14.0)).collect();
        let names = self.parts.iter().map(|part| part.name.as_str());
        legend::draw(canvas, &names.zip(&looks).collect::<Vec<_>>(), ends, top)
    }

    /// Draws the bars with their labels and their axis.
    pub(super) fn draw(
        &self,
        canvas: &mut Canvas,
        (left, right): (f64, f64),
        (top, bottom): (f64, f64),
    ) {
        let widths = self.bars.iter().map(|bar| text::width(&bar.label, TICK_EM, false));
        let labels = widths.fold(0.0, f64::max);
        // The labels take at most half of the width.
        let em = TICK_EM * (0.5 * (right - left) / labels.max(1.0)).min(1.0);
        let left = left + labels * em / TICK_EM + 12.0;
        let area = Rect { left, right, top, bottom };
        let sums = self.bars.iter().map(|bar| bar.drawable().sum());
        let axis = Axis::linear(&self.label, &self.unit).tight();
        let axis = axis.range(0.0, sums.fold(0.0, f64::max));
        let x = Ruler::new(&axis, std::iter::empty(), 5);
        for tick in x.ticks.iter().filter(|tick| !tick.text.is_empty()) {
            let at = area.left + tick.at * area.width();
            canvas.line(&[(at, area.top), (at, area.bottom)], 1.0, GRID, Stroke::Solid);
        }
        let slot = area.height() / self.bars.len().max(1) as f64;
        for (index, bar) in self.bars.iter().enumerate() {
            let middle = area.top + (index as f64 + 0.5) * slot;
            let at = (area.left - 12.0, middle + 0.36 * em);
            canvas.text(&bar.label, at, em, Align::Right, INK);
            self.draw_bar(canvas, bar, &area, &x, (middle, (0.7 * slot).min(WIDEST)));
        }
        axes::floor(canvas, &area, &x);
        axes::x_numbers(canvas, &area, &x);
    }

    fn draw_bar(
        &self,
        canvas: &mut Canvas,
        bar: &Bar,
        area: &Rect,
        x: &Ruler,
        (middle, thickness): (f64, f64),
    ) {
        if bar.values.is_empty() {
            let at = (0.5 * (area.left + area.right), middle + 0.36 * LABEL_EM);
            canvas.text("no data", at, LABEL_EM, Align::Center, INK);
        }
        let mut sum = 0.0;
        for (part, value) in self.parts.iter().zip(bar.drawable()) {
            let ends = [sum, sum + value].map(|v| x.place(v).unwrap_or(0.0));
            sum += value;
            let [left, right] = ends.map(|share| area.left + share * area.width());
            let (top, bottom) = (middle - 0.5 * thickness, middle + 0.5 * thickness);
            canvas.fill(Rect { left, top, right, bottom }, part.color, 1.0);
            let number = format!("{value:.0}");
            let fits = text::width(&number, NUMBER_EM, false) + 8.0 < right - left;
            if fits && NUMBER_EM < thickness {
                let at = (0.5 * (left + right), middle + 0.36 * NUMBER_EM);
                canvas.text(&number, at, NUMBER_EM, Align::Center, Color::WHITE);
            }
        }
    }
}

impl Bar {
    /// The values, with zero for each value that cannot be drawn.
    fn drawable(&self) -> impl Iterator<Item = f64> {
        self.values.iter().map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 })
    }
}
