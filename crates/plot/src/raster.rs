//! Paints parallelograms with values onto a grid of pixels.

/// Marks a pixel that no body covers.
pub(super) const NOBODY: u32 = u32::MAX;
/// Distance by which parallelograms are extended into free pixels \[pixel\]. This closes the thin
/// gaps between neighbours of slightly different shape.
const REACH: f64 = 1.0;

/// A parallelogram in pixels, y downwards: centre and half-edges (centre to midpoint of a side).
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub centre: [f64; 2],
    pub half_edges: [[f64; 2]; 2],
    pub value: f64,
    pub body: u32,
}

/// Grid of pixels, each with the mean value of what covers it, independent of the order.
pub(super) struct Raster {
    pub columns: usize,
    pub rows: usize,
    pixels: Vec<Pixel>,
}

#[derive(Clone, Copy)]
struct Pixel {
    sum: f64,
    count: u32,
    body: u32,
}

impl Raster {
    /// Paints parallelograms; those with a non-finite number are omitted.
    pub fn of<I>(columns: usize, rows: usize, placed: impl Fn() -> I) -> Self
    where
        I: Iterator<Item = Placed>,
    {
        let empty = Pixel { sum: 0.0, count: 0, body: NOBODY };
        let mut raster = Self { columns, rows, pixels: vec![empty; columns * rows] };
        let free = vec![true; columns * rows];
        placed().for_each(|p| raster.paint(&p, 0.0, &free));
        let free: Vec<bool> = raster.pixels.iter().map(|pixel| pixel.count == 0).collect();
        placed().for_each(|p| raster.paint(&p, REACH, &free));
        raster
    }

    /// Mean value at a pixel; `None` if it is free.
    pub fn value(&self, index: usize) -> Option<f64> {
        let pixel = &self.pixels[index];
        (pixel.count > 0).then(|| pixel.sum / f64::from(pixel.count))
    }

    /// Index of the body at a pixel, the lowest of those that cover it, or [`NOBODY`].
    pub fn body(&self, index: usize) -> u32 {
        self.pixels[index].body
    }

    /// Adds the value to the free pixels whose centre lies within `reach` of the parallelogram; if
    /// `reach` is zero, to at least one pixel.
    fn paint(&mut self, placed: &Placed, reach: f64, free: &[bool]) {
        let Placed { centre: [x, y], half_edges: [a, b], value, body } = *placed;
        if ![x, y, a[0], a[1], b[0], b[1], value].iter().all(|v| v.is_finite()) {
            return;
        }
        let area = a[0] * b[1] - a[1] * b[0];
        let sides = [a[0].hypot(a[1]), b[0].hypot(b[1])];
        let mut painted = false;
        // In centre + s a + t b, |s| and |t| are at most 1, or slightly more with `reach`.
        if area.abs() > 1e-9 * sides[0] * sides[1] {
            let most = [1.0 + reach * sides[1] / area.abs(), 1.0 + reach * sides[0] / area.abs()];
            let half = [0, 1].map(|i| a[i].abs() + b[i].abs() + reach);
            for row in middles(y - half[1], y + half[1], self.rows) {
                let down = row as f64 + 0.5 - y;
                let in_s = between(b[1] / area, -b[0] * down / area, most[0]);
                let in_t = between(-a[1] / area, a[0] * down / area, most[1]);
                let (Some(s), Some(t)) = (in_s, in_t) else { continue };
                let (from, to) = (s.0.max(t.0).max(-half[0]), s.1.min(t.1).min(half[0]));
                for column in middles(x + from, x + to, self.columns) {
                    painted = true;
                    self.add(row * self.columns + column, value, body, free);
                }
            }
        }
        let inside =
            (0.0..self.columns as f64).contains(&x) && (0.0..self.rows as f64).contains(&y);
        if !painted && reach == 0.0 && inside {
            self.add(y as usize * self.columns + x as usize, value, body, free);
        }
    }

    fn add(&mut self, index: usize, value: f64, body: u32, free: &[bool]) {
        if free[index] {
            let pixel = &mut self.pixels[index];
            pixel.sum += value;
            pixel.count += 1;
            pixel.body = pixel.body.min(body);
        }
    }
}

