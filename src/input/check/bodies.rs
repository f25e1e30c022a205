//! Checks of materials and bodies: names, positions, and number of particles.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use serde_json::json;

use super::super::errors::SceneFault;
use super::super::faults::Faults;
use super::super::paths::join;
use super::common::{MOST, check_box, check_length, check_printable};
use super::{materials, motion};
use crate::geometry::{BoundedRegion, PointFault, Tile, Tiling, fill, voronoi, voronoi_line};
use crate::scene::CheckedBody;
use crate::scene::TOUCHING;
use crate::scene::{Body, BoxShape, Positions, Region, Scene};

/// Checks each body; `None` for one that has a fault.
pub(super) fn check(
    scene: &Scene,
    cell_size: &[f64],
    faults: &mut Faults,
) -> Vec<Option<CheckedBody>> {
    let materials: HashMap<_, _> =
        scene.materials.keys().enumerate().map(|(i, name)| (name.as_str(), i)).collect();
    let mut names = HashSet::new();
    let mut check_name = |(i, body): (usize, &Body), faults: &mut Faults| {
        let path = format!("bodies[{i}].name");
        faults.take(check_printable(&path, &body.name));
        if !names.insert(body.name.clone()) {
            let reason = "another body has this name; allowed: a name of its own";
            faults.add(SceneFault::new(path, &body.name, reason));
        }
    };
    let mut check = |(i, body): (usize, &Body)| {
        // numbers are those of the file if no body is left out
        if faults.keys_are_valid() {
            check_name((i, body), faults);
        }
        let path = join("bodies", &body.name);
        let material = materials.get(body.material.as_str()).copied();
        let checked = check_body(scene, body, &path, material, cell_size, faults);
        if checked.is_none() {
            faults.leave_out(path);
        }
        checked
    };
    scene.bodies.iter().enumerate().map(&mut check).collect()
}

/// Warns of materials that no body has.
pub(super) fn warn_of_materials(scene: &Scene, warnings: &mut Vec<String>) {
    let used: HashSet<_> = scene.bodies.iter().map(|body| body.material.as_str()).collect();
    for name in scene.materials.keys().filter(|name| !used.contains(name.as_str())) {
        warnings.push(format!("{}: no body is of this material", join("materials", name)));
    }
}

fn check_body(
    scene: &Scene,
    body: &Body,
    path: &str,
    material: Option<usize>,
    cell_size: &[f64],
    faults: &mut Faults,
) -> Option<CheckedBody> {
    let dimension = cell_size.len();
    let below = |key: &str| format!("{path}.{key}");
    let velocity = body.velocity.clone().unwrap_or_else(|| vec![0.0; dimension]);
    faults.judge(&[&below("velocity")], || check_length(&below("velocity"), &velocity, dimension));
    let region = match faults.concern(path) {
        false => faults.take(region_of(scene, body, path)),
        true => region_of(scene, body, path).ok().filter(|(key, _)| !faults.concern(&below(key))),
    };
    let filled = region.and_then(|(key, region)| {
        let fill = Fill { scene, body, path, key, region: &region, cell_size };
        let outline = faults.take(fill.outline())?;
        // in a plane, a body is clipped at sides of symmetry
        let reads: &[&str] = if dimension == 1 { &[] } else { &["boundary"] };
        faults.judge(reads, || check_inside(scene, path, (key, &region), &outline, cell_size))?;
        // what cannot run is not filled, since that may take long
        let is_lattice = matches!(region, Region::Box(_)) && body.positions.is_none();
        match (is_lattice || faults.keys_are_valid()) && !faults.concern("domain.cell_size") {
            true => faults.take(fill.fill(outline)),
            false => Some(Filled::unknown(outline)),
        }
    });
    // what a faulty material cannot do is no fault of the body
    let material = material.filter(|_| !faults.concern(&join("materials", &body.material)))?;
    let pressure = below("pressure");
    faults.judge(&[&pressure], || materials::check_pressure(scene, body, &pressure));
    let reads = [&below("velocity")[..], &below("velocity_field")[..], &pressure[..]];
    let motion = faults.judge(&reads, || motion::check_field(scene, body, path, dimension))?;
    let Filled { lower, upper, lattice, tiling } = filled?;
    if faults.concern(path) {
        return None;
    }
    let top_speed = match &motion {
        Some(motion) => motion.top_speed(&lower, &upper),
        None => norm(&velocity),
    };
    let particles = match &tiling {
        Some(tiling) => tiling.count(),
        None => lattice.iter().map(|&n| n as u64).product(),
    };
    Some(CheckedBody {
        material,
        velocity,
        motion,
        top_speed,
        lower,
        upper,
        lattice,
        tiling,
        particles,
    })
}

