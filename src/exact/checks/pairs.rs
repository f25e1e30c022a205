//! Impacts of random pairs of materials, compared with an independent integration and bisection.
//!
//! `IMPACT_CASES` sets the number of library pairs (default 3000).

use std::path::Path;

use super::super::{Impact, ImpactBody, Release};
use crate::material::MieGruneisen;

/// Random numbers between 0 and 1 (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A random number whose logarithm is uniformly distributed.
    fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// The state on an isentrope: chi, specific internal energy, velocity.
#[derive(Clone, Copy)]
struct OwnEos {
    chi: f64,
    e: f64,
    u: f64,
}

/// Pressure and its derivative along the isentrope, from the definition of the equation of state.
fn pressure(m: &MieGruneisen, chi: f64, e: f64) -> (f64, f64) {
    let k = m.rho0 * m.c0 * m.c0;
    let (f, slope) = if chi > 0.0 {
        let q = 1.0 - m.s * chi;
        let top = chi - 0.5 * m.gamma0 * chi * chi;
        (k * top / (q * q), k * ((1.0 - m.gamma0 * chi) / (q * q) + 2.0 * m.s * top / (q * q * q)))
    } else {
        (k * chi, k)
    };
    let p = f + m.gamma0 * m.rho0 * e;
    (p, slope + m.gamma0 * p)
}

/// One step of the midpoint rule by `h` in chi.
fn step(m: &MieGruneisen, side: f64, s: OwnEos, h: f64) -> Option<OwnEos> {
    let rate = |chi: f64, e: f64| {
        let (p, slope) = pressure(m, chi, e);
        (slope > 0.0).then(|| (p / m.rho0, side * (slope / m.rho0).sqrt()))
    };
    let (de, _) = rate(s.chi, s.e)?;
    let (de, du) = rate(s.chi + 0.5 * h, s.e + 0.5 * h * de)?;
    Some(OwnEos { chi: s.chi + h, e: s.e + h * de, u: s.u + h * du })
}

/// Follows the isentrope to the pressure `p` by small steps, the last one by bisection. `None` if
/// the sound speed becomes imaginary on the way, or if no state has this pressure.
fn follow(m: &MieGruneisen, side: f64, mut s: OwnEos, p: f64) -> Option<OwnEos> {
    let up = pressure(m, s.chi, s.e).0 < p;
    let h = if up { 1e-4 } else { -1e-4 };
    let past = |s: &OwnEos| (pressure(m, s.chi, s.e).0 >= p) == up;
    for _ in 0..400_000 {
        let next = step(m, side, s, h)?;
        if past(&next) {
            let (mut inside, mut outside) = (0.0, h);
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if past(&step(m, side, s, middle)?) { outside = middle } else { inside = middle }
            }
            return step(m, side, s, inside);
        }
        s = next;
    }
    None
}

/// The velocity at which the two Hugoniots meet, by bisection, and the states there.
fn impedance_match(flyer: &MieGruneisen, target: &MieGruneisen, speed: f64) -> [OwnEos; 2] {
    let p = |m: &MieGruneisen, w: f64| m.rho0 * (m.c0 + m.s * w) * w;
    let (mut low, mut high) = (0.0, speed);
    for _ in 0..200 {
        let u = 0.5 * (low + high);
        if p(target, u) < p(flyer, speed - u) { low = u } else { high = u }
    }
    let state =
        |m: &MieGruneisen, w: f64| OwnEos { chi: w / (m.c0 + m.s * w), e: 0.5 * w * w, u: low };
    [state(flyer, speed - low), state(target, low)]
}

/// Expected result of an impact.
enum ExpectedRelease {
    /// Compression beyond the limit density, or an imaginary sound speed.
    Refused,
    /// State 2 of both plates, and the flyer and the target released to P = 0.
    Solved { two: [OwnEos; 2], free: OwnEos, unloaded: OwnEos },
}

fn expect(flyer: &MieGruneisen, target: &MieGruneisen, speed: f64) -> ExpectedRelease {
    let two = impedance_match(flyer, target, speed);
    let limit = |m: &MieGruneisen| 0.95f64.min(0.95 / m.s);
    if two[0].chi >= limit(flyer) || two[1].chi >= limit(target) {
        return ExpectedRelease::Refused;
    }
    let free = follow(flyer, 1.0, two[0], 0.0);
    let unloaded = follow(target, 1.0, two[1], 0.0);
    match free.zip(unloaded) {
        Some((free, unloaded)) => ExpectedRelease::Solved { two, free, unloaded },
        None => ExpectedRelease::Refused,
    }
}

