//! Weights of all particles of a patch: four narrow particles at a time in a plane, and on a line in
//! windows of four nodes; all others one after the other, with the same bits.

use std::ops::Range;

use decomp::array::{from_fn, map};
use wide::f64x4;

use crate::shape::{
    LANES, ParticleDomain, Plane, PlaneLanes, Shape, Weights, extents, integer, vector,
};
use crate::solver::particle_weights::{NARROW, lines};
use crate::solver::shape_weights::Stencils;

/// Places of particles and their domains.
pub(super) struct Places<'a, const D: usize> {
    /// Cells.
    pub cells: &'a [[i32; D]],
    /// Positions in the cells [cells].
    pub fractions: [&'a [f64]; D],
    /// Columns of the domain: the length on a line, or those of the shape function's extent in a
    /// plane [cells].
    pub domains: [&'a [f64]; 4],
    /// First node of the patch's arrays.
    pub lower: [i32; D],
    /// 1/edge of a cell [1/m].
    pub inverse_cell: [f64; D],
}

/// First nodes of windows along each direction, relative to the first node of the arrays: the least
/// and the greatest.
pub(super) struct Corners<const D: usize> {
    pub least: [i32; D],
    pub most: [i32; D],
}

impl<const D: usize> Corners<D> {
    /// No windows.
    pub fn none() -> Self {
        Corners { least: [i32::MAX; D], most: [i32::MIN; D] }
    }

    #[inline(always)]
    fn extend(&mut self, corner: [i32; D]) {
        for a in 0..D {
            self.least[a] = self.least[a].min(corner[a]);
            self.most[a] = self.most[a].max(corner[a]);
        }
    }
}

/// Values of four particles of a column from `first` on.
#[inline(always)]
pub(super) fn four(column: &[f64], first: usize) -> f64x4 {
    vector(column[first..first + LANES].try_into().expect("four particles"))
}

/// Writes `N` numbers of each of four particles, which follow each other in `out`.
#[inline(always)]
fn put(numbers: &[f64x4], out: &mut [f64]) {
    let count = numbers.len();
    let out = &mut out[..LANES * count];
    let (squares, rest) = numbers.as_chunks::<LANES>();
    for (square, numbers) in squares.iter().enumerate() {
        for (lane, line) in f64x4::transpose(*numbers).iter().enumerate() {
            let at = lane * count + LANES * square;
            out[at..at + LANES].copy_from_slice(line.as_array());
        }
    }
    for (k, number) in rest.iter().enumerate() {
        for lane in 0..LANES {
            out[lane * count + LANES * squares.len() + k] = number.as_array()[lane];
        }
    }
}

/// Whether four particles are computed together: in a plane always, on a line only for windows of
/// four nodes, because it takes more instructions for two or three. In windows of more than
/// [`NARROW`] nodes in a plane it is done for four narrow particles only.
const fn in_lanes(width: usize, dimension: usize) -> bool {
    dimension > 1 || width == NARROW
}

/// Writes four lines of four numbers of each of four particles to the first places of the lines of their
/// windows of `K` nodes in `out`, and zeros to the others.
#[inline(always)]
fn put_narrow<const K: usize>(numbers: &[[f64x4; NARROW]; NARROW], out: [&mut [f64]; LANES]) {
    let turned = map(numbers, |line: [f64x4; NARROW]| f64x4::transpose(line));
    for (lane, out) in out.into_iter().enumerate() {
        let lines = out.as_chunks_mut::<K>().0;
        lines.iter_mut().for_each(|line| line.fill(0.0));
        for (line, turned) in lines.iter_mut().zip(&turned) {
            line[..NARROW].copy_from_slice(turned[lane].as_array());
        }
    }
}

impl Stencils {
    /// Computes the weights of all particles at the places `at`, in arrays with lines of `stride`
    /// nodes.
    pub(super) fn fill<S: Shape, const K: usize, const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        stride: usize,
    ) -> Corners<D> {
        let n = at.cells.len();
        self.resize::<K, D>(n, stride);
        let mut corners = Corners::none();
        let whole = if const { in_lanes(K, D) } { n - n % LANES } else { 0 };
        let mut buffer = PlaneLanes::none();
        let mut narrow_buffer = PlaneLanes::none();
        for first in (0..whole).step_by(LANES) {
            // at most one of the branches is compiled
            if const { D == 1 && in_lanes(K, D) } {
                self.fill_four_on_line::<S, K, D>(at, first, &mut corners);
            } else if const { D > 1 && K <= NARROW } {
                self.fill_four::<S, K, D>(at, first, &mut corners, &mut buffer);
            } else if const { D > 1 } {
                if at.are_narrow::<S>(first) {
                    self.fill_four_narrow::<S, K, D>(at, first, &mut corners, &mut narrow_buffer);
                } else {
                    self.fill_rest::<S, K, D>(at, first..first + LANES, &mut corners);
                }
            }
        }
        self.fill_rest::<S, K, D>(at, whole..n, &mut corners);
        corners
    }

    /// Weights of four particles from `first` on, on a line.
    #[inline(always)]
    fn fill_four_on_line<S: Shape, const K: usize, const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        first: usize,
        corners: &mut Corners<D>,
    ) {
        let mut w = S::four::<K>(four(at.fractions[0], first), four(at.domains[0], first));
        let inverse = f64x4::splat(at.inverse_cell[0]);
        w.gradients.iter_mut().for_each(|g| *g *= inverse);
        put(&w.values, &mut self.values[first * K..]);
        put(&w.gradients, &mut self.gradients[first * K..]);
        self.put_corners(at, first, corners, ([w.first; D], [w.skipped; D]));
    }

    /// Weights of four particles from `first` on, in a plane.
    #[inline(always)]
    fn fill_four<S: Shape, const K: usize, const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        first: usize,
        corners: &mut Corners<D>,
        w: &mut PlaneLanes<K>,
    ) {
        let nodes = const { K * lines(K, D) };
        let values = &mut self.values[first * nodes..];
        let gradients = &mut self.gradients[first * nodes * D..];
        at.four::<S, K>(first, w);
        put(w.values.as_flattened(), values);
        put(w.gradients.as_flattened().as_flattened(), gradients);
        self.put_corners(at, first, corners, (from_fn(|a| w.first[a]), from_fn(|a| w.skipped[a])));
    }

    /// Weights of four narrow particles from `first` on, in windows of more nodes.
    #[inline(always)]
    fn fill_four_narrow<S: Shape, const K: usize, const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        first: usize,
        corners: &mut Corners<D>,
        w: &mut PlaneLanes<NARROW>,
    ) {
        at.four::<S, NARROW>(first, w);
        let nodes = const { K * lines(K, D) };
        let parts = [&w.values, &w.gradients[0], &w.gradients[1]];
        put_narrow::<K>(parts[0], parts_of_four::<1>(&mut self.values[first * nodes..], nodes, 0));
        for axis in 0..D {
            let gradients = &mut self.gradients[first * nodes * D..];
            put_narrow::<K>(parts[1 + axis], parts_of_four::<D>(gradients, nodes, axis));
        }
        self.narrow[first..first + LANES].fill(true);
        self.put_corners(at, first, corners, (from_fn(|a| w.first[a]), from_fn(|a| w.skipped[a])));
    }

    /// Writes the first nodes of four particles from `first` on, which lie `offset` nodes from the
    /// lower nodes of their cells, and whether windows start one node before their first weights.
    #[inline(always)]
    fn put_corners<const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        first: usize,
        corners: &mut Corners<D>,
        (offset, skipped): ([f64x4; D], [f64x4; D]),
    ) {
        let offset = map(&offset, |offset: f64x4| offset.to_array());
        let cells = &at.cells[first..first + LANES];
        let windows = &mut self.first[first..first + LANES];
        for lane in 0..LANES {
            let corner: [i32; D] =
                from_fn(|a| cells[lane][a] + integer(offset[a][lane]) - at.lower[a]);
            corners.extend(corner);
            windows[lane] = index(corner, self.stride);
        }
        let bits = map(&skipped, |skipped: f64x4| skipped.to_bitmask());
        for (lane, skipped) in self.skipped[first..first + LANES].iter_mut().enumerate() {
            *skipped = (0..D).fold(0, |all, a| all | ((bits[a] >> lane & 1) as u8) << a);
        }
    }

    /// Weights of `particles`, one after the other.
    #[inline(always)]
    fn fill_rest<S: Shape, const K: usize, const D: usize>(
        &mut self,
        at: &Places<'_, D>,
        particles: Range<usize>,
        corners: &mut Corners<D>,
    ) {
        let nodes = const { K * lines(K, D) };
        let (from, stride) = (particles.start, self.stride);
        self.skipped[particles.clone()].fill(0);
        // chunks, so that there are no bounds checks
        let weights = self.values[from * nodes..]
            .chunks_exact_mut(nodes)
            .zip(self.gradients[from * nodes * D..].chunks_exact_mut(nodes * D));
        let windows = self.first[particles.clone()].iter_mut().zip(weights);
        for ((particle, cell), (first, (values, gradients))) in
            particles.clone().zip(&at.cells[particles]).zip(windows)
        {
            let (from, length) = at.weights::<S, K>(particle, values, gradients);
            if K > NARROW {
                self.narrow[particle] = S::nodes(length) <= NARROW;
            }
            let corner: [i32; D] = from_fn(|a| cell[a] + from[a] - at.lower[a]);
            corners.extend(corner);
            *first = index(corner, stride);
        }
    }
}

