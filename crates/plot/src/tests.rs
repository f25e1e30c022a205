//! Tests of whole pictures: text and points appear in both files; non-finite data do no harm.

use std::path::Path;

use super::*;

/// A decoded PNG: width, height, RGB.
fn decoded(path: &Path) -> (usize, usize, Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info.width as usize, info.height as usize, pixels)
}

/// Draws a figure and returns the bitmap and the SVG text.
pub(super) fn drawn(figure: &Figure) -> ((usize, usize, Vec<u8>), String) {
    let folder = tempfile::tempdir().unwrap();
    let files = draw(figure, &folder.path().join("a picture.of 0.5us")).unwrap();
    assert!(files.png.ends_with("a picture.of 0.5us.png"));
    (decoded(&files.png), std::fs::read_to_string(&files.svg).unwrap())
}

/// Number of pixels in a part of a bitmap that satisfy `wanted`.
pub(super) fn count(
    (width, _, pixels): &(usize, usize, Vec<u8>),
    [left, top, right, bottom]: [usize; 4],
    wanted: impl Fn(&[u8]) -> bool,
) -> usize {
    let rows = pixels.chunks_exact(3 * width).take(bottom).skip(top);
    rows.flat_map(|row| row.chunks_exact(3).take(right).skip(left)).filter(|p| wanted(p)).count()
}

fn profile() -> ProfileFigure {
    let x: Vec<f64> = (0..400).map(|i| f64::from(i) * 2e-5).collect();
    let p: Vec<f64> = x.iter().map(|x| if *x < 5e-3 { 12e9 } else { 0.0 }).collect();
    ProfileFigure {
        title: "Copper <on> aluminium & more".into(),
        time: 0.5e-6,
        approximation: Some(Points::new(x.clone(), p.clone())),
        exact: Some(Points::new(x.clone(), p.clone())),
        computed: vec![ProfilePart {
            name: "MPM".into(),
            color: Color::GREEN,
            points: Points::new(x, p),
        }],
        failed: Points::new([], []),
        bands: vec![],
        interfaces: vec![],
        notes: vec!["L1 = 0.9 %".into()],
        close_up: Some((4.8e-3, 5.2e-3)),
    }
}

#[test]
fn profile_shows_text_and_points_in_both_files() {
    let (png, svg) = drawn(&profile().figure());
    assert_eq!((png.0, png.1), (1200, 800));
    let dark = |p: &[u8]| p.iter().all(|&v| v < 100);
    assert!(count(&png, [60, 20, 1200, 60], dark) > 500, "no title");
    assert!(count(&png, [200, 740, 1000, 800], dark) > 100, "no label under the x axis");
    assert!(count(&png, [20, 200, 60, 700], dark) > 100, "no label of the y axis");
    let green = |p: &[u8]| p[1] > 130 && p[0] < 110 && p[2] < 130;
    assert!(count(&png, [100, 120, 1180, 700], green) > 500, "no computed points");
    for text in
        ["Copper &lt;on&gt; aluminium &amp; more, t = 0.5 µs", "Pressure (GPa)", "Position (mm)"]
    {
        assert!(svg.contains(text), "{text} is missing");
    }
    for text in ["MPM", "exact solution", "shock approximation", "L1 = 0.9 %", "sans-serif"] {
        assert!(svg.contains(text), "{text} is missing");
    }
    assert!(svg.matches("<circle").count() >= 400);
    assert!(svg.trim_end().ends_with("</svg>"));
}

#[test]
fn figures_without_data_say_so() {
    let empty = [
        HugoniotFigure { title: "Nothing".into(), curves: vec![], states: vec![] }.figure(),
        WaveDiagram { title: "Nothing".into(), ..WaveDiagram::default() }.figure(),
        Figure::new("Nothing", Axis::log("Cost", "s")).panel(
            Panel::new(Axis::log("Error", "")).series(Series::new(
                "nought",
                Points::new([0.0, -1.0, f64::NAN], [1.0, f64::INFINITY, 2.0]),
                Style::line(Color::RED),
            )),
        ),
    ];
    for figure in empty {
        let (png, svg) = drawn(&figure);
        assert!(svg.contains("no data"));
        assert!(count(&png, [300, 200, 900, 600], |p| p[0] < 200) > 50);
    }
    let panels = vec![];
    drawn(&HistoriesFigure { title: "No panel".into(), panels }.figure());
}

