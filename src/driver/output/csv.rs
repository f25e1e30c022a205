//! Profiles as CSV: a header, then one line per particle.
//!
//! Numbers are the shortest decimals that read back as the same double, so that files can be
//! compared bitwise; NaN is an empty field. Text is quoted only where RFC 4180 requires it.

use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::os::unix::fs::FileExt;
use std::path::Path;

use decomp::Comm;

use super::error::{OutputError, read_text};
use super::shared_file::{agree, from_first};
use crate::input::input_file::LARGEST_RESULT;
use crate::simulation::{ParticleTable, TableColumn};

/// Names of the profile files, one per time \[s\], such as `profile_0.500us.csv`. They are unique
/// and depend only on the times.
pub fn profile_names(times: &[f64]) -> Vec<String> {
    let longest = times.iter().fold(0.0_f64, |a, t| a.max(t.abs()));
    let (unit, scale) = match longest {
        t if t >= 0.1 => ("s", 1.0),
        t if t >= 1e-3 => ("ms", 1e3),
        t if t >= 1e-8 => ("us", 1e6),
        _ => ("ns", 1e9),
    };
    let texts = |decimals: usize| -> Vec<String> {
        times.iter().map(|t| format!("{:.decimals$}", t * scale)).collect()
    };
    let distinct = |texts: &[String]| {
        let zeros = texts.iter().zip(times).any(|(s, t)| *t != 0.0 && s.parse() == Ok(0.0_f64));
        !zeros && (1..texts.len()).all(|i| !texts[..i].contains(&texts[i]))
    };
    let decimals = (3..=24).find(|&d| distinct(&texts(d))).unwrap_or(3);
    let mut names: Vec<String> = Vec::with_capacity(times.len());
    for text in texts(decimals) {
        let mut name = format!("profile_{text}{unit}.csv");
        let mut copy = 1;
        while names.contains(&name) {
            copy += 1;
            name = format!("profile_{text}{unit}_{copy}.csv");
        }
        names.push(name);
    }
    names
}

/// Writes every particle of the table, in its order.
///
/// The columns are those of the table; the name of the `material` follows `artificial_viscosity`.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write_profile(path: &Path, table: &ParticleTable) -> Result<(), OutputError> {
    let lines = Lines::of(table);
    write_rows(path, &lines.header(), table.len(), |text, row| lines.push(text, row))
}

/// Writes a table of which each rank has a share, in the order of the ranks, as [`write_profile`] does.
/// The file is written aside and renamed. Collective.
///
/// # Errors
///
/// If the file cannot be written; all ranks return an error.
pub fn write_frame(comm: &dyn Comm, path: &Path, share: &ParticleTable) -> Result<(), OutputError> {
    let aside = path.with_extension("partial");
    let (path, aside) = from_first(comm, (path.to_path_buf(), aside));
    let lines = Lines::of(share);
    let mut text = Vec::new();
    if comm.rank() == 0 {
        text.extend(lines.header().join(",").into_bytes());
        text.push(b'\n');
    }
    for row in 0..share.len() {
        lines.push(&mut text, row);
        text.push(b'\n');
        if row.is_multiple_of(1 << 14) {
            comm.heartbeat();
        }
    }
    let mut lengths = vec![0; comm.size()];
    lengths[comm.rank()] = text.len() as i64;
    comm.sum(&mut lengths);
    let start = lengths[..comm.rank()].iter().sum::<i64>() as u64;
    let fail = |e| OutputError::io("write the fields", &path)(e);
    let made = if comm.rank() == 0 { File::create(&aside).map(drop) } else { Ok(()) };
    agree(comm, made.map_err(fail))?;
    let write = || OpenOptions::new().write(true).open(&aside)?.write_all_at(&text, start);
    agree(comm, write().map_err(fail))?;
    let renamed = if comm.rank() == 0 { fs::rename(&aside, &path) } else { Ok(()) };
    agree(comm, renamed.map_err(fail))
}

