//! Shocks in gases: Noh's problem, and Sod's tube at an angle to the grid.

use flyer_mpm::driver::output::csv::CsvTable;

use super::waves::last;
use crate::bounds::{Unit, plane as bounds};
use crate::runs::{Job, Outcome};
use crate::table::Table;

/// Noh's problem towards a wall, and towards an axis on two kinds of grids.
pub fn noh(table: &mut Table) {
    use bounds::noh;
    for (scene, cells, [bound, near], exact) in [
        ("noh_planar", [100, 200], [noh::PLANAR_DENSITY, noh::PLANAR_LEAST], 4.0),
        ("noh_cylindrical", [50, 100], [noh::CYLINDRICAL_DENSITY, noh::CYLINDRICAL_LEAST], 16.0),
        ("noh_axis", [50, 100], [noh::AXIS_DENSITY, noh::AXIS_LEAST], 16.0),
    ] {
        let runs = cells.map(|cells| {
            let job = Job::new(scene).set(format!("domain.cell_size={}", 1.0 / f64::from(cells)));
            table.take(&format!("{scene}.json"), job.run())
        });
        let [Some(coarse), Some(fine)] = &runs else { continue };
        let of = |run: &Outcome, name: &str| last(run, |p| p.error(name));
        let mean = format!("{scene}.json: mean density against {exact}");
        let [coarse_error, error] = [coarse, fine].map(|run| of(run, "mean_density_error"));
        table.check(&mean, error, bound);
        let figure = format!("{scene}.json: the same at {} cells a unit", cells[0]);
        table.beside(&figure, coarse_error, "", Unit::Fraction);
        let [coarse_l1, l1] = [coarse, fine].map(|run| of(run, "density_l1"));
        table.beside(&format!("{scene}.json: L1 of density"), l1, "", Unit::Fraction);
        let falls = coarse_l1.zip(l1).map(|(coarse, fine)| coarse / fine);
        let figure = format!("{scene}.json: L1 at half the cells over it");
        table.check(&figure, falls, noh::L1_COARSE_OVER_FINE);
        let least = least_density(fine).map(|least| least / exact);
        let figure = format!("{scene}.json: least density behind, of the exact");
        table.check(&figure, least, near);
        let drift = fine.summary.energy.drift;
        table.check(&format!("{scene}.json: energy drift"), drift, noh::ENERGY_DRIFT);
    }
}

/// The least density [kg/m3] nearer than 0.05 m to where the gas meets: it is heated there as the
/// shock is born, and the same pressure then needs less of it.
fn least_density(run: &Outcome) -> Option<f64> {
    let tables = run.tables().ok()?;
    let last: &CsvTable = tables.last()?;
    let (x, rho) = (last.numbers("x")?, last.numbers("density")?);
    let axial = run.summary.scene["domain"]["geometry"] == "axisymmetric";
    let y = last.numbers("y").filter(|_| !axial);
    let distance = |k: usize| x[k].hypot(y.as_ref().map_or(0.0, |y| y[k]));
    let near = (0..x.len()).filter(|&k| distance(k) < 0.05).map(|k| rho[k]);
    near.min_by(f64::total_cmp)
}

/// Sod's tube along the grid, at 30 and at 45 degrees to it.
pub fn sod(table: &mut Table) {
    let mut along = None;
    for angle in [0.0f64, 30.0, 45.0] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let run = Job::new("sod_2d")
            .set(format!("bodies.left.intersection[1].half_plane.normal=[{cos}, {sin}]"))
            .set(format!("bodies.right.intersection[1].half_plane.normal=[{}, {}]", -cos, -sin))
            .set(format!("reference.riemann.front.angle={angle}"))
            .run();
        let name = format!("sod_2d.json at {angle} degrees");
        let Some(run) = table.take(&name, run) else { continue };
        let l1 = last(&run, |p| p.error("density_l1"));
        table.beside(&format!("{name}: L1 norm of density"), l1, "", Unit::One);
        along = along.or(l1);
        let ratio = l1.zip(along).map(|(l1, along)| l1 / along);
        if angle != 0.0 {
            table.check(
                &format!("{name}: over that at 0"),
                ratio,
                bounds::sod::L1_OVER_THAT_ALONG_GRID,
            );
        }
        let drift = run.summary.energy.drift;
        table.check(&format!("{name}: energy drift"), drift, bounds::sod::ENERGY_DRIFT);
    }
}
