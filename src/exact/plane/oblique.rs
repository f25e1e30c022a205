//! A one-dimensional solution as plane waves at an angle to the grid.
//!
//! With o the point that corresponds to x = 0 of the solution, n the unit normal of the waves, and
//! t = (-n_y, n_x):
//!
//! ```text
//! s = (x - o) . n,   p(x) = p_1D(s),   v(x) = u_1D(s) n,   v . t = 0
//! ```
//!
//! (The equations are invariant under rotation.) The solution holds in the part of a body that no
//! signal from an edge has reached: see [`super::edge`]. In a frame that also moves along the
//! front, add that velocity to v. [`PlaneWave::samples`] projects the particles of a strip onto s,
//! so that [`fn@crate::exact::score`] can compare them with the 1-D profile.

use super::{Vector, cross, difference, dot, length};
use crate::exact::{ExactError, Profile, ProfilePoint, ScoreSample, cell_average, finite};

/// The line along which a 1-D solution is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWave {
    /// Position of the solution's x = 0 [m].
    origin: Vector,
    /// Unit vector in the direction of the solution's x.
    normal: Vector,
}

/// A particle in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanePoint {
    /// Position [m].
    pub x: Vector,
    /// Velocity [m/s].
    pub v: Vector,
    /// Current volume; in the plane an area [m2]. Only ratios matter.
    pub volume: f64,
    /// Pressure [Pa].
    pub p: f64,
    /// Density [kg/m3].
    pub rho: f64,
    /// Specific internal energy [J/kg].
    pub e: f64,
}

impl PlaneWave {
    /// The line through `origin` along `normal`, which need not have unit length.
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite, or if the normal has no length.
    pub fn new(origin: Vector, normal: Vector) -> Result<PlaneWave, ExactError> {
        for value in [origin[0], origin[1], normal[0], normal[1]] {
            finite("a coordinate of the plane wave", value)?;
        }
        let size = length(normal);
        if size > 0.0 {
            Ok(PlaneWave { origin, normal: normal.map(|c| c / size) })
        } else {
            let allowed = "longer than 0";
            Err(ExactError::Number { name: "the normal's length", value: size, allowed })
        }
    }

    /// The line through `origin` at `angle` [rad] from the x axis.
    ///
    /// # Errors
    ///
    /// If a coordinate or the angle is not finite.
    pub fn at_angle(origin: Vector, angle: f64) -> Result<PlaneWave, ExactError> {
        PlaneWave::new(origin, [angle.cos(), angle.sin()])
    }

    /// The unit normal n.
    pub fn normal(&self) -> Vector {
        self.normal
    }

    /// Coordinate s of `x` along the line [m].
    pub fn along(&self, x: Vector) -> f64 {
        dot(difference(x, self.origin), self.normal)
    }

    /// Coordinate of `x` along the fronts [m].
    pub fn across(&self, x: Vector) -> f64 {
        cross(self.normal, difference(x, self.origin))
    }

    /// The position with the coordinates `along` and `across` [m].
    pub fn place(&self, along: f64, across: f64) -> Vector {
        let ([ox, oy], [nx, ny]) = (self.origin, self.normal);
        [ox + along * nx - across * ny, oy + along * ny + across * nx]
    }

    /// Velocity vector [m/s] of a velocity `u` along the line.
    pub fn velocity(&self, u: f64) -> Vector {
        self.normal.map(|n| u * n)
    }

    /// State of the 1-D `profile` at the position `x`, and its velocity vector [m/s]; `None` beyond
    /// the ends of the profile.
    pub fn state(&self, profile: &Profile, x: Vector) -> Option<(ProfilePoint, Vector)> {
        let point = profile.at(self.along(x))?;
        Some((point, self.velocity(point.u)))
    }

