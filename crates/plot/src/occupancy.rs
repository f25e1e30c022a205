//! Map of the occupied parts of a panel, to find free space for text.

use super::canvas::{CanvasPoint, Rect};

/// Side of a square of the map \[pixel\].
const CELL: f64 = 8.0;

/// A panel divided into squares; each is free or occupied.
pub(super) struct Occupancy {
    panel: Rect,
    columns: usize,
    taken: Vec<bool>,
}

impl Occupancy {
    /// A panel with all squares free.
    pub fn new(panel: Rect) -> Self {
        let columns = (panel.width() / CELL).ceil().max(1.0) as usize;
        let rows = (panel.height() / CELL).ceil().max(1.0) as usize;
        Self { panel, columns, taken: vec![false; columns * rows] }
    }

    /// Marks the squares along a line as occupied.
    pub fn add_line(&mut self, points: &[CanvasPoint]) {
        for pair in points.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let steps = ((b.0 - a.0).hypot(b.1 - a.1) / (0.7 * CELL)).ceil().clamp(1.0, 1000.0);
            for step in 0..=steps as usize {
                let share = step as f64 / steps;
                self.add_point((a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1)));
            }
        }
    }

    /// Marks the square of a point as occupied.
    pub fn add_point(&mut self, at: CanvasPoint) {
        if self.panel.contains(at) {
            let column = ((at.0 - self.panel.left) / CELL) as usize;
            let row = ((at.1 - self.panel.top) / CELL) as usize;
            let index = row * self.columns + column.min(self.columns - 1);
            if let Some(cell) = self.taken.get_mut(index) {
                *cell = true;
            }
        }
    }

    /// Marks the squares of a rectangle as occupied.
    pub fn add_rect(&mut self, rect: &Rect) {
        let indices: Vec<usize> = self.indices(rect).collect();
        for index in indices {
            self.taken[index] = true;
        }
    }

    /// Number of occupied squares in a rectangle; parts outside the panel count as occupied.
    pub fn count(&self, rect: &Rect) -> usize {
        let outside = [
            self.panel.left - rect.left,
            rect.right - self.panel.right,
            self.panel.top - rect.top,
            rect.bottom - self.panel.bottom,
        ];
        let outside = outside.iter().fold(0.0f64, |most, &by| most.max(by));
        self.indices(rect).filter(|&i| self.taken[i]).count()
            + 10 * (outside / CELL).ceil() as usize
    }

    fn indices(&self, rect: &Rect) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.taken.len() / self.columns);
        let cell =
            |distance: f64, count: usize| ((distance / CELL).max(0.0) as usize).min(count - 1);
        let across = cell(rect.left - self.panel.left, columns)
            ..=cell(rect.right - self.panel.left, columns);
        let down = cell(rect.top - self.panel.top, rows)..=cell(rect.bottom - self.panel.top, rows);
        down.flat_map(move |row| across.clone().map(move |column| row * columns + column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_takes_its_squares() {
        let panel = Rect { left: 100.0, top: 100.0, right: 180.0, bottom: 180.0 };
        let mut occupancy = Occupancy::new(panel);
        occupancy.add_line(&[(100.0, 104.0), (180.0, 104.0)]);
        let upper = Rect { left: 110.0, top: 100.0, right: 125.0, bottom: 110.0 };
        let lower = Rect { left: 110.0, top: 130.0, right: 125.0, bottom: 140.0 };
        assert!(occupancy.count(&upper) > 0);
        assert_eq!(occupancy.count(&lower), 0);
        assert!(occupancy.count(&Rect { right: 300.0, ..lower }) > 0);
    }
}
