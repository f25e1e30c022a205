//! What makes a shape function: its basis, its weights along one direction and in a plane.

use std::ops::Mul;

use wide::f64x4;

use super::domain::{DomainExtent, ParticleDomain};
use super::lanes::{LANES, Lanes, PlaneLanes};
use super::plane::Plane;

/// Nodal basis functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Piecewise linear functions.
    Hat,
    /// Quadratic B-splines.
    Quadratic,
    /// Cubic B-splines.
    Cubic,
}

/// Courant numbers up to which schemes were measured to be stable [-], one per transfer: FLIP, PIC,
/// APIC, XPIC(2), XPIC(5), FMPM(2), FMPM(4), FMPM(6), FMPM(8).
///
/// The numbers are data: `cargo run --release --example courant_limits` measures them again. It
/// runs a shortened standard problem at Courant numbers from 0.1 to 1 in steps of 0.1, with the
/// options of `inputs/flyer.json` (mid-point; with its viscosity and with one that does not grow)
/// and `inputs/flyer_defaults.json` (leapfrog) that the transfer allows. A number is stable if, at
/// this and at every smaller number, the run passes the monitor and its pressures stay below twice
/// the impact pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CourantLimits {
    /// Limits for leapfrog stepping [-].
    pub leapfrog: [f64; 9],
    /// Limits for mid-point stepping [-].
    pub midpoint: [f64; 9],
}

/// Weights of one particle on a line of `K` nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const K: usize> {
    /// First node, relative to the lower node of the particle's cell.
    pub first: i32,
    /// Values of the nodes' functions [-]; they sum to 1.
    pub values: [f64; K],
    /// Gradients of the nodes' functions [1/cell]; they sum to 0.
    pub gradients: [f64; K],
}

impl<const K: usize> Weights<K> {
    /// No weight, on nodes from `first` on.
    pub(super) fn none(first: i32) -> Self {
        Weights { first, values: [0.0; K], gradients: [0.0; K] }
    }
}

/// A shape function along one direction.
pub trait Shape: Copy + Send + Sync + 'static {
    /// Dependence on the length of the particle: none, undeformed or current.
    const EXTENT: DomainExtent;

    /// Nodal basis functions from which the shape function is built.
    const BASIS: Basis;

    /// Measured limits of the Courant number.
    const COURANT: CourantLimits;

    /// Greatest number of nodes in the support of a particle of up to `length` [cells].
    fn nodes(length: f64) -> usize;

    /// Weights of a particle at `fraction` of its cell. `K` is at least `nodes(length)`.
    fn weights<const K: usize>(fraction: f64, length: f64) -> Weights<K>;

    /// Weights along both directions of a box of `extent` [cells].
    #[inline(always)]
    fn box_weights<const K: usize>(fraction: [f64; 2], extent: [f64; 2]) -> [Weights<K>; 2] {
        decomp::array::from_fn(|a| Self::weights(fraction[a], extent[a]))
    }

    /// Writes the weights in a plane of a particle at `fraction` of its cell to `out`; returns the
    /// first node, relative to the lower node of the cell. `K` is at least `nodes` of the domain's
    /// extent along either direction. By default the product of the weights along each direction.
    #[inline(always)]
    fn plane<const K: usize>(
        fraction: [f64; 2],
        domain: &ParticleDomain,
        out: &mut Plane<'_, K>,
    ) -> [i32; 2] {
        product::<Self, K>(fraction, domain, out)
    }

    /// [`Shape::weights`] of four particles, bit by bit, one in each lane.
    #[inline(always)]
    fn four<const K: usize>(fraction: f64x4, length: f64x4) -> Lanes<K> {
        one_by_one::<Self, K>(fraction, length)
    }

    /// Writes [`Shape::plane`] of four particles with the half edges of their domains to `out`, bit
    /// by bit, one in each lane.
    #[inline(always)]
    fn four_in_plane<const K: usize>(
        fraction: [f64x4; 2],
        half_edges: [[f64x4; 2]; 2],
        out: &mut PlaneLanes<K>,
    ) {
        four_boxes::<Self, K>(fraction, half_edges, out);
    }
}

