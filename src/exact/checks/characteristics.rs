//! The method of characteristics. The flyer behind its shock is homentropic, and the target behind
//! its shock is a simple wave. Both Riemann invariants u +- I, I = int C dchi, are therefore
//! constant along their characteristics. The net consists of the fan's characteristics and of their
//! reflections from the interface. It is valid until a wave in the flyer steepens into a shock, or
//! the fan catches the target's shock. When the pressure on the interface would fall below 0, the
//! plates separate, and the flyer's face is free from then on.

use crate::exact::{Impact, Profile, ProfilePoint};
use crate::material::{EquationOfState, MieGruneisen};

/// An isentrope, tabulated at equal steps of compression, in ascending order.
pub(super) struct Isentrope {
    /// Compression chi = 1 - rho0/rho [-].
    pub chi: Vec<f64>,
    /// Pressure [Pa].
    pub p: Vec<f64>,
    /// Lagrangian sound speed [m/s].
    pub c: Vec<f64>,
    /// Specific internal energy [J/kg].
    pub e: Vec<f64>,
    /// I, 0 at the top [m/s].
    pub i: Vec<f64>,
}

const ENTRIES: usize = 20_000;

impl Isentrope {
    /// The isentrope from the state behind a shock of velocity jump `up` [m/s] to a tension of
    /// chi = -0.08.
    pub fn new(m: &MieGruneisen, up: f64) -> Isentrope {
        let us = m.c0 + m.s * up;
        let (top, e_top) = (up / us, 0.5 * up * up);
        let d = -(top + 0.08) / ENTRIES as f64;
        let pressure = |chi: f64, e: f64| m.pressure(1.0 - chi, e);
        let speed = |chi: f64, p: f64| ((m.cold_slope(chi) + m.gamma0 * p) / m.rho0).sqrt();
        let mut out = Isentrope { chi: vec![], p: vec![], c: vec![], e: vec![], i: vec![] };
        let (mut e, mut i) = (e_top, 0.0);
        for k in 0..=ENTRIES {
            let chi = top + d * k as f64;
            let p = pressure(chi, e);
            for (list, value) in [
                (&mut out.chi, chi),
                (&mut out.p, p),
                (&mut out.c, speed(chi, p)),
                (&mut out.e, e),
                (&mut out.i, i),
            ] {
                list.push(value);
            }
            // mid-point rule: de = p dchi/rho0
            let e_half = e + 0.5 * d * p / m.rho0;
            let p_half = pressure(chi + 0.5 * d, e_half);
            e += d * p_half / m.rho0;
            i += d * speed(chi + 0.5 * d, p_half);
        }
        for list in [&mut out.chi, &mut out.p, &mut out.c, &mut out.e, &mut out.i] {
            list.reverse();
        }
        out
    }

    /// Interpolates the column `wanted` at the value `at` of the column `key`.
    pub fn read(key: &[f64], wanted: &[f64], at: f64) -> f64 {
        let k = key.partition_point(|&v| v < at).clamp(1, key.len() - 1);
        let w = (at - key[k - 1]) / (key[k] - key[k - 1]);
        wanted[k - 1] + w * (wanted[k] - wanted[k - 1])
    }

    fn c(&self, i: f64) -> f64 {
        Self::read(&self.i, &self.c, i)
    }
}

/// A point of the net: time, Lagrangian position, Lagrangian sound speed.
#[derive(Clone, Copy)]
struct Node {
    t: f64,
    x: f64,
    c: f64,
}

/// State of the interface when one of the fan's characteristics arrives there.
#[derive(Clone, Copy)]
pub struct Arrival {
    /// Time [s].
    pub t: f64,
    /// Pressure [Pa]; negative at the arrival that separates the plates, 0 afterwards.
    pub p: f64,
    /// I in the target [m/s]: its face moves at u2 + I.
    pub in_target: f64,
    /// Velocity of the flyer's face [m/s].
    pub flyer_face: f64,
}

