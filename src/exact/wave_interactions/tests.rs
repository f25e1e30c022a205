use super::*;
use crate::exact::samples::{ALUMINIUM, COPPER};

fn standard() -> Chain {
    Chain::new(COPPER, ALUMINIUM, 1000.0, 0.5e-3, 6).unwrap()
}

#[test]
fn the_documents_states() {
    let want = [
        (2, 690.935777, 12.144294e9),
        (3, 381.871553, 0.0),
        (4, 266.027390, 4.254325e9),
        (5, 150.183228, 0.0),
        (6, 105.014699, 1.616347e9),
    ];
    let chain = standard();
    assert_eq!(chain.states.len(), 7);
    for (number, u, p) in want {
        let s = chain.states[number];
        assert_eq!(s.number, number);
        assert!((s.u - u).abs() < 6e-7, "{number}: u {}", s.u);
        assert!((s.p - p).abs() < 600.0, "{number}: P {}", s.p);
    }
    assert!((chain.states[2].rho_target.unwrap() - 3127.380).abs() < 6e-4);
    assert!((chain.states[2].rho_flyer.unwrap() - 9604.616).abs() < 6e-4);
    assert!(!chain.separates);
}

#[test]
fn the_documents_waves() {
    let chain = standard();
    let waves: Vec<_> = chain.target_waves().collect();
    for (w, speed) in waves.iter().zip([6311.163, 6667.374, 5882.825]) {
        assert!((w.lagrangian_speed - speed).abs() < 6e-4, "{}", w.lagrangian_speed);
    }
    assert!((waves[1].start[0] - 0.227263e-6).abs() < 6e-13);
    // each wave in the flyer ends where the next one starts
    let flyer: Vec<_> = chain.waves.iter().filter(|w| w.plate == Plate::Flyer).collect();
    for (a, b) in flyer.iter().zip(flyer.iter().skip(1)) {
        let end = a.end.unwrap();
        assert!((end[0] - b.start[0]).abs() < 1e-18 && (end[1] - b.start[1]).abs() < 1e-15);
        let ran = a.velocity * (end[0] - a.start[0]);
        assert!((a.start[1] + ran - end[1]).abs() < 1e-15, "{a:?}");
    }
}

#[test]
fn the_black_line_conserves_mass_and_momentum() {
    let chain = standard();
    for t in [0.2e-6, 0.5e-6, 0.9e-6] {
        let points = chain.shock_profile(t).unwrap().points;
        let area = |f: fn(&ProfilePoint) -> f64| -> f64 {
            points.windows(2).map(|w| f(&w[0]) * (w[1].x - w[0].x)).sum()
        };
        let ahead = points.last().unwrap().x;
        assert!((area(|q| q.rho) / (ALUMINIUM.rho0 * ahead) - 1.0).abs() < 1e-12);
        let impulse: f64 = {
            // pressure on the interface: states 2, 4 and 6 in turn
            let t2 = 0.22726294e-6f64.min(t);
            let wave = chain.target_waves().nth(2).unwrap().start[0];
            let t4 = (t.min(wave) - t2).max(0.0);
            let t6 = (t - t2 - t4).max(0.0);
            [t2, t4, t6].iter().zip([2, 4, 6]).map(|(t, k)| t * chain.states[k].p).sum()
        };
        assert!((area(|q| q.rho * q.u) / impulse - 1.0).abs() < 1e-6, "{t}");
        assert!((points[0].x / chain.interface_position(t) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn equal_materials_come_to_rest_and_a_softer_flyer_parts() {
    let equal = Chain::new(COPPER, COPPER, 1000.0, 1e-3, 10).unwrap();
    assert!(!equal.separates && equal.states.len() == 5);
    assert_eq!((equal.states[4].p, equal.states[4].u), (0.0, 0.0));
    assert!((equal.states[2].p - 20.916e9).abs() < 5e5);
    let soft = Chain::new(ALUMINIUM, COPPER, 1500.0, 0.5e-3, 8).unwrap();
    assert!(soft.separates && soft.states[3].u < 0.0 && soft.states.len() == 5);
    assert!(soft.separation_time.unwrap() > 0.0);
    assert!(soft.shock_profile(0.4e-6).unwrap().points[0].p == 0.0);
}

#[test]
fn curves_pass_through_their_states() {
    let (p, u) = (5e9, 100.0);
    assert!((hugoniot_right(&COPPER, centre_right(&COPPER, p, u), u) / p - 1.0).abs() < 1e-13);
    assert!((hugoniot_left(&COPPER, centre_left(&COPPER, p, u), u) / p - 1.0).abs() < 1e-13);
}

#[test]
fn refuses_what_cannot_be() {
    let chain = |speed, thickness| Chain::new(COPPER, ALUMINIUM, speed, thickness, 6);
    for (speed, thickness) in [(0.0, 1e-3), (-5.0, 1e-3), (f64::NAN, 1e-3), (1e3, 0.0), (1e6, 1e-3)]
    {
        assert!(chain(speed, thickness).is_err());
    }
}
