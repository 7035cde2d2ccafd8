//! Checks the time step of a scene: which time step its springs and contact force allow, and for what else a time step is too
//! long.
//!
//! A spring of stiffness k and damping c between spheres of inverse masses wA and wB moves along its axis like an oscillator
//! x'' = -K x - C x' with K = wA k + wB k, C = wA c + wB c. With several springs on a sphere, the sums of their k and c give an
//! upper bound (Gershgorin's rows). The integrators keep such an oscillator bounded under these conditions:
//!
//! - RK4: dt² K <= 8 (|R| <= 1 on the imaginary axis), dt C <= 2.78 (on the negative real axis), and |R(z)| <= 1 for both roots
//!   z = λ dt of z² + dt C z + dt² K = 0. The last condition is stricter than the first two together near the corner where both
//!   are almost reached;
//! - symplectic Euler: dt² K + 2 dt C <= 4 (Jury's criterion for λ² - (2 - dt C - dt² K) λ + 1 - dt C).
//!
//! Springs that are far from their rest length rotate as well as oscillate. With symplectic Euler they gain energy slowly if
//! dt² K exceeds 1 + 2 dt C.
//!
//! A contact has stiffness Cc m* and damping Cd m* with m* = 1/(wA + wB), so K = Cc and C = Cd for all masses. Several contacts
//! of one body add up if they point the same way: to 2 Cc for a body between two others, and to 4 Cc at most in a crowd of
//! equal spheres.
//!
//! A crowd has two bounds. Above the larger one it is unstable: its energy grows without bound. Between the two it is restless:
//! the energy stays bounded, but the bodies of a pile shake and never come to rest, because contacts that open and close within
//! a step add energy. `stability/bounds.rs` has the bounds and their derivation.
//!
//! | | comes to rest if | unstable if |
//! |---|---|---|
//! | RK4 | dt² Cc <= 0.5, and 4 Cc and 4 Cd are stable (dt Cd <= 0.69) | 2 Cc and 2 Cd are not stable: dt² Cc > 4 or less |
//! | symplectic Euler | dt² Cc <= 1/4 + 2/3 dt Cd, dt² Cc + 2 dt Cd <= 1, 2 dt Cd <= 3/4 | dt² Cc + 2 dt Cd > 2 |
//!
//! The second column has a safety margin: the measured piles became unstable at time steps up to twice as long.
//!
//! Fixed-length rods only add mass to a sphere. External forces have no effect on stability.

use crate::report::short_number;
use crate::scene::{Scene, Sphere};
use crate::settings::{Integrator, Settings};

mod behind;
mod bounds;
mod chains;
mod connected;
mod depth;
mod falling;
mod idle;
mod impact;
mod inlets;
mod intent;
mod laws;
mod muscles;
mod necks;
mod resolution;
mod rods;
mod servos;
mod softness;
mod speed;

use bounds::{Steps, crowd_steps, few_steps, spring_steps};
use chains::chain_steps;
pub use depth::{Remedy, Sinking};
pub use impact::DeepImpact;
pub use laws::LawTime;
pub use muscles::FastMuscle;
pub use resolution::{ChosenPrecision, Coarse, PrecisionReason};
pub use rods::OddRod;
pub use softness::SoftMaterial;
pub use speed::{Thin, Tunnelling};

/// Largest number of spheres for which the check compares every two of them.
const FEW: usize = 32;

/// The force for which the time step is too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stiff {
    /// The spring with this index, in order of addition.
    Spring(usize),
    /// The tether with this index, in order of addition.
    Tether(usize),
    /// The contact force, with `contact_force` and `contact_damping`.
    Contact,
    /// The setting `linear_damping`.
    LinearDamping,
    /// The setting `angular_damping`.
    AngularDamping,
    /// The chain of rods of fixed length at the sphere with this index, under its own weight.
    Chain(usize),
}

/// Effect of a time step that is too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Effect {
    /// Energy grows without bound.
    Unstable,
    /// Energy stays bounded, but bodies do not come to rest. Springs that are far from their rest length gain energy slowly.
    Restless,
}

/// A warning that a time step is too long for a force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Warning {
    /// The force that is too stiff or too strongly damped.
    pub what: Stiff,
    /// The effect of the time step.
    pub effect: Effect,
    /// Stiffness per mass K, in 1/s². For the contact force, that of one contact.
    pub stiffness: f64,
    /// Damping per mass C, in 1/s. For the contact force, that of one contact.
    pub damping: f64,
    /// The largest time step without either effect, in s.
    pub largest_dt: f64,
}

