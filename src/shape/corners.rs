//! Hat functions at the corners of particles in a plane: the CPDI method (Sadeghirad, Brannon &
//! Burghardt 2011) without weights on a window of nodes.

use wide::f64x4;

use super::knots::split4;

/// Corners of four particles: corners 0 to 3 are at -r1 - r2, r1 - r2, -r1 + r2 and r1 + r2 from
/// the centre, where r1 and r2 are half edges of the particle's parallelogram.
#[derive(Clone, Copy, Debug)]
pub struct CornerLanes {
    /// Positions in the cells of the particles [cells].
    pub fraction: [f64x4; 2],
    /// Half edges r1 and r2 [cells].
    pub half_edges: [[f64x4; 2]; 2],
}

impl CornerLanes {
    /// Node below and to the left of corner `C` along x and y, relative to the lower nodes of the
    /// particles' cells, and the hat functions of four nodes there: of that node, of the next along x,
    /// and of both above them. Their means over the corners are the particle's weights.
    #[inline(always)]
    pub fn hats<const C: usize>(&self) -> ([f64x4; 2], [f64x4; 4]) {
        let [r1, r2] = &self.half_edges;
        let place = |a: usize| {
            let along = match C % 2 {
                0 => self.fraction[a] - r1[a],
                _ => self.fraction[a] + r1[a],
            };
            split4(if const { C < 2 } { along - r2[a] } else { along + r2[a] })
        };
        let ((i, x), (j, y)) = (place(0), place(1));
        let (before, below) = (f64x4::ONE - x, f64x4::ONE - y);
        ([i, j], [before * below, x * below, before * y, x * y])
    }

    /// Gradients [1/cell] along x and y from the difference of the hat functions between corners 3 and
    /// 0, then those from the difference between corners 1 and 2.
    ///
    /// The mean gradient over a parallelogram follows from its values along the outline by Gauss's
    /// theorem, with the trapezoidal rule on each edge.
    #[inline(always)]
    pub fn slopes(&self) -> [f64x4; 4] {
        let [r1, r2] = &self.half_edges;
        // outward normals of the edges at +r1 and +r2, times edge length over area, and a half for the
        // mean of two corners
        let scale = f64x4::splat(0.25) / (r1[0] * r2[1] - r1[1] * r2[0]);
        let (g1, g2) = ([r2[1] * scale, -r2[0] * scale], [-r1[1] * scale, r1[0] * scale]);
        [g1[0] + g2[0], g1[1] + g2[1], g1[0] - g2[0], g1[1] - g2[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Cpdi, ParticleDomain, Plane, Shape};
    use super::*;

    /// Values and gradients from the corners of four particles are those of the shape function.
    #[test]
    fn corners_give_the_weights_of_cpdi() {
        let edges = [
            [[0.25, 0.0], [0.0, 0.25]],
            [[0.4, 0.1], [-0.15, 0.3]],
            [[-0.25, 0.1], [0.05, 0.3]],
            [[0.3, -0.7], [0.2, 0.6]],
        ];
        for k in 0..25 {
            let at = [k as f64 / 25.0, (7 * k % 25) as f64 / 25.0];
            let half_edges =
                [0, 1].map(|e| [0, 1].map(|a| f64x4::from([0, 1, 2, 3].map(|l| edges[l][e][a]))));
            let corners = CornerLanes { fraction: at.map(f64x4::splat), half_edges };
            let hats = [
                corners.hats::<0>(),
                corners.hats::<1>(),
                corners.hats::<2>(),
                corners.hats::<3>(),
            ];
            let slopes = corners.slopes();
            for (lane, half_edges) in edges.into_iter().enumerate() {
                let [mut n, mut gx, mut gy] = [[[0.0; 6]; 6]; 3];
                let mut plane = Plane { values: &mut n, gradients: [&mut gx, &mut gy] };
                let first = Cpdi::plane::<6>(at, &ParticleDomain { half_edges }, &mut plane);
                let of = |v: f64x4| v.to_array()[lane];
                for (corner, (nodes, values)) in hats.iter().enumerate() {
                    let node = nodes.map(|v| of(v) as i32);
                    for (at, value) in values.iter().enumerate() {
                        let [k, l] = [0, 1]
                            .map(|a| node[a] + (at as i32 >> a & 1) - first[a])
                            .map(|k| k as usize);
                        let value = of(*value);
                        let pair = if corner == 1 || corner == 2 { 2 } else { 0 };
                        let sign = if corner == 3 || corner == 1 { 1.0 } else { -1.0 };
                        if value != 0.0 {
                            n[l][k] -= 0.25 * value;
                            gx[l][k] -= sign * value * of(slopes[pair]);
                            gy[l][k] -= sign * value * of(slopes[pair + 1]);
                        }
                    }
                }
                for rest in [n, gx, gy].as_flattened().as_flattened() {
                    assert!(rest.abs() < 1e-14, "{at:?}, {half_edges:?}: {rest}");
                }
            }
        }
    }
}
