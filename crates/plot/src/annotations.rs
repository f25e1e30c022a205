//! Annotations inside a panel: labels, notes and the enlarged detail, placed where they cover the
//! least data.

use super::axes::{GRID, INK, LABEL_EM, outline};
use super::axis::Axis;
use super::canvas::{Align, Canvas, CanvasPoint, CanvasShape, Rect, Text};
use super::color::Color;
use super::curves::{self, place};
use super::figure::{Figure, Label, Panel};
use super::occupancy::Occupancy;
use super::series::Stroke;
use super::text;
use super::ticks::Ruler;

const NOTE_EM: f64 = 18.0;
const SMALL_EM: f64 = 15.0;

/// Background colour of the part of the x axis that a close-up enlarges.
const BAND: Color = Color(0xfd, 0xf3, 0xda);

/// Draws a dot with its text, on the side of the dot where the text covers the least data.
pub(super) fn label(
    canvas: &mut Canvas,
    occupancy: &mut Occupancy,
    label: &Label,
    area: &Rect,
    x: &Ruler,
    y: &Ruler,
) {
    let Some(at) = place(area, x, y, (label.x, label.y)).filter(|at| area.grown(1.0).contains(*at))
    else {
        return;
    };
    canvas.shapes.push(CanvasShape::Dot { at, radius: 8.0, color: Color::WHITE });
    canvas.shapes.push(CanvasShape::Dot { at, radius: 6.5, color: Color::BLACK });
    let (width, height) = (text::width(&label.text, LABEL_EM, true), 0.75 * LABEL_EM);
    let sides = [(1, -1), (-1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (-1, 0), (0, 1)];
    let boxes = sides.map(|(across, down)| {
        let apart = if across == 0 || down == 0 { 14.0 } else { 10.0 };
        let x = at.0 + f64::from(across) * (apart + 0.5 * width);
        let y = at.1 + f64::from(down) * (apart + 0.5 * height);
        let (left, top) = (x - 0.5 * width, y - 0.5 * height);
        Rect { left, top, right: left + width, bottom: top + height }
    });
    let best =
        boxes.iter().min_by_key(|rect| occupancy.count(&rect.grown(3.0))).unwrap_or(&boxes[0]);
    canvas.shapes.push(CanvasShape::Text(Text {
        text: label.text.clone(),
        at: (0.5 * (best.left + best.right), best.bottom),
        em: LABEL_EM,
        bold: true,
        color: Color::BLACK,
        align: Align::Center,
        upright: false,
    }));
    occupancy.add_rect(best);
    occupancy.add_rect(&Rect { left: at.0, right: at.0, top: at.1, bottom: at.1 }.grown(8.0));
}

/// Draws the notes in a box, in the corner where the box covers the least data.
pub(super) fn notes(canvas: &mut Canvas, occupancy: &Occupancy, notes: &[String], area: &Rect) {
    if notes.is_empty() {
        return;
    }
    let line = 1.45 * NOTE_EM;
    let room = 0.6 * area.width();
    let notes: Vec<String> =
        notes.iter().flat_map(|note| text::wrapped(note, NOTE_EM, false, room)).collect();
    let widths = notes.iter().map(|note| text::width(note, NOTE_EM, false));
    let width = widths.fold(0.0, f64::max) + 24.0;
    let height = notes.len() as f64 * line + 14.0;
    let Some((best, _)) = freest(occupancy, area, width, height) else { return };
    canvas.fill(best.grown(1.0), GRID, 1.0);
    canvas.fill(best, Color::WHITE, 1.0);
    for (index, note) in notes.iter().enumerate() {
        let base = best.top + 7.0 + (index as f64 + 0.72) * line;
        canvas.text(note, (best.left + 12.0, base), NOTE_EM, Align::Left, INK);
    }
}

/// Draws an enlarged part of the x axis in a free area, with the y axis of the panel. Draws nothing
/// if no area is free. `below` is the number of shapes that lie under the series.
pub(super) fn close_up(
    canvas: &mut Canvas,
    occupancy: &mut Occupancy,
    (figure, panel): (&Figure, &Panel),
    area: &Rect,
    (x, y): (&Ruler, &Ruler),
    below: usize,
) {
    let Some((low, high)) = panel.close_up.filter(|(low, high)| low < high) else { return };
    let axis = Axis { scale: figure.x.scale, ..Axis::linear("", &figure.x.unit) }.range(low, high);
    let part = Ruler::new(&axis, std::iter::empty(), 3);
    let (Some(from), Some(to)) = (x.place(low), x.place(high)) else { return };
    let numbers = 1.4 * SMALL_EM;
    let widths = y.ticks.iter().map(|tick| text::width(&tick.text, SMALL_EM, false));
    let aside = widths.fold(0.0, f64::max) + 6.0;
    let free = [0.34, 0.27, 0.2].iter().find_map(|share| {
        let (width, height) = (share * area.width(), 1.5 * share * area.height());
        let (width, height) = (width + aside, height + numbers);
        let (rect, taken) = freest(occupancy, area, width, height)?;
        (taken == 0).then_some(rect)
    });
    let Some(whole) = free else { return };
    let inner = Rect { left: whole.left + aside, bottom: whole.bottom - numbers, ..whole };

    let across = |share: f64| area.left + share.clamp(0.0, 1.0) * area.width();
    let band = Rect { left: across(from), right: across(to), ..*area };
    canvas.shapes.insert(below, CanvasShape::Fill { rect: band, color: BAND, opacity: 1.0 });
    canvas.fill(whole.grown(4.0), Color::WHITE, 1.0);
    canvas.fill(inner, BAND.mix(Color::WHITE, 0.5), 1.0);
    for tick in part.ticks.iter().filter(|tick| !tick.text.is_empty()) {
        let at = inner.left + tick.at * inner.width();
        canvas.line(&[(at, inner.top), (at, inner.bottom)], 1.0, GRID, Stroke::Solid);
        let base = (at, inner.bottom + 1.2 * SMALL_EM);
        canvas.text(&tick.text, base, SMALL_EM, Align::Center, INK);
    }
    for tick in y.ticks.iter().filter(|tick| !tick.text.is_empty()) {
        let at = inner.bottom - tick.at * inner.height();
        canvas.line(&[(inner.left, at), (inner.right, at)], 1.0, GRID, Stroke::Solid);
        let base = (inner.left - 5.0, at + 0.36 * SMALL_EM);
        canvas.text(&tick.text, base, SMALL_EM, Align::Right, INK);
    }
    for series in &panel.series {
        let mut series = series.clone();
        series.style.mark = series.style.mark.map(|radius| 1.3 * radius);
        let runs = curves::runs(&series.points, figure.x.scale, panel.y.scale);
        let runs: Vec<Vec<CanvasPoint>> = runs
            .iter()
            .map(|run| run.iter().filter_map(|p| place(&inner, &part, y, *p)).collect())
            .collect();
        curves::draw(canvas, &mut Occupancy::new(inner), &series, &runs, &inner);
    }
    outline(canvas, &inner, 1.0);
    occupancy.add_rect(&whole.grown(6.0));
}

/// Finds the position for a box of this size that covers the least data, corners first. Returns the
/// box and the number of occupied squares under it.
fn freest(occupancy: &Occupancy, area: &Rect, width: f64, height: f64) -> Option<(Rect, usize)> {
    let room = area.grown(-14.0);
    let across = [1.0, 0.0, 0.5, 0.75, 0.25, 0.875, 0.625, 0.375, 0.125];
    let down = [0.0, 1.0, 0.5, 0.25, 0.75];
    let boxes = down.iter().flat_map(|down| {
        let top = room.top + down * (room.height() - height);
        across.map(|share| {
            let left = room.left + share * (room.width() - width);
            Rect { left, top, right: left + width, bottom: top + height }
        })
    });
    boxes.map(|rect| (rect, occupancy.count(&rect.grown(6.0)))).min_by_key(|(_, taken)| *taken)
}
