//! Sums between particles and grid over the corners of the particles, for hat functions at the
//! corners in a plane (CPDI): neither weights nor windows of nodes are stored.
//!
//! [`Scheme::by_corners`] says which scenes have them. Each node adds its terms in canonical order of the
//! particles, and for a particle from corner to corner, so that all patches with a node get the same
//! bits.

use std::ops::Range;

use decomp::array::{from_fn, map};
use wide::f64x4;

use super::end_columns::Values;
use super::nodal_sums::EndSums;
use super::scheme::Scheme;
use crate::shape::{
    CornerLanes, DomainExtent, LANES, from_low_bits, integer, padded_width, to_low_bits,
};
use crate::solver::find_weights::{Corners, Places, four};
use crate::solver::packed::WindowPlace;
use crate::solver::patch::Patch;
use crate::solver::summed_fields::{SummedColumns, SummedSlices};

/// Particles whose corners are found together.
const BLOCK: usize = 32;

/// Corners of four particles, one in each lane.
#[derive(Clone, Copy)]
struct FourCorners {
    /// Index in the patch's arrays of the node below and to the left of each corner, written by
    /// [`to_low_bits`].
    nodes: [[f64; LANES]; 4],
    /// Hat functions of the four nodes around each corner [-].
    values: [[[f64; LANES]; 4]; 4],
    /// Gradients from differences of these values between opposite corners, along x and y [1/m]: for
    /// corner 3 minus corner 0, and for corner 1 minus corner 2.
    slopes: [[f64; LANES]; 4],
}

impl FourCorners {
    /// Square of four nodes around a corner of the particle in `lane`.
    #[inline(always)]
    fn place(&self, corner: usize, lane: usize, stride: u32) -> WindowPlace {
        WindowPlace { first: from_low_bits(self.nodes[corner][lane]), stride }
    }

    /// Weights of these nodes.
    #[inline(always)]
    fn values(&self, corner: usize, lane: usize) -> [f64; 4] {
        from_fn(|node| self.values[corner][node][lane])
    }
}

/// Corners of up to [`BLOCK`] particles.
type CornerBlock = [FourCorners; BLOCK / LANES];

/// Block without corners.
fn no_corners() -> CornerBlock {
    let none = [[0.0; LANES]; 4];
    [FourCorners { nodes: none, values: [none; 4], slopes: none }; BLOCK / LANES]
}

/// Least and greatest places of corners along x and y, relative to the first node of the arrays.
struct CornerRange {
    least: [f64x4; 2],
    most: [f64x4; 2],
}

impl CornerRange {
    fn none() -> Self {
        let infinity = f64x4::splat(f64::INFINITY);
        CornerRange { least: [infinity; 2], most: [-infinity; 2] }
    }

    /// Includes four places of four particles.
    #[inline(always)]
    fn add(&mut self, [a, b, c, d]: [[f64x4; 2]; 4]) {
        for k in 0..2 {
            let least = a[k].fast_min(b[k]).fast_min(c[k].fast_min(d[k]));
            let most = a[k].fast_max(b[k]).fast_max(c[k].fast_max(d[k]));
            self.least[k] = self.least[k].fast_min(least);
            self.most[k] = self.most[k].fast_max(most);
        }
    }

    /// First nodes of all squares around corners.
    fn corners<const D: usize>(&self) -> Corners<D> {
        let (least, most) = (map(&self.least, f64x4::to_array), map(&self.most, f64x4::to_array));
        Corners {
            least: from_fn(|a| integer(least[a].into_iter().fold(f64::INFINITY, f64::min))),
            most: from_fn(|a| integer(most[a].into_iter().fold(f64::NEG_INFINITY, f64::max))),
        }
    }
}

