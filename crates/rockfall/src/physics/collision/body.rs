//! The bodies of the collision phase, and what an impulse does to them (docs/physics sections 1.4 and 3.3).

use glam::Vec3;

use crate::model::lists::Lists;
use crate::model::view::View;
use crate::physics::geometry::scale;
use crate::physics::touch::Motions;

/// A unit that an impulse moves as a whole. Fixed spheres, boxes and polygons are not bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Body {
    /// A single sphere. Rods of free length may end in it.
    Sphere(u32),
    /// A rigid capsule, by the index of its rod.
    Capsule(u32),
    /// A network, by its number: moving spheres that are connected by rods of fixed length.
    Network(u32),
}

impl Body {
    /// The body that a sphere belongs to. `None` for a fixed sphere.
    pub(crate) fn of(view: &View, sphere: u32) -> Option<Self> {
        if view.is_fixed(sphere) {
            return None;
        }
        if let Some(rod) = view.capsule_of(sphere) {
            return Some(Self::Capsule(rod));
        }
        let network = view.rods_of(sphere).find_map(|rod| view.network_of(rod));
        Some(network.map_or(Self::Sphere(sphere), Self::Network))
    }

    /// Calls `take` for each mover whose contacts touch the body: its spheres, and the rods that end in them.
    pub(crate) fn each_row(self, view: &View, mut take: impl FnMut(u32)) {
        match self {
            Self::Sphere(sphere) => sphere_rows(view, sphere).for_each(take),
            Self::Capsule(rod) => {
                let [one, two] = view.rod(rod).ends;
                [one, two, view.step.layout.spheres + rod].into_iter().for_each(take);
            }
            Self::Network(network) => {
                let (spheres, rods) = view.network(network);
                rods.iter().for_each(|rod| take(view.step.layout.spheres + rod));
                for sphere in spheres {
                    take(sphere);
                    let free = view.rods_of(sphere).filter(|rod| view.network_of(*rod) != Some(network));
                    free.for_each(|rod| take(view.step.layout.spheres + rod));
                }
            }
        }
    }
}

/// The movers whose contacts touch a sphere: itself and its rods.
pub(crate) fn sphere_rows(view: &View, sphere: u32) -> impl Iterator<Item = u32> {
    let spheres = view.step.layout.spheres;
    std::iter::once(sphere).chain(view.rods_of(sphere).map(move |rod| spheres + rod))
}

/// The effect of a contact's impulse, along its normal n, on one of its bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) body: Body,
    /// -1 on side A, +1 on side B.
    pub(crate) sign: f32,
    /// The spheres that get the impulse, and their shares of it. For a capsule, its ends; their shares are not used.
    pub(crate) shares: [(u32, f32); 2],
    /// For a capsule: the torque of a unit impulse about its centre of mass.
    pub(crate) torque: Vec3,
    /// The change of the velocity along n by a unit impulse. For a network, the value before the projection.
    pub(crate) inverse_mass: f32,
}

impl Part {
    pub(crate) const NONE: Self =
        Self { body: Body::Sphere(0), sign: 0.0, shares: [(0, 0.0); 2], torque: Vec3::ZERO, inverse_mass: 0.0 };

    /// The part of a sphere that is not the end of a capsule.
    pub(crate) fn of_sphere(view: &View, body: Body, sphere: u32, share: f32, sign: f32) -> Self {
        let inverse_mass = share * share * view.inverse_mass(sphere);
        Self { body, sign, shares: [(sphere, share), (sphere, 0.0)], torque: Vec3::ZERO, inverse_mass }
    }

    /// Combines the parts of two spheres of one network.
    pub(crate) fn and(self, other: Self) -> Self {
        let shares = [self.shares[0], other.shares[0]];
        Self { shares, inverse_mass: self.inverse_mass + other.inverse_mass, ..self }
    }
}

/// A rigid capsule: a rod and the spheres at its ends, which move as one rigid body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    pub(crate) rod: u32,
    pub(crate) ends: [u32; 2],
    /// Mass M of both ends.
    pub(crate) mass: f32,
    /// m2 / M: the position of the centre of mass on the axis, 0 at end 1 and 1 at end 2.
    pub(crate) centre: f32,
    /// Moments of inertia of the ends.
    pub(crate) inertia: [f32; 2],
    /// Moment of inertia about the centre of mass, across the axis: It = mu d.d + I1 + I2.
    pub(crate) inertia_across: f32,
    /// From end 1 to end 2.
    pub(crate) d: Vec3,
    /// Velocity of end 2 relative to end 1.
    pub(crate) q: Vec3,
    /// Velocity of the centre of mass.
    pub(crate) velocity: Vec3,
    /// Angular velocity across the axis.
    pub(crate) spin: Vec3,
}

