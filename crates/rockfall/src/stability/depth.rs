//! Computes how deep bodies at rest overlap, and the contact force that limits the overlap.
//!
//! The contact law is Cc m* o. A body of mass m that rests on something fixed (m* = m) overlaps by o = G/Cc for any radius. On
//! a free body of the same mass (m* = m/2) it overlaps by twice that. If it carries l times its own mass in all, the overlap is
//! o = 2 l G/Cc.

use std::fmt;

use glam::{DVec2, DVec3};

use crate::scene::{BondedSets, Scene, Sphere};
use crate::settings::{ContactLaw, Integrator, Settings};
use crate::stability::{Crowd, at_most, nearest, rounded_down, rounded_up};

/// Largest overlap of one resting body, as a share of the smallest radius, that causes no warning. Under the weight of others
/// the overlap is several times as large, and bodies sink through each other.
pub(super) const DEEP: f64 = 0.05;
/// Safety factor of the chosen contact force. Contacts in a pile do not carry equal shares of the load. With this factor the
/// deepest overlap in piles of 20 to 2,000 spheres with radii from 3 to 5 was 0.2 to 0.8 times the requested one.
pub(super) const SAFETY: f64 = 3.0;

/// Least number of loose spheres that count as a pile. Fewer ones need not end on top of each other.
const PILE: usize = 64;
/// Safety factor of [`Scene::gentle_gravity`].
const GENTLE: f64 = 8.0;

/// A warning that gravity presses resting bodies too deeply into what they lie on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinking {
    /// Overlap at rest, in units: of one body on a fixed object, gravity / `contact_force`; under a load of more than 1, of the
    /// body that it presses most.
    pub overlap: f64,
    /// The smallest radius, or that of the body that the load presses most, in units.
    pub radius: f64,
    /// The mass that the body carries, divided by its own mass; 1 for a body alone.
    pub load: f64,
    /// The least sufficient `contact_force`, in 1/s².
    pub contact_force: f64,
    /// The `contact_damping` that keeps the restitution of contacts unchanged, in 1/s.
    pub contact_damping: f64,
    /// The largest time step that works with them, in s.
    pub largest_dt: f64,
}

impl fmt::Display for Sinking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = nearest(100.0 * self.overlap / self.radius);
        let [overlap, radius] = [self.overlap, self.radius].map(nearest);
        if self.load > 1.0 {
            let load = nearest(self.load);
            write!(f, "bodies below others carry about {load} times their weight and overlap by about {overlap} units, ")?;
            write!(f, "{percent} % of their radius {radius}")?;
        } else {
            write!(
                f,
                "bodies at rest overlap by {overlap} (gravity / contact_force), {percent} % of the smallest radius {radius}"
            )?;
        }
        write!(
            f,
            ": `set resting_overlap 0.02` chooses a contact force; or use a contact_force of {} or more, with a \
             contact_damping of {} and a time step of at most {} s",
            nearest(self.contact_force),
            nearest(self.contact_damping),
            at_most(self.largest_dt),
        )
    }
}

/// Constants with which bodies at rest overlap little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remedy {
    /// A value for [`Settings::resting_overlap`].
    pub resting_overlap: f32,
    /// The `contact_force` that it chooses, in 1/s².
    pub contact_force: f32,
    /// The `contact_damping` that it chooses, in 1/s.
    pub contact_damping: f32,
    /// The largest time step that works with them, in s.
    pub largest_dt: f64,
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { resting_overlap, contact_force, contact_damping, largest_dt } = *self;
        let [force, damping] = [contact_force, contact_damping].map(|number| nearest(number.into()));
        write!(
            f,
            "`set resting_overlap {resting_overlap}` chooses a contact_force of {force} /s² and a contact_damping of {damping} \
             /s, which need a time step of at most {} s",
            at_most(largest_dt)
        )
    }
}

