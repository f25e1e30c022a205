//! The colour bar, which relates colours to values.

use super::axes::{self, INK, LABEL_EM, TICK, TICK_EM};
use super::canvas::{Align, Canvas, CanvasImage, CanvasPoint, CanvasShape, Rect};
use super::series::Stroke;
use super::shades::Shades;
use super::text;
use super::ticks::Ruler;

/// Thickness of the bar \[pixel\].
pub(super) const BAR: f64 = 26.0;
/// Gap between a panel and the bar beside it \[pixel\].
const GAP: f64 = 24.0;
/// Length of the pointed end that stands for values out of range \[pixel\].
const TIP: f64 = 20.0;

/// The colours of a bar, and whether values lie below or above its range.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColorBar {
    pub shades: Shades,
    pub under: bool,
    pub over: bool,
}

/// Width of a bar beside a panel, with numbers and label, up to the page margin \[pixel\].
pub(super) fn room_beside(colors: &Ruler) -> f64 {
    GAP + BAR + TICK + 8.0 + colors.widest(TICK_EM) + 14.0 + LABEL_EM
}

impl ColorBar {
    /// Draws a vertical bar to the right of a panel, with its label at `label`.
    pub fn draw_beside(&self, canvas: &mut Canvas, panel: &Rect, colors: &Ruler, label: f64) {
        let left = panel.right + GAP;
        let whole = Rect { left, right: left + BAR, ..*panel };
        let tip = |is: bool| if is { TIP } else { 0.0 };
        let (top, bottom) = (whole.top + tip(self.over), whole.bottom - tip(self.under));
        let bar = Rect { top, bottom, ..whole };
        // One column per pixel, so that viewers do not blur the sides.
        let columns = BAR as usize;
        let shades = (0..256).rev().map(|level| self.shades.color(f64::from(level) / 255.0));
        let pixels = shades.flat_map(|shade| std::iter::repeat_n(shade, columns)).collect();
        canvas.images.push(CanvasImage { rect: bar, columns, rows: 256, pixels });
        let middle = 0.5 * (bar.left + bar.right);
        let tips = [
            (self.over, 1.0, [(bar.left, top), (middle, whole.top), (bar.right, top)]),
            (self.under, 0.0, [(bar.left, bottom), (middle, whole.bottom), (bar.right, bottom)]),
        ];
        self.tips(canvas, tips);
        axes::outline(canvas, &bar, 1.5);
        for tick in &colors.ticks {
            let length = if tick.text.is_empty() { 0.5 * TICK } else { TICK };
            let at = bar.bottom - tick.at * bar.height();
            canvas.line(&[(bar.right, at), (bar.right + length, at)], 1.5, INK, Stroke::Solid);
            let place = (bar.right + TICK + 6.0, at + 0.36 * TICK_EM);
            canvas.text(&tick.text, place, TICK_EM, Align::Left, INK);
        }
        axes::upright(canvas, &colors.label, label, &whole);
    }

    /// Draws a horizontal bar, with numbers and label below it.
    pub fn draw_lying(&self, canvas: &mut Canvas, whole: &Rect, colors: &Ruler) {
        let tip = |is: bool| if is { TIP } else { 0.0 };
        let (left, right) = (whole.left + tip(self.under), whole.right - tip(self.over));
        let bar = Rect { left, right, ..*whole };
        let rows = BAR as usize;
        let shades: Vec<_> =
            (0..256).map(|level| self.shades.color(f64::from(level) / 255.0)).collect();
        canvas.images.push(CanvasImage {
            rect: bar,
            columns: 256,
            rows,
            pixels: shades.repeat(rows),
        });
        let middle = 0.5 * (bar.top + bar.bottom);
        let tips = [
            (self.over, 1.0, [(right, bar.top), (whole.right, middle), (right, bar.bottom)]),
            (self.under, 0.0, [(left, bar.top), (whole.left, middle), (left, bar.bottom)]),
        ];
        self.tips(canvas, tips);
        axes::floor(canvas, &bar, colors);
        axes::x_numbers(canvas, &bar, colors);
    }

    fn tips(&self, canvas: &mut Canvas, tips: [(bool, f64, [CanvasPoint; 3]); 2]) {
        for (_, end, corners) in tips.iter().filter(|tip| tip.0) {
            let color = self.shades.color(*end);
            canvas.shapes.push(CanvasShape::Polygon { corners: corners.to_vec(), color });
            canvas.line(corners, 1.5, INK, Stroke::Solid);
        }
    }
}

impl Ruler {
    /// Width of the widest number \[pixel\].
    pub(super) fn widest(&self, em: f64) -> f64 {
        self.ticks.iter().map(|tick| text::width(&tick.text, em, false)).fold(0.0, f64::max)
    }
}
