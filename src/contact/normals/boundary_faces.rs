//! Normals from the faces of the bodies, which the particles at their boundaries carry.
//!
//! At the start each particle at a boundary gets up to two faces: the tangents of the boundary at
//! its points nearest to the particle. They deform with the particle: with the outward normal N0
//! and the distance delta0 from its centre, a face has the normal n ~ F^-T N0 and the distance
//! d = delta0/|F^-T N0|. At a node, faces p of the first body and q of the second face each other
//! with c = -n_p.n_q > 1/2, and
//!
//! ```text
//! S_a = sum_pq c^4 w_p w_q n_p,   S_b = sum_pq c^4 w_p w_q n_q,   w = V N
//! ```
//!
//! are sums over such pairs. The normal is the direction with the widest gap among the mean of both,
//! S_a alone and -S_b alone; the gap is that of the faces. A corner adds nothing: each of its faces
//! faces only what is opposite to it.

use smallvec::SmallVec;

use super::body_pair::{
    BodyPair, BoundaryPoint, ContactParticle, ContactPlane, direction, dot, unit,
};
use super::widest_gap::{self, mean, widest};

pub(super) const PLANE_ONLY: bool = false;

pub(super) const USES_FACES: bool = true;

/// Least cosine between a face and the reverse of another for which they face each other.
const FACING: f64 = 0.5;

/// Least cosine between a face and a direction for which the face bounds its body along it.
const BOUNDING: f64 = 0.7;

/// Face of a particle near a node.
struct Face<const D: usize> {
    /// Outward unit normal.
    normal: [f64; D],
    /// Point of the face nearest to the particle, relative to the node [m].
    foot: [f64; D],
    /// Weight of the particle [cells].
    weight: f64,
}

pub(super) fn plane<const D: usize>(
    pair: &BodyPair<'_, D>,
    corners: &mut Vec<BoundaryPoint<D>>,
) -> Option<ContactPlane<D>> {
    let met = if D == 2 { faces_plane(pair) } else { None };
    met.or_else(|| widest_gap::plane(pair, corners))
}

/// Contact plane of faces that face each other; `None` if there are none.
fn faces_plane<const D: usize>(pair: &BodyPair<'_, D>) -> Option<ContactPlane<D>> {
    let [first, second] = pair.particles.map(faces);
    let (mut sums, mut met) = ([[0.0; D]; 2], false);
    for p in &first {
        for q in &second {
            let facing = -dot(&p.normal, &q.normal);
            if facing > FACING {
                let square = facing * facing;
                let weight = square * square * (p.weight * q.weight);
                for a in 0..D {
                    sums[0][a] += weight * p.normal[a];
                    sums[1][a] += weight * q.normal[a];
                }
                met = true;
            }
        }
    }
    if !met {
        return None;
    }
    let outward = sums.map(direction);
    let candidates = [mean(outward), outward[0], outward[1].map(|n| n.map(|x| -x))];
    let cell = pair.shortest_edge();
    widest(candidates.into_iter().flatten(), |normal| {
        let second = extent(&second, &normal.map(|n| -n))?;
        Some(-(extent(&first, normal)? + second) / cell)
    })
}

/// Faces of particles near a node.
fn faces<const D: usize>(particles: &[ContactParticle<D>]) -> SmallVec<[Face<D>; 16]> {
    let mut faces = SmallVec::new();
    for particle in particles {
        let [[ax, ay], [bx, by]] = particle.half_edges.map(|edge| [edge[0], edge[D - 1]]);
        let inverse = 1.0 / (ax * by - ay * bx);
        for [s, t] in particle.faces {
            if s == 0.0 && t == 0.0 {
                continue;
            }
            // m with m.a = s and m.b = t; the face is m.x = 1
            let m = [(s * by - t * ay) * inverse, (t * ax - s * bx) * inverse];
            let square = m[0] * m[0] + m[1] * m[1];
            let normal = unit(std::array::from_fn(|a| m[a]));
            let foot = std::array::from_fn(|a| particle.place[a] + m[a] / square);
            faces.push(Face { normal, foot, weight: particle.volume });
        }
    }
    faces
}

/// Greatest extent along `normal` of faces that bound their body along it [m].
fn extent<const D: usize>(faces: &[Face<D>], normal: &[f64; D]) -> Option<f64> {
    let bounding = faces.iter().filter(|face| dot(&face.normal, normal) > BOUNDING);
    bounding.map(|face| dot(&face.foot, normal)).reduce(f64::max)
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

    fn pair_plane(
        first: &[ContactParticle<2>],
        second: &[ContactParticle<2>],
    ) -> Option<ContactPlane<2>> {
        faces_plane(&BodyPair {
            volume: [0.5; 2],
            gradient: [&[0.0; 2]; 2],
            particles: [first, second],
            cell: &[1.0; 2],
        })
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
        let plane = pair_plane(&flat, &[corner]).unwrap();
        assert_eq!(plane.normal, [0.0, 1.0]);
        assert!((plane.gap - 0.05).abs() < 1e-15);
        let back = pair_plane(&[corner], &flat).unwrap();
        assert_eq!(back.normal, [0.0, -1.0]);
    }

    #[test]
    fn faces_that_look_away_have_no_plane() {
        let left = particle([-0.25, 0.0], [-1.0, 0.0], 0.25);
        let right = particle([0.25, 0.0], [1.0, 0.0], 0.25);
        assert_eq!(pair_plane(&[left], &[right]), None);
        assert!(pair_plane(&[right], &[left]).is_some());
    }
}
