use super::*;
use crate::exact::samples::{ALUMINIUM, COPPER};

fn plates(flyer: MieGruneisen, target: MieGruneisen, speed: f64) -> Impact {
    let flyer = ImpactBody { material: flyer, lower: -0.5e-3, upper: 0.0, velocity: speed };
    let target = ImpactBody { material: target, lower: 0.0, upper: 8e-3, velocity: 0.0 };
    Impact::new(flyer, target).unwrap()
}

fn solve(impact: &Impact, times: &[f64]) -> Solution {
    impact.solve(times, &[], Accuracy::default()).unwrap()
}

/// Largest relative error in the integrals of mass, momentum and energy.
fn conservation(impact: &Impact, snapshot: &Snapshot) -> f64 {
    let all = &snapshot.profile.as_ref().unwrap().points;
    let target = &snapshot.target.as_ref().unwrap().points;
    // the flyer's points come first, or last if it comes from the right
    let rest = all.len() - target.len();
    let flyer = if impact.mirrored { &all[target.len()..] } else { &all[..rest] };
    let integral = |f: &dyn Fn(&ProfilePoint) -> f64, points: &[ProfilePoint]| -> f64 {
        points.windows(2).map(|w| 0.5 * (f(&w[0]) + f(&w[1])) * (w[1].x - w[0].x)).sum()
    };
    let both = |f: &dyn Fn(&ProfilePoint) -> f64| integral(f, flyer) + integral(f, target);
    let (l, u) = (impact.thickness(), impact.speed);
    let t = impact.target.upper - impact.target.lower;
    let (rf, rt) = (impact.flyer.material.rho0, impact.target.material.rho0);
    let v = impact.target.velocity;
    let energy = |q: &ProfilePoint| q.rho * (q.e + 0.5 * (q.u - v) * (q.u - v));
    println!(
        "{:.3} {:.1e} {:.1e} {:.1e} {:.1e}",
        snapshot.time * 1e6,
        integral(&|q| q.rho, flyer) / (rf * l) - 1.0,
        (integral(&|q| q.rho, target) - rt * t) / (rf * l),
        both(&|q| q.rho * (q.u - v)).abs() / (rf * l * u) - 1.0,
        both(&energy) / (0.5 * rf * l * u * u) - 1.0,
    );
    [
        integral(&|q| q.rho, flyer) / (rf * l) - 1.0,
        (integral(&|q| q.rho, target) - rt * t) / (rf * l),
        both(&|q| q.rho * (q.u - v)).abs() / (rf * l * u) - 1.0,
        both(&energy) / (0.5 * rf * l * u * u) - 1.0,
    ]
    .into_iter()
    .fold(0.0, |a, b| a.max(b.abs()))
}

#[test]
fn mass_momentum_and_energy_are_kept_in_all_three_cases() {
    let lead = MieGruneisen { rho0: 11350.0, c0: 2051.0, s: 1.46, gamma0: 2.77 };
    let cases = [
        (COPPER, ALUMINIUM, 1000.0),
        (COPPER, ALUMINIUM, 5000.0),
        (COPPER, COPPER, 1000.0),
        (lead, lead, 2500.0),
        (ALUMINIUM, COPPER, 1500.0),
        (ALUMINIUM, lead, 300.0),
    ];
    for (flyer, target, speed) in cases {
        let impact = plates(flyer, target, speed);
        let solution = solve(&impact, &[0.05e-6, 0.25e-6, 0.5e-6, 0.7e-6]);
        for snapshot in &solution.snapshots {
            let fault = conservation(&impact, snapshot);
            assert!(fault < 3e-5, "{flyer:?} {speed} {} {fault:e}", snapshot.time);
        }
        assert_eq!(solution.separation_time.is_some(), solution.release.separates);
    }
}

#[test]
fn the_standard_problem_has_its_waves_and_is_cheap() {
    let impact = plates(COPPER, ALUMINIUM, 1000.0);
    let solution = solve(&impact, &[0.2e-6, 0.5e-6, 1e-6]);
    assert!(solution.interactions < 100_000, "{}", solution.interactions);
    let starts = |kind| {
        let wanted = move |p: &&Path| p.plate == Plate::Target && p.kind == kind;
        solution.paths.iter().filter(wanted).map(|p| p.points[0][0]).next().unwrap()
    };
    assert!((starts(PathKind::FanHead) - 0.216613e-6).abs() < 6e-13);
    assert!((starts(PathKind::FanTail) - 0.239995e-6).abs() < 6e-13);
    let marks = solution.snapshots[2].landmarks.unwrap();
    assert!((marks.shock.unwrap() - 6.311163e-3).abs() < 1e-9);
    let states = &solution.release.states;
    let near_face = solution.interface.at(0.3e-6).unwrap();
    assert!((near_face.p / states[2].p - 1.0).abs() < 1e-5);
    assert!((near_face.u / states[2].u - 1.0).abs() < 1e-5);
    // no fan yet: the plateau starts at the interface
    let early = solution.snapshots[0].landmarks.unwrap();
    assert_eq!(early.plateau, Some([early.interface, early.shock.unwrap()]));
    assert!(early.second_plateau.is_none() && marks.second_plateau.is_some());
}

