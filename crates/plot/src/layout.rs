//! Layout: turns a figure into shapes on a page.

use super::annotations;
use super::axes::{self, LABEL_EM, MARGIN, TICK, TICK_EM};
use super::axis::Axis;
use super::canvas::{Canvas, CanvasPoint, HEIGHT, Rect, WIDTH};
use super::color_bar::{self, ColorBar};
use super::color_map::ColorMap;
use super::curves::{self, place};
use super::error::PictureError;
use super::field_layout;
use super::figure::{Figure, Panel};
use super::legend;
use super::limits::AxisLimits;
use super::occupancy::Occupancy;
use super::series::{Points, Series, Stroke};
use super::ticks::{Ruler, drawable};
use super::title;

/// Gap between the panels and the bars beside them \[pixel\].
const GUTTER: f64 = 40.0;

/// Lays a figure out.
pub(super) fn lay_out(figure: &Figure) -> Result<Canvas, PictureError> {
    check(figure)?;
    if let Some((panel, field)) = figure.panels.iter().find_map(|p| Some((p, p.field.as_ref()?))) {
        return field_layout::lay_out(figure, panel, field);
    }
    let mut canvas = Canvas::new(&figure.title, (WIDTH, HEIGHT));
    let areas = areas(figure);
    let top = MARGIN + title::draw(&mut canvas, &figure.title, areas.left);
    let names = figure.legend();
    let mut legend_end = legend::draw(&mut canvas, &names, (areas.left, right_edge(figure)), top);
    let beside = (right_edge(figure) + GUTTER, WIDTH - MARGIN);
    if let Some(bars) = &figure.bars {
        legend_end = legend_end.max(bars.draw_legend(&mut canvas, beside, top));
    }
    let x = Ruler::new(&figure.x, x_values(figure), wanted(areas.right - areas.left, 120.0));
    let bottom = HEIGHT - MARGIN - LABEL_EM - TICK_EM - 24.0;
    let banded = figure.panels.iter().any(|panel| !panel.bands.is_empty());
    let head = if banded { 24.0 } else { 16.0 };
    let panels = areas_of_panels(figure.panels.len(), &areas, legend_end + head, bottom);
    for (index, (panel, area)) in figure.panels.iter().zip(&panels).enumerate() {
        let y = y_ruler(figure, panel, area.height());
        draw_panel(&mut canvas, figure, panel, area, (&x, &y));
        axes::frame(&mut canvas, area, &x, &y, areas.label);
        if index + 1 == panels.len() {
            axes::x_numbers(&mut canvas, area, &x);
        }
    }
    if let Some(bars) = &figure.bars {
        bars.draw(&mut canvas, beside, (legend_end + 16.0, bottom));
    }
    Ok(canvas)
}

fn check(figure: &Figure) -> Result<(), PictureError> {
    let lengths = |series: &str, x: usize, y: usize| PictureError::Lengths {
        figure: figure.title.clone(),
        series: series.into(),
        x,
        y,
    };
    for panel in &figure.panels {
        for Series { name, points: Points { x, y }, .. } in &panel.series {
            if x.len() != y.len() {
                return Err(lengths(name, x.len(), y.len()));
            }
        }
        for row in panel.map.iter().flat_map(|map| &map.rows) {
            if row.x.len() != row.values.len() {
                return Err(lengths("colour map", row.x.len(), row.values.len()));
            }
        }
    }
    Ok(())
}

/// Horizontal layout that all panels share \[pixel\].
struct Areas {
    left: f64,
    right: f64,
    /// Middle of the vertical labels.
    label: f64,
}

/// Right edge of the panels with their colour bars.
fn right_edge(figure: &Figure) -> f64 {
    if figure.bars.is_some() { 0.5 * (WIDTH - GUTTER) } else { WIDTH - MARGIN }
}

fn areas(figure: &Figure) -> Areas {
    // Panels are lower under a long legend: reserve space for the numbers of low and high panels.
    let heights = [0.6, 0.9].map(|share| share * HEIGHT / figure.panels.len().max(1) as f64);
    let panels = || heights.iter().flat_map(|&h| figure.panels.iter().map(move |p| (p, h)));
    let rulers = panels().map(|(panel, height)| y_ruler(figure, panel, height));
    let numbers = rulers.map(|ruler| ruler.widest(TICK_EM)).fold(0.0, f64::max);
    let maps = figure.panels.iter().filter_map(|panel| panel.map.as_ref());
    let bars = maps.flat_map(|map| {
        let scale = map.scale();
        heights.map(|height| color_bar::room_beside(&bar_ruler(map, &scale, height)))
    });
    Areas {
        left: MARGIN + LABEL_EM + 14.0 + numbers + 6.0 + TICK,
        right: right_edge(figure) - bars.fold(0.0, f64::max),
        label: MARGIN + 0.75 * LABEL_EM,
    }
}