/// The interface until the time `last` [s], from `n` characteristics in the fan.
pub fn interface(impact: &Impact, last: f64, n: usize) -> Vec<Arrival> {
    let release = impact.release(4).unwrap();
    let flyer = impact.flyer.material;
    let (u2, l) = (release.states[0].u, impact.thickness());
    let in_flyer = Isentrope::new(&flyer, impact.speed - u2);
    let in_target = Isentrope::new(&impact.target.material, u2);
    let free = Isentrope::read(&in_flyer.p, &in_flyer.i, 0.0);
    let s0 = u2;
    let free_target = Isentrope::read(&in_target.p, &in_target.i, 0.0);
    let corner = |r: f64| Node { t: release.rear_time, x: -l, c: in_flyer.c(0.5 * (r - s0)) };
    // invariants of the left-going characteristics, and the points on the last right-going one
    let mut s: Vec<f64> = Vec::new();
    let mut row: Vec<Node> = Vec::new();
    let mut arrivals: Vec<Arrival> = Vec::new();
    let mut parted = false;
    for j in 0.. {
        let first = j as isize - n as isize - 1;
        let (r, mut node, from) = if first < 0 {
            let r = s0 + 2.0 * free * j as f64 / n as f64;
            (r, corner(r), 0)
        } else {
            // a left-going characteristic has returned to the free rear
            let i = first as usize;
            let (r, before) = (s[i] + 2.0 * free, row[i]);
            let c = in_flyer.c(free);
            let t = before.t + (before.x + l) / (0.5 * (before.c + c));
            (r, Node { t, x: -l, c }, i + 1)
        };
        let mut next = vec![node; from];
        for i in from..j {
            let before = row[i];
            let c = in_flyer.c(0.5 * (r - s[i]));
            let (plus, minus) = (0.5 * (node.c + c), 0.5 * (before.c + c));
            let t = (before.x - node.x + plus * node.t + minus * before.t) / (plus + minus);
            assert!(t >= node.t && t >= before.t, "a wave has steepened");
            node = Node { t, x: node.x + plus * (t - node.t), c };
            next.push(node);
        }
        // the interface: r - I_flyer(p) = u2 + I_target(p)
        let (mut low, mut high) = (in_target.p[0].max(in_flyer.p[0]), 1.1 * release.states[0].p);
        for _ in 0..60 {
            let p = 0.5 * (low + high);
            let i_f = Isentrope::read(&in_flyer.p, &in_flyer.i, p);
            let i_t = Isentrope::read(&in_target.p, &in_target.i, p);
            if r - i_f > u2 + i_t { low = p } else { high = p }
        }
        let p = if parted { 0.0 } else { low };
        parted |= low < 0.0;
        let (i_f, in_target) = if parted {
            (free, free_target)
        } else {
            let i_f = Isentrope::read(&in_flyer.p, &in_flyer.i, low);
            (i_f, r - i_f - u2)
        };
        let c = in_flyer.c(i_f);
        let t = node.t - node.x / (0.5 * (node.c + c));
        next.push(Node { t, x: 0.0, c });
        s.push(r - 2.0 * i_f);
        row = next;
        arrivals.push(Arrival { t, p, in_target, flyer_face: r - i_f });
        if t > last {
            break;
        }
    }
    arrivals
}

/// The target's profiles at `times`, from `n` characteristics in the fan.
pub fn target(impact: &Impact, times: &[f64], n: usize) -> Vec<Profile> {
    let last = times.iter().fold(0.0, |a: f64, &b| a.max(b));
    let sent: Vec<(f64, f64)> =
        interface(impact, last, n).iter().map(|q| (q.t, q.in_target)).collect();
    let release = impact.release(4).unwrap();
    let (u2, rho0) = (release.states[0].u, impact.target.material.rho0);
    let in_target = Isentrope::new(&impact.target.material, u2);
    let profile = |&time: &f64| {
        // Lagrangian position and I in the target, backwards from the shock
        let mut points = vec![(release.target_shock * time, 0.0)];
        for pair in sent.windows(2) {
            let ((t, i), (t_next, i_next)) = (pair[0], pair[1]);
            if t > time {
                break;
            }
            points.push((in_target.c(i) * (time - t), i));
            if t_next > time {
                points.push((0.0, i + (i_next - i) * (time - t) / (t_next - t)));
            }
        }
        let mut x = points[0].0;
        let mut out: Vec<ProfilePoint> = vec![];
        let end = impact.target.upper;
        for at in [end, x] {
            out.push(ProfilePoint { x: at, rho: rho0, ..ProfilePoint::default() });
        }
        let mut before: Option<(f64, f64)> = None;
        for (place, i) in points {
            let read = |list: &[f64]| Isentrope::read(&in_target.i, list, i);
            let chi = read(&in_target.chi);
            if let Some((p0, chi0)) = before {
                x -= (p0 - place) * (1.0 - 0.5 * (chi + chi0));
            }
            before = Some((place, chi));
            let (p, e) = (read(&in_target.p), read(&in_target.e));
            out.push(ProfilePoint { x, p, u: u2 + i, rho: rho0 / (1.0 - chi), e });
        }
        out.reverse();
        Profile { points: out }
    };
    times.iter().map(profile).collect()
}