impl Scene {
    /// The constants that a simulation of this scene uses. Where [`Settings::resting_overlap`] is positive, its contact force
    /// and damping replace those of [`Scene::settings`].
    ///
    /// Derivation. All bodies together press on the area that they cover with the pressure p = weight / area. A sphere at the
    /// bottom carries p (2r)², the load on the square of its diameter, but at least its own weight. For equal spheres this is
    /// the weight of a column of l spheres. The law of contact between two such spheres, (Cc o) m/2 = l m G, gives o = 2 l
    /// G/Cc, so an overlap of F r needs Cc = 2 l G/(F r). The largest such Cc of any moving sphere or rod is used, times a
    /// safety factor of 3. The area is the horizontal extent of all movers, clipped to that of boxes and polygons. A narrow
    /// tower therefore counts as one that stays narrow. A heavy body that rests on a single much lighter one presses deeper
    /// than F.
    ///
    /// The damping ratio Cd / (2 sqrt(Cc)) determines the restitution of a contact and is kept. `friction` is not changed, so
    /// friction becomes weaker in proportion to the contact force.
    ///
    /// The contact law is that of [`Scene::contact_law`]. Where `auto` means `rigid`, a restitution and a `coulomb_friction` that have
    /// the defaults of [`Settings`] become 0 and 0.5.
    pub fn resolved_settings(&self) -> Settings {
        let mut settings = self.chosen_settings();
        settings.precision = self.chosen_precision().precision;
        let share = f64::from(settings.resting_overlap);
        let load = if share > 0.0 { self.heaviest_load() } else { 0.0 };
        if load <= 0.0 {
            return settings;
        }
        let force = (2.0 * SAFETY * load / share).min(f64::from(f32::MAX));
        settings.contact_damping = damping_for(&self.settings, force) as f32;
        settings.contact_force = force as f32;
        settings
    }

    /// Returns a warning if bodies at rest overlap by more than 5 % of the smallest radius, with sufficient constants.
    ///
    /// A body alone overlaps by gravity / `contact_force`. In a scene of three or more moving bodies, those below others carry
    /// them. Their load is estimated as in [`Scene::resolved_settings`], without the bodies that fixed spheres or tethers hold.
    /// Where nothing can touch, and where rods, springs and tethers hold all bodies and there are no boxes and polygons, no body
    /// rests on another one.
    pub fn sinking(&self, integrator: Integrator) -> Option<Sinking> {
        let settings = self.resolved_settings();
        let crowd = self.crowd();
        let [gravity, force] = [settings.gravity.abs(), settings.contact_force].map(f64::from);
        // Without a contact force no body is meant to rest.
        let other_law = self.contact_law() != ContactLaw::Thesis;
        if other_law || force <= 0.0 || settings.resting_overlap > 0.0 || crowd == Crowd::None {
            return None;
        }
        let radii = self.spheres().iter().filter(|sphere| !sphere.fixed).map(|sphere| f64::from(sphere.radius));
        let smallest = radii.fold(f64::INFINITY, f64::min);
        let alone = gravity / force;
        // Constants are f32, so an intended 5 % may be slightly exceeded.
        let is_deep = |overlap: f64, radius: f64| overlap > DEEP * (1.0 + 1e-6) * radius;
        let needed = gravity / (DEEP * smallest);
        let sets = self.sets_at_rest();
        // Where bodies carry others, the constants for a body alone are not enough.
        let [load, radius] = if crowd == Crowd::Many { self.load_of_loose(&sets, true) } else { [1.0, smallest] };
        let (overlap, radius, load, needed) = if load > 1.0 && is_deep(2.0 * load * alone, radius) {
            (2.0 * load * alone, radius, load, needed.max(2.0 * SAFETY * load * gravity / (DEEP * radius)))
        } else if is_deep(alone, smallest) && !self.is_hung(&sets) {
            (alone, smallest, 1.0, needed)
        } else {
            return None;
        };
        let contact_force = rounded_up(needed);
        let contact_damping = rounded_down(damping_for(&settings, contact_force));
        let steps = self.contact_steps([contact_force, contact_damping], integrator)?;
        Some(Sinking { overlap, radius, load, contact_force, contact_damping, largest_dt: steps.rest })
    }

