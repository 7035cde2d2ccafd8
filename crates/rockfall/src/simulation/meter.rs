//! Means of loads, and the work of walls and muscles (docs/physics section 2.12) and of a shear.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::error::Result;
use crate::scene::{Body, Pose, Scene, Sphere};
use crate::settings::ContactLaw;
use crate::simulation::observe::{Contact, ContactAction};
use crate::simulation::shear_work::Slid;
use crate::simulation::{Simulation, engine};

/// Sums over steps: the loads that the gauges of a scene measure, and the work done on bodies by what moves them.
/// [`Simulation::run_metered`] adds to them. It reads the state back after every step, so a plain run is faster.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Meter {
    /// For every gauge, the sums of the force on its walls, in mass units/s², and of the torque about the origin, in mass units²/s².
    /// Both are 0 for a plane.
    pub loads: Vec<[DVec3; 2]>,
    /// Number of steps that the sums of loads have.
    pub steps: u64,
    /// Work done on bodies by walls that move, conveyors, the surfaces of fixed spheres, muscles, and the shear of a periodic scene, in
    /// mass units²/s².
    pub work: f64,
    has_loads: bool,
    has_work: bool,
    /// How bodies are driven after the last step.
    last: Option<Drive>,
    /// Where spheres are in a sheared scene after the last step.
    slid: Vec<Slid>,
}

/// How walls, muscles and a shear drive bodies in one state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Drive {
    /// Power of forces.
    power: f64,
    /// Work of the impulses of the next step.
    impulses: f64,
}

impl Meter {
    /// A meter of the loads on the walls that the gauges of a scene measure, of the work of its walls and muscles, or of both.
    pub fn new(scene: &Scene, loads: bool, work: bool) -> Self {
        Self {
            loads: vec![[DVec3::ZERO; 2]; scene.gauges().len()],
            has_loads: loads && scene.gauges().iter().any(|gauge| !gauge.of.is_plane()),
            has_work: work && is_driven(scene),
            ..Self::default()
        }
    }

    /// Whether there is something to add after every step.
    pub fn is_active(&self) -> bool {
        self.has_loads || self.has_work
    }

    /// Whether the work less the growth of all energies is what contacts, joints and dampers of a scene have dissipated (docs/physics
    /// section 2.12), apart from what tangential springs store. Under the laws of the thesis and of a program
    /// forces have no known potential. External forces do work of their own, and so does, in the long frames of `rigid`, all that
    /// moves or drives bodies.
    pub fn knows_dissipation(scene: &Scene) -> bool {
        let pulls = scene.spheres().iter().any(|sphere| sphere.force != Vec3::ZERO)
            || scene.bodies().iter().any(|body| body.force != Vec3::ZERO || body.torque != Vec3::ZERO);
        let has_motors = || scene.joints().iter().any(|joint| joint.speed.is_some());
        let law = scene.contact_law();
        match law.grain() {
            Some(grain) => grain.has_potential() && !pulls,
            None => law == ContactLaw::Rigid && !(pulls || is_driven(scene) || has_motors()),
        }
    }

    /// The means of the sums of loads, after which the sums begin again. Zeros if there was no step.
    pub fn take_means(&mut self) -> Vec<[DVec3; 2]> {
        let steps = self.steps.max(1) as f64;
        self.steps = 0;
        self.loads.iter_mut().map(|sums| std::mem::take(sums).map(|sum| sum / steps)).collect()
    }
}

impl Simulation {
    /// Runs `steps` steps of `dt` seconds like `run`, and adds the state after each of them to a meter. The results are the same. The
    /// work of a step is the trapezoidal rule for forces, from the state before it to that after it, and the sum of the impulses times
    /// the velocities of the walls. The states between two calls with one meter must not be edited.
    ///
    /// # Errors
    /// As for [`Simulation::run_async`], [`Simulation::contacts`] and [`Simulation::gauges`].
    pub fn run_metered(&mut self, steps: u64, dt: f32, meter: &mut Meter) -> Result<()> {
        let device = self.engine.waiter();
        if !meter.is_active() {
            return engine::block_on(device, self.run_async(steps, dt)).map(drop);
        }
        self.set_time_step(dt)?;
        if meter.has_work && meter.last.is_none() {
            let contacts = self.contacts()?;
            meter.last = Some(self.drive_of(&contacts)?);
            meter.slid = self.slid();
        }
        for _ in 0..steps {
            let device = self.engine.waiter();
            engine::block_on(device, self.run_async(1, dt))?;
            let contacts = self.contacts()?;
            if meter.has_loads {
                for (sums, load) in meter.loads.iter_mut().zip(self.loads_of(&contacts)?) {
                    let load = load.unwrap_or_default();
                    sums[0] += load.force;
                    sums[1] += load.torque;
                }
                meter.steps += 1;
            }
            if meter.has_work {
                let now = self.drive_of(&contacts)?;
                let before = meter.last.replace(now).unwrap_or_default();
                meter.work += before.impulses + 0.5 * f64::from(dt) * (before.power + now.power);
                let slid = std::mem::replace(&mut meter.slid, self.slid());
                meter.work += self.work_at_faces(&slid, &meter.slid);
            }
        }
        Ok(())
    }

