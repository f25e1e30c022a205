//! A page of shapes \[pixel\], y downwards: the result of the layout and the input of the painter.

use super::color::Color;
use super::series::{Stroke, Style, Symbol};

/// Width of most pages \[pixel\].
pub(super) const WIDTH: f64 = 1200.0;
/// Height of most pages \[pixel\].
pub(super) const HEIGHT: f64 = 800.0;

/// Position on the page, x and y \[pixel\].
pub(super) type CanvasPoint = (f64, f64);

/// Horizontal alignment of a text at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Center,
    Right,
}

/// A text; its position is on the base line.
#[derive(Debug, Clone)]
pub(super) struct Text {
    pub text: String,
    pub at: CanvasPoint,
    /// Nominal height of the font \[pixel\].
    pub em: f64,
    pub bold: bool,
    pub color: Color,
    pub align: Align,
    /// Whether the text runs upwards.
    pub upright: bool,
}

/// An axis-aligned rectangle \[pixel\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Rect {
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The rectangle enlarged by `by` on every side.
    pub fn grown(&self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            right: self.right + by,
            bottom: self.bottom + by,
        }
    }

    pub fn contains(&self, (x, y): CanvasPoint) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    /// The part of the straight line from `a` to `b` inside the rectangle (Liang and Barsky 1984).
    pub fn clip(&self, a: CanvasPoint, b: CanvasPoint) -> Option<(CanvasPoint, CanvasPoint)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0f64, 1.0f64);
        let sides = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        for (outwards, room) in sides {
            if outwards == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if outwards < 0.0 {
                from = from.max(room / outwards);
            } else {
                to = to.min(room / outwards);
            }
        }
        let at = |s: f64| (a.0 + s * dx, a.1 + s * dy);
        (from <= to).then(|| (at(from), at(to)))
    }
}

/// A shape on the page.
#[derive(Debug, Clone)]
pub(super) enum CanvasShape {
    Line { points: Vec<CanvasPoint>, width: f64, color: Color },
    Fill { rect: Rect, color: Color, opacity: f64 },
    Dot { at: CanvasPoint, radius: f64, color: Color },
    Polygon { corners: Vec<CanvasPoint>, color: Color },
    Text(Text),
}

/// An image that is stretched over a rectangle; rows from the top.
#[derive(Debug, Clone)]
pub(super) struct CanvasImage {
    pub rect: Rect,
    pub columns: usize,
    pub rows: usize,
    pub pixels: Vec<Color>,
}

/// A page: images at the bottom, shapes over them in the order of the list.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    pub title: String,
    /// Width and height in whole pixels \[px\].
    pub size: (f64, f64),
    pub images: Vec<CanvasImage>,
    pub shapes: Vec<CanvasShape>,
}

impl Canvas {
    /// An empty page.
    pub fn new(title: &str, size: (f64, f64)) -> Self {
        Self { title: title.into(), size, images: Vec::new(), shapes: Vec::new() }
    }

    /// Draws a line with a pattern.
    pub fn line(&mut self, points: &[CanvasPoint], width: f64, color: Color, stroke: Stroke) {
        let (on, off) = match stroke {
            Stroke::Solid => {
                self.shapes.push(CanvasShape::Line { points: points.to_vec(), width, color });
                return;
            }
            Stroke::Dashed => (12.0, 7.0),
            Stroke::Dotted => (2.5, 5.0),
        };
        for points in dashes(points, on, off) {
            self.shapes.push(CanvasShape::Line { points, width, color });
        }
    }

    /// Draws a mark in the colour and with the symbol of `style`.
    pub fn mark(&mut self, at: CanvasPoint, radius: f64, style: &Style) {
        let color = style.color;
        match style.symbol {
            Symbol::Disc => self.shapes.push(CanvasShape::Dot { at, radius, color }),
            Symbol::Ring => {
                self.shapes.push(CanvasShape::Dot { at, radius, color });
                let radius = 0.55 * radius;
                self.shapes.push(CanvasShape::Dot { at, radius, color: Color::WHITE });
            }
            Symbol::Cross => {
                let corner =
                    |across: f64, down: f64| (at.0 + across * radius, at.1 + down * radius);
                let strokes = [
                    [corner(-1.0, -1.0), corner(1.0, 1.0)],
                    [corner(-1.0, 1.0), corner(1.0, -1.0)],
                ];
                if style.outlined {
                    let (width, color) = (4.0, Color::WHITE);
                    let line = |points: Vec<_>| CanvasShape::Line { points, width, color };
                    self.shapes.extend(strokes.map(|s| line(s.to_vec())));
                }
                let line = |points: Vec<_>| CanvasShape::Line { points, width: 1.8, color };
                self.shapes.extend(strokes.map(|s| line(s.to_vec())));
            }
        }
    }

    /// Fills a rectangle.
    pub fn fill(&mut self, rect: Rect, color: Color, opacity: f64) {
        self.shapes.push(CanvasShape::Fill { rect, color, opacity });
    }

    /// Draws a horizontal text.
    pub fn text(&mut self, text: &str, at: CanvasPoint, em: f64, align: Align, color: Color) {
        let text = Text { text: text.into(), at, em, bold: false, color, align, upright: false };
        self.shapes.push(CanvasShape::Text(text));
    }
}

/// Cuts a line into dashes of length `on` with gaps of length `off`.
fn dashes(points: &[CanvasPoint], on: f64, off: f64) -> Vec<Vec<CanvasPoint>> {
    let mut done = Vec::new();
    let mut dash: Vec<CanvasPoint> = points.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, on);
    for pair in points.windows(2) {
        let (mut a, b) = (pair[0], pair[1]);
        loop {
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            if length < left {
                left -= length;
                if drawing {
                    dash.push(b);
                }
                break;
            }
            let share = left / length;
            a = (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1));
            if drawing {
                dash.push(a);
                done.push(std::mem::take(&mut dash));
            } else {
                dash = vec![a];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
    }
    if dash.len() > 1 {
        done.push(dash);
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_clipped_to_the_rectangle() {
        let rect = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        assert_eq!(rect.clip((-5.0, 5.0), (15.0, 5.0)), Some(((0.0, 5.0), (10.0, 5.0))));
        assert_eq!(rect.clip((-5.0, 11.0), (15.0, 11.0)), None);
        assert_eq!(rect.clip((2.0, 2.0), (2.0, 2.0)), Some(((2.0, 2.0), (2.0, 2.0))));
    }

    #[test]
    fn dashes_turn_corners() {
        let cut = dashes(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)], 3.0, 2.0);
        assert_eq!(cut, [vec![(0.0, 0.0), (3.0, 0.0)], vec![(4.0, 1.0), (4.0, 4.0)]]);
        assert!(dashes(&[], 3.0, 2.0).is_empty());
    }
}