#[test]
fn any_frame_gives_the_same() {
    let here = plates(COPPER, ALUMINIUM, 1000.0);
    let gap = 0.1037e-3;
    let flyer =
        ImpactBody { material: COPPER, lower: 3e-3 + gap, upper: 3.5e-3 + gap, velocity: -950.0 };
    let target = ImpactBody { material: ALUMINIUM, lower: -5e-3, upper: 3e-3, velocity: 50.0 };
    let there = Impact::new(flyer, target).unwrap();
    assert!(there.mirrored && (there.contact_time - 0.1037e-6).abs() < 1e-15);
    let tracers = [
        TracedPoint { plate: Plate::Target, x: 2e-3 },
        TracedPoint { plate: Plate::Flyer, x: 3.25e-3 + gap },
    ];
    let moved = [
        TracedPoint { plate: Plate::Target, x: 1e-3 },
        TracedPoint { plate: Plate::Flyer, x: -0.25e-3 },
    ];
    let (t, later) = (0.5e-6, 0.5e-6 + there.contact_time);
    let a = here.solve(&[t], &moved, Accuracy { wavelets: 60 }).unwrap();
    let b = there.solve(&[later, 0.05e-6], &tracers, Accuracy { wavelets: 60 }).unwrap();
    let (pa, pb) = (a.snapshots[0].target.as_ref(), b.snapshots[0].target.as_ref());
    let (pa, pb) = (&pa.unwrap().points, &pb.unwrap().points);
    assert_eq!(pa.len(), pb.len());
    for (a, b) in pa.iter().zip(pb.iter().rev()) {
        assert!((3e-3 + 50.0 * later - a.x - b.x).abs() < 1e-14);
        assert!((a.p - b.p).abs() < 1e-2 && (50.0 - a.u - b.u).abs() < 1e-8);
    }
    for (a, b) in a.tracers.iter().zip(&b.tracers) {
        for k in 0..50 {
            let since = t * k as f64 / 50.0;
            let (a, b) = (a.at(since).unwrap(), b.at(since + there.contact_time).unwrap());
            assert!((a.p - b.p).abs() < 1.0 && (50.0 - a.u - b.u).abs() < 1e-6);
            let x = 3e-3 + 50.0 * (since + there.contact_time);
            assert!((x - a.x - b.x).abs() < 1e-13);
        }
    }
    // before contact all pressures are 0
    let before = &b.snapshots[1];
    assert!(before.landmarks.is_none());
    assert!(before.profile.as_ref().unwrap().points.iter().all(|q| q.p == 0.0));
}

#[test]
fn a_softer_flyer_parts_on_time() {
    let solution = solve(&plates(ALUMINIUM, COPPER, 1500.0), &[0.5e-6]);
    assert!((solution.separation_time.unwrap() - 0.1566e-6).abs() < 1e-10);
    let snapshot = &solution.snapshots[0];
    let all = &snapshot.profile.as_ref().unwrap().points;
    let target = &snapshot.target.as_ref().unwrap().points;
    let gap = target[0].x - all[all.len() - target.len() - 1].x;
    assert!((gap - 181.9e-6).abs() < 0.2e-6, "{gap}");
    assert_eq!(target[0].p, 0.0);
}

#[test]
fn tracers_follow_the_profile() {
    let impact = plates(COPPER, ALUMINIUM, 1000.0);
    let tracers = [
        TracedPoint { plate: Plate::Target, x: 1e-3 },
        TracedPoint { plate: Plate::Flyer, x: -2e-4 },
    ];
    let times = [0.1e-6, 0.24e-6, 0.4e-6, 0.6e-6];
    let solution = impact.solve(&times, &tracers, Accuracy::default()).unwrap();
    for snapshot in &solution.snapshots {
        for history in &solution.tracers {
            let h = history.at(snapshot.time).unwrap();
            let q = snapshot.profile.as_ref().unwrap().at(h.x).unwrap();
            assert!((h.p - q.p).abs() < 1e-3 * 12e9, "{} {h:?} {q:?}", snapshot.time);
            assert!((h.u - q.u).abs() < 1.0, "{} {h:?} {q:?}", snapshot.time);
        }
    }
    let arrival = solution.tracers[0].points.iter().find(|h| h.p > 0.0).unwrap().t;
    assert!((arrival - 1e-3 / solution.release.target_shock).abs() < 1e-12);
}

