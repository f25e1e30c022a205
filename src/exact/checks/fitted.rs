//! A finite-volume scheme in Lagrangian coordinates: linear reconstruction, acoustic Riemann
//! solver, Heun's method in time. The flyer's cells are fixed to the material. The target's cells
//! move so that the last face is the shock itself, which is never smeared. The scheme is of second
//! order where the solution is smooth. It starts from the centred fan in the flyer, shortly before
//! the head of the fan reaches the interface.

use super::characteristics::Isentrope;
use crate::exact::{Impact, Profile, ProfilePoint};
use crate::material::{EquationOfState, MieGruneisen};

/// Volume ratio J, velocity, total energy.
type Conserved = [f64; 3];

/// Reconstructed state at a face: pressure, velocity, J, impedance rho0 C.
#[derive(Clone, Copy)]
struct FittedSide {
    p: f64,
    u: f64,
    j: f64,
    z: f64,
}

/// Cells of one plate, each with J, u, E.
struct FittedPlate {
    m: MieGruneisen,
    cells: Vec<Conserved>,
}

impl FittedPlate {
    fn pressure(&self, c: &Conserved) -> f64 {
        self.m.pressure(c[0], c[2] - 0.5 * c[1] * c[1])
    }

    /// The states at both faces of each cell, by van Leer's slopes of p, u and J.
    fn faces(&self) -> Vec<[FittedSide; 2]> {
        let values: Vec<[f64; 3]> =
            self.cells.iter().map(|c| [self.pressure(c), c[1], c[0]]).collect();
        let n = values.len();
        // bounded at kinks, second order in smooth flow
        let limited = |l: f64, r: f64| {
            if l * r > 0.0 { 2.0 * l * r / (l + r) } else { 0.0 }
        };
        (0..n)
            .map(|k| {
                let (l, r) = (&values[k.saturating_sub(1)], &values[(k + 1).min(n - 1)]);
                let half: [f64; 3] = std::array::from_fn(|q| {
                    let (dl, dr) = (values[k][q] - l[q], r[q] - values[k][q]);
                    // one-sided at the ends
                    let d = if k == 0 {
                        dr
                    } else if k + 1 == n {
                        dl
                    } else {
                        limited(dl, dr)
                    };
                    0.5 * d
                });
                [-1.0, 1.0].map(|s| {
                    let [p, u, j]: [f64; 3] = std::array::from_fn(|q| values[k][q] + s * half[q]);
                    let z = self.m.rho0 * self.m.sound_speed_squared(j, p).sqrt() / j;
                    FittedSide { p, u, j, z }
                })
            })
            .collect()
    }
}

/// Pressure and velocity between two sides, by the acoustic Riemann solver.
fn star(l: &FittedSide, r: &FittedSide) -> (f64, f64) {
    let sum = l.z + r.z;
    let p = (r.z * l.p + l.z * r.p + l.z * r.z * (l.u - r.u)) / sum;
    (p, (l.z * l.u + r.z * r.u + l.p - r.p) / sum)
}

/// Flux through a face that is fixed to the material, at pressure p and velocity u.
fn flux(rho0: f64, p: f64, u: f64) -> Conserved {
    [-u, p / rho0, p * u / rho0]
}

struct Discretisation {
    flyer: FittedPlate,
    target: FittedPlate,
    thickness: f64,
    shock: f64,
}

impl Discretisation {
    /// Rates of the cell contents, and the speed of the shock.
    fn rates(&self) -> (Vec<Conserved>, Vec<Conserved>, f64) {
        let (f, t) = (self.flyer.faces(), self.target.faces());
        let (mf, mt) = (&self.flyer.m, &self.target.m);
        let n = t.len();
        // the shock: p + z (u - u*) = rho0 (c0 + s u*) u*
        let last = &t[n - 1][1];
        let b = mt.rho0 * mt.c0 + last.z;
        let c = last.p + last.z * last.u;
        let speed = mt.c0 + mt.s * 2.0 * c / (b + (b * b + 4.0 * mt.rho0 * mt.s * c).sqrt());
        let mut through_f: Vec<Conserved> = Vec::with_capacity(f.len() + 1);
        let rear = &f[0][0];
        through_f.push(flux(mf.rho0, 0.0, rear.u - rear.p / rear.z));
        for pair in f.windows(2) {
            let (p, u) = star(&pair[0][1], &pair[1][0]);
            through_f.push(flux(mf.rho0, p, u));
        }
        let (p, u) = star(&f[f.len() - 1][1], &t[0][0]);
        through_f.push(flux(mf.rho0, p, u));
        let mut through_t: Vec<Conserved> = vec![flux(mt.rho0, p, u)];
        for (k, pair) in t.windows(2).enumerate() {
            let r = &pair[1][0];
            let (p, u) = star(&pair[0][1], r);
            // the face overtakes the material: its state is that to the right of the contact
            let w = speed * (k + 1) as f64 / n as f64;
            let j = r.j - (p - r.p) * mt.rho0 / (r.z * r.z);
            let e = mt.energy_at(r.j, r.p) + 0.5 * (p + r.p) * (r.j - j) / mt.rho0;
            let still = flux(mt.rho0, p, u);
            let carried = [j, u, e + 0.5 * u * u];
            through_t.push(std::array::from_fn(|q| still[q] - w * carried[q]));
        }
        through_t.push([-speed, 0.0, 0.0]);
        let net = |faces: Vec<Conserved>| {
            faces.windows(2).map(|w| std::array::from_fn(|q| w[0][q] - w[1][q])).collect()
        };
        (net(through_f), net(through_t), speed)
    }

