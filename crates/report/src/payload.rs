//! The frames as arrays of a bounded size.
//!
//! On a line every particle is kept while the arrays are small enough, else every second, third, and
//! so on. In a plane the values are means over the cells of a grid, as integers of 16 bits between the
//! least and the greatest value of the frame. The page says what was left out.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::error::ReportError;
use crate::frames::{Frame, FrameFile};

/// Greatest size of all frames in the page [bytes].
const LARGEST: usize = 3_300_000;

/// Greatest number of frames.
const MOST_FRAMES: usize = 120;

/// Text of `n` bytes in base 64 [bytes].
const BASE64: f64 = 4.0 / 3.0;

/// Integer of a cell without particles.
const EMPTY: u16 = u16::MAX;

/// A quantity, for the viewer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    name: String,
    unit: String,
}

/// The frames, for the viewer.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Payload {
    quantities: Vec<Quantity>,
    frames: Vec<FrameData>,
    /// The grid of a plane.
    grid: Option<Grid>,
    /// Remarks on what is shown.
    notes: Vec<String>,
}

/// One frame. Texts are little-endian arrays in base 64.
#[derive(Clone, Debug, Serialize)]
struct FrameData {
    /// [s]
    time: f64,
    /// Positions on a line [m], 32-bit floats, sorted.
    #[serde(skip_serializing_if = "String::is_empty")]
    x: String,
    /// Bodies of the particles or cells, 8 bits; 255: none.
    body: String,
    /// Failed particles or cells: 1; empty if there are none.
    failed: String,
    /// Values of the quantities: 32-bit floats on a line, 16-bit integers in a plane.
    values: Vec<String>,
    /// Least and greatest value of each quantity in a plane.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ranges: Vec<[f64; 2]>,
}

/// Cells of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Grid {
    /// Lower corner [m].
    lower: [f64; 2],
    /// Edges of a cell [m].
    cell: [f64; 2],
    /// Numbers of cells.
    count: [usize; 2],
}

