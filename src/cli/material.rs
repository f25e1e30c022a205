//! Description of a material's equation of state, without a run: its Hugoniot, isentropes, sound
//! speed and limits of validity.

use std::path::Path;

use flyer_mpm::driver::output::SUMMARY_FILE;
use flyer_mpm::driver::output::folder::OutputFolder;
use flyer_mpm::driver::output::lock::Lock;
use flyer_mpm::driver::output::origin::Maker;
use flyer_mpm::exact::hugoniot::{HugoniotState, ShockFront, isentrope, piston, shock_to};
use flyer_mpm::material::constitutive::equation;
use flyer_mpm::material::{Detonation, HistoryEos};
use flyer_mpm::plot::{self, Axis, Color, Figure, Panel, Points, Series, Stroke, Style};
use flyer_mpm::scene::{Burn, BurnWhole, CheckedScene, Eos, Material};
use serde_json::json;

use crate::{FAILED, Outcome, bad};

/// Particle velocities of the table [m/s].
const VELOCITIES: [f64; 12] =
    [10.0, 50.0, 100.0, 200.0, 500.0, 1e3, 1.5e3, 2e3, 3e3, 4e3, 6e3, 8e3];

/// Number of points of a curve.
const POINTS: usize = 160;

/// Volume up to which isentropes are followed, over the volume at their start [-].
const EXPANSION: f64 = 10.0;

/// Describes the material `name` of a scene; draws pictures into `output`.
pub fn material(scene: &CheckedScene, name: &str, output: &Path) -> Outcome<String> {
    let Some(material) = scene.scene.materials.get(name) else {
        let known: Vec<_> = scene.scene.materials.keys().map(String::as_str).collect();
        let known = known.join(", ");
        return Err(bad(format!("{}: no material {name}; allowed: {known}", scene.file)));
    };
    let burnt = burnt(material);
    let Some(eos) = equation(&burnt).map_err(bad)? else {
        return Err(bad(format!(
            "{}: materials.{name}.eos: an elastic solid has no equation of state; allowed: a fluid",
            scene.file
        )));
    };
    let sheet = Sheet::new(&*eos, burnt.eos.products(burnt.density).map(|p| p.detonation()));
    let mut text = sheet.text(name, material);
    // by its name alone, the material is that of the library
    if scene.file == super::materials::LIBRARY_SCENE {
        text += &super::materials::failure_laws(name);
    }
    let _lock = Lock::take(output).map_err(bad)?;
    let maker = Maker::new(&format!("material {name}"), scene);
    let folder = OutputFolder::create(output, false, &maker).map_err(bad)?;
    for (stem, figure) in sheet.figures(name) {
        plot::draw(&figure, &folder.file(stem)).map_err(|e| (FAILED, e.to_string()))?;
    }
    let summary = json!({
        "title": format!("{}: {name}", scene.scene.title),
        "version": env!("CARGO_PKG_VERSION"),
        "origin": folder.origin(),
        "scene": scene.scene,
        "profiles": [],
        "material": {"name": name, "hugoniot": sheet.hugoniot.iter().map(|front| json!({
            "particle_velocity": front.behind.u,
            "shock_speed": front.speed,
            "pressure": front.behind.p,
            "density": front.behind.density(&*eos),
            "specific_internal_energy": front.behind.e,
            "sound_speed": front.behind.sound_speed,
        })).collect::<Vec<_>>()},
    });
    let text_of_summary = serde_json::to_string_pretty(&summary).map_err(bad)?;
    std::fs::write(folder.file(SUMMARY_FILE), text_of_summary).map_err(bad)?;
    let place = folder.commit().map_err(bad)?;
    Ok(text + &format!("pictures in {}\n", place.display()))
}

/// The material with an explosive replaced by its products.
fn burnt(material: &Material) -> Material {
    let mut material = material.clone();
    if let Eos::Jwl(explosive) = &mut material.eos {
        explosive.burn = Burn::Whole(BurnWhole::Complete);
    }
    material
}

struct Sheet<'a> {
    eos: &'a dyn HistoryEos,
    rest: HugoniotState,
    /// The last shock front for each particle velocity of the table.
    hugoniot: Vec<ShockFront>,
    /// The last shock front for many particle velocities, for pictures.
    curve: Vec<ShockFront>,
    /// Name and states of each isentrope.
    isentropes: Vec<(String, Vec<HugoniotState>)>,
    detonation: Option<Detonation>,
}