    /// Whether rods, springs and tethers hold all moving bodies, and there are no boxes and polygons to rest on.
    fn is_hung(&self, sets: &BondedSets) -> bool {
        let is_free = self.boxes().is_empty() && self.polygons().is_empty();
        is_free && (0..self.spheres().len()).all(|sphere| sets.is_held(sphere))
    }

    /// The largest gravity up to the present one at which bodies at rest overlap by less than 5 % of their radius, whatever they
    /// carry, at the present contact force. The sign is that of the present gravity.
    pub fn gentle_gravity(&self) -> f32 {
        let gravity = self.settings.gravity;
        let [load, radius] = self.load_of_loose(&self.sets_at_rest(), false);
        // Contacts do not carry equal shares, as in `resolved_settings`, and bodies that still settle press deeper. The deepest
        // overlaps in piles and hoppers of 100 to 5,000 spheres after 20 s were 1 to 6 times the estimate without the factor.
        let largest = DEEP * radius * f64::from(self.settings.contact_force) / (2.0 * GENTLE * load);
        let rounded = rounded_down(largest) as f32;
        if rounded < gravity.abs() { rounded.copysign(gravity) } else { gravity }
    }

    /// Constants with which bodies at rest overlap by less than 2 % of their radius; `None` if nothing presses them.
    pub fn remedy(&self, integrator: Integrator) -> Option<Remedy> {
        if self.is_rigid() {
            return None;
        }
        let mut scene = Self { settings: self.settings, ..self.clone() };
        scene.settings.resting_overlap = 0.02;
        let settings = scene.resolved_settings();
        let contact = [settings.contact_force, settings.contact_damping].map(f64::from);
        let steps = scene.contact_steps(contact, integrator)?;
        let Settings { resting_overlap, contact_force, contact_damping, .. } = settings;
        (settings.gravity != 0.0).then_some(Remedy { resting_overlap, contact_force, contact_damping, largest_dt: steps.rest })
    }

