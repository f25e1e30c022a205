//! Probes for histories: interface, free surfaces, tracers, energies.

use crate::driver::output::histories::HistoryTable;
use crate::scene::{CheckedScene, GaugeAxis, GaugePlane, Reference, Station};
use crate::simulation::{Around, Followed, Simulation};

/// The part of a particle at which a probe is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ProbePart {
    Lower,
    Centre,
    Upper,
    /// The lower face, at a free surface.
    FreeLower,
    /// The upper face, at a free surface.
    FreeUpper,
}

/// A probe: the mean over the parts of some particles.
struct Probe {
    name: String,
    parts: Vec<(u64, ProbePart)>,
    /// Body of the first part.
    body: usize,
    /// Fringes per velocity [s/m], if it counts them.
    fringes: Option<f64>,
}

/// A probe or gauge, and its columns in the histories.
#[derive(Clone, Debug, PartialEq)]
pub enum GaugeKind {
    /// A point of a body.
    Material {
        /// Number of the body.
        body: usize,
        /// Whether the point is at the surface of the body.
        surface: SurfacePart,
    },
    /// A point fixed in space.
    Station,
    /// A plane.
    Plane,
}

/// Part of the surface of a body at which a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfacePart {
    /// None: inside of the body.
    Inside,
    /// A free surface.
    Free,
    /// A face that meets a side or another body.
    Loaded,
}

impl GaugeKind {
    /// Whether it is a point of a face that meets a side or another body.
    pub fn is_loaded(&self) -> bool {
        matches!(self, GaugeKind::Material { surface: SurfacePart::Loaded, .. })
    }
}

/// The probes of a run and their recorded values.
pub struct Probes {
    probes: Vec<Probe>,
    stations: Vec<Station>,
    planes: Vec<GaugePlane>,
    wanted: Vec<u64>,
    /// Number of columns for the contact force.
    forces: usize,
    interval: f64,
    due: u64,
    histories: HistoryTable,
}

