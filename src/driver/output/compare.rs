//! Comparison of two results, particle by particle: `flyer-mpm compare RUN RUN`.
//!
//! Profiles are matched by time. Particles are matched by their position in the order of x.

use std::fmt;
use std::path::Path;

use super::csv::{CsvTable, CsvValues, read_csv};
use super::error::OutputError;
use super::summary::{ProfileSummary, Summary};

/// Result of [`compare`]; displayed as a table and a verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Titles of the two runs, if they differ.
    pub titles: Option<(String, String)>,
    /// Profiles at times that both runs have.
    pub profiles: Vec<ProfileComparison>,
    /// Times \[s\] that only the first run has, then those that only the second run has.
    pub unmatched: [Vec<f64>; 2],
}

/// Comparison of two profiles of the same time.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileComparison {
    /// Time \[s\].
    pub time: f64,
    /// Numbers of particles in the two profiles.
    pub particles: [usize; 2],
    /// Whether the digests of the whole state are equal.
    pub same_state: bool,
    /// Columns that only the first profile has, then those that only the second profile has.
    pub unmatched: [Vec<String>; 2],
    /// Numeric columns of both profiles; empty if the numbers of particles differ.
    pub columns: Vec<ColumnComparison>,
    /// The first particle that differs, and the first column in which it differs.
    pub first: Option<Difference>,
}

/// Comparison of one column of two profiles.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnComparison {
    /// Name of the column.
    pub name: String,
    /// Sum of |a - b| over the sum of |a| \[-\].
    pub l1: f64,
    /// Root of the sum of (a - b)^2 over the sum of a^2 \[-\].
    pub l2: f64,
    /// Maximum of |a - b| over the maximum of |a| \[-\].
    pub max: f64,
    /// Number of particles whose values differ in any bit.
    pub differing: usize,
}

/// First difference of two profiles.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Index of the particle in the order of x, from 0.
    pub particle: usize,
    /// Position x of the particle in the first run \[m\].
    pub x: f64,
    /// Name of the column.
    pub column: String,
    /// The two values as text.
    pub values: [String; 2],
}

impl Comparison {
    /// Whether the two runs are bitwise equal.
    pub fn same_bits(&self) -> bool {
        self.unmatched.iter().all(Vec::is_empty)
            && self.profiles.iter().all(ProfileComparison::same_bits)
    }
}

impl ProfileComparison {
    /// Whether the two profiles and their whole states are bitwise equal.
    pub fn same_bits(&self) -> bool {
        self.same_state
            && self.particles[0] == self.particles[1]
            && self.unmatched.iter().all(Vec::is_empty)
            && self.first.is_none()
    }
}

/// Compares the results in two folders.
///
/// # Errors
///
/// If a summary or table of either folder cannot be read.
pub fn compare(a: &Path, b: &Path) -> Result<Comparison, OutputError> {
    let (first, second) = (Summary::read(a)?, Summary::read(b)?);
    let lacks = |profiles: &[ProfileSummary], time: f64| profiles.iter().all(|p| p.time != time);
    let only = |mine: &[ProfileSummary], theirs: &[ProfileSummary]| {
        mine.iter().map(|p| p.time).filter(|&time| lacks(theirs, time)).collect()
    };
    let unmatched =
        [only(&first.profiles, &second.profiles), only(&second.profiles, &first.profiles)];
    let mut profiles = Vec::new();
    for mine in &first.profiles {
        let Some(theirs) = second.profiles.iter().find(|p| p.time == mine.time) else { continue };
        let tables = [read_csv(&a.join(&mine.file))?, read_csv(&b.join(&theirs.file))?];
        let same_state = mine.state_sha256 == theirs.state_sha256;
        profiles.push(compare_tables(mine.time, same_state, &tables));
    }
    let titles = (first.title != second.title).then_some((first.title, second.title));
    Ok(Comparison { titles, profiles, unmatched })
}

