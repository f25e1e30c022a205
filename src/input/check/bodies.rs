//! Checks of materials and bodies: names, positions, and number of particles.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use serde_json::json;

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use super::common::{MOST, check_box, check_length, check_printable};
use super::{materials, motion};
use crate::geometry::{BoundedRegion, PointFault, Tile, fill, voronoi, voronoi_line};
use crate::scene::CheckedBody;
use crate::scene::TOUCHING;
use crate::scene::{Body, BoxShape, Positions, Region, Scene};

pub(super) fn check(
    scene: &Scene,
    cell_size: &[f64],
    warnings: &mut Vec<String>,
) -> Result<Vec<CheckedBody>, Faults> {
    let mut faults = Faults::default();
    faults.extend(materials::check(scene, warnings));
    let materials: Vec<_> = scene.materials.keys().map(String::as_str).collect();
    let index: HashMap<_, _> = materials.iter().enumerate().map(|(i, &name)| (name, i)).collect();
    let mut names = HashSet::new();
    let mut checked = Vec::with_capacity(scene.bodies.len());
    for (i, body) in scene.bodies.iter().enumerate() {
        let path = format!("bodies[{i}].name");
        faults.take(check_printable(&path, &body.name));
        if !names.insert(body.name.as_str()) {
            let reason = "another body has this name; allowed: a name of its own";
            faults.add(SceneFault::new(path, &body.name, reason));
        }
        let path = join("bodies", &body.name);
        let material = index[body.material.as_str()];
        // what a faulty material cannot do is no fault of the body
        if faults.concern(&join("materials", &body.material)) {
            continue;
        }
        checked.extend(faults.take(check_body(scene, body, &path, material, cell_size)));
    }
    faults.ok_or_faults(())?;
    check_overlap(scene, &checked, cell_size)?;
    let used: HashSet<_> = checked.iter().map(|body| body.material).collect();
    for (i, name) in materials.iter().enumerate() {
        if !used.contains(&i) {
            warnings.push(format!("{}: no body is of this material", join("materials", name)));
        }
    }
    Ok(checked)
}

fn check_body(
    scene: &Scene,
    body: &Body,
    path: &str,
    material: usize,
    cell_size: &[f64],
) -> Result<CheckedBody, SceneFault> {
    let dimension = cell_size.len();
    let below = |key: &str| format!("{path}.{key}");
    let velocity = body.velocity.clone().unwrap_or_else(|| vec![0.0; dimension]);
    let mut regions = scene.regions_of(body);
    let keys: Vec<_> = regions.iter().map(|(key, _)| *key).collect();
    let (Some((key, region)), 1) = (regions.pop(), keys.len()) else {
        let allowed = if dimension == 1 { "\"box\"" } else { KEYS };
        return Err(match keys.get(1) {
            None => {
                SceneFault::missing(below("box"), format!("missing key; allowed: one of {allowed}"))
            }
            Some(other) => {
                let reason = format!("beside {}; allowed: one region a body", below(keys[0]));
                SceneFault::new(below(other), true, reason)
            }
        });
    };
    let fill = Fill { scene, body, path, key, region: &region, cell_size };
    let filled = if dimension == 1 { fill.line()? } else { fill.plane()? };
    check_length(&below("velocity"), &velocity, dimension)?;
    check_inside(scene, path, (key, &region), &filled, cell_size)?;
    materials::check_pressure(scene, body, &below("pressure"))?;
    let motion = motion::check_field(scene, body, path, dimension)?;
    let Filled { lower, upper, lattice, tiles } = filled;
    let top_speed = match &motion {
        Some(motion) => motion.top_speed(&lower, &upper),
        None => norm(&velocity),
    };
    let particles = match &tiles {
        Some(tiles) => tiles.len() as u64,
        None => lattice.iter().map(|&n| n as u64).product(),
    };
    Ok(CheckedBody {
        material,
        velocity,
        motion,
        top_speed,
        lower,
        upper,
        lattice,
        tiles,
        particles,
    })
}

/// Keys of regions, for messages.
const KEYS: &str = "\"box\", \"disk\", \"ellipse\", \"polygon\", \"annulus\", \"half_plane\", \
                    \"union\", \"difference\", \"intersection\" and \"rotation\"";

/// Results of filling a body with particles; see [`CheckedBody`].
struct Filled {
    lower: Vec<f64>,
    upper: Vec<f64>,
    lattice: Vec<usize>,
    tiles: Option<Arc<Vec<Tile>>>,
}

/// Input for filling a body with particles.
struct Fill<'a> {
    scene: &'a Scene,
    body: &'a Body,
    path: &'a str,
    /// Key of its region.
    key: &'static str,
    region: &'a Region,
    cell_size: &'a [f64],
}

