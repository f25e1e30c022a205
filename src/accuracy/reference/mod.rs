//! The exact solution named by a scene, and the scores of profiles against it.
//!
//! Converts the bodies of the scene to the input of [`crate::exact`]. Does not depend on MPI.

mod bodies;
mod plane;

pub use plane::{PlaneReference, PlaneSolution};

use self::bodies::body_named;
use crate::exact::{
    Accuracy, Chain, Drive, EdgeRelease, Errors, ExactError, GasState, History, HugoniotState,
    Impact, ImpactBody, PlanePoint, PlaneWave, Plate, Profile, ProfilePoint, RiemannSolution,
    ScoreSample, SimpleWaveSolution, Solution, TracedPoint, WallImpactSolution, WallMaterial,
    cell_average, hugoniot, interface_errors, score, score_density,
};
use crate::material::IdealGasParameters;
use crate::material::MieGruneisen;
use crate::material::constitutive;
use crate::scene::{self, CheckedScene, Eos};
use crate::simulation::ParticleTable;

/// Last state of the chain of wave interactions; with fewer, waves near the interface are missing.
pub const LAST_STATE: usize = 12;

/// Exact solution of a scene at its profile times.
pub enum ReferenceSolution {
    /// Impact of a plate on a target.
    Impact(Box<ImpactReference>),
    /// Riemann problem of two gases.
    Riemann {
        /// The solution.
        solution: RiemannSolution,
        /// Initial position of the diaphragm [m].
        diaphragm: f64,
    },
    /// Impact of a body on a wall.
    Wall {
        /// The solution.
        solution: WallImpactSolution,
        /// Index of the body.
        body: usize,
    },
    /// Simple wave that a piston sends into a body.
    SimpleWave {
        /// The solution.
        solution: SimpleWaveSolution<scene::Course>,
        /// Index of the body.
        body: usize,
    },
    /// Solution that follows from the initial motion of a body.
    Plane(PlaneReference),
}

/// A particle of a plane wave in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlongWave {
    /// Position along the wave [m].
    pub x: f64,
    /// Velocity along the wave [m/s].
    pub u: f64,
    /// Pressure [Pa].
    pub p: f64,
}

/// Impact of a plate on a target.
pub struct ImpactReference {
    /// The two bodies.
    pub impact: Impact,
    /// The solution of Burghardt (2010), with rarefactions as shocks.
    pub chain: Chain,
    /// The exact solution, one snapshot per profile time.
    pub solution: Solution,
    /// Index of the flyer.
    pub flyer: usize,
    /// Index of the target.
    pub target: usize,
}

fn solid(scene: &CheckedScene, body: usize) -> MieGruneisen {
    let material = scene.material_of(body);
    let straight = material.eos.straight(material.density);
    straight.expect("the check has refused other equations of state")
}

fn gas(scene: &CheckedScene, body: usize) -> GasState {
    let material = scene.material_of(body);
    let Eos::IdealGas(IdealGasParameters { gamma }) = material.eos else {
        unreachable!("the check has refused other equations of state")
    };
    let (p, u) = (scene.scene.bodies[body].pressure, scene.speed_along(body));
    GasState { rho: material.density, u, p, gamma }
}

/// The Mie-Grueneisen material of a body at zero pressure with a straight Us-up line.
fn straight_at_rest(scene: &CheckedScene, body: usize) -> Option<MieGruneisen> {
    let material = scene.material_of(body);
    let free = scene.scene.bodies[body].pressure == 0.0;
    material.eos.straight(material.density).filter(|_| free)
}

/// The shock fronts that a wall sends into a body of any other material.
fn fronts(
    scene: &CheckedScene,
    body: usize,
    wall: &scene::Wall,
) -> Result<WallMaterial, ExactError> {
    let eos = constitutive::equation(scene.material_of(body)).ok().flatten();
    let eos = eos.ok_or(ExactError::NoImpact("the body has no equation of state"))?;
    let rest = HugoniotState::at_rest(&*eos, scene.scene.bodies[body].pressure, 0.0);
    let fronts = hugoniot::piston(&*eos, &rest, scene.closing_speed(wall, body))?;
    let point =
        |s: &HugoniotState| ProfilePoint { x: 0.0, p: s.p, u: s.u, rho: s.density(&*eos), e: s.e };
    let (speed, precursor) = match &fronts[..] {
        [first, last] => (last.speed, Some((point(&first.behind), first.speed))),
        _ => (fronts[0].speed, None),
    };
    Ok(WallMaterial::Fronts { ahead: point(&rest), precursor, speed })
}

