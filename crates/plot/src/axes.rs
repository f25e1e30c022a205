//! The axes around a panel: frame, ticks, numbers and labels.

use super::canvas::{Align, Canvas, CanvasShape, Rect, Text};
use super::color::Color;
use super::series::Stroke;
use super::text;
use super::ticks::Ruler;

/// Nominal heights of the fonts of titles, labels and numbers \[pixel\].
pub(super) const TITLE_EM: f64 = 25.0;
pub(super) const LABEL_EM: f64 = 21.0;
pub(super) const TICK_EM: f64 = 19.0;
/// Length of a numbered tick \[pixel\].
pub(super) const TICK: f64 = 7.0;
/// Margin at the page border \[pixel\].
pub(super) const MARGIN: f64 = 28.0;

pub(super) const INK: Color = Color(0x33, 0x33, 0x38);
pub(super) const GRID: Color = Color(0xe4, 0xe5, 0xe8);
const FAINT: Color = Color(0x77, 0x77, 0x7c);

/// Draws faint lines at the numbered ticks.
pub(super) fn grid(canvas: &mut Canvas, area: &Rect, x: &Ruler, y: &Ruler) {
    for tick in x.ticks.iter().filter(|tick| !tick.text.is_empty()) {
        let at = area.left + tick.at * area.width();
        canvas.line(&[(at, area.top), (at, area.bottom)], 1.0, GRID, Stroke::Solid);
    }
    for tick in y.ticks.iter().filter(|tick| !tick.text.is_empty()) {
        let at = area.bottom - tick.at * area.height();
        canvas.line(&[(area.left, at), (area.right, at)], 1.0, GRID, Stroke::Solid);
    }
}

/// Draws the frame with all ticks, and the numbers and the label of the y axis.
pub(super) fn frame(canvas: &mut Canvas, area: &Rect, x: &Ruler, y: &Ruler, label: f64) {
    floor(canvas, area, x);
    for tick in &y.ticks {
        let length = if tick.text.is_empty() { 0.5 * TICK } else { TICK };
        let at = area.bottom - tick.at * area.height();
        canvas.line(&[(area.left - length, at), (area.left, at)], 1.5, INK, Stroke::Solid);
        let place = (area.left - TICK - 6.0, at + 0.36 * TICK_EM);
        canvas.text(&tick.text, place, TICK_EM, Align::Right, INK);
    }
    upright(canvas, &y.label, label, area);
}

/// Draws the frame with the ticks of the x axis.
pub(super) fn floor(canvas: &mut Canvas, area: &Rect, x: &Ruler) {
    outline(canvas, area, 1.5);
    for tick in &x.ticks {
        let length = if tick.text.is_empty() { 0.5 * TICK } else { TICK };
        let at = area.left + tick.at * area.width();
        canvas.line(&[(at, area.bottom), (at, area.bottom + length)], 1.5, INK, Stroke::Solid);
    }
}

/// Draws the border of a rectangle.
pub(super) fn outline(canvas: &mut Canvas, area: &Rect, width: f64) {
    let (a, b) = ((area.left, area.top), (area.right, area.bottom));
    let corners = [a, (b.0, a.1), b, (a.0, b.1), a];
    for side in corners.windows(2) {
        canvas.line(side, width, INK, Stroke::Solid);
    }
}

/// Draws a vertical label at `x`, centred on the height of `area`.
pub(super) fn upright(canvas: &mut Canvas, label: &str, x: f64, area: &Rect) {
    let width = text::width(label, LABEL_EM, false);
    let room = area.height() + 16.0;
    canvas.shapes.push(CanvasShape::Text(Text {
        text: label.into(),
        at: (x, 0.5 * (area.top + area.bottom)),
        em: if width > room { LABEL_EM * room / width } else { LABEL_EM },
        bold: false,
        color: INK,
        align: Align::Center,
        upright: true,
    }));
}

/// Draws the numbers and the label of the common x axis under the lowest panel.
pub(super) fn x_numbers(canvas: &mut Canvas, area: &Rect, x: &Ruler) {
    let base = area.bottom + TICK + 5.0 + TICK_EM;
    for tick in &x.ticks {
        let at = area.left + tick.at * area.width();
        canvas.text(&tick.text, (at, base), TICK_EM, Align::Center, INK);
    }
    let middle = 0.5 * (area.left + area.right);
    canvas.text(&x.label, (middle, base + LABEL_EM + 10.0), LABEL_EM, Align::Center, INK);
}

/// Says that a panel has no data.
pub(super) fn no_data(canvas: &mut Canvas, area: &Rect) {
    let middle = (0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom));
    canvas.text("no data", middle, LABEL_EM, Align::Center, FAINT);
}
