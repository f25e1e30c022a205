//! Description of a scene without a run: size, effects, and exact solution of its impact.

use std::fmt::Write;
use std::path::Path;

use flyer_mpm::accuracy::reference;
use flyer_mpm::driver::figures::{self, WaveRow, plate_name};
use flyer_mpm::driver::memory::needed_memory;
use flyer_mpm::driver::output::SUMMARY_FILE;
use flyer_mpm::driver::output::folder::OutputFolder;
use flyer_mpm::driver::output::lock::Lock;
use flyer_mpm::driver::output::origin::Maker;
use flyer_mpm::effects::{ledger, ledger_lines, ledger_rest};
use flyer_mpm::exact::{Accuracy, Chain, Impact, Plate, Release, Solution, WaveKind};
use flyer_mpm::input;
use flyer_mpm::scene::{Body, CheckedScene, Reference};
use flyer_mpm::simulation::{Preview, RunError};
use serde_json::json;

use crate::{FAILED, Outcome, bad};

/// Particles, cells, memory, first time step, steps and effects of a scene.
///
/// # Errors
///
/// If the scene cannot be simulated.
pub fn check(scene: &CheckedScene) -> Result<String, RunError> {
    let preview = Preview::new(scene)?;
    let (columns, dt) = (&preview.columns, preview.first_step.min(scene.scene.time.end));
    let mut text = String::new();
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<20} {value}");
    };
    line("title", scene.scene.title.clone());
    line("particles", scene.particles.to_string());
    if let Some(names) = bodies_with_default(scene) {
        let counts = Body::default().particles_per_cell(scene.dimension);
        line("particles per cell", format!("{counts:?} (default): {names}"));
    }
    line("cells", scene.cell_count().to_string());
    line("memory", memory(scene, input::available_memory()));
    line("first time step", format!("{dt:.4e} s"));
    line("steps", format!("about {:.0}", (scene.scene.time.end / dt).ceil()));
    let names: Vec<&str> = columns.specs.iter().map(|s| s.name).collect();
    line("particle columns", format!("{} ({})", names.len(), names.join(", ")));
    line("last good state", format!("{} bytes per particle", columns.state_bytes(scene.dimension)));
    let limit = scene.courant_limit();
    line("courant", format!("{}, this method's limit {limit}", scene.scene.time.courant));
    if let Some(choice) = &scene.method_choice {
        line("method", format!("preset {}", choice.preset.name()));
        choice.reasons.iter().for_each(|reason| line("", reason.clone()));
    }
    for warning in &scene.warnings {
        line("warning", warning.clone());
    }
    text += "effects\n";
    for (name, state) in effects(scene) {
        let _ = writeln!(text, "  {name:<22} {state}");
    }
    text += "memory and messages of each effect\n";
    let all = ledger(scene, columns, None);
    for line in ledger_lines(&all) {
        // without a run, the shares are unknown
        let [name, particle, ghost] = [0, 1, 2].map(|k| line[k].as_str());
        let _ = writeln!(text, "  {name:<22} {particle:>16} {ghost:>13}");
    }
    let _ = writeln!(text, "  {}", ledger_rest(&all));
    Ok(text)
}

/// Memory of a run on one rank, and how much of it `available` bytes lack.
fn memory(scene: &CheckedScene, available: Option<u64>) -> String {
    let megabytes = |bytes: u64| bytes as f64 / 1e6;
    let needed = needed_memory(scene, 0, 1, scene.scene.decomposition.threads);
    let text = format!("{:.1} MB", megabytes(needed));
    match available {
        Some(available) if available < needed => {
            format!(
                "{text}, more than the {:.1} MB that this machine has left",
                megabytes(available)
            )
        }
        _ => text,
    }
}

/// Names of the bodies whose number of particles per cell is the default; `None`: there are none.
fn bodies_with_default(scene: &CheckedScene) -> Option<String> {
    let has_default = |b: &&Body| b.particles_per_cell.is_none() && b.positions.is_none();
    let bodies = scene.scene.bodies.iter().filter(has_default);
    let names: Vec<&str> = bodies.map(|body| body.name.as_str()).collect();
    match &names[..] {
        [] => None,
        all if all.len() == scene.bodies.len() => Some("all bodies".into()),
        some => Some(some.join(", ")),
    }
}

