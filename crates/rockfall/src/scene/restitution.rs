//! The damping that gives a coefficient of restitution (docs/physics section 4.11).

/// Elastic force and stiffness at an overlap, in units in which a law has no constants.
type Elastic = fn(f64) -> (f64, f64);

/// Smallest restitution that the laws produce. A smaller one would need a dashpot so strong that the time step resolves it badly.
const LEAST: f64 = 0.01;
/// Upper bound of the damping that is searched. It gives less than [`LEAST`].
const MOST_DAMPING: f64 = 40.0;

/// Returns the damping g of the law, for which an impact of two bodies rebounds with `restitution`.
///
/// The dashpot is c = g sqrt(S m*), with the normal stiffness S at the present overlap. In units of the impact's own length and
/// time, the motion depends on g alone. So the impact is integrated once per trial, with the force clipped at 0, and g is found
/// by bisection. The known formulas for g leave the clip out.
pub(crate) fn damping_for(elastic: Elastic, restitution: f32) -> f32 {
    let wanted = f64::from(restitution).max(LEAST);
    if wanted >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MOST_DAMPING);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if rebound(elastic, middle) > wanted { low = middle } else { high = middle }
    }
    (0.5 * (low + high)) as f32
}

/// Speed of rebound of an impact at speed 1.
fn rebound(elastic: Elastic, damping: f64) -> f64 {
    /// Time step, in units in which an undamped impact takes about 3.
    const STEP: f64 = 2e-3;
    let force = |overlap: f64, speed: f64| {
        let (elastic, stiffness) = elastic(overlap);
        elastic + damping * stiffness.sqrt() * speed
    };
    let (mut overlap, mut speed): (f64, f64) = (0.0, 1.0);
    // Strong damping makes the equation stiff near the start.
    let step = STEP / (1.0 + damping);
    loop {
        let rate = |x: f64, v: f64| (v, -force(x, v));
        let (x1, v1) = rate(overlap, speed);
        let (x2, v2) = rate(overlap + 0.5 * step * x1, speed + 0.5 * step * v1);
        let (x3, v3) = rate(overlap + 0.5 * step * x2, speed + 0.5 * step * v2);
        let (x4, v4) = rate(overlap + step * x3, speed + step * v3);
        let next =
            (overlap + step / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4), speed + step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4));
        if next.1 < 0.0 && force(next.0, next.1) <= 0.0 {
            // The clipped force stays 0 from the time at which it reaches 0.
            let (before, after) = (force(overlap, speed), force(next.0, next.1));
            let part = if before > after { before / (before - after) } else { 1.0 };
            return -(speed + part.clamp(0.0, 1.0) * (next.1 - speed));
        }
        (overlap, speed) = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ContactLaw;

    /// Schwager and Poeschel, Granular Matter 9 (2007) 465: the linear law with the force clipped at 0. With z = g / 2 and
    /// w = sqrt(1 - z^2), e = exp(-z/w (pi - atan2(2 z w, 2 z^2 - 1))).
    #[test]
    fn the_linear_rebound_is_that_of_the_closed_form() {
        for damping in [0.05, 0.3, 0.8, 1.2] {
            let z = 0.5 * damping;
            let w = (1.0_f64 - z * z).sqrt();
            let angle = (2.0 * z * w).atan2(2.0 * z * z - 1.0);
            let expected = (-z / w * angle).exp();
            let found = rebound(|overlap| (overlap, 1.0), damping);
            assert!((found - expected).abs() < 1e-4, "{damping}: {found}, {expected}");
        }
    }

    #[test]
    fn the_damping_gives_the_restitution() {
        let laws = ContactLaw::ALL.into_iter().filter_map(|law| Some((law, law.grain()?.unit_impact()?)));
        for (law, elastic) in laws {
            assert_eq!(damping_for(elastic, 1.0), 0.0);
            let mut before = f32::INFINITY;
            for e in [0.02, 0.1, 0.3, 0.5, 0.9, 0.99] {
                let damping = damping_for(elastic, e);
                assert!(damping < before, "less damping for more restitution");
                before = damping;
                let found = rebound(elastic, damping.into());
                assert!((found - f64::from(e)).abs() < 1e-4, "{law}: {found} in place of {e}");
            }
        }
    }
}
