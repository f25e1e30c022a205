//! Paints shapes to files with the bitmap and SVG backends of `plotters`.
//!
//! Plotters accepts whole pixels only. The bitmap is therefore painted at twice the size and
//! averaged down, with lines and text cut into spans of pixels here; the SVG is written in quarters
//! of a pixel.

use std::fmt::Write as _;

use base64::prelude::{BASE64_STANDARD, Engine};
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color as _, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle,
};

use super::canvas::{Align, Canvas, CanvasImage, CanvasPoint, CanvasShape, Text};
use super::color::Color;
use super::error::PictureError;
use super::stroke::Coverage;
use super::text;

/// Settings of a backend.
struct Pen {
    /// Backend units per page pixel.
    scale: f64,
    /// Whether the backend draws lines and text well itself; else they are sent span by span.
    able: bool,
}

const BITMAP: Pen = Pen { scale: 2.0, able: false };
const SVG: Pen = Pen { scale: 4.0, able: true };

/// Font size that plotters writes to SVG, over the nominal height.
const SIZE_PER_EM: f64 = 1.24;
/// Depth of the base line below the position that plotters writes to SVG, over the nominal height.
const BASE_PER_EM: f64 = 0.76;

/// The page as PNG.
pub(super) fn to_png(canvas: &Canvas) -> Result<Vec<u8>, PictureError> {
    let (width, height) = size(canvas, BITMAP.scale);
    let mut pixels = vec![255u8; 3 * (width * height) as usize];
    for image in &canvas.images {
        stretch(image, &mut pixels, width as usize);
    }
    {
        let mut backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
        paint(&mut backend, &canvas.shapes, &BITMAP)?;
        backend.present().map_err(refused)?;
    }
    let pixels = halved(&pixels, width as usize);
    encode(&pixels, width / 2, height / 2)
}

/// The page as the text of an SVG file.
pub(super) fn to_svg(canvas: &Canvas) -> Result<String, PictureError> {
    let (width, height) = size(canvas, SVG.scale);
    let mut drawn = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut drawn, (width, height));
        paint(&mut backend, &canvas.shapes, &SVG)?;
        backend.present().map_err(refused)?;
    }
    // Replace the SVG header: that of plotters would show the page at the size of its fine units.
    let body = drawn.split_once('\n').map_or("", |(_, body)| body);
    let body =
        body.replace(" opacity=\"1\"", "").replace(" stroke=\"none\" stroke-width=\"1\"", "");
    let mut svg = String::with_capacity(body.len() + 1000);
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
         viewBox=\"0 0 {width} {height}\" stroke-linejoin=\"round\">\n<title>{}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>",
        canvas.size.0,
        canvas.size.1,
        escaped(&canvas.title)
    );
    for image in &canvas.images {
        let flat: Vec<u8> = image.pixels.iter().flat_map(|c| [c.0, c.1, c.2]).collect();
        let png = encode(&flat, image.columns as u32, image.rows as u32)?;
        let [x, y] = [image.rect.left, image.rect.top].map(|v| v * SVG.scale);
        let [w, h] = [image.rect.width(), image.rect.height()].map(|v| v * SVG.scale);
        let _ = writeln!(
            svg,
            "<image x=\"{x:.0}\" y=\"{y:.0}\" width=\"{w:.0}\" height=\"{h:.0}\" \
             preserveAspectRatio=\"none\" href=\"data:image/png;base64,{}\"/>",
            BASE64_STANDARD.encode(&png)
        );
    }
    svg.push_str(&body);
    Ok(svg)
}

fn size(canvas: &Canvas, scale: f64) -> (u32, u32) {
    ((canvas.size.0 * scale) as u32, (canvas.size.1 * scale) as u32)
}

fn refused(error: impl std::fmt::Display) -> PictureError {
    PictureError::Draw(error.to_string())
}

fn paint<B: DrawingBackend>(
    backend: &mut B,
    shapes: &[CanvasShape],
    pen: &Pen,
) -> Result<(), PictureError> {
    shapes.iter().try_for_each(|shape| paint_shape(backend, shape, pen))
}

fn paint_shape<B: DrawingBackend>(
    backend: &mut B,
    shape: &CanvasShape,
    pen: &Pen,
) -> Result<(), PictureError> {
    let whole = |v: f64| (v * pen.scale).round() as i32;
    let units = |(x, y): CanvasPoint| (whole(x), whole(y));
    match shape {
        CanvasShape::Line { points, width, color } if pen.able => {
            let points: Vec<(i32, i32)> = points.iter().map(|&at| units(at)).collect();
            let style = solid(*color, 1.0).stroke_width(whole(*width).max(1) as u32);
            backend.draw_path(points, &style).map_err(refused)
        }
        CanvasShape::Line { points, width, color } => {
            let fine = points.iter().map(|&(x, y)| (x * pen.scale, y * pen.scale));
            let fine: Vec<CanvasPoint> = fine.collect();
            let page = backend.get_size();
            let covered = Coverage::of_line(&fine, width * pen.scale, page);
            covered.spans().try_for_each(|(from, to, row, share)| {
                backend.draw_line((from, row), (to, row), &solid(*color, share)).map_err(refused)
            })
        }
        CanvasShape::Fill { rect, color, opacity } => {
            let (a, b) = (units((rect.left, rect.top)), units((rect.right, rect.bottom)));
            backend.draw_rect(a, b, &solid(*color, *opacity), true).map_err(refused)
        }
        CanvasShape::Dot { at, radius, color } => {
            let radius = whole(*radius).max(1) as u32;
            backend.draw_circle(units(*at), radius, &solid(*color, 1.0), true).map_err(refused)
        }
        CanvasShape::Polygon { corners, color } => {
            let corners: Vec<(i32, i32)> = corners.iter().map(|&at| units(at)).collect();
            backend.fill_polygon(corners, &solid(*color, 1.0)).map_err(refused)
        }
        CanvasShape::Text(text) => paint_text(backend, text, pen),
    }
}

