//! Draws series as lines and marks inside a panel.

use super::axis::AxisScale;
use super::canvas::{Canvas, CanvasPoint, Rect};
use super::color::Color;
use super::occupancy::Occupancy;
use super::series::{Points, Series};
use super::thin::{LIMIT, thin};
use super::ticks::{Ruler, drawable};

/// Colour of the border around outlined lines.
const BORDER: Color = Color(0x10, 0x08, 0x20);

/// Position on the page of a point of the data; `None` if it cannot be drawn.
pub(super) fn place(
    area: &Rect,
    x: &Ruler,
    y: &Ruler,
    (px, py): (f64, f64),
) -> Option<CanvasPoint> {
    let (across, up) = (x.place(px)?, y.place(py)?);
    Some((area.left + across * area.width(), area.bottom - up * area.height()))
}

/// Drawable points, thinned and split into unbroken runs.
pub(super) fn runs(
    points: &Points,
    x_scale: AxisScale,
    y_scale: AxisScale,
) -> Vec<Vec<(f64, f64)>> {
    let (mut run, mut good) = (0, Vec::new());
    for (&x, &y) in std::iter::zip(&points.x, &points.y) {
        if drawable(x, x_scale) && drawable(y, y_scale) {
            good.push((run, x, y));
        } else {
            run += 1;
        }
    }
    let ordinates: Vec<f64> = good.iter().map(|point| point.2).collect();
    let mut last = None;
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    for (run, x, y) in thin(&ordinates, LIMIT).into_iter().map(|index| good[index]) {
        if last != Some(run) {
            runs.push(Vec::new());
        }
        last = Some(run);
        runs.last_mut().into_iter().for_each(|run| run.push((x, y)));
    }
    runs
}

/// Draws a series from its unbroken runs of points on the page.
pub(super) fn draw(
    canvas: &mut Canvas,
    occupancy: &mut Occupancy,
    series: &Series,
    runs: &[Vec<CanvasPoint>],
    area: &Rect,
) {
    let style = &series.style;
    if let Some(stroke) = style.stroke {
        let lines: Vec<Vec<CanvasPoint>> = runs.iter().flat_map(|run| clipped(run, area)).collect();
        for line in &lines {
            occupancy.add_line(line);
            if style.outlined {
                canvas.line(line, style.width + 2.0, BORDER, stroke);
            }
        }
        for line in &lines {
            canvas.line(line, style.width, style.color, stroke);
        }
    }
    let lone = |run: &&Vec<CanvasPoint>| run.len() == 1 && style.mark.is_none();
    let radius = style.mark.unwrap_or(style.width);
    let marked = runs.iter().filter(|run| style.mark.is_some() || lone(run)).flatten();
    for &at in marked.filter(|at| area.grown(0.5).contains(**at)) {
        occupancy.add_point(at);
        canvas.mark(at, radius, style);
    }
}

/// Parts of a line inside a rectangle, without points that are too close to their neighbours to be
/// distinguished.
fn clipped(points: &[CanvasPoint], area: &Rect) -> Vec<Vec<CanvasPoint>> {
    let mut lines: Vec<Vec<CanvasPoint>> = Vec::new();
    let mut end = None;
    for pair in points.windows(2) {
        let Some((a, b)) = area.clip(pair[0], pair[1]) else {
            end = None;
            continue;
        };
        if end != Some(a) {
            lines.push(vec![a]);
        }
        if let Some(line) = lines.last_mut() {
            line.push(b);
        }
        end = Some(b);
    }
    for line in &mut lines {
        let last = line.len() - 1;
        let mut kept = line[0];
        let mut index = 0;
        line.retain(|&at| {
            let far = (at.0 - kept.0).abs().max((at.1 - kept.1).abs()) > 0.3;
            let keep = index == 0 || index == last || far;
            index += 1;
            if keep {
                kept = at;
            }
            keep
        });
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_breaks_a_line() {
        let points = Points::new([0.0, 1.0, 2.0, 3.0, 4.0], [1.0, 2.0, f64::NAN, 3.0, 4.0]);
        let expected = [[(0.0, 1.0), (1.0, 2.0)], [(3.0, 3.0), (4.0, 4.0)]];
        assert_eq!(runs(&points, AxisScale::Linear, AxisScale::Linear), expected);
        assert!(runs(&points, AxisScale::Linear, AxisScale::Log).len() == 2);
    }

    #[test]
    fn lines_leave_and_enter_the_panel() {
        let area = Rect { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        let line = [(-5.0, 5.0), (5.0, 5.0), (5.0, -5.0), (8.0, -5.0), (8.0, 5.0)];
        let parts = clipped(&line, &area);
        assert_eq!(parts[0], [(0.0, 5.0), (5.0, 5.0), (5.0, 0.0)]);
        assert_eq!(parts[1], [(8.0, 0.0), (8.0, 5.0)]);
    }
}
