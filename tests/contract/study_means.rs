//! Studies: means over labels, axes in files of their own, and histories beside those of a
//! reference case.

use serde_json::{Value, json};

use crate::home::Home;
use crate::scenes::whole;

/// Two schemes and two cell sizes at two positions of the grid, with a gauge.
fn study() -> Value {
    let at = |shift: f64| {
        let scene = whole();
        let moved = |end: &str| json!([scene["domain"][end][0].as_f64().unwrap() - shift]);
        json!({"domain.lower": moved("lower"), "domain.upper": moved("upper")})
    };
    json!({
        "title": "means", "scene": "scene.json",
        "set": {
            "output.pictures": false, "output.hdf5": false,
            "output.histories": {"stations": [{"name": "gauge", "at": [2e-4]}]},
        },
        "sweep": [
            {"file": "schemes.json"},
            {"key": "domain.cell_size", "values": [2e-5, 1e-5]},
            {"name": "grid", "cases": [
                {"name": "aligned", "set": {}},
                {"name": "shifted", "set": at(3e-6)},
            ]},
        ],
        "convergence": {
            "against": {"scheme": "as it is", "domain.cell_size": 1e-5, "grid": "aligned"},
            "columns": ["gauge_pressure"],
        },
        "choices": {"error": "l1", "over": ["grid"], "wanted": [0.9]},
        "pictures": [{"type": "curves", "name": "cost", "title": "cost", "x": "loop_cpu_seconds",
            "y": ["l1", "histories"], "series": ["scheme"], "over": ["grid"]}],
    })
}

fn home(study: &Value) -> Home {
    let home = Home::with(&whole());
    home.write("study.json", &study.to_string());
    let schemes = json!({"name": "scheme", "cases": [
        {"name": "as it is", "set": {}},
        {"name": "PIC", "set": {"method": {"shape": "linear", "transfer": "pic"}}},
    ]});
    home.write("schemes.json", &schemes.to_string());
    home
}

/// Rows of `study.csv` by their heads.
fn rows(home: &Home) -> Vec<Vec<(String, String)>> {
    let mut reader = csv::Reader::from_path(home.at("out/study.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let pairs = |row: csv::StringRecord| {
        heads.iter().zip(row.iter()).map(|(head, value)| (head.into(), value.into())).collect()
    };
    reader.records().map(|row| pairs(row.unwrap())).collect()
}

/// Number of the last column whose head begins with `head`.
fn number(row: &[(String, String)], head: &str) -> Option<f64> {
    row.iter()
        .rev()
        .find(|(name, _)| name.starts_with(head))
        .and_then(|(_, value)| value.parse().ok())
}

#[test]
fn choices_are_means_over_labels_and_histories_are_compared() {
    let home = home(&study());
    home.call(["study", "study.json", "--output", "out"]).end().succeeded();
    let rows = rows(&home);
    assert_eq!(rows.len(), 8);
    let histories: Vec<Option<f64>> = rows.iter().map(|row| number(row, "histories")).collect();
    // only the reference has no difference from itself
    let reference = histories.iter().position(Option::is_none).unwrap();
    assert_eq!(reference, 2);
    assert!(histories.iter().enumerate().all(|(k, h)| k == 2 || h.unwrap() > 0.0), "{histories:?}");
    // that of the same scheme on a shifted grid is smaller than that of PIC on large cells
    assert!(histories[3] < histories[4], "{histories:?}");
    let choices = std::fs::read_to_string(home.at("out/choices.md")).unwrap();
    assert!(
        choices.contains("| mean L1 wanted | cheapest choice | mean L1 | greatest |"),
        "{choices}"
    );
    let line = choices.lines().last().unwrap();
    let numbers: Vec<f64> =
        line.split('|').filter_map(|t| t.trim().trim_end_matches(" %").parse().ok()).collect();
    let [wanted, mean, greatest, _] = numbers[..] else { panic!("{line}") };
    assert_eq!(wanted, 90.0);
    // the mean of two rows of the table and the greater of them
    let l1: Vec<f64> = rows.iter().map(|row| 100.0 * number(row, "l1").unwrap()).collect();
    let pair = l1.chunks(2).find(|pair| (0.5 * (pair[0] + pair[1]) - mean).abs() < 6e-4);
    let pair = pair.unwrap_or_else(|| panic!("{mean} of {l1:?}"));
    assert!((pair[0].max(pair[1]) - greatest).abs() < 6e-4, "{greatest} of {pair:?}");
}

#[test]
fn labels_axes_and_columns_that_do_not_exist_are_named() {
    for (at, value, word) in [
        ("/choices/over", json!(["speed"]), "choices.over: no label `speed`"),
        ("/pictures/0/over", json!(["speed"]), "pictures.cost: no label `speed`"),
        ("/convergence/against", json!({"speed": 1}), "convergence.against: no label `speed`"),
        (
            "/convergence/against",
            json!({"grid": "turned"}),
            "convergence.against: no case has these labels",
        ),
        ("/convergence/columns", json!([]), "convergence.columns: empty"),
        ("/sweep/0", json!({"file": "none.json"}), "none.json"),
    ] {
        let mut study = study();
        *study.pointer_mut(at).unwrap() = value;
        home(&study)
            .call(["study", "study.json", "--output", "out"])
            .end()
            .failed(&["error: ", word]);
    }
    let mut study = study();
    study["convergence"]["columns"] = json!(["gauge_speed"]);
    let home = home(&study);
    let text = home.call(["study", "study.json", "--output", "out"]).end().succeeded();
    for part in ["no column `gauge_speed`", "gauge_pressure", "the reference case has failed"] {
        assert!(text.contains(part), "{text}");
    }
}