#[test]
fn ends_when_the_shock_reaches_the_rear() {
    let flyer = ImpactBody { material: COPPER, lower: -0.5e-3, upper: 0.0, velocity: 1000.0 };
    let target = ImpactBody { material: ALUMINIUM, lower: 0.0, upper: 2e-3, velocity: 0.0 };
    let impact = Impact::new(flyer, target).unwrap();
    let solution = solve(&impact, &[1e-6, 0.3e-6]);
    assert!(solution.snapshots[0].profile.is_none() && solution.snapshots[1].profile.is_some());
    assert!((solution.valid_until - 2e-3 / solution.release.target_shock).abs() < 1e-15);
    assert_eq!(solution.valid_until, impact.valid_until);
}

#[test]
fn refuses_what_cannot_be() {
    let body = |lower, upper, velocity| ImpactBody { material: COPPER, lower, upper, velocity };
    let target = body(0.0, 1e-3, 0.0);
    for flyer in [
        body(-1e-3, 0.0, 0.0),
        body(-1e-3, 0.0, -10.0),
        body(-1e-3, 1e-4, 10.0),
        body(0.0, 0.0, 10.0),
        body(-1e-3, 0.0, f64::NAN),
        body(-1e-3, 0.0, 1e7),
    ] {
        assert!(Impact::new(flyer, target).is_err(), "{flyer:?}");
    }
    let impact = plates(COPPER, ALUMINIUM, 100.0);
    let far = TracedPoint { plate: Plate::Target, x: 1.0 };
    assert!(impact.solve(&[1e-7], &[far], Accuracy::default()).is_err());
    assert!(impact.solve(&[f64::NAN], &[], Accuracy::default()).is_err());
    assert!(impact.solve(&[1e-7], &[], Accuracy { wavelets: 1 }).is_err());
}

/// Number of points of the flyer, whose mass is `mass` [kg/m2].
fn flyer_points(points: &[ProfilePoint], mass: f64) -> usize {
    let mut sum = 0.0;
    let full = points.windows(2).position(|w| {
        sum += 0.5 * (w[0].rho + w[1].rho) * (w[1].x - w[0].x);
        sum > (1.0 - 1e-4) * mass && w[1].x > w[0].x
    });
    // flyer and target each have a point at the contact face
    let mut k = full.unwrap() + 1;
    while sum < (1.0 - 1e-9) * mass && points[k + 1].x - points[k].x < 1e-3 * mass / points[k].rho {
        sum += 0.5 * (points[k].rho + points[k + 1].rho) * (points[k + 1].x - points[k].x);
        k += 1;
    }
    k + 1
}

#[test]
fn the_rear_of_the_target_releases_the_shock() {
    for (flyer, target, speed, thickness) in [
        (COPPER, ALUMINIUM, 1000.0, 2e-3),
        (ALUMINIUM, COPPER, 1500.0, 1e-3),
        (COPPER, COPPER, 3000.0, 0.3e-3),
    ] {
        let body =
            |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
        let impact =
            Impact::new(body(flyer, -0.5e-3, 0.0, speed), body(target, 0.0, thickness, 0.0))
                .unwrap();
        let arrival = impact.valid_until;
        let times: Vec<f64> = (1..8).map(|k| arrival * (0.9 + 0.2 * f64::from(k))).collect();
        let solution = solve(&impact, &times);
        assert!(solution.stopped.is_none());
        let sum = |f: &dyn Fn(&ProfilePoint) -> f64, points: &[ProfilePoint]| -> f64 {
            points.windows(2).map(|w| 0.5 * (f(&w[0]) + f(&w[1])) * (w[1].x - w[0].x)).sum()
        };
        let mass = [flyer.rho0 * 0.5e-3, target.rho0 * thickness];
        for snapshot in &solution.snapshots {
            assert_eq!(snapshot.profile.is_some(), snapshot.time < arrival);
            let points = &snapshot.whole.as_ref().unwrap().points;
            let (a, b) = points.split_at(flyer_points(points, mass[0]));
            let both = |f: &dyn Fn(&ProfilePoint) -> f64| sum(f, a) + sum(f, b);
            let close = |a: f64, b: f64| {
                assert!((a / b - 1.0).abs() < 1e-4, "{speed} {} {a} {b}", snapshot.time)
            };
            close(sum(&|q| q.rho, a), mass[0]);
            close(sum(&|q| q.rho, b), mass[1]);
            close(both(&|q| q.rho * q.u), mass[0] * speed);
            close(both(&|q| q.rho * (q.e + 0.5 * q.u * q.u)), 0.5 * mass[0] * speed * speed);
            let rear = solution.target_rear.at(snapshot.time).unwrap();
            assert!((points.last().unwrap().x - rear.x).abs() < 1e-9 && rear.p == 0.0);
        }
        // directly after the arrival the rear state is released along the isentrope
        let two = super::super::wave::shocked(&target, solution.release.states[0].u);
        let free = super::super::isentrope::to_pressure(&target, two, -1.0, 0.0).unwrap();
        let rear = solution.target_rear.at(1.001 * arrival).unwrap();
        assert!((rear.u / free.u - 1.0).abs() < 1e-5, "{} {}", rear.u, free.u);
    }
}

