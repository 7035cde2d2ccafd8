//! The largest time steps that the integrators allow, for one oscillator and for a pile.
//!
//! Velocity Verlet has the bounds of symplectic Euler. Its velocities in the middle of the steps, with the positions, are the states of
//! symplectic Euler (docs/physics section 5.7).

use crate::settings::Integrator;

/// The largest eigenvalue of the contacts of a crowd, in units of one contact's stiffness (or damping). See [`crowd_steps`].
const CROWD: f64 = 4.0;
/// The same for a body between two others.
const BETWEEN: f64 = 2.0;

/// Largest dt² Cc at which a pile comes to rest with RK4. A pile of 300 spheres with overlaps at rest of 5 % of the smallest
/// radius comes to rest at 0.5 with any damping (0.02 to 1 of the critical one). With low damping it shakes from 0.6 on if
/// colliding pairs keep their contact force, and from 1.5 on if not.
const REST_RK4: f64 = 0.5;
/// The same with symplectic Euler, where the bound depends on the damping: dt² Cc <= 1/4 + 2/3 dt Cd. The same pile comes to
/// rest at 0.3 with hardly any damping and at 0.45 with dt Cd = 0.25. It shakes from 0.35 and 0.5 on, respectively.
const REST_EULER: [f64; 2] = [0.25, 2.0 / 3.0];
/// Largest 2 dt Cd at which the pile comes to rest with symplectic Euler. It rests at 0.7 and shakes at 0.9, with any contact
/// force.
const REST_EULER_DAMPING: f64 = 0.75;

/// Largest dt² K at which undamped springs far from their rest length gain no energy with symplectic Euler; with damping, dt² K
/// <= 1 + 2 dt C. Such springs rotate as well as oscillate, which linear theory leaves out. Two to eight spheres with a spring
/// between every two, far from its rest length, gain energy slowly above this bound without damping. With a tenth of the
/// critical damping they gain none even at twice the bound.
const SPRING_EULER: f64 = 1.0;
/// Largest dt² K + 2 dt C with symplectic Euler by linear theory.
const EDGE_EULER: f64 = 4.0;

/// The largest time steps that something allows, in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    /// The largest time step at which bodies come to rest and springs gain no energy.
    pub(super) rest: f64,
    /// The largest time step at which energy stays bounded.
    pub(super) bounded: f64,
}

/// The bounds of a scene with many movers.
///
/// One contact has stiffness Cc m* along its normal n. Linearised about a state, the contacts of equal spheres give
/// x'' = -Cc A x with A = sum over contacts of (1/2) n n' between the two spheres. Row i of A has the diagonal block
/// sum (1/2) n n', of trace 6 with the twelve neighbours that a sphere can have, so 2 in every direction, and off-diagonal
/// blocks of the same sum: by Gershgorin no eigenvalue exceeds 4. (Piles were measured to have 2.8 to 3.35.) The damping
/// acts through the same matrix, so every mode is an oscillator with K = λ Cc and C = λ Cd, λ <= 4. Bodies come to rest
/// where all of these are stable and contacts that open and close within a step add no energy (measured, `REST_RK4`).
///
/// Modes that are unstable alone need not make a pile unstable, because collisions remove their energy. The measured piles gain
/// energy without bound from dt² Cc = 10 (RK4) and 3 (symplectic Euler) on, with any damping. With λ = 2, a body between two
/// others, linear theory gives 4 and 2 at most. These values are used as the bound, unless collisions are `elastic`: then λ = 4
/// is used.
pub(super) fn crowd_steps(force: f64, damping: f64, integrator: Integrator, elastic: bool) -> Steps {
    let linear = |eigenvalue: f64| largest_dt(eigenvalue * force, eigenvalue * damping, integrator);
    let closing = match integrator {
        Integrator::Rk4 => (REST_RK4 / force).sqrt(),
        Integrator::SymplecticEuler | Integrator::VelocityVerlet => {
            let [base, slope] = REST_EULER;
            damped_bound(base, slope, force, damping).min(0.5 * REST_EULER_DAMPING / damping)
        }
    };
    Steps { rest: linear(CROWD).min(closing), bounded: linear(if elastic { CROWD } else { BETWEEN }) }
}

