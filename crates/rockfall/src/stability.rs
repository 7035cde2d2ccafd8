//! Which time step the springs and the contact force of a scene bear.
//!
//! A spring of stiffness k and damping c between spheres of inverse masses wA and wB moves along its axis like an oscillator
//! x'' = -K x - C x' with K = wA k + wB k, C = wA c + wB c. With several springs on a sphere the sums of their k and c
//! bound it (Gershgorin's rows). The integrators keep such an oscillator bounded where
//!
//! - RK4: dt² K <= 8 (|R| <= 1 on the imaginary axis), dt C <= 2.78 (on the negative real axis), and |R(z)| <= 1 for both
//!   roots z = λ dt of z² + dt C z + dt² K = 0, which is stricter than the first two together near the corner where both
//!   are all but used up;
//! - symplectic Euler: dt² K + 2 dt C <= 4 (Jury's criterion for λ² - (2 - dt C - dt² K) λ + 1 - dt C).
//!
//! A contact has stiffness Cc m* and damping Cd m* with m* = 1/(wA + wB), so K = Cc and C = Cd whatever the masses.
//! That is for one contact, the bound below which nothing helps. Several contacts of one body add up where they point the same
//! way: two opposite ones (a ball in a tight slot) make 2 Cc, the stiffest wave in a dense packing of equal
//! spheres (each has twelve) 4 Cc. So half the step that a single contact bears is safe for piles.
//!
//! Fixed-length rods only add mass to a sphere, and outside forces do not matter.

use std::fmt;

use crate::scene::{Scene, Sphere};
use crate::settings::Integrator;

/// What does not bear the time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stiff {
    /// The spring with this index, in order of addition.
    Spring(usize),
    /// The tether with this index, in order of addition.
    Tether(usize),
    /// The contact force, with `contact_force` and `contact_damping`.
    Contact,
}

/// A time step that is too long for something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// What is too stiff or too strongly damped.
    pub what: Stiff,
    /// Stiffness per mass K, in 1/s².
    pub stiffness: f64,
    /// Damping per mass C, in 1/s.
    pub damping: f64,
    /// The largest time step that it bears, in seconds.
    pub largest_dt: f64,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            Stiff::Spring(index) => write!(f, "spring {index}, with all others at its ends,")?,
            Stiff::Tether(index) => write!(f, "tether {index}, with all others at its sphere,")?,
            Stiff::Contact => write!(f, "the contact force")?,
        }
        let [k, c] = [self.stiffness, self.damping].map(rounded_down);
        let largest = rounded_down(self.largest_dt);
        write!(
            f,
            " is too stiff for the time step (stiffness per mass {k} /s², damping per mass {c} /s): the largest that would do is {largest} s"
        )
    }
}

/// Three significant digits, never more than the number itself.
fn rounded_down(number: f64) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    let digits = 2 - number.abs().log10().floor() as i32;
    // Scaled by a power of ten that is itself exact, so that 0.02 stays 0.02.
    let scale = 10_f64.powi(digits.abs());
    // A hair up before rounding down, for what is such a number already.
    let floor = |scaled: f64| (scaled * (1.0 + 1e-12)).floor();
    if digits >= 0 { floor(number * scale) / scale } else { floor(number / scale) * scale }
}

impl Scene {
    /// What a time step of `dt` seconds is too long for: springs, tethers, then the contact force.
    pub fn stability(&self, dt: f32, integrator: Integrator) -> Vec<Warning> {
        let loads = Loads::of(self);
        let dt = f64::from(dt);
        let warn = |what, [stiffness, damping]: [f64; 2]| {
            let largest_dt = largest_dt(stiffness, damping, integrator);
            (dt > largest_dt).then_some(Warning { what, stiffness, damping, largest_dt })
        };
        let springs = self.springs().iter().enumerate().filter_map(|(index, spring)| {
            let [a, b] = [spring.a, spring.b].map(|id| loads.on(self, id));
            warn(Stiff::Spring(index), [a[0] + b[0], a[1] + b[1]])
        });
        let tethers = self.tethers().iter().enumerate();
        let tethers = tethers.filter_map(|(index, tether)| warn(Stiff::Tether(index), loads.on(self, tether.sphere)));
        let mut warnings: Vec<Warning> = springs.chain(tethers).collect();
        if self.can_touch() {
            let contact = [self.settings.contact_force, self.settings.contact_damping].map(f64::from);
            warnings.extend(warn(Stiff::Contact, contact));
        }
        warnings
    }

    /// Whether there is anything to touch for something that moves.
    fn can_touch(&self) -> bool {
        let others = self.spheres().len() + self.boxes().len() + self.polygons().len();
        others > 1 && self.spheres().iter().any(|sphere| !sphere.fixed)
    }
}

/// For each sphere, the sums of k and c over its springs and tethers.
struct Loads(Vec<[f64; 2]>);

