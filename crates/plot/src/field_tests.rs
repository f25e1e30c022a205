//! Tests of field pictures: positions, colours, and page sizes for planes of any shape.

use super::canvas::{Canvas, CanvasImage, CanvasShape};
use super::shades::Shades;
use super::tests::{count, drawn};
use super::*;

fn pressure(shading: Shading, limits: (f64, f64)) -> FieldQuantity {
    FieldQuantity { limits: Some(limits), ..FieldQuantity::new("Pressure", "Pa", shading) }
}

fn tile(centre: [f64; 2], half: f64, value: f64) -> FieldTile {
    FieldTile { centre, half_edges: [[half, 0.0], [0.0, half]], value, body: 0 }
}

fn field(tiles: Vec<FieldTile>, extent: [[f64; 2]; 2]) -> Field {
    let quantity = pressure(Shading::Sequential, (0.0, 1e9));
    let data = FieldData::Particles(tiles);
    Field { extent: Some(extent), ..Field::new("Field", 5e-7, quantity, data) }
}

fn laid_out(field: Field) -> Canvas {
    layout::lay_out(&field.figure()).unwrap()
}

/// Colour at a point of the plane, given as fractions from its lower left corner.
fn at(image: &CanvasImage, x: f64, y: f64) -> Color {
    let column = (x * image.columns as f64) as usize;
    let row = ((1.0 - y) * image.rows as f64) as usize;
    image.pixels[row * image.columns + column]
}

fn texts(canvas: &Canvas) -> Vec<&str> {
    let mut texts = Vec::new();
    for shape in &canvas.shapes {
        if let CanvasShape::Text(text) = shape {
            texts.push(text.text.as_str());
        }
    }
    texts
}

const YELLOW: Color = Color(253, 231, 37);
const PURPLE: Color = Color(68, 1, 84);

#[test]
fn sheared_particles_are_painted_where_they_are() {
    // A square of 2 mm, sheared so that its upper side has moved by 1 mm.
    let sheared =
        FieldTile { half_edges: [[1e-3, 0.0], [0.5e-3, 1e-3]], ..tile([0.0; 2], 1e-3, 1e9) };
    let canvas = laid_out(field(vec![sheared], [[-2e-3; 2], [2e-3; 2]]));
    let image = &canvas.images[0];
    assert_eq!(at(image, 0.5, 0.5), YELLOW);
    // Just inside and outside of the upper right corner and the left side.
    assert_eq!(at(image, 0.5 + 1.4 / 4.0, 0.5 + 0.95 / 4.0), YELLOW);
    assert_eq!(at(image, 0.5 + 1.3 / 4.0, 0.5), Color::WHITE);
    assert_eq!(at(image, 0.5 - 0.9 / 4.0, 0.5 + 0.9 / 4.0), Color::WHITE);
    assert_eq!(at(image, 0.5, 0.5 + 1.1 / 4.0), Color::WHITE);
    assert_eq!((canvas.images.len(), texts(&canvas).contains(&"no data")), (2, false));
}

#[test]
fn gaps_stay_empty_and_values_that_are_not_finite_leave_one() {
    let tiles = vec![
        tile([1.0, 1.0], 0.5, 0.0),
        tile([3.0, 1.0], 0.5, 5e12),
        tile([5.0, 1.0], 0.5, f64::NAN),
        tile([f64::INFINITY, 1.0], 0.5, 1e9),
    ];
    let canvas = laid_out(field(tiles, [[0.0; 2], [6.0, 2.0]]));
    let row = [0.4, 1.0, 2.0, 3.0, 4.0, 5.0].map(|x| at(&canvas.images[0], x / 6.0, 0.5));
    let none = Color::WHITE;
    assert_eq!(row, [none, PURPLE, none, YELLOW, none, none], "{row:?}");
    // One pointed end, for the value above the upper end.
    let tips = canvas.shapes.iter().filter(|s| matches!(s, CanvasShape::Polygon { .. })).count();
    assert_eq!(tips, 1);
}

