//! Plates that meet one after the other, against impedance matching.

use flyer_mpm::driver::output::csv::{CsvTable, read_csv};
use flyer_mpm::exact::ShockFront;
use flyer_mpm::exact::hugoniot::{HugoniotState, isentrope, shock};
use flyer_mpm::material::HistoryEos;
use flyer_mpm::material::constitutive::equation;
use flyer_mpm::scene::Material;

use crate::bounds::effects as bounds;
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// A material at rest or in motion.
pub(super) struct Plate {
    eos: Box<dyn HistoryEos>,
    /// Its state.
    pub state: HugoniotState,
}

impl Plate {
    /// A material of the scene as run, at no pressure.
    pub fn of(run: &Outcome, material: &str, u: f64) -> Option<Plate> {
        let material = run.summary.scene.get("materials")?.get(material)?;
        let material: Material = serde_json::from_value(material.clone()).ok()?;
        let eos = equation(&material).ok()??;
        let state = HugoniotState::at_rest(&*eos, 0.0, u);
        Some(Plate { eos, state })
    }

    /// The shock that brings it to the velocity `u`, either way.
    pub fn shock(&self, u: f64) -> Option<ShockFront> {
        shock(&*self.eos, &self.state, (u - self.state.u).abs()).ok()
    }

    /// Its state at `u` behind that shock.
    pub fn shocked(self, u: f64) -> Option<Plate> {
        let state = HugoniotState { u, ..self.shock(u)?.behind };
        Some(Plate { state, ..self })
    }

    /// Its state where the shock, towards +x, has been released to the volume ratio `jacobian` by a
    /// wave towards -x.
    fn released(&self, jacobian: f64) -> HugoniotState {
        let state = isentrope(&*self.eos, self.state, jacobian, 400);
        HugoniotState { u: 2.0 * self.state.u - state.u, ..state }
    }

    /// The release at which `excess`, positive in the shock, comes to zero.
    pub fn released_until(&self, excess: impl Fn(&HugoniotState) -> f64) -> HugoniotState {
        let (mut low, mut high) = (self.state.jacobian, 1.2);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if excess(&self.released(middle)) > 0.0 { low = middle } else { high = middle }
        }
        self.released(low)
    }
}

/// Velocity of the interface where `left` runs into `right`: the same pressure in both.
pub(super) fn meet(left: &Plate, right: &Plate) -> Option<f64> {
    let (mut low, mut high) = (right.state.u, left.state.u);
    for _ in 0..60 {
        let u = 0.5 * (low + high);
        let [pushing, pushed] = [left.shock(u)?.behind.p, right.shock(u)?.behind.p];
        if pushing > pushed { low = u } else { high = u }
    }
    Some(0.5 * (low + high))
}

/// When a column first passes `level`, between two rows.
fn passes(histories: &CsvTable, column: &str, level: f64) -> Option<f64> {
    let (t, v) = (histories.numbers("time")?, histories.numbers(column)?);
    let k = (1..v.len()).find(|&k| v[k] >= level)?;
    Some(t[k - 1] + (t[k] - t[k - 1]) * (level - v[k - 1]) / (v[k] - v[k - 1]))
}

pub(super) fn histories(run: &Outcome) -> Option<CsvTable> {
    read_csv(&run.folder.join("histories.csv")).ok()
}

/// Names, times by hand and by the run of `three_plates.json`.
fn arrivals(run: &Outcome) -> Option<Vec<(&'static str, f64, f64)>> {
    let length = |body: usize| 1e-3 * [1.0, 1.0, 0.8][body];
    let [first_gap, second_gap] = [2e-4, 1e-4];
    let (flyer, last) = (Plate::of(run, "copper", 1000.0)?, Plate::of(run, "pmma", 0.0)?);
    let middle = Plate::of(run, "aluminium", 0.0)?;
    let u = meet(&flyer, &middle)?;
    let closed = first_gap / flyer.state.u;
    let crossed = closed + length(1) / middle.shock(u)?.speed;
    let shocked = middle.shocked(u)?;
    let state = shocked.released_until(|s| s.p);
    let rear = state.u;
    let closed_again = crossed + second_gap / rear;
    let thrown = Plate { state, ..shocked };
    let pushed = meet(&thrown, &last)?;
    let crossed_again = closed_again + length(2) / last.shock(pushed)?.speed;
    let last_rear = last.shocked(pushed)?.released_until(|s| s.p).u;
    let histories = histories(run)?;
    let half = |column: &str, speed: f64| passes(&histories, column, 0.5 * speed);
    Some(vec![
        ("copper meets aluminium", closed, half("middle_lower_velocity", u)?),
        ("shock at the aluminium's rear", crossed, half("middle_upper_velocity", rear)?),
        ("aluminium meets PMMA", closed_again, half("last_lower_velocity", pushed)?),
        ("shock at the PMMA's rear", crossed_again, half("last_upper_velocity", last_rear)?),
    ])
}

/// Each gap's end and each shock's arrival.
pub fn check(table: &mut Table) {
    let Some(run) = table.take("three_plates.json", Job::new("three_plates").run()) else { return };
    let Some(arrivals) = arrivals(&run) else {
        return table.holds("three plates: arrivals", "none", "all", false);
    };
    for (what, exact, time) in arrivals {
        let figure = format!("three plates: {what}, {:.1} ns", 1e9 * exact);
        table.check(&figure, Some(time / exact - 1.0), bounds::plates::ARRIVAL);
    }
    let (energy, momentum) = (run.summary.energy.drift, run.summary.momentum.drift);
    table.check("three plates: energy drift", energy, bounds::plates::ENERGY_DRIFT);
    table.check("three plates: momentum drift", momentum, bounds::plates::MOMENTUM_DRIFT);
}

/// Velocity of the window's interface by hand, and its mean over the run's plateau.
pub(super) fn seen(run: &Outcome) -> Option<(f64, f64)> {
    let (flyer, window) = (Plate::of(run, "copper", 600.0)?, Plate::of(run, "window", 0.0)?);
    let sample = Plate::of(run, "aluminium", 0.0)?;
    let u = meet(&flyer, &sample)?;
    let shocked = sample.shocked(u)?;
    // the window is the softer
    let against = |s: &HugoniotState| window.shock(s.u).map_or(0.0, |front| front.behind.p);
    let exact = shocked.released_until(|s| s.p - against(s)).u;
    let histories = histories(run)?;
    let rows = histories.numbers("time")?.iter().zip(histories.numbers("interface_velocity")?);
    let plateau: Vec<f64> =
        rows.filter(|(t, _)| (0.45e-6..0.85e-6).contains(*t)).map(|(_, v)| *v).collect();
    Some((exact, plateau.iter().sum::<f64>() / plateau.len() as f64))
}

/// What a laser sees through the window.
pub fn window(table: &mut Table) {
    let job = Job::new("gas_gun_window");
    let Some(run) = table.take("gas_gun_window.json", job.run()) else { return };
    let seen = seen(&run);
    let exact = seen.map_or(f64::NAN, |(exact, _)| exact);
    let error = seen.map(|(exact, mean)| mean / exact - 1.0);
    let figure = format!("window: velocity of the interface, {exact:.2} m/s");
    table.check(&figure, error, bounds::window::VELOCITY);
}