#[test]
fn odd_data_are_drawn_as_far_as_they_go() {
    let odd = [f64::NAN, f64::NEG_INFINITY, 1e308, -1e308, 5e-324, 0.0, 3.0, 3.0, 1e-9];
    for axis in
        [Axis::linear("x", "m"), Axis::log("x", "m"), Axis::linear("x", "m").range(2.0, 1.0)]
    {
        for values in [&odd[..], &odd[5..6], &odd[6..8], &odd[..2]] {
            let points = Points::new(values, values.iter().rev().copied().collect::<Vec<_>>());
            let style = Style::line_and_marks(Color::RED).stroke(Stroke::Dashed);
            let panel = Panel::new(Axis { label: "\u{0}y".into(), ..axis.clone() });
            let panel = panel.series(Series::new("", points, style)).note("note");
            let (_, svg) = drawn(&Figure::new("odd", axis.clone()).panel(panel));
            assert!(!svg.contains('\u{0}') && !svg.contains("NaN"));
        }
    }
    let rows = vec![
        DiagramRow { time: f64::NAN, x: vec![0.0], values: vec![1.0] },
        DiagramRow { time: 1e-6, x: vec![0.0, 0.0, f64::NAN], values: vec![f64::NAN, 2.0, 1.0] },
        DiagramRow { time: 1e-6, x: vec![], values: vec![] },
    ];
    drawn(&WaveDiagram { title: "odd".into(), rows, ..WaveDiagram::default() }.figure());
}

#[test]
fn bars_stand_beside_the_panels() {
    let part = |name: &str, index| BarPart { name: name.into(), color: Color::palette(index) };
    let bar = |label: &str, values: &[f64]| Bar { label: label.into(), values: values.into() };
    let bars = Bars {
        label: "Share of time".into(),
        unit: "%".into(),
        parts: vec![part("compute", 0), part("wait", 1)],
        bars: vec![
            bar("1 rank", &[75.0, 25.0]),
            bar("2 ranks", &[f64::NAN, -1.0]),
            bar("4 ranks", &[]),
        ],
    };
    let points = Points::new([1.0, 2.0], [1.0, 1.9]);
    let look = Style::line_and_marks(Color::RED).hollow();
    let panel = Panel::new(Axis::log("Speed-up", "")).series(Series::new("ranks", points, look));
    let (png, svg) = drawn(&Figure::new("Bars", Axis::log("Workers", "")).panel(panel).bars(bars));
    for text in ["Share of time (%)", "compute", "wait", "2 ranks", ">\n75\n<", "no data"] {
        assert!(svg.contains(text), "{text} is missing");
    }
    let blue = |p: &[u8]| p == [0x1f, 0x6f, 0xb4];
    assert!(count(&png, [620, 120, 1180, 700], blue) > 5000);
    assert_eq!(count(&png, [0, 120, 580, 700], blue), 0);
}

#[test]
fn columns_of_unequal_length_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut bad = profile();
    bad.computed[0].points.y.pop();
    let error = draw(&bad.figure(), &folder.path().join("bad")).unwrap_err().to_string();
    assert!(error.contains("'MPM' has 400 abscissae but 399 ordinates"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let missing = folder.path().join("no/folder/x");
    assert!(matches!(draw(&profile().figure(), &missing), Err(PictureError::Write { .. })));
}

#[test]
fn very_many_points_are_thinned_without_losing_peaks() {
    let x: Vec<f64> = (0..300_000).map(f64::from).collect();
    let mut y: Vec<f64> = x.iter().map(|x| (x * 1e-4).sin()).collect();
    y[123_456] = 10.0;
    let series = Series::new("many", Points::new(x, y), Style::marks(Color::RED));
    let panel = Panel::new(Axis::linear("y", "").range(-2.0, 11.0)).series(series);
    let (png, svg) = drawn(&Figure::new("Many", Axis::linear("x", "")).panel(panel));
    assert!(svg.matches("<circle").count() < 5010);
    assert!(svg.len() < 500_000);
    let red = |p: &[u8]| p[0] > 150 && p[1] < 120;
    assert!(count(&png, [500, 90, 600, 200], red) > 5, "the peak is lost");
}

#[test]
fn colour_map_is_in_both_files() {
    let rows = (0..50).map(|i| {
        let x: Vec<f64> = (0..100).map(|j| f64::from(j) * 1e-5).collect();
        let pressure = x.iter().map(|x| if *x < f64::from(i) * 2e-5 { 1e9 } else { 0.0 }).collect();
        DiagramRow { time: f64::from(i) * 1e-8, x, values: pressure }
    });
    let path = WavePath {
        name: "shock".into(),
        points: Points::new([0.0, 1e-3], [0.0, 5e-7]),
        stroke: Stroke::Solid,
    };
    let title = "Waves".into();
    let (png, svg) = drawn(
        &WaveDiagram { title, rows: rows.collect(), paths: vec![path], ..WaveDiagram::default() }
            .figure(),
    );
    let yellow = |p: &[u8]| p[0] > 240 && p[1] > 220 && p[2] < 60;
    let purple = |p: &[u8]| p[0] < 80 && p[1] < 15 && p[2] > 70;
    assert!(count(&png, [100, 120, 900, 700], yellow) > 20_000);
    assert!(count(&png, [100, 120, 900, 700], purple) > 20_000);
    assert!(svg.contains("<image ") && svg.contains("data:image/png;base64,iVBOR"));
    assert!(svg.contains("shock") && svg.contains("Pressure (GPa)") && svg.contains("Time (µs)"));
}