/// Writes the corners of `particles` to `block`, in arrays with lines of `stride` nodes, and adds them
/// to `range` if it is `RANGED`.
#[inline(never)]
fn find_corners<const D: usize, const RANGED: bool>(
    at: &Places<'_, D>,
    particles: Range<usize>,
    stride: u32,
    block: &mut CornerBlock,
    range: &mut CornerRange,
) {
    // equal lengths, so that one check is enough for all columns
    let count = at.cells.len();
    let at = Places {
        cells: at.cells,
        fractions: map(&at.fractions, |column: &[f64]| &column[..count]),
        domains: map(&at.domains, |column: &[f64]| &column[..count]),
        ..*at
    };
    for (first, out) in particles.step_by(LANES).zip(block) {
        let places = match first + LANES <= count {
            true => find_four(&at, first, stride, out),
            false => find_last(&at, first, stride, out),
        };
        if RANGED {
            range.add(places);
        }
    }
}

/// Corners of four particles from `first` on; returns the nodes below and to the left of them.
#[inline(always)]
fn find_four<const D: usize>(
    at: &Places<'_, D>,
    first: usize,
    stride: u32,
    out: &mut FourCorners,
) -> [[f64x4; 2]; 4] {
    let axes = [0, D - 1];
    let cells: &[[i32; D]; LANES] = at.cells[first..].first_chunk().expect("four particles");
    let cells =
        map(&axes, |a| f64x4::from(from_fn(|lane| f64::from(cells[lane][a] - at.lower[a]))));
    let corners = CornerLanes {
        fraction: map(&axes, |a| four(at.fractions[a], first)),
        half_edges: DomainExtent::Current.half_edges(|k| four(at.domains[k], first)),
    };
    let stride = f64x4::splat(f64::from(stride));
    let first_node = to_low_bits(cells[0] + stride * cells[1]);
    let mut put = |corner: usize, ([x, y], values): ([f64x4; 2], [f64x4; 4])| {
        out.nodes[corner] = (first_node + x + stride * y).to_array();
        out.values[corner] = map(&values, f64x4::to_array);
        [x + cells[0], y + cells[1]]
    };
    let places = [
        put(0, corners.hats::<0>()),
        put(1, corners.hats::<1>()),
        put(2, corners.hats::<2>()),
        put(3, corners.hats::<3>()),
    ];
    let slopes = corners.slopes();
    out.slopes = from_fn(|k| (slopes[k] * f64x4::splat(at.inverse_cell[axes[k % 2]])).to_array());
    places
}

/// The same of the last particles of a patch, fewer than four: the last one is repeated.
#[cold]
#[inline(never)]
fn find_last<const D: usize>(
    at: &Places<'_, D>,
    first: usize,
    stride: u32,
    out: &mut FourCorners,
) -> [[f64x4; 2]; 4] {
    let particle = |lane: usize| (first + lane).min(at.cells.len() - 1);
    let copy = |column: &[f64]| -> [f64; LANES] { from_fn(|lane| column[particle(lane)]) };
    let cells: [[i32; D]; LANES] = from_fn(|lane| at.cells[particle(lane)]);
    let (fractions, domains) = (map(&at.fractions, copy), map(&at.domains, copy));
    let four = Places {
        cells: &cells,
        fractions: from_fn(|a| &fractions[a][..]),
        domains: from_fn(|k| &domains[k][..]),
        lower: at.lower,
        inverse_cell: at.inverse_cell,
    };
    find_four(&four, 0, stride, out)
}

impl<const D: usize> Scheme<D> {
    /// Whether sums run over the corners of the particles.
    #[inline(always)]
    pub(super) fn sums_corners(&self) -> bool {
        D > 1 && self.by_corners
    }