/// Of the first four particles in `numbers`, each with `N` parts of `nodes` numbers, the part `part`:
/// values have one part, gradients one for each direction.
#[inline(always)]
fn parts_of_four<const N: usize>(
    numbers: &mut [f64],
    nodes: usize,
    part: usize,
) -> [&mut [f64]; LANES] {
    let mut all = numbers.chunks_exact_mut(N * nodes);
    from_fn(|_| {
        let window = all.next().expect("those of four particles");
        &mut window[part * nodes..(part + 1) * nodes]
    })
}

impl<const D: usize> Places<'_, D> {
    /// Writes the weights of four particles from `first` on, in a plane.
    #[inline(always)]
    fn four<S: Shape, const K: usize>(&self, first: usize, w: &mut PlaneLanes<K>) {
        let place = map(&self.fractions, |column| four(column, first));
        let inverse = map(&self.inverse_cell, f64x4::splat);
        let half_edges = S::EXTENT.half_edges(|k| four(self.domains[k], first));
        S::four_in_plane::<K>([place[0], place[D - 1]], half_edges, w);
        for (axis, lines) in w.gradients.iter_mut().enumerate() {
            let inverse = inverse[axis * (D - 1)];
            lines.as_flattened_mut().iter_mut().for_each(|g| *g *= inverse);
        }
    }

    /// Whether four particles from `first` on have weights on at most [`NARROW`] nodes along each
    /// direction.
    #[inline(always)]
    fn are_narrow<S: Shape>(&self, first: usize) -> bool {
        let [width, height] = extents(S::EXTENT.half_edges(|k| four(self.domains[k], first)));
        let longest = width.max(height).to_array();
        longest.into_iter().all(|length| S::nodes(length) <= NARROW)
    }

    /// Writes the values and gradients of a particle; returns its first node along each direction,
    /// relative to the lower node of its cell, and its longest extent [cells].
    #[inline(always)]
    fn weights<S: Shape, const K: usize>(
        &self,
        particle: usize,
        values: &mut [f64],
        gradients: &mut [f64],
    ) -> ([i32; D], f64) {
        let nodes = const { K * lines(K, D) };
        let place = map(&self.fractions, |column| column[particle]);
        if D == 1 {
            let length = self.domains[0][particle];
            let w: Weights<K> = S::weights(place[0], length);
            values.copy_from_slice(&w.values);
            for (out, g) in gradients.iter_mut().zip(w.gradients) {
                *out = g * self.inverse_cell[0];
            }
            return ([w.first; D], length);
        }
        let domain = ParticleDomain::from_columns(S::EXTENT, &self.domains, particle);
        let (gx, gy) = gradients.split_at_mut(nodes);
        let mut lines = Plane {
            values: values.as_chunks_mut::<K>().0,
            gradients: [gx.as_chunks_mut::<K>().0, gy.as_chunks_mut::<K>().0],
        };
        let [width, height] = domain.extent();
        let (place, length) = ([place[0], place[D - 1]], width.max(height));
        let corner = match K > NARROW && S::nodes(length) <= NARROW {
            true => lines.fill_first::<S, NARROW>(place, &domain),
            false => S::plane(place, &domain, &mut lines),
        };
        gx.iter_mut().for_each(|g| *g *= self.inverse_cell[0]);
        gy.iter_mut().for_each(|g| *g *= self.inverse_cell[D - 1]);
        (from_fn(|a| corner[a]), length)
    }
}

/// Index of a node in arrays with lines of `stride` nodes.
#[inline(always)]
fn index<const D: usize>(node: [i32; D], stride: usize) -> u32 {
    match D {
        1 => node[0] as u32,
        _ => (node[0] + stride as i32 * node[D - 1]) as u32,
    }
}
