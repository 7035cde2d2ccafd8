//! Contacts of the present state under the law `rigid`.

use glam::{DVec3, Vec3};

use super::Frames;
use crate::error::Result;
use crate::rigid::broad::{Aabb, pairs_of_images};
use crate::rigid::collide::{Point, collide};
use crate::rigid::pose::Pose;
use crate::scene::{Body as Part, Scene, Sphere};
use crate::settings::DEFAULT_TIME_STEP;
use crate::simulation::observe::{Contact, ContactAction};
use crate::simulation::{MaxOverlap, Simulation, SphereDiagnostics};

/// Points are found up to this share of the radii of the bodies, as those of frames at rest are (docs/physics section 11.2).
const NEAR: f32 = 0.02;
/// Bodies meet, for events, while they are apart by at most this share of the radius of the smaller one: so what rocks or rattles does not
/// part for a frame.
const MEETS: f32 = 0.001;

/// A contact point.
struct Touch {
    colliders: [u32; 2],
    point: Vec3,
    /// From a to b.
    normal: Vec3,
    overlap: f32,
    /// Force on b at the end of the last frame.
    force: Vec3,
}

impl Frames {
    /// The place of a collider in the world.
    fn place(&self, collider: u32) -> Pose {
        let collider = &self.world.colliders[collider as usize];
        self.world.bodies[collider.body as usize].pose.compose(&collider.place)
    }

    /// What moves the second collider to its image nearest to the first one.
    fn image(&self, colliders: [u32; 2]) -> Vec3 {
        self.world.image(colliders.map(|collider| self.world.colliders[collider as usize].body))
    }

    /// The places of two colliders, the second one at its image nearest to the first one.
    fn places(&self, colliders: [u32; 2]) -> [Pose; 2] {
        let [place, mut other] = colliders.map(|collider| self.place(collider));
        other.position += self.image(colliders);
        [place, other]
    }

    /// A point of the world in coordinates of the scene.
    fn in_scene(&self, point: Vec3) -> Vec3 {
        if self.base == DVec3::ZERO { point } else { (self.base + point.as_dvec3()).as_vec3() }
    }