    /// The load and the radius of the body with the largest ratio of the two, among the bodies that nothing holds; a load of 1
    /// if they are too few for a pile.
    fn load_of_loose(&self, sets: &BondedSets, spreads: bool) -> [f64; 2] {
        let loose: Vec<&Sphere> =
            self.spheres().iter().enumerate().filter(|(index, _)| !sets.is_held(*index)).map(|(_, sphere)| sphere).collect();
        let Some(carried) = self.pile_load(&loose, spreads) else {
            return [1.0, loose.iter().map(|sphere| f64::from(sphere.radius)).fold(f64::INFINITY, f64::min)];
        };
        let loads = loose.iter().map(|sphere| {
            let [own, radius] = [sphere.mass, sphere.radius].map(f64::from);
            [carried(own, radius) / own, radius]
        });
        loads.max_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1]))).unwrap_or([1.0, f64::INFINITY])
    }

    /// What a body of a pile of these spheres carries, as in `carried`; `None` if they are too few for a pile.
    pub(super) fn pile_load(&self, loose: &[&Sphere], spreads: bool) -> Option<impl Fn(f64, f64) -> f64 + use<>> {
        (loose.len() >= PILE).then(|| self.carried(loose, spreads))
    }

    /// The largest l G / r of all moving spheres and rods, where l is the mass that the body carries divided by its own mass.
    fn heaviest_load(&self) -> f64 {
        let gravity = f64::from(self.settings.gravity.abs());
        let movers: Vec<&Sphere> = self.spheres().iter().filter(|sphere| !sphere.fixed).collect();
        let carried = self.carried(&movers, false);
        let of_body = |own: f64, radius: f64| carried(own, radius) / (own * radius);
        let spheres = movers.iter().map(|sphere| of_body(sphere.mass.into(), sphere.radius.into()));
        let rods = self.rods().iter().filter_map(|rod| {
            let ends = [rod.end1, rod.end2].map(|id| self.sphere(id).ok().filter(|sphere| !sphere.fixed));
            let lighter = ends.into_iter().flatten().map(|sphere| f64::from(sphere.mass)).reduce(f64::min)?;
            Some(of_body(lighter, rod.radius.into()))
        });
        gravity * spheres.chain(rods).fold(0.0, f64::max)
    }

    /// The mass that a body of a pile of moving spheres carries, by its own mass and its radius: what lies on the square of its
    /// diameter, and at least itself. `spreads`: a narrow column on a floor, without walls, falls and becomes a heap.
    fn carried(&self, movers: &[&Sphere], spreads: bool) -> impl Fn(f64, f64) -> f64 + use<> {
        let mass: f64 = movers.iter().map(|sphere| f64::from(sphere.mass)).sum();
        let area = self.covered_area(movers, spreads);
        move |own, radius| (mass / area * 4.0 * radius * radius).clamp(own, mass.max(own))
    }

    /// The horizontal area that movers cover after they have fallen down, in units².
    fn covered_area(&self, movers: &[&Sphere], spreads: bool) -> f64 {
        let (east, north) = self.settings.gravity_direction.as_dvec3().normalize().any_orthonormal_pair();
        let flat = |point: DVec3| DVec2::new(point.dot(east), point.dot(north));
        let mut own = Span::default();
        let mut widest = 0.0_f64;
        for sphere in movers {
            let radius = f64::from(sphere.radius);
            own.add(flat(sphere.position.as_dvec3()), radius);
            widest = widest.max(2.0 * radius);
        }
        let mut walls = Span::default();
        for cuboid in self.boxes() {
            let corner = cuboid.corner.as_dvec3();
            let [i, j, k] = cuboid.edges.map(|edge| edge.as_dvec3());
            for edge in [DVec3::ZERO, i, j, k, i + j, j + k, k + i, i + j + k] {
                walls.add(flat(corner + edge), 0.0);
            }
        }
        for polygon in self.polygons() {
            let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(|vector| vector.as_dvec3());
            for edge in [DVec3::ZERO, left, right, left + right] {
                walls.add(flat(corner + edge), 0.0);
            }
        }
        let within = own.within(&walls);
        let mut least = widest;
        if spreads && self.boxes().len() + self.polygons().len() == 1 {
            // A heap twice as wide as it is high.
            let volume: f64 = movers.iter().map(|sphere| (2.0 * f64::from(sphere.radius)).powi(3)).sum();
            least = least.max((2.0 * volume).cbrt());
        }
        within.x.max(least) * within.y.max(least)
    }
}

/// The contact damping with the same damping ratio at another contact force. Uses the default ratio if there was no contact
/// force.
fn damping_for(settings: &Settings, force: f64) -> f64 {
    let default = Settings::default();
    let given = if settings.contact_force > 0.0 { settings } else { &default };
    let [old_force, old_damping] = [given.contact_force, given.contact_damping].map(f64::from);
    old_damping * (force / old_force).sqrt()
}

/// A rectangle in the horizontal plane.
#[derive(Clone, Copy, Debug)]
struct Span {
    min: DVec2,
    max: DVec2,
}

impl Default for Span {
    fn default() -> Self {
        Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY }
    }
}

impl Span {
    fn add(&mut self, point: DVec2, radius: f64) {
        self.min = self.min.min(point - radius);
        self.max = self.max.max(point + radius);
    }

    /// The sides of the intersection with another rectangle, or of the whole rectangle if they do not intersect.
    fn within(&self, other: &Self) -> DVec2 {
        let common = self.max.min(other.max) - self.min.max(other.min);
        if common.min_element() > 0.0 { common } else { self.max - self.min }
    }
}
