//! Forces on walls, as a gauge would measure them.

use glam::{DVec3, Vec3};

use crate::error::{Error, Result, quoted};
use crate::scene::{Body, ObjectId, Scene};
use crate::simulation::Simulation;
use crate::simulation::observe::ContactAction;

/// The load of all contacts on a wall in one state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct WallLoad {
    /// Force on the wall, in mass units/s².
    pub force: DVec3,
    /// Its torque about the origin, in mass units²/s².
    pub torque: DVec3,
    /// Number of contacts.
    pub contacts: u64,
}

impl Simulation {
    /// The load on the boxes and polygons that follow the motion of a name or have it as their own name, in the current state. The sum is
    /// in the order of [`Simulation::contacts`], so it does not depend on memory.
    ///
    /// A collision counts with its impulse divided by the time step, as its mean force over the next step. Friction impulses
    /// (`coulomb_friction`, `collision_friction`) are left out.
    ///
    /// # Errors
    /// [`Error::Invalid`] if no box and no polygon has this name or motion, and as for [`Simulation::contacts`].
    pub fn wall_load(&mut self, name: &str) -> Result<WallLoad> {
        let found = {
            let scene = self.scene();
            let mut walls = scene.box_ids().map(Body::Box).chain(scene.polygon_ids().map(Body::Polygon));
            walls.any(|body| is_wall(scene, body, name))
        };
        if !found {
            let expected = "the name of a motion, or of boxes or polygons";
            return Err(Error::Invalid { field: "wall", value: quoted(name), expected });
        }
        let dt = f64::from(self.time_step());
        let mut load = WallLoad::default();
        for contact in self.contacts()?.iter().filter(|contact| is_wall(self.scene(), contact.b, name)) {
            let force = match contact.action {
                ContactAction::Force(force) => force.as_dvec3(),
                ContactAction::Impulse(Vec3::ZERO) => DVec3::ZERO,
                ContactAction::Impulse(impulse) => impulse.as_dvec3() / dt,
            };
            load.force += force;
            load.torque += contact.point.as_dvec3().cross(force);
            load.contacts += 1;
        }
        Ok(load)
    }
}

/// Whether a body is a box or polygon that has a name or follows the motion of that name.
fn is_wall(scene: &Scene, body: Body, name: &str) -> bool {
    let (motion, id) = match body {
        Body::Box(id) => (scene.cuboid(id).ok().and_then(|cuboid| cuboid.motion), ObjectId::from(id)),
        Body::Polygon(id) => (scene.polygon(id).ok().and_then(|polygon| polygon.motion), ObjectId::from(id)),
        _ => return false,
    };
    let of_motion = motion.and_then(|id| scene.motion(id).ok()).is_some_and(|motion| motion.name == name);
    of_motion || scene.tag(id).ok().flatten().is_some_and(|tag| tag.name.as_deref() == Some(name))
}