    /// All contact points that overlap or have a force, in the order of their colliders, and those that are apart by at most a share of the
    /// radius of the smaller body. The overlap of a point at rest may be less than the rounding of its place.
    fn touches(&self, share: f32) -> Vec<Touch> {
        let world = &self.world;
        let shape = |collider: u32| &world.shapes[world.colliders[collider as usize].shape as usize];
        let reach = |at: u32| {
            let body = &world.bodies[world.colliders[at as usize].body as usize];
            if body.inverse_mass > 0.0 { NEAR * body.radius } else { 0.0 }
        };
        let grown = |at: u32| {
            let (Aabb { min, max }, reach) = (shape(at).aabb(&self.place(at)), reach(at));
            Aabb { min: min - reach, max: max + reach }
        };
        let boxes: Vec<_> = (0..world.colliders.len() as u32).map(grown).collect();
        let apart = world.joints.apart_now();
        let may_touch = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|at| &world.colliders[at]);
            let has_mass = |body: u32| world.bodies[body as usize].inverse_mass > 0.0;
            a.body != b.body
                && a.group.touches(b.group)
                && (has_mass(a.body) || has_mass(b.body))
                && !apart.contains(a.body, b.body)
        };
        let mut found = Vec::new();
        let has_image = |at: usize| world.bodies[world.colliders[at].body as usize].inverse_mass > 0.0;
        let image = |a: usize, b: usize| self.image([a as u32, b as u32]);
        for (a, b) in pairs_of_images(&boxes, &world.periods, has_image, image, may_touch) {
            let [place, other] = self.places([a, b]);
            let Some(manifold) = collide(shape(a), shape(b), &place.relative(&other), reach(a) + reach(b)) else {
                continue;
            };
            let normal = place.turn * manifold.normal;
            let radii = [a, b].map(|at| if reach(at) > 0.0 { reach(at) / NEAR } else { f32::INFINITY });
            let gap = if share > 0.0 { share * radii[0].min(radii[1]) } else { 0.0 };
            for point in &manifold.points[..manifold.count] {
                let overlap = -(point.on_b - point.on_a).dot(manifold.normal);
                let force = world.history.forces([a, b], normal).find(|(id, _)| *id == point.id);
                let middle = self.in_scene(place.point(0.5 * (point.on_a + point.on_b)));
                let force = force.map_or(Vec3::ZERO, |(_, force)| force);
                if overlap >= -gap || force != Vec3::ZERO {
                    found.push(Touch { colliders: [a, b], point: middle, normal, overlap: overlap.max(0.0), force });
                }
            }
        }
        found
    }

    /// The pairs of colliders that struck each other in the last frame: where they are nearest now, and the mean force of their impacts over
    /// the frame. They may be apart.
    fn strikes(&self, dt: f32) -> Vec<Touch> {
        let world = &self.world;
        let speed = |at: u32| {
            let body = &world.bodies[world.colliders[at as usize].body as usize];
            let rate = body.spin.length();
            body.velocity.length() + if rate > 0.0 { rate * body.radius } else { 0.0 }
        };
        let strike = |([a, b], impulse): ([u32; 2], f32)| {
            let shape = |collider: u32| &world.shapes[world.colliders[collider as usize].shape as usize];
            let [place, other] = self.places([a, b]);
            let reach = 2.0 * dt * (speed(a) + speed(b));
            let found = collide(shape(a), shape(b), &place.relative(&other), reach);
            let nearest = found.and_then(|manifold| {
                let gap = |point: &Point| (point.on_b - point.on_a).dot(manifold.normal);
                let points = manifold.points[..manifold.count].iter();
                let point = points.min_by(|one, two| gap(one).total_cmp(&gap(two)))?;
                Some((place.turn * manifold.normal, self.in_scene(place.point(0.5 * (point.on_a + point.on_b)))))
            });
            let (normal, point) = nearest.unwrap_or_else(|| {
                let normal = (other.position - place.position).try_normalize().unwrap_or(Vec3::Y);
                (normal, self.in_scene(other.position))
            });
            Touch { colliders: [a, b], point, normal, overlap: 0.0, force: (impulse / dt) * normal }
        };
        world.history.strikes().map(strike).collect()
    }

    /// Contact points in the order of the objects of the scene.
    fn as_contacts(&self, touches: Vec<Touch>, scene: &Scene) -> Vec<Contact> {
        let contact = |touch: Touch| {
            let Touch { colliders, point, normal, overlap, force } = touch;
            let [a, b] = colliders.map(|at| self.parts[at as usize]);
            // The order spheres, rods, boxes, polygons, and by number.
            let is_turned = rank(scene, a) > rank(scene, b);
            let (a, b, sign) = if is_turned { (b, a, -1.0) } else { (a, b, 1.0) };
            Contact { a, b, point, normal: sign * normal, overlap, action: ContactAction::Force(sign * force), springs: None }
        };
        let mut contacts: Vec<Contact> = touches.into_iter().map(contact).collect();
        contacts.sort_by_key(|contact| (rank(scene, contact.a), rank(scene, contact.b)));
        contacts
    }

    /// An overlap in half the least edge or diameter of the smaller body.
    fn share(&self, touch: &Touch) -> f32 {
        let widths = touch.colliders.map(|at| {
            let body = &self.world.bodies[self.world.colliders[at as usize].body as usize];
            if body.inverse_mass > 0.0 { body.width } else { f32::INFINITY }
        });
        touch.overlap / (0.5 * widths[0].min(widths[1]))
    }
}

/// Overlaps in which a box or a hull of a rigid body takes part, the deepest point of each pair: both bodies, and the depth in
/// units and in half the least edge or diameter of the smaller body.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) for objects that the law `rigid` does not know.
pub(crate) fn overlaps_of_solids(scene: &Scene) -> Result<Vec<([Part; 2], f32, f32)>> {
    if scene.shapes().iter().all(|shape| shape.boxes.is_empty() && shape.hulls.is_empty()) {
        return Ok(Vec::new());
    }
    let mut implied = scene.clone();
    implied.imply_bodies();
    let mut frames = Frames::of(&implied, None)?;
    frames.place_motions(&implied, 0.0, DEFAULT_TIME_STEP);
    let mut found: Vec<([Part; 2], f32, f32)> = Vec::new();
    for touch in frames.touches(0.0) {
        let mut parts = touch.colliders.map(|at| frames.parts[at as usize]);
        if !parts.iter().any(|part| scene.is_solid(*part)) || touch.overlap <= 0.0 {
            continue;
        }
        parts.sort_by_key(|part| rank(scene, *part));
        let share = frames.share(&touch);
        // The points of a pair follow each other.
        match found.last_mut().filter(|(before, ..)| *before == parts) {
            Some((_, depth, radii)) => (*depth, *radii) = (depth.max(touch.overlap), radii.max(share)),
            None => found.push((parts, touch.overlap, share)),
        }
    }
    Ok(found)
}

