//! The commands `calibrate` and `predict`.

use std::path::PathBuf;

use decomp::Comm;
use flyer_mpm::driver::output::origin::check_target;
use flyer_mpm::driver::output::wrap::warning;
use flyer_mpm::input;
use flyer_mpm::input::input_file;
use flyer_mpm::perf_model::calibrate;
use flyer_mpm::perf_model::{
    Against, Machine, Network, Work, forecast, machine_table, ranks_to, table,
};
use flyer_mpm::scene::{CellSize, CheckedScene};
use flyer_mpm::simulation::{Preview, may_skip};
use serde_json::Value;

use crate::cli::PredictArgs;
use crate::{FAILED, Outcome, bad, read_scene, say};

/// Default scene for `calibrate`.
const FLYER: &str = include_str!("../../inputs/flyer.json");

/// Arguments of `calibrate`.
pub struct Order {
    /// The scene file, if given.
    pub scene: Option<PathBuf>,
    /// Overrides of the scene.
    pub set: Vec<String>,
    /// File of the constants.
    pub output: PathBuf,
    /// Measuring time \[s\].
    pub seconds: f64,
    /// Whether samples are printed.
    pub samples: bool,
}

/// Measures the constants and writes them. Collective.
pub fn calibrate(comm: &dyn Comm, order: &Order) -> Outcome<()> {
    let Order { scene: file, set: sets, output, seconds, samples } = order;
    let file = file.as_deref();
    let name = file.map_or("flyer.json".into(), |f| f.display().to_string());
    let mine = match (comm.rank(), file) {
        (0, Some(file)) => input::read(file).map_err(bad),
        (0, None) => Ok(FLYER.as_bytes().to_vec()),
        _ => Ok(Vec::new()),
    };
    // rank 0 checks everything that could fail before it sends the scene to the other ranks
    let mine = mine.and_then(|bytes| {
        if comm.rank() == 0 {
            input::parse(&bytes, &name, sets).map_err(bad)?;
            input_file::check_place(output)
                .map_err(|fault| bad(format!("{}: {fault}", output.display())))?;
            check_target(output, "a machine file of `flyer-mpm perf calibrate`", |text| {
                let there: Option<Value> = serde_json::from_str(text).ok();
                there.is_some_and(|there| there.get("processor").is_some())
            })
            .map_err(bad)?;
        }
        Ok(bytes)
    });
    let (bytes, verdict) = match mine {
        Ok(bytes) => (bytes, Ok(())),
        Err(error) => (Vec::new(), Err(error)),
    };
    let bytes = comm.broadcast(bytes);
    verdict?;
    if bytes.is_empty() {
        return Err((crate::BAD_INPUT, String::new()));
    }
    let checked = input::parse(&bytes, &name, sets).map_err(bad)?;
    if comm.rank() == 0 {
        eprintln!("calibrating about {seconds:.0} s: {}", checked.scene.title);
        if comm.size() > 1 && calibrate::cores() == 1 {
            let text = "this rank has one core, so threads and a second busy core are not \
                        measured; mpirun --bind-to none gives it all";
            eprintln!("{}", warning(text));
        }
    }
    let found =
        calibrate::calibrate(comm, &checked, *seconds).map_err(|e| (FAILED, e.to_string()))?;
    let Some((machine, residuals)) = found else { return Ok(()) };
    machine
        .write(output)
        .map_err(|e| (FAILED, format!("{}: cannot be written: {e}", output.display())))?;
    if *samples {
        say("particles patches threads halo measured_us fitted_us deviation_%\n");
        for r in &residuals {
            say(&format!(
                "{:.0} {} {} {:?} {:.2} {:.2} {:+.1}\n",
                r.particles,
                r.patches,
                r.threads,
                r.halo,
                r.measured * 1e6,
                r.fitted * 1e6,
                100.0 * (r.fitted / r.measured - 1.0)
            ));
        }
    }
    say(&machine_table(&machine));
    say(&format!("constants in {}\n", output.display()));
    Ok(())
}

/// Predicts the performance of a scene, or compares predictions with studies.
pub fn predict(args: &PredictArgs) -> Outcome<String> {
    let (bytes, checked) = read_scene(&args.scene, false)?;
    let machine = Machine::read(&args.machine).map_err(bad)?;
    machine.fits(&checked, &args.machine).map_err(bad)?;
    let network = Network::parse(&args.network, &machine.network).map_err(bad)?;
    if args.against.is_empty() {
        let threads = args.threads.unwrap_or(checked.scene.decomposition.threads);
        let dt = first_time_step(&checked)?;
        let steps = (checked.scene.time.end / dt).ceil();
        let ranks = ranks_to(&args.ranks);
        let forecast = forecast(&machine, &network, &checked, &ranks, threads);
        let head = format!(
            "{}: {} particles, {} cells, about {steps:.0} steps; {}; a checkpoint has {:.3} MB\n",
            checked.scene.title,
            checked.particles,
            checked.cell_count(),
            match may_skip(&checked) {
                true => "patches at rest are skipped until a wave arrives",
                false => "every particle computed",
            },
            1e-6 * Work::new(&checked).checkpoint_bytes
        );
        return Ok(head + &table(&machine, &network, &forecast, steps));
    }
    let mut all = Vec::new();
    for path in &args.against {
        let study = Against::read(path).map_err(bad)?;
        let mut sets = args.scene.set.clone();
        sets.extend(study.sets.iter().cloned());
        sets.push("decomposition.skip_quiescent=false".into());
        let file = args.scene.scene.display().to_string();
        let scene = input::parse(&bytes, &file, &sets).map_err(bad)?;
        machine.fits(&scene, &args.machine).map_err(bad)?;
        all.extend(study.compare(&machine, &network, &scene, path).map_err(bad)?);
    }
    Ok(Against::table(&machine, &all))
}

/// Largest number of particles created to find the first time step.
const MOST_PARTICLES: u64 = 200_000;

/// The first Courant time step \[s\]. For a large scene it is scaled from larger cells, because the
/// time step is proportional to the cell size.
fn first_time_step(scene: &CheckedScene) -> Outcome<f64> {
    let failed = |e: &dyn std::fmt::Display| (FAILED, e.to_string());
    let coarser = coarsened(scene);
    let (scene, factor) = coarser.as_ref().map_or((scene, 1.0), |(s, f)| (s, *f));
    let preview = Preview::new(scene).map_err(|e| failed(&e))?;
    Ok((preview.first_step / factor).min(scene.scene.time.end))
}

/// The scene with cells so much larger that it has few particles, and the ratio of cell sizes.
fn coarsened(scene: &CheckedScene) -> Option<(CheckedScene, f64)> {
    if scene.particles <= MOST_PARTICLES {
        return None;
    }
    let least = scene.particles.div_ceil(MOST_PARTICLES) as usize;
    // particles grow with the power of the dimension
    let least = (least as f64).powf(1.0 / scene.dimension as f64).ceil() as usize;
    let divides = |k: &usize| scene.cells.iter().all(|cells| cells.is_multiple_of(*k));
    let factors = (least..least * 16).filter(divides);
    factors.take(8).find_map(|k| {
        let mut new = scene.scene.clone();
        let sizes: Vec<f64> = scene.cell_size.iter().map(|size| size * k as f64).collect();
        new.domain.cell_size = match sizes[..] {
            [size] => CellSize::Uniform(size),
            _ => CellSize::PerDirection(sizes),
        };
        new.domain.patches = None;
        input::check(new, &scene.file).ok().map(|checked| (checked, k as f64))
    })
}