/// The bounds of a scene with few movers. `most` is how many times the stiffness of one contact can add up: 1 for a single
/// pair, 2 for a body between two others. No pile can shake, so everything bounded comes to rest.
pub(super) fn few_steps(most: f64, force: f64, damping: f64, integrator: Integrator) -> Steps {
    let bounded = largest_dt(most * force, most * damping, integrator);
    Steps { rest: bounded, bounded }
}

/// The bounds of a spring of stiffness K and damping C per mass.
pub(super) fn spring_steps(stiffness: f64, damping: f64, integrator: Integrator) -> Steps {
    let bounded = largest_dt(stiffness, damping, integrator);
    let rest = match integrator {
        Integrator::Rk4 => bounded,
        Integrator::SymplecticEuler | Integrator::VelocityVerlet => {
            bounded.min(damped_bound(SPRING_EULER, 2.0, stiffness, damping))
        }
    };
    Steps { rest, bounded }
}

/// The largest dt with dt² K <= base + slope dt C. Damping raises the bound.
fn damped_bound(base: f64, slope: f64, stiffness: f64, damping: f64) -> f64 {
    let half = 0.5 * slope * damping;
    if stiffness > 0.0 { (half + (half * half + base * stiffness).sqrt()) / stiffness } else { f64::INFINITY }
}

