//! Equations of state of particles that may have failed and then carry no tension.

use crate::material::constitutive::FluidModel;

/// Ranges of particles that have failed, or have not.
fn runs(damage: &[f64]) -> impl Iterator<Item = (bool, std::ops::Range<usize>)> + '_ {
    let mut at = 0;
    std::iter::from_fn(move || {
        let failed = *damage.get(at)? >= 1.0;
        let start = at;
        at += damage[at..].iter().take_while(|&&d| (d >= 1.0) == failed).count();
        Some((failed, start..at))
    })
}

/// Pressure and sound speed of particles that may have failed. A failed particle in tension is
/// debris: it has no pressure, and its equation of state reports no fault.
pub(super) fn refresh(
    (model, damage): (&dyn FluidModel, &[f64]),
    (jacobian, energy): (&[f64], &[f64]),
    mut history: Option<&mut [f64]>,
    (pressure, speed): (&mut [f64], &mut [f64]),
) -> Option<(usize, String)> {
    let mut found = None;
    for (failed, particles) in runs(damage) {
        if !failed {
            let (p, c) = (&mut pressure[particles.clone()], &mut speed[particles.clone()]);
            let history = history.as_mut().map(|h| &mut h[particles.clone()]);
            let (j, e) = (&jacobian[particles.clone()], &energy[particles.clone()]);
            let told = model.refresh(j, e, history, p, c);
            if let (None, Some((particle, what))) = (&found, told) {
                found = Some((particles.start + particle, what));
            }
            continue;
        }
        for r in particles {
            let (p, c) = (&mut pressure[r..=r], &mut speed[r..=r]);
            let history = history.as_mut().map(|h| &mut h[r..=r]);
            let told = model.refresh(&jacobian[r..=r], &energy[r..=r], history, p, c);
            let apart = p[0] < 0.0 && jacobian[r] > 0.0 && energy[r].is_finite();
            if p[0] < 0.0 {
                p[0] = 0.0;
            }
            if apart && (c[0].is_nan() || c[0] == 0.0) {
                c[0] = model.sound_speed_at(0.0);
            }
            if let (None, Some((_, what)), false) = (&found, told, apart) {
                found = Some((r, what));
            }
        }
    }
    found
}
