use super::*;
use crate::exact::samples::{ALUMINIUM, COPPER};
use crate::exact::{Accuracy, Impact, ImpactBody};

fn point(x: f64, p: f64) -> ProfilePoint {
    ProfilePoint { x, p, u: 0.0, rho: 2.0 * p + 1.0, e: 3.0 * p }
}

fn marks() -> Landmarks {
    Landmarks {
        direction: 1.0,
        interface: 0.0,
        far_end: 100.0,
        shock: Some(60.0),
        plateau: Some([20.0, 60.0]),
        p2: 4.0,
        rho2: 9.0,
        e2: 12.0,
        rho2_flyer: f64::NAN,
        e2_flyer: f64::NAN,
        second_plateau: None,
        p4: None,
        behind_shock: 4.0,
    }
}

fn step() -> Profile {
    Profile { points: vec![point(0.0, 4.0), point(60.0, 4.0), point(60.0, 0.0), point(100.0, 0.0)] }
}

fn samples(p: impl Fn(f64) -> f64) -> Vec<ScoreSample> {
    let at = |k: usize| 0.25 + 0.5 * k as f64;
    let one = |x| ScoreSample { x, volume: 0.5, p: p(x), rho: 2.0 * p(x) + 1.0, e: 3.0 * p(x) };
    (0..200).map(|k| one(at(k))).collect()
}

fn close(a: Option<f64>, b: f64, by: f64) {
    assert!((a.unwrap() - b).abs() <= by, "{a:?} {b}");
}

#[test]
fn a_shifted_step() {
    let errors = score(&samples(|x| if x < 62.0 { 4.0 } else { 0.0 }), &step(), &marks(), 1.0);
    // two cells too far, joined by a line half a cell wide
    close(errors.l1, 2.0 / 60.0, 1e-12);
    close(errors.e1_cells, 2.0, 1e-12);
    close(errors.shock_position_cells, 2.0, 1e-12);
    close(errors.rise_cells, 0.4, 1e-12);
    close(errors.plateau, 0.0, 1e-12);
    close(errors.noise, 0.0, 1e-12);
    close(errors.overshoot, 0.0, 1e-12);
    assert_eq!((errors.second_plateau, errors.density_l1), (None, None));
}

#[test]
fn a_mirrored_run_scores_the_same() {
    let run = samples(|x| if x < 59.0 { 4.1 + 0.01 * (3.0 * x).sin() } else { 0.02 * (100.0 - x) });
    let want = score(&run, &step(), &marks(), 1.0);
    let turned: Vec<_> = run.iter().rev().map(|s| ScoreSample { x: 7.0 - s.x, ..*s }).collect();
    let points = step().points.iter().rev().map(|q| ProfilePoint { x: 7.0 - q.x, ..*q }).collect();
    let there = Landmarks {
        direction: -1.0,
        interface: 7.0,
        far_end: -93.0,
        shock: Some(-53.0),
        plateau: Some([-53.0, -13.0]),
        ..marks()
    };
    let got = score(&turned, &Profile { points }, &there, 1.0);
    for (a, b) in [
        (got.l1, want.l1),
        (got.shock_position_cells, want.shock_position_cells),
        (got.rise_cells, want.rise_cells),
        (got.plateau, want.plateau),
        (got.noise, want.noise),
        (got.overshoot, want.overshoot),
        (got.energy_plateau, want.energy_plateau),
    ] {
        close(a, b.unwrap(), 1e-12);
    }
}

#[test]
fn a_crossing_of_signs_is_counted_on_both_sides() {
    let a = [(0.0, -1.0), (2.0, 1.0)];
    let b = [(0.0, 0.0), (2.0, 0.0)];
    let [d1, d2, size, _] = integrals(&a, &b, 0.0, 2.0);
    assert!((d1 - 1.0).abs() < 1e-15 && (d2 - 2.0 / 3.0).abs() < 1e-15 && size == 0.0);
}

#[test]
fn a_plateau_under_eight_cells_is_not_judged() {
    let errors = score(&samples(|_| 4.0), &step(), &marks(), 5.1);
    assert_eq!((errors.plateau, errors.noise, errors.energy_plateau), (None, None, None));
    assert!(score(&[], &step(), &marks(), 1.0).l1.is_none());
    assert!(score(&samples(|_| f64::NAN), &step(), &marks(), 1.0).l1.is_none());
}

#[test]
fn cells_hold_their_particles_mean() {
    let of = |x: f64, volume: f64, p: f64| ScoreSample { x, volume, p, rho: 1.0, e: p };
    let cells = cell_average(&[of(0.2, 1.0, 2.0), of(0.8, 3.0, 6.0), of(1.5, 1.0, 7.0)], 1.0, 0.0);
    assert_eq!(cells.len(), 2);
    assert_eq!((cells[0].p, cells[0].volume, cells[1].p), (5.0, 4.0, 7.0));
    assert!((cells[0].x - 0.65).abs() < 1e-15);
}

/// Exact means of a profile over cells of size `h`, offset from the grid by the fraction `shift` of
/// a cell.
fn exact_cells(profile: &Profile, h: f64, shift: f64) -> Vec<ScoreSample> {
    let (lower, upper) = profile.span().unwrap();
    let (first, last) = ((lower / h).ceil() as i64, (upper / h).floor() as i64 - 1);
    let line: Polyline = profile.points.iter().map(|q| (q.x, q.p)).collect();
    (first..last)
        .map(|k| {
            let from = (k as f64 + shift) * h;
            let p = mean_over(&line, from, from + h).unwrap();
            ScoreSample { x: from + 0.5 * h, volume: h, p, rho: 1.0, e: 1.0 }
        })
        .collect()
}

#[test]
fn standard_problem_floor_and_the_documents_line() {
    let body = |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
    let flyer = body(COPPER, -0.5e-3, 0.0, 1000.0);
    let impact = Impact::new(flyer, body(ALUMINIUM, 0.0, 8e-3, 0.0)).unwrap();
    let solution = impact.solve(&[0.5e-6, 1e-6], &[], Accuracy::default()).unwrap();
    let chain = impact.chain(12).unwrap();
    // the line of Burghardt (2010) is off by 4.4 % and 9.0 %
    for (snapshot, want) in solution.snapshots.iter().zip([0.0445, 0.090]) {
        let marks = snapshot.landmarks.unwrap();
        let line = |p: &Profile| -> Polyline { p.points.iter().map(|q| (q.x, q.p)).collect() };
        let truth = line(snapshot.target.as_ref().unwrap());
        let black = line(&impact.chain_profile(&chain, snapshot.time).unwrap());
        let [d1, _, size, _] = integrals(&black, &truth, marks.interface, marks.far_end);
        close(Some(d1 / size), want, 6e-4);
    }
    // the floor for cells of 0.01 mm; it depends on the position of the shock within its cell
    let last = &solution.snapshots[1];
    let (truth, h) = (last.target.as_ref().unwrap(), 1e-5);
    for (shift, l1, rise) in [(0.1, 0.0013, 0.81), (0.4, 0.0022, 1.5), (0.6, 0.0025, 1.6)] {
        let errors = score(&exact_cells(truth, h, shift), truth, &last.landmarks.unwrap(), h);
        close(errors.l1, l1, 5e-5);
        close(errors.rise_cells, rise, 0.01);
        close(errors.plateau, 0.0, 1e-6);
        close(errors.second_plateau, 0.0, 1e-4);
    }
}