impl Warning {
    /// A message that names the force as the scene text does.
    pub fn describe(&self, scene: &Scene) -> String {
        let what = match self.what {
            Stiff::Spring(index) => format!("{}, with all others at its ends,", scene.name_of_spring(index)),
            Stiff::Tether(index) => format!("{}, with all others at its sphere,", scene.name_of_tether(index)),
            Stiff::Contact => "the contact force".to_owned(),
            Stiff::Chain(index) => {
                format!("the chain of rods of fixed length at {}, under its own weight,", scene.name_of_sphere(index))
            }
            Stiff::LinearDamping => "`linear_damping`".to_owned(),
            Stiff::AngularDamping => "`angular_damping`".to_owned(),
        };
        let [k, c, largest] = [self.stiffness, self.damping, self.largest_dt].map(at_most);
        let effect = match (self.effect, self.what) {
            (Effect::Unstable, _) => "it is unstable, energy grows without bound",
            (Effect::Restless, Stiff::Contact) => "bodies do not come to rest",
            (Effect::Restless, Stiff::Chain(_)) => "it gains energy when it is let go level",
            (Effect::Restless, _) => "it gains energy when it is far from its rest length",
        };
        format!(
            "{what} is too stiff for the time step (stiffness per mass {k} /s², damping per mass {c} /s): {effect}; the largest \
             time step that works is {largest} s"
        )
    }
}

/// Constants and a time step that cause no warnings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Suggestion {
    /// A value for [`Settings::resting_overlap`]; `None` if the present contact force will do.
    pub resting_overlap: Option<f32>,
    /// The contact force in use with it, in 1/s².
    pub contact_force: f32,
    /// The contact damping in use with it, in 1/s.
    pub contact_damping: f32,
    /// The time step, in s.
    pub time_step: f32,
}

/// Rounds to three significant digits, never above the number itself.
fn rounded_down(number: f64) -> f64 {
    // The tiny increase keeps a number that already has three digits.
    rounded(number, 3, |scaled| (scaled * (1.0 + 1e-12)).floor())
}

/// Rounds to three significant digits, never below the number itself.
fn rounded_up(number: f64) -> f64 {
    rounded(number, 3, |scaled| (scaled * (1.0 - 1e-12)).ceil())
}

/// A number for a message, with three significant digits.
fn nearest(number: f64) -> String {
    short_number(number, 3)
}

/// The same, never above the number itself.
fn at_most(number: f64) -> String {
    short_number(rounded_down(number), 3)
}

fn rounded(number: f64, digits: i32, to_whole: impl Fn(f64) -> f64) -> f64 {
    if number == 0.0 || !number.is_finite() {
        return number;
    }
    let digits = digits - 1 - number.abs().log10().floor() as i32;
    // The scale is a power of ten that is exact itself, so that 0.02 stays 0.02.
    let scale = 10_f64.powi(digits.abs());
    if digits >= 0 { to_whole(number * scale) / scale } else { to_whole(number / scale) * scale }
}

impl Scene {
    /// Returns a warning for everything that a time step of `dt` seconds is too long for: springs, then tethers, then the
    /// contact force of [`Scene::resolved_settings`]. Empty if the time step works.
    pub fn stability(&self, dt: f32, integrator: Integrator) -> Vec<Warning> {
        if self.is_rigid() {
            // Hard contacts have no stiffness that a time step must suit.
            return Vec::new();
        }
        let loads = Loads::of(self);
        let dt = f64::from(dt);
        let warn = |what, [stiffness, damping]: [f64; 2], steps: Steps| {
            let effect = if dt > steps.bounded { Effect::Unstable } else { Effect::Restless };
            (dt > steps.rest).then_some(Warning { what, effect, stiffness, damping, largest_dt: steps.rest })
        };
        let spring = |[stiffness, damping]: [f64; 2]| spring_steps(stiffness, damping, integrator);
        let springs = self.springs().iter().enumerate().filter_map(|(index, ends)| {
            let [a, b] = [ends.a, ends.b].map(|id| loads.on(self, id));
            let load = [a[0] + b[0], a[1] + b[1]];
            warn(Stiff::Spring(index), load, spring(load))
        });
        let tethers = self.tethers().iter().enumerate().filter_map(|(index, tether)| {
            let load = loads.on(self, tether.sphere);
            warn(Stiff::Tether(index), load, spring(load))
        });
        let mut warnings: Vec<Warning> = springs.chain(tethers).collect();
        let settings = self.resolved_settings();
        let contact = [settings.contact_force, settings.contact_damping].map(f64::from);
        let steps = self.contact_steps(contact, integrator);
        warnings.extend(steps.and_then(|steps| warn(Stiff::Contact, contact, steps)));
        let chain = self.stiffest_link();
        warnings.extend(chain.and_then(|(index, load)| warn(Stiff::Chain(index), [load, 0.0], chain_steps(load))));
        let dampings = [(Stiff::LinearDamping, settings.linear_damping), (Stiff::AngularDamping, settings.angular_damping)];
        for (what, rate) in dampings.into_iter().filter(|(_, rate)| *rate > 0.0) {
            warnings.extend(warn(what, [0.0, rate.into()], few_steps(1.0, 0.0, rate.into(), integrator)));
        }
        warnings
    }