/// The bodies of an impact as input of the exact solution, and their indices.
///
/// # Errors
///
/// If the bodies do not approach each other, or if a material cannot reach the impact state.
///
/// # Panics
///
/// If `named` is not the reference of this scene.
pub fn impact_of(
    scene: &CheckedScene,
    named: &scene::FlyerImpact,
) -> Result<(Impact, [usize; 2]), ExactError> {
    let numbers = [body_named(scene, &named.flyer), body_named(scene, &named.target)];
    let [flyer, target] = numbers.map(|b| {
        let [lower, upper] = scene.span(b).expect("the check has found the body's ends");
        let velocity = scene.speed_along(b);
        ImpactBody { material: solid(scene, b), lower, upper, velocity }
    });
    let impact = Impact::new(flyer, target)?;
    // spall would create a new rear surface
    let whole = scene.material_of(numbers[1]).failure.is_none();
    let free_rear = whole && scene.face_is_free(numbers[1], !impact.mirrored);
    Ok((Impact { free_rear, ..impact }, numbers))
}

impl Drive for scene::Course {
    fn velocity(&self, t: f64) -> f64 {
        self.at(t)
    }

    fn way(&self, t: f64) -> f64 {
        self.integral(t)
    }

    fn acceleration(&self, t: f64) -> f64 {
        self.slope(t)
    }

    fn kinks(&self) -> Vec<f64> {
        scene::Course::kinks(self)
    }
}

impl ReferenceSolution {
    /// The solution named by the scene, at its profile times and for its tracers.
    ///
    /// # Errors
    ///
    /// If the named solution does not exist for the bodies and materials of the scene.
    #[expect(clippy::missing_panics_doc, reason = "an invariant of this crate")]
    pub fn new(scene: &CheckedScene) -> Result<Option<ReferenceSolution>, ExactError> {
        let Some(named) = &scene.scene.reference else { return Ok(None) };
        Ok(Some(match named {
            scene::Reference::FlyerImpact(named) => {
                let (impact, [flyer, target]) = impact_of(scene, named)?;
                let histories = scene.scene.output.histories.iter();
                let tracers: Vec<TracedPoint> = histories
                    .flat_map(|h| &h.tracers)
                    .filter_map(|t| {
                        let body = body_named(scene, &t.body);
                        let plate = match body {
                            b if b == flyer => Plate::Flyer,
                            b if b == target => Plate::Target,
                            _ => return None,
                        };
                        Some(TracedPoint { plate, x: t.at[0] })
                    })
                    .collect();
                let arrivals = scene.scene.error_estimate.iter().flat_map(|e| &e.arrivals);
                let plate = match scene.estimated_body() {
                    Some(b) if b == flyer => Some(Plate::Flyer),
                    Some(b) if b == target => Some(Plate::Target),
                    _ => None,
                };
                let arrivals = plate
                    .into_iter()
                    .flat_map(|plate| arrivals.clone().map(move |&x| TracedPoint { plate, x }));
                let tracers: Vec<TracedPoint> = tracers.into_iter().chain(arrivals).collect();
                let mut times = scene.profile_times.clone();
                times.push(scene.scene.time.end);
                let solution = impact.solve(&times, &tracers, Accuracy::default())?;
                let chain = impact.chain(LAST_STATE)?;
                let all = ImpactReference { impact, chain, solution, flyer, target };
                ReferenceSolution::Impact(Box::new(all))
            }
            scene::Reference::Riemann(named) => {
                let (left, right) =
                    (body_named(scene, &named.left), body_named(scene, &named.right));
                ReferenceSolution::Riemann {
                    solution: RiemannSolution::solve(gas(scene, left), gas(scene, right))?,
                    diaphragm: scene.span(left).map_or(0.0, |[_, upper]| upper),
                }
            }
            scene::Reference::WallImpact(named) => {
                let body = body_named(scene, &named.body);
                let wall = scene.wall_struck_by(body).ok_or(ExactError::NoImpact(
                    "the body of the reference does not run into a wall",
                ))?;
                let extent = &scene.bodies[body];
                let material = match scene.material_of(body).eos {
                    Eos::IdealGas(IdealGasParameters { gamma }) => {
                        let state = gas(scene, body);
                        let e = state.p / ((gamma - 1.0) * state.rho);
                        WallMaterial::IdealGas { gamma, rho: state.rho, e }
                    }
                    _ => match straight_at_rest(scene, body) {
                        Some(material) => WallMaterial::MieGruneisen(material),
                        None => fronts(scene, body, &wall)?,
                    },
                };
                let solution = WallImpactSolution::new(
                    material,
                    extent.lower[0],
                    extent.upper[0],
                    scene.bodies[body].velocity[0],
                    !wall.upper,
                    wall.velocity,
                )?;
                ReferenceSolution::Wall { solution, body }
            }
            scene::Reference::SimpleWave(named) => {
                let body = body_named(scene, &named.body);
                let piston = scene.piston_at(body).expect("the check has found the piston");
                let extent = &scene.bodies[body];
                let solution = SimpleWaveSolution::new(
                    solid(scene, body),
                    extent.lower[0],
                    extent.upper[0],
                    !piston.upper,
                    piston.course,
                    scene.scene.time.end,
                )?;
                ReferenceSolution::SimpleWave { solution, body }
            }
            _ => return Ok(PlaneReference::new(scene).map(ReferenceSolution::Plane)),
        }))
    }