#[test]
fn scales_are_equal_in_both_directions_on_pages_of_any_shape() {
    let plane = |x: f64, y: f64| {
        let canvas =
            laid_out(field(vec![tile([0.5 * x, 0.5 * y], 0.1 * x, 1e9)], [[0.0; 2], [x, y]]));
        let rect = canvas.images[0].rect;
        let stretched = texts(&canvas).iter().any(|text| text.contains("stretched"));
        assert!(canvas.size.0 <= 1600.0 && canvas.size.1 <= 1000.0, "{:?}", canvas.size);
        assert!(rect.left > 60.0 && rect.right < canvas.size.0 - 20.0);
        assert!(rect.bottom < canvas.size.1 - 70.0);
        assert!(rect.width() >= 64.0 && rect.height() >= 64.0);
        assert_eq!(canvas.size.0.fract() + canvas.size.1.fract() + rect.left.fract(), 0.0);
        (rect.width() * y / (rect.height() * x), stretched)
    };
    for (x, y) in [(1e-2, 1e-2), (1e-2, 1e-3), (1e-3, 5e-3), (4.0, 3.0), (1e-6, 3e-6)] {
        let (aspect, stretched) = plane(x, y);
        assert!((aspect - 1.0).abs() < 0.01 && !stretched, "{x} {y}: {aspect}");
    }
    for (x, y) in [(8e-3, 8e-6), (8e-6, 8e-3)] {
        assert!(plane(x, y).1);
    }
}

#[test]
fn a_thin_plane_is_stretched_and_its_bar_lies_below() {
    let cells = Cells {
        lower: [0.0, 0.0],
        upper: [8e-3, 8e-6],
        counts: [1000, 1],
        values: (0..1000).map(|i| (i >= 100).then_some(if i < 500 { 1e9 } else { 0.0 })).collect(),
    };
    let quantity = pressure(Shading::Sequential, (0.0, 1e9));
    let canvas = laid_out(Field::new("Strip", 1e-6, quantity, FieldData::Cells(cells)));
    let (image, bar) = (&canvas.images[0], &canvas.images[1]);
    assert_eq!([0.05, 0.3, 0.8].map(|x| at(image, x, 0.5)), [Color::WHITE, YELLOW, PURPLE]);
    assert!(bar.rect.top > image.rect.bottom && bar.rect.width() > 10.0 * bar.rect.height());
    let texts = texts(&canvas);
    for text in ["Strip, t = 1 µs", "x (mm)", "y (µm)", "y stretched ×98", "Pressure (GPa)"] {
        assert!(texts.contains(&text), "{text} is missing in {texts:?}");
    }
}

#[test]
fn the_other_half_is_the_mirror_image() {
    let tiles = vec![tile([1.0, 0.5], 0.5, 1e9), tile([1.0, 2.5], 0.5, 1e9)];
    let mut half = field(tiles, [[0.0, 0.0], [2.0, 3.0]]);
    half.quantity = pressure(Shading::Diverging, (-1e9, 1e9));
    half.mirror = Some(SymmetryPlane { across: Direction::Y, at: 0.0, changes_sign: true });
    let canvas = laid_out(half);
    let image = &canvas.images[0];
    let column = [-2.5, -1.5, -0.5, 0.5, 1.5, 2.5].map(|y| at(image, 0.5, (y + 3.0) / 6.0));
    let [cold, warm] = [0.0, 1.0].map(|end| Shades::Diverging.color(end));
    let none = Color::WHITE;
    assert_eq!(column, [cold, none, cold, warm, none, warm]);
}

#[test]
fn mirror_images_lean_the_other_way() {
    let leaning = FieldTile { half_edges: [[0.2, 0.0], [0.8, 0.5]], ..tile([1.0, 0.5], 0.5, 1e9) };
    let mirror = Some(SymmetryPlane { across: Direction::X, at: 0.0, changes_sign: false });
    let canvas = laid_out(Field { mirror, ..field(vec![leaning], [[0.0; 2], [2.0, 1.0]]) });
    let image = &canvas.images[0];
    let row = [-1.75, -0.25, 0.25, 1.75].map(|x| at(image, (x + 2.0) / 4.0, 0.9));
    assert_eq!(row, [YELLOW, Color::WHITE, Color::WHITE, YELLOW]);
}