fn compare_tables(time: f64, same_state: bool, tables: &[CsvTable; 2]) -> ProfileComparison {
    let [a, b] = tables;
    let lacks = |table: &CsvTable, name: &str| table.columns.iter().all(|c| c.name != name);
    let only = |mine: &CsvTable, theirs: &CsvTable| {
        let names = mine.columns.iter().map(|c| c.name.clone());
        names.filter(|name| lacks(theirs, name)).collect()
    };
    let mut found = ProfileComparison {
        time,
        particles: [a.len(), b.len()],
        same_state,
        unmatched: [only(a, b), only(b, a)],
        columns: Vec::new(),
        first: None,
    };
    if a.len() != b.len() {
        return found;
    }
    for mine in &a.columns {
        let Some(theirs) = b.columns.iter().find(|c| c.name == mine.name) else { continue };
        if let (CsvValues::Numbers(va), CsvValues::Numbers(vb)) = (&mine.values, &theirs.values) {
            found.columns.push(compare_columns(&mine.name, va, vb));
        }
        let until = found.first.as_ref().map_or(a.len(), |first| first.particle);
        let differs = (0..until).find(|&row| bits(&mine.values, row) != bits(&theirs.values, row));
        if let Some(particle) = differs {
            found.first = Some(Difference {
                particle,
                x: a.numbers("x").map_or(f64::NAN, |x| x[particle]),
                column: mine.name.clone(),
                values: [text(&mine.values, particle), text(&theirs.values, particle)],
            });
        }
    }
    found
}

fn compare_columns(name: &str, a: &[f64], b: &[f64]) -> ColumnComparison {
    // a field that is empty in both runs is no difference; in one run, the difference is infinite
    let gap = |(a, b): (&f64, &f64)| match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        (false, false) if a == b => 0.0,
        (false, false) => (a - b).abs(),
        _ => f64::INFINITY,
    };
    let pairs = || a.iter().zip(b);
    let known = || a.iter().filter(|a| !a.is_nan());
    let over = |top: f64, bottom: f64| if top == 0.0 { 0.0 } else { top / bottom };
    ColumnComparison {
        name: name.to_owned(),
        l1: over(pairs().map(gap).sum(), known().map(|a| a.abs()).sum()),
        l2: over(pairs().map(|p| gap(p).powi(2)).sum::<f64>(), known().map(|a| a * a).sum()).sqrt(),
        max: over(pairs().map(gap).fold(0.0, f64::max), known().fold(0.0, |m, a| m.max(a.abs()))),
        differing: pairs().filter(|(a, b)| to_bits(**a) != to_bits(**b)).count(),
    }
}

/// The bits of a value; all NaN are alike, because a file holds an empty field for each of them.
fn to_bits(value: f64) -> u64 {
    if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() }
}

/// A value in a form for bitwise comparison.
fn bits(values: &CsvValues, row: usize) -> (Option<u64>, Option<&str>) {
    match values {
        CsvValues::Numbers(values) => (Some(to_bits(values[row])), None),
        CsvValues::Text(values) => (None, Some(&values[row])),
    }
}

fn text(values: &CsvValues, row: usize) -> String {
    match values {
        CsvValues::Numbers(values) if values[row].is_nan() => "nothing".into(),
        CsvValues::Numbers(values) => format!("{:?}", values[row]),
        CsvValues::Text(values) => values[row].clone(),
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some((a, b)) = &self.titles {
            writeln!(f, "first run:  {a}\nsecond run: {b}")?;
        }
        for (which, times) in ["first", "second"].iter().zip(&self.unmatched) {
            for time in times {
                writeln!(f, "profile at {time:e} s: only in the {which} run")?;
            }
        }
        self.profiles.iter().try_for_each(|profile| write!(f, "{profile}"))?;
        let verdict = match (self.profiles.is_empty(), self.same_bits()) {
            (true, _) => "no profile in common",
            (_, true) => "the same to the bit",
            (_, false) => "different",
        };
        writeln!(f, "{verdict}")
    }
}