/// Every path of the x-t diagram continues to the last time, or ends where it meets another path or
/// at the time from which the waves are no longer followed; then the solution states the reason.
#[test]
fn lines_reach_the_end_or_have_a_reason() {
    let tungsten = MieGruneisen { rho0: 19224.0, c0: 4029.0, s: 1.237, gamma0: 1.54 };
    let tantalum = MieGruneisen { rho0: 16654.0, c0: 3414.0, s: 1.201, gamma0: 1.6 };
    let lead = MieGruneisen { rho0: 11350.0, c0: 2051.0, s: 1.46, gamma0: 2.77 };
    let body = |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
    for (flyer, target, speed, thickness, free_rear) in [
        (tungsten, tantalum, 1000.0, [1e-3, 3e-3], true),
        (tungsten, tantalum, 1000.0, [1e-3, 3e-3], false),
        (tungsten, tantalum, 4000.0, [3e-3, 1e-3], true),
        (tungsten, tantalum, 1000.0, [2.8e-3, 1e-3], true),
        (ALUMINIUM, COPPER, 1500.0, [1e-3, 0.7e-3], true),
        (ALUMINIUM, lead, 4200.0, [0.6e-3, 0.5e-3], true),
        (COPPER, COPPER, 500.0, [1e-3, 1e-3], true),
    ] {
        let impact = Impact::new(
            body(flyer, -thickness[0], 0.0, speed),
            body(target, 0.0, thickness[1], 0.0),
        )
        .unwrap();
        let impact = Impact { free_rear, ..impact };
        let end = 2.2 * impact.valid_until.max(thickness[0] / flyer.c0);
        let solution = solve(&impact, &[end]);
        let until = solution.stopped.as_ref().map_or(end, |(t, _)| *t);
        if !free_rear {
            let (t, why) = solution.stopped.as_ref().unwrap();
            assert!(
                (t / impact.valid_until - 1.0).abs() < 1e-12 && *why == ExactError::RearNotFree
            );
        }
        let last = |path: &Path| *path.points.last().unwrap();
        let shock_reaches_rear = |path: &Path| {
            path.plate == Plate::Target
                && path.kind == PathKind::Shock
                && (last(path)[0] / impact.valid_until - 1.0).abs() < 1e-9
        };
        assert!(solution.paths.iter().any(shock_reaches_rear));
        for (k, path) in solution.paths.iter().enumerate() {
            let [t, x] = last(path);
            let meets = |other: &Path| {
                other.points.windows(2).any(|w| {
                    let ([t0, x0], [t1, x1]) = (w[0], w[1]);
                    let inside = t0 <= t * (1.0 + 1e-9) && t <= t1 * (1.0 + 1e-9);
                    let along = if t1 > t0 { (t - t0) / (t1 - t0) } else { 0.0 };
                    inside && (x0 + along * (x1 - x0) - x).abs() < 1e-4 * thickness[1]
                })
            };
            let others = solution.paths.iter().enumerate().filter(|(j, _)| *j != k);
            let ends = path.steepened
                || (t / until - 1.0).abs() < 1e-9
                || others.map(|(_, p)| p).any(meets);
            assert!(ends, "{speed} {:?} {:?} ends at {t} {x}", path.plate, path.kind);
        }
    }
}