impl Payload {
    /// The frames of a result, whose domain has cells of these edges [m].
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn new(file: &FrameFile, cell: &[f64]) -> Result<Payload, ReportError> {
        let quantities = file
            .columns
            .iter()
            .map(|column| Quantity { name: column.name.clone(), unit: column.unit.clone() });
        let mut payload = Payload { quantities: quantities.collect(), ..Payload::default() };
        let step = file.times.len().div_ceil(MOST_FRAMES).max(1);
        if step > 1 {
            payload.notes.push(format!("one frame in {step} is shown, and the last one"));
        }
        // the last frame stays
        let last = file.times.len().saturating_sub(1);
        let shown: Vec<usize> = (0..=last).rev().step_by(step).collect();
        let shown: Vec<usize> =
            shown.into_iter().rev().filter(|_| !file.times.is_empty()).collect();
        match *cell {
            [width, height] => payload.add_plane(file, &shown, [width, height])?,
            _ => payload.add_line(file, &shown)?,
        }
        Ok(payload)
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    fn add_line(&mut self, file: &FrameFile, shown: &[usize]) -> Result<(), ReportError> {
        let mut frames = Vec::new();
        for &number in shown {
            frames.push(file.read(number)?);
        }
        let particles: usize = frames.iter().map(|frame| frame.points.len()).sum();
        let bytes = (particles * (file.columns.len() + 1) * 4) as f64 * BASE64;
        let step = (bytes / LARGEST as f64).ceil().max(1.0) as usize;
        if step > 1 {
            self.notes.push(format!("one particle in {step} is shown"));
        }
        for frame in &frames {
            let mut rows: Vec<usize> = (0..frame.points.len()).collect();
            rows.sort_by(|&a, &b| frame.points[a][0].total_cmp(&frame.points[b][0]));
            let rows: Vec<usize> = rows.into_iter().step_by(step).collect();
            let floats = |value: &dyn Fn(usize) -> f64| {
                encode(rows.iter().flat_map(|&row| (value(row) as f32).to_le_bytes()))
            };
            let failed = rows.iter().any(|&row| frame.failed[row]);
            let failed_bytes = rows.iter().map(|&row| u8::from(frame.failed[row]));
            self.frames.push(FrameData {
                time: frame.time,
                x: floats(&|row| frame.points[row][0]),
                body: encode(rows.iter().map(|&row| frame.body[row].min(254) as u8)),
                failed: if failed { encode(failed_bytes) } else { String::new() },
                values: frame.values.iter().map(|values| floats(&|row| values[row])).collect(),
                ranges: Vec::new(),
            });
        }
        Ok(())
    }

    fn add_plane(
        &mut self,
        file: &FrameFile,
        shown: &[usize],
        cell: [f64; 2],
    ) -> Result<(), ReportError> {
        let mut extent: Option<[[f64; 2]; 2]> = None;
        for &number in shown {
            for point in file.read(number)?.points {
                let [low, high] = extent.get_or_insert([point, point]);
                for d in 0..2 {
                    low[d] = low[d].min(point[d]);
                    high[d] = high[d].max(point[d]);
                }
            }
        }
        let Some([low, high]) = extent else { return Ok(()) };
        let grid = Grid::over(low, high, cell, file.columns.len() * shown.len());
        let factor = (grid.cell[0] / cell[0]).round();
        self.notes.push(match factor > 1.0 {
            true => format!("values are means over blocks of {factor} x {factor} cells"),
            false => "values are means over cells".into(),
        });
        for &number in shown {
            self.frames.push(grid.frame(&file.read(number)?));
        }
        self.grid = Some(grid);
        Ok(())
    }
}

impl Grid {
    /// The grid over the particles between `low` and `high` \[m\], of the finest cells, multiples of
    /// `cell` \[m\], with which `arrays` arrays are small enough.
    fn over(low: [f64; 2], high: [f64; 2], cell: [f64; 2], arrays: usize) -> Grid {
        let mut factor = 1.0;
        loop {
            let edges = cell.map(|edge| edge * factor);
            let lower = [0, 1].map(|d| (low[d] / edges[d]).floor() * edges[d]);
            let count = [0, 1].map(|d| ((high[d] - lower[d]) / edges[d]).floor() as usize + 1);
            // two bytes per value, and the bodies
            let bytes = (count[0] * count[1] * (2 * arrays + arrays)) as f64 * BASE64;
            if bytes <= LARGEST as f64 {
                return Grid { lower, cell: edges, count };
            }
            factor += 1.0;
        }
    }

    /// Means of a frame over the cells.
    fn frame(&self, frame: &Frame) -> FrameData {
        let cells = self.count[0] * self.count[1];
        let index = |point: &[f64; 2]| {
            let at = |d: usize| {
                let place = (point[d] - self.lower[d]) / self.cell[d];
                (place.max(0.0) as usize).min(self.count[d] - 1)
            };
            at(1) * self.count[0] + at(0)
        };
        let places: Vec<usize> = frame.points.iter().map(index).collect();
        let (mut body, mut failed) = (vec![u8::MAX; cells], vec![0_u8; cells]);
        for (row, &place) in places.iter().enumerate() {
            body[place] = frame.body[row].min(254) as u8;
            failed[place] |= u8::from(frame.failed[row]);
        }
        let (mut values, mut ranges) = (Vec::new(), Vec::new());
        for column in &frame.values {
            let means = self.means(&places, column);
            let finite = means.iter().copied().filter(|mean| mean.is_finite());
            let (low, high) =
                finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            let scale = if high > low { f64::from(EMPTY - 1) / (high - low) } else { 0.0 };
            let integer = |mean: &f64| match mean.is_finite() {
                true => ((mean - low) * scale).round() as u16,
                false => EMPTY,
            };
            values.push(encode(means.iter().flat_map(|mean| integer(mean).to_le_bytes())));
            ranges.push(if low <= high { [low, high] } else { [0.0, 0.0] });
        }
        let none = failed.iter().all(|failed| *failed == 0);
        FrameData {
            time: frame.time,
            x: String::new(),
            body: encode(fill(self.count, &body, |body| *body == u8::MAX, |a, _| a).into_iter()),
            failed: if none { String::new() } else { encode(failed.into_iter()) },
            values,
            ranges,
        }
    }