/// Values, and gradients along x and y, of products of weights along x and along y; each is given
/// with its gradients.
#[inline(always)]
fn products<T: Copy + Mul<Output = T>, const K: usize>(
    [x, slope_x]: [&[T; K]; 2],
    [y, slope_y]: [&[T; K]; 2],
    [values, gx, gy]: [&mut [[T; K]]; 3],
) {
    for l in 0..K {
        for k in 0..K {
            values[l][k] = x[k] * y[l];
            gx[l][k] = slope_x[k] * y[l];
            gy[l][k] = x[k] * slope_y[l];
        }
    }
}

/// Weights of a box: products of the weights along each direction.
#[inline(always)]
pub(super) fn product<S: Shape, const K: usize>(
    fraction: [f64; 2],
    domain: &ParticleDomain,
    out: &mut Plane<'_, K>,
) -> [i32; 2] {
    let [x, y] = S::box_weights::<K>(fraction, domain.extent());
    let [gx, gy] = &mut out.gradients;
    products([&x.values, &x.gradients], [&y.values, &y.gradients], [out.values, gx, gy]);
    [x.first, y.first]
}

/// Weights of each particle by the function for one.
#[inline(always)]
fn one_by_one<S: Shape, const K: usize>(fraction: f64x4, length: f64x4) -> Lanes<K> {
    let mut first = [0.0; LANES];
    let mut lines = [[[0.0; LANES]; K]; 2];
    for lane in 0..LANES {
        let w = S::weights::<K>(fraction.as_array()[lane], length.as_array()[lane]);
        first[lane] = f64::from(w.first);
        for k in 0..K {
            lines[0][k][lane] = w.values[k];
            lines[1][k][lane] = w.gradients[k];
        }
    }
    let [values, gradients] =
        decomp::array::map(&lines, |line| decomp::array::map(&line, f64x4::from));
    Lanes { first: f64x4::from(first), skipped: f64x4::ZERO, values, gradients }
}

/// Extents of domains along x and y [cells].
#[inline(always)]
pub(crate) fn extents([r1, r2]: [[f64x4; 2]; 2]) -> [f64x4; 2] {
    let two = f64x4::splat(2.0);
    [two * (r1[0].abs() + r2[0].abs()), two * (r1[1].abs() + r2[1].abs())]
}

/// Weights of four boxes: products of the weights along each direction.
#[inline(always)]
pub(super) fn four_boxes<S: Shape, const K: usize>(
    fraction: [f64x4; 2],
    half_edges: [[f64x4; 2]; 2],
    out: &mut PlaneLanes<K>,
) {
    let [width, height] = extents(half_edges);
    let (x, y) = (S::four::<K>(fraction[0], width), S::four::<K>(fraction[1], height));
    let [gx, gy] = &mut out.gradients;
    products([&x.values, &x.gradients], [&y.values, &y.gradients], [&mut out.values, gx, gy]);
    out.first = [x.first, y.first];
    out.skipped = [x.skipped, y.skipped];
}

impl<const K: usize> Plane<'_, K> {
    /// Like [`Shape::plane`], for a particle at `fraction` [cells] of its cell with nonzero weights
    /// only at the first `M` nodes along each direction: only these are computed.
    #[inline(always)]
    pub fn fill_first<S: Shape, const M: usize>(
        &mut self,
        fraction: [f64; 2],
        domain: &ParticleDomain,
    ) -> [i32; 2] {
        let [mut values, mut gx, mut gy] = [[[0.0; M]; M]; 3];
        let mut out = Plane { values: &mut values, gradients: [&mut gx, &mut gy] };
        let first = S::plane(fraction, domain, &mut out);
        let [to_x, to_y] = &mut self.gradients;
        for (to, from) in [(&mut *self.values, &values), (to_x, &gx), (to_y, &gy)] {
            to.fill([0.0; K]);
            for (to, from) in to.iter_mut().zip(from) {
                to[..M].copy_from_slice(from);
            }
        }
        first
    }
}
