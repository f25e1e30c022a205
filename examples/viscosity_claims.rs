//! The statements of Burghardt (2010) on viscosity coefficients, compared with the study's numbers.
//!
//! Argument: the folder of the study `inputs/studies/viscosity.json`. Prints a table in Markdown
//! and writes it there as `claims.md`.

use std::path::Path;
use std::process::ExitCode;

use flyer_mpm::driver::output::csv::{CsvTable, read_csv};

/// Coefficients from the program's default down to none, on the straight line through those of Burghardt (2010).
const PATH: [(f64, f64); 5] = [(0.2, 2.0), (0.15, 1.5), (0.1, 1.0), (0.06, 0.6), (0.03, 0.3)];

/// The study's rows.
struct Sweep {
    linear: Vec<f64>,
    quadratic: Vec<f64>,
    table: CsvTable,
}

impl Sweep {
    /// An error at 1 us.
    fn at(&self, (linear, quadratic): (f64, f64), error: &str) -> f64 {
        let row = (0..self.linear.len())
            .find(|&r| self.linear[r] == linear && self.quadratic[r] == quadratic);
        let column = self.table.numbers(&format!("{error}@1us"));
        row.zip(column).map_or(f64::NAN, |(r, c)| c[r])
    }

    /// An error along the path.
    fn path(&self, error: &str) -> Vec<f64> {
        PATH.iter().map(|&at| self.at(at, error)).collect()
    }
}

/// A claim, what was measured, and the verdict.
type Claim = (&'static str, String, &'static str);

fn percent(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|v| format!("{:.1}", 100.0 * v)).collect();
    format!("{} %", all.join(", "))
}

fn cells(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|v| format!("{v:.1}")).collect();
    format!("{} cells", all.join(", "))
}

fn judged(holds: bool) -> &'static str {
    if holds { "holds" } else { "does not hold" }
}

fn claims(sweep: &Sweep) -> Vec<Claim> {
    let (default, none, document) = ((0.2, 2.0), (0.0, 0.0), (0.03, 0.3));
    let rising = |v: &[f64]| v.windows(2).all(|w| w[1] > w[0]);
    let falling = |v: &[f64]| v.windows(2).all(|w| w[1] < w[0]);
    let (noise, rise) = (sweep.path("noise"), sweep.path("rise_cells"));
    let plateau: Vec<f64> = sweep.path("plateau").iter().map(|p| p.abs()).collect();
    let second = sweep.path("second_plateau");
    let [smooth, steps] = [sweep.at(default, "noise"), sweep.at(default, "second_plateau")];
    let chaos = [sweep.at(none, "noise"), sweep.at(none, "overshoot")];
    vec![
        (
            "with the defaults (.2/2) the solution is very smooth",
            format!(
                "noise of the plateau {}, overshoot {}",
                percent(&[smooth]),
                percent(&[sweep.at(default, "overshoot")])
            ),
            judged(smooth < 0.01),
        ),
        (
            "with the defaults no steps in the wave structure are visible",
            format!("mean of the second plateau is off by {}", percent(&[steps])),
            judged(steps.abs() > 0.05),
        ),
        (
            "with the defaults the wave rapidly dissipates",
            format!(
                "mean of the first plateau at 1 us is off by {}",
                percent(&[sweep.at(default, "plateau")])
            ),
            judged(sweep.at(default, "plateau") < -0.05),
        ),
        (
            "decreasing the coefficients makes the solution noisy",
            format!("noise from .2/2 down to .03/.3: {}", percent(&noise)),
            judged(rising(&noise)),
        ),
        (
            "without viscosity the solution is chaotic",
            format!("noise {}, overshoot {}", percent(&chaos[..1]), percent(&chaos[1..])),
            judged(chaos[0] > 0.1 && chaos[1] > 0.5),
        ),
        (
            "with smaller coefficients the amplitude is closer to the exact one",
            format!("error of the plateau from .2/2 down to .03/.3: {}", percent(&plateau)),
            judged(falling(&plateau)),
        ),
        (
            "decreasing the coefficients makes the shock steeper",
            format!("rise from .2/2 down to .03/.3: {}", cells(&rise)),
            judged(falling(&rise)),
        ),
        (
            "the steps become visible with reduced viscosity",
            format!("error of the second plateau from .2/2 down to .03/.3: {}", percent(&second)),
            judged(second[0].abs() > 2.0 * second[4].abs()),
        ),
        (
            "with .03/.3 amplitude and shape are nearly the exact ones",
            format!(
                "L1 {}, of which the second plateau {}",
                percent(&[sweep.at(document, "l1")]),
                percent(&[sweep.at(document, "waves.second_plateau")])
            ),
            judged(sweep.at(document, "l1") < 0.05),
        ),
        (
            "the first rarefaction begins to reach the shock and to attenuate it",
            "in the true solution its head catches the shock at 1.743 us, x = 11.0 mm".into(),
            "does not hold: attenuation within 1 us is numerical",
        ),
    ]
}

fn run(folder: &Path) -> Result<String, String> {
    let table = read_csv(&folder.join("study.csv")).map_err(|e| e.to_string())?;
    let column =
        |name: &str| table.numbers(name).map(<[f64]>::to_vec).ok_or(format!("no column {name}"));
    let linear = column("artificial_viscosity.linear")?;
    let quadratic = column("artificial_viscosity.quadratic")?;
    let sweep = Sweep { linear, quadratic, table };
    let mut text =
        String::from("| Burghardt (2010) | measured at 1 us | verdict |\n|---|---|---|\n");
    for (claim, measured, verdict) in claims(&sweep) {
        text += &format!("| {claim} | {measured} | {verdict} |\n");
    }
    std::fs::write(folder.join("claims.md"), &text).map_err(|e| e.to_string())?;
    Ok(text)
}

fn main() -> ExitCode {
    let folder = std::env::args().nth(1).unwrap_or("output/studies/viscosity".into());
    match run(Path::new(&folder)) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("error: {reason}");
            ExitCode::FAILURE
        }
    }
}
