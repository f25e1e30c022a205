//! The embedded font: DejaVu Sans from the crate `dejavu`.
//!
//! Plotters can use it too, but places glyphs without their side bearings, so that words look
//! uneven. On the bitmap, this module therefore places the glyphs.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};

/// Font family for SVG: the embedded font, then similar fonts of other machines.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

static REGULAR: LazyLock<FontRef> = LazyLock::new(|| embedded(dejavu::sans::regular()));
static BOLD: LazyLock<FontRef> = LazyLock::new(|| embedded(dejavu::sans::bold()));

fn embedded(bytes: &'static [u8]) -> FontRef<'static> {
    FontRef::try_from_slice(bytes).expect("the embedded font is whole")
}

fn font(bold: bool) -> &'static FontRef<'static> {
    if bold { &BOLD } else { &REGULAR }
}

/// Width of a text with nominal height `em`.
pub(super) fn width(text: &str, em: f64, bold: bool) -> f64 {
    place(text, em, bold, |_, _| ())
}

/// Splits a text between words into lines at most `room` wide; a longer word stays whole.
pub(super) fn wrapped(text: &str, em: f64, bold: bool, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), em, bold) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// Pixels of a text with nominal height `em`: column, row and coverage (0 to 1) of each. The text
/// starts at the origin on its base line, y downwards.
pub(super) fn draw(text: &str, em: f64, bold: bool, mut pixel: impl FnMut(i32, i32, f64)) {
    let font = font(bold);
    let scale = scale(em, font);
    place(text, em, bold, |sign, x| {
        let glyph = font.glyph_id(sign).with_scale_and_position(scale, point(x as f32, 0.0));
        if let Some(outline) = font.outline_glyph(glyph) {
            let (left, top) = (outline.px_bounds().min.x as i32, outline.px_bounds().min.y as i32);
            outline.draw(|x, y, share| pixel(left + x as i32, top + y as i32, f64::from(share)));
        }
    });
}

/// Calls `set` with each character and its start position; returns the end of the text.
fn place(text: &str, em: f64, bold: bool, mut set: impl FnMut(char, f64)) -> f64 {
    let font = font(bold);
    let scaled = font.as_scaled(scale(em, font));
    let (mut x, mut last) = (0.0, None);
    for sign in text.chars() {
        let glyph = font.glyph_id(sign);
        x += last.map_or(0.0, |last| f64::from(scaled.kern(last, glyph)));
        set(sign, x);
        x += f64::from(scaled.h_advance(glyph));
        last = Some(glyph);
    }
    x
}

/// Font size; the font library expects the height of a line.
fn scale(em: f64, font: &FontRef) -> PxScale {
    let line_per_em = font.height_unscaled() / font.units_per_em().unwrap_or(2048.0);
    PxScale::from(em as f32 * line_per_em)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embedded_font_has_our_signs() {
        for sign in "AZaz09µ−×⁻¹²³⁴⁹().,%°".chars() {
            assert!(font(false).glyph_id(sign).0 > 0 && font(true).glyph_id(sign).0 > 0, "{sign}");
        }
    }

    #[test]
    fn long_text_is_wrapped_between_words() {
        let text = "copper on aluminium at 1 km/s";
        assert_eq!(wrapped(text, 20.0, false, 1e4), [text]);
        let room = width("aluminium at", 20.0, false);
        let lines = wrapped(text, 20.0, false, room);
        assert_eq!(lines, ["copper on", "aluminium at", "1 km/s"]);
        assert!(wrapped(" ", 20.0, true, 0.0).is_empty());
    }

    #[test]
    fn text_is_as_wide_and_high_as_it_says() {
        let (mut left, mut right, mut top, mut bottom) = (99, -99, 99, -99);
        draw("HHH", 40.0, false, |x, y, share| {
            if share > 0.5 {
                (left, right) = (left.min(x), right.max(x));
                (top, bottom) = (top.min(y), bottom.max(y));
            }
        });
        let width = width("HHH", 40.0, false);
        assert!(left >= 0 && f64::from(right) < width && f64::from(right) > 0.9 * width);
        // A capital letter of this font is 0.729 em high.
        assert!((28..=30).contains(&-top) && (-1..=0).contains(&bottom), "{top} {bottom}");
    }
}
