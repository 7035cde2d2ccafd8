//! Gauges: loads on walls, and the flow through planes.

use glam::{DVec3, Vec3};

use crate::error::Result;
use crate::scene::{Gauge, Gauged, Scene};
use crate::simulation::Simulation;
use crate::simulation::observe::{Contact, ContactAction};

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

/// What a [`Gauge`] measures in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum GaugeReading {
    /// The load on walls.
    Wall(WallLoad),
    /// What has passed a plane since the start, along its normal minus against it. Fixed spheres do not count, and neither do
    /// spheres that edits add, remove or move across the plane.
    Plane {
        /// Mass of the spheres.
        mass: f64,
        /// Number of spheres.
        count: i64,
    },
}

impl Simulation {
    /// The load on the boxes and polygons that follow the motion of a name or have it as their own name, in the current state. The sum is
    /// in the order of [`Simulation::contacts`], so it does not depend on memory.
    ///
    /// A collision counts with its impulse divided by the time step, as its mean force over the next step. Friction impulses
    /// (`coulomb_friction`, `collision_friction`) are left out.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if no box and no polygon has this name or motion, and as for [`Simulation::contacts`].
    pub fn wall_load(&mut self, name: &str) -> Result<WallLoad> {
        self.scene().check_wall("wall", name)?;
        let dt = f64::from(self.time_step());
        let contacts = self.contacts()?;
        Ok(load(&contacts, self.scene(), name, dt))
    }

    /// The readings of all gauges of the scene in the current state, in order of addition; see [`Simulation::wall_load`] for walls.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if the walls of a gauge were removed, and as for [`Simulation::contacts`].
    pub fn gauges(&mut self) -> Result<Vec<GaugeReading>> {
        let walls = self.wall_loads()?;
        self.sync()?;
        let passed = self.planes.passed(&self.scene);
        let readings = walls.into_iter().zip(passed).map(|(load, front)| match load {
            Some(load) => GaugeReading::Wall(load),
            None => GaugeReading::Plane { mass: front.mass, count: front.count },
        });
        Ok(readings.collect())
    }

    /// For every gauge the load on its wall; `None` for a plane.
    fn wall_loads(&mut self) -> Result<Vec<Option<WallLoad>>> {
        if self.scene.gauges().iter().all(|gauge| gauge.of.is_plane()) {
            return Ok(vec![None; self.scene.gauges().len()]);
        }
        let contacts = self.contacts()?;
        self.loads_of(&contacts)
    }

    /// For every gauge the load of contacts on its wall; `None` for a plane.
    pub(super) fn loads_of(&self, contacts: &[Contact]) -> Result<Vec<Option<WallLoad>>> {
        let dt = f64::from(self.time_step());
        let of = |gauge: &Gauge| match &gauge.of {
            Gauged::Wall(wall) => {
                self.scene.check_wall("gauge.wall", wall)?;
                Ok(Some(load(contacts, &self.scene, wall, dt)))
            }
            Gauged::Plane { .. } => Ok(None),
        };
        self.scene.gauges().iter().map(of).collect()
    }

    /// Adds a gauge. That of a plane counts from now on.
    ///
    /// # Errors
    /// As for [`Scene::add_gauge`] and [`Simulation::sync`].
    pub fn add_gauge(&mut self, gauge: Gauge) -> Result<()> {
        self.sync()?;
        self.scene.add_gauge(gauge)?;
        self.planes.begin(&self.scene);
        Ok(())
    }
}

/// The load of contacts on the walls of a name.
fn load(contacts: &[Contact], scene: &Scene, name: &str, dt: f64) -> WallLoad {
    let mut load = WallLoad::default();
    for contact in contacts.iter().filter(|contact| scene.is_wall(contact.b, name)) {
        let force = match contact.action {
            ContactAction::Force(force) => force.as_dvec3(),
            ContactAction::Impulse(Vec3::ZERO) => DVec3::ZERO,
            ContactAction::Impulse(impulse) => impulse.as_dvec3() / dt,
        };
        load.force += force;
        load.torque += contact.point.as_dvec3().cross(force);
        load.contacts += 1;
    }
    load
}