    /// Places of the particles of a patch.
    fn corner_places<'a>(&self, patch: &'a Patch<D>) -> Places<'a, D> {
        let columns = [self.columns.fraction, self.columns.domain];
        let (block, nodes) = (&patch.block, &patch.nodes);
        Patch::places(block, nodes, DomainExtent::Current, columns, self.inverse_cell)
    }

    /// Mass, momentum and with `force` the internal force of the nodes of a patch, and the nodes within
    /// reach of its particles.
    pub(super) fn scatter_corners(&self, patch: &mut Patch<D>, force: bool) {
        debug_assert!(!self.tensor_stress() && self.forces.is_empty());
        self.clear_sums::<2, false>(patch);
        let stride = patch.nodes.nodes.extent(0) as u32;
        let mut nodes = std::mem::take(&mut patch.corner_nodes);
        let mut fields = self.take_sums(patch);
        let sums = fields.sums();
        let count = sums.mass.len();
        nodes.clear();
        nodes.resize(count, f64x4::ZERO);
        let (mut block, mut range) = (no_corners(), CornerRange::none());
        let (at, of) = (self.corner_places(patch), self.summed_columns(patch, force));
        for run in &patch.runs {
            for first in run.clone().step_by(BLOCK) {
                let particles = first..run.end.min(first + BLOCK);
                find_corners::<D, true>(&at, particles.clone(), stride, &mut block, &mut range);
                for (first, corners) in particles.step_by(LANES).zip(&block) {
                    // each corner has a quarter of the particle
                    let mass = f64x4::load(of.mass, first) * 0.25;
                    let terms = terms(corners, &of, first, mass);
                    for lane in 0..LANES.min(run.end - first) {
                        let m = mass.as_array()[lane];
                        for corner in 0..4 {
                            let place = corners.place(corner, lane, stride);
                            let [a, b, c, d] = corners.values(corner, lane);
                            let [lower, upper] = place.square_mut(&mut sums.mass[..count]);
                            lower[0] += m * a;
                            lower[1] += m * b;
                            upper[0] += m * c;
                            upper[1] += m * d;
                            let term = terms[corner][lane];
                            let [lower, upper] = place.square_mut(&mut nodes[..count]);
                            lower[0] += term * f64x4::splat(a);
                            lower[1] += term * f64x4::splat(b);
                            upper[0] += term * f64x4::splat(c);
                            upper[1] += term * f64x4::splat(d);
                        }
                    }
                }
            }
        }
        let SummedSlices { momentum, force, .. } = sums;
        let mut vectors = momentum.into_iter().chain(force);
        split_components(&nodes, from_fn(|_| vectors.next().expect("two components each")));
        drop(vectors);
        patch.corner_nodes = nodes;
        self.put_sums(patch, fields);
        // not that of the longest particle, which would take a pass over the particles
        let longest = patch.reach_length.min(self.longest_ever());
        let longest = padded_width(self.shape.nodes(longest));
        patch.find_nodes(None, [2, longest as i64], range.corners());
    }

    /// [`Scheme::gather_end`] over the corners of the own particles, four at a time.
    pub(super) fn gather_corners(&self, patch: &mut Patch<D>, dt: f64, steps: [bool; 2]) {
        match steps {
            // as constants they leave no branch in the loop
            [true, true] => self.end_corners(patch, dt, [true, true]),
            steps => self.end_corners(patch, dt, steps),
        }
    }

    #[inline(always)]
    fn end_corners(&self, patch: &mut Patch<D>, dt: f64, [moves, strains]: [bool; 2]) {
        let (stride, own) = (patch.nodes.nodes.extent(0) as u32, patch.block.own());
        let mut nodes = std::mem::take(&mut patch.corner_nodes);
        let f = &self.fields;
        let fields = [f.lumped_velocity, f.velocity_star].map(|k| [k, k + D - 1]);
        let fields = fields.as_flattened();
        join_components(from_fn(|k| &patch.nodes.fields[fields[k]][..]), &mut nodes);
        let mut taken = self.take_ends(patch);
        let mut ends = taken.own(own);
        let (at, mut block) = (self.corner_places(patch), no_corners());
        for first in (0..own).step_by(LANES) {
            if first % BLOCK == 0 {
                let particles = first..own.min(first + BLOCK);
                find_corners::<D, false>(
                    &at,
                    particles,
                    stride,
                    &mut block,
                    &mut CornerRange::none(),
                );
            }
            let sums = end_sums(&block[first % BLOCK / LANES], &nodes, stride);
            ends.put(first, &sums, (self.transfer.update, dt), [moves, strains]);
        }
        self.put_ends(patch, taken);
        patch.corner_nodes = nodes;
    }
}