impl Fill<'_> {
    fn below(&self, key: &str) -> String {
        format!("{}.{key}", self.path)
    }

    /// Particles per cell; required without `positions`, not allowed with them.
    fn per_cell(&self) -> Result<Option<&[usize]>, SceneFault> {
        let path = self.below("particles_per_cell");
        let dimension = self.cell_size.len();
        match (&self.body.particles_per_cell, &self.body.positions) {
            (Some(counts), None) => {
                check_length(&path, counts, dimension)?;
                Ok(Some(counts))
            }
            (None, Some(_)) => Ok(None),
            (None, None) => {
                let reason = "missing key; allowed: an array of whole numbers, or positions";
                Err(SceneFault::missing(path, reason))
            }
            (Some(counts), Some(_)) => {
                let reason = format!("beside {}; allowed: one of them", self.below("positions"));
                Err(SceneFault::new(path, counts, reason))
            }
        }
    }

    /// Positions given in the scene.
    fn points<const D: usize>(&self) -> Result<Vec<[f64; D]>, SceneFault> {
        let path = self.below("positions");
        let points = match &self.body.positions {
            Some(Positions::Points(points)) => points,
            Some(Positions::File(name)) => {
                let reason = "a file is read with the scene alone; allowed: positions in the scene's \
                              own text, or an array of points";
                return Err(SceneFault::new(path, name, reason));
            }
            None => return Ok(Vec::new()),
        };
        let point = |(k, point): (usize, &Vec<f64>)| {
            check_length(&format!("{path}[{k}]"), point, D)?;
            Ok(std::array::from_fn(|a| point[a]))
        };
        points.iter().enumerate().map(point).collect()
    }

    fn faulty(&self, fault: PointFault) -> SceneFault {
        let path = format!("{}[{}]", self.below("positions"), fault.number);
        SceneFault::new(path, fault.place, fault.reason)
    }

    /// Fills a body in one dimension.
    fn line(&self) -> Result<Filled, SceneFault> {
        let Region::Box(extent) = self.region else {
            let reason = "a region of the plane, but domain.lower has 1 number, which is the \
                          dimension of the scene; allowed: \"box\"";
            return Err(SceneFault::new(self.below(self.key), true, reason));
        };
        let (lower, upper) = (extent.lower.clone(), extent.upper.clone());
        check_length(&self.below("box.lower"), &lower, 1)?;
        check_length(&self.below("box.upper"), &upper, 1)?;
        check_box(&self.below("box"), &lower, &upper)?;
        let Some(per_cell) = self.per_cell()? else {
            let points: Vec<f64> = self.points::<1>()?.into_iter().map(|p| p[0]).collect();
            let tiles = voronoi_line(lower[0], upper[0], &points).map_err(|f| self.faulty(f))?;
            let tile = |&(centre, length): &(f64, f64)| Tile {
                centre: [centre, 0.0],
                area: length,
                size: [length, 0.0],
            };
            let tiles = Some(Arc::new(tiles.iter().map(tile).collect()));
            return Ok(Filled { lower, upper, lattice: vec![1], tiles });
        };
        let lattice = lattice(extent, per_cell, self.path, self.cell_size)?;
        Ok(Filled { lower, upper, lattice, tiles: None })
    }

    /// Fills a body in a plane.
    fn plane(&self) -> Result<Filled, SceneFault> {
        if let Region::Box(extent) = self.region {
            check_length(&self.below("box.lower"), &extent.lower, 2)?;
            check_length(&self.below("box.upper"), &extent.upper, 2)?;
            check_box(&self.below("box"), &extent.lower, &extent.upper)?;
            if let Some(per_cell) = self.per_cell()? {
                let (lower, upper) = (extent.lower.clone(), extent.upper.clone());
                let lattice = lattice(extent, per_cell, self.path, self.cell_size)?;
                return Ok(Filled { lower, upper, lattice, tiles: None });
            }
        }
        let shape = BoundedRegion::new(self.region)
            .map_err(|fault| SceneFault::new(self.below(&fault.path), fault.value, fault.reason))?;
        let [lower, upper] = shape.bounds().map(|corner| corner.to_vec());
        let cell = [self.cell_size[0], self.cell_size[1]];
        let tiles = match self.per_cell()? {
            Some(per_cell) => {
                let counts = [per_cell[0], per_cell[1]];
                let whole = cell[0] * cell[1] / (counts[0] * counts[1]) as f64;
                if shape.area() / whole > MOST_TILES {
                    let reason = format!(
                        "{:.1e} particles; allowed: at most {MOST_TILES:e} in a body that is no box",
                        shape.area() / whole
                    );
                    let path = self.below("particles_per_cell");
                    return Err(SceneFault::new(path, per_cell, reason));
                }
                let origin = [self.scene.domain.lower[0], self.scene.domain.lower[1]];
                fill(&shape, origin, cell, counts)
            }
            None => voronoi(&shape, &self.points::<2>()?).map_err(|f| self.faulty(f))?,
        };
        Ok(Filled { lower, upper, lattice: vec![1; 2], tiles: Some(Arc::new(tiles)) })
    }
}