impl Probes {
    /// The probes of a scene; `None` if the scene asks for no histories.
    ///
    /// An impact has `interface` (the mean of both faces), `free_surface` (the target's rear) and
    /// `flyer_rear`; other scenes have the two ends of each body. Tracers follow.
    ///
    /// Position and velocity [m/s] of a face are those of the outermost particle, with the position
    /// moved to the particle's edge. On a free surface ([`CheckedScene::face_is_free`]) the
    /// traction is zero, so the pressure [Pa] is 0, or the deviator's xx component if the material
    /// has strength. On other faces it is the pressure of the particle. The particle's pressure
    /// would be wrong on a free surface: its centre lies half a particle inside, where a shock
    /// raises the pressure for as long as the computed front takes to pass.
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
        let end = |body: usize, upper: bool| match (upper, scene.face_is_free(body, upper)) {
            (true, false) => (ranges[body].1, ProbePart::Upper),
            (true, true) => (ranges[body].1, ProbePart::FreeUpper),
            (false, false) => (ranges[body].0, ProbePart::Lower),
            (false, true) => (ranges[body].0, ProbePart::FreeLower),
        };
        let bodies = &scene.scene.bodies;
        let mut probes = Vec::new();
        let body_of =
            |id: u64| ranges.iter().position(|&(first, last)| (first..=last).contains(&id));
        let mut add = |name: &str, parts: Vec<(u64, ProbePart)>| {
            let body = parts.first().and_then(|part| body_of(part.0)).unwrap_or(0);
            probes.push(Probe { name: name.to_string(), parts, body, fringes: None });
        };
        match &scene.scene.reference {
            Some(Reference::FlyerImpact(named)) if scene.dimension == 1 => {
                let number = |name: &str| bodies.iter().position(|b| b.name == name);
                let (flyer, target) = (number(&named.flyer)?, number(&named.target)?);
                let below = scene.bodies[flyer].lower[0] < scene.bodies[target].lower[0];
                add("interface", vec![end(flyer, below), end(target, !below)]);
                add("free_surface", vec![end(target, below)]);
                add("flyer_rear", vec![end(flyer, !below)]);
            }
            _ if scene.dimension > 1 => {}
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
            let k = scene.bodies[number].nearest(&tracer.at);
            add(&tracer.name, vec![(ranges[number].0 + k, ProbePart::Centre)]);
        }
        for meter in &histories.velocimeters {
            let number = bodies.iter().position(|b| b.name == meter.body)?;
            let (body, tolerance) = (&scene.bodies[number], scene.tolerance(0));
            let is_at = |x: f64| scene.dimension == 1 && (meter.at[0] - x).abs() <= tolerance;
            let part = match (is_at(body.lower[0]), is_at(body.upper[0])) {
                (true, _) => end(number, false),
                (_, true) => end(number, true),
                _ => (ranges[number].0 + body.nearest(&meter.at), ProbePart::Centre),
            };
            add(&meter.name, vec![part]);
        }
        let first = probes.len() - histories.velocimeters.len();
        for (probe, meter) in probes[first..].iter_mut().zip(&histories.velocimeters) {
            probe.fringes = meter.fringe.map(|fringe| (1.0 + meter.window_correction) / fringe);
        }
        let mut columns: Vec<(String, String)> = [
            ("time", "s"),
            ("dt", "s"),
            ("kinetic_energy", "J"),
            ("internal_energy", "J"),
            ("total_energy", "J"),
        ]
        .map(|(name, unit)| (name.to_string(), unit.to_string()))
        .into();
        let (momenta, places, velocities): (&[&str], &[&str], &[&str]) = match scene.dimension {
            1 => (&["momentum"], &["x"], &["velocity"]),
            _ => (&["momentum_x", "momentum_y"], &["x", "y"], &["velocity_x", "velocity_y"]),
        };
        columns.extend(momenta.iter().map(|name| (name.to_string(), "kg m/s".to_string())));
        let forces: &[&str] = match (scene.velocity_fields(), scene.dimension) {
            (1, _) => &[],
            (_, 1) => &["contact_force"],
            _ => &["contact_force", "contact_friction"],
        };
        columns.extend(forces.iter().map(|name| (name.to_string(), "N".to_string())));
        for probe in &probes {
            let units = [(places, "m"), (velocities, "m/s"), (&["pressure"], "Pa")];
            for (names, unit) in units {
                let of_probe = |what| (format!("{}_{what}", probe.name), unit.to_string());
                columns.extend(names.iter().map(of_probe));
            }
            if probe.fringes.is_some() {
                columns.push((format!("{}_fringes", probe.name), "-".to_string()));
            }
        }
        for station in &histories.stations {
            let units = [(velocities, "m/s"), (&["pressure"], "Pa"), (&["density"], "kg/m3")];
            for (names, unit) in units {
                let of_station = |what| (format!("{}_{what}", station.name), unit.to_string());
                columns.extend(names.iter().map(of_station));
            }
        }
        for plane in &histories.planes {
            for (what, unit) in [("mass", "kg"), ("momentum", "kg m/s")] {
                columns.push((format!("{}_{what}", plane.name), unit.to_string()));
            }
        }
        let mut wanted: Vec<u64> = probes.iter().flat_map(|p| &p.parts).map(|p| p.0).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let (forces, histories) = (forces.len(), HistoryTable::new(columns));
        let (stations, planes) = {
            let asked = scene.scene.output.histories.as_ref()?;
            (asked.stations.clone(), asked.planes.clone())
        };
        Some(Probes { probes, stations, planes, wanted, forces, interval, due: 0, histories })
    }

    /// Records a row if one is due, at the end of the first step after each interval. Collective.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn sample<const D: usize>(&mut self, simulation: &Simulation<'_, D>) {
        let time = simulation.time();
        if time < self.due as f64 * self.interval {
            return;
        }
        self.due = self.after(time);
        let totals = simulation.totals();
        let forces = if self.forces > 0 { simulation.contact_force() } else { [0.0; 2] };
        let beyond: Vec<[f64; 2]> = self
            .planes
            .iter()
            .map(|plane| simulation.beyond(usize::from(plane.axis == GaugeAxis::Y), plane.at))
            .collect();
        let around: Vec<Option<Around<D>>> =
            self.stations.iter().map(|station| simulation.around(&station.at)).collect();
        let followed = simulation.follow(&self.wanted);
        // only rank 0 has the values
        if followed.is_empty() && !self.wanted.is_empty() {
            return;
        }
        // without particles the time step is unbounded
        let dt = Some(simulation.time_step()).filter(|dt| dt.is_finite()).unwrap_or(f64::NAN);
        let mut row =
            vec![time, dt, totals.kinetic, totals.internal, totals.kinetic + totals.internal];
        row.extend(totals.momentum);
        row.extend(&forces[..self.forces]);
        for probe in &self.probes {
            let parts = probe.parts.iter().map(|&(id, part)| {
                let at = self.wanted.binary_search(&id).expect("a probe's particle is wanted");
                followed[at].map(|f| place(&f, part))
            });
            // a particle that has been removed leaves an empty field
            let parts: Option<Vec<Vec<f64>>> = parts.collect();
            let mean = |k: usize| match &parts {
                Some(parts) => parts.iter().map(|p| p[k]).sum::<f64>() / parts.len() as f64,
                None => f64::NAN,
            };
            row.extend((0..2 * D + 1).map(mean));
            // an interferometer looks along x
            row.extend(probe.fringes.map(|fringes| fringes * mean(D)));
        }
        for around in around {
            let values = around.map(|a| {
                a.velocity.into_iter().chain([a.pressure, a.density]).collect::<Vec<f64>>()
            });
            row.extend(values.unwrap_or(vec![f64::NAN; D + 2]));
        }
        row.extend(beyond.into_iter().flatten());
        self.histories.push(&row);
    }

    /// All probes and gauges, with the names of their columns.
    pub fn gauges(&self) -> Vec<(&str, GaugeKind)> {
        let probes = self.probes.iter().map(|probe| {
            let is = |of: fn(&ProbePart) -> bool| probe.parts.iter().all(|(_, part)| of(part));
            let surface = match () {
                _ if is(|p| matches!(p, ProbePart::FreeLower | ProbePart::FreeUpper)) => {
                    SurfacePart::Free
                }
                _ if is(|p| *p == ProbePart::Centre) => SurfacePart::Inside,
                _ => SurfacePart::Loaded,
            };
            (&probe.name[..], GaugeKind::Material { body: probe.body, surface })
        });
        let stations = self.stations.iter().map(|s| (&s.name[..], GaugeKind::Station));
        let planes = self.planes.iter().map(|p| (&p.name[..], GaugeKind::Plane));
        probes.chain(stations).chain(planes).collect()
    }

    /// The number of the first interval that ends after `time`.
    fn after(&self, time: f64) -> u64 {
        ((time / self.interval).floor() as u64).saturating_add(1)
    }

    /// The number of the interval at whose end the next row is due.
    pub fn due(&self) -> u64 {
        self.due
    }

    /// Continues at `time` [s] after `histories`, which must have the same columns. `due` is the
    /// number of the next row, if known.
    pub fn resume(&mut self, time: f64, due: Option<u64>, histories: Option<HistoryTable>) {
        self.due = due.unwrap_or_else(|| self.after(time));
        if let Some(histories) = histories {
            self.histories = histories;
        }
    }

    /// The rows recorded so far.
    pub fn histories(&self) -> &HistoryTable {
        &self.histories
    }

    /// The recorded rows.
    pub fn into_histories(self) -> HistoryTable {
        self.histories
    }
}

/// Position, velocity and pressure of a part.
fn place<const D: usize>(followed: &Followed<D>, part: ProbePart) -> Vec<f64> {
    let shift = match part {
        ProbePart::Lower | ProbePart::FreeLower => -followed.half_length,
        ProbePart::Centre => 0.0,
        ProbePart::Upper | ProbePart::FreeUpper => followed.half_length,
    };
    let pressure = match part {
        ProbePart::FreeLower | ProbePart::FreeUpper => followed.free_pressure,
        ProbePart::Lower | ProbePart::Centre | ProbePart::Upper => followed.pressure,
    };
    let mut values = followed.position.to_vec();
    values[0] += shift;
    values.extend(followed.velocity);
    values.push(pressure);
    values
}