    /// The least number of equal parts into which a time step of `dt` seconds must be divided for [`Scene::stability`] to
    /// return no warnings, and for no time of [`Scene::law_times`] to be exceeded.
    pub fn substeps_for(&self, dt: f32, integrator: Integrator) -> u32 {
        let largest = self.force_bounds(dt, integrator).fold(f64::INFINITY, f64::min);
        // Every bound is below dt. The least one is the bound of the scene.
        let mut parts = (f64::from(dt) / largest).ceil().clamp(1.0, f64::from(u32::MAX)) as u32;
        // The part is an f32, which may be rounded up.
        while f64::from(dt / parts as f32) > largest && parts < u32::MAX {
            parts += 1;
        }
        parts
    }

    /// The largest time steps of the springs, tethers, contacts and dampings for which a time step of `dt` seconds is too long.
    fn force_bounds(&self, dt: f32, integrator: Integrator) -> impl Iterator<Item = f64> {
        let stiff = self.stability(dt, integrator).into_iter().map(|warning| warning.largest_dt);
        let slow = self.law_times().into_iter().filter(move |time| time.is_exceeded_by(dt));
        stiff.chain(slow.map(|time| time.largest_dt()))
    }

    /// Everything that a run of this scene with a time step of `dt` seconds should be warned of, one message each: an unstable
    /// time step, one that is too long for a contact law with history, muscles and servos that are too fast for it, bodies that sink into each
    /// other, impacts that are deeper than walls, bodies that pass through thin things, positions that are too coarse, rods
    /// that lose angular momentum, and rods that are likely mistakes. Also what [`Scene::intent`] finds.
    pub fn concerns(&self, dt: f32, integrator: Integrator) -> Vec<String> {
        if self.is_rigid() {
            // Hard contacts bound no time step, but springs bound the substep.
            let rods = self.odd_rods();
            return self.concerns_of_frames(dt).into_iter().chain(rods.iter().map(|rod| rod.describe(self))).collect();
        }
        let mut concerns: Vec<String> = self.stability(dt, integrator).iter().map(|warning| warning.describe(self)).collect();
        let slow = self.law_times().into_iter().filter(|time| time.is_exceeded_by(dt));
        concerns.extend(slow.map(|time| time.describe(self, dt)));
        concerns.extend(self.unused_properties());
        concerns.extend(self.neck_concerns(dt));
        concerns.extend(self.fast_muscle(dt).map(|muscle| muscle.describe(self)));
        concerns.extend(self.sinking(integrator).map(|sinking| sinking.to_string()));
        concerns.extend(self.soft_material().map(|soft| soft.to_string()));
        concerns.extend(self.deep_impact().map(|impact| impact.describe(self)));
        concerns.extend(self.tunnelling(dt).map(|tunnelling| tunnelling.to_string()));
        concerns.extend(self.servo_concerns(dt));
        concerns.extend(self.coarse().map(|coarse| coarse.describe(self)));
        concerns.extend(self.strained_rod(dt, integrator));
        concerns.extend(self.intent());
        concerns.extend(self.odd_rods().iter().map(|rod| rod.describe(self)));
        concerns
    }