/// The lines of a table of particles.
struct Lines<'a> {
    before: &'a [TableColumn],
    after: &'a [TableColumn],
    table: &'a ParticleTable,
    materials: Vec<String>,
}

impl<'a> Lines<'a> {
    fn of(table: &'a ParticleTable) -> Lines<'a> {
        let split = table
            .columns
            .iter()
            .position(|c| c.name == "artificial_viscosity")
            .map_or(table.columns.len(), |i| i + 1);
        let (before, after) = table.columns.split_at(split);
        let materials = table.materials.iter().map(|name| field(name)).collect();
        Lines { before, after, table, materials }
    }

    fn header(&self) -> Vec<String> {
        let named = |columns: &[TableColumn]| -> Vec<String> {
            columns.iter().map(|c| field(&c.name)).collect()
        };
        [named(self.before), vec!["material".to_owned()], named(self.after)].concat()
    }

    /// Appends the line of a particle, without its end.
    fn push(&self, text: &mut Vec<u8>, row: usize) {
        for column in self.before {
            push_number(text, column.values[row]);
            text.push(b',');
        }
        text.extend_from_slice(self.materials[self.table.material[row] as usize].as_bytes());
        for column in self.after {
            text.push(b',');
            push_number(text, column.values[row]);
        }
    }
}

/// Writes a header and `rows` lines; `fill` appends the fields of a line, separated by commas.
pub(super) fn write_rows(
    path: &Path,
    header: &[String],
    rows: usize,
    fill: impl Fn(&mut Vec<u8>, usize),
) -> Result<(), OutputError> {
    let file = File::create(path).map_err(OutputError::io("create the file", path))?;
    let mut out = BufWriter::with_capacity(1 << 16, file);
    let mut write = || {
        let mut line = header.join(",").into_bytes();
        line.push(b'\n');
        out.write_all(&line)?;
        for row in 0..rows {
            line.clear();
            fill(&mut line, row);
            line.push(b'\n');
            out.write_all(&line)?;
        }
        out.flush()
    };
    write().map_err(OutputError::io("write the file", path))
}

/// Text as a field of a line, quoted only if necessary.
pub(super) fn field(text: &str) -> String {
    let plain = !text.contains([',', '"', '\n', '\r']) && text.trim() == text && !text.is_empty();
    if plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Appends the shortest decimal that reads back as the same double; nothing for NaN.
///
/// Whole numbers keep their `.0`, so that readers do not parse integers and lose the sign of zero.
pub fn push_number(text: &mut Vec<u8>, value: f64) {
    if value.is_nan() {
        return;
    }
    let mut buffer = ryu::Buffer::new();
    let all = buffer.format(value).as_bytes();
    match scientific(all.strip_prefix(b"-").unwrap_or(all)) {
        Some(([first, others @ ..], exponent)) => {
            text.extend_from_slice(&all[..usize::from(all[0] == b'-')]);
            text.push(*first);
            if !others.is_empty() {
                text.push(b'.');
                text.extend_from_slice(others);
            }
            text.extend_from_slice(exponent.as_bytes());
        }
        _ => text.extend_from_slice(all),
    }
}

/// Digits and exponent of the scientific form of `fixed`, such as `125` and `e-4` of `0.000125`, if it is
/// shorter. ryu writes at most four zeros after `0.`, and at most 16 digits before the point.
fn scientific(fixed: &[u8]) -> Option<(&[u8], &'static str)> {
    const SMALL: [&str; 5] = ["e-1", "e-2", "e-3", "e-4", "e-5"];
    const LARGE: [&str; 16] = [
        "e0", "e1", "e2", "e3", "e4", "e5", "e6", "e7", "e8", "e9", "e10", "e11", "e12", "e13",
        "e14", "e15",
    ];
    let (digits, exponent, length) = if let Some(decimals) = fixed.strip_prefix(b"0.") {
        let zeros = decimals.iter().take_while(|&&digit| digit == b'0').count();
        (&decimals[zeros..], SMALL.get(zeros)?, fixed.len())
    } else {
        let whole = fixed.strip_suffix(b".0").filter(|whole| whole.ends_with(b"0"))?;
        let zeros = whole.iter().rev().take_while(|&&digit| digit == b'0').count();
        (&whole[..whole.len() - zeros], LARGE.get(whole.len() - 1)?, whole.len())
    };
    let is_shorter = digits.len() + usize::from(digits.len() > 1) + exponent.len() < length;
    is_shorter.then_some((digits, exponent))
}

/// Contents of a CSV file.
#[derive(Clone, Debug, PartialEq)]
pub struct CsvTable {
    /// The columns in the order of the file.
    pub columns: Vec<CsvColumn>,
}

/// One column of a [`CsvTable`].
#[derive(Clone, Debug, PartialEq)]
pub struct CsvColumn {
    /// Name in the header.
    pub name: String,
    /// One value per line.
    pub values: CsvValues,
}

/// Values of a [`CsvColumn`].
#[derive(Clone, Debug, PartialEq)]
pub enum CsvValues {
    /// Every field is a number or empty (NaN).
    Numbers(Vec<f64>),
    /// Text of the fields, at least one of which is neither.
    Text(Vec<String>),
}

impl CsvTable {
    /// Number of lines below the header.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |c| match &c.values {
            CsvValues::Numbers(v) => v.len(),
            CsvValues::Text(v) => v.len(),
        })
    }

    /// Whether there are no lines below the header.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values of the column `name`, if it exists and is numeric.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match &self.columns.iter().find(|c| c.name == name)?.values {
            CsvValues::Numbers(values) => Some(values),
            CsvValues::Text(_) => None,
        }
    }
}

