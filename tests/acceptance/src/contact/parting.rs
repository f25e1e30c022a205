//! Twenty impacts of softer flyers, drawn at random: the momentum that the target gets, the tension
//! between the plates, and the time at which they part.

use decomp::Serial;
use flyer_mpm::exact::{Accuracy, HistoryPoint, Impact, ImpactBody, Separation};
use flyer_mpm::input;
use flyer_mpm::material::MieGruneisen;
use flyer_mpm::simulation::{Compiled, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::bounds::{Bound, contact::parting as bounds};
use crate::table::Table;

/// A material: name, density \[kg/m3\], c0 \[m/s\], s \[-\], gamma0 \[-\]; S. P. Marsh (1980), LASL
/// Shock Hugoniot Data, and M. A. Meyers (1994), Dynamic Behavior of Materials, table 5.1.
type Material = (&'static str, f64, f64, f64, f64);

const MATERIALS: [Material; 14] = [
    ("copper", 8930.0, 3940.0, 1.489, 1.96),
    ("aluminium", 2785.0, 5386.0, 1.339, 2.1),
    ("silver", 10490.0, 3229.0, 1.595, 2.38),
    ("beryllium", 1851.0, 7998.0, 1.124, 1.16),
    ("indium", 7279.0, 2419.0, 1.536, 1.80),
    ("magnesium", 1740.0, 4492.0, 1.263, 1.42),
    ("molybdenum", 10206.0, 5124.0, 1.233, 1.52),
    ("tin", 7287.0, 2608.0, 1.486, 2.11),
    ("uranium", 18950.0, 2487.0, 2.200, 1.56),
    ("zinc", 7138.0, 3005.0, 1.581, 1.96),
    ("zirconium", 6505.0, 3757.0, 1.018, 1.09),
    ("brass", 8450.0, 3726.0, 1.434, 2.04),
    ("polystyrene", 1044.0, 2746.0, 1.319, 1.18),
    ("polycarbonate", 1193.0, 1933.0, 1.420, 0.61),
];

/// Number of impacts.
const COUNT: usize = 20;

/// Edge of a cell [m].
const CELL: f64 = 1e-5;

/// Height of the column in a plane [cells].
const ROWS: u32 = 2;

/// An impact whose plates part.
struct Parting {
    /// Flyer and target.
    materials: [Material; 2],
    /// Speed of the flyer [m/s].
    speed: f64,
    /// Thickness of the flyer and of the target [m].
    lengths: [f64; 2],
    /// End of the run [s].
    end: f64,
    exact: Separation,
}

/// Numbers from 0 to 1 (Knuth's linear congruential generator).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn eos((_, rho0, c0, s, gamma0): Material) -> MieGruneisen {
    MieGruneisen { rho0, c0, s, gamma0 }
}

/// The impacts: pairs of materials of which the flyer is the softer one, speeds from 200 to 3000
/// m/s, and flyers of 15 to 60 cells.
fn impacts() -> Vec<Parting> {
    let (mut draw, mut found) = (Draw(7), Vec::new());
    while found.len() < COUNT {
        let mut pair = [0, 1].map(|_| MATERIALS[(draw.next() * MATERIALS.len() as f64) as usize]);
        pair.sort_by(|a, b| (a.1 * a.2).total_cmp(&(b.1 * b.2)));
        let speed = (200.0 * 15f64.powf(draw.next())).round();
        let thickness = (15.0 + 45.0 * draw.next()).round() * CELL;
        let [flyer, target] = pair;
        // waves from the rear of the target do not return before the end
        let end = 4.0 * thickness / flyer.2;
        let length = (0.6 * end * (target.2 + target.3 * speed) / CELL).ceil() * CELL;
        let plate = |material, lower, upper, velocity| ImpactBody {
            material: eos(material),
            lower,
            upper,
            velocity,
        };
        let [left, right] = [plate(flyer, -thickness, 0.0, speed), plate(target, 0.0, length, 0.0)];
        let exact = Impact::new(left, right)
            .and_then(|impact| Separation::new(&impact, end, Accuracy { wavelets: 120 }));
        // some pairs stay together, and some materials do not reach such pressures
        if let Ok(Some(exact)) = exact
            && exact.separation_time < 0.75 * end
        {
            found.push(Parting {
                materials: pair,
                speed,
                lengths: [thickness, length],
                end,
                exact,
            });
        }
    }
    found
}

impl Parting {
    /// The scene with a frame, on a line or as a column in a plane.
    fn scene(&self, frame: &str, dimension: usize) -> Value {
        let [thickness, length] = self.lengths;
        let way = ((self.speed * self.end / CELL).ceil() + 20.0) * CELL;
        let height = f64::from(ROWS) * CELL;
        let point = |x: f64, y: f64| json!(&[x, y][..dimension]);
        let mut materials = json!({});
        for (name, rho, c0, s, gamma0) in self.materials {
            materials[name] = json!({"density": rho, "eos":
                {"type": "mie_gruneisen", "c0": c0, "s": s, "gamma0": gamma0}});
        }
        let body = |k: usize, name: &str, lower: f64, upper: f64, velocity: f64| {
            json!({
                "name": name, "material": self.materials[k].0,
                "box": {"lower": point(lower, 0.0), "upper": point(upper, height)},
                "velocity": point(velocity, 0.0), "particles_per_cell": vec![2; dimension]
            })
        };
        let mut scene = json!({
            "title": "a softer flyer",
            "domain": {
                "lower": point(-thickness - way, 0.0), "upper": point(length + way, height),
                "cell_size": CELL
            },
            "time": {"end": self.end, "courant": 0.4},
            "method": {"preset": "default", "frame": frame},
            "materials": materials,
            "bodies": [
                body(0, "flyer", -thickness, 0.0, self.speed), body(1, "target", 0.0, length, 0.0)
            ],
            "contact": {"type": "frictionless"}
        });
        if dimension == 2 {
            scene["boundary"] = json!({"y_lower": "symmetry", "y_upper": "symmetry"});
        }
        scene
    }

    /// Length of each step, time at its end and pressure between the plates in it.
    fn run<const D: usize>(&self, frame: &str) -> Result<Vec<[f64; 3]>, String>
    where
        Stepper<D>: Compiled<D>,
    {
        let text = self.scene(frame, D).to_string();
        let scene = input::parse(text.as_bytes(), "scene.json", &[]).map_err(|e| e.to_string())?;
        let mut simulation = Simulation::<D>::new(&scene, &Serial, 1).map_err(|e| e.to_string())?;
        let area = if D == 1 { 1.0 } else { f64::from(ROWS) * CELL };
        let mut steps = Vec::new();
        while simulation.time() < self.end {
            let before = simulation.time();
            simulation.advance(self.end).map_err(|e| e.to_string())?;
            let pressure = simulation.contact_force()[0] / area;
            steps.push([simulation.time() - before, simulation.time(), pressure]);
        }
        Ok(steps)
    }

    /// Impulse that the target has too little, over that of a cell of the lighter plate at the
    /// impact speed; greatest tension over P2; time from the exact parting to the last force [cells
    /// of the flyer's sound].
    fn errors(&self, steps: &[[f64; 3]]) -> [f64; 3] {
        let history = self.exact.target_face.points.iter();
        let corners: Vec<_> =
            history.take_while(|corner| corner.t < self.exact.separation_time).collect();
        let whole = |corners: &[&HistoryPoint]| -> f64 {
            let parts = corners.windows(2).map(|w| 0.5 * (w[1].t - w[0].t) * (w[0].p + w[1].p));
            parts.sum()
        };
        let exact = whole(&corners);
        let given: f64 = steps.iter().map(|step| step[0] * step[2]).sum();
        let density = self.materials.map(|m| m.1).into_iter().fold(f64::INFINITY, f64::min);
        let peak = self.exact.peak_pressure;
        let pull = steps.iter().map(|step| -step[2] / peak).fold(0.0, f64::max);
        let last = steps.iter().rfind(|step| step[2].abs() > 0.001 * peak);
        let late = last.map_or(0.0, |step| step[1]) - self.exact.falls_to(0.001);
        [(exact - given) / (density * CELL * self.speed), pull, late * self.materials[0].2 / CELL]
    }
}

/// The worst of all impacts.
pub fn check(table: &mut Table) {
    let impacts = impacts();
    for (name, frame, dimension) in [
        ("line, updated", "updated_lagrangian", 1),
        ("line, total", "total_lagrangian", 1),
        ("column, updated", "updated_lagrangian", 2),
    ] {
        let mut worst = [0.0f64; 3];
        for impact in &impacts {
            let steps =
                if dimension == 1 { impact.run::<1>(frame) } else { impact.run::<2>(frame) };
            let [(flyer, ..), (target, ..)] = impact.materials;
            let what = format!("{name}: {flyer} on {target}, {} m/s", impact.speed);
            let Some(steps) = table.take(&what, steps) else { continue };
            let errors = impact.errors(&steps);
            worst = std::array::from_fn(|k| worst[k].max(errors[k].abs()));
        }
        let bounds: [(&str, Bound); 3] = [
            ("impulse missing, cells x rho u", bounds::IMPULSE),
            ("tension, of P2", bounds::TENSION),
            ("last force, cells late", bounds::LATE),
        ];
        for ((figure, bound), worst) in bounds.into_iter().zip(worst) {
            table.check(&format!("{name}: {figure}"), Some(worst), bound);
        }
    }
}
