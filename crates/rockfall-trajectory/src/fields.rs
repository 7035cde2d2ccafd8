//! Coarse-grained fields: density, velocity, stress and temperature on a grid, from the bodies and contacts of a state.
//!
//! The fields are those of Goldhirsch, *Granular Matter* 12 (2010) 239-252, near walls with the force density of Weinhart and
//! others, *Granular Matter* 14 (2012) 289-294. With the smoothing function phi ([`Kernel`]), at the point r:
//!
//! | field | formula | unit |
//! |---|---|---|
//! | density | rho = sum m_i phi(r - r_i) | mass/units³ |
//! | velocity | V = sum m_i v_i phi(r - r_i) / rho | units/s |
//! | kinetic stress | -sum m_i v'_i v'_i phi(r - r_i), with v'_i = v_i - V(r) | mass/(units s²) |
//! | contact stress | -sum b f times the mean of phi over the branch b | mass/(units s²) |
//! | temperature | T = sum m_i v'_i² phi(r - r_i) / (3 rho) | units²/s² |
//! | wall force | t = sum f phi(r - c) | mass/(units² s²) |
//!
//! For two bodies that touch, the branch b leads from the centre of the second to that of the first, and f is the force on the
//! first. For a body and something fixed, b leads from the contact point c to the centre of the body, and f is the force on the
//! body. Stress is positive in tension. The balance of momentum holds exactly: rho DV/Dt = div(stress) + t + rho g.
//!
//! Spheres count, and ends of rods and capsules as spheres of their mass. A contact of a rod acts at the middle of the rod.
//! Fixed bodies, boxes and polygons are walls. Springs and external forces do not count, and collisions do not, because their
//! impulses are no forces: use a contact law without collisions, or bodies at rest.
//!
//! ```no_run
//! use rockfall::{Scene, Simulation};
//! use rockfall_trajectory::fields::{Kernel, Smoothing, Sources};
//!
//! # fn main() -> rockfall::Result<()> {
//! let mut simulation = Simulation::new(Scene::load("pile.txt")?.scene)?;
//! simulation.run(1000, 0.001)?;
//! let sources = Sources::of(&mut simulation)?;
//! let smoothing = Smoothing::new(Kernel::Gaussian, 0.2)?;
//! let fields = sources.fields(sources.grid(smoothing, 0.2)?, smoothing);
//! let deepest = fields.pressure().fold(0.0, f64::max);
//! # let _ = deepest;
//! # Ok(())
//! # }
//! ```

use glam::{DMat3, DVec3};
use rockfall::{Body, ContactAction, Error, Result, Scene, Simulation};

mod grid;
mod kernel;
mod write;

pub use grid::Grid;
pub use kernel::{Kernel, Smoothing};

/// A moving sphere.
#[derive(Clone, Copy, Debug)]
struct Grain {
    position: DVec3,
    velocity: DVec3,
    mass: f64,
}

/// The line along which a contact transmits its force, and the force on the body where it ends.
#[derive(Clone, Copy, Debug)]
struct Branch {
    from: DVec3,
    to: DVec3,
    force: DVec3,
    /// Whether `from` is a contact point on a wall.
    at_wall: bool,
}

/// Bodies and contacts of a state.
#[derive(Clone, Debug)]
pub struct Sources {
    grains: Vec<Grain>,
    branches: Vec<Branch>,
    gravity: DVec3,
    widest: f64,
}

/// Fields on a grid. All vectors have an item per point of the grid: x changes fastest, then y, then z.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fields {
    /// The points.
    pub grid: Grid,
    /// Density, in mass/units³.
    pub density: Vec<f64>,
    /// Velocity, in units/s; 0 where there is no body.
    pub velocity: Vec<DVec3>,
    /// Contact stress, in mass/(units s²), positive in tension. Column i, row j: force in the direction j through a face whose
    /// normal is the axis i.
    pub contact_stress: Vec<DMat3>,
    /// Kinetic stress, in mass/(units s²).
    pub kinetic_stress: Vec<DMat3>,
    /// Granular temperature, in units²/s²: the mean square of a component of the velocity relative to `velocity`.
    pub temperature: Vec<f64>,
    /// Force density of walls, in mass/(units² s²).
    pub wall_force: Vec<DVec3>,
}

impl Fields {
    fn new(grid: Grid) -> Self {
        let count = grid.len();
        Self {
            grid,
            density: vec![0.0; count],
            velocity: vec![DVec3::ZERO; count],
            contact_stress: vec![DMat3::ZERO; count],
            kinetic_stress: vec![DMat3::ZERO; count],
            temperature: vec![0.0; count],
            wall_force: vec![DVec3::ZERO; count],
        }
    }

    /// Contact and kinetic stress together, in mass/(units s²), positive in tension.
    pub fn stress(&self) -> impl Iterator<Item = DMat3> {
        self.contact_stress.iter().zip(&self.kinetic_stress).map(|(contact, kinetic)| *contact + *kinetic)
    }

    /// Pressure, in mass/(units s²): a third of the trace of the stress, positive in compression.
    pub fn pressure(&self) -> impl Iterator<Item = f64> {
        self.stress().map(|stress| -(stress.x_axis.x + stress.y_axis.y + stress.z_axis.z) / 3.0)
    }
}