/// The region of a body, with its key.
fn region_of(scene: &Scene, body: &Body, path: &str) -> Result<(&'static str, Region), SceneFault> {
    let mut regions = scene.regions_of(body);
    let keys: Vec<_> = regions.iter().map(|(key, _)| *key).collect();
    match (&keys[..], regions.pop()) {
        ([_], Some(region)) => Ok(region),
        ([first, other, ..], _) => {
            let reason = format!("beside {path}.{first}; allowed: one region a body");
            Err(SceneFault::new(format!("{path}.{other}"), true, reason))
        }
        _ => {
            let allowed = if scene.domain.lower.len() == 1 { "\"box\"" } else { KEYS };
            let reason = format!("missing key; allowed: one of {allowed}");
            Err(SceneFault::missing(format!("{path}.box"), reason))
        }
    }
}

/// Keys of regions, for messages.
const KEYS: &str = "\"box\", \"disk\", \"ellipse\", \"polygon\", \"annulus\", \"half_plane\", \
                    \"union\", \"difference\", \"intersection\" and \"rotation\"";

/// Results of filling a body with particles; see [`CheckedBody`].
struct Filled {
    lower: Vec<f64>,
    upper: Vec<f64>,
    lattice: Vec<usize>,
    tiling: Option<Arc<Tiling>>,
}

impl Filled {
    /// A body whose particles are not known.
    fn unknown(outline: BodyOutline) -> Self {
        let BodyOutline { lower, upper, .. } = outline;
        Filled { lattice: vec![1; lower.len()], lower, upper, tiling: None }
    }
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

