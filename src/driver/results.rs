//! The results of a run that has reached its end: files, pictures, summary.

use super::balance::{balance, gone};
use super::failure::RunFailure;
use super::profiles::{draw, write_profiles};
use super::rank_statistics::{self, Costs, LoopUse};
use super::run::Run;
use crate::accuracy::estimate::{
    self, Answer, EstimatedErrors, FieldEstimate, Laws, fields, least_pressure_of_all,
    tensile_failure,
};
use crate::accuracy::plan;
use crate::accuracy::reference::ReferenceSolution;
use crate::driver::checkpoint::folder;
use crate::driver::measured;
use crate::driver::output::brief::brief;
use crate::driver::output::field_files::{FIELDS_FILE, FIELDS_FOLDER};
use crate::driver::output::folder::{OutputFolder, checkpoint_folder};
use crate::driver::output::gauges;
use crate::driver::output::histories::HISTORIES_FILE;
use crate::driver::output::origin::Maker;
use crate::driver::output::report::full;
use crate::driver::output::summary::{FailureSummary, ProfileSummary, SUMMARY_FORMAT, Summary};
use crate::driver::output::trace::write_trace;
use crate::driver::output::unfinished::{self, unfinished_folder};
use crate::driver::output::vtkhdf::{RESULTS_FILE, RunInfo, write_vtkhdf};
use crate::driver::readings::{gauge_readings, gauge_records, report_readings};
use crate::driver::recorder::most_particles;
use crate::effects::ledger;
use crate::simulation::{BoundaryWork, Compiled, ParticleTable, RemovedByKind, Totals};
use crate::solver::Stepper;
use crate::solver::clock::user_cpu_seconds;

/// Sums over all ranks at the end of a run.
struct Sums<const D: usize> {
    totals: Totals<D>,
    removed: RemovedByKind<D>,
    given: BoundaryWork<D>,
    /// Number of particles that fill more than a cell.
    stretched: u64,
    /// Change of the energy that nothing explains, over the energy that the bodies bring [-].
    energy_change: f64,
}