    /// Mean of a column over each cell; NaN in empty cells.
    fn means(&self, places: &[usize], column: &[f64]) -> Vec<f64> {
        let cells = self.count[0] * self.count[1];
        let (mut sums, mut counts) = (vec![0.0; cells], vec![0_u32; cells]);
        for (&place, value) in places.iter().zip(column).filter(|(_, value)| value.is_finite()) {
            sums[place] += value;
            counts[place] += 1;
        }
        let mean =
            |(sum, count): (f64, u32)| if count > 0 { sum / f64::from(count) } else { f64::NAN };
        let means: Vec<f64> = sums.into_iter().zip(counts).map(mean).collect();
        fill(self.count, &means, |mean| mean.is_nan(), |a, b| 0.5 * (a + b))
    }
}

/// Values of cells; an empty cell between two filled ones gets their mean, as a particle that is
/// stretched over two cells fills both.
fn fill<T: Copy>(
    count: [usize; 2],
    values: &[T],
    is_empty: impl Fn(&T) -> bool,
    mean: impl Fn(T, T) -> T,
) -> Vec<T> {
    let at = |i: usize, j: usize| Some(values[j * count[0] + i]).filter(|value| !is_empty(value));
    let mut filled = values.to_vec();
    for j in 0..count[1] {
        for i in 0..count[0] {
            if at(i, j).is_some() {
                continue;
            }
            let beside = |inside: bool, a: (usize, usize), b: (usize, usize)| match inside {
                true => at(a.0, a.1).zip(at(b.0, b.1)),
                false => None,
            };
            let along_x = beside(i > 0 && i + 1 < count[0], (i.wrapping_sub(1), j), (i + 1, j));
            let along_y = beside(j > 0 && j + 1 < count[1], (i, j.wrapping_sub(1)), (i, j + 1));
            if let Some((a, b)) = along_x.or(along_y) {
                filled[j * count[0] + i] = mean(a, b);
            }
        }
    }
    filled
}

/// Bytes as text in base 64.
fn encode(bytes: impl Iterator<Item = u8>) -> String {
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_means_and_gaps_are_closed() {
        let grid = Grid { lower: [0.0, 0.0], cell: [1.0, 1.0], count: [3, 1] };
        let frame = Frame {
            time: 1.0,
            points: vec![[0.2, 0.5], [0.8, 0.5], [2.5, 0.5]],
            body: vec![0, 0, 1],
            failed: vec![false, false, true],
            values: vec![vec![1.0, 3.0, 4.0]],
        };
        assert_eq!(grid.means(&[0, 0, 2], &frame.values[0]), [2.0, 3.0, 4.0]);
        let data = grid.frame(&frame);
        assert_eq!(data.ranges, [[2.0, 4.0]]);
        let bytes = STANDARD.decode(&data.values[0]).unwrap();
        assert_eq!(bytes, [0_u16, 32767, 65534].map(u16::to_le_bytes).concat());
        assert_eq!(STANDARD.decode(&data.body).unwrap(), [0, 0, 1]);
        assert_eq!(STANDARD.decode(&data.failed).unwrap(), [0, 0, 1]);
    }

    #[test]
    fn a_large_plane_gets_larger_cells() {
        let fine = Grid::over([0.0; 2], [99.5, 49.5], [1.0; 2], 10);
        assert_eq!((fine.count, fine.cell), ([100, 50], [1.0; 2]));
        let coarse = Grid::over([-0.5, 0.0], [999.5, 999.5], [1.0; 2], 30);
        assert!(coarse.cell[0] > 1.0 && coarse.lower[0] <= -0.5, "{coarse:?}");
        let bytes = (coarse.count[0] * coarse.count[1] * 90) as f64 * BASE64;
        assert!(bytes <= LARGEST as f64);
    }
}