impl Loads {
    fn of(scene: &Scene) -> Self {
        let mut sums = vec![[0.0; 2]; scene.spheres().len()];
        let mut add = |id, stiffness: f32, damping: f32| {
            // Every end is in the scene: with a sphere go its springs.
            if let Ok(index) = scene.spheres.index(id) {
                let sum: &mut [f64; 2] = &mut sums[index];
                sum[0] += f64::from(stiffness);
                sum[1] += f64::from(damping);
            }
        };
        for spring in scene.springs() {
            add(spring.a, spring.stiffness, spring.damping);
            add(spring.b, spring.stiffness, spring.damping);
        }
        for tether in scene.tethers() {
            add(tether.sphere, tether.stiffness, tether.damping);
        }
        Self(sums)
    }

    /// A sphere's sums of k and c times its inverse mass.
    fn on(&self, scene: &Scene, id: crate::SphereId) -> [f64; 2] {
        let inverse_mass = |sphere: &Sphere| if sphere.fixed { 0.0 } else { 1.0 / f64::from(sphere.mass) };
        let index = scene.spheres.index(id);
        index.map_or([0.0; 2], |index| self.0[index].map(|sum| sum * inverse_mass(&scene.spheres()[index])))
    }
}

/// The largest step that keeps x'' = -K x - C x' bounded; infinite when nothing limits it.
fn largest_dt(stiffness: f64, damping: f64, integrator: Integrator) -> f64 {
    match integrator {
        Integrator::Rk4 => {
            let sides = (8.0 / stiffness).sqrt().min(2.78 / damping);
            if !sides.is_finite() || rk4_is_stable(stiffness, damping, sides) {
                return sides;
            }
            // The stable region is star-shaped about 0 in the left half plane: halve down to its edge.
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
        Integrator::SymplecticEuler => 4.0 / (damping + (damping * damping + 4.0 * stiffness).sqrt()),
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
    // On the imaginary axis the edge itself is 1 up to rounding.
    largest <= 1.0 + 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Spring, Tether};

    /// Largest |x| after many steps of the oscillator itself, to hold the bounds against.
    fn amplitude(stiffness: f64, damping: f64, dt: f64, integrator: Integrator) -> f64 {
        let force = |x: f64, v: f64| -stiffness * x - damping * v;
        let (mut x, mut v) = (1.0, 0.3);
        for _ in 0..4000 {
            match integrator {
                Integrator::SymplecticEuler => {
                    v += dt * force(x, v);
                    x += dt * v;
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
    fn the_largest_step_is_bounded_and_at_the_edge_where_it_claims_to_be() {
        // Stiffness, damping, and whether RK4's bound is its edge: on both axes, and between them near the corner.
        let cases = [
            (1000.0, 0.0, true),
            (0.5, 100.0, true),
            (1000.0, 12.5, false),
            (100.0, 8.0, true),
            (100.0, 10.0, true),
            (100.0, 25.0, false),
        ];
        for (stiffness, damping, rk4_edge) in cases {
            for (integrator, edge) in [(Integrator::Rk4, rk4_edge), (Integrator::SymplecticEuler, true)] {
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
    fn sums_run_over_all_springs_of_a_sphere_and_fixed_ones_do_not_count() {
        let mut scene = Scene::new();
        let fixed = scene.add_sphere(Sphere::new([0.0; 3], 0.1).fixed()).unwrap();
        let ball = scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).mass(0.5)).unwrap();
        scene.add_spring(Spring::new(fixed, ball, 4000.0, 1.0)).unwrap();
        scene.add_tether(Tether::new(ball, [2.0, 0.0, 0.0], 1000.0).damping(1.0)).unwrap();
        // K = (4000 + 1000) / 0.5: the edge is sqrt(8 / 10000) = 0.0283.
        assert!(scene.stability(0.028, Integrator::Rk4).is_empty());
        let warnings = scene.stability(0.029, Integrator::Rk4);
        let whats: Vec<Stiff> = warnings.iter().map(|warning| warning.what).collect();
        assert_eq!(whats, [Stiff::Spring(0), Stiff::Tether(0)]);
        assert_eq!((warnings[0].stiffness, warnings[0].damping), (10000.0, 2.0));
        assert!((warnings[0].largest_dt - 0.0008_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn the_contact_force_has_its_own_bound() {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
        scene.settings.contact_force = 30000.0;
        assert!(scene.stability(0.02, Integrator::Rk4).is_empty(), "nothing to touch");
        scene.add_sphere(Sphere::new([1.0; 3], 0.1)).unwrap();
        let warnings = scene.stability(0.02, Integrator::Rk4);
        assert_eq!(warnings.len(), 1);
        assert_eq!(warnings[0].what, Stiff::Contact);
        let text = warnings[0].to_string();
        assert!(text.contains("the largest that would do is 0.0163 s"), "{text}");
        scene.settings.contact_force = 19000.0;
        assert!(scene.stability(0.02, Integrator::Rk4).is_empty());
        assert_eq!(scene.stability(0.02, Integrator::SymplecticEuler).len(), 1);
        scene.settings.contact_damping = 140.0;
        assert_eq!(scene.stability(0.02, Integrator::Rk4).len(), 1);
    }

    #[test]
    fn printed_numbers_are_never_rounded_up() {
        let rounded = [0.02, 0.0282843, 0.01999, 1.0, 12345.0, 0.0].map(rounded_down);
        assert_eq!(rounded, [0.02, 0.0282, 0.0199, 1.0, 12300.0, 0.0]);
    }
}