impl Simulation {
    /// The bodies of the present state, of whose contacts nothing may be known yet.
    fn present_frames(&mut self) -> Result<(&Frames, &Scene)> {
        self.sync()?;
        if self.frames_due || self.frames.is_none() {
            self.renew_frames()?;
        }
        let Some(frames) = &mut self.frames else { unreachable!("they were renewed") };
        frames.fetch_history()?;
        Ok((frames, &self.scene))
    }

    pub(in crate::simulation) fn rigid_contacts(&mut self) -> Result<Vec<Contact>> {
        let (frames, scene) = self.present_frames()?;
        Ok(frames.as_contacts(frames.touches(0.0), scene))
    }

    /// What touches or nearly does so, and then what struck in the last frame, with the mean forces of the impacts over the frame. The
    /// latter may be apart now.
    pub(in crate::simulation) fn rigid_meetings(&mut self) -> Result<Vec<Contact>> {
        let dt = self.time_step();
        let (frames, scene) = self.present_frames()?;
        let mut contacts = frames.as_contacts(frames.touches(MEETS), scene);
        contacts.extend(frames.as_contacts(frames.strikes(dt), scene));
        Ok(contacts)
    }

    /// The deepest overlap, in units, and in half the least edge or diameter of the smaller body. Bodies that are faster than what the field
    /// gives in a frame are not at rest.
    pub(in crate::simulation) fn rigid_overlap(&mut self, only_at_rest: bool) -> Result<MaxOverlap> {
        let fast = if only_at_rest { self.gravity().length() * self.time_step() } else { f32::INFINITY };
        let (frames, _) = self.present_frames()?;
        let is_slow =
            |at: u32| frames.world.bodies[frames.world.colliders[at as usize].body as usize].velocity.length() <= fast;
        let mut deepest = MaxOverlap::default();
        for touch in frames.touches(0.0).into_iter().filter(|touch| touch.colliders.into_iter().all(is_slow)) {
            let share = frames.share(&touch);
            deepest.units = deepest.units.max(touch.overlap);
            if share > deepest.radii {
                deepest.radii = share;
                deepest.bodies = Some(touch.colliders.map(|at| frames.parts[at as usize]));
            }
        }
        Ok(deepest)
    }

    /// Of each sphere the contacts of the collider that goes by its name, and its weight with the forces of these contacts.
    pub(in crate::simulation) fn rigid_diagnostics(&mut self) -> Result<Vec<SphereDiagnostics>> {
        let contacts = self.rigid_contacts()?;
        let gravity = self.gravity();
        let scene = &self.scene;
        let of_sphere = |sphere: &Sphere| SphereDiagnostics {
            net_force: if sphere.fixed { Vec3::ZERO } else { sphere.mass * gravity + sphere.force },
            ..SphereDiagnostics::default()
        };
        let mut values: Vec<SphereDiagnostics> = scene.spheres().iter().map(of_sphere).collect();
        for contact in contacts {
            let ContactAction::Force(force) = contact.action else { continue };
            for (part, force) in [(contact.a, -force), (contact.b, force)] {
                let Part::Sphere(id) = part else { continue };
                let index = scene.spheres.index(id)?;
                values[index].contacts += 1;
                values[index].deepest_overlap = values[index].deepest_overlap.max(contact.overlap);
                if !scene.spheres()[index].fixed {
                    values[index].net_force += force;
                }
            }
        }
        Ok(values)
    }
}

/// The place of a part in the order spheres, rods, boxes, polygons.
fn rank(scene: &Scene, part: Part) -> (u32, usize) {
    match part {
        Part::Sphere(id) => (0, scene.spheres.index(id).unwrap_or_default()),
        Part::Rod(id) => (1, scene.rods.index(id).unwrap_or_default()),
        Part::Box(id) => (2, scene.boxes.index(id).unwrap_or_default()),
        Part::Polygon(id) => (3, scene.polygons.index(id).unwrap_or_default()),
    }
}