/// Momentum and force that four particles from `first` on add to the nodes around each corner, times
/// the hat functions there: for each corner and particle two components of each. `mass` is a quarter of
/// the particles' masses [kg].
#[inline(always)]
fn terms<const D: usize>(
    corners: &FourCorners,
    of: &SummedColumns<'_, D>,
    first: usize,
    mass: f64x4,
) -> [[f64x4; LANES]; 4] {
    let [px, py] = [0, D - 1].map(|a| mass * f64x4::load(of.velocity[a], first));
    let [ax, ay, bx, by] = match of.stress.map(|stress| f64x4::load(stress, first)) {
        Some(stress) => map(&corners.slopes, |slopes| f64x4::from(slopes) * stress),
        None => [f64x4::ZERO; 4],
    };
    let opposite = f64x4::from([1.0, 1.0, -1.0, -1.0]);
    let three = f64x4::transpose([px, py, ax, ay]);
    let one = f64x4::transpose([px, py, bx, by]);
    [map(&three, |term| term * opposite), one, map(&one, |term| term * opposite), three]
}

/// Velocities of four particles at the start and the end of the step, and the gradient of the latter,
/// from those of the `nodes`: two components at the start and two at the end [m/s].
#[inline(always)]
fn end_sums<const D: usize>(
    corners: &FourCorners,
    nodes: &[f64x4],
    stride: u32,
) -> EndSums<D, f64x4> {
    let (mut ends, mut differences) = ([f64x4::ZERO; LANES], [f64x4::ZERO; LANES]);
    for lane in 0..LANES {
        let at: [f64x4; 4] = from_fn(|corner| {
            let [a, b, c, d] = map(&corners.values(corner, lane), f64x4::splat);
            let [lower, upper] = corners.place(corner, lane, stride).square(nodes);
            lower[0] * a + lower[1] * b + upper[0] * c + upper[1] * d
        });
        ends[lane] = at[0] + at[1] + at[2] + at[3];
        let [_, _, ax, ay] = (at[3] - at[0]).to_array();
        let [_, _, bx, by] = (at[1] - at[2]).to_array();
        differences[lane] = f64x4::from([ax, ay, bx, by]);
    }
    let ends = map(&f64x4::transpose(ends), |sum| sum * 0.25);
    let differences = f64x4::transpose(differences);
    let slopes = map(&corners.slopes, f64x4::from);
    EndSums {
        start: from_fn(|a| ends[a]),
        star: from_fn(|a| ends[2 + a]),
        gradient: from_fn(|a| {
            from_fn(|b| differences[a] * slopes[b] + differences[2 + a] * slopes[2 + b])
        }),
    }
}

/// Writes the four numbers of each node to four fields.
fn split_components(nodes: &[f64x4], mut fields: [&mut [f64]; 4]) {
    for (k, some) in nodes.chunks(LANES).enumerate() {
        let four = from_fn(|lane| some.get(lane).copied().unwrap_or(f64x4::ZERO));
        for (field, numbers) in fields.iter_mut().zip(f64x4::transpose(four)) {
            numbers.store(field, LANES * k);
        }
    }
}

/// Writes one number of each of four fields to each node.
fn join_components(fields: [&[f64]; 4], nodes: &mut Vec<f64x4>) {
    let count = fields[0].len();
    nodes.resize(count, f64x4::ZERO);
    for (k, some) in nodes.chunks_mut(LANES).enumerate() {
        let four = f64x4::transpose(map(&fields, |field: &[f64]| f64x4::load(field, LANES * k)));
        some.copy_from_slice(&four[..some.len()]);
    }
}