fn areas_of_panels(count: usize, areas: &Areas, top: f64, bottom: f64) -> Vec<Rect> {
    let gap = 22.0;
    let height = (bottom - top - gap * (count.max(1) - 1) as f64) / count.max(1) as f64;
    (0..count)
        .map(|index| {
            let top = top + index as f64 * (height + gap);
            Rect { left: areas.left, right: areas.right, top, bottom: top + height }
        })
        .collect()
}

fn wanted(length: f64, room: f64) -> usize {
    ((length / room) as usize).clamp(3, 10)
}

/// Abscissae that the x axis must cover: those of a colour map, else those of series and labels.
fn x_values(figure: &Figure) -> impl Iterator<Item = f64> {
    let rows =
        figure.panels.iter().filter_map(|panel| panel.map.as_ref()).flat_map(|map| &map.rows);
    let mapped: Vec<f64> = rows.flat_map(|row| row.x.iter().copied()).collect();
    let use_series = !mapped.iter().any(|&x| drawable(x, figure.x.scale));
    let panels = figure.panels.iter().filter(move |_| use_series);
    let series =
        panels.clone().flat_map(|panel| &panel.series).flat_map(|s| s.points.x.iter().copied());
    let labels = panels.flat_map(|panel| &panel.labels).map(|label| label.x);
    series.chain(labels).chain(mapped)
}

fn y_ruler(figure: &Figure, panel: &Panel, height: f64) -> Ruler {
    let rows = panel.map.iter().flat_map(|map| &map.rows);
    let mapped: Vec<f64> = rows.map(|row| row.time).collect();
    let use_series = !mapped.iter().any(|&t| drawable(t, panel.y.scale));
    let x_scale = figure.x.scale;
    let series = panel.series.iter().filter(|_| use_series).flat_map(|series| {
        std::iter::zip(&series.points.x, &series.points.y)
            .filter(move |(x, _)| drawable(**x, x_scale))
            .map(|(_, y)| *y)
    });
    let labels = panel.labels.iter().filter(|_| use_series).map(|label| label.y);
    Ruler::new(&panel.y, series.chain(labels).chain(mapped), wanted(height, 70.0))
}

fn bar_ruler(map: &ColorMap, scale: &AxisLimits, height: f64) -> Ruler {
    let axis = Axis::linear(&map.label, &map.unit).range(scale.low, scale.high);
    Ruler::new(&axis, std::iter::empty(), wanted(height, 70.0))
}

fn draw_panel(
    canvas: &mut Canvas,
    figure: &Figure,
    panel: &Panel,
    area: &Rect,
    (x, y): (&Ruler, &Ruler),
) {
    let mut occupancy = Occupancy::new(*area);
    let below = canvas.shapes.len();
    if let Some(map) = &panel.map {
        let scale = map.scale();
        let colors = bar_ruler(map, &scale, area.height());
        canvas.images.push(map.image(*area, (x, y), (&colors, scale.shades)));
        let bar = ColorBar { shades: scale.shades, under: scale.under, over: scale.over };
        bar.draw_beside(canvas, area, &colors, WIDTH - MARGIN);
    } else {
        axes::grid(canvas, area, x, y);
    }
    bands(canvas, panel, area, x);
    for at in panel.lines.iter().filter_map(|&value| x.place(value)) {
        if (0.0..=1.0).contains(&at) {
            let at = area.left + at * area.width();
            let line = [(at, area.top), (at, area.bottom)];
            canvas.line(&line, 1.5, axes::INK, Stroke::Dashed);
        }
    }
    let mut empty = true;
    for series in &panel.series {
        let runs = curves::runs(&series.points, figure.x.scale, panel.y.scale);
        let places = |run: &Vec<_>| run.iter().filter_map(|p| place(area, x, y, *p)).collect();
        let runs: Vec<Vec<CanvasPoint>> = runs.iter().map(places).collect();
        empty &= runs.is_empty();
        curves::draw(canvas, &mut occupancy, series, &runs, area);
    }
    let mapped = panel.map.as_ref().is_some_and(|map| map.values().any(f64::is_finite));
    if empty && !mapped && panel.labels.is_empty() {
        axes::no_data(canvas, area);
    }
    for label in &panel.labels {
        annotations::label(canvas, &mut occupancy, label, area, x, y);
    }
    annotations::close_up(canvas, &mut occupancy, (figure, panel), area, (x, y), below);
    annotations::notes(canvas, &occupancy, &panel.notes, area);
}

/// Draws the bands above a panel, which name parts of the x axis by colour.
fn bands(canvas: &mut Canvas, panel: &Panel, area: &Rect, x: &Ruler) {
    for band in &panel.bands {
        let [Some(from), Some(to)] = [band.low, band.high].map(|end| x.place(end)) else {
            continue;
        };
        let [left, right] = [from, to].map(|at| area.left + at.clamp(0.0, 1.0) * area.width());
        if right > left {
            let (top, bottom) = (area.top - 14.0, area.top - 4.0);
            // a thin part stays visible
            let rect = Rect { left, top, right: right.max(left + 2.0), bottom };
            canvas.fill(rect, band.style.color, 1.0);
        }
    }
}
