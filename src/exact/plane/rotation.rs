//! A spinning body without external forces: its conserved quantities and its angle of rotation.
//!
//! ```text
//! L = sum m (x - c) x v,   E_k = sum m v^2/2,   both kept by a rigid body at omega = L/I
//! ```
//!
//! Any free body conserves its angular momentum L exactly. A deformable body exchanges kinetic
//! energy with strain energy, as its rim pulls outward. It conserves only the sum of the two, so
//! pass that sum to [`loss`]. Each loss of the exact solution is 0.
//!
//! The mean angle is that of the rotation Q closest to the motion, the minimum of
//! sum m |x - c - Q (X - C)|^2 over Q: tan angle = sum m (X - C) x (x - c)/sum m (X - C).(x - c)
//! (Kabsch, 1976, Acta Cryst. A 32, 922, in two dimensions), with c and C the current and the
//! initial centre of mass.

use std::f64::consts::TAU;

use super::{Vector, cross, difference, dot, square};

/// A particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassPoint {
    /// Mass; in plane strain per depth [kg].
    pub mass: f64,
    /// Position [m].
    pub x: Vector,
    /// Velocity [m/s].
    pub v: Vector,
    /// Angular momentum [m2/s] and energy [J/kg] of the particle's own rotation, per unit mass.
    pub spin: [f64; 2],
}

/// Initial and current position of a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// Mass [kg].
    pub mass: f64,
    /// Initial position [m].
    pub reference: Vector,
    /// Current position [m].
    pub position: Vector,
}

/// Velocity at `x` of a rigid body that spins about `centre` at `omega` [rad/s] [m/s].
pub fn rigid_velocity(x: Vector, centre: Vector, omega: f64) -> Vector {
    let [rx, ry] = difference(x, centre);
    [-omega * ry, omega * rx]
}

/// Position at time `t` [m] of the point that was at `x`, in a rigid body that spins about
/// `centre`.
pub fn rigid_position(x: Vector, centre: Vector, omega: f64, t: f64) -> Vector {
    let [rx, ry] = super::turn(difference(x, centre), omega * t);
    [centre[0] + rx, centre[1] + ry]
}

/// Centre of mass [m]; NaN without mass.
pub fn centre_of_mass(points: &[MassPoint]) -> Vector {
    mean(points.iter().map(|q| (q.mass, q.x)))
}

/// Angular momentum about `centre`, counter-clockwise [kg m2/s].
pub fn angular_momentum(points: &[MassPoint], centre: Vector) -> f64 {
    points.iter().map(|q| q.mass * (cross(difference(q.x, centre), q.v) + q.spin[0])).sum()
}

/// Moment of inertia about `centre` [kg m2].
pub fn moment_of_inertia(points: &[MassPoint], centre: Vector) -> f64 {
    points.iter().map(|q| q.mass * square(difference(q.x, centre))).sum()
}

/// Kinetic energy [J].
pub fn kinetic_energy(points: &[MassPoint]) -> f64 {
    points.iter().map(|q| q.mass * (0.5 * square(q.v) + q.spin[1])).sum()
}

/// Kinetic energy of the rigid rotation with the same angular momentum, L^2/(2 I) [J]; the
/// remaining kinetic energy is motion without rotation.
pub fn rotational_energy(points: &[MassPoint], centre: Vector) -> f64 {
    let momentum = angular_momentum(points, centre);
    0.5 * momentum * momentum / moment_of_inertia(points, centre)
}

/// Lost fraction of a conserved quantity, 1 - now/start [-]; negative for a gain.
pub fn loss(start: f64, now: f64) -> f64 {
    1.0 - now / start
}

/// Mean angle of rotation about the centre of mass, in (-pi, pi] [rad]; 0 without points.
pub fn mean_angle(points: &[Turned]) -> f64 {
    let reference = mean(points.iter().map(|q| (q.mass, q.reference)));
    let position = mean(points.iter().map(|q| (q.mass, q.position)));
    let (mut sine, mut cosine) = (0.0, 0.0);
    for q in points {
        let (from, to) = (difference(q.reference, reference), difference(q.position, position));
        sine += q.mass * cross(from, to);
        cosine += q.mass * dot(from, to);
    }
    if sine == 0.0 && cosine == 0.0 { 0.0 } else { sine.atan2(cosine) }
}

/// `angle` plus the number of full revolutions that brings it closest to `expected`, both [rad].
pub fn unwrap_angle(angle: f64, expected: f64) -> f64 {
    angle + TAU * ((expected - angle) / TAU).round()
}

