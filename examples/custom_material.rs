//! A material from outside: an equation of state and a strength that the library does not know,
//! in a run of this process.
//!
//! ```sh
//! cargo run --release --example custom_material
//! ```

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::material::constitutive::CustomModel;
use flyer_mpm::material::strength::{MaterialState, StrengthLaw};
use flyer_mpm::material::{EquationOfState, LinearPressure};
use flyer_mpm::simulation::Simulation;

/// Murnaghan's cold curve (1944) with Grueneisen's thermal pressure, Gamma rho constant:
/// p = pc(J) + Gamma0 rho0 (e - ec(J)), pc = K/n (J^-n - 1), ec its work.
#[derive(Clone, Copy)]
struct Murnaghan {
    /// Density [kg/m3].
    rho0: f64,
    /// Bulk modulus K [Pa].
    modulus: f64,
    /// Its slope n over the pressure [-].
    slope: f64,
    /// Gamma0 [-].
    gamma0: f64,
}

impl Murnaghan {
    fn cold(&self, j: f64) -> f64 {
        self.modulus / self.slope * (j.powf(-self.slope) - 1.0)
    }
}

impl EquationOfState for Murnaghan {
    fn reference_density(&self) -> f64 {
        self.rho0
    }

    fn linear(&self, j: f64) -> LinearPressure {
        let n = self.slope;
        // rho0 ec
        let work = self.modulus / n * ((j.powf(1.0 - n) - 1.0) / (n - 1.0) + j - 1.0);
        LinearPressure {
            reference_pressure: self.cold(j) - self.gamma0 * work,
            gruneisen_rho: self.gamma0 * self.rho0,
        }
    }

    fn sound_speed_squared(&self, j: f64, pressure: f64) -> f64 {
        let stiffness = self.modulus * j.powf(-self.slope - 1.0);
        j * j / self.rho0 * (stiffness + self.gamma0 * (pressure - self.cold(j)))
    }

    fn check_validity(&self, j: f64, _pressure: f64) -> Option<&'static str> {
        (j > 1.2).then_some("beyond the tension that Murnaghan's curve is meant for")
    }
}

/// A yield stress that grows with the pressure, up to a limit: Y = min(Y0 + b p, Ymax).
#[derive(Clone, Copy)]
struct Pressed {
    shear_modulus: f64,
    yield_stress: f64,
    slope: f64,
    most: f64,
}

impl StrengthLaw for Pressed {
    fn shear_modulus(&self, _at: &MaterialState) -> f64 {
        self.shear_modulus
    }

    fn yield_stress(&self, _strain: f64, _rate: f64, at: &MaterialState) -> f64 {
        (self.yield_stress + self.slope * at.pressure.max(0.0)).min(self.most)
    }
}

const METAL: Murnaghan = Murnaghan { rho0: 2790.0, modulus: 79e9, slope: 4.4, gamma0: 2.0 };
const STRONG: Pressed =
    Pressed { shear_modulus: 28.6e9, yield_stress: 0.3e9, slope: 0.05, most: 2e9 };

/// Speed of the piston [m/s]: so fast that the shock outruns its elastic precursor.
const SPEED: f64 = 1500.0;

/// The slab runs into a wall. The models that it names give way to those above.
const SCENE: &str = r#"{
  "title": "A slab of a material from outside",
  "domain": {"lower": [0.0], "upper": [0.003], "cell_size": 2e-5},
  "time": {"end": 2e-7, "courant": 0.4},
  "method": {
    "shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 6}, "stepping": "midpoint",
    "energy": "compatible", "filter_heat": true,
    "pressure_relaxation": {"rate": 0.1, "interval": 1}, "edge_mask": 0.3
  },
  "materials": {"metal": {
    "density": 2790.0,
    "eos": {"type": "ideal_gas", "gamma": 1.4},
    "strength": {"type": "von_mises", "shear_modulus": 1e9, "yield_stress": 1e8}
  }},
  "bodies": [{
    "name": "slab", "material": "metal", "box": {"lower": [0.0], "upper": [0.0025]},
    "velocity": [-1500.0], "particles_per_cell": [2]
  }],
  "artificial_viscosity":
    {"linear": 0.1, "quadratic": 1.25, "limiter": "christensen", "limited": "linear"},
  "boundary": {"x_lower": "wall"}
}"#;

/// A quantity behind the shock.
pub struct Figure {
    /// Its name and unit.
    pub name: &'static str,
    /// By the run.
    pub run: f64,
    /// By the jump conditions.
    pub exact: f64,
}

/// Axial stress and pressure [Pa] and J behind the shock: momentum gives
/// u^2 = sigma (1 - J)/rho0, energy e = u^2/2, and the flow law sigma = p + 2/3 Y(p).
fn jump() -> (f64, f64, f64) {
    let energy = 0.5 * SPEED * SPEED;
    let state = |j: f64| {
        let pressure = METAL.pressure(j, energy);
        let at = MaterialState { compression: 1.0 / j, pressure, temperature: f64::NAN };
        (pressure + 2.0 / 3.0 * STRONG.yield_stress(0.0, 0.0, &at), pressure)
    };
    let (mut low, mut high) = (0.5, 1.0);
    for _ in 0..60 {
        let j = 0.5 * (low + high);
        let speed_squared = state(j).0 * (1.0 - j) / METAL.rho0;
        if speed_squared > SPEED * SPEED { low = j } else { high = j }
    }
    let (stress, pressure) = state(low);
    (stress, pressure, low)
}

/// Runs the slab and compares its plateau with the jump conditions.
///
/// # Errors
///
/// What is wrong with the scene or its run.
pub fn plateau() -> Result<Vec<Figure>, Box<dyn std::error::Error>> {
    let scene = input::parse(SCENE.as_bytes(), "custom_material", &[])?;
    let models = |material: &str| {
        (material == "metal").then(|| CustomModel::fluid(METAL).with_strength(STRONG))
    };
    let mut simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models)?;
    let end = scene.scene.time.end;
    while simulation.time() < end {
        simulation.advance(end)?;
    }
    let (table, _) = simulation.gather().ok_or("rank 0 holds the particles")?;
    let column = |name: &str| table.column(name).ok_or_else(|| format!("no column {name}"));
    let x = column("x")?;
    let (stress, pressure, j) = jump();
    // as seen from the wall
    let shock = SPEED * j / (1.0 - j) * end;
    let behind: Vec<usize> =
        (0..x.len()).filter(|&r| (0.3 * shock..0.8 * shock).contains(&x[r])).collect();
    let mean = |name: &str| -> Result<f64, String> {
        let values = column(name)?;
        Ok(behind.iter().map(|&r| values[r]).sum::<f64>() / behind.len() as f64)
    };
    Ok(vec![
        Figure { name: "axial stress [Pa]", run: -mean("stress_xx")?, exact: stress },
        Figure { name: "pressure [Pa]", run: mean("pressure")?, exact: pressure },
        Figure { name: "density [kg/m3]", run: mean("density")?, exact: METAL.rho0 / j },
    ])
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{:<20} {:>14} {:>14} {:>10}", "behind the shock", "run", "jump", "apart");
    for Figure { name, run, exact } in plateau()? {
        let apart = format!("{:.3} %", 100.0 * (run / exact - 1.0));
        println!("{name:<20} {run:>14.6e} {exact:>14.6e} {apart:>10}");
    }
    Ok(())
}