    /// Exact profile at profile time number `k` of the scene; `None` if there is none.
    pub fn profile(&self, scene: &CheckedScene, k: usize) -> Option<Profile> {
        let t = scene.profile_times[k];
        match self {
            ReferenceSolution::Impact(all) => all.solution.snapshots[k].target.clone(),
            ReferenceSolution::Riemann { solution, diaphragm } => {
                let [lower, upper] = scored_range(scene);
                Some(solution.profile(*diaphragm, t, lower, upper))
            }
            ReferenceSolution::Wall { solution, .. } => solution.profile(t),
            ReferenceSolution::SimpleWave { solution, .. } => solution.profile(t),
            ReferenceSolution::Plane(_) => None,
        }
    }

    /// Times at which the pressure at the positions of `error_estimate` first passes half of its
    /// maximum \[s\]; `None` if unknown.
    pub fn arrivals(&self, scene: &CheckedScene) -> Vec<Option<f64>> {
        let ReferenceSolution::Impact(all) = self else { return Vec::new() };
        let count = scene.scene.error_estimate.as_ref().map_or(0, |e| e.arrivals.len());
        // these tracers follow those of the histories
        let all = &all.solution.tracers;
        let arrival = |history: &History| {
            let peak = history.points.iter().map(|q| q.p).fold(0.0, f64::max);
            history.points.iter().find(|q| peak > 0.0 && q.p >= 0.5 * peak).map(|q| q.t)
        };
        all[all.len().saturating_sub(count)..].iter().map(arrival).collect()
    }

    /// Whether, in a plane, releases from the plate edges have reached the scored strip.
    pub fn edge_release_has_come(&self, scene: &CheckedScene, k: usize) -> bool {
        let ReferenceSolution::Impact(all) = self else { return false };
        if scene.dimension == 1 {
            return false;
        }
        let edge = scene.edge_distance(all.flyer).min(scene.edge_distance(all.target));
        let scored = scene.front().and_then(|front| front.half_width).unwrap_or(f64::INFINITY);
        if edge == f64::INFINITY {
            return false;
        }
        EdgeRelease::new(&all.impact, edge)
            .is_ok_and(|release| release.untouched_half_width(scene.profile_times[k]) < scored)
    }

    /// The scored body; `None`: all bodies.
    fn scored(&self) -> Option<usize> {
        match self {
            ReferenceSolution::Impact(all) => Some(all.target),
            ReferenceSolution::Wall { body, .. } | ReferenceSolution::SimpleWave { body, .. } => {
                Some(*body)
            }
            ReferenceSolution::Plane(plane) => Some(plane.body),
            ReferenceSolution::Riemann { .. } => None,
        }
    }

    /// In a plane: means of the scored particles over strips whose length along the direction of
    /// the waves is `cells` \[cells\].
    pub fn samples_along(
        &self,
        scene: &CheckedScene,
        table: &ParticleTable,
        cells: f64,
    ) -> Vec<ScoreSample> {
        plane_samples(scene, table, self.scored(), cells * scene.cell_size[0])
    }

    /// In a plane: the scored particles in the strip along the waves.
    pub fn particles_along(&self, scene: &CheckedScene, table: &ParticleTable) -> Vec<AlongWave> {
        let line = wave_line(scene);
        let points = plane_points(scene, table, self.scored());
        let state = |q: &PlanePoint| AlongWave {
            x: line.along(q.x),
            u: line.normal()[0] * q.v[0] + line.normal()[1] * q.v[1],
            p: q.p,
        };
        let in_strip = |q: &&PlanePoint| line.across(q.x).abs() < half_width(scene);
        points.iter().filter(in_strip).map(state).collect()
    }