/// The largest time step that keeps x'' = -K x - C x' bounded; infinite if nothing limits it.
fn largest_dt(stiffness: f64, damping: f64, integrator: Integrator) -> f64 {
    match integrator {
        Integrator::Rk4 => {
            let sides = (8.0 / stiffness).sqrt().min(2.78 / damping);
            if !sides.is_finite() || rk4_is_stable(stiffness, damping, sides) {
                return sides;
            }
            // The stable region is star-shaped about 0 in the left half plane, so bisection finds its edge.
            let (mut good, mut bad) = (0.0, sides);
            for _ in 0..60 {
                let middle = 0.5 * (good + bad);
                if rk4_is_stable(stiffness, damping, middle) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            good
        }
        // dt² K + 2 dt C = 4, solved without cancellation.
        Integrator::SymplecticEuler | Integrator::VelocityVerlet => {
            EDGE_EULER / (damping + (damping * damping + EDGE_EULER * stiffness).sqrt())
        }
    }
}

/// Whether both modes of x'' = -K x - C x' stay within |R(λ dt)| <= 1, R(z) = 1 + z + z²/2 + z³/6 + z⁴/24.
fn rk4_is_stable(stiffness: f64, damping: f64, dt: f64) -> bool {
    let half = -0.5 * damping * dt;
    let root = half * half - stiffness * dt * dt;
    let growth = |re: f64, im: f64| {
        // Horner's scheme over complex numbers.
        let times = |(a, b): (f64, f64), by: f64| (1.0 + (a * re - b * im) / by, (a * im + b * re) / by);
        let (a, b) = times(times(times(times((1.0, 0.0), 4.0), 3.0), 2.0), 1.0);
        a.hypot(b)
    };
    let largest = if root < 0.0 {
        growth(half, (-root).sqrt())
    } else {
        growth(half - root.sqrt(), 0.0).max(growth(half + root.sqrt(), 0.0))
    };
    // On the imaginary axis the value at the edge is 1 up to rounding.
    largest <= 1.0 + 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |x| after 4,000 steps of the oscillator itself, to compare with the bounds.
    fn amplitude(stiffness: f64, damping: f64, dt: f64, integrator: Integrator) -> f64 {
        let force = |x: f64, v: f64| -stiffness * x - damping * v;
        let (mut x, mut v) = (1.0, 0.3);
        let mut rate = force(x, v);
        for _ in 0..4000 {
            match integrator {
                Integrator::SymplecticEuler => {
                    v += dt * force(x, v);
                    x += dt * v;
                }
                Integrator::VelocityVerlet => {
                    v += 0.5 * dt * rate;
                    x += dt * v;
                    rate = force(x, v);
                    v += 0.5 * dt * rate;
                }
                Integrator::Rk4 => {
                    let slope = |x: f64, v: f64| (v, force(x, v));
                    let k1 = slope(x, v);
                    let k2 = slope(x + 0.5 * dt * k1.0, v + 0.5 * dt * k1.1);
                    let k3 = slope(x + 0.5 * dt * k2.0, v + 0.5 * dt * k2.1);
                    let k4 = slope(x + dt * k3.0, v + dt * k3.1);
                    x += dt / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                    v += dt / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
                }
            }
            if !x.is_finite() {
                return f64::INFINITY;
            }
        }
        x.abs()
    }

    #[test]
    fn the_largest_step_is_bounded_and_at_the_edge_of_stability() {
        // Stiffness, damping, and whether the bound of RK4 is its exact edge: on both axes, and between them near the corner.
        let cases = [
            (1000.0, 0.0, true),
            (0.5, 100.0, true),
            (1000.0, 12.5, false),
            (100.0, 8.0, true),
            (100.0, 10.0, true),
            (100.0, 25.0, false),
        ];
        for (stiffness, damping, rk4_edge) in cases {
            let one_evaluation = [Integrator::SymplecticEuler, Integrator::VelocityVerlet].map(|integrator| (integrator, true));
            for (integrator, edge) in [(Integrator::Rk4, rk4_edge)].into_iter().chain(one_evaluation) {
                let largest = largest_dt(stiffness, damping, integrator);
                let below = amplitude(stiffness, damping, 0.99 * largest, integrator);
                let above = amplitude(stiffness, damping, 1.02 * largest, integrator);
                assert!(
                    below < 10.0 && (above > 10.0 || !edge),
                    "{stiffness} {damping} {integrator}: {below} {above} about {largest}"
                );
            }
        }
    }

    #[test]
    fn the_bounds_are_those_of_the_documentation() {
        assert_eq!(largest_dt(200.0, 0.0, Integrator::Rk4), 0.2);
        assert_eq!(largest_dt(0.0, 100.0, Integrator::Rk4), 0.0278);
        assert_eq!(largest_dt(400.0, 0.0, Integrator::SymplecticEuler), 0.1);
        assert_eq!(largest_dt(0.0, 0.0, Integrator::SymplecticEuler), f64::INFINITY);
    }

    #[test]
    fn an_undamped_spring_has_a_lower_bound_with_symplectic_euler() {
        let euler = |stiffness, damping| spring_steps(stiffness, damping, Integrator::SymplecticEuler);
        assert_eq!(euler(400.0, 0.0), Steps { rest: 0.05, bounded: 0.1 });
        // dt² K = 1 + 2 dt C at 0.1: 2 = 1 + 1.
        assert!((euler(200.0, 5.0).rest - 0.1).abs() < 1e-12);
        let rk4 = spring_steps(200.0, 0.0, Integrator::Rk4);
        assert_eq!(rk4, Steps { rest: 0.2, bounded: 0.2 });
    }

    #[test]
    fn a_crowd_has_the_bounds_of_the_documentation() {
        let rk4 = |force, damping| crowd_steps(force, damping, Integrator::Rk4, false);
        assert_eq!(rk4(1250.0, 0.0), Steps { rest: 0.02, bounded: (4.0_f64 / 1250.0).sqrt() });
        // 4 dt Cd = 2.78 and 2 dt Cd = 2.78.
        let damped = rk4(0.0, 69.5);
        assert!((damped.rest - 0.01).abs() + (damped.bounded - 0.02).abs() < 1e-12);
        assert_eq!(crowd_steps(1250.0, 0.0, Integrator::Rk4, true).bounded, 0.04);
        let euler = |force, damping| crowd_steps(force, damping, Integrator::SymplecticEuler, false);
        assert_eq!(euler(100.0, 0.0), Steps { rest: 0.05, bounded: 0.02_f64.sqrt() });
        // dt² Cc = 1/4 + 2/3 dt Cd at 0.05: 0.35 = 0.25 + 0.1.
        assert!((euler(140.0, 3.0).rest - 0.05).abs() < 1e-12);
        assert_eq!(euler(1.0, 37.5).rest, 0.01);
        assert_eq!(euler(0.0, 0.0), Steps { rest: f64::INFINITY, bounded: f64::INFINITY });
    }
}