impl fmt::Display for ProfileComparison {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [a, b] = self.particles;
        write!(f, "profile at {:e} s: ", self.time)?;
        if a != b {
            return writeln!(f, "{a} and {b} particles, which cannot be paired");
        }
        let state = if self.same_state { "same" } else { "different" };
        writeln!(f, "{a} particles, {state} state_sha256")?;
        for (which, names) in ["first", "second"].iter().zip(&self.unmatched) {
            if !names.is_empty() {
                writeln!(f, "  only in the {which} run: {}", names.join(", "))?;
            }
        }
        let Some(first) = &self.first else { return writeln!(f, "  every column the same") };
        let width = self.columns.iter().map(|c| c.name.len()).max().unwrap_or(0).max(6);
        let [l1, l2, max] = ["L1", "L2", "max"];
        writeln!(f, "  {:width$}  {l1:>9}  {l2:>9}  {max:>9}  differing", "column")?;
        for c in &self.columns {
            let ColumnComparison { name, l1, l2, max, differing } = c;
            writeln!(f, "  {name:width$}  {l1:>9.2e}  {l2:>9.2e}  {max:>9.2e}  {differing:>9}")?;
        }
        let Difference { particle, x, column, values: [a, b] } = first;
        let place = particle + 1;
        writeln!(f, "  first: particle {place} from the left (x = {x:e} m), {column}: {a}, {b}")
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::summary::tests::example;
    use super::*;

    const HEADER: &str = "x,pressure,material,temperature\n";

    fn run(home: &Path, name: &str, profiles: [&str; 2]) -> std::path::PathBuf {
        let folder = home.join(name);
        fs::create_dir(&folder).unwrap();
        let mut summary = example();
        for (profile, text) in summary.profiles.iter_mut().zip(profiles) {
            fs::write(folder.join(&profile.file), format!("{HEADER}{text}")).unwrap();
            profile.state_sha256 = text.into();
        }
        summary.write(&folder).unwrap();
        folder
    }

    #[test]
    fn finds_the_first_difference_and_the_norms() {
        let home = tempfile::tempdir().unwrap();
        let one = "0.0,3.0,cu,\n1.0,4.0,cu,\n2.0,-0.0,al,300.0\n";
        let two = "0.0,3.0,cu,\n1.0,5.0,cu,\n2.0,0.0,cu,300.0\n";
        let a = run(home.path(), "a", [one, one]);
        let b = run(home.path(), "b", [one, two]);
        let found = compare(&a, &b).unwrap();
        assert!(!found.same_bits());
        assert!(found.profiles[0].same_bits());
        let second = &found.profiles[1];
        let pressure = &second.columns[1];
        assert_eq!((pressure.name.as_str(), pressure.differing), ("pressure", 2));
        assert_eq!((pressure.l1, pressure.l2, pressure.max), (1.0 / 7.0, 0.2, 0.25));
        assert_eq!(second.columns[2].l1, 0.0);
        let first = second.first.as_ref().unwrap();
        assert_eq!((first.particle, first.x, first.column.as_str()), (1, 1.0, "pressure"));
        assert_eq!(first.values, ["4.0", "5.0"]);
        let text = found.to_string();
        assert!(text.contains("pressure       1.43e-1    2.00e-1    2.50e-1          2"), "{text}");
        assert!(text.ends_with("different\n"), "{text}");
    }

    #[test]
    fn equal_runs_are_the_same_to_the_bit() {
        let home = tempfile::tempdir().unwrap();
        let one = "0.0,3.0,cu,\n";
        let [a, b] = ["a", "b"].map(|name| run(home.path(), name, [one, one]));
        let found = compare(&a, &b).unwrap();
        assert!(found.same_bits());
        assert!(found.to_string().ends_with("the same to the bit\n"));
        // the states may differ although the columns are equal
        let mut summary = Summary::read(&b).unwrap();
        summary.profiles[0].state_sha256.push('0');
        summary.profiles[1].time = 2e-6;
        summary.write(&b).unwrap();
        let found = compare(&a, &b).unwrap();
        assert!(!found.profiles[0].same_bits());
        assert_eq!(found.unmatched, [vec![1e-6], vec![2e-6]]);
    }

    #[test]
    fn other_shapes_and_missing_files_are_reported() {
        let home = tempfile::tempdir().unwrap();
        let a = run(home.path(), "a", ["0.0,3.0,cu,\n", ""]);
        let b = run(home.path(), "b", ["0.0,3.0,cu,\n1.0,3.0,cu,\n", ""]);
        let found = compare(&a, &b).unwrap();
        assert!(!found.same_bits());
        assert!(found.to_string().contains("1 and 2 particles"), "{found}");
        fs::remove_file(b.join("profile_0.500us.csv")).unwrap();
        let error = compare(&a, &b).unwrap_err().to_string();
        assert!(error.contains("b/profile_0.500us.csv: cannot read the file: "), "{error}");
        assert!(compare(&a, &home.path().join("c")).is_err());
    }
}
