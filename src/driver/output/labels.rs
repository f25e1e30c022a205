//! Labels of the brief report, each with the entry of `docs/glossary.md` that explains it.

macro_rules! labels {
    ($($(#[$doc:meta])* $name:ident: $text:literal, explained by $entry:literal;)*) => {
        $($(#[$doc])* pub const $name: &str = $text;)*

        /// Each label and the term of the glossary that explains it.
        pub const LABELS: &[(&str, &str)] = &[$(($text, $entry)),*];
    };
}

labels! {
    /// Pressure behind the first shock in the target [Pa].
    PRESSURE: "pressure behind shock", explained by "P2";
    /// Velocity of the material behind the first shock, with the target at rest [m/s].
    PARTICLE_VELOCITY: "particle velocity", explained by "Us, up";
    /// The same if the target moves at the start [m/s].
    RELATIVE_VELOCITY: "velocity relative to target", explained by "Us, up";
    /// Distance that the shock has travelled over its time [m/s].
    SHOCK_SPEED: "mean shock speed", explained by "Us, up";
    /// Velocity of the rear of the target [m/s].
    FREE_SURFACE: "free-surface velocity", explained by "free surface";
    /// Largest pressure of the last profile [Pa].
    LARGEST_PRESSURE: "largest pressure", explained by "profile";
    /// Largest negative pressure of the last profile [Pa].
    LARGEST_TENSION: "largest tension", explained by "tension";
    /// Largest speed of the last profile [m/s].
    LARGEST_SPEED: "largest speed", explained by "profile";
    /// Mean density behind the shock of Noh's problem [kg/m3].
    DENSITY: "density behind shock", explained by "wall heating";
    /// Length of a body along its impact on a wall [m].
    LENGTH: "length at the last profile", explained by "Taylor bar";
    /// Largest diameter of a body of revolution [m].
    DIAMETER: "largest diameter", explained by "Taylor bar";
    /// Error `l1`.
    MEAN_PRESSURE_ERROR: "mean pressure error", explained by "L1, mean pressure error";
    /// Error `rise_cells`.
    SHOCK_WIDTH: "shock width", explained by "rise, shock width";
    /// Error `overshoot`.
    OVERSHOOT: "overshoot", explained by "overshoot";
    /// Error `density_l1`.
    MEAN_DENSITY_ERROR: "mean density error", explained by "L1, mean pressure error";
    /// Error `mean_density_error`.
    SHOCK_DENSITY_ERROR: "density error behind the shock", explained by "wall heating";
    /// Error `displacement_l2`.
    DISPLACEMENT_ERROR: "displacement error", explained by "L2";
    /// Error `angular_momentum_loss`.
    LOST_ANGULAR_MOMENTUM: "lost angular momentum", explained by "lost angular momentum";
    /// Error `velocity_rms`.
    VELOCITY_ERROR: "velocity error", explained by "velocity error, pressure error";
    /// Error `pressure_rms`.
    PRESSURE_ERROR: "pressure error", explained by "velocity error, pressure error";
    /// Line of the errors of the last profile.
    ERRORS: "errors", explained by "profile";
    /// Line of the drifts of energy and momentum.
    CONSERVATION: "conservation", explained by "drift";
    /// Line of the numbers of particles that have failed, were removed, or have left the domain.
    PARTICLES: "particles", explained by "damage, failed particle";
    /// Line of the estimated errors.
    ESTIMATE: "estimate", explained by "error estimate";
    /// Line of the predicted and actual values of a plan.
    PLAN: "plan", explained by "plan";
    /// Line of the size and the time of the run.
    RUN: "run", explained by "rank";
    /// Line of the folder of the results.
    RESULTS: "results", explained by "results";
}

#[cfg(test)]
mod tests {
    use super::LABELS;

    #[test]
    fn the_glossary_explains_every_label() {
        let glossary = include_str!("../../../docs/glossary.md");
        let entries =
            glossary.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
        let entries: Vec<&str> = entries.collect();
        assert!(entries.len() > 60, "{entries:?}");
        for (label, entry) in LABELS {
            assert!(entries.contains(entry), "{label}: the glossary has no {entry}");
        }
    }
}
