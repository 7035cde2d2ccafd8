//! The bodies of the collision phase, and what an impulse does to them (docs/physics.md sections 1.4 and 3.3).

use glam::Vec3;

use crate::model::lists::Lists;
use crate::model::view::View;
use crate::physics::touch::Motions;

/// What an impulse moves as a whole. What is fixed or static is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Body {
    /// A sphere by itself; rods of free length may end in it.
    Sphere(u32),
    /// A rigid capsule, by its rod.
    Capsule(u32),
    /// Moving spheres joined by rods of fixed length, by the number of their network.
    Network(u32),
}

impl Body {
    /// The body that a sphere belongs to.
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

    /// Hands over the movers whose contacts touch the body: its spheres, and the rods that end in them.
    pub(crate) fn each_row(self, view: &View, mut take: impl FnMut(u32)) {
        match self {
            Self::Sphere(sphere) => sphere_rows(view, sphere).for_each(take),
            Self::Capsule(rod) => {
                let [one, two] = view.rod(rod).ends;
                [one, two, view.step.spheres + rod].into_iter().for_each(take);
            }
            Self::Network(network) => {
                let (spheres, rods) = view.network(network);
                rods.iter().for_each(|rod| take(view.step.spheres + rod));
                for sphere in spheres {
                    take(sphere);
                    let free = view.rods_of(sphere).filter(|rod| view.network_of(*rod) != Some(network));
                    free.for_each(|rod| take(view.step.spheres + rod));
                }
            }
        }
    }
}

/// The movers whose contacts touch a sphere: itself and its rods.
pub(crate) fn sphere_rows(view: &View, sphere: u32) -> impl Iterator<Item = u32> {
    let spheres = view.step.spheres;
    std::iter::once(sphere).chain(view.rods_of(sphere).map(move |rod| spheres + rod))
}

/// What a contact's impulse, along its normal n, does to one of its bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) body: Body,
    /// -1 on side A, +1 on side B.
    pub(crate) sign: f32,
    /// The spheres that share in it, and how much each gets; of a capsule, its ends.
    pub(crate) shares: [(u32, f32); 2],
    /// Of a capsule: the couple of a unit impulse about its centre.
    pub(crate) torque: Vec3,
    /// What a unit impulse changes the velocity along n by; of a network, as if its spheres were loose.
    pub(crate) inverse_mass: f32,
}

impl Part {
    pub(crate) const NONE: Self =
        Self { body: Body::Sphere(0), sign: 0.0, shares: [(0, 0.0); 2], torque: Vec3::ZERO, inverse_mass: 0.0 };

    /// A sphere that is no capsule's end.
    pub(crate) fn of_sphere(view: &View, body: Body, sphere: u32, share: f32, sign: f32) -> Self {
        let inverse_mass = share * share * view.inverse_mass(sphere);
        Self { body, sign, shares: [(sphere, share), (sphere, 0.0)], torque: Vec3::ZERO, inverse_mass }
    }

    /// Two spheres of one network.
    pub(crate) fn and(self, other: Self) -> Self {
        let shares = [self.shares[0], other.shares[0]];
        Self { shares, inverse_mass: self.inverse_mass + other.inverse_mass, ..self }
    }
}

/// A rigid capsule: two spheres on a rod that turn as one body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    pub(crate) rod: u32,
    pub(crate) ends: [u32; 2],
    /// M.
    pub(crate) mass: f32,
    /// Where the centre of mass is on the axis, from end 1: m2 / M; the lever of end 1.
    pub(crate) centre: f32,
    /// Moments of inertia of the ends.
    pub(crate) inertia: [f32; 2],
    /// It = mu d.d + I1 + I2, about the centre, across the axis.
    pub(crate) inertia_across: f32,
    /// From end 1 to end 2.
    pub(crate) d: Vec3,
    /// Velocity of end 2 against end 1.
    pub(crate) q: Vec3,
    /// Velocity of the centre of mass.
    pub(crate) velocity: Vec3,
    /// Angular velocity across the axis.
    pub(crate) spin: Vec3,
}

impl Capsule {
    /// The capsule of a rod in a state.
    pub(crate) fn of(view: &View, at: &impl Motions, rod: u32) -> Self {
        let ends = view.rod(rod).ends;
        let [w1, w2] = ends.map(|end| view.inverse_mass(end));
        let inertia = ends.map(|end| 1.0 / view.inverse_inertia(end));
        let [v1, v2] = ends.map(|end| at.velocity(end));
        // m2 / M, also where masses are far apart.
        let centre = w1 / (w1 + w2);
        // mu = m1 m2 / M.
        let reduced_mass = 1.0 / (w1 + w2);
        let d = at.position(ends[1]) - at.position(ends[0]);
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

    /// A vector without what it has along the axis.
    pub(crate) fn across(&self, v: Vec3) -> Vec3 {
        v - v.dot(self.d) / self.d.length_squared() * self.d
    }

    /// The lever of a place on the axis, 0 at end 1 and 1 at end 2, in lengths of the axis.
    pub(crate) fn lever(&self, place: f32) -> f32 {
        place - self.centre
    }

    /// The couple of the impulse p at a place on the axis, about the centre of mass.
    pub(crate) fn torque(&self, place: f32, p: Vec3) -> Vec3 {
        (self.lever(place) * self.d).cross(p)
    }

    /// What a unit impulse of that couple does.
    pub(crate) fn part(&self, torque: Vec3) -> Part {
        let shares = self.ends.map(|end| (end, 0.0));
        let inverse_mass = 1.0 / self.mass + torque.length_squared() / self.inertia_across;
        Part { body: Body::Capsule(self.rod), sign: 0.0, shares, torque, inverse_mass }
    }

    /// Changes of the ends' velocities from those of the centre and of the angular velocity across the axis.
    pub(crate) fn end_velocities(&self, velocity: Vec3, spin: Vec3) -> [Vec3; 2] {
        let q = spin.cross(self.d);
        [velocity - self.centre * q, velocity + (1.0 - self.centre) * q]
    }
}

/// Which spheres the collisions of a step change.
pub(crate) struct TakingPart<'a> {
    view: &'a View<'a>,
    lists: &'a Lists<'a>,
    /// By network.
    networks: Vec<bool>,
}

impl<'a> TakingPart<'a> {
    pub(crate) fn new(view: &'a View<'a>, lists: &'a Lists<'a>) -> Self {
        let networks = (0..view.step.networks).map(|network| collides(view, lists, Body::Network(network))).collect();
        Self { view, lists, networks }
    }

    /// Whether some contact of the sphere's body collides.
    pub(crate) fn has(&self, sphere: u32) -> bool {
        let Self { view, lists, networks } = self;
        // Nearly all are told by their own list.
        lists.collides(sphere)
            || view.step.rods > 0
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