#[test]
fn a_hairline_parts_bodies() {
    let square = |x: f64, body: u32| FieldTile { body, ..tile([x, 1.0], 1.0, 1e9) };
    let dark = |outlines: bool, body: u32| {
        let tiles = vec![square(1.0, 0), square(3.0, body)];
        let canvas = laid_out(Field { outlines, ..field(tiles, [[0.0; 2], [4.0, 2.0]]) });
        let image = &canvas.images[0];
        let row = &image.pixels[image.columns * (image.rows / 2)..][..image.columns];
        row.iter().filter(|color| color.0 < 100).count()
    };
    assert_eq!((dark(true, 1), dark(true, 0), dark(false, 1)), (2, 0, 0));
}

#[test]
fn bodies_have_the_colours_that_are_given() {
    let square = |x: f64, body: u32| FieldTile { body, ..tile([x, 1.0], 1.0, 1e9) };
    let tiles = vec![square(1.0, 0), square(3.0, 1)];
    let fills = Some(vec![Color::ORANGE, Color::GRAY]);
    let canvas = laid_out(Field { fills, ..field(tiles, [[0.0; 2], [5.0, 2.0]]) });
    let image = &canvas.images[0];
    let row = [1.0, 3.0, 4.5].map(|x| at(image, x / 5.0, 0.5));
    assert_eq!(row, [Color::ORANGE, Color::GRAY, Color::WHITE]);
    assert_eq!(canvas.images.len(), 1, "there is no colour bar");
}

#[test]
fn both_files_show_the_field() {
    let tiles = vec![tile([1e-3, 1e-3], 1e-3, 1e9), tile([3e-3, 1e-3], 1e-3, 0.0)];
    let shock = Points::new([2e-3, 2e-3], [0.0, 2e-3]);
    let overlay = Style { outlined: true, ..Style::line(Color::WHITE) };
    let figure = Field {
        notes: vec!["L1 = 0.9 %".into()],
        overlays: vec![Series::new("shock", shock, overlay)],
        ..field(tiles, [[0.0; 2], [4e-3, 2e-3]])
    };
    let (png, svg) = drawn(&figure.figure());
    let whole = [0, 0, png.0, png.1];
    assert!(count(&png, whole, |p| p == [253, 231, 37]) > 200_000);
    assert!(count(&png, whole, |p| p == [68, 1, 84]) > 200_000);
    for text in ["Field, t = 0.5 µs", "L1 = 0.9 %", "shock", "x (mm)", "Pressure (GPa)"] {
        assert!(svg.contains(text), "{text} is missing");
    }
    assert!(svg.contains(&format!("width=\"{}\" height=\"{}\"", png.0, png.1)));
}

#[test]
fn odd_fields_are_drawn_as_far_as_they_go() {
    let odd = [f64::NAN, f64::INFINITY, 0.0, -1e308, 1e150, 3e-3];
    let quantity = FieldQuantity::new("Pressure", "Pa", Shading::BySign);
    let alone = |tiles| Field::new("Odd", f64::NAN, quantity.clone(), FieldData::Particles(tiles));
    for i in 0..36 {
        let [value, place, size] = [i / 6, i % 6, (i / 6 + i) % 6].map(|k| odd[k]);
        let tiles = vec![tile([place, 1.0], size, value); 2];
        let canvas = laid_out(Field { outlines: true, ..alone(tiles) });
        assert!(canvas.size.0 < 1600.0 && canvas.size.1 < 1100.0);
    }
    for extent in [[[0.0; 2]; 2], [[f64::NAN; 2], [1.0; 2]], [[-1e300; 2], [1e300; 2]]] {
        let mirror = Some(SymmetryPlane { across: Direction::X, at: f64::NAN, changes_sign: true });
        drawn(&Field { extent: Some(extent), mirror, ..alone(vec![]) }.figure());
    }
    let (_, svg) = drawn(&alone(vec![]).figure());
    assert!(svg.contains("no data") && svg.contains("y (m)"));
}

#[test]
fn cells_without_their_values_are_refused() {
    let cells = Cells { lower: [0.0; 2], upper: [1.0; 2], counts: [3, 4], values: vec![None; 11] };
    let quantity = FieldQuantity::new("Pressure", "Pa", Shading::BySign);
    let figure = Field::new("Bad", 0.0, quantity, FieldData::Cells(cells)).figure();
    let error = layout::lay_out(&figure).unwrap_err().to_string();
    assert_eq!(error, "picture 'Bad, t = 0 µs': 12 cells but 11 values");
}
