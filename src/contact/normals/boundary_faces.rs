//! Normals from the faces of the bodies, which the particles at their boundaries carry.
//!
//! At the start each particle at a boundary gets up to two faces: the tangents of the boundary at
//! its points nearest to the particle. They deform with the particle: with the outward normal N0
//! and the distance delta0 from its centre, a face has the normal n ~ F^-T N0 and the distance
//! d = delta0/|F^-T N0|. At a node, faces p of the first body and q of the second face each other
//! with c = -n_p.n_q > 1/2 if they overlap along the contact plane, and
//!
//! ```text
//! S_a = sum_pq c^4 w_p w_q n_p,   S_b = sum_pq c^4 w_p w_q n_q,   w = V N
//! ```
//!
//! are sums over such pairs. The normal is the direction with the widest gap among the mean of both,
//! S_a alone and -S_b alone; the gap is the mean over the pairs, by their weights, of the distances
//! between their faces. A convex corner adds nothing: each of its faces faces only what is opposite
//! to it. In a concave corner that both bodies fill, the pairs form two families more than 45
//! degrees apart, each with its own plane. Where faces face each other but none overlap, bodies pass
//! each other; they touch if the particles overlap widely, as at surfaces of fracture, which carry
//! no faces.

use smallvec::SmallVec;

use super::body_pair::{
    BodyPair, BoundaryPoint, ContactParticle, ContactPlanes, direction, dot, unit,
};
use super::widest_gap::{self, mean, widest};

pub(super) const PLANE_ONLY: bool = false;

pub(super) const USES_FACES: bool = true;

/// Least cosine between a face and the reverse of another for which they face each other.
const FACING: f64 = 0.5;

/// Face of a particle near a node.
#[derive(Clone, Copy)]
struct Face<const D: usize> {
    /// Outward unit normal.
    normal: [f64; D],
    /// Centre of the particle, relative to the node [m].
    centre: [f64; D],
    /// Point of the face nearest to the particle, relative to the node [m].
    foot: [f64; D],
    /// Weight of the particle [cells].
    weight: f64,
    /// Extents against and along its tangent from there, to the edge of the particle or to its other
    /// face [m].
    extent: [f64; 2],
}

/// Least cosine between the normals of two pairs of the same family.
const SAME_FAMILY: f64 = 0.7;

pub(super) fn planes<const D: usize>(
    pair: &BodyPair<'_, D>,
    corners: &mut Vec<BoundaryPoint<D>>,
) -> ContactPlanes<D> {
    let (faces, passing) = match D {
        2 => faces_planes(pair),
        _ => (ContactPlanes::new(), false),
    };
    if !faces.is_empty() {
        return faces;
    }
    let mut planes = widest_gap::planes(pair, corners);
    if passing {
        planes.iter_mut().for_each(|plane| plane.gap += PASSING);
    }
    planes
}

/// Overlap of particles below which bodies pass each other, if faces face each other beside each
/// other [cells].
const PASSING: f64 = 0.25;

/// Least overlap of two faces that face each other, as a fraction of the smaller one.
const OVERLAP: f64 = 0.25;

/// Two faces that face each other.
struct FacePair<const D: usize> {
    /// Indices of the faces of the first and the second body.
    faces: [usize; 2],
    weight: f64,
    /// Unit vector between the normal of the first and the reverse of that of the second.
    normal: [f64; D],
}

