//! Tests that wrappers of equations of state forward every method, including those with a default
//! implementation.
//!
//! The wrapped models override every method of their trait with a distinct value, so that a default
//! implementation in a wrapper gives a different number.

use super::{
    Cutoff, EosPoint, EquationOfState, GeneralCutoff, GeneralEos, HistoryEos, LinearPressure,
    Porous, Tait,
};

/// Tension that no pressure of these tests reaches [Pa].
const FAR: f64 = 1e30;

const STATES: [[f64; 2]; 4] = [[0.7, 3.0], [1.0, 0.0], [1.1, -2.0], [1.3, 1e4]];

/// Equation of state linear in e that overrides every method.
#[derive(Clone, Copy)]
struct FixedEos;

impl EquationOfState for FixedEos {
    fn reference_density(&self) -> f64 {
        7.0
    }

    fn linear(&self, jacobian: f64) -> LinearPressure {
        LinearPressure { reference_pressure: 3.0 - jacobian, gruneisen_rho: 0.25 }
    }

    fn sound_speed_squared(&self, jacobian: f64, pressure: f64) -> f64 {
        11.0 * jacobian + pressure
    }

    fn least_pressure(&self) -> f64 {
        -13.0
    }

    fn clamp_tension(&self, pressure: f64) -> f64 {
        0.5 * pressure
    }

    fn check_validity(&self, jacobian: f64, pressure: f64) -> Option<&'static str> {
        (jacobian * pressure > 2.0).then_some("outside")
    }

    fn pressure(&self, jacobian: f64, energy: f64) -> f64 {
        17.0 * jacobian + energy
    }

    fn energy_at(&self, jacobian: f64, pressure: f64) -> f64 {
        19.0 * jacobian + pressure
    }
}

/// Equation of state of any form that overrides every method.
#[derive(Clone, Copy)]
struct OwnGeneral;

impl GeneralEos for OwnGeneral {
    fn reference_density(&self) -> f64 {
        23.0
    }

    fn at(&self, jacobian: f64, energy: f64) -> EosPoint {
        EosPoint { pressure: energy - jacobian, energy_slope: 1.0, sound_speed_squared: 29.0 }
    }

    fn check_validity(&self, jacobian: f64, energy: f64, pressure: f64) -> Option<&'static str> {
        (jacobian + energy + pressure > 2.0).then_some("outside")
    }

    fn energy_at(&self, pressure: f64) -> f64 {
        31.0 + pressure
    }
}

#[test]
fn a_cutoff_out_of_reach_changes_nothing() {
    let limited = Cutoff { eos: FixedEos, tension: FAR };
    assert_eq!(EquationOfState::reference_density(&limited), 7.0);
    assert_eq!(limited.least_pressure(), -13.0);
    for [j, e] in STATES {
        assert_eq!(limited.linear(j), FixedEos.linear(j));
        assert_eq!(limited.sound_speed_squared(j, e), FixedEos.sound_speed_squared(j, e));
        assert_eq!(limited.clamp_tension(e), FixedEos.clamp_tension(e));
        let fault = EquationOfState::check_validity(&FixedEos, j, e);
        assert_eq!(EquationOfState::check_validity(&limited, j, e), fault);
        assert_eq!(limited.pressure(j, e), FixedEos.clamp_tension(FixedEos.pressure(j, e)));
        let energy = EquationOfState::energy_at(&FixedEos, j, e);
        assert_eq!(EquationOfState::energy_at(&limited, j, e), energy);
    }
    let general = GeneralCutoff { eos: OwnGeneral, tension: FAR, rest: 1.0 };
    same(&general, &OwnGeneral);
}