/// Each effect, with its setting in the scene.
fn effects(scene: &CheckedScene) -> Vec<(&'static str, String)> {
    let method = &scene.scene.method;
    let off = || "off".to_string();
    let plain = |v: &dyn erased::Json| v.text();
    vec![
        ("shape", plain(&method.shape)),
        ("frame", plain(&method.frame)),
        ("transfer", plain(&method.transfer)),
        ("stepping", plain(&method.stepping)),
        ("stress update", plain(&method.stress_update)),
        ("energy", plain(&method.energy)),
        ("filter heat", if method.filter_heat { "on".into() } else { off() }),
        ("heat spreading", method.heat_spreading.as_ref().map_or_else(off, |s| plain(s))),
        ("pressure relaxation", method.pressure_relaxation.as_ref().map_or_else(off, |r| plain(r))),
        ("volume relaxation", method.volume_relaxation.map_or_else(off, |r| r.to_string())),
        ("mass lumping", method.mass_lumping.map_or_else(off, |s| s.to_string())),
        ("edge mask", method.edge_mask.map_or_else(off, |m| m.to_string())),
        (
            "artificial viscosity",
            scene.scene.artificial_viscosity.as_ref().map_or_else(off, |v| plain(v)),
        ),
        ("boundary", scene.scene.boundary.as_ref().map_or_else(|| "free".into(), |b| plain(b))),
        ("reference", scene.scene.reference.as_ref().map_or_else(|| "none".into(), |r| plain(r))),
    ]
}

/// Options as JSON text.
mod erased {
    pub trait Json {
        fn text(&self) -> String;
    }

    impl<T: serde::Serialize> Json for T {
        fn text(&self) -> String {
            serde_json::to_string(self).unwrap_or_default().replace('"', "")
        }
    }
}

/// Number of states of the chain in the table.
const SHOWN_STATES: usize = 6;

/// Number of rows of the x-t diagram.
const ROWS: usize = 160;

/// The chain of an impact as a table; draws its Hugoniots and x-t diagram into `output`.
pub fn hugoniot(scene: &CheckedScene, output: &Path) -> Outcome<String> {
    let Some(Reference::FlyerImpact(named)) = &scene.scene.reference else {
        return Err(bad(format!(
            "{}: reference: `hugoniot` needs a scene with reference.flyer_impact",
            scene.file
        )));
    };
    let failed = |e: &dyn std::fmt::Display| (FAILED, e.to_string());
    let (impact, bodies) = reference::impact_of(scene, named).map_err(|e| failed(&e))?;
    let chain = impact.chain(SHOWN_STATES).map_err(|e| failed(&e))?;
    let release = impact.release(SHOWN_STATES).map_err(|e| failed(&e))?;
    let end = scene.scene.time.end;
    let times: Vec<f64> = (0..=ROWS).map(|k| end * k as f64 / ROWS as f64).collect();
    let solution = impact.solve(&times, &[], Accuracy::default()).map_err(|e| failed(&e))?;

    let _lock = Lock::take(output).map_err(bad)?;
    let maker = Maker::new("hugoniot", scene);
    let folder = OutputFolder::create(output, false, &maker).map_err(bad)?;
    figures::draw_hugoniots(scene, bodies, &impact, &chain, folder.path())
        .map_err(|e| failed(&e))?;
    let reference = reference::ReferenceSolution::Impact(Box::new(reference::ImpactReference {
        impact,
        chain: chain.clone(),
        solution: solution.clone(),
        flyer: bodies[0],
        target: bodies[1],
    }));
    let title = format!("{}: exact pressure and wave paths", scene.scene.title);
    let stem = folder.file("x_t_diagram");
    figures::draw_waves(&title, &rows(&solution), Some(end), Some(&reference), &stem)
        .map_err(|e| failed(&e))?;
    let summary = json!({
        "title": scene.scene.title,
        "version": env!("CARGO_PKG_VERSION"),
        "origin": folder.origin(),
        "scene": scene.scene,
        "profiles": [],
        "chain": {
            "separates": chain.separates,
            "states": chain.states.iter().map(|s| json!({"state": s.number, "velocity": s.u, "pressure": s.p})).collect::<Vec<_>>(),
        },
    });
    let text = serde_json::to_string_pretty(&summary).map_err(bad)?;
    std::fs::write(folder.file(SUMMARY_FILE), text).map_err(bad)?;
    let place = folder.commit().map_err(bad)?;
    let text = table(&impact, &chain, &release) + &limits(&impact, &solution, end);
    Ok(text + &format!("pictures in {}\n", place.display()))
}