impl<'a> Sheet<'a> {
    fn new(eos: &'a dyn HistoryEos, detonation: Option<Detonation>) -> Self {
        let rest = HugoniotState::at_rest(eos, 0.0, 0.0);
        let last = |up: f64| piston(eos, &rest, up).ok()?.last().copied();
        let hugoniot: Vec<ShockFront> = VELOCITIES.iter().map_while(|&up| last(up)).collect();
        let range = (VELOCITIES[VELOCITIES.len() - 1] / VELOCITIES[0]).ln();
        let velocities =
            (0..=POINTS).map(|k| VELOCITIES[0] * (range * k as f64 / POINTS as f64).exp());
        let curve: Vec<ShockFront> = velocities.map_while(last).collect();
        // the principal isentrope is also followed into compression
        let densest = curve.last().map_or(rest.jacobian, |front| front.behind.jacobian);
        let mut principal: Vec<HugoniotState> = (0..POINTS)
            .map(|k| densest + (rest.jacobian - densest) * k as f64 / POINTS as f64)
            .map(|j| isentrope(eos, rest, j, 200))
            .filter(|s| s.p.is_finite() && s.sound_speed > 0.0)
            .collect();
        principal.extend(follow(eos, rest));
        let mut isentropes = vec![("from rest".to_string(), principal)];
        for front in hugoniot.iter().filter(|f| [1e3, 3e3].contains(&f.behind.u.round())) {
            let name = format!("from {:.4} GPa", front.behind.p * 1e-9);
            isentropes.push((name, follow(eos, front.behind)));
        }
        Sheet { eos, rest, hugoniot, curve, isentropes, detonation }
    }

    fn text(&self, name: &str, material: &Material) -> String {
        let mut text = String::new();
        let mut line = |s: String| {
            text += &s;
            text.push('\n');
        };
        line(format!("{name}: {}", json!(material.eos)["type"].as_str().unwrap_or("")));
        if !material.source.is_empty() {
            line(format!("source               {}", material.source));
        }
        line(format!("density              {:.6e} kg/m3", self.rest.density(self.eos)));
        line(format!("pressure at start    {:.6e} Pa", self.rest.p));
        line(format!("sound speed          {:.4} m/s", self.rest.sound_speed));
        if let Some(d) = self.detonation {
            line(format!("detonation (CJ)      {:.1} m/s, {:.4} GPa", d.speed, d.pressure * 1e-9));
        }
        line(String::new());
        line("Hugoniot".into());
        line("  up [m/s]   Us [m/s]     P [GPa]  rho [kg/m3]     e [J/kg]    c [m/s]".into());
        for front in &self.hugoniot {
            let b = front.behind;
            let rho = b.density(self.eos);
            line(format!(
                "{:>10.1} {:>10.2} {:>11.5} {:>12.3} {:>12.5e} {:>10.2}",
                b.u,
                front.speed,
                b.p * 1e-9,
                rho,
                b.e,
                b.sound_speed
            ));
        }
        for (name, states) in &self.isentropes {
            line(String::new());
            line(format!("isentrope {name}"));
            line("  v/v0         P [GPa]     e [J/kg]    c [m/s]".into());
            let every = states.len().div_ceil(10).max(1);
            for s in states.iter().step_by(every).chain(states.last()) {
                line(format!(
                    "{:>7.4} {:>14.6e} {:>12.5e} {:>10.2}",
                    s.jacobian,
                    s.p * 1e-9,
                    s.e,
                    s.sound_speed
                ));
            }
        }
        line(String::new());
        line(self.limit_of_shocks());
        line(self.limit_of_expansion());
        text
    }

    /// The limit of the Hugoniot.
    fn limit_of_shocks(&self) -> String {
        let rho0 = self.eos.reference_density();
        let mut last = None;
        for k in 1..2000 {
            let j = self.rest.jacobian * (1.0 - f64::from(k) * 5e-4);
            match shock_to(self.eos, &self.rest, j) {
                Some(front) => last = Some(front),
                None if last.is_some() => {
                    // find the reason at the energy of the last state
                    let e = last.map_or(0.0, |f: ShockFront| f.behind.e);
                    let (point, history) = self.eos.at(j, e, self.rest.history);
                    let why = self.eos.check_validity(j, e, history, point.pressure);
                    let why = why.unwrap_or("no denser state has the energy of a shock");
                    return format!("shocks hold up to a density of {:.1} kg/m3: {why}", rho0 / j);
                }
                None => {}
            }
        }
        "shocks have no limit".into()
    }

