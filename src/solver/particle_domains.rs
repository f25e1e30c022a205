//! Particle domains: the extent of a particle as the shape functions use it, and its reach.
//!
//! Parallelograms are computed for several particles at a time, each operation for all of them
//! before the next, so that compilers assign one vector lane to each particle.

use std::ops::Range;

use decomp::array::map;

use super::scheme::Scheme;
use crate::shape::{DomainExtent, ParticleDomain};
use crate::solver::patch::{FaultPhase, Patch};

/// Number of particles computed together.
const LANES: usize = 4;

/// Number of particles whose parallelograms are kept at a time if only their extents are needed.
const BLOCK: usize = 128;

/// Values of `particles` in a column, in groups of `L`.
#[inline(always)]
fn groups_of<'a, const L: usize>(column: &'a [f64], particles: &Range<usize>) -> &'a [[f64; L]] {
    column[particles.clone()].as_chunks().0
}

/// One operation on `L` particles.
#[inline(always)]
fn each<const L: usize>(of: impl Fn(usize) -> f64) -> [f64; L] {
    decomp::array::from_fn(of)
}

/// (1 + l) F, with the components of a tensor row by row.
#[inline(always)]
fn moved_by<const L: usize>(l: &[[f64; L]; 4], f: &[[f64; L]; 4]) -> [[f64; L]; 4] {
    let ([lxx, lxy, lyx, lyy], [xx, xy, yx, yy]) = (l, f);
    [
        each(|r| xx[r] + (lxx[r] * xx[r] + lxy[r] * yx[r])),
        each(|r| xy[r] + (lxx[r] * xy[r] + lxy[r] * yy[r])),
        each(|r| yx[r] + (lyx[r] * xx[r] + lyy[r] * yx[r])),
        each(|r| yy[r] + (lyx[r] * xy[r] + lyy[r] * yy[r])),
    ]
}

/// Raises each of `most` to the corresponding value; NaN is ignored.
#[inline(always)]
fn raise<const L: usize>(most: &mut [f64; L], values: &[f64; L]) {
    for i in 0..LANES {
        most[i] = if values[i] > most[i] { values[i] } else { most[i] };
    }
}

/// Greatest value, at least 0; NaN is ignored.
pub(super) fn greatest(values: &[f64]) -> f64 {
    let mut most = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    chunks.iter().for_each(|chunk| raise(&mut most, chunk));
    rest.iter().chain(&most).copied().fold(0.0, f64::max)
}