impl<const D: usize> Run<'_, D>
where
    Stepper<D>: Compiled<D>,
{
    /// Writes all files of a run that has `used` this in its time loop; returns the final table at
    /// rank 0. Collective.
    pub(super) fn write_results(mut self, used: &LoopUse) -> Result<Option<String>, RunFailure> {
        let sums = Sums {
            totals: self.simulation.totals(),
            removed: self.simulation.ways(),
            given: self.simulation.given(),
            stretched: self.simulation.stretched(),
            energy_change: self.simulation.energy_change(),
        };
        let (comm, sharing) = (self.comm, &self.scene.scene.decomposition);
        let costs = rank_statistics::costs(comm, &mut self.simulation, sharing, used);
        if let Some((path, _)) = &self.options.trace {
            let events = rank_statistics::timeline(comm, &mut self.simulation);
            if comm.rank() == 0 {
                write_trace(path, &events)?;
            }
        }
        // the other ranks wait for this rank at the end
        let Some(costs) = costs else { return Ok(None) };
        // pictures and tables take memory that no other rank needs
        self.simulation.release_particles();
        let mut warnings = self.scene.warnings.clone();
        let reference = self.reference(&mut warnings);
        comm.heartbeat();
        let fields = self.compare_fields();
        let maker = Maker::with(self.recorder.origin.clone(), self.scene);
        let folder = OutputFolder::create(&self.options.output, self.options.keep, &maker)?;
        let profiles = self.write_files(reference.as_ref(), &folder)?;
        warnings.extend(self.warnings(&sums));
        let summary = Summary {
            origin: Some(folder.origin()),
            warnings,
            ..self.summary(sums, costs, reference.as_ref(), profiles, fields)
        };
        summary.write(folder.path())?;
        let unfinished = unfinished_folder(&self.options.output)?;
        unfinished::finish(&unfinished, folder.path(), &[FIELDS_FILE, FIELDS_FOLDER])?;
        let place = folder.commit()?;
        if self.schedule.passing {
            folder::clear(&checkpoint_folder(&self.options.output)?);
        }
        let text = if self.options.verbose { full } else { brief };
        let shown = report_readings(self.scene, &summary.gauges, self.options.verbose);
        let errors = summary.error_estimate.as_ref().map_or(&[][..], |e| &e.readings);
        Ok(Some(text(&summary, &place) + &gauges::report(&shown, errors)))
    }

    /// The exact solution, and warnings where there is none. A run without one still writes its files.
    fn reference(&self, warnings: &mut Vec<String>) -> Option<ReferenceSolution> {
        let reference = ReferenceSolution::new(self.scene).unwrap_or_else(|error| {
            warnings.push(format!("no exact solution: {error}"));
            None
        });
        if let Some(ReferenceSolution::Impact(all)) = &reference
            && let Some((time, why)) = &all.solution.stopped
        {
            warnings
                .push(format!("the exact solution ends at {time:.4e} s, before the run: {why}"));
        }
        reference
    }

    /// Writes profiles, histories and pictures; returns the errors of the profiles.
    fn write_files(
        &self,
        reference: Option<&ReferenceSolution>,
        folder: &OutputFolder,
    ) -> Result<Vec<ProfileSummary>, RunFailure> {
        let (comm, scene, recorder) = (self.comm, self.scene, &self.recorder);
        let profiles = write_profiles(comm, scene, reference, recorder, folder.path())?;
        if scene.scene.output.hdf5 {
            let bodies: Vec<String> = scene.scene.bodies.iter().map(|b| b.name.clone()).collect();
            let tables = self.tables();
            let as_run = serde_json::to_value(&scene.scene).expect("a scene is plain data");
            let info = RunInfo {
                title: &scene.scene.title,
                scene: &as_run,
                materials: tables.first().map_or(&[], |t| &t.materials),
                bodies: &bodies,
                axisymmetric: scene.axisymmetric(),
            };
            write_vtkhdf(&folder.file(RESULTS_FILE), &tables, &info)?;
            comm.heartbeat();
        }
        if let Some(histories) = recorder.histories() {
            histories.write(&folder.file(HISTORIES_FILE))?;
        }
        if scene.scene.output.pictures {
            draw(comm, scene, reference, recorder, &profiles, folder.path())?;
        }
        Ok(profiles)
    }

    /// The recorded profiles.
    fn tables(&self) -> Vec<&ParticleTable> {
        self.recorder.tables.iter().map(|t| &t.0).collect()
    }

    /// Error estimates of the fields of the scene. Adds to the profiles their differences from the run
    /// with cells twice as large.
    fn compare_fields(&mut self) -> Vec<FieldEstimate> {
        let quantities = self.scene.estimated_fields();
        let Some(coarse_runs) = self.coarse_runs.as_ref().filter(|_| !quantities.is_empty()) else {
            return Vec::new();
        };
        let factors = tensile_failure::factors(self.scene, &self.tables());
        let least = least_pressure_of_all(self.scene, self.simulation.steps());
        let mut estimates = Vec::new();
        for (k, (table, _)) in self.recorder.tables.iter_mut().enumerate() {
            let (found, differences) =
                fields::compare(table, k, &quantities, coarse_runs, factors[k], least);
            estimates.extend(found);
            table.columns.extend(differences);
            // a large table takes some time
            self.comm.heartbeat();
        }
        estimates
    }

    /// The run's own estimate of its errors; `None` unless the scene asks for it.
    fn error_estimate(
        &self,
        reference: Option<&ReferenceSolution>,
        profiles: &[ProfileSummary],
        fields: Vec<FieldEstimate>,
    ) -> Option<EstimatedErrors> {
        let coarse_runs = self.coarse_runs.as_ref()?;
        let (arrivals, steps) = (&self.recorder.arrivals, self.simulation.steps());
        let (scene, tables) = (self.scene, self.tables());
        let probes = self.recorder.probes();
        let gauges = probes.map(|probes| gauge_records(scene, probes, &self.simulation));
        let gauges = &gauges.unwrap_or_default();
        let answer = Answer { scene, tables, fields, gauges, arrivals, steps, reference };
        let mut estimates = estimate::estimate(&answer, coarse_runs, &Laws::shipped());
        for (estimate, profile) in estimates.profiles.iter_mut().zip(profiles) {
            estimate.l1.exact = profile.error("l1");
        }
        Some(estimates)
    }

    /// The summary, without its origin and warnings.
    fn summary(
        &self,
        sums: Sums<D>,
        costs: Costs,
        reference: Option<&ReferenceSolution>,
        profiles: Vec<ProfileSummary>,
        fields: Vec<FieldEstimate>,
    ) -> Summary {
        let (scene, simulation) = (self.scene, &self.simulation);
        let (ways, end) = (&sums.removed, &sums.totals);
        let histories = self.recorder.histories();
        let measured = measured::quantities(scene, reference, &profiles, &self.tables(), histories);
        let error_estimate = self.error_estimate(reference, &profiles, fields);
        let plan = scene.scene.output.plan.as_ref().map(|planned| {
            let seconds = [costs.loop_cpu, costs.loop_wall];
            let exact_l1: Vec<f64> = profiles.iter().filter_map(|p| p.error("l1")).collect();
            plan::verdict(planned, &exact_l1, error_estimate.as_ref(), seconds)
        });
        let times = [0.0, simulation.time()];
        let left = ways.outflow.and(&ways.erosion);
        let rounding = simulation.rounding_energy();
        let (energy, momentum) =
            balance(scene, times, [&self.start, end], &left, &sums.given, rounding);
        let lets_out = scene.has_side(|side| side.lets_out);
        let particle_steps = scene.particles as f64 * simulation.steps_made() as f64;
        Summary {
            format: SUMMARY_FORMAT,
            title: scene.scene.title.clone(),
            version: env!("CARGO_PKG_VERSION").into(),
            commit: self.options.commit.map(String::from),
            machine: self.machine.clone(),
            origin: None,
            scene: serde_json::to_value(&scene.scene).expect("a scene is plain data"),
            method_choice: scene.method_choice.clone(),
            ranks: self.comm.size(),
            threads: self.options.threads,
            patches: simulation.layout().parts().to_vec(),
            particles: scene.particles,
            cells: scene.cell_count(),
            steps: simulation.steps(),
            wall_seconds: self.options.started.elapsed().as_secs_f64(),
            loop_wall_seconds: costs.loop_wall,
            loop_cpu_seconds: costs.loop_cpu,
            cpu_seconds: user_cpu_seconds() + costs.others_cpu,
            particle_steps_per_cpu_second: particle_steps / costs.loop_cpu,
            phase_seconds: costs.decomposition.seconds(),
            decomposition: costs.decomposition,
            effects: ledger(scene, simulation.columns(), costs.step_shares.as_deref()),
            energy,
            momentum,
            outflow: lets_out.then(|| gone(&ways.outflow)),
            erosion: scene.erodes().then(|| gone(&ways.erosion)),
            failure: simulation.columns().may_fail().then_some(FailureSummary {
                particles: end.failed,
                damaged: end.damaged,
                released_energy: end.released,
            }),
            measured,
            gauges: (self.recorder.probes())
                .map_or(Vec::new(), |probes| gauge_readings(scene, probes, simulation)),
            profiles,
            error_estimate,
            plan,
            warnings: Vec::new(),
        }
    }

    /// Warnings about the accuracy of the run.
    fn warnings(&mut self, sums: &Sums<D>) -> Vec<String> {
        let redone = self.simulation.tally().redone_steps;
        let mut all = inaccurate(sums.energy_change, sums.stretched, redone);
        all.extend(self.simulation.peaks().warnings());
        let bodies = &self.scene.scene.bodies;
        all.extend(self.simulation.self_contact().map(|e| e.warning(&bodies[e.body].name)));
        all.extend(self.simulation.profile_block(most_particles(self.scene)).map(|edge| {
            format!(
                "the profiles hold means over blocks of {edge} cells along each edge, for the scene \
                 has more particles than output.profiles.max_particles"
            )
        }));
        all
    }
}

/// Drift of energy above which a run reports that it is inaccurate [-].
const DRIFT_TOLD: f64 = 0.01;

/// Warnings about the accuracy of a run that has ended normally, one line each.
fn inaccurate(energy_change: f64, stretched: u64, redone: u64) -> Vec<String> {
    let drift = (energy_change.abs() > DRIFT_TOLD).then(|| {
        format!(
            "energy has drifted by {:+.2} % of what the bodies bring: the scheme does not keep it, and shocks are wrong \
             with it; method.stepping \"midpoint\" with method.energy \"compatible\" and \
             method.filter_heat keep it to rounding",
            100.0 * energy_change
        )
    });
    let stretched = (stretched > 0).then(|| {
        format!(
            "{stretched} particles fill more than a cell each, further than the shape function \
             takes them to reach: gaps may have opened between them; more particles a cell, or \
             method.shape \"cpdi_bspline_quadratic\""
        )
    });
    let redone = (redone > 0).then(|| {
        format!(
            "{redone} times a step was redone half as long, as monitor.on_alarm = \"redo\" asks"
        )
    });
    drift.into_iter().chain(stretched).chain(redone).collect()
}
