//! Picks, holds, drags and throws bodies with the pointer.

use rockfall::glam::Vec3;
use rockfall::{Body, Scene, Sphere, SphereId, Tether};

use super::Session;
use crate::window::hold::{Held, Sight};
use crate::window::message::Level;

/// Angular frequency of the tether that holds a body, in rad/s.
const ANGULAR_FREQUENCY: f32 = 10.0;
/// Damping ratio of that tether.
const DAMPING_RATIO: f32 = 0.7;
/// Greatest mass that the tether is designed for, divided by the mass of the held sphere. More would need a shorter time step.
const GREATEST_MASS_RATIO: f32 = 40.0;
/// Greatest number of connected bodies that are counted.
const MOST_CONNECTED: usize = 10_000;
/// Number of places along the way of a thrown sphere that are tried.
const MOST_PLACES: u16 = 12;
/// Distance of a thrown sphere from other bodies, divided by the sum of the radii.
const GAP: f32 = 1.05;

impl Session {
    /// Connects the first body in the line of sight to the pointer. A rod is held at the nearer end that is not fixed.
    pub fn hold(&mut self, sight: &Sight) {
        self.release();
        let Some(hit) = self.first_visible(sight.origin, sight.direction) else {
            return;
        };
        self.set_picked(Some(hit.body));
        let scene = self.simulation.scene();
        let place = |id: SphereId| scene.sphere(id).map(|sphere| (id, *sphere));
        let grabbed = match hit.body {
            Body::Sphere(id) => place(id),
            Body::Rod(id) => scene.rod(id).and_then(|rod| {
                let (one, two) = (place(rod.end1)?, place(rod.end2)?);
                let far = |end: &Sphere| end.position.distance_squared(hit.point);
                // A fixed end cannot be dragged.
                let first = !one.1.fixed && (two.1.fixed || far(&one.1) <= far(&two.1));
                Ok(if first { one } else { two })
            }),
            _ => {
                self.tell(Level::Note, "boxes and polygons never move, so they cannot be held");
                return;
            }
        };
        let Some((id, sphere)) = self.ok_or_report(grabbed) else {
            return;
        };
        if sphere.fixed {
            self.tell(Level::Note, "this sphere is fixed, so it cannot be held");
            return;
        }
        self.tie(id, &sphere, hit.point, sight);
    }

    fn tie(&mut self, id: SphereId, sphere: &Sphere, grabbed: Vec3, sight: &Sight) {
        let mass = connected_mass(self.simulation.scene(), id).min(GREATEST_MASS_RATIO * sphere.mass);
        // Damping above sphere.mass / dt would be unstable.
        let damping = (2.0 * DAMPING_RATIO * ANGULAR_FREQUENCY * mass).min(sphere.mass / self.pace.time_step);
        let tether = Tether::new(id, sphere.position, mass * ANGULAR_FREQUENCY * ANGULAR_FREQUENCY).damping(damping);
        let before = self.state_for_undo();
        let added = self.simulation.add_tether(tether);
        if let Some(tether) = self.ok_or_report(added) {
            self.before_hold = before;
            let depth = (grabbed - sight.origin).dot(sight.forward);
            self.held = Some(Held { sphere: id, tether, pointer: grabbed, offset: sphere.position - grabbed, depth });
        }
    }

    /// Moves the anchor of the held body to the present position of the pointer.
    pub fn drag(&mut self, sight: &Sight) {
        let Some(held) = &mut self.held else {
            return;
        };
        held.pointer = sight.at_depth(held.depth);
        let (id, point) = (held.tether, held.pointer + held.offset);
        let updated = self.simulation.update_tether(id, |tether| tether.point = point);
        if self.ok_or_report(updated).is_none() {
            self.held = None;
        }
    }

    /// Releases the held body.
    pub fn release(&mut self) {
        if let Some(held) = self.held.take() {
            let removed = self.simulation.remove_tether(held.tether);
            self.ok_or_report(removed);
            let steps = self.simulation.report().steps;
            let before = self.before_hold.take().filter(|before| before.report.steps < steps);
            self.edited_state("pull", before);
        }
    }

    /// Adds a sphere at `origin` with this velocity. It has the mean size and density of the spheres of the scene. If another
    /// body is there, it starts at the next free place along its way.
    pub fn throw(&mut self, origin: Vec3, velocity: Vec3) {
        let synced = self.simulation.sync().map(drop);
        if self.ok_or_report(synced).is_none() {
            return;
        }
        let mut sphere = thrown(self.simulation.scene(), origin, velocity);
        let Some(place) = free_place(self.simulation.scene(), &sphere) else {
            self.tell(Level::Warning, "there is no room for another sphere here");
            return;
        };
        sphere.position = place;
        let before = self.state_for_undo();
        let added = self.simulation.add_sphere(sphere);
        if self.ok_or_report(added).is_some() {
            self.objects_version += 1;
            self.edited_state("throw", before);
            if !self.running {
                self.tell(Level::Note, "the sphere flies as soon as the simulation runs (space)");
            }
        }
    }

    /// Returns the point where a line of sight enters the first visible body.
    pub fn look(&mut self, sight: &Sight) -> Option<Vec3> {
        self.first_visible(sight.origin, sight.direction).map(|hit| hit.point)
    }
}

/// Returns the first place along the way of a sphere where it touches no sphere and no rod.
fn free_place(scene: &Scene, sphere: &Sphere) -> Option<Vec3> {
    let way = sphere.velocity.normalize_or_zero() * (2.0 * sphere.radius * GAP);
    let touches = |place: Vec3| {
        let near = |other: Vec3, radius: f32| other.distance(place) < GAP * (radius + sphere.radius);
        scene.spheres().iter().any(|other| near(other.position, other.radius))
            || scene.rods().iter().any(|rod| {
                let ends = [rod.end1, rod.end2].map(|end| scene.sphere(end).map(|sphere| sphere.position));
                let [Ok(one), Ok(two)] = ends else { return false };
                let along = (place - one).dot(two - one) / one.distance_squared(two).max(f32::MIN_POSITIVE);
                near(one.lerp(two, along.clamp(0.0, 1.0)), rod.radius)
            })
    };
    (0..MOST_PLACES).map(|number| sphere.position + number as f32 * way).find(|place| !touches(*place))
}

/// Returns the mass of all moving spheres that rods and springs connect to a sphere, including itself.
fn connected_mass(scene: &Scene, start: SphereId) -> f32 {
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
        let new = next.get(&id).into_iter().flatten().filter(|id| seen.len() < MOST_CONNECTED && seen.insert(**id));
        left.extend(new.copied().collect::<Vec<_>>());
    }
    mass
}

/// Returns a sphere with the mean radius and density of the moving spheres.
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
