//! The title of a page, wrapped to its width.

use super::axes::{MARGIN, TITLE_EM};
use super::canvas::{Align, Canvas, CanvasShape, Text};
use super::color::Color;
use super::text;

/// Distance of the base lines of a wrapped title, in heights of its font.
const LINE: f64 = 1.25;

/// Smallest font by which a title is kept on one line, as a fraction of the usual one.
const SMALLEST: f64 = 0.8;

/// Draws the title from `left` to the margin of the page: a long one is wrapped, a word that is wider
/// than the page is shrunk. Returns the height of the title \[pixel\].
pub(super) fn draw(canvas: &mut Canvas, title: &str, left: f64) -> f64 {
    let room = canvas.size.0 - MARGIN - left;
    let whole = text::width(title, TITLE_EM, true);
    // a slightly smaller font reads better than a second line of one word
    let lines = match whole * SMALLEST <= room {
        true => vec![title.to_string()],
        false => text::wrapped(title, TITLE_EM, true, room),
    };
    for (index, line) in lines.iter().enumerate() {
        let width = text::width(line, TITLE_EM, true);
        canvas.shapes.push(CanvasShape::Text(Text {
            text: line.clone(),
            at: (left, MARGIN + (0.8 + LINE * index as f64) * TITLE_EM),
            em: if width > room { TITLE_EM * room / width } else { TITLE_EM },
            bold: true,
            color: Color::BLACK,
            align: Align::Left,
            upright: false,
        }));
    }
    LINE * TITLE_EM * lines.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_of_any_length_stay_on_the_page() {
        let endless = "Kupfer".repeat(40);
        let long = "Three plates of copper, aluminium and PMMA behind each other: ".repeat(5);
        let mut heights = Vec::new();
        for title in ["Sod", &long, &endless] {
            let mut canvas = Canvas::new(title, (620.0, 800.0));
            heights.push(draw(&mut canvas, title, 100.0));
            let mut words = String::new();
            for shape in &canvas.shapes {
                let CanvasShape::Text(line) = shape else { continue };
                let end = line.at.0 + text::width(&line.text, line.em, true);
                assert!(end <= 620.0 - MARGIN + 0.5, "{} ends at {end}", line.text);
                assert!(line.at.1 < MARGIN + heights[heights.len() - 1]);
                words += &line.text;
            }
            assert_eq!(words.replace(' ', ""), title.replace(' ', ""), "the title is whole");
        }
        assert!(heights[0] < heights[1] && heights[0] == heights[2]);
    }
}