impl Capsule {
    /// The capsule of a rod, with the positions and velocities of the state `at`.
    pub(crate) fn of(view: &View, at: &impl Motions, rod: u32) -> Self {
        let ends = view.rod(rod).ends;
        let [w1, w2] = ends.map(|end| view.inverse_mass(end));
        let inertia = ends.map(|end| 1.0 / view.inverse_inertia(end));
        let [v1, v2] = ends.map(|end| at.velocity(end));
        // m2 / M. This form is accurate even if the masses differ greatly.
        let centre = w1 / (w1 + w2);
        // mu = m1 m2 / M.
        let reduced_mass = 1.0 / (w1 + w2);
        let d = at.between(ends[0], ends[1]);
        let inertia_across = reduced_mass * d.length_squared() + inertia[0] + inertia[1];
        let q = v2 - v1;
        let whole = reduced_mass * d.cross(q) + ends.map(|end| view.angular_momentum(end)).into_iter().sum::<Vec3>();
        let mut capsule = Self {
            rod,
            ends,
            mass: 1.0 / w1 + 1.0 / w2,
            centre,
            inertia,
            inertia_across,
            d,
            q,
            velocity: v1 + centre * q,
            spin: Vec3::ZERO,
        };
        capsule.spin = capsule.across(whole) / inertia_across;
        capsule
    }

    /// The part of a vector across the axis.
    pub(crate) fn across(&self, v: Vec3) -> Vec3 {
        let d = scale(self.d) * self.d;
        v - v.dot(d) / d.length_squared() * d
    }

    /// The lever arm of a place on the axis about the centre of mass, in units of the length of the axis. The place is 0 at
    /// end 1 and 1 at end 2.
    pub(crate) fn lever(&self, place: f32) -> f32 {
        place - self.centre
    }

    /// The torque of the impulse p at a place on the axis, about the centre of mass.
    pub(crate) fn torque(&self, place: f32, p: Vec3) -> Vec3 {
        (self.lever(place) * self.d).cross(p)
    }

    /// The effect of a unit impulse with this torque. The sign is left at 0.
    pub(crate) fn part(&self, torque: Vec3) -> Part {
        let shares = self.ends.map(|end| (end, 0.0));
        let inverse_mass = 1.0 / self.mass + torque.length_squared() / self.inertia_across;
        Part { body: Body::Capsule(self.rod), sign: 0.0, shares, torque, inverse_mass }
    }

    /// The changes of the ends' velocities that follow from these changes of the velocity of the centre of mass and of the
    /// angular velocity across the axis.
    pub(crate) fn end_velocities(&self, velocity: Vec3, spin: Vec3) -> [Vec3; 2] {
        let q = spin.cross(self.d);
        [velocity - self.centre * q, velocity + (1.0 - self.centre) * q]
    }
}

/// Finds out which spheres the collisions of a step change.
pub(crate) struct TakingPart<'a> {
    view: &'a View<'a>,
    lists: &'a Lists<'a>,
    /// For each network, whether one of its contacts collides.
    networks: Vec<bool>,
}

impl<'a> TakingPart<'a> {
    pub(crate) fn new(view: &'a View<'a>, lists: &'a Lists<'a>) -> Self {
        let networks = (0..view.step.layout.networks).map(|network| collides(view, lists, Body::Network(network))).collect();
        Self { view, lists, networks }
    }

    /// Whether a contact of the sphere's body collides.
    pub(crate) fn has(&self, sphere: u32) -> bool {
        let Self { view, lists, networks } = self;
        // The sphere's own list decides in nearly all cases.
        lists.collides(sphere)
            || view.step.layout.rods > 0
                && match Body::of(view, sphere) {
                    None => false,
                    Some(Body::Network(network)) => networks[network as usize],
                    Some(body) => collides(view, lists, body),
                }
    }
}

fn collides(view: &View, lists: &Lists, body: Body) -> bool {
    let mut collides = false;
    body.each_row(view, |row| collides |= lists.collides(row));
    collides
}
