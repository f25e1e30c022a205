//! Positions of particles from CSV text.

/// A fault in a list of points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("line {line}: {reason}")]
pub struct PointsFault {
    /// Line number, from 1.
    pub line: u64,
    /// Description of the fault, and the allowed values.
    pub reason: String,
}

impl PointsFault {
    fn new(line: u64, reason: impl Into<String>) -> Self {
        PointsFault { line, reason: reason.into() }
    }
}

/// Names of the columns.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// Reads points of `D` coordinates [m], one per line, separated by commas.
///
/// If the first line is not all numbers, it names the columns: `x`, `y` in any order; other columns
/// are ignored. Without such a header the columns are the coordinates. Blank lines and lines that
/// start with `#` are skipped.
///
/// # Errors
///
/// The first line that is not a point, or a text without points.
pub fn read_points<const D: usize>(text: &str) -> Result<Vec<[f64; D]>, PointsFault> {
    // the csv crate would count blank lines with the record after them, and so misplace a fault
    let text = text.trim_start_matches('\u{feff}');
    let lines = (1..).zip(text.lines().map(str::trim));
    let mut columns: Option<([usize; D], usize)> = None;
    let mut points = Vec::new();
    for (line, text) in lines.filter(|(_, text)| !text.is_empty() && !text.starts_with('#')) {
        let fields: Vec<&str> = text.split(',').map(str::trim).collect();
        let numbers = || fields.iter().all(|field| field.parse::<f64>().is_ok());
        let (places, width) = match columns {
            Some(columns) => columns,
            None if numbers() => *columns.insert((std::array::from_fn(|d| d), D)),
            None => {
                columns = Some((header(&fields, line)?, fields.len()));
                continue;
            }
        };
        if fields.len() != width {
            let reason =
                format!("{} columns; allowed: {width}, as {}", fields.len(), wanted::<D>());
            return Err(PointsFault::new(line, reason));
        }
        let mut point = [0.0; D];
        for (coordinate, place) in point.iter_mut().zip(places) {
            let field = fields[place];
            *coordinate = field.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
                PointsFault::new(line, format!("{field:?} is no number; allowed: finite numbers"))
            })?;
        }
        points.push(point);
    }
    if points.is_empty() {
        let reason = format!("no points; allowed: one a line, as {}", wanted::<D>());
        return Err(PointsFault::new(1, reason));
    }
    Ok(points)
}

/// Column indices of the coordinates, from the column names.
fn header<const D: usize>(names: &[&str], line: u64) -> Result<[usize; D], PointsFault> {
    let mut places = [0; D];
    for (place, wanted_name) in places.iter_mut().zip(NAMES) {
        let is = |name: &str| name.trim_matches('"') == wanted_name;
        let mut found = (0..names.len()).filter(|&i| is(names[i]));
        *place = match (found.next(), found.next()) {
            (Some(i), None) => i,
            (first, _) => {
                let what = if first.is_some() { "two columns" } else { "no column" };
                let reason = format!(
                    "{what} {wanted_name} in {:?}; allowed: {}, or a header that names them",
                    names.join(","),
                    wanted::<D>()
                );
                return Err(PointsFault::new(line, reason));
            }
        };
    }
    Ok(places)
}

fn wanted<const D: usize>() -> String {
    format!("{} of numbers", NAMES[..D].join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault<const D: usize>(text: &str) -> String {
        read_points::<D>(text).unwrap_err().to_string()
    }

    #[test]
    fn points_are_read_with_and_without_a_header() {
        let points = [[1.0, -2.5e-3], [0.0, 4.0]];
        assert_eq!(read_points("1,-2.5e-3\n0, 4\n").unwrap(), points);
        assert_eq!(read_points("\u{feff}x,y\r\n1,-0.0025\r\n\r\n0,4\r\n").unwrap(), points);
        assert_eq!(read_points("# by hand\ny,id,x\n-0.0025,7,1\n4,8,0").unwrap(), points);
        assert_eq!(read_points("\"x\"\n1\n2").unwrap(), [[1.0], [2.0]]);
    }

    #[test]
    fn a_fault_names_its_line() {
        assert_eq!(fault::<2>("1,2\n3\n"), "line 2: 1 columns; allowed: 2, as x,y of numbers");
        let text = "line 3: \"a\" is no number; allowed: finite numbers";
        assert_eq!(fault::<2>("x,y\n1,2\n3,a\n"), text);
        assert_eq!(
            fault::<1>("1\n\ninf\n"),
            "line 3: \"inf\" is no number; allowed: finite numbers"
        );
        assert!(fault::<1>("1,2\n").starts_with("line 1: 2 columns; allowed: 1"));
    }

    #[test]
    fn a_header_must_name_each_coordinate_once() {
        assert!(fault::<2>("x,z\n1,2\n").starts_with("line 1: no column y in \"x,z\""));
        assert!(fault::<2>("x,y,x\n1,2,3\n").starts_with("line 1: two columns x"));
        assert!(fault::<2>("").starts_with("line 1: no points"));
        assert!(fault::<2>("x,y\n").starts_with("line 1: no points"));
    }
}