/// Checks that both give the same result for every method of a general equation of state.
#[track_caller]
fn same(one: &impl GeneralEos, other: &impl GeneralEos) {
    assert_eq!(GeneralEos::reference_density(one), GeneralEos::reference_density(other));
    for [j, e] in STATES {
        assert_eq!(GeneralEos::at(one, j, e), GeneralEos::at(other, j, e));
        for p in [-5.0, 0.0, 5.0] {
            assert_eq!(
                GeneralEos::check_validity(one, j, e, p),
                GeneralEos::check_validity(other, j, e, p)
            );
        }
        assert_eq!(GeneralEos::energy_at(one, e), GeneralEos::energy_at(other, e));
    }
}

#[test]
fn a_linear_equation_is_a_general_one_and_one_with_a_history() {
    assert_eq!(GeneralEos::reference_density(&FixedEos), 7.0);
    assert_eq!(HistoryEos::reference_density(&FixedEos), 7.0);
    assert_eq!(HistoryEos::reference_density(&OwnGeneral), 23.0);
    for [j, e] in STATES {
        let LinearPressure { reference_pressure: cold, gruneisen_rho } = FixedEos.linear(j);
        let p = FixedEos.clamp_tension(cold + gruneisen_rho * e);
        let point = GeneralEos::at(&FixedEos, j, e);
        assert_eq!(
            (point.pressure, point.sound_speed_squared),
            (p, FixedEos.sound_speed_squared(j, p))
        );
        assert_eq!(HistoryEos::at(&FixedEos, j, e, 0.3), (point, 0.3));
        assert_eq!(
            HistoryEos::at(&OwnGeneral, j, e, 0.3),
            (GeneralEos::at(&OwnGeneral, j, e), 0.3)
        );
        let fault = EquationOfState::check_validity(&FixedEos, j, e);
        assert_eq!(GeneralEos::check_validity(&FixedEos, j, 0.0, e), fault);
        assert_eq!(HistoryEos::check_validity(&FixedEos, j, 0.0, 0.0, e), fault);
        let fault = GeneralEos::check_validity(&OwnGeneral, j, e, 0.0);
        assert_eq!(HistoryEos::check_validity(&OwnGeneral, j, e, 9.0, 0.0), fault);
        assert_eq!(
            GeneralEos::energy_at(&FixedEos, e),
            EquationOfState::energy_at(&FixedEos, 1.0, e)
        );
        assert_eq!(
            HistoryEos::energy_at(&FixedEos, e),
            EquationOfState::energy_at(&FixedEos, 1.0, e)
        );
        assert_eq!(HistoryEos::energy_at(&OwnGeneral, e), GeneralEos::energy_at(&OwnGeneral, e));
    }
    assert_eq!((FixedEos.first_history(), OwnGeneral.first_history()), (None, None));
}

#[test]
fn pores_that_are_closed_leave_the_solid() {
    let porous = Porous {
        solid: OwnGeneral,
        distension: 1.5,
        elastic_pressure: 0.0,
        full_compaction_pressure: 1.0,
    };
    assert_eq!(HistoryEos::reference_density(&porous), 23.0 / 1.5);
    assert_eq!(porous.first_history(), Some(1.5));
    for [j, e] in STATES {
        let solid = GeneralEos::at(&OwnGeneral, j * 1.5, e);
        assert_eq!(HistoryEos::at(&porous, j, e, 1.0), (solid, 1.0));
        let fault = GeneralEos::check_validity(&OwnGeneral, j * 1.5, e, 3.0);
        assert_eq!(HistoryEos::check_validity(&porous, j, e, 1.0, 3.0), fault);
        assert_eq!(HistoryEos::energy_at(&porous, e), GeneralEos::energy_at(&OwnGeneral, 1.5 * e));
    }
}

#[test]
fn tait_has_a_sound_speed_with_a_cutoff() {
    let water = Tait { rho0: 998.2, bulk_modulus: 2.193e9, exponent: 7.15 };
    let limited = Cutoff { eos: water, tension: 1e6 };
    let e = GeneralEos::energy_at(&limited, 0.0);
    assert_eq!(e, 0.0);
    let point = GeneralEos::at(&limited, 1.0, e);
    assert_eq!(point, GeneralEos::at(&water, 1.0, 0.0));
}