/// Contact planes of faces that face each other; empty if there are none, and whether some face
/// each other without an overlap.
fn faces_planes<const D: usize>(pair: &BodyPair<'_, D>) -> (ContactPlanes<D>, bool) {
    let [first, second] = pair.particles.map(faces);
    let mut passing = false;
    let mut left: SmallVec<[FacePair<D>; 64]> = SmallVec::new();
    for (i, p) in first.iter().enumerate() {
        for (k, q) in second.iter().enumerate() {
            let facing = -dot(&p.normal, &q.normal);
            if facing > FACING {
                let normal = unit(std::array::from_fn(|a| p.normal[a] - q.normal[a]));
                // the far faces of thin bodies face away from each other
                if dot(&q.centre, &normal) <= dot(&p.centre, &normal) {
                    continue;
                }
                let overlap = overlap(p, q, &normal);
                if overlap < OVERLAP {
                    passing = true;
                    continue;
                }
                let square = facing * facing;
                let weight = square * square * (p.weight * q.weight) * overlap;
                left.push(FacePair { faces: [i, k], weight, normal });
            }
        }
    }
    let cell = pair.shortest_edge();
    let mut planes = ContactPlanes::new();
    while let Some(heaviest) = heaviest(&left).filter(|_| planes.len() < MOST_PLANES) {
        let mut sums = [[0.0; D]; 2];
        let mut feet = [[0.0; D]; 2];
        let mut total = 0.0;
        left.retain(|pair| {
            let other = dot(&pair.normal, &heaviest) <= SAME_FAMILY;
            if !other {
                let normals = [&first[pair.faces[0]].normal, &second[pair.faces[1]].normal];
                let points = [&first[pair.faces[0]].foot, &second[pair.faces[1]].foot];
                for (sum, point) in feet.iter_mut().zip(points) {
                    (0..D).for_each(|a| sum[a] += pair.weight * point[a]);
                }
                total += pair.weight;
                for (sum, normal) in sums.iter_mut().zip(normals) {
                    (0..D).for_each(|a| sum[a] += pair.weight * normal[a]);
                }
            }
            other
        });
        let outward = sums.map(direction);
        let candidates = [mean(outward), outward[0], outward[1].map(|n| n.map(|x| -x))];
        // extents would close the gap of round bodies over the whole width of the weights
        planes.extend(widest(candidates.into_iter().flatten(), |normal| {
            Some((dot(&feet[1], normal) - dot(&feet[0], normal)) / (total * cell))
        }));
    }
    (planes, passing)
}

/// Faces of a particle at the boundary of its body.
pub struct BoundaryParticle<const D: usize> {
    faces: SmallVec<[Face<D>; 2]>,
}

impl<const D: usize> BoundaryParticle<D> {
    /// Faces of a particle, of which neither place nor volume counts.
    pub fn new(particle: &ContactParticle<D>) -> Self {
        let centred = ContactParticle { place: [0.0; D], ..*particle };
        BoundaryParticle { faces: faces(&[centred]).into_iter().collect() }
    }

    /// Narrowest gap between its faces and those of `other`, whose centre is `away` from its own
    /// \[m\], among faces that face each other across the gap and overlap along it: unit normal
    /// towards the other particle [-] and width [m], negative if the particles overlap.
    pub fn gap_to(&self, other: &Self, away: &[f64; D]) -> Option<([f64; D], f64)> {
        let mut narrowest: Option<([f64; D], f64)> = None;
        for p in &self.faces {
            for q in &other.faces {
                if -dot(&p.normal, &q.normal) <= FACING {
                    continue;
                }
                let normal = unit(std::array::from_fn(|a| p.normal[a] - q.normal[a]));
                let q = Face {
                    centre: *away,
                    foot: std::array::from_fn(|a| away[a] + q.foot[a]),
                    ..*q
                };
                let along = |from: &[f64; D], to: &[f64; D]| dot(to, &normal) - dot(from, &normal);
                // the two faces of a thin piece look away from each other
                let is_across = along(&p.centre, &q.foot) > 0.0 && along(&p.foot, &q.centre) > 0.0;
                let gap = along(&p.foot, &q.foot);
                if is_across
                    && overlap(p, &q, &normal) >= OVERLAP
                    && narrowest.is_none_or(|(_, width)| gap < width)
                {
                    narrowest = Some((normal, gap));
                }
            }
        }
        narrowest
    }
}

/// Component of `v` along the tangent of a line with the normal `normal`.
fn across<const D: usize>(v: &[f64; D], normal: &[f64; D]) -> f64 {
    v[D - 1] * normal[0] - v[0] * normal[D - 1]
}

/// Overlap of two faces along the line normal to `normal`, as a fraction of the shorter one; negative
/// if they are apart.
fn overlap<const D: usize>(p: &Face<D>, q: &Face<D>, normal: &[f64; D]) -> f64 {
    let (first, second) = (across(&p.foot, normal), across(&q.foot, normal));
    // the tangents of faces that face each other are opposite
    let lower = (first - p.extent[0]).max(second - q.extent[1]);
    let upper = (first + p.extent[1]).min(second + q.extent[0]);
    let length = |face: &Face<D>| face.extent[0] + face.extent[1];
    (upper - lower) / length(p).min(length(q))
}

