//! The work that the shear of a periodic scene does (docs/physics section 2.14).

use glam::DVec3;

use crate::error::Result;
use crate::scene::{Body, Scene, Shear, SphereId};
use crate::simulation::Simulation;
use crate::simulation::observe::{Contact, ContactAction};

/// The boxes of a sheared scene, which slide along each other.
struct Boxes<'a> {
    scene: &'a Scene,
    gradient: usize,
    flow: usize,
    from: f64,
    period: f64,
    /// Velocity of the box above.
    speed: f64,
}

/// The box in which a sphere is, counted along the gradient, and its velocity along the flow.
pub(super) type Slid = (f64, f64);

impl<'a> Boxes<'a> {
    fn of(scene: &'a Scene) -> Option<Self> {
        let Shear { gradient, flow, .. } = scene.shear()?;
        let [from, to] = scene.periodic()[gradient]?.map(f64::from);
        Some(Self { scene, gradient, flow, from, period: to - from, speed: scene.shear_speed() })
    }

    fn centre(&self, sphere: SphereId) -> DVec3 {
        self.scene.sphere(sphere).map(|sphere| DVec3::from_array(sphere.centre())).unwrap_or_default()
    }

    fn number(&self, centre: DVec3) -> f64 {
        ((centre[self.gradient] - self.from) / self.period).floor()
    }

    /// The power that the shear has through a force on the second of two bodies, which acts across some boxes.
    fn power(&self, across: f64, force: DVec3) -> f64 {
        across * self.speed * force[self.flow]
    }
}

impl Simulation {
    /// The power of the shear through contacts, springs and tethers; 0 without a shear.
    pub(super) fn power_of_shear(&mut self, contacts: &[Contact]) -> Result<f64> {
        if self.scene.shear().is_none() {
            return Ok(0.0);
        }
        let links = self.tensions()?;
        let Some(boxes) = Boxes::of(&self.scene) else { return Ok(0.0) };
        let mut power = 0.0;
        for contact in contacts {
            let (Body::Sphere(a), Body::Sphere(b), ContactAction::Force(force)) = (contact.a, contact.b, contact.action) else {
                continue;
            };
            let (a, b) = (boxes.centre(a), boxes.centre(b));
            let nearest = ((b - a)[boxes.gradient] / boxes.period).round_ties_even();
            power += boxes.power(boxes.number(a) - boxes.number(b) + nearest, force.as_dvec3());
        }
        for link in links {
            let a = boxes.centre(link.a);
            let (b, number) = match (link.b, link.point(&self.scene)) {
                (Some(b), _) => (boxes.centre(b), boxes.number(boxes.centre(b))),
                (None, point) => (point, 0.0),
            };
            let pull = (a - b).normalize_or_zero() * f64::from(link.force);
            power += boxes.power(boxes.number(a) - number, pull);
        }
        Ok(power)
    }

    /// Where all spheres are in a sheared scene; empty in other scenes.
    pub(super) fn slid(&self) -> Vec<Slid> {
        let Some(boxes) = Boxes::of(&self.scene) else { return Vec::new() };
        let slid = |sphere: &crate::scene::Sphere| {
            (boxes.number(DVec3::from_array(sphere.centre())), f64::from(sphere.velocity[boxes.flow]))
        };
        self.scene.spheres().iter().map(slid).collect()
    }

    /// The work of the shear on spheres that have passed a face: what the kinetic energy of their images changes by.
    pub(super) fn work_at_faces(&self, before: &[Slid], now: &[Slid]) -> f64 {
        let speed = self.scene.shear_speed();
        let work = |(mass, (before, now)): (f32, (&Slid, &Slid))| {
            let slower = (now.0 - before.0) * speed;
            let velocity = 0.5 * (before.1 + now.1) - before.0 * speed;
            f64::from(mass) * slower * (0.5 * slower - velocity)
        };
        let masses = self.scene.spheres().iter().map(|sphere| sphere.mass);
        masses.zip(before.iter().zip(now)).filter(|(_, (before, now))| before.0 != now.0).map(work).sum()
    }
}
