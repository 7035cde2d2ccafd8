//! What the pointer does with bodies: picks, holds, drags and throws them.

use rockfall::glam::Vec3;
use rockfall::{Body, Scene, Sphere, SphereId, Tether};

use super::Session;
use crate::window::hold::{Held, Sight};
use crate::window::message::Level;

/// How fast a held body swings about the pointer, in rad/s, and how much of that is damped.
const SWING: f32 = 10.0;
const DAMPING: f32 = 0.7;
/// A body drags along what hangs on it, up to so many times its own mass; more would need a shorter time step.
const DRAGGED: f32 = 40.0;
/// Bodies that hang together are counted up to so many.
const COUNTED: usize = 10_000;

impl Session {
    /// Ties the first body in the line of sight to the pointer; of a rod, the nearer end.
    pub fn hold(&mut self, sight: &Sight) {
        self.release();
        let hit = self.simulation.cast_ray(sight.origin, sight.direction);
        let Some(hit) = self.good(hit).flatten() else {
            return;
        };
        self.picked = Some(hit.body);
        let scene = self.simulation.scene();
        let place = |id: SphereId| scene.sphere(id).map(|sphere| (id, *sphere));
        let seized = match hit.body {
            Body::Sphere(id) => place(id),
            Body::Rod(id) => scene.rod(id).and_then(|rod| {
                let (one, two) = (place(rod.end1)?, place(rod.end2)?);
                let far = |end: &Sphere| end.position.distance_squared(hit.point);
                // A fixed end cannot be dragged.
                let first = !one.1.fixed && (two.1.fixed || far(&one.1) <= far(&two.1));
                Ok(if first { one } else { two })
            }),
            _ => {
                self.tell(Level::Note, "boxes and polygons never move");
                return;
            }
        };
        let Some((id, sphere)) = self.good(seized) else {
            return;
        };
        if sphere.fixed {
            self.tell(Level::Note, "this sphere is fixed");
            return;
        }
        self.tie(id, &sphere, hit.point, sight);
    }

    fn tie(&mut self, id: SphereId, sphere: &Sphere, seized: Vec3, sight: &Sight) {
        let mass = hanging_mass(self.simulation.scene(), id).min(DRAGGED * sphere.mass);
        // Beyond sphere.mass / dt the damping itself would shake.
        let damping = (2.0 * DAMPING * SWING * mass).min(sphere.mass / self.pace.time_step);
        let tether = Tether::new(id, sphere.position, mass * SWING * SWING).damping(damping);
        let added = self.simulation.add_tether(tether);
        if let Some(tether) = self.good(added) {
            let depth = (seized - sight.origin).dot(sight.forward);
            self.held = Some(Held { sphere: id, tether, pointer: seized, offset: sphere.position - seized, depth });
        }
    }

    /// Pulls what is held to where the pointer is now.
    pub fn drag(&mut self, sight: &Sight) {
        let Some(held) = &mut self.held else {
            return;
        };
        held.pointer = sight.at_depth(held.depth);
        let (id, point) = (held.tether, held.pointer + held.offset);
        let updated = self.simulation.update_tether(id, |tether| tether.point = point);
        if self.good(updated).is_none() {
            self.held = None;
        }
    }

    /// Lets go.
    pub fn release(&mut self) {
        if let Some(held) = self.held.take() {
            let removed = self.simulation.remove_tether(held.tether);
            self.good(removed);
        }
    }

    /// Adds a sphere that flies off from `origin` at `velocity`: as large and as dense as those of the scene.
    pub fn throw(&mut self, origin: Vec3, velocity: Vec3) {
        let sphere = thrown(self.simulation.scene(), origin, velocity);
        let added = self.simulation.add_sphere(sphere);
        if self.good(added).is_some() {
            self.objects_version += 1;
        }
    }

    /// Forgets or picks the first body that a ray meets.
    pub fn pick(&mut self, origin: Vec3, direction: Vec3) {
        let hit = self.simulation.cast_ray(origin, direction);
        self.picked = self.good(hit).flatten().map(|hit| hit.body);
        self.sample(true);
    }
}

/// The mass of all moving spheres that rods and springs join to one.
fn hanging_mass(scene: &Scene, start: SphereId) -> f32 {
    let rods = scene.rods().iter().map(|rod| (rod.end1, rod.end2));
    let springs = scene.springs().iter().map(|spring| (spring.a, spring.b));
    let mut next = std::collections::HashMap::<SphereId, Vec<SphereId>>::new();
    for (a, b) in rods.chain(springs) {
        next.entry(a).or_default().push(b);
        next.entry(b).or_default().push(a);
    }
    let (mut seen, mut left) = (std::collections::HashSet::from([start]), vec![start]);
    let mut mass = 0.0;
    while let Some(id) = left.pop() {
        let Some(sphere) = scene.sphere(id).ok().filter(|sphere| !sphere.fixed) else { continue };
        mass += sphere.mass;
        let new = next.get(&id).into_iter().flatten().filter(|id| seen.len() < COUNTED && seen.insert(**id));
        left.extend(new.copied().collect::<Vec<_>>());
    }
    mass
}

/// A sphere of the mean size and density of the moving ones.
fn thrown(scene: &Scene, origin: Vec3, velocity: Vec3) -> Sphere {
    let moving = || scene.spheres().iter().filter(|sphere| !sphere.fixed);
    let count = moving().count();
    let sum = |value: fn(&Sphere) -> f32| moving().map(|sphere| f64::from(value(sphere))).sum::<f64>();
    let cubes = sum(|sphere| sphere.radius.powi(3));
    let (radius, mass) = if count > 0 {
        let radius = sum(|sphere| sphere.radius) / count as f64;
        (radius, sum(|sphere| sphere.mass) / cubes * radius.powi(3))
    } else {
        (0.5, 1.0)
    };
    Sphere::new(origin, radius as f32).mass(mass as f32).velocity(velocity)
}
