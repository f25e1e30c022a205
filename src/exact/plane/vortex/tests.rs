use super::*;

/// Derivative of `f` at 0 by the central difference of sixth order.
fn derivative<const N: usize>(h: f64, f: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let mut out = [0.0; N];
    for (k, w) in [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)] {
        let (up, down) = (f(k * h), f(-k * h));
        for n in 0..N {
            out[n] += w * (up[n] - down[n]) / (60.0 * h);
        }
    }
    out
}

fn flat(f: Tensor) -> [f64; 4] {
    [f[0][0], f[0][1], f[1][0], f[1][1]]
}

/// F by finite differences of the position.
fn numerical_gradient(v: &Vortex, [x, y]: Vector, t: f64) -> Tensor {
    let by_x = derivative(1e-3, |d| v.position([x + d, y], t));
    let by_y = derivative(1e-3, |d| v.position([x, y + d], t));
    [[by_x[0], by_y[0]], [by_x[1], by_y[1]]]
}

/// First Piola-Kirchhoff stress J sigma F^-T.
fn piola(v: &Vortex, f: Tensor) -> Tensor {
    let s = v.cauchy_stress(f);
    // J F^-T
    let cofactor = [[f[1][1], -f[1][0]], [-f[0][1], f[0][0]]];
    let entry = |a: usize, b: usize| s[a][0] * cofactor[0][b] + s[a][1] * cofactor[1][b];
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// Points of the ring, far enough from the rims that the differences stay inside the ring.
fn inside(v: &Vortex) -> Vec<Vector> {
    let width = v.outer - v.inner;
    (0..40)
        .map(|k| {
            let radius = v.inner + width * (0.05 + 0.9 * (0.37 * k as f64).fract());
            turn([radius, 0.0], 2.4 * k as f64)
        })
        .collect()
}

fn close(a: f64, b: f64, by: f64) {
    assert!((a - b).abs() <= by, "{a} {b}");
}

#[test]
fn has_the_papers_angle() {
    let v = Vortex::default();
    v.check().unwrap();
    for radius in [0.75f64, 0.8, 0.9, 1.0, 1.1, 1.25] {
        let s = radius - 1.0;
        let want = (0.3 * PI).sin() * (1.0 - 32.0 * s * s + 256.0 * s.powi(4));
        close(v.rotation(radius, 0.3), want, 1e-14);
    }
    // A = 1 shears by about 6 at half period: 64 s - 1024 s^3 at s^2 = 1/48, times R for k
    let slope = |k: i32| v.angle(0.75 + 1e-4 * f64::from(k), 0.5).slope.abs();
    let greatest = (0..5000).map(slope).fold(0.0, f64::max);
    close(greatest, 64.0 * 2.0 / 3.0 / 48f64.sqrt(), 1e-5);
}

#[test]
fn gradient_velocity_and_acceleration_are_derivatives_of_the_position() {
    for v in
        [Vortex::default(), Vortex { inner: 0.4, outer: 1.5, period: 0.7, ..Vortex::default() }]
    {
        for x in inside(&v) {
            for t in [0.05, 0.15, 0.5, 0.8] {
                let f = v.deformation_gradient(x, t);
                close(f[0][0] * f[1][1] - f[0][1] * f[1][0], 1.0, 1e-13);
                for (a, b) in flat(f).iter().zip(flat(numerical_gradient(&v, x, t))) {
                    close(*a, b, 1e-8);
                }
                let u = derivative(1e-3, |d| v.position(x, t + d));
                let a = derivative(1e-3, |d| v.velocity(x, t + d));
                for n in 0..2 {
                    close(v.velocity(x, t)[n], u[n], 1e-10);
                    close(v.acceleration(x, t)[n], a[n], 1e-9);
                }
            }
        }
    }
}

#[test]
fn body_force_balances_momentum() {
    // rho0 u_tt = Div P + rho0 b, with all terms except b from differences of the position alone;
    // with these constants inertia and stress are about equally large
    let base = Vortex::default();
    let stiff = Vortex { youngs_modulus: 4e4, poissons_ratio: 0.2, amplitude: 0.4, ..base };
    for v in [base, stiff] {
        let (mut fault, mut scale) = (0.0f64, 0.0f64);
        for [x, y] in inside(&v) {
            for t in [0.05, 0.15, 0.4, 0.9] {
                let p = |x: f64, y: f64| flat(piola(&v, numerical_gradient(&v, [x, y], t)));
                let by_x = derivative(2e-3, |d| p(x + d, y));
                let by_y = derivative(2e-3, |d| p(x, y + d));
                let divergence = [by_x[0] + by_y[1], by_x[2] + by_y[3]];
                let rate = |t: f64| derivative(5e-3, |d| v.position([x, y], t + d));
                let a = derivative(5e-3, |d| rate(t + d));
                let b = v.body_force([x, y], t);
                for n in 0..2 {
                    let terms = [v.density * a[n], -divergence[n], -v.density * b[n]];
                    fault = fault.max(terms.iter().sum::<f64>().abs());
                    scale = terms.iter().fold(scale, |s, term| s.max(term.abs()));
                }
            }
        }
        assert!(fault < 1e-6 * scale, "{fault} of {scale}");
    }
}

#[test]
fn rims_are_free_and_fixed() {
    let v = Vortex::default();
    for (radius, sign) in [(v.inner, -1.0), (v.outer, 1.0)] {
        for k in 0..8 {
            let n = turn([sign, 0.0], 0.8 * k as f64);
            let x = n.map(|c| sign * c * radius * (1.0 - sign * 1e-15));
            let s = v.cauchy_stress(v.deformation_gradient(x, 0.5));
            for row in s {
                close(row[0] * n[0] + row[1] * n[1], 0.0, 1e-8);
            }
            close(v.position(x, 0.5)[0], x[0], 1e-13);
        }
    }
}

#[test]
fn a_point_off_the_ring_rests() {
    let v = Vortex::default();
    for x in [[0.5, 0.0], [0.0, 1.2500001], [0.0, 0.0]] {
        assert_eq!(v.position(x, 0.5), x);
        assert_eq!(v.deformation_gradient(x, 0.5), [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(v.body_force(x, 0.5), [0.0, 0.0]);
    }
}

#[test]
fn error_of_a_known_fault() {
    // every displacement is 2 % too large
    let v = Vortex::default();
    let off = |x: Vector| {
        let exact = v.position(x, 0.15);
        let position = [0, 1].map(|n| x[n] + 1.02 * (exact[n] - x[n]));
        Displaced { reference: x, position, volume: 1.0 + x[0] * x[0] }
    };
    let points: Vec<_> = inside(&v).into_iter().map(off).collect();
    close(v.l2_error(&points, 0.15).unwrap(), 0.02, 1e-14);
    assert!(v.l2_error(&points, 0.0).is_none() && v.l2_error(&[], 0.15).is_none());
}

#[test]
fn refuses_what_makes_no_ring() {
    let v = Vortex::default();
    for bad in [
        Vortex { outer: 0.7, ..v },
        Vortex { poissons_ratio: 0.5, ..v },
        Vortex { period: 0.0, ..v },
        Vortex { amplitude: f64::NAN, ..v },
    ] {
        assert!(bad.check().is_err(), "{bad:?}");
    }
}