/// Reads a file in the format of [`write_profile`].
///
/// # Errors
///
/// The file cannot be read, has no header, or has a line with another number of fields.
pub fn read_csv(path: &Path) -> Result<CsvTable, OutputError> {
    let text = read_text(path, LARGEST_RESULT)?;
    let fault = |line: u64, message: String| OutputError::Csv { path: path.into(), line, message };
    // the csv crate takes the rest of a truncated file as a field
    if !text.matches('"').count().is_multiple_of(2) {
        let lines = text.lines().count() as u64;
        return Err(fault(lines.max(1), "a quote is not closed".into()));
    }
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let names = reader.headers().map_err(|error| fault(1, error.to_string()))?.clone();
    if names.is_empty() {
        return Err(fault(1, "no header".into()));
    }
    let mut columns: Vec<Vec<String>> = vec![Vec::new(); names.len()];
    for record in reader.records() {
        let record = record.map_err(|error| {
            fault(error.position().map_or(1, csv::Position::line), error.to_string())
        })?;
        if record.len() != names.len() {
            let message = format!("{} fields, the header has {}", record.len(), names.len());
            return Err(fault(record.position().map_or(1, csv::Position::line), message));
        }
        for (column, value) in columns.iter_mut().zip(&record) {
            column.push(value.to_string());
        }
    }
    let columns = names.iter().zip(columns).map(|(name, texts)| {
        let number = |s: &String| if s.is_empty() { Some(f64::NAN) } else { s.parse().ok() };
        let values = match texts.iter().map(number).collect() {
            Some(numbers) => CsvValues::Numbers(numbers),
            None => CsvValues::Text(texts),
        };
        CsvColumn { name: name.to_string(), values }
    });
    Ok(CsvTable { columns: columns.collect() })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::simulation::TableColumn;

    fn number(value: f64) -> String {
        let mut text = Vec::new();
        push_number(&mut text, value);
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn numbers_are_short_and_come_back_to_the_bit() {
        for (value, text) in [
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (20.0, "20.0"),
            (-1000.0, "-1e3"),
            (2785.0, "2785.0"),
            (1e-5, "1e-5"),
            (-2.5e-6, "-2.5e-6"),
            (0.00125, "0.00125"),
            (5.025e-4, "5.025e-4"),
            (0.125, "0.125"),
            (12144294123.5, "12144294123.5"),
            (5e-324, "5e-324"),
            (1.2e4, "12000.0"),
            (1e15, "1e15"),
            (1e16, "1e16"),
            (-0.001, "-1e-3"),
            (0.01, "0.01"),
            (1.234e-5, "1.234e-5"),
            (0.0001, "1e-4"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::INFINITY, "inf"),
            (f64::NAN, ""),
        ] {
            assert_eq!(number(value), text);
        }
        // values over all magnitudes, from a fixed linear congruential sequence
        let mut bits = 1_u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = f64::from_bits(bits);
            if value.is_nan() {
                continue;
            }
            let scaled = value.rem_euclid(1.0) * 10_f64.powi((bits >> 8) as i32 % 12);
            for value in [value, scaled] {
                let text = number(value);
                assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
                assert!(text.len() <= format!("{value:?}").len(), "{text} {value:?}");
            }
        }
    }

    #[test]
    fn a_profile_comes_back() {
        let column = |name: &str, values: &[f64]| TableColumn {
            name: name.into(),
            unit: "m".into(),
            values: values.into(),
        };
        let table = ParticleTable {
            time: 1e-6,
            dimension: 1,
            ids: vec![4, 2],
            material: vec![1, 0],
            materials: vec!["copper".into(), "Al \"6061\", T6\nrolled".into()],
            body: vec![0, 1],
            columns: vec![
                column("x", &[-2.5e-6, 0.1 + 0.2]),
                column("artificial_viscosity", &[0.0, -0.0]),
                column("temperature", &[f64::NAN, 293.15]),
            ],
            half_edges: Vec::new(),
        };
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("p.csv");
        write_profile(&path, &table).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let expected = "x,artificial_viscosity,material,temperature\n\
            -2.5e-6,0.0,\"Al \"\"6061\"\", T6\nrolled\",\n\
            0.30000000000000004,-0.0,copper,293.15\n";
        assert_eq!(text, expected);
        let back = read_csv(&path).unwrap();
        assert_eq!(back.len(), 2);
        assert_eq!(back.numbers("x"), table.column("x"));
        assert!(back.numbers("temperature").unwrap()[0].is_nan());
        let names = CsvValues::Text(vec![table.materials[1].clone(), table.materials[0].clone()]);
        assert_eq!(back.columns[2].values, names);
        fs::write(&path, "x,y\n1,2\n3\n").unwrap();
        assert!(
            read_csv(&path)
                .unwrap_err()
                .to_string()
                .ends_with("p.csv: line 3: 1 fields, the header has 2")
        );
        fs::write(&path, "x,y\n1,\"two\n").unwrap();
        let error = read_csv(&path).unwrap_err().to_string();
        assert!(error.ends_with("p.csv: line 2: a quote is not closed"), "{error}");
    }

    #[test]
    fn profiles_have_names_of_their_own() {
        let names = |t: &[f64]| profile_names(t).join(" ");
        assert_eq!(names(&[2e-7, 1e-6]), "profile_0.200us.csv profile_1.000us.csv");
        assert_eq!(names(&[0.0, 0.2]), "profile_0.000s.csv profile_0.200s.csv");
        assert_eq!(names(&[5e-7, 5.0001e-7]), "profile_0.50000us.csv profile_0.50001us.csv");
        assert_eq!(names(&[1e-13, 1e-6]), "profile_0.0000001us.csv profile_1.0000000us.csv");
        assert_eq!(names(&[1e-6, 1e-6]), "profile_1.000us.csv profile_1.000us_2.csv");
        let twins = profile_names(&[1e-6, 1e-6_f64.next_up()]);
        assert_ne!(twins[0], twins[1]);
    }
}
