//! The page of a field; its size follows from equal scales in both directions.

use super::axes::{self, INK, LABEL_EM, MARGIN, TICK, TICK_EM};
use super::axis::Axis;
use super::canvas::{Align, Canvas, CanvasPoint, Rect};
use super::color_bar::{self, BAR, ColorBar};
use super::curves::{self, place};
use super::error::PictureError;
use super::field::Field;
use super::field_map::{self, Extent};
use super::figure::{Figure, Panel};
use super::legend;
use super::limits::AxisLimits;
use super::occupancy::Occupancy;
use super::text;
use super::ticks::Ruler;
use super::title;

/// Largest size of the plane on the page \[pixel\].
const WIDEST: f64 = 980.0;
const HIGHEST: f64 = 800.0;
/// Smallest size of the plane on the page \[pixel\]; a thinner plane is stretched.
const THINNEST: f64 = 96.0;
/// Smallest width of a page, so that the title has space \[pixel\].
const NARROWEST: f64 = 620.0;
/// Below this height of the plane, the colour bar is placed under it \[pixel\].
const LOW: f64 = 240.0;
const NOTE_EM: f64 = 18.0;
/// Height of the numbers and the label under an axis \[pixel\].
const UNDER: f64 = TICK + 5.0 + TICK_EM + LABEL_EM + 10.0 + 6.0;

/// Lays a field out.
pub(super) fn lay_out(
    figure: &Figure,
    panel: &Panel,
    field: &Field,
) -> Result<Canvas, PictureError> {
    let tiles = field.tiles(&figure.title)?;
    let extent = Extent::of(field, &tiles);
    let shown = field_map::values(field, &tiles, &extent);
    let empty = shown.is_empty();
    let limits = AxisLimits::of(shown, field.quantity.shading, field.quantity.limits);
    let (size, stretch) = panel_size(&extent);
    let has_bar = field.fills.is_none();
    let is_low = has_bar && size.1 < LOW;

    let axis = Axis::linear(&field.quantity.label, &field.quantity.unit);
    let axis = axis.range(limits.low, limits.high);
    let colors = match is_low {
        true => across(&axis, 0.6 * size.0, None),
        false => upwards(&axis, size.1, None),
    };
    let ends = extent.lower.iter().chain(&extent.upper);
    let farthest = ends.fold(0.0f64, |most, v| most.max(v.abs()));
    // The same unit in both directions, unless one is stretched.
    let unit_of = stretch.is_none().then_some(farthest);
    let x = across(&ranged(&figure.x, &extent, 0), size.0, unit_of);
    let y = upwards(&ranged(&panel.y, &extent, 1), size.1, unit_of);

    let left = MARGIN + LABEL_EM + 14.0 + y.widest(TICK_EM) + 6.0 + TICK;
    let right = match is_low {
        _ if !has_bar => 0.5 * x.widest(TICK_EM),
        true => 0.5 * x.widest(TICK_EM),
        false => color_bar::room_beside(&colors),
    };
    let content = (left + size.0 + right + MARGIN).ceil();
    let width = content.max(NARROWEST);
    let shift = (0.5 * (width - content)).floor();
    let left = (left + shift).ceil();

    let mut canvas = Canvas::new(&figure.title, (width, 0.0));
    let head = if content < width { MARGIN } else { left };
    let mut top = MARGIN + title::draw(&mut canvas, &figure.title, head);
    top += notes(&mut canvas, (figure, panel), stretch, head, top);
    let names = figure.legend();
    top = legend::draw(&mut canvas, &names, (head, width - MARGIN), top);
    let top = (top + 16.0).ceil();
    let area = Rect { left, top, right: left + size.0, bottom: top + size.1 };

    canvas.images.push(field_map::image(field, &tiles, area, &extent, (&colors, limits.shades)));
    draw_series(&mut canvas, figure, panel, &area, (&x, &y));
    if empty {
        axes::no_data(&mut canvas, &area);
    }
    axes::frame(&mut canvas, &area, &x, &y, MARGIN + 0.75 * LABEL_EM + shift);
    axes::x_numbers(&mut canvas, &area, &x);
    let bar = ColorBar { shades: limits.shades, under: limits.under, over: limits.over };
    let mut bottom = area.bottom + UNDER;
    if is_low {
        // Shorter than the plane, so that the bar does not look like a part of it.
        let inset = (0.18 * area.width()).round();
        let (left, right) = (area.left + inset, area.right - inset);
        let top = (bottom + 12.0).ceil();
        let whole = Rect { left, right, top, bottom: top + BAR };
        bar.draw_lying(&mut canvas, &whole, &colors);
        bottom = whole.bottom + UNDER;
    } else if has_bar {
        bar.draw_beside(&mut canvas, &area, &colors, width - MARGIN - shift);
    }
    canvas.size.1 = (bottom + MARGIN).ceil();
    Ok(canvas)
}

