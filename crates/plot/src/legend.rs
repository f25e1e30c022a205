//! The legend: names of the series in rows under the title, outside of the panels.

use super::canvas::{Align, Canvas, Rect};
use super::color::Color;
use super::series::Style;
use super::shades::DARKEST;
use super::text;

const EM: f64 = 19.0;
const ROW: f64 = 30.0;
const SWATCH: f64 = 46.0;
/// Height of the ground of a swatch.
const SWATCH_HEIGHT: f64 = 20.0;
const SPACE: f64 = 34.0;

/// Draws names with their styles from `top` downwards between `left` and `right`; returns the lower
/// end of the legend.
pub(super) fn draw(
    canvas: &mut Canvas,
    entries: &[(&str, &Style)],
    (left, right): (f64, f64),
    top: f64,
) -> f64 {
    if entries.is_empty() {
        return top;
    }
    let (mut x, mut y) = (left, top + 0.5 * ROW);
    for (name, style) in entries {
        let (room, whole) = (right - left - SWATCH - 10.0, text::width(name, EM, false));
        let em = if whole > room { EM * room / whole } else { EM };
        let width = SWATCH + 10.0 + whole.min(room);
        if x > left && x + width > right {
            (x, y) = (left, y + ROW);
        }
        swatch(canvas, style, x, y);
        canvas.text(name, (x + SWATCH + 10.0, y + 0.35 * EM), em, Align::Left, Color::BLACK);
        x += width + SPACE;
    }
    y + 0.5 * ROW
}

fn swatch(canvas: &mut Canvas, style: &Style, x: f64, y: f64) {
    let end = x + SWATCH;
    if style.outlined {
        let half = 0.5 * SWATCH_HEIGHT;
        let rect = Rect { left: x, top: y - half, right: end, bottom: y + half };
        canvas.fill(rect, DARKEST, 1.0);
    }
    if let Some(stroke) = style.stroke {
        // The round ends of a wide line extend beyond its end points.
        let inset = if style.outlined { 5.0 } else { (0.5 * style.width - 1.5).max(0.0) };
        canvas.line(&[(x + inset, y), (end - inset, y)], style.width, style.color, stroke);
    }
    if let Some(radius) = style.mark {
        // small points stand for a cloud, a large mark for itself
        let is_cloud = style.stroke.is_none() && radius < 0.3 * SWATCH_HEIGHT;
        let places: &[f64] = if is_cloud { &[0.2, 0.5, 0.8] } else { &[0.5] };
        for share in places {
            let at = (x + share * SWATCH, y);
            canvas.mark(at, radius.min(0.4 * SWATCH_HEIGHT), style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::CanvasShape;
    use super::*;

    #[test]
    fn names_of_any_length_end_within_the_page() {
        let style = Style::line(Color::RED);
        let long = "aluminium of the second plate ".repeat(8);
        let mut canvas = Canvas::new("", (1200.0, 800.0));
        let entries = [("copper", &style), (long.as_str(), &style), ("pmma", &style)];
        let end = draw(&mut canvas, &entries, (100.0, 1172.0), 60.0);
        assert_eq!(end, 60.0 + 3.0 * ROW);
        for shape in &canvas.shapes {
            let CanvasShape::Text(text) = shape else { continue };
            let right = text.at.0 + text::width(&text.text, text.em, false);
            assert!(right < 1172.5, "{} ends at {right}", text.text);
        }
    }
}