    fn strip<'a>(
        &self,
        points: &'a [PlanePoint],
        half_width: f64,
    ) -> impl Iterator<Item = &'a PlanePoint> {
        let line = *self;
        points.iter().filter(move |q| line.across(q.x).abs() < half_width)
    }

    /// The particles at a distance of less than `half_width` [m] from the line, sorted along it;
    /// their `x` is the position s along the line [m].
    pub fn samples(&self, points: &[PlanePoint], half_width: f64) -> Vec<ScoreSample> {
        let sample = |q: &PlanePoint| ScoreSample {
            x: self.along(q.x),
            volume: q.volume,
            p: q.p,
            rho: q.rho,
            e: q.e,
        };
        let mut samples: Vec<ScoreSample> = self.strip(points, half_width).map(sample).collect();
        samples.sort_by(|a, b| a.x.total_cmp(&b.x));
        samples
    }

    /// Volume-weighted means of these particles over bins of `width` [m] along the line, with one
    /// edge at s = 0. Score these: particles of the same s differ by their position within their
    /// cells.
    pub fn binned(&self, points: &[PlanePoint], half_width: f64, width: f64) -> Vec<ScoreSample> {
        cell_average(&self.samples(points, half_width), width, 0.0)
    }

    /// Volume-weighted rms velocity along the fronts over `speed` [-], for example the velocity
    /// behind the shock. It is 0 in the exact solution. `None` without particles.
    pub fn tangential_velocity(
        &self,
        points: &[PlanePoint],
        half_width: f64,
        speed: f64,
    ) -> Option<f64> {
        let (mut sum, mut volume) = (0.0, 0.0);
        for q in self.strip(points, half_width) {
            sum += q.volume * cross(self.normal, q.v).powi(2);
            volume += q.volume;
        }
        (volume > 0.0).then(|| (sum / volume).sqrt() / speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::samples::{ALUMINIUM, COPPER};
    use crate::exact::{Accuracy, Impact, ImpactBody, score};

    const HALF_WIDTH: f64 = 0.1e-3;

    fn close(a: f64, b: f64, by: f64) {
        assert!((a - b).abs() <= by, "{a} {b}");
    }

    fn slanted() -> PlaneWave {
        PlaneWave::at_angle([1e-3, -2e-3], 30f64.to_radians()).unwrap()
    }

    fn solution() -> (Profile, crate::exact::Landmarks) {
        let flyer = ImpactBody { material: COPPER, lower: -0.5e-3, upper: 0.0, velocity: 1000.0 };
        let target = ImpactBody { material: ALUMINIUM, lower: 0.0, upper: 4e-3, velocity: 0.0 };
        let impact = Impact::new(flyer, target).unwrap();
        let solution = impact.solve(&[0.5e-6], &[], Accuracy::default()).unwrap();
        let snapshot = &solution.snapshots[0];
        (snapshot.target.clone().unwrap(), snapshot.landmarks.unwrap())
    }

    /// The exact solution at the points of a square lattice, in any order.
    fn lattice(line: &PlaneWave, profile: &Profile, h: f64) -> Vec<PlanePoint> {
        let mut points = Vec::new();
        for i in -2000..2000 {
            for j in -2000..2000 {
                let x = [f64::from(i) * h, f64::from(j) * h];
                if line.across(x).abs() > 2.0 * HALF_WIDTH {
                    continue;
                }
                if let Some((q, v)) = line.state(profile, x) {
                    points.push(PlanePoint { x, v, volume: h * h, p: q.p, rho: q.rho, e: q.e });
                }
            }
        }
        points
    }

    #[test]
    fn coordinates_go_forth_and_back() {
        let line = slanted();
        let x = line.place(3e-3, -0.7e-3);
        close(line.along(x), 3e-3, 1e-17);
        close(line.across(x), -0.7e-3, 1e-17);
        // by hand: o + 2 n
        let [a, b] = line.place(2.0, 0.0);
        close(a, 1e-3 + 3f64.sqrt(), 1e-12);
        close(b, -2e-3 + 1.0, 1e-12);
        close(length(line.normal()), 1.0, 1e-15);
        assert_eq!(PlaneWave::new([0.0; 2], [0.0, -3.0]).unwrap().velocity(5.0), [0.0, -5.0]);
        assert!(PlaneWave::new([0.0; 2], [0.0; 2]).is_err());
        assert!(PlaneWave::new([f64::NAN, 0.0], [1.0, 0.0]).is_err());
    }

    #[test]
    fn a_slanted_lattice_of_exact_values_scores_as_the_floor() {
        let (profile, marks) = solution();
        let (line, h) = (slanted(), 20e-6);
        let points = lattice(&line, &profile, 0.5 * h);
        let binned = line.binned(&points, HALF_WIDTH, h);
        let raw = score(&line.samples(&points, HALF_WIDTH), &profile, &marks, h);
        let cells = score(&binned, &profile, &marks, h);
        // raw samples lie on the profile, so only the shock between two of them is smeared
        assert!(raw.l1.unwrap() < 1e-3 && raw.noise.unwrap() < 1e-6, "{raw:?}");
        assert!(cells.e1_cells.unwrap() < 0.6 && cells.noise.unwrap() < 1e-6, "{cells:?}");
        close(cells.shock_position_cells.unwrap(), 0.0, 0.6);
        assert!(binned.windows(2).all(|w| w[0].x < w[1].x));
        close(line.tangential_velocity(&points, HALF_WIDTH, 690.0).unwrap(), 0.0, 1e-15);
    }

    #[test]
    fn the_strip_is_cut_and_faults_show() {
        let (profile, marks) = solution();
        let (line, h) = (slanted(), 20e-6);
        let mut points = lattice(&line, &profile, 0.5 * h);
        let all = line.samples(&points, 1.0).len();
        let cut = line.samples(&points, HALF_WIDTH);
        close(cut.len() as f64 / all as f64, 0.5, 0.02);
        assert!(cut.windows(2).all(|w| w[0].x <= w[1].x));
        // a pressure that is 2 % too high, and a velocity along the fronts
        for q in &mut points {
            q.p *= 1.02;
            let [nx, ny] = line.normal();
            q.v = [q.v[0] - 3.0 * ny, q.v[1] + 3.0 * nx];
        }
        let errors = score(&line.binned(&points, HALF_WIDTH, h), &profile, &marks, h);
        close(errors.plateau.unwrap(), 0.02, 1e-5);
        close(line.tangential_velocity(&points, HALF_WIDTH, 300.0).unwrap(), 0.01, 1e-12);
        assert!(line.tangential_velocity(&[], HALF_WIDTH, 300.0).is_none());
    }

    #[test]
    fn the_plane_wave_keeps_mass_and_momentum() {
        // over a parallelogram between two fronts: the integrals of the line times its width
        let (profile, _) = solution();
        let line = slanted();
        let h = 4e-6;
        let points = lattice(&line, &profile, h);
        let in_strip: Vec<_> = line.strip(&points, HALF_WIDTH).collect();
        let total = |f: &dyn Fn(&PlanePoint) -> f64| -> f64 {
            in_strip.iter().map(|q| q.volume * f(q)).sum::<f64>() / (2.0 * HALF_WIDTH)
        };
        let on_line = |f: &dyn Fn(&ProfilePoint) -> f64| -> f64 {
            let pairs = profile.points.windows(2);
            pairs.map(|w| 0.5 * (f(&w[0]) + f(&w[1])) * (w[1].x - w[0].x)).sum()
        };
        let mass = on_line(&|q| q.rho);
        close(total(&|q| q.rho) / mass, 1.0, 3e-3);
        let momentum = on_line(&|q| q.rho * q.u);
        for (k, n) in line.normal().into_iter().enumerate() {
            close(total(&|q| q.rho * q.v[k]) / (n * momentum), 1.0, 3e-3);
        }
    }
}