/// Width and height of the plane on the page, in whole pixels. If a direction is stretched, its
/// index and the factor by which it is stretched relative to the other.
fn panel_size(extent: &Extent) -> ((f64, f64), Option<(usize, f64)>) {
    let (x, y) = (extent.length(0), extent.length(1));
    let scale = (WIDEST / x).min(HIGHEST / y);
    let size = ((x * scale).round().max(THINNEST), (y * scale).round().max(THINNEST));
    let stretch = |d: usize, length: f64| (length < THINNEST - 0.5).then(|| (d, THINNEST / length));
    (size, stretch(0, x * scale).or(stretch(1, y * scale)))
}

fn ranged(axis: &Axis, extent: &Extent, d: usize) -> Axis {
    axis.clone().range(extent.lower[d], extent.upper[d])
}

/// A horizontal axis with as many round numbers as fit beside each other.
fn across(axis: &Axis, length: f64, size: Option<f64>) -> Ruler {
    let most = ((length / 85.0) as usize).clamp(2, 9);
    fitting(axis, most, size, |ruler| length / (ruler.widest(TICK_EM) + 14.0))
}

/// A vertical axis with as many round numbers as fit above each other.
fn upwards(axis: &Axis, length: f64, size: Option<f64>) -> Ruler {
    fitting(axis, ((length / 62.0) as usize).clamp(2, 9), size, |_| length / (1.5 * TICK_EM))
}

/// The ruler with the most ticks that fit; `room`: how many numbers fit on the axis.
fn fitting(axis: &Axis, most: usize, size: Option<f64>, room: impl Fn(&Ruler) -> f64) -> Ruler {
    let ruler = |wanted| Ruler::with_size(axis, std::iter::empty(), wanted, size);
    let fits = |ruler: &Ruler| {
        let places = ruler.ticks.iter().filter(|tick| !tick.text.is_empty()).map(|tick| tick.at);
        let places: Vec<f64> = places.collect();
        places.windows(2).all(|pair| (pair[1] - pair[0]) * room(ruler) >= 1.0)
    };
    (1..=most).rev().map(ruler).find(fits).unwrap_or_else(|| ruler(1))
}

/// Draws the notes from `top` downwards; returns their height.
fn notes(
    canvas: &mut Canvas,
    (figure, panel): (&Figure, &Panel),
    stretch: Option<(usize, f64)>,
    left: f64,
    top: f64,
) -> f64 {
    let stretched = stretch.map(|(d, times)| {
        let times = if times < 10.0 { format!("{times:.1}") } else { format!("{times:.0}") };
        format!("{} stretched ×{times}", if d == 0 { &figure.x.label } else { &panel.y.label })
    });
    let all: Vec<&str> = panel.notes.iter().chain(&stretched).map(String::as_str).collect();
    let room = canvas.size.0 - MARGIN - left;
    let lines = text::wrapped(&all.join("; "), NOTE_EM, false, room);
    for (index, line) in lines.iter().enumerate() {
        let at = (left, top + (1.0 + 1.35 * index as f64) * NOTE_EM);
        canvas.text(line, at, NOTE_EM, Align::Left, INK);
    }
    1.35 * NOTE_EM * lines.len() as f64
}

fn draw_series(
    canvas: &mut Canvas,
    figure: &Figure,
    panel: &Panel,
    area: &Rect,
    (x, y): (&Ruler, &Ruler),
) {
    let mut occupancy = Occupancy::new(*area);
    for series in &panel.series {
        let runs = curves::runs(&series.points, figure.x.scale, panel.y.scale);
        let places = |run: &Vec<_>| run.iter().filter_map(|p| place(area, x, y, *p)).collect();
        let runs: Vec<Vec<CanvasPoint>> = runs.iter().map(places).collect();
        curves::draw(canvas, &mut occupancy, series, &runs, area);
    }
}
