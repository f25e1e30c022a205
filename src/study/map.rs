//! A map of a study: an error over two keys, drawn as colour.

use super::StudyRow;
use super::cases::fits;
use super::curves::{quantity, swept};
use super::spec::MapPicture;
use crate::plot::{Axis, Figure, TileMap};

/// The figure of this map. The tiles of failed cases are empty.
pub fn figure(picture: &MapPicture, rows: &[StudyRow]) -> Figure {
    let rows: Vec<&StudyRow> = rows.iter().filter(|row| fits(&row.labels, &picture.only)).collect();
    let places = |key: &str| {
        let mut all: Vec<f64> = rows.iter().filter_map(|row| row.number(key, None)).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let (xs, ys) = (places(&picture.x), places(&picture.y));
    let (label, unit, factor) = quantity(&picture.value);
    let value = |x: f64, y: f64| {
        let at = |row: &&&StudyRow| {
            row.number(&picture.x, None) == Some(x) && row.number(&picture.y, None) == Some(y)
        };
        Some(rows.iter().find(at)?.number(&picture.value, picture.time)?.abs())
    };
    let mut values: Vec<Vec<Option<f64>>> =
        ys.iter().map(|&y| xs.iter().map(|&x| value(x, y)).collect()).collect();
    let axis = |key: &str| {
        let (label, unit, _) = swept(key, 0.0);
        Axis::linear(label, unit).tight()
    };
    let all = || values.iter().flatten().flatten();
    let most = picture.most.filter(|&most| all().any(|&value| value > most));
    let beyond =
        most.map(|m| format!(", {} {unit} and more alike", (m * factor * 1e6).round() / 1e6));
    for value in values.iter_mut().flatten().flatten() {
        *value = value.min(most.unwrap_or(f64::INFINITY)) * factor;
    }
    TileMap {
        title: picture.title.clone(),
        x: axis(&picture.x).ticks(&xs[..]),
        y: axis(&picture.y).ticks(&ys[..]),
        places: [xs, ys],
        values,
        label: label + &beyond.unwrap_or_default(),
        unit: unit.into(),
        marks: picture.marks.clone(),
    }
    .figure()
}
