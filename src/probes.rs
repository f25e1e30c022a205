//! What histories follow: the interface, free surfaces, tracers, energies.

use decomp::Comm;

use crate::output::histories::Histories;
use crate::scene::{CheckedScene, Reference};
use crate::simulation::{Followed, Simulation};

/// The part of a particle that a probe sits on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Lower,
    Centre,
    Upper,
}

/// A probe: the mean over some particles' parts.
struct Probe {
    name: String,
    parts: Vec<(u64, Part)>,
}

/// The probes of a run and what they have told.
pub struct Probes {
    probes: Vec<Probe>,
    wanted: Vec<u64>,
    interval: f64,
    due: u64,
    histories: Histories,
}

impl Probes {
    /// The probes that a scene asks for; `None` if it asks for no histories.
    ///
    /// An impact has `interface` (the mean of both faces), `free_surface` (the target's rear) and
    /// `flyer_rear`; other scenes the two ends of each body. Tracers follow.
    pub fn new(scene: &CheckedScene) -> Option<Self> {
        let interval = scene.history_interval?;
        let mut first = 0;
        let ranges: Vec<(u64, u64)> = scene
            .bodies
            .iter()
            .map(|b| {
                let range = (first, first + b.particles - 1);
                first += b.particles;
                range
            })
            .collect();
        let end = |body: usize, upper: bool| match upper {
            true => (ranges[body].1, Part::Upper),
            false => (ranges[body].0, Part::Lower),
        };
        let bodies = &scene.scene.bodies;
        let mut probes = Vec::new();
        let mut add = |name: &str, parts: Vec<(u64, Part)>| {
            probes.push(Probe { name: name.to_string(), parts });
        };
        match &scene.scene.reference {
            Some(Reference::FlyerImpact(named)) => {
                let number = |name: &str| bodies.iter().position(|b| b.name == name);
                let (flyer, target) = (number(&named.flyer)?, number(&named.target)?);
                let below = bodies[flyer].extent.lower[0] < bodies[target].extent.lower[0];
                add("interface", vec![end(flyer, below), end(target, !below)]);
                add("free_surface", vec![end(target, below)]);
                add("flyer_rear", vec![end(flyer, !below)]);
            }
            _ => {
                for (number, body) in bodies.iter().enumerate() {
                    add(&format!("{}_lower", body.name), vec![end(number, false)]);
                    add(&format!("{}_upper", body.name), vec![end(number, true)]);
                }
            }
        }
        let histories = scene.scene.output.histories.as_ref()?;
        for tracer in &histories.tracers {
            let number = bodies.iter().position(|b| b.name == tracer.body)?;
            let extent = &bodies[number].extent;
            let count = scene.bodies[number].lattice[0] as f64;
            let share = (tracer.at[0] - extent.lower[0]) / (extent.upper[0] - extent.lower[0]);
            let k = (share * count).floor().clamp(0.0, count - 1.0) as u64;
            add(&tracer.name, vec![(ranges[number].0 + k, Part::Centre)]);
        }
        let mut columns: Vec<(String, String)> = [
            ("time", "s"),
            ("dt", "s"),
            ("kinetic_energy", "J"),
            ("internal_energy", "J"),
            ("total_energy", "J"),
            ("momentum", "kg m/s"),
        ]
        .map(|(name, unit)| (name.to_string(), unit.to_string()))
        .into();
        for probe in &probes {
            for (what, unit) in [("x", "m"), ("velocity", "m/s"), ("pressure", "Pa")] {
                columns.push((format!("{}_{what}", probe.name), unit.into()));
            }
        }
        let mut wanted: Vec<u64> = probes.iter().flat_map(|p| &p.parts).map(|p| p.0).collect();
        wanted.sort_unstable();
        wanted.dedup();
        Some(Probes { probes, wanted, interval, due: 0, histories: Histories::new(columns) })
    }

    /// Takes a row if one is due: at the first step's end past each interval. Collective.
    pub fn sample<C: Comm>(&mut self, simulation: &Simulation<'_, C>) {
        let time = simulation.time();
        if time < self.due as f64 * self.interval {
            return;
        }
        self.due = (time / self.interval).floor() as u64 + 1;
        let totals = simulation.totals();
        let followed = simulation.follow(&self.wanted);
        if followed.is_empty() {
            return;
        }
        let mut row = vec![
            time,
            simulation.time_step(),
            totals.kinetic,
            totals.internal,
            totals.kinetic + totals.internal,
            totals.momentum,
        ];
        for probe in &self.probes {
            let parts = probe.parts.iter().map(|&(id, part)| {
                let at = self.wanted.binary_search(&id).expect("a probe's particle is wanted");
                followed[at].map(|f| place(&f, part))
            });
            // a particle that has left makes the field empty
            let parts: Option<Vec<[f64; 3]>> = parts.collect();
            let mean = |k: usize| match &parts {
                Some(parts) => parts.iter().map(|p| p[k]).sum::<f64>() / parts.len() as f64,
                None => f64::NAN,
            };
            row.extend([mean(0), mean(1), mean(2)]);
        }
        self.histories.push(&row);
    }

    /// What has been told.
    pub fn into_histories(self) -> Histories {
        self.histories
    }
}

/// Position, velocity and pressure of a part.
fn place(followed: &Followed, part: Part) -> [f64; 3] {
    let x = match part {
        Part::Lower => followed.position - followed.half_length,
        Part::Centre => followed.position,
        Part::Upper => followed.position + followed.half_length,
    };
    [x, followed.velocity, followed.pressure]
}