    /// Particles per cell, not allowed with `positions`.
    fn per_cell(&self) -> Result<Option<Vec<usize>>, SceneFault> {
        let path = self.below("particles_per_cell");
        match (&self.body.particles_per_cell, &self.body.positions) {
            (None, Some(_)) => Ok(None),
            (_, None) => {
                let counts = self.body.particles_per_cell(self.cell_size.len());
                check_length(&path, &counts, self.cell_size.len())?;
                Ok(Some(counts))
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

    /// The region's bounds, and its shape unless it is a box.
    fn outline(&self) -> Result<BodyOutline, SceneFault> {
        let dimension = self.cell_size.len();
        if let Region::Box(extent) = self.region {
            let (lower, upper) = (extent.lower.clone(), extent.upper.clone());
            check_length(&self.below("box.lower"), &lower, dimension)?;
            check_length(&self.below("box.upper"), &upper, dimension)?;
            check_box(&self.below("box"), &lower, &upper)?;
            return Ok(BodyOutline { lower, upper, shape: None });
        }
        if dimension == 1 {
            let reason = "a region of the plane, but domain.lower has 1 number, which is the \
                          dimension of the scene; allowed: \"box\"";
            return Err(SceneFault::new(self.below(self.key), true, reason));
        }
        let shape = self.shape()?;
        let [lower, upper] = shape.bounds().map(|corner| corner.to_vec());
        Ok(BodyOutline { lower, upper, shape: Some(shape) })
    }

    fn shape(&self) -> Result<BoundedRegion, SceneFault> {
        BoundedRegion::new(self.region)
            .map_err(|fault| SceneFault::new(self.below(&fault.path), fault.value, fault.reason))
    }

    /// Fills a body with particles.
    fn fill(&self, outline: BodyOutline) -> Result<Filled, SceneFault> {
        let BodyOutline { lower, upper, shape } = outline;
        let per_cell = self.per_cell()?;
        if let (Region::Box(extent), Some(per_cell)) = (self.region, &per_cell) {
            let lattice = lattice(extent, per_cell, self.path, self.cell_size)?;
            return Ok(Filled { lower, upper, lattice, tiling: None });
        }
        let tiling = match self.cell_size {
            [_] => self.tiles_on_line(lower[0], upper[0])?,
            _ => {
                self.tiles_in_plane(shape.map_or_else(|| self.shape(), Ok)?, per_cell.as_deref())?
            }
        };
        let lattice = vec![1; lower.len()];
        Ok(Filled { lower, upper, lattice, tiling: Some(Arc::new(tiling)) })
    }

    /// Particles at given positions on a line.
    fn tiles_on_line(&self, lower: f64, upper: f64) -> Result<Tiling, SceneFault> {
        let points: Vec<f64> = self.points::<1>()?.into_iter().map(|p| p[0]).collect();
        let tiles = voronoi_line(lower, upper, &points).map_err(|f| self.faulty(f))?;
        let tile = |&(centre, length): &(f64, f64)| Tile {
            centre: [centre, 0.0],
            area: length,
            size: [length, 0.0],
        };
        let (origin, cell) = ([self.scene.domain.lower[0], 0.0], [self.cell_size[0], 1.0]);
        Ok(Tiling::of_tiles(tiles.iter().map(tile).collect(), origin, cell))
    }

    /// Particles in a plane, `per_cell` of them or at given positions.
    fn tiles_in_plane(
        &self,
        shape: BoundedRegion,
        per_cell: Option<&[usize]>,
    ) -> Result<Tiling, SceneFault> {
        let origin = [self.scene.domain.lower[0], self.scene.domain.lower[1]];
        let cell = [self.cell_size[0], self.cell_size[1]];
        let Some(per_cell) = per_cell else {
            let tiles = voronoi(&shape, &self.points::<2>()?).map_err(|f| self.faulty(f))?;
            return Ok(Tiling::of_tiles(tiles, origin, cell));
        };
        let counts = [per_cell[0], per_cell[1]];
        fill(shape, origin, cell, counts).map_err(|fault| {
            let reason = format!("{fault}; allowed: fewer particles_per_cell, or larger cells");
            SceneFault::new(self.below("particles_per_cell"), per_cell, reason)
        })
    }
}

/// Bounds of a region.
struct BodyOutline {
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// `None` for a box.
    shape: Option<BoundedRegion>,
}

/// Checks that a body, whose region has the key `key`, lies within the domain.
fn check_inside(
    scene: &Scene,
    path: &str,
    (key, region): (&str, &Region),
    filled: &BodyOutline,
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

/// Maximum number of overlapping bodies that are reported.
const MOST_OVERLAPS: usize = 10;

/// Checks that bodies may touch but do not overlap: in order of x, each is compared with those that
/// begin before it ends.
pub(super) fn check_overlap(
    scene: &Scene,
    checked: &[CheckedBody],
    cell_size: &[f64],
) -> Vec<SceneFault> {
    let mut faults = Vec::new();
    let mut overlapping = vec![false; checked.len()];
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
            if !overlapping[other] && overlap(body, other) {
                let reason = format!(
                    "overlaps {} = {}; allowed: {} that touch at most",
                    path(body),
                    value(body),
                    if scene.domain.lower.len() == 1 { "boxes" } else { "bodies" }
                );
                faults.push(SceneFault::new(path(other), value(other), reason));
                overlapping[other] = true;
                if faults.len() == MOST_OVERLAPS {
                    return faults;
                }
            }
        }
    }
    faults
}