fn mean(points: impl Iterator<Item = (f64, Vector)>) -> Vector {
    let [mut m, mut x, mut y] = [0.0; 3];
    for (mass, place) in points {
        m += mass;
        x += mass * place[0];
        y += mass * place[1];
    }
    [x / m, y / m]
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: Vector = [0.3, -0.2];

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    /// A disk of radius 1 and mass pi about `CENTRE`, at rest, in squares of side `h`.
    fn disk(h: f64) -> Vec<MassPoint> {
        let n = (1.0 / h) as i32 + 1;
        let place = |k: i32| h * (f64::from(k) + 0.5);
        let squares = (-n..n).flat_map(|i| (-n..n).map(move |j| [place(i), place(j)]));
        squares
            .filter(|&x| square(x) < 1.0)
            .map(|[x, y]| MassPoint {
                mass: h * h,
                x: [CENTRE[0] + x, CENTRE[1] + y],
                v: [0.0; 2],
                spin: [0.0; 2],
            })
            .collect()
    }

    fn spinning(h: f64, omega: f64) -> Vec<MassPoint> {
        let spin = |q: MassPoint| MassPoint { v: rigid_velocity(q.x, CENTRE, omega), ..q };
        disk(h).into_iter().map(spin).collect()
    }

    #[test]
    fn a_disk_has_its_textbook_values() {
        use std::f64::consts::PI;
        let points = spinning(0.01, 3.0);
        close(moment_of_inertia(&points, CENTRE), 0.5 * PI, 2e-3);
        close(angular_momentum(&points, CENTRE), 1.5 * PI, 6e-3);
        close(kinetic_energy(&points), 2.25 * PI, 1e-2);
        close(rotational_energy(&points, CENTRE) / kinetic_energy(&points), 1.0, 1e-12);
        let c = centre_of_mass(&points);
        close(c[0], CENTRE[0], 1e-12);
        close(c[1], CENTRE[1], 1e-12);
    }

    #[test]
    fn a_rigid_rotation_loses_nothing() {
        let (omega, t) = (3.0, 2.9);
        let start = spinning(0.1, omega);
        let turned = |q: &MassPoint| {
            let x = rigid_position(q.x, CENTRE, omega, t);
            MassPoint { x, v: rigid_velocity(x, CENTRE, omega), ..*q }
        };
        let now: Vec<_> = start.iter().map(turned).collect();
        let momentum = |p: &[MassPoint]| angular_momentum(p, CENTRE);
        close(loss(momentum(&start), momentum(&now)), 0.0, 1e-13);
        close(loss(kinetic_energy(&start), kinetic_energy(&now)), 0.0, 1e-13);
        // the velocity is the time derivative of the position
        let (q, h) = (start[3], 1e-5);
        let at = |t| rigid_position(q.x, CENTRE, omega, t);
        for k in 0..2 {
            close((at(h)[k] - at(-h)[k]) / (2.0 * h), q.v[k], 1e-8);
        }
    }

    #[test]
    fn a_loss_is_seen() {
        let start = spinning(0.1, 3.0);
        let slow = |q: &MassPoint| MassPoint { v: q.v.map(|v| 0.9 * v), ..*q };
        let now: Vec<_> = start.iter().map(slow).collect();
        let momentum = |p: &[MassPoint]| angular_momentum(p, CENTRE);
        close(loss(momentum(&start), momentum(&now)), 0.1, 1e-13);
        close(loss(kinetic_energy(&start), kinetic_energy(&now)), 0.19, 1e-13);
        // breathing is kinetic energy without rotation: it does not change the angular momentum
        let breathe = |q: &MassPoint| {
            let [rx, ry] = difference(q.x, CENTRE);
            MassPoint { v: [q.v[0] + 0.5 * rx, q.v[1] + 0.5 * ry], ..*q }
        };
        let now: Vec<_> = start.iter().map(breathe).collect();
        close(loss(momentum(&start), momentum(&now)), 0.0, 1e-13);
        let rest = kinetic_energy(&now) - rotational_energy(&now, CENTRE);
        close(rest / kinetic_energy(&start), 0.25 / 9.0, 1e-12);
    }

    #[test]
    fn the_angle_of_a_stretched_and_shifted_body() {
        for angle in [0.0, 1.0, -2.5, 3.1] {
            let turned = |q: &MassPoint| {
                // stretched along the initial axes, then rotated, then shifted
                let stretched = [CENTRE[0] + 1.2 * (q.x[0] - CENTRE[0]), q.x[1]];
                let [x, y] = rigid_position(stretched, CENTRE, angle, 1.0);
                Turned { mass: q.mass, reference: q.x, position: [x + 7.0, y - 3.0] }
            };
            let points: Vec<_> = disk(0.1).iter().map(turned).collect();
            close(mean_angle(&points), angle, 1e-12);
        }
        close(unwrap_angle(0.2, 6.0 * std::f64::consts::PI + 0.3), 0.2 + 3.0 * TAU, 1e-14);
        assert_eq!(unwrap_angle(-0.2, 0.1), -0.2);
        assert_eq!(mean_angle(&[]), 0.0);
    }
}