    /// The limit of the isentrope from rest.
    fn limit_of_expansion(&self) -> String {
        let (_, states) = &self.isentropes[0];
        let last = states.last().unwrap_or(&self.rest);
        let rho = last.density(self.eos);
        if last.jacobian >= EXPANSION * self.rest.jacobian * 0.999 {
            return format!("expansion from rest holds down to {rho:.2} kg/m3 and beyond");
        }
        let j = last.jacobian * 1.02;
        let next = isentrope(self.eos, *last, j, 8);
        let why = self.eos.check_validity(j, next.e, next.history, next.p);
        let why = why.unwrap_or("the sound speed becomes imaginary");
        format!("expansion from rest holds to {rho:.2} kg/m3, {:.4} GPa: {why}", last.p * 1e-9)
    }

    fn figures(&self, name: &str) -> Vec<(&'static str, Figure)> {
        let fronts = &self.curve;
        let points = |x: &dyn Fn(&ShockFront) -> f64, y: &dyn Fn(&ShockFront) -> f64| {
            let xs: Vec<f64> = fronts.iter().map(x).collect();
            Points::new(xs, fronts.iter().map(y).collect::<Vec<f64>>())
        };
        let panel = |axis: Axis, points: Points| {
            let style = Style::line(Color::of_material(name, 0));
            Panel::new(axis).series(Series::new("", points, style))
        };
        let up = |f: &ShockFront| f.behind.u;
        let waves =
            Figure::new(format!("{name}: Hugoniot"), Axis::linear("Particle velocity", "m/s"))
                .panel(panel(Axis::linear("Shock speed", "m/s"), points(&up, &|f| f.speed)))
                .panel(panel(Axis::linear("Pressure", "Pa"), points(&up, &|f| f.behind.p)))
                .panel(panel(
                    Axis::linear("Sound speed", "m/s"),
                    points(&up, &|f| f.behind.sound_speed),
                ));
        // gases expand over decades; a material under tension needs a linear scale
        let states = || self.isentropes.iter().flat_map(|(_, states)| states);
        let gas = states().all(|s| s.p > 0.0);
        let axis = |label: &str, unit: &str| match gas {
            true => Axis::log(label, unit),
            false => Axis::linear(label, unit),
        };
        let mut pressures = Panel::new(axis("Pressure", "Pa"));
        let line = Style::line(Color::of_material(name, 0));
        let volume = |f: &ShockFront| f.behind.jacobian;
        let series = Series::new("Hugoniot", points(&volume, &|f| f.behind.p), line);
        pressures = pressures.series(series);
        for (k, (from, states)) in self.isentropes.iter().enumerate() {
            let v: Vec<f64> = states.iter().map(|s| s.jacobian).collect();
            let p: Vec<f64> = states.iter().map(|s| s.p).collect();
            let style = Style::line(Color::palette(k)).stroke(Stroke::Dashed);
            let name = format!("isentrope {from}");
            pressures = pressures.series(Series::new(name, Points::new(v, p), style));
        }
        let volume = axis("Volume over that at rest", "");
        let isentropes =
            Figure::new(format!("{name}: pressure by volume"), volume).panel(pressures);
        vec![("hugoniot", waves), ("isentropes", isentropes)]
    }
}

/// The isentrope from a state, until it has expanded by `EXPANSION` or the model ceases to be
/// valid.
fn follow(eos: &dyn HistoryEos, start: HugoniotState) -> Vec<HugoniotState> {
    let mut states = vec![start];
    let factor = EXPANSION.powf(1.0 / POINTS as f64);
    let mut state = start;
    for k in 1..=POINTS {
        let next = isentrope(eos, state, start.jacobian * factor.powi(k as i32), 8);
        let holds = eos.check_validity(next.jacobian, next.e, next.history, next.p).is_none();
        if !(holds && next.p.is_finite() && next.sound_speed > 0.0) {
            break;
        }
        state = next;
        states.push(state);
    }
    states
}
