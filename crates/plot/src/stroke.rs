//! Antialiased lines for the bitmap. Plotters draws wide lines between whole pixels, which is
//! visible on gentle curves.

use super::canvas::CanvasPoint;

/// Coverage of pixels by a line, within its bounding rectangle.
pub(super) struct Coverage {
    left: i32,
    top: i32,
    width: usize,
    covered: Vec<u8>,
    /// Columns touched in each row: from, to (exclusive).
    touched: Vec<(usize, usize)>,
}

impl Coverage {
    /// Coverage of a line with this width through `points` \[pixel\], with round ends and corners,
    /// on a page of size `page`.
    pub fn of_line(points: &[CanvasPoint], width: f64, page: (u32, u32)) -> Self {
        let reach = 0.5 * width + 1.0;
        let ends = |values: &mut dyn Iterator<Item = f64>, size: u32| {
            let (low, high) =
                values.fold((f64::MAX, f64::MIN), |(low, high), v| (v.min(low), v.max(high)));
            let within = |v: f64| v.clamp(0.0, f64::from(size)) as i32;
            (within((low - reach).floor()), within((high + reach).ceil() + 1.0))
        };
        let (left, right) = ends(&mut points.iter().map(|at| at.0), page.0);
        let (top, bottom) = ends(&mut points.iter().map(|at| at.1), page.1);
        let (columns, rows) = ((right - left).max(0) as usize, (bottom - top).max(0) as usize);
        let covered = vec![0; columns * rows];
        let touched = vec![(columns, 0); rows];
        let mut coverage = Self { left, top, width: columns, covered, touched };
        let local = |at: CanvasPoint| (at.0 - f64::from(left), at.1 - f64::from(top));
        for pair in points.windows(2) {
            coverage.add(local(pair[0]), local(pair[1]), 0.5 * width);
        }
        coverage
    }

    /// Spans of pixels with equal coverage: first and last column, row, and coverage (0 to 1).
    pub fn spans(&self) -> impl Iterator<Item = (i32, i32, i32, f64)> {
        self.touched.iter().enumerate().flat_map(move |(row, &(from, to))| {
            let start = row * self.width;
            let cells = &self.covered[start + from.min(to)..start + to];
            let mut column = self.left + from as i32;
            cells.chunk_by(|a, b| a == b).filter_map(move |span| {
                let first = column;
                column += span.len() as i32;
                let share = f64::from(span[0]) / 255.0;
                (share > 0.0).then_some((first, column - 1, self.top + row as i32, share))
            })
        })
    }

    /// Adds a straight segment. The coverage of a pixel follows from the distance of its centre to
    /// the segment, relative to `radius`.
    fn add(&mut self, a: CanvasPoint, b: CanvasPoint, radius: f64) {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let square = dx * dx + dy * dy;
        let reach = radius + 1.0;
        let rows = self.touched.len() as f64;
        let from = (a.1.min(b.1) - reach).floor().clamp(0.0, rows) as usize;
        let to = (a.1.max(b.1) + reach).ceil().clamp(0.0, rows) as usize;
        for row in from..to {
            let y = row as f64 + 0.5;
            // Interval in which the segment passes this row, plus or minus the reach.
            let at = |y: f64| a.0 + ((y - a.1) / dy).clamp(0.0, 1.0) * dx;
            let (p, q) = if dy == 0.0 { (a.0, b.0) } else { (at(y - reach), at(y + reach)) };
            let first = (p.min(q) - reach).floor().clamp(0.0, self.width as f64) as usize;
            let last = (p.max(q) + reach).ceil().clamp(0.0, self.width as f64) as usize;
            if first >= last {
                continue;
            }
            let touched = &mut self.touched[row];
            *touched = (touched.0.min(first), touched.1.max(last));
            let start = row * self.width;
            for (column, cell) in (first..last).zip(&mut self.covered[start + first..start + last])
            {
                let (px, py) = (column as f64 + 0.5 - a.0, y - a.1);
                let along =
                    if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
                let (ox, oy) = (px - along * dx, py - along * dy);
                let share = radius + 0.5 - (ox * ox + oy * oy).sqrt();
                *cell = (*cell).max((share.clamp(0.0, 1.0) * 255.0) as u8);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[CanvasPoint], width: f64) -> f64 {
        let spans = Coverage::of_line(points, width, (100, 100));
        spans.spans().map(|(from, to, _, share)| f64::from(to - from + 1) * share).sum()
    }

    #[test]
    fn lines_in_all_directions_are_as_wide() {
        for turn in 0..24 {
            let (sin, cos) = (f64::from(turn) * 0.2618).sin_cos();
            let end = |s: f64| (50.3 + s * 30.0 * cos, 49.8 + s * 30.0 * sin);
            let expected = 60.0 * 4.0 + std::f64::consts::PI * 4.0;
            let found = area(&[end(-1.0), end(1.0)], 4.0);
            assert!((found / expected - 1.0).abs() < 0.04, "{turn}: {found} of {expected}");
        }
    }

    #[test]
    fn corners_are_covered_once_and_the_page_is_kept_to() {
        let bent = area(&[(10.0, 10.0), (30.0, 10.0), (30.0, 10.0), (10.0, 10.0)], 3.0);
        assert!((bent - area(&[(10.0, 10.0), (30.0, 10.0)], 3.0)).abs() < 1e-9);
        assert_eq!(area(&[(-90.0, -50.0), (-10.0, -50.0)], 3.0), 0.0);
        let wide = Coverage::of_line(&[(-1e6, 50.0), (1e6, 50.0)], 3.0, (100, 100));
        assert!(
            wide.spans().all(|(from, to, y, _)| from >= 0 && to < 100 && (48..52).contains(&y))
        );
        assert_eq!(
            wide.spans().filter(|span| span.3 == 1.0).map(|(a, b, ..)| b - a + 1).sum::<i32>(),
            200
        );
    }
}