/// Columns from which the parallelograms of particles are computed.
struct Strained<'a> {
    /// Deformation gradient F [-].
    deformation: [&'a [f64]; 4],
    /// Velocity gradient [1/s] and the time [s] by which it extrapolates F.
    ahead: Option<([&'a [f64]; 4], f64)>,
    /// Initial half lengths [m].
    half: [&'a [f64]; 2],
    /// Initial volume [m3] and volume ratio [-].
    volume: [&'a [f64]; 2],
    /// Radial position [m] and velocity [m/s], with axial symmetry.
    radius: Option<[&'a [f64]; 2]>,
    /// Columns of the faces of the bodies, in the coordinates of the half edges.
    faces: Option<&'a [Vec<f64>]>,
}

/// Columns from which the extents of particle domains are computed.
#[expect(clippy::large_enum_variant, reason = "one at a time, on the stack")]
enum Outlines<'a> {
    /// Current lengths: initial volume and volume ratio.
    Length([&'a [f64]; 2]),
    /// Constant lengths: initial volume.
    FirstLength(&'a [f64]),
    /// Boxes of constant size: half lengths [m].
    Boxes([&'a [f64]; 2]),
    /// Deforming domains in a plane.
    Parallelograms(Strained<'a>),
    /// No extent.
    Points,
}

impl<const D: usize> Scheme<D> {
    /// Domains of the own particles [cells] at the volume ratio in column `jacobian`, and their
    /// volume if an edge mask needs it.
    pub(super) fn find_domains(&self, patch: &mut Patch<D>, ahead: f64, jacobian: usize) {
        let c = &self.columns;
        let n = patch.block.own();
        let scale: f64 = self.inverse_cell.iter().product();
        let filled = c.fill_fraction.filter(|&k| k != c.domain);
        for k in filled.into_iter().chain((D == 1).then_some(c.domain)) {
            let [volume0, j, out] = patch
                .block
                .columns
                .get_disjoint_mut([c.volume0, jacobian, k])
                .expect("columns differ");
            out.resize(n, 0.0);
            let (volume0, j, out) = (&volume0[..n], &j[..n], &mut out[..n]);
            match self.extent() {
                DomainExtent::Undeformed if k == c.domain => {
                    (0..n).for_each(|r| out[r] = volume0[r] * scale);
                }
                DomainExtent::Point if k == c.domain => {}
                DomainExtent::Current if D == 1 => {
                    (0..n).for_each(|r| out[r] = self.domain_length(volume0[r] * j[r] * scale));
                }
                _ => (0..n).for_each(|r| out[r] = volume0[r] * j[r] * scale),
            }
        }
        if let (true, Some(filled)) = (D > 1 && self.axisymmetric, filled) {
            let [x, v, out] = patch
                .block
                .columns
                .get_disjoint_mut([c.position, c.velocity, filled])
                .expect("columns differ");
            (0..n).for_each(|r| out[r] /= x[r] + ahead * v[r]);
        }
        if let (Some(half_edges), Some(_)) = (c.half_edges, c.deformation) {
            self.find_parallelograms(patch, half_edges, ahead, jacobian);
        }
        if let (Some(half_lengths), DomainExtent::Undeformed) = (c.half_lengths, self.extent()) {
            for a in 0..D {
                let [half, out] = patch
                    .block
                    .columns
                    .get_disjoint_mut([half_lengths + a, c.domain + a])
                    .expect("differ");
                out.clear();
                out.extend(half.iter().map(|h| 2.0 * h * self.inverse_cell[a]));
            }
        }
    }

    /// Length of the domain on a line of a particle with `length` [cells]: at most twice the
    /// greatest half diagonal that the scene allows. NaN stays NaN.
    #[inline(always)]
    pub(super) fn domain_length(&self, length: f64) -> f64 {
        let most = self.domain_limit.map_or(f64::INFINITY, |limit| 2.0 * limit);
        if length > most { most } else { length }
    }

    /// Parallelograms of the own particles [cells] at the time `ahead` [s] of their state, with the
    /// area of their volume, limited to the length that the scene allows.
    fn find_parallelograms(
        &self,
        patch: &mut Patch<D>,
        half_edges: usize,
        ahead: f64,
        jacobian: usize,
    ) {
        let n = patch.block.own();
        let mut columns: [Vec<f64>; 4] = decomp::array::from_fn(|k| {
            let mut column = std::mem::take(&mut patch.block.columns[half_edges + k]);
            column.resize(n, 0.0);
            column
        });
        let from = self.strained(&patch.block, ahead, jacobian).expect("domains have half lengths");
        self.parallelograms(&from, 0..n, columns.each_mut().map(|column| &mut column[..]));
        let [ax, ay, bx, by] = columns.each_ref().map(|column| &column[..n]);
        let limit = if self.domains_deform() { patch.reach_length } else { f64::INFINITY };
        let torn = |r: usize| extent([ax[r], ay[r]], [bx[r], by[r]]) > limit;
        // no early exit from the loop, which would prevent vectorization
        let particle = match (0..n).fold(false, |any, r| any | torn(r)) {
            true => (0..n).find(|&r| torn(r)),
            false => None,
        };
        for (k, column) in columns.into_iter().enumerate() {
            patch.block.columns[half_edges + k] = column;
        }
        if let Some(particle) = particle {
            self.fault(
                patch,
                FaultPhase::Start,
                particle,
                "it is torn apart within one step".into(),
            );
        }
    }

    /// Input of the parallelograms at the time `ahead` [s] of the particles' state and the volume
    /// ratio in column `jacobian`; `None` if domains do not deform.
    fn strained<'a>(
        &self,
        block: &'a decomp::Block<D>,
        ahead: f64,
        jacobian: usize,
    ) -> Option<Strained<'a>> {
        let c = &self.columns;
        let column = |k: usize| &block.columns[k][..block.own()];
        let tensor = |first: usize| decomp::array::from_fn(|k| column(first + k));
        let (deformation, half) = (c.deformation?, c.half_lengths?);
        let gradient = || tensor(c.velocity_gradient.expect("what deforms has the column"));
        Some(Strained {
            deformation: tensor(deformation),
            ahead: (ahead != 0.0).then(|| (gradient(), ahead)),
            half: [column(half), column(half + 1)],
            volume: [column(c.volume0), column(jacobian)],
            radius: self.axisymmetric.then(|| [column(c.position), column(c.velocity)]),
            faces: c.faces.map(|first| &block.columns[first..first + 4]),
        })
    }

    /// Half edges of `particles` [cells], in the order of their columns, limited to the length that
    /// the scene allows.
    fn parallelograms(
        &self,
        from: &Strained<'_>,
        particles: Range<usize>,
        mut out: [&mut [f64]; 4],
    ) {
        let first = particles.start;
        match (from.ahead.is_some(), from.radius.is_some()) {
            (false, false) => self.whole_parallelograms::<false, false>(from, particles, &mut out),
            (true, false) => self.whole_parallelograms::<true, false>(from, particles, &mut out),
            (false, true) => self.whole_parallelograms::<false, true>(from, particles, &mut out),
            (true, true) => self.whole_parallelograms::<true, true>(from, particles, &mut out),
        }
        if let Some(most) = self.domain_limit {
            let faces = from.faces.into_iter().flatten();
            let has_face = |r: usize| faces.clone().any(|column| column[first + r] != 0.0);
            limit(out, most, has_face);
        }
    }

    fn whole_parallelograms<const AHEAD: bool, const AXIS: bool>(
        &self,
        from: &Strained<'_>,
        particles: Range<usize>,
        out: &mut [&mut [f64]; 4],
    ) {
        let whole = particles.len() - particles.len() % LANES;
        let middle = particles.start + whole;
        let first = out.each_mut().map(|column| &mut column[..whole]);
        self.some_parallelograms::<LANES, AHEAD, AXIS>(from, particles.start..middle, first);
        let last = out.each_mut().map(|column| &mut column[whole..]);
        self.some_parallelograms::<1, AHEAD, AXIS>(from, middle..particles.end, last);
    }

    /// Parallelograms of `particles`, `L` at a time, without a limit of length, written to `out`.
    ///
    /// The ratio of J to det F, from volume relaxation and rounding of the time step, is applied to
    /// the strained directions, weighted by the squares of their strains: material compressed along
    /// one direction only keeps its width, as on a line.
    // inlining would unroll it without a gain
    #[inline(never)]
    fn some_parallelograms<const L: usize, const AHEAD: bool, const AXIS: bool>(
        &self,
        from: &Strained<'_>,
        particles: Range<usize>,
        out: [&mut [f64]; 4],
    ) {
        // all of the same length, so that the bounds are checked only once
        let count = particles.len() / L;
        let groups = |column| &groups_of::<L>(column, &particles)[..count];
        let deformation = from.deformation.map(groups);
        let ahead = from.ahead.filter(|_| AHEAD);
        let gradient = ahead.map(|(gradient, time)| (gradient.map(groups), time));
        let radius = from.radius.filter(|_| AXIS).map(|radius| radius.map(groups));
        let [volume0, jacobian] = from.volume.map(groups);
        let half = from.half.map(groups);
        let mut out = out.map(|column| &mut column.as_chunks_mut::<L>().0[..count]);
        for k in 0..count {
            let mut f = map(&deformation, |column| column[k]);
            let mut time = 0.0;
            if let Some((gradient, ahead)) = &gradient {
                time = *ahead;
                let l = map(gradient, |column| map(&column[k], |l| time * l));
                f = moved_by(&l, &f);
            }
            let mut area: [f64; L] = each(|r| volume0[k][r] * jacobian[k][r]);
            if let Some([x, v]) = radius {
                area = each(|r| area[r] / (x[k][r] + time * v[k][r]));
            }
            let half = map(&half, |column| column[k]);
            let edges = self.parallelogram(f, &area, &half);
            for (column, edge) in out.iter_mut().zip(edges) {
                column[k] = edge;
            }
        }
    }

    /// Half edges [cells] of `L` particles with the deformation gradient `f` [-], `area` [m2] and
    /// the initial half lengths `half` [m].
    #[inline(always)]
    fn parallelogram<const L: usize>(
        &self,
        [xx, xy, yx, yy]: [[f64; L]; 4],
        area: &[f64; L],
        half: &[[f64; L]; 2],
    ) -> [[f64; L]; 4] {
        let q: [f64; L] = each(|r| {
            let determinant = xx[r] * yy[r] - xy[r] * yx[r];
            area[r] / (4.0 * half[0][r] * half[1][r] * determinant)
        });
        // E = (F F^T - 1)/2 and its square
        let ex: [f64; L] = each(|r| 0.5 * (xx[r] * xx[r] + xy[r] * xy[r] - 1.0));
        let ey: [f64; L] = each(|r| 0.5 * (yx[r] * yx[r] + yy[r] * yy[r] - 1.0));
        let es: [f64; L] = each(|r| 0.5 * (xx[r] * yx[r] + xy[r] * yy[r]));
        let sx: [f64; L] = each(|r| ex[r] * ex[r] + es[r] * es[r]);
        let sy: [f64; L] = each(|r| ey[r] * ey[r] + es[r] * es[r]);
        let ss: [f64; L] = each(|r| es[r] * (ex[r] + ey[r]));
        let share: [f64; L] = each(|r| {
            let trace = sx[r] + sy[r];
            // computed in both cases, then selected: no branch
            let share = (q[r] - 1.0) / trace;
            if trace > 0.0 { share } else { 0.0 }
        });
        let ax: [f64; L] = each(|r| 1.0 + share[r] * sx[r]);
        let ay: [f64; L] = each(|r| 1.0 + share[r] * sy[r]);
        let axy: [f64; L] = each(|r| share[r] * ss[r]);
        let rest: [f64; L] = each(|r| (q[r] / (ax[r] * ay[r] - axy[r] * axy[r])).sqrt());
        let [dx, dy] = [self.inverse_cell[0], self.inverse_cell[D - 1]];
        let edge = |half: &[f64; L], x: &[f64; L], y: &[f64; L]| -> [[f64; L]; 2] {
            let scale: [f64; L] = each(|r| rest[r] * half[r]);
            [
                each(|r| scale[r] * (ax[r] * x[r] + axy[r] * y[r]) * dx),
                each(|r| scale[r] * (axy[r] * x[r] + ay[r] * y[r]) * dy),
            ]
        };
        let [first, second] = [edge(&half[0], &xx, &yx), edge(&half[1], &xy, &yy)];
        [first[0], first[1], second[0], second[1]]
    }

    /// Deformation of the own particles [-] after a leapfrog step of `dt` [s], (1 + dt L) F: points
    /// within a particle move with it, by the final velocity gradient and their positions at the
    /// start of the step.
    pub(super) fn deform_forward(&self, patch: &mut Patch<D>, dt: f64) {
        #[inline(never)]
        fn go<const L: usize>(f: [&mut [f64]; 4], l: [&[f64]; 4], dt: f64) {
            let count = l[0].len() / L;
            let mut f = f.map(|column| &mut column.as_chunks_mut::<L>().0[..count]);
            let l = l.map(|column| &column.as_chunks::<L>().0[..count]);
            for k in 0..count {
                let l = map(&l, |column| map(&column[k], |l| dt * l));
                let start = decomp::array::from_fn(|c| f[c][k]);
                for (column, moved) in f.iter_mut().zip(moved_by(&l, &start)) {
                    column[k] = moved;
                }
            }
        }
        let (Some(f), Some(l)) = (self.columns.deformation, self.columns.velocity_gradient) else {
            return;
        };
        let n = patch.block.columns[f].len();
        let at = [f, f + 1, f + 2, f + 3, l, l + 1, l + 2, l + 3];
        let columns = patch.block.columns.get_disjoint_mut(at).expect("columns differ");
        let [xx, xy, yx, yy, lxx, lxy, lyx, lyy] = columns;
        let mut f = [xx, xy, yx, yy].map(|column| &mut column[..]);
        let l = [lxx, lxy, lyx, lyy].map(|column| &column[..n]);
        let whole = n - n % LANES;
        go::<LANES>(f.each_mut().map(|f| &mut f[..whole]), l.map(|l| &l[..whole]), dt);
        go::<1>(f.map(|f| &mut f[whole..]), l.map(|l| &l[whole..]), dt);
    }

    /// Input for the extents of the own particles.
    fn outlines<'a>(&self, block: &'a decomp::Block<D>) -> Outlines<'a> {
        let c = &self.columns;
        let column = |k: usize| &block.columns[k][..block.own()];
        let deforms = self.extent() == DomainExtent::Current && !self.total_lagrangian;
        match c.half_lengths {
            None if self.extent() == DomainExtent::Current && !self.total_lagrangian => {
                Outlines::Length([column(c.volume0), column(c.jacobian)])
            }
            None if D == 1 => Outlines::FirstLength(column(c.volume0)),
            None => Outlines::Points,
            Some(_) if deforms => self
                .strained(block, 0.0, c.jacobian)
                .map_or(Outlines::Points, Outlines::Parallelograms),
            Some(_) if self.extent() == DomainExtent::Point => Outlines::Points,
            Some(half) => Outlines::Boxes([column(half), column(half + 1)]),
        }
    }

    /// Greatest extent along a direction of each of `particles`, at most a block of them [cells].
    fn lengths(&self, from: &Outlines<'_>, particles: Range<usize>) -> [f64; BLOCK] {
        let mut lengths = [0.0; BLOCK];
        let out = &mut lengths[..particles.len()];
        let inverse = [self.inverse_cell[0], self.inverse_cell[D - 1]];
        match from {
            Outlines::Length(volume) => {
                let [volume0, jacobian] = volume.map(|column| &column[particles.clone()]);
                for ((length, v), j) in out.iter_mut().zip(volume0).zip(jacobian) {
                    *length = self.domain_length(v * j * inverse[0]);
                }
            }
            Outlines::FirstLength(volume0) => {
                for (length, v) in out.iter_mut().zip(&volume0[particles]) {
                    *length = v * inverse[0];
                }
            }
            Outlines::Boxes(half) => {
                let [x, y] = half.map(|column| &column[particles.clone()]);
                for ((length, x), y) in out.iter_mut().zip(x).zip(y) {
                    *length = (2.0 * x * inverse[0]).max(2.0 * y * inverse[1]);
                }
            }
            Outlines::Parallelograms(from) => {
                let mut edges = [[0.0; BLOCK]; 4];
                let n = particles.len();
                self.parallelograms(from, particles, edges.each_mut().map(|edges| &mut edges[..n]));
                let [ax, ay, bx, by] = edges.each_ref().map(|edges| &edges[..n]);
                for r in 0..n {
                    out[r] = extent([ax[r], ay[r]], [bx[r], by[r]]);
                }
            }
            Outlines::Points => {}
        }
        lengths
    }

    /// Greatest extent of the domains of all particles of a patch along a direction [cells].
    pub(super) fn longest(&self, block: &decomp::Block<D>) -> f64 {
        let column = |k: usize| &block.columns[self.columns.domain + k][..];
        match (D, self.extent()) {
            (1, _) => greatest(column(0)),
            (_, DomainExtent::Point) => 0.0,
            (_, DomainExtent::Undeformed) => greatest(column(0)).max(greatest(column(1))),
            (_, DomainExtent::Current) => {
                let along = |a: usize| {
                    let (r1, r2) = (column(a).chunks(BLOCK), column(a + 2).chunks(BLOCK));
                    r1.zip(r2).fold(0.0f64, |most, (r1, r2)| {
                        let mut lengths = [0.0; BLOCK];
                        for ((length, r1), r2) in lengths.iter_mut().zip(r1).zip(r2) {
                            *length = 2.0 * (r1.abs() + r2.abs());
                        }
                        most.max(greatest(&lengths))
                    })
                };
                along(0).max(along(1))
            }
        }
    }

    /// Greatest extent of the own particles along a direction [cells].
    #[inline(never)]
    pub(super) fn longest_own(&self, block: &decomp::Block<D>) -> f64 {
        let (from, n) = (self.outlines(block), block.own());
        if matches!(from, Outlines::Points) {
            return 0.0;
        }
        let blocks = (0..n).step_by(BLOCK).map(|first| first..n.min(first + BLOCK));
        blocks.fold(0.0, |most, particles| greatest(&self.lengths(&from, particles)).max(most))
    }

    /// First own particle longer than `limit` [cells] along a direction, and its extent.
    pub(super) fn first_longer(
        &self,
        block: &decomp::Block<D>,
        limit: f64,
    ) -> Option<(usize, f64)> {
        let from = self.outlines(block);
        let mut lengths = (0..block.own())
            .map(|particle| (particle, self.lengths(&from, particle..particle + 1)[0]));
        lengths.find(|(_, length)| *length > limit)
    }
}

/// Greatest extent along a direction of a parallelogram with given half edges.
#[inline(always)]
fn extent(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = ParticleDomain { half_edges: [a, b] }.extent();
    x.max(y)
}

/// Limits parallelograms to `most` [cells]: see [`ParticleDomain::limited_as_rectangle`]. Particles
/// with faces keep the directions of their edges, on which the components of the faces depend.
fn limit(edges: [&mut [f64]; 4], most: f64, has_face: impl Fn(usize) -> bool) {
    let [ax, ay, bx, by] = edges;
    let n = ax.len();
    let (ay, bx, by) = (&mut ay[..n], &mut bx[..n], &mut by[..n]);
    let square = |x: f64, y: f64| x * x + y * y;
    let within = |square: f64| square <= most * most;
    let long = |long: bool, r: usize| {
        let plus = square(ax[r] + bx[r], ay[r] + by[r]);
        let minus = square(ax[r] - bx[r], ay[r] - by[r]);
        long | !within(plus) | !within(minus)
    };
    // in most cases none is too long
    if (0..n).fold(false, long) {
        for r in 0..n {
            let domain = ParticleDomain { half_edges: [[ax[r], ay[r]], [bx[r], by[r]]] };
            let limited = match has_face(r) {
                true => domain.limited(most),
                false => domain.limited_as_rectangle(most),
            };
            [[ax[r], ay[r]], [bx[r], by[r]]] = limited.half_edges;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_is_found_in_any_place_beside_what_is_no_number() {
        assert_eq!(greatest(&[]), 0.0);
        for n in 1..=9 {
            for place in 0..n {
                let mut values = vec![f64::NAN; n];
                values[place] = 2.0;
                values[(place + 5) % n] = if n > 1 && (place + 5) % n != place { 1.0 } else { 2.0 };
                assert_eq!(greatest(&values), 2.0, "{values:?}");
            }
        }
    }

    /// Particles of a patch that are not too long must not change.
    #[test]
    fn long_parallelograms_are_shortened_alone() {
        let short = [0.25, 0.0, 0.0, 0.25];
        let long = [3.0, 0.5, -0.1, 0.25];
        let mut particles: Vec<[f64; 4]> = vec![short; 7];
        particles[3] = long;
        let mut columns: [Vec<f64>; 4] =
            decomp::array::from_fn(|k| particles.iter().map(|r| r[k]).collect());
        limit(columns.each_mut().map(|column| &mut column[..]), 1.0, |_| false);
        let alone =
            ParticleDomain { half_edges: [[3.0, 0.5], [-0.1, 0.25]] }.limited(1.0).half_edges;
        for (r, particle) in particles.iter().enumerate() {
            let found: [f64; 4] = decomp::array::from_fn(|k| columns[k][r]);
            let expected = if r == 3 { alone.as_flattened() } else { &particle[..] };
            assert_eq!(found, expected, "{r}");
        }
    }

    /// The components of a face belong to the directions of the edges.
    #[test]
    fn flat_parallelograms_with_a_face_keep_the_directions_of_their_edges() {
        let flat = ParticleDomain { half_edges: [[3.0, 30.0], [2.0, 21.0]] };
        let mut columns = flat.half_edges.as_flattened().iter().map(|&edge| vec![edge; 2]);
        let mut columns: [Vec<f64>; 4] = decomp::array::from_fn(|_| columns.next().unwrap());
        limit(columns.each_mut().map(|column| &mut column[..]), 0.7, |r| r == 1);
        let found = [0, 1].map(|r| columns.each_ref().map(|column| column[r]));
        let expected = [flat.limited_as_rectangle(0.7), flat.limited(0.7)];
        assert_eq!(
            found.map(|f| f.to_vec()),
            expected.map(|d| d.half_edges.as_flattened().to_vec())
        );
        assert_ne!(found[0], found[1]);
    }
}
