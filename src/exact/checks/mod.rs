//! The true solution by other methods, held against front tracking: characteristics while there
//! is no shock but the first two, a shock-fitted finite-volume scheme at any time.

mod characteristics;
mod fitted;

use super::samples::{ALUMINIUM, COPPER};
use super::score::difference;
use super::{Accuracy, Impact, ImpactBody, Profile};
use crate::material::MieGruneisen;

fn impact(flyer: MieGruneisen, target: MieGruneisen, speed: f64, thickness: f64) -> Impact {
    let body = |material, lower, upper, velocity| ImpactBody { material, lower, upper, velocity };
    Impact::new(body(flyer, -thickness, 0.0, speed), body(target, 0.0, 10e-3, 0.0)).unwrap()
}

fn tracked(impact: &Impact, times: &[f64], wavelets: usize) -> Vec<Profile> {
    let solution = impact.solve(times, &[], Accuracy { wavelets }).unwrap();
    solution.snapshots.into_iter().map(|s| s.target.unwrap()).collect()
}

#[test]
fn tracking_converges_to_the_characteristics() {
    let impact = impact(COPPER, ALUMINIUM, 1000.0, 0.5e-3);
    let times = [0.23e-6, 0.5e-6, 1e-6];
    let exact = characteristics::target(&impact, &times, 1600);
    let errors = |n| -> Vec<f64> {
        tracked(&impact, &times, n).iter().zip(&exact).map(|(a, b)| difference(a, b)).collect()
    };
    let (coarse, default) = (errors(60), errors(Accuracy::default().wavelets));
    println!("{coarse:?} {default:?}");
    for k in 0..3 {
        assert!(default[k] < 3e-6 && coarse[k] / default[k] > 5.0, "{coarse:?} {default:?}");
    }
}

#[test]
fn tracking_converges_to_itself_after_the_catch_up() {
    let impact = impact(COPPER, ALUMINIUM, 1000.0, 0.25e-3);
    let times = [0.8e-6, 1.0e-6, 1.4e-6];
    let exact = tracked(&impact, &times, 960);
    let errors = |n| -> Vec<f64> {
        tracked(&impact, &times, n).iter().zip(&exact).map(|(a, b)| difference(a, b)).collect()
    };
    let (coarse, default) = (errors(60), errors(Accuracy::default().wavelets));
    println!("{coarse:?} {default:?}");
    for k in 0..3 {
        assert!(default[k] < 1e-5 && coarse[k] / default[k] > 3.0, "{coarse:?} {default:?}");
    }
}

#[test]
fn tracking_agrees_with_a_shock_fitted_scheme_after_the_catch_up() {
    let impact = impact(COPPER, ALUMINIUM, 1000.0, 0.25e-3);
    let times = [0.8e-6, 1.2e-6];
    let exact = tracked(&impact, &times, Accuracy::default().wavelets);
    let peak = |p: &Profile| p.points.iter().rev().find(|q| q.p > 0.0).copied().unwrap();
    // L1 difference; distance of the shocks; relative difference of the pressures behind them
    let errors = |cells| -> Vec<[f64; 3]> {
        let one = |(a, b): (&Profile, &Profile)| {
            let (pa, pb) = (peak(a), peak(b));
            [difference(a, b), (pa.x - pb.x).abs(), (pa.p / pb.p - 1.0).abs()]
        };
        fitted::target(&impact, &times, cells).iter().zip(&exact).map(one).collect()
    };
    let (coarse, fine) = (errors(60), errors(120));
    println!("{coarse:?} {fine:?}");
    for k in 0..2 {
        // kinks are what the scheme's L1 norm is slow in; the shock is not
        assert!(fine[k][0] < 2.5e-3 && coarse[k][0] / fine[k][0] > 2.3, "{coarse:?} {fine:?}");
        assert!(fine[k][1] < 5e-9 && fine[k][2] < 1e-5, "{fine:?}");
    }
}
