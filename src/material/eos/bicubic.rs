//! Bicubic interpolation on a rectangle of nodes with any spacing.
//!
//! Cubic Hermite polynomials in both directions. The derivatives at the nodes are those of
//! parabolas through three neighbours, so that the surface is C1, and exact for polynomials of
//! second order. Beyond the rectangle, the polynomial of the last cell continues.

/// Surface f(x, y).
#[derive(Clone, Debug, PartialEq)]
pub struct Bicubic {
    x: Vec<f64>,
    y: Vec<f64>,
    /// f, df/dx, df/dy, d2f/dxdy at the nodes; y runs fastest.
    nodes: Vec<[f64; 4]>,
}

/// Derivatives at `x` of the parabolas through three neighbours of `f`.
fn slopes(x: &[f64], f: &[f64]) -> Vec<f64> {
    let n = x.len();
    let secant = |k: usize| (f[k + 1] - f[k]) / (x[k + 1] - x[k]);
    if n == 2 {
        return vec![secant(0); 2];
    }
    (0..n)
        .map(|k| {
            let m = k.clamp(1, n - 2);
            let (h, g) = (x[m] - x[m - 1], x[m + 1] - x[m]);
            let bend = (secant(m) - secant(m - 1)) / (h + g);
            // f' at x[k] of the parabola about m
            (g * secant(m - 1) + h * secant(m)) / (h + g) + 2.0 * bend * (x[k] - x[m])
        })
        .collect()
}

/// Cubic Hermite weights at the position `t` in a cell of `width`, for the values and the
/// derivatives at both ends; and the derivatives of these weights.
#[inline(always)]
fn weights(t: f64, width: f64) -> [[f64; 4]; 2] {
    let (t2, t3) = (t * t, t * t * t);
    let value = [
        2.0 * t3 - 3.0 * t2 + 1.0,
        3.0 * t2 - 2.0 * t3,
        (t3 - 2.0 * t2 + t) * width,
        (t3 - t2) * width,
    ];
    let slope = [
        6.0 * (t2 - t) / width,
        6.0 * (t - t2) / width,
        3.0 * t2 - 4.0 * t + 1.0,
        3.0 * t2 - 2.0 * t,
    ];
    [value, slope]
}

/// Index of the cell of `v` among `nodes`; the outermost cell for a `v` beyond them.
#[inline(always)]
fn cell(nodes: &[f64], v: f64) -> usize {
    nodes.partition_point(|&n| n <= v).clamp(1, nodes.len() - 1) - 1
}

impl Bicubic {
    /// Surface through `f`, which has one row of values along y per x; `x` and `y` ascend.
    pub fn new(x: Vec<f64>, y: Vec<f64>, f: &[Vec<f64>]) -> Self {
        let along_y: Vec<Vec<f64>> = f.iter().map(|row| slopes(&y, row)).collect();
        let across = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
            (0..y.len())
                .map(|k| slopes(&x, &rows.iter().map(|row| row[k]).collect::<Vec<_>>()))
                .collect()
        };
        let (along_x, both) = (across(f), across(&along_y));
        let nodes = (0..x.len())
            .flat_map(|i| (0..y.len()).map(move |k| (i, k)))
            .map(|(i, k)| [f[i][k], along_x[k][i], along_y[i][k], both[k][i]])
            .collect();
        Bicubic { x, y, nodes }
    }

    /// Whether a point lies inside the rectangle.
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let within = |nodes: &[f64], v: f64| v >= nodes[0] && v <= nodes[nodes.len() - 1];
        within(&self.x, x) && within(&self.y, y)
    }

    /// Nodes along x.
    pub fn x(&self) -> &[f64] {
        &self.x
    }

    /// Nodes along y.
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// f, df/dx and df/dy at a point.
    #[inline]
    pub fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let (i, k) = (cell(&self.x, x), cell(&self.y, y));
        let (width, height) = (self.x[i + 1] - self.x[i], self.y[k + 1] - self.y[k]);
        let [wx, sx] = weights((x - self.x[i]) / width, width);
        let [wy, sy] = weights((y - self.y[k]) / height, height);
        let n = self.y.len();
        let mut sum = [0.0; 3];
        for a in 0..2 {
            for b in 0..2 {
                let [f, fx, fy, fxy] = self.nodes[(i + a) * n + k + b];
                let add = |wx: &[f64; 4], wy: &[f64; 4]| {
                    wx[a] * (wy[b] * f + wy[2 + b] * fy)
                        + wx[2 + a] * (wy[b] * fx + wy[2 + b] * fxy)
                };
                sum[0] += add(&wx, &wy);
                sum[1] += add(&sx, &wy);
                sum[2] += add(&wx, &sy);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 5] = [0.0, 1.0, 1.5, 3.0, 4.0];
    const Y: [f64; 4] = [-1.0, 0.0, 0.4, 2.0];

    fn surface(f: impl Fn(f64, f64) -> f64) -> Bicubic {
        let rows: Vec<Vec<f64>> = X.iter().map(|&x| Y.iter().map(|&y| f(x, y)).collect()).collect();
        Bicubic::new(X.to_vec(), Y.to_vec(), &rows)
    }

    #[test]
    fn is_exact_for_second_order() {
        let s = surface(|x, y| 1.0 + 2.0 * x - y + x * x + 3.0 * x * y - 0.5 * y * y);
        for (x, y) in [(0.3, -0.5), (1.2, 0.1), (3.7, 1.9), (1.5, 0.4), (4.5, 2.5)] {
            let want = [
                1.0 + 2.0 * x - y + x * x + 3.0 * x * y - 0.5 * y * y,
                2.0 + 2.0 * x + 3.0 * y,
                -1.0 + 3.0 * x - y,
            ];
            for (a, b) in s.at(x, y).into_iter().zip(want) {
                assert!((a - b).abs() < 1e-12, "{x} {y}: {a} {b}");
            }
        }
        assert!(s.contains(4.0, -1.0) && !s.contains(4.1, 0.0) && !s.contains(1.0, f64::NAN));
    }

    #[test]
    fn derivatives_are_those_of_the_surface() {
        let s = surface(|x, y| (0.4 * x).exp() * (1.0 + y * y * y));
        let h = 1e-6;
        for (x, y) in [(0.3, -0.5), (1.2, 0.1), (2.7, 1.3)] {
            let [_, fx, fy] = s.at(x, y);
            let dx = (s.at(x + h, y)[0] - s.at(x - h, y)[0]) / (2.0 * h);
            let dy = (s.at(x, y + h)[0] - s.at(x, y - h)[0]) / (2.0 * h);
            assert!((fx - dx).abs() < 1e-7 && (fy - dy).abs() < 1e-7, "{x} {y}");
        }
    }
}