/// The exact pressure over both plates, per row of the x-t diagram.
fn rows(solution: &Solution) -> Vec<WaveRow> {
    solution
        .snapshots
        .iter()
        .filter_map(|s| {
            let profile = s.whole.as_ref()?;
            let (lower, upper) = profile.span()?;
            let x = |k: usize| lower + (upper - lower) * (k as f64 + 0.5) / 1500.0;
            let points = (0..1500).filter_map(|k| Some((x(k), profile.at(x(k))?.p)));
            let (x, pressure) = points.unzip();
            Some(WaveRow { time: s.time, x, pressure, others: Vec::new() })
        })
        .collect()
}

/// Times at which the shock reaches the target's rear and the exact lines of the diagram end.
fn limits(impact: &Impact, solution: &Solution, end: f64) -> String {
    let mut text = String::new();
    if solution.valid_until < end {
        let _ = writeln!(
            text,
            "the shock reaches the target's rear at {:.6} us{}",
            solution.valid_until * 1e6,
            if impact.free_rear { "; its release from there is drawn too" } else { "" },
        );
    }
    if let Some((stopped, why)) = &solution.stopped {
        let _ = writeln!(
            text,
            "exact lines end at {:.6} us, before the end at {:.6} us: {why}",
            stopped * 1e6,
            end * 1e6
        );
    }
    text
}

fn table(impact: &Impact, chain: &Chain, release: &Release) -> String {
    let mut text = String::new();
    let mut line = |s: String| {
        text += &s;
        text.push('\n');
    };
    line(format!(
        "impact at {:.3} m/s; velocities are relative to the target at rest",
        impact.speed
    ));
    line(String::new());
    line("state  rarefactions as shocks      true release isentropes".into());
    line("       u [m/s]     p [GPa]         u [m/s]     p [GPa]".into());
    for state in &chain.states {
        let exact = match release.state(state.number) {
            Some(s) => format!("{:>11.6} {:>11.6}", s.u, s.p * 1e-9),
            None if state.number < 2 => format!("{:>11.6} {:>11.6}", state.u, state.p * 1e-9),
            None => String::new(),
        };
        line(format!(
            "{:>5}  {:>11.6} {:>11.6}     {exact}",
            state.number,
            state.u,
            state.p * 1e-9
        ));
    }
    line(String::new());
    line("wave     kind         plate   Lagrangian [m/s]  from t [us]   x [mm]".into());
    for wave in &chain.waves {
        let kind = match wave.kind {
            WaveKind::Shock => "shock",
            WaveKind::Rarefaction => "rarefaction",
        };
        line(format!(
            "{:>2} - {:<2}  {kind:<12} {:<7} {:>12.3}      {:>9.6}   {:>9.6}",
            wave.from,
            wave.to,
            plate_name(wave.plate),
            wave.lagrangian_speed,
            wave.start[0] * 1e6,
            wave.start[1] * 1e3,
        ));
    }
    line(String::new());
    if chain.separates {
        line("the flyer is softer than the target: the plates separate".into());
    }
    line(format!(
        "true fan: reaches the interface at {:.6} us; Lagrangian head and tail in the {} {:.3} and {:.3} m/s, in the {} {:.3} and {:.3} m/s",
        release.head_time * 1e6,
        plate_name(Plate::Flyer),
        release.flyer_head,
        release.flyer_tail,
        plate_name(Plate::Target),
        release.target_head,
        release.target_tail,
    ));
    line(format!(
        "its head catches the shock at {:.6} us, x = {:.6} mm",
        release.catch_up_time * 1e6,
        release.catch_up_place * 1e3
    ));
    text
}