impl Sources {
    /// Takes the bodies and contacts of the current state.
    ///
    /// # Errors
    /// As for [`Simulation::contacts`].
    pub fn of(simulation: &mut Simulation) -> Result<Self> {
        let contacts = simulation.contacts()?;
        let scene = simulation.sync()?;
        let moving = scene.spheres().iter().filter(|sphere| !sphere.fixed);
        let grains: Vec<Grain> = moving
            .clone()
            .map(|sphere| Grain {
                position: sphere.position.as_dvec3(),
                velocity: sphere.velocity.as_dvec3(),
                mass: sphere.mass.into(),
            })
            .collect();
        let widest = moving.map(|sphere| 2.0 * f64::from(sphere.radius)).fold(0.0, f64::max);
        let forces = contacts.iter().filter_map(|contact| match contact.action {
            ContactAction::Force(force) => Some((contact, force.as_dvec3())),
            _ => None,
        });
        let branches = forces.filter_map(|(contact, on_b)| {
            let point = contact.point.as_dvec3();
            match (centre(scene, contact.a), centre(scene, contact.b)) {
                (Some(a), Some(b)) => Some(Branch { from: b, to: a, force: -on_b, at_wall: false }),
                (Some(a), None) => Some(Branch { from: point, to: a, force: -on_b, at_wall: true }),
                (None, Some(b)) => Some(Branch { from: point, to: b, force: on_b, at_wall: true }),
                (None, None) => None,
            }
        });
        let branches = branches.collect();
        let settings = &scene.settings;
        let gravity = f64::from(settings.gravity) * settings.gravity_direction.as_dvec3().normalize_or_zero();
        Ok(Self { grains, branches, gravity, widest })
    }

    /// Diameter of the largest moving sphere, in units: a common width of the smoothing function.
    pub fn widest(&self) -> f64 {
        self.widest
    }

    /// A grid over all moving bodies and their contacts and what their smoothing functions reach, with points `spacing` units
    /// apart.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a spacing that is not positive, without moving bodies, and for a grid of more than 10^8 points.
    pub fn grid(&self, smoothing: Smoothing, spacing: f64) -> Result<Grid> {
        let ends = || self.branches.iter().map(|branch| branch.from);
        let positions = || self.grains.iter().map(|grain| grain.position).chain(ends());
        if self.grains.is_empty() {
            return Err(Error::Invalid {
                field: "fields",
                value: "a scene without moving bodies".to_owned(),
                expected: "bodies",
            });
        }
        let reach = DVec3::splat(smoothing.reach());
        let low = positions().fold(DVec3::INFINITY, DVec3::min) - reach;
        let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max) + reach;
        Grid::between(low, high, spacing)
    }

    /// The fields on a grid.
    pub fn fields(&self, grid: Grid, smoothing: Smoothing) -> Fields {
        let mut fields = Fields::new(grid);
        let reach = smoothing.reach();
        for grain in &self.grains {
            grid.visit(grain.position, grain.position, reach, |node, point| {
                let share = grain.mass * smoothing.at(point - grain.position);
                fields.density[node] += share;
                fields.velocity[node] += share * grain.velocity;
            });
        }
        for (velocity, density) in fields.velocity.iter_mut().zip(&fields.density) {
            *velocity = if *density > 0.0 { *velocity / *density } else { DVec3::ZERO };
        }
        for grain in &self.grains {
            grid.visit(grain.position, grain.position, reach, |node, point| {
                let share = grain.mass * smoothing.at(point - grain.position);
                let own = grain.velocity - fields.velocity[node];
                fields.kinetic_stress[node] -= share * outer(own, own);
                fields.temperature[node] += share * own.length_squared() / 3.0;
            });
        }
        for (temperature, density) in fields.temperature.iter_mut().zip(&fields.density) {
            *temperature = if *density > 0.0 { *temperature / *density } else { 0.0 };
        }
        for branch in &self.branches {
            let moment = outer(branch.to - branch.from, branch.force);
            grid.visit(branch.from, branch.to, reach, |node, point| {
                fields.contact_stress[node] -= smoothing.mean(branch.from - point, branch.to - point) * moment;
                if branch.at_wall {
                    fields.wall_force[node] += smoothing.at(point - branch.from) * branch.force;
                }
            });
        }
        fields
    }

    /// div(contact stress) + wall force + rho g at a point, and rho g, in mass/(units² s²). The first is the rate at which contacts
    /// and gravity change the momentum per volume. It vanishes where bodies are at rest.
    pub fn balance(&self, point: DVec3, smoothing: Smoothing) -> [DVec3; 2] {
        // The fields are smooth, so a small step gives their derivatives to about 1e-6.
        let step = 1e-3 * smoothing.width();
        let fields = self.fields(Grid::around(point, step), smoothing);
        let at = |x: usize, y: usize, z: usize| x + 3 * (y + 3 * z);
        let along = |axis: usize, low: usize, high: usize| {
            (fields.contact_stress[high].col(axis) - fields.contact_stress[low].col(axis)) / (2.0 * step)
        };
        let divergence =
            along(0, at(0, 1, 1), at(2, 1, 1)) + along(1, at(1, 0, 1), at(1, 2, 1)) + along(2, at(1, 1, 0), at(1, 1, 2));
        let weight = fields.density[at(1, 1, 1)] * self.gravity;
        [divergence + fields.wall_force[at(1, 1, 1)] + weight, weight]
    }
}

/// Where a body is; `None` if it cannot move.
fn centre(scene: &Scene, body: Body) -> Option<DVec3> {
    match body {
        Body::Sphere(id) => scene.sphere(id).ok().filter(|sphere| !sphere.fixed).map(|sphere| sphere.position.as_dvec3()),
        Body::Rod(id) => {
            let rod = scene.rod(id).ok()?;
            let [one, other] = [scene.sphere(rod.end1).ok()?, scene.sphere(rod.end2).ok()?];
            (!(one.fixed && other.fixed)).then(|| 0.5 * (one.position.as_dvec3() + other.position.as_dvec3()))
        }
        _ => None,
    }
}

/// The matrix a b^T transposed: column i is a_i b.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a.x * b, a.y * b, a.z * b)
}