/// Maximum number of particles of a body whose tiles are generated one by one.
const MOST_TILES: f64 = 1e9;

/// Checks that a body, whose region has the key `key`, lies within the domain.
fn check_inside(
    scene: &Scene,
    path: &str,
    (key, region): (&str, &Region),
    filled: &Filled,
    cell_size: &[f64],
) -> Result<(), SceneFault> {
    let domain = &scene.domain;
    for (d, size) in cell_size.iter().enumerate() {
        let tolerance = TOUCHING * size;
        let (lower, upper) = (domain.lower[d], domain.upper[d]);
        let (corner, value) = if filled.lower[d] < lower - tolerance {
            ("lower", &filled.lower)
        } else if filled.upper[d] > upper + tolerance {
            ("upper", &filled.upper)
        } else {
            continue;
        };
        let allowed = format!("allowed: {lower} to {upper} (domain.lower, domain.upper)");
        // a box has the corner as a key; the corners of other regions follow from theirs
        return Err(match region {
            Region::Box(_) => {
                let reason = format!("outside of the domain; {allowed}");
                SceneFault::new(format!("{path}.box.{corner}"), value, reason)
            }
            _ => {
                let reason = format!(
                    "outside of the domain: it reaches from {:?} to {:?} along {}; {allowed}",
                    filled.lower[d],
                    filled.upper[d],
                    ["x", "y"][d]
                );
                let value = json!(region)[key].clone();
                SceneFault::new(format!("{path}.{key}"), value, reason)
            }
        });
    }
    Ok(())
}

/// Length of a vector; exact along an axis.
fn norm(v: &[f64]) -> f64 {
    match v {
        [x] => x.abs(),
        _ => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
    }
}

/// Number of particles in each direction of a box.
fn lattice(
    extent: &BoxShape,
    per_cell: &[usize],
    path: &str,
    cell_size: &[f64],
) -> Result<Vec<usize>, SceneFault> {
    let mut total = 1.0;
    let mut lattice = Vec::with_capacity(cell_size.len());
    for (d, size) in cell_size.iter().enumerate() {
        let cells = (extent.upper[d] - extent.lower[d]) / size;
        let count = (cells * per_cell[d] as f64).round();
        if count < 1.0 {
            let reason = format!(
                "no particle: the body is {cells:?} cells long, less than half a particle's size; \
                 allowed: a longer box, a smaller domain.cell_size or more particles_per_cell"
            );
            return Err(SceneFault::new(format!("{path}.box"), extent, reason));
        }
        total *= count;
        if total > MOST {
            let reason = format!(
                "{total:e} particles; allowed: at most {MOST:e} in all, and what the machine's \
                 memory holds"
            );
            let path = format!("{path}.particles_per_cell");
            return Err(SceneFault::new(path, per_cell, reason));
        }
        lattice.push(count as usize);
    }
    Ok(lattice)
}

/// Checks that bodies may touch but do not overlap: in order of x, each is compared with those that
/// begin before it ends.
fn check_overlap(
    scene: &Scene,
    checked: &[CheckedBody],
    cell_size: &[f64],
) -> Result<(), SceneFault> {
    let mut order: Vec<usize> = (0..checked.len()).collect();
    order.sort_by(|&a, &b| checked[a].lower[0].total_cmp(&checked[b].lower[0]));
    let cell: f64 = cell_size.iter().product();
    let overlap = |a: usize, b: usize| {
        let (one, other) = (&checked[a], &checked[b]);
        let boxes = cell_size.iter().enumerate().all(|(d, size)| {
            one.upper[d].min(other.upper[d]) - one.lower[d].max(other.lower[d]) > TOUCHING * size
        });
        let region = |i: usize| scene.regions_of(&scene.bodies[i]).pop().map(|(_, region)| region);
        match (boxes, region(a), region(b)) {
            (false, ..) | (_, None, _) | (.., None) => false,
            (_, Some(Region::Box(_)), Some(Region::Box(_))) => true,
            (_, Some(a), Some(b)) => BoundedRegion::new(&Region::Intersection(vec![a, b]))
                .is_ok_and(|shape| shape.area() > TOUCHING * cell),
        }
    };
    let key = |i: usize| scene.bodies[i].regions().pop().map_or("box", |(key, _)| key);
    let path = |i: usize| join(&join("bodies", &scene.bodies[i].name), key(i));
    let value = |i: usize| json!(scene.bodies[i])[key(i)].clone();
    for (k, &body) in order.iter().enumerate() {
        let rest = order[k + 1..].iter();
        for &other in rest.take_while(|&&other| checked[other].lower[0] < checked[body].upper[0]) {
            if overlap(body, other) {
                let reason = format!(
                    "overlaps {} = {}; allowed: {} that touch at most",
                    path(body),
                    value(body),
                    if scene.domain.lower.len() == 1 { "boxes" } else { "bodies" }
                );
                return Err(SceneFault::new(path(other), value(other), reason));
            }
        }
    }
    Ok(())
}