    fn step(&mut self, dt: f64) {
        let width = |scheme: &Discretisation| {
            [
                scheme.thickness / scheme.flyer.cells.len() as f64,
                scheme.shock / scheme.target.cells.len() as f64,
            ]
        };
        let before = width(self);
        let (f0, t0, shock0) = (self.flyer.cells.clone(), self.target.cells.clone(), self.shock);
        let (rf, rt, w) = self.rates();
        let (mut rf2, mut rt2, mut w2) = (rf.clone(), rt.clone(), w);
        for round in 0..2 {
            if round == 1 {
                (rf2, rt2, w2) = self.rates();
            }
            self.shock = shock0 + 0.5 * dt * (w + w2);
            let after = width(self);
            let mean = |from: &Conserved, a: &Conserved, b: &Conserved, k: usize| -> Conserved {
                std::array::from_fn(|q| (from[q] * before[k] + 0.5 * dt * (a[q] + b[q])) / after[k])
            };
            for (i, cell) in self.flyer.cells.iter_mut().enumerate() {
                *cell = mean(&f0[i], &rf[i], &rf2[i], 0);
            }
            for (i, cell) in self.target.cells.iter_mut().enumerate() {
                *cell = mean(&t0[i], &rt[i], &rt2[i], 1);
            }
        }
    }

    fn profile(&self, end: f64) -> Profile {
        let m = &self.target.m;
        let width = self.shock / self.target.cells.len() as f64;
        let compressed: f64 = self.target.cells.iter().map(|c| c[0] * width).sum();
        let mut x = self.shock - compressed;
        let mut points: Vec<ProfilePoint> = Vec::new();
        for (cell, faces) in self.target.cells.iter().zip(self.target.faces()) {
            for (side, x) in faces.iter().zip([x, x + cell[0] * width]) {
                let e = m.energy_at(side.j, side.p);
                points.push(ProfilePoint { x, p: side.p, u: side.u, rho: m.rho0 / side.j, e });
            }
            x += cell[0] * width;
        }
        for x in [self.shock, end] {
            points.push(ProfilePoint { x, rho: m.rho0, ..ProfilePoint::default() });
        }
        Profile { points }
    }
}

/// The target's profiles at `times` (ascending), with `n` cells in the flyer and four times as many
/// in the target.
pub fn target(impact: &Impact, times: &[f64], n: usize) -> Vec<Profile> {
    let release = impact.release(4).unwrap();
    let two = &release.states[0];
    let (flyer, target, l) = (impact.flyer.material, impact.target.material, impact.thickness());
    let cell = |j: f64, u: f64, e: f64| [j, u, e + 0.5 * u * u];
    let in_target = cell(target.rho0 / two.rho_target.unwrap(), two.u, two.e_target.unwrap());
    let isentrope = Isentrope::new(&flyer, impact.speed - two.u);
    let mut t = release.rear_time + 0.95 * (release.head_time - release.rear_time);
    let in_flyer = |x: f64| {
        // C = x/t in the fan, between its tail and its head
        let c = ((x + l) / (t - release.rear_time)).clamp(release.flyer_tail, release.flyer_head);
        let read = |list: &[f64]| Isentrope::read(&isentrope.c, list, c);
        cell(1.0 - read(&isentrope.chi), two.u + read(&isentrope.i), read(&isentrope.e))
    };
    let mean = |k: usize| {
        let parts = 16;
        let mut sum = [0.0; 3];
        for q in 0..parts {
            let x = -l + l * (k as f64 + (q as f64 + 0.5) / parts as f64) / n as f64;
            for (s, v) in sum.iter_mut().zip(in_flyer(x)) {
                *s += v / parts as f64;
            }
        }
        sum
    };
    let mut scheme = Discretisation {
        flyer: FittedPlate { m: flyer, cells: (0..n).map(mean).collect() },
        target: FittedPlate { m: target, cells: vec![in_target; 4 * n] },
        thickness: l,
        shock: release.target_shock * t,
    };
    let mut out = Vec::new();
    for &time in times {
        while t < time {
            // the target's cells grow with its shocked part; the speed of a face adds to the sound
            // speed
            let in_flyer = scheme.thickness / n as f64 / release.flyer_head;
            let in_target = scheme.shock / (4 * n) as f64 / (2.0 * release.target_head);
            let dt = (0.45 * in_flyer.min(in_target)).min(time - t);
            scheme.step(dt);
            t += dt;
        }
        out.push(scheme.profile(impact.target.upper));
    }
    out
}