    /// Constants and a time step, at most `dt` seconds, with which the scene causes none of the warnings of
    /// [`Scene::stability`], [`Scene::law_times`], [`Scene::fast_muscle`], [`Scene::sinking`] and [`Scene::tunnelling`]. `None` if
    /// there are none now. A time step below `dt` is 10 to 18 % below the bound, and has two significant digits.
    pub fn suggestion(&self, dt: f32, integrator: Integrator) -> Option<Suggestion> {
        let mut settings = self.settings;
        let sinking = self.sinking(integrator);
        if sinking.is_some() {
            settings.resting_overlap = 0.02;
        }
        let mended = Self { settings, ..self.clone() };
        let bounds = mended
            .force_bounds(dt, integrator)
            .chain(mended.tunnelling(dt).map(|tunnelling| tunnelling.largest_dt))
            .chain(mended.fast_muscle(dt).map(|muscle| muscle.largest_dt));
        let largest = bounds.fold(f64::INFINITY, f64::min);
        if largest.is_infinite() && sinking.is_none() {
            return None;
        }
        let time_step = if largest.is_finite() { rounded(0.9 * largest, 2, f64::floor) as f32 } else { dt };
        let Settings { contact_force, contact_damping, .. } = mended.resolved_settings();
        Some(Suggestion {
            resting_overlap: sinking.map(|_| settings.resting_overlap),
            contact_force,
            contact_damping,
            time_step,
        })
    }

    /// The bounds of the contact force; `None` if no moving body can touch anything, and for contact laws other than the thesis's.
    fn contact_steps(&self, [force, damping]: [f64; 2], integrator: Integrator) -> Option<Steps> {
        if self.contact_law().has_history() {
            return None;
        }
        let crowd = self.crowd();
        match crowd {
            Crowd::None => None,
            Crowd::Pair => Some(few_steps(1.0, force, damping, integrator)),
            Crowd::Few => Some(few_steps(2.0, force, damping, integrator)),
            Crowd::Many => {
                let elastic = self.settings.collisions && self.settings.restitution >= 1.0;
                let steps = crowd_steps(force, damping, integrator, elastic);
                // Without any loss of energy nothing comes to rest at any time step.
                let lossless = damping == 0.0 && (elastic || !self.settings.collisions);
                Some(if lossless { Steps { rest: steps.bounded, ..steps } } else { steps })
            }
        }
    }

    /// Whether no two bodies can touch, because there are no boxes and polygons and every two spheres are fixed or joined by a
    /// rod of fixed length. `false` for many spheres, without a look at them.
    fn is_bonded(&self) -> bool {
        let spheres = self.spheres();
        if spheres.len() > FEW || !self.boxes().is_empty() || !self.polygons().is_empty() {
            return false;
        }
        let rods = self.rods().iter().filter(|rod| rod.length.is_some());
        let bonds: Vec<[usize; 2]> =
            rods.filter_map(|rod| Some([self.spheres.index(rod.end1).ok()?, self.spheres.index(rod.end2).ok()?])).collect();
        let is_bond = |a, b| bonds.contains(&[a, b]) || bonds.contains(&[b, a]);
        let mut pairs = (0..spheres.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        pairs.all(|(a, b)| (spheres[a].fixed && spheres[b].fixed) || is_bond(a, b))
    }

    /// Returns how many bodies can touch each other.
    fn crowd(&self) -> Crowd {
        if self.is_bonded() {
            return Crowd::None;
        }
        // Numbers of movers and of all other objects, by group.
        let mut groups = vec![[0_usize; 2]; 1 << 16];
        for sphere in self.spheres() {
            groups[usize::from(sphere.group)][usize::from(sphere.fixed)] += 1;
        }
        let boxes = self.boxes().iter().map(|cuboid| cuboid.group);
        let polygons = self.polygons().iter().map(|polygon| polygon.group);
        let rods = self.rods().iter().map(|rod| rod.group);
        for group in boxes.chain(polygons).chain(rods) {
            groups[usize::from(group)][1] += 1;
        }
        let of_group = |[movers, others]: &[usize; 2]| match (*movers, movers + others) {
            (0, _) | (_, 1) => Crowd::None,
            (_, 2) => Crowd::Pair,
            (1 | 2, _) => Crowd::Few,
            _ => Crowd::Many,
        };
        groups.iter().map(of_group).max().unwrap_or(Crowd::None)
    }
}

/// How many bodies can touch each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Crowd {
    /// No moving bodies.
    None,
    /// One pair.
    Pair,
    /// One or two moving bodies among fixed ones.
    Few,
    /// Three or more moving bodies.
    Many,
}

/// For each sphere, the sums of k and c over its springs and tethers. Empty if the scene has none.
struct Loads(Vec<[f64; 2]>);

impl Loads {
    fn of(scene: &Scene) -> Self {
        if scene.springs().is_empty() && scene.tethers().is_empty() {
            return Self(Vec::new());
        }
        let mut sums = vec![[0.0; 2]; scene.spheres().len()];
        let mut add = |id, stiffness: f32, damping: f32| {
            // Every end is in the scene, because removing a sphere also removes its springs.
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

#[cfg(test)]
#[path = "stability/tests.rs"]
mod tests;