/// Checks one impact against the expected result; returns whether it is solved and whether the
/// plates separate.
fn check(flyer: MieGruneisen, target: MieGruneisen, speed: f64, thickness: [f64; 2]) -> [bool; 2] {
    let what = format!("{flyer:?} on {target:?} at {speed} m/s, {thickness:?} m");
    let body = |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
    let found =
        Impact::new(body(flyer, -thickness[0], 0.0, speed), body(target, 0.0, thickness[1], 0.0))
            .and_then(|impact| Ok((impact.chain(12)?, impact.release(6)?)));
    let (two, free, unloaded) = match expect(&flyer, &target, speed) {
        ExpectedRelease::Refused => {
            assert!(found.is_err(), "{what}: solved, though it has no solution");
            return [false; 2];
        }
        ExpectedRelease::Solved { two, free, unloaded } => (two, free, unloaded),
    };
    let (chain, release): (_, Release) = found.unwrap_or_else(|e| panic!("{what}: {e}"));
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-5 * speed, "{what}: {a} {b}");
    near(release.states[0].u, two[0].u);
    near(chain.states[2].u, two[0].u);
    near(release.states[1].u, free.u);
    assert!(release.states.iter().all(|s| s.u.is_finite() && s.p.is_finite()), "{what}");
    let four = &release.states[2];
    let gap = free.u - unloaded.u;
    // equal plates come to rest: neither separated nor under pressure
    if gap < -1e-5 * speed {
        assert!(release.separates && four.p == 0.0, "{what}");
        near(four.u, unloaded.u);
    } else if gap > 1e-5 * speed {
        // they may still separate at state 6
        assert!(four.rho_flyer.is_some() && four.p > 0.0, "{what}");
        // the velocities of the two isentropes cross at the pressure of state 4
        let at = |p: f64| {
            let a = follow(&flyer, -1.0, free, p).expect("below state 2");
            let b = follow(&target, 1.0, two[1], p).expect("below state 2");
            a.u - b.u
        };
        let p2 = release.states[0].p;
        let reach = 1e-4 * p2;
        assert!(at(four.p + reach) < 0.0, "{what}");
        assert!(four.p < reach || at(four.p - reach) > 0.0, "{what}");
    }
    [true, release.separates]
}

/// The materials of the library with a straight Hugoniot.
fn library() -> Vec<MieGruneisen> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/materials");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let read = |file: &std::path::PathBuf| {
        let text = std::fs::read_to_string(file).unwrap();
        let material: serde_json::Value = serde_json::from_str(&text).unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let eos = &material["eos"];
        (eos["type"] == "mie_gruneisen" && eos["s2"].is_null()).then(|| MieGruneisen {
            rho0: number(&material["density"]),
            c0: number(&eos["c0"]),
            s: number(&eos["s"]),
            gamma0: number(&eos["gamma0"]),
        })
    };
    files.iter().filter_map(read).collect()
}

#[test]
fn every_pair_of_library_materials_has_its_chain() {
    let cases = std::env::var("IMPACT_CASES").map_or(3000, |n| n.parse().unwrap());
    let materials = library();
    assert!(materials.len() > 15);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut counts = [0; 2];
    for _ in 0..cases {
        let mut one = || materials[(random.next() * materials.len() as f64) as usize];
        let (flyer, target) = (one(), one());
        let speed = random.log(10.0, 1e4);
        let thickness = [random.log(1e-5, 1e-2), random.log(1e-5, 1e-2)];
        let found = check(flyer, target, speed, thickness);
        (0..2).for_each(|k| counts[k] += usize::from(found[k]));
    }
    assert_eq!(counts[0], cases, "all have a solution");
    assert!(counts[1] > cases / 3, "{} part", counts[1]);
}

#[test]
fn made_up_materials_have_their_chain_where_there_is_one() {
    let mut random = Random(0x0123_4567_89ab_cdef);
    let (mut solved, mut parted) = (0, 0);
    for case in 0..600 {
        let mut one = || MieGruneisen {
            rho0: random.log(500.0, 20e3),
            c0: random.log(800.0, 12e3),
            s: 0.7 + 1.8 * random.next(),
            gamma0: 3.2 * random.next(),
        };
        let (mut flyer, mut target) = (one(), one());
        // the softer plate strikes: both rarefactions separate the plates
        if flyer.rho0 * flyer.c0 > target.rho0 * target.c0 {
            (flyer, target) = (target, flyer);
        }
        let speed = if case % 2 == 0 { random.log(4e3, 7e3) } else { random.log(10.0, 1e4) };
        let [is_solved, parts] = check(flyer, target, speed, [1e-3, 5e-3]);
        solved += usize::from(is_solved);
        parted += usize::from(parts);
    }
    assert!(solved >= 500 && parted >= 300, "{solved} {parted}");
}