    /// Scores of the particles at profile time number `k`: unaveraged, and averaged over cells.
    /// `None` if no exact solution holds.
    pub fn score(
        &self,
        scene: &CheckedScene,
        k: usize,
        table: &ParticleTable,
    ) -> Option<(Errors, Errors)> {
        let exact = self.profile(scene, k)?;
        let h = scene.cell_size[0];
        let scored = self.scored();
        if self.edge_release_has_come(scene, k) {
            return None;
        }
        let (samples, averaged) = match scene.dimension {
            1 => {
                let samples = samples(scene, table, scored);
                let averaged = cell_average(&samples, h, scene.scene.domain.lower[0]);
                (samples, averaged)
            }
            // particles at the same position along the wave differ by their position in the cell
            _ => [0.5, 1.0].map(|cells| self.samples_along(scene, table, cells)).into(),
        };
        let time = scene.profile_times[k];
        let judge = |samples: &[ScoreSample]| match self {
            ReferenceSolution::Impact(all) => {
                let marks = all.solution.snapshots[k].landmarks.as_ref()?;
                let mut errors = score(samples, &exact, marks, h);
                if let Some((density, energy)) = interface_errors(samples, &exact, marks, h) {
                    errors.density_interface = Some(density);
                    errors.energy_interface = Some(energy);
                }
                Some(errors)
            }
            ReferenceSolution::Wall { solution, .. } => {
                Some(score(samples, &exact, &solution.landmarks(time)?, h))
            }
            ReferenceSolution::SimpleWave { solution, .. } => {
                Some(score(samples, &exact, &solution.landmarks(time)?, h))
            }
            ReferenceSolution::Plane(_) => None,
            ReferenceSolution::Riemann { .. } => {
                let [lower, upper] = scored_range(scene);
                Some(score_density(samples, &exact, lower, upper))
            }
        };
        Some((judge(&samples)?, judge(&averaged)?))
    }
}

/// The range along the wave direction in which gases are scored [m].
fn scored_range(scene: &CheckedScene) -> [f64; 2] {
    let domain = &scene.scene.domain;
    scene.front().and_then(|front| front.range).unwrap_or([domain.lower[0], domain.upper[0]])
}

/// The wave direction in a plane.
fn wave_line(scene: &CheckedScene) -> PlaneWave {
    let (about, angle) = scene.front().map_or(([0.0; 2], 0.0), |front| {
        // for waves along x, positions are those of the scene
        let about = [front.about[0], front.about[1]];
        (if front.angle == 0.0 { [0.0, about[1]] } else { about }, front.angle.to_radians())
    });
    PlaneWave::at_angle(about, angle).expect("the scene's numbers are finite")
}

/// Half of the width of the scored strip along the wave direction [m]; infinite without a limit.
fn half_width(scene: &CheckedScene) -> f64 {
    scene.front().and_then(|front| front.half_width).unwrap_or(f64::INFINITY)
}

/// The particles of `body` (or all) in a plane, as means over `width` [m] along the wave direction.
fn plane_samples(
    scene: &CheckedScene,
    table: &ParticleTable,
    body: Option<usize>,
    width: f64,
) -> Vec<ScoreSample> {
    wave_line(scene).binned(&plane_points(scene, table, body), half_width(scene), width)
}

/// The particles of `body` (or all) in a plane within the scored range.
fn plane_points(
    scene: &CheckedScene,
    table: &ParticleTable,
    body: Option<usize>,
) -> Vec<PlanePoint> {
    let column = |name| table.column(name).expect("the table has its own columns");
    let [x, y] = ["x", "y"].map(column);
    let [vx, vy] = ["velocity_x", "velocity_y"].map(column);
    let [p, rho, e, volume] =
        ["pressure", "density", "specific_internal_energy", "volume"].map(column);
    let line = wave_line(scene);
    let range = scene.front().and_then(|front| front.range);
    let scored = |&r: &usize| {
        body.is_none_or(|b| table.body[r] as usize == b)
            && range.is_none_or(|[from, to]| (from..=to).contains(&line.along([x[r], y[r]])))
    };
    (0..table.len())
        .filter(scored)
        .map(|r| PlanePoint {
            x: [x[r], y[r]],
            v: [vx[r], vy[r]],
            volume: volume[r],
            p: p[r],
            rho: rho[r],
            e: e[r],
        })
        .collect()
}

/// The particles of `body` (or all) as samples.
fn samples(scene: &CheckedScene, table: &ParticleTable, body: Option<usize>) -> Vec<ScoreSample> {
    let column = |name| table.column(name).expect("the table has its own columns");
    let (x, p) = (column("x"), column("pressure"));
    let (rho, e) = (column("density"), column("specific_internal_energy"));
    let volumes = table.column("volume");
    (0..table.len())
        .filter(|&r| body.is_none_or(|b| table.body[r] as usize == b))
        .map(|r| {
            // all particles of a body have the same mass
            let b = table.body[r] as usize;
            let body = &scene.bodies[b];
            let length = (body.upper[0] - body.lower[0]) / body.lattice[0] as f64;
            let volume = match volumes {
                Some(volumes) => volumes[r],
                None => length * scene.material_of(b).density / rho[r],
            };
            ScoreSample { x: x[r], volume, p: p[r], rho: rho[r], e: e[r] }
        })
        .collect()
}