fn paint_text<B: DrawingBackend>(
    backend: &mut B,
    text: &Text,
    pen: &Pen,
) -> Result<(), PictureError> {
    // Control characters are not allowed in XML and would make the file invalid.
    let shown: String = text.text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let em = text.em * pen.scale;
    let (x, y) = (text.at.0 * pen.scale, text.at.1 * pen.scale);
    if !pen.able {
        return paint_glyphs(backend, text, &shown, em, (x, y));
    }
    let horizontal = match text.align {
        Align::Left => HPos::Left,
        Align::Center => HPos::Center,
        Align::Right => HPos::Right,
    };
    let style = if text.bold { FontStyle::Bold } else { FontStyle::Normal };
    let mut font = FontDesc::new(FontFamily::Name(text::FAMILY), em * SIZE_PER_EM, style);
    let base = em * BASE_PER_EM;
    let (mut x, mut y) = (x, y);
    if text.upright {
        font = font.transform(FontTransform::Rotate270);
        x -= base;
    } else {
        y -= base;
    }
    let style = font.color(&rgb(text.color)).pos(Pos::new(horizontal, VPos::Top));
    backend.draw_text(&shown, &style, (x.round() as i32, y.round() as i32)).map_err(refused)
}

/// Draws a text with the embedded font.
fn paint_glyphs<B: DrawingBackend>(
    backend: &mut B,
    text: &Text,
    shown: &str,
    em: f64,
    (x, y): CanvasPoint,
) -> Result<(), PictureError> {
    let before = match text.align {
        Align::Left => 0.0,
        Align::Center => 0.5 * text::width(shown, em, text.bold),
        Align::Right => text::width(shown, em, text.bold),
    };
    let start = if text.upright { (x, y + before) } else { (x - before, y) };
    let start = (start.0.round() as i32, start.1.round() as i32);
    let mut result = Ok(());
    text::draw(shown, em, text.bold, |along, down, share| {
        let (x, y) = if text.upright { (down, -along) } else { (along, down) };
        let at = (start.0 + x, start.1 + y);
        if result.is_ok() && share > 0.0 {
            let style = solid(text.color, share.min(1.0));
            result = backend.draw_line(at, at, &style).map_err(refused);
        }
    });
    result
}

fn rgb(color: Color) -> RGBColor {
    RGBColor(color.0, color.1, color.2)
}

fn solid(color: Color, opacity: f64) -> ShapeStyle {
    ShapeStyle { color: rgb(color).mix(opacity), filled: true, stroke_width: 1 }
}

/// Copies an image onto the large bitmap; each pixel takes the nearest image pixel.
fn stretch(image: &CanvasImage, pixels: &mut [u8], width: usize) {
    let edge = |v: f64| (v * BITMAP.scale).round() as usize;
    let (left, right) = (edge(image.rect.left), edge(image.rect.right));
    let (top, bottom) = (edge(image.rect.top), edge(image.rect.bottom));
    for y in top..bottom {
        let row = (y - top) * image.rows / (bottom - top);
        let source = &image.pixels[row * image.columns..(row + 1) * image.columns];
        let target = &mut pixels[3 * (y * width + left)..3 * (y * width + right)];
        for (x, pixel) in target.chunks_exact_mut(3).enumerate() {
            let color = source[x * image.columns / (right - left)];
            pixel.copy_from_slice(&[color.0, color.1, color.2]);
        }
    }
}

/// The bitmap at half the size: each pixel is the mean of four.
fn halved(pixels: &[u8], width: usize) -> Vec<u8> {
    let mut half = Vec::with_capacity(pixels.len() / 4);
    for rows in pixels.chunks_exact(6 * width) {
        let (upper, lower) = rows.split_at(3 * width);
        for (a, b) in upper.chunks_exact(6).zip(lower.chunks_exact(6)) {
            for i in 0..3 {
                let sum =
                    u16::from(a[i]) + u16::from(a[i + 3]) + u16::from(b[i]) + u16::from(b[i + 3]);
                half.push(((sum + 2) / 4) as u8);
            }
        }
    }
    half
}

/// Encodes pixels as PNG, for speed rather than for size.
fn encode(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, PictureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

fn escaped(text: &str) -> String {
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    clean.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_takes_the_mean() {
        let pixels = [0, 0, 0, 4, 8, 12, 4, 8, 12, 0, 0, 0];
        assert_eq!(halved(&pixels, 2), [2, 4, 6]);
    }
}