/// Pixels of a row of `count` whose centre lies between `from` and `to`.
fn middles(from: f64, to: f64, count: usize) -> std::ops::Range<usize> {
    let first = (from - 0.5).ceil().max(0.0);
    let end = ((to - 0.5).floor() + 1.0).min(count as f64);
    // Casts saturate; the end of an empty range is before its start.
    first as usize..end.max(0.0) as usize
}

/// Interval of d in which |slope d + start| is at most `most`.
fn between(slope: f64, start: f64, most: f64) -> Option<(f64, f64)> {
    if slope == 0.0 {
        return (start.abs() <= most).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let ends = [(-most - start) / slope, (most - start) / slope];
    Some((ends[0].min(ends[1]), ends[0].max(ends[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(centre: [f64; 2], half_edges: [[f64; 2]; 2], value: f64) -> Placed {
        Placed { centre, half_edges, value, body: 0 }
    }

    fn painted(tiles: &[Placed]) -> Raster {
        Raster::of(100, 80, || tiles.iter().copied())
    }

    fn covered(raster: &Raster) -> usize {
        (0..8000).filter(|&i| raster.value(i).is_some()).count()
    }

    #[test]
    fn a_parallelogram_covers_its_area() {
        for turn in 0..12 {
            let (sin, cos) = (f64::from(turn) * 0.55).sin_cos();
            let (a, b) = ([20.0 * cos, 20.0 * sin], [12.0 * cos - 15.0 * sin, 15.0 * cos]);
            let area = 4.0 * (a[0] * b[1] - a[1] * b[0]).abs();
            // `REACH` adds a rim.
            let expected = area + 4.0 * (a[0].hypot(a[1]) + b[0].hypot(b[1])) * REACH;
            let found = covered(&painted(&[tile([50.3, 39.7], [a, b], 1.0)])) as f64;
            assert!((found - expected).abs() < 0.03 * expected, "{turn}: {found} of {expected}");
        }
    }

    #[test]
    fn neighbours_meet_without_gap_and_keep_their_values() {
        let square = [[10.0, 0.0], [0.0, 10.0]];
        let tiles = [tile([20.0, 40.0], square, 1.0), tile([40.9, 40.0], square, 3.0)];
        let raster = painted(&tiles);
        let row: Vec<_> = (12..48).map(|x| raster.value(40 * 100 + x)).collect();
        assert!(row[..18].iter().all(|v| *v == Some(1.0)), "{row:?}");
        assert!(row[19..].iter().all(|v| *v == Some(3.0)));
        assert_eq!(row[18], Some(2.0));
        assert_eq!(raster.value(40 * 100 + 5), None);
        assert_eq!(raster.value(40 * 100 + 60), None);
    }

    #[test]
    fn many_in_a_pixel_give_their_mean_in_any_order() {
        let dot = [[0.01, 0.0], [0.0, 0.01]];
        let mut tiles: Vec<Placed> =
            (0..10).map(|i| tile([7.3, 5.0 + 0.05 * f64::from(i)], dot, f64::from(i))).collect();
        let there = painted(&tiles).value(507);
        tiles.reverse();
        assert_eq!((there, painted(&tiles).value(507)), (Some(4.5), Some(4.5)));
    }

    #[test]
    fn odd_parallelograms_do_no_harm() {
        let flat = [[3.0, 1.0], [6.0, 2.0]];
        let odd = [
            tile([f64::NAN, 5.0], [[1.0, 0.0], [0.0, 1.0]], 1.0),
            tile([5.0, 5.0], [[1.0, 0.0], [0.0, 1.0]], f64::INFINITY),
            tile([-1e300, 1e300], [[1e300, 0.0], [0.0, 1.0]], 1.0),
            tile([-5.0, 200.0], [[1.0, 0.0], [0.0, 1.0]], 1.0),
        ];
        assert_eq!(covered(&painted(&odd)), 0);
        assert_eq!(covered(&painted(&[tile([50.0, 40.0], flat, 1.0)])), 1);
        let all = [[1e9, 0.0], [0.0, 1e9]];
        assert_eq!(covered(&painted(&[tile([50.0, 40.0], all, 1.0)])), 8000);
    }
}