    /// How walls and muscles drive bodies in the current state, whose contacts are given.
    fn drive_of(&mut self, contacts: &[Contact]) -> Result<Drive> {
        let time = self.muscle_clock.written_time();
        let mut drive = Drive { power: self.power_of_shear(contacts)?, ..Drive::default() };
        let driven =
            Driven { scene: &self.scene, poses: self.scene.motions().iter().map(|motion| motion.pose(time)).collect() };
        for contact in contacts {
            // Body B has the effect of the contact, and body A the opposite one.
            let velocity = driven.velocity(contact.a, contact) - driven.velocity(contact.b, contact);
            match contact.action {
                ContactAction::Force(force) => drive.power += force.as_dvec3().dot(velocity),
                ContactAction::Impulse(impulse) => drive.impulses += impulse.as_dvec3().dot(velocity),
            }
        }
        drive.power += self.power_of_muscles();
        Ok(drive)
    }

    /// The power of muscles: minus the elastic tension times the rate of the rest length.
    fn power_of_muscles(&self) -> f64 {
        let centre = |id| self.scene.sphere(id).map(|sphere| DVec3::from_array(sphere.centre())).unwrap_or_default();
        let springs = self.scene.springs().iter().filter_map(|spring| spring.muscle.map(|muscle| (spring, muscle)));
        springs
            .map(|(spring, muscle)| {
                let turns = self.muscle_clock.turns(&muscle);
                let swing = f64::from(spring.length) * f64::from(muscle.amplitude);
                let rate = swing * TAU * f64::from(muscle.frequency) * (TAU * turns).cos();
                let stretch = centre(spring.a).distance(centre(spring.b)) - spring.length_at_phase(turns);
                -f64::from(spring.stiffness) * stretch * rate
            })
            .sum()
    }
}

/// What moves bodies: walls at a time, and the surfaces of fixed spheres.
struct Driven<'a> {
    scene: &'a Scene,
    poses: Vec<Pose>,
}

impl Driven<'_> {
    /// The prescribed velocity of a body at a contact; 0 for a body that contacts can move.
    fn velocity(&self, body: Body, contact: &Contact) -> DVec3 {
        let place = contact.point.as_dvec3();
        let surface = match body {
            Body::Sphere(id) => return self.scene.sphere(id).map_or(DVec3::ZERO, |sphere| surface_velocity(sphere, place)),
            Body::Rod(_) => return DVec3::ZERO,
            Body::Box(id) => self.scene.cuboid(id).map(|cuboid| cuboid.surface_velocity),
            Body::Polygon(id) => self.scene.polygon(id).map(|polygon| polygon.surface_velocity),
        };
        let (surface, normal) = (surface.unwrap_or_default().as_dvec3(), contact.normal.as_dvec3());
        let number = self.scene.body_number(self.scene.motion_of(body)).unwrap_or_default();
        let pose = (number as usize).checked_sub(1).and_then(|motion| self.poses.get(motion));
        pose.map_or(DVec3::ZERO, |pose| pose.velocity_at(place)) + surface - surface.dot(normal) * normal
    }
}

/// The velocity of the surface of a sphere at a place; 0 unless it is fixed.
fn surface_velocity(sphere: &Sphere, place: DVec3) -> DVec3 {
    if !sphere.fixed {
        return DVec3::ZERO;
    }
    let inertia = 0.4 * f64::from(sphere.mass) * f64::from(sphere.radius).powi(2);
    let spin = sphere.angular_momentum.as_dvec3() / inertia;
    sphere.velocity.as_dvec3() + spin.cross(place - DVec3::from_array(sphere.centre()))
}

/// Whether walls, surfaces, muscles or the shear of a scene can do work.
fn is_driven(scene: &Scene) -> bool {
    let surfaces = scene.boxes().iter().map(|cuboid| cuboid.surface_velocity);
    let mut surfaces = surfaces.chain(scene.polygons().iter().map(|polygon| polygon.surface_velocity));
    let turns = |sphere: &Sphere| sphere.velocity != Vec3::ZERO || sphere.angular_momentum != Vec3::ZERO;
    !scene.motions().is_empty()
        || scene.shear().is_some()
        || surfaces.any(|velocity| velocity != Vec3::ZERO)
        || scene.springs().iter().any(|spring| spring.muscle.is_some())
        || scene.spheres().iter().any(|sphere| sphere.fixed && turns(sphere))
}
