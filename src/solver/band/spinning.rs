//! Sums over particles with spin that have the same window: blocks of two by two, stored by nodes.

use std::ops::Range;

use decomp::array::map;
use wide::f64x4;

use super::{BLOCK_ENTRIES, Band, Spinning, TOGETHER, diagonals, first_entry};
use crate::shape::vector;
use crate::solver::packed::{WindowPlace, between};
use crate::solver::particle_weights::window;
use crate::solver::shape_weights::Stencils;

/// Numbers of `N` particles: values on the nodes of their window, and their products with the
/// distances along x and y.
struct Parts<const V: usize, const N: usize> {
    values: [[f64x4; V]; N],
    along: [[f64x4; V]; N],
    across: [[f64x4; V]; N],
    /// The same times mass, or times mass over I.
    terms: [[[[f64; 4]; V]; 3]; N],
}

impl<const V: usize, const N: usize> Parts<V, N> {
    #[inline(always)]
    fn new<const K: usize, const D: usize>(
        stencils: &Stencils,
        from: usize,
        particles: &[Spinning],
    ) -> Self {
        let mut parts = Parts {
            values: [[f64x4::ZERO; V]; N],
            along: [[f64x4::ZERO; V]; N],
            across: [[f64x4::ZERO; V]; N],
            terms: [[[[0.0; 4]; V]; 3]; N],
        };
        for k in 0..N {
            let Spinning { mass, place, inverse } = particles[k];
            let along = place.four_along();
            let (mass, turn) = (f64x4::splat(mass), f64x4::splat(mass * inverse));
            let lines = stencils.packed_values::<K, V, D>(from + k);
            for (line, values) in lines.into_iter().enumerate() {
                let values = values & between(0, K);
                let (x, y) = (values * along, values * f64x4::splat(place.across(line)));
                parts.values[k][line] = values;
                parts.along[k][line] = x;
                parts.across[k][line] = y;
                let terms = [mass * values, turn * x, turn * y];
                for (part, terms) in terms.into_iter().enumerate() {
                    parts.terms[k][part][line] = terms.to_array();
                }
            }
        }
        parts
    }
}

/// Adds the blocks of node `NODE` of line `LINE` and the nodes of its line from itself on, and those
/// of later lines, for some particles.
#[inline(always)]
fn add_node<
    const K: usize,
    const V: usize,
    const D: usize,
    const N: usize,
    const LINE: usize,
    const NODE: usize,
>(
    rows: &mut [f64],
    parts: &Parts<V, N>,
) {
    let count = const { diagonals(K, D) };
    for later in 0..const { V.saturating_sub(LINE) } {
        let first = first_entry(K, NODE * BLOCK_ENTRIES * count, NODE, later);
        let kept = if later == 0 { between(NODE, K) } else { between(0, 4) };
        let at = map(&[0, 1, 2, 3], |entry: usize| first + entry * count);
        let [mut xx, mut yy, mut xy, mut yx] = map(&at, |at| vector(window(rows, at)));
        for k in 0..N {
            let [term, x, y] =
                map(&[0, 1, 2], |part: usize| f64x4::splat(parts.terms[k][part][LINE][NODE]));
            let there = LINE + later;
            let (values, along, across) =
                (parts.values[k][there], parts.along[k][there], parts.across[k][there]);
            let [values, along, across] = map(&[values, along, across], |part| part & kept);
            let both = term * values;
            xx += both + y * across;
            yy += both + x * along;
            xy += -(y * along);
            yx += -(x * across);
        }
        for (at, sums) in at.into_iter().zip([xx, yy, xy, yx]) {
            rows[at..at + 4].copy_from_slice(sums.as_array());
        }
    }
}

impl Band {
    /// Adds some narrow particles with spin from `particles.start` on, which have the same window in
    /// `V` vectors.
    #[inline(always)]
    pub fn add_spinning<const K: usize, const V: usize, const D: usize>(
        &mut self,
        stencils: &Stencils,
        particles: Range<usize>,
        spinning: &[Spinning],
    ) {
        let from = particles.start;
        // numbers of particles known at compile time, so that there are no loops over them
        match spinning.len() {
            1 => self.add_some_spinning::<K, V, D, 1>(stencils, from, spinning),
            2 => self.add_some_spinning::<K, V, D, 2>(stencils, from, spinning),
            3 => self.add_some_spinning::<K, V, D, 3>(stencils, from, spinning),
            _ => self.add_some_spinning::<K, V, D, TOGETHER>(stencils, from, spinning),
        }
    }

    #[inline(always)]
    fn add_some_spinning<const K: usize, const V: usize, const D: usize, const N: usize>(
        &mut self,
        stencils: &Stencils,
        from: usize,
        spinning: &[Spinning],
    ) {
        let place = stencils.place(from);
        let parts = Parts::<V, N>::new::<K, D>(stencils, from, &spinning[..N]);
        self.add_spinning_line::<K, V, D, N, 0>(place, &parts);
        self.add_spinning_line::<K, V, D, N, 1>(place, &parts);
        self.add_spinning_line::<K, V, D, N, 2>(place, &parts);
        if const { V > 3 } {
            self.add_spinning_line::<K, V, D, N, 3>(place, &parts);
        }
    }

    #[inline(never)]
    fn add_spinning_line<
        const K: usize,
        const V: usize,
        const D: usize,
        const N: usize,
        const LINE: usize,
    >(
        &mut self,
        place: WindowPlace,
        parts: &Parts<V, N>,
    ) {
        let count = const { diagonals(K, D) };
        let from = place.first + LINE * place.stride;
        self.touch_group::<K>(from);
        // a length known at compile time avoids bounds checks
        let rows = &mut self.rows[from * BLOCK_ENTRIES * count..]
            [..const { K * BLOCK_ENTRIES * diagonals(K, D) }];
        add_node::<K, V, D, N, LINE, 0>(rows, parts);
        add_node::<K, V, D, N, LINE, 1>(rows, parts);
        add_node::<K, V, D, N, LINE, 2>(rows, parts);
        if const { K > 3 } {
            add_node::<K, V, D, N, LINE, 3>(rows, parts);
        }
    }
}