/// Greatest number of planes at a node.
const MOST_PLANES: usize = 2;

/// Normal of the first of the pairs with the greatest weight.
fn heaviest<const D: usize>(pairs: &[FacePair<D>]) -> Option<[f64; D]> {
    let first = pairs.first()?;
    let heavier = |a, b: &'_ FacePair<D>| if b.weight > a { b.weight } else { a };
    let most = pairs.iter().fold(first.weight, heavier);
    pairs.iter().find(|pair| pair.weight == most).map(|pair| pair.normal)
}

/// Faces of particles near a node.
fn faces<const D: usize>(particles: &[ContactParticle<D>]) -> SmallVec<[Face<D>; 16]> {
    let mut faces = SmallVec::new();
    for particle in particles.iter().filter(|particle| particle.faces != [[0.0; 2]; 2]) {
        let [[ax, ay], [bx, by]] = particle.half_edges.map(|edge| [edge[0], edge[D - 1]]);
        let inverse = 1.0 / (ax * by - ay * bx);
        // m with m.a = s and m.b = t; the face is m.x = 1
        let line = |[s, t]: [f64; 2]| [(s * by - t * ay) * inverse, (t * ax - s * bx) * inverse];
        let lines = particle.faces.map(line);
        for (k, m) in lines.into_iter().enumerate().filter(|(_, m)| *m != [0.0; 2]) {
            let square = m[0] * m[0] + m[1] * m[1];
            let normal: [f64; D] = unit(std::array::from_fn(|a| m[a]));
            let from_centre: [f64; D] = std::array::from_fn(|a| m[a] / square);
            let edges = particle.half_edges.iter();
            let half: f64 = edges.map(|edge| across(edge, &normal).abs()).sum();
            let mut extent = [half; 2];
            // the other face: o.x = 1 where the tangent crosses it
            let other: [f64; D] = std::array::from_fn(|a| lines[1 - k][a]);
            let slope = across(&other, &normal);
            let crossing = (1.0 - dot(&other, &from_centre)) / slope.abs();
            let side = usize::from(slope > 0.0);
            if crossing >= 0.0 && crossing < half {
                extent[side] = crossing;
            }
            let foot = std::array::from_fn(|a| particle.place[a] + from_centre[a]);
            let (centre, weight) = (particle.place, particle.volume);
            faces.push(Face { normal, centre, foot, weight, extent });
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particle of half a cell at `place` with a face towards `normal` at the distance `away`.
    fn particle(place: [f64; 2], normal: [f64; 2], away: f64) -> ContactParticle<2> {
        ContactParticle {
            index: 0,
            place,
            half_edges: [[0.25, 0.0], [0.0, 0.25]],
            volume: 0.1,
            faces: [normal.map(|n| 0.25 * n / away), [0.0; 2]],
        }
    }

    fn planes_between(
        first: &[ContactParticle<2>],
        second: &[ContactParticle<2>],
    ) -> ContactPlanes<2> {
        faces_planes(&BodyPair {
            volume: [0.5; 2],
            gradient: [&[0.0; 2]; 2],
            particles: [first, second],
            cell: &[1.0; 2],
        })
        .0
    }

    #[test]
    fn a_face_deforms_with_its_particle() {
        // F shears by 1 along x: the face x + ... of normal (0, 1) stays, that of (1, 0) tilts
        let mut sheared = particle([0.0, 0.0], [0.0, 1.0], 0.25);
        sheared.half_edges = [[0.25, 0.0], [0.25, 0.25]];
        sheared.faces[1] = [1.0, 0.0];
        let found = faces(&[sheared]);
        assert_eq!((found[0].normal, found[0].foot), ([0.0, 1.0], [0.0, 0.25]));
        let half = 0.5f64.sqrt();
        for a in 0..2 {
            assert!((found[1].normal[a] - [half, -half][a]).abs() < 1e-15);
            assert!((found[1].foot[a] - [0.125, -0.125][a]).abs() < 1e-15);
        }
    }

    #[test]
    fn a_corner_on_a_flat_face_has_the_normal_of_the_face() {
        let flat = [-0.75, -0.25, 0.25, 0.75].map(|x| particle([x, -0.25], [0.0, 1.0], 0.25));
        let mut corner = particle([0.25, 0.3], [0.0, -1.0], 0.25);
        corner.faces[1] = [-1.0, 0.0];
        let plane = planes_between(&flat, &[corner])[0];
        assert_eq!(plane.normal, [0.0, 1.0]);
        assert!((plane.gap - 0.05).abs() < 1e-15);
        let back = planes_between(&[corner], &flat)[0];
        assert_eq!(back.normal, [0.0, -1.0]);
    }

    #[test]
    fn faces_that_look_away_have_no_plane() {
        let left = particle([-0.25, 0.0], [-1.0, 0.0], 0.25);
        let right = particle([0.25, 0.0], [1.0, 0.0], 0.25);
        assert!(planes_between(&[left], &[right]).is_empty());
        assert!(planes_between(&[right], &[left]).is_empty());
    }

    #[test]
    fn a_gap_lies_between_faces_that_face_each_other() {
        let lower = particle([0.0, -0.5], [0.0, 1.0], 0.25);
        let upper = particle([0.1, 0.25], [0.0, -1.0], 0.25);
        let gap = |first: &ContactParticle<2>, second: &ContactParticle<2>| {
            let away = [0, 1].map(|a| second.place[a] - first.place[a]);
            BoundaryParticle::new(first).gap_to(&BoundaryParticle::new(second), &away)
        };
        assert_eq!(gap(&lower, &upper), Some(([0.0, 1.0], 0.25)));
        assert_eq!(gap(&upper, &lower), Some(([0.0, -1.0], 0.25)));
        let aside = particle([0.5, 0.25], [0.0, -1.0], 0.25);
        assert_eq!(gap(&lower, &aside), None);
        // two particles of a plate that is one particle thick and bent
        let plate = |place: [f64; 2]| {
            let mut plate = particle(place, [0.0, 1.0], 0.25);
            plate.faces[1] = [0.0, -1.0];
            plate
        };
        assert_eq!(gap(&plate([0.0, 0.0]), &plate([0.3, 0.05])), None);
    }

    #[test]
    fn faces_beside_each_other_have_no_plane() {
        let left = particle([-0.25, 0.25], [1.0, 0.0], 0.25);
        let right = particle([0.25, -0.25], [-1.0, 0.0], 0.25);
        assert!(planes_between(&[left], &[right]).is_empty());
        let lower = particle([-0.25, 0.0], [1.0, 0.0], 0.25);
        assert_eq!(planes_between(&[lower], &[right]).len(), 1);
    }

    #[test]
    fn the_gap_of_a_face_that_is_not_flat_is_the_mean() {
        let floor = [-0.25, 0.25].map(|x| particle([x, -0.25], [0.0, 1.0], 0.25));
        let stairs =
            [(-0.25, 0.35), (0.25, 0.25)].map(|(x, y)| particle([x, y], [0.0, -1.0], 0.25));
        let plane = planes_between(&floor, &stairs)[0];
        assert_eq!(plane.normal, [0.0, 1.0]);
        assert!((plane.gap - 0.05).abs() < 1e-15);
    }

    #[test]
    fn a_corner_that_both_fill_has_two_planes() {
        let floor = particle([0.25, -0.25], [0.0, 1.0], 0.25);
        let wall = particle([-0.25, 0.25], [1.0, 0.0], 0.25);
        let mut corner = particle([0.3, 0.25], [0.0, -1.0], 0.25);
        corner.faces[1] = [-1.0, 0.0];
        let planes = planes_between(&[floor, wall], &[corner]);
        let normals: Vec<_> = planes.iter().map(|plane| plane.normal).collect();
        assert_eq!(normals, [[1.0, 0.0], [0.0, 1.0]]);
        assert!((planes[0].gap - 0.05).abs() < 1e-15 && planes[1].gap.abs() < 1e-15);
    }
}
