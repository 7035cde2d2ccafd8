//! Solves the collisions that share bodies, and those on networks, by sweeps (docs/physics sections 3.7 and 3.8). A cluster
//! of two collisions has a closed form.
//!
//! A sweep computes all impulses from those of the sweep before, so the order of the collisions does not matter:
//! `j <- max(0, j + s ((1 + e) u - du) / Gt)`. Here u is the approach velocity before all impulses, and du is what all impulses
//! together have taken from it.
//!
//! The scale Gt is so large that the matrix G of the effects of all impulses is at most diag(Gt). For this, the couplings with
//! the collisions on each body are added up (Gershgorin), or a bound of this sum. The factors s of the sweeps follow from Chebyshev polynomials.

use glam::{DVec3, Vec3};

use crate::model::impulse::Impulse;
use crate::model::layout::{SWEEP_SIZES, SWEEPS};
use crate::model::view::View;
use crate::physics::collision::body::{Body, Capsule, Part};
use crate::physics::collision::networks::Network;
use crate::physics::collision::{Change, Collision, pair};
use crate::physics::pairs::Surface;

/// Rods keep a contact from moving when its inverse mass is less than this fraction of the value before the projection. It
/// gets no impulse.
const BLOCKED: f32 = 1e-6;

/// A body, and the number of a collision that touches it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Touching {
    pub(super) body: Body,
    pub(super) collision: usize,
}

/// The effects of a cluster: impulses in the order of its members, and changes of spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    pub(super) impulses: Vec<Impulse>,
    pub(super) changes: Vec<Change>,
    /// Whether the rods of a network could not be solved.
    pub(super) is_unsolved: bool,
}

/// A body, and its changes by the impulses.
enum Moved {
    Sphere { sphere: u32, inverse_mass: f32, velocity: Vec3 },
    Capsule { capsule: Capsule, velocity: Vec3, spin: Vec3 },
    Network { network: Network, impulses: Vec<DVec3>, velocities: Vec<DVec3> },
}

impl Moved {
    fn of(view: &View, body: Body) -> Self {
        match body {
            Body::Sphere(sphere) => Self::Sphere { sphere, inverse_mass: view.inverse_mass(sphere), velocity: Vec3::ZERO },
            Body::Capsule(rod) => {
                Self::Capsule { capsule: Capsule::of(view, view, rod), velocity: Vec3::ZERO, spin: Vec3::ZERO }
            }
            Body::Network(number) => {
                let network = Network::of(view, number);
                let none = vec![DVec3::ZERO; network.spheres.len()];
                Self::Network { network, impulses: none.clone(), velocities: none }
            }
        }
    }

    /// Removes all impulses.
    fn clear(&mut self) {
        match self {
            Self::Sphere { velocity, .. } => *velocity = Vec3::ZERO,
            Self::Capsule { velocity, spin, .. } => (*velocity, *spin) = (Vec3::ZERO, Vec3::ZERO),
            Self::Network { impulses, .. } => impulses.fill(DVec3::ZERO),
        }
    }

    /// Adds an impulse of this size along the normal n of a contact.
    fn push(&mut self, part: &Part, n: Vec3, size: f32) {
        match self {
            Self::Sphere { inverse_mass, velocity, .. } => *velocity += size * part.shares[0].1 * *inverse_mass * n,
            Self::Capsule { capsule, velocity, spin } => {
                *velocity += size / capsule.mass * n;
                *spin += size / capsule.inertia_across * part.torque;
            }
            Self::Network { network, impulses, .. } => {
                each_place(network, part, |place, share| impulses[place] += f64::from(size * share) * n.as_dvec3());
            }
        }
    }

    /// Computes the changes by all impulses on a network. Other bodies are up to date already.
    fn update(&mut self) {
        if let Self::Network { network, impulses, velocities } = self {
            *velocities = network.project(impulses);
        }
    }

    /// The change of the velocity of a contact's point along n.
    fn velocity(&self, part: &Part, n: Vec3) -> f32 {
        match self {
            Self::Sphere { velocity, .. } => part.shares[0].1 * n.dot(*velocity),
            Self::Capsule { velocity, spin, .. } => n.dot(*velocity) + part.torque.dot(*spin),
            Self::Network { network, velocities, .. } => {
                let mut along = 0.0;
                each_place(network, part, |place, share| along += f64::from(share) * n.as_dvec3().dot(velocities[place]));
                along as f32
            }
        }
    }

    /// The change of the velocity along n by a unit impulse. On a network, the call discards all impulses added so far.
    fn inverse_mass(&mut self, part: &Part, n: Vec3) -> f32 {
        if !matches!(self, Self::Network { .. }) {
            return part.inverse_mass;
        }
        self.clear();
        self.push(part, n, 1.0);
        self.update();
        self.velocity(part, n)
    }

    /// A bound of the sum, over all collisions that touch the body, of their couplings with a collision of normal n. The collision
    /// itself is included. The body has just computed the effect of its unit impulse, `inverse_mass`.
    fn sum_of_couplings(&self, body: Body, n: Vec3, inverse_mass: f32, all: &[Collision], touching: &[Touching]) -> f32 {
        let here = of_body(body, touching);
        match self {
            Self::Sphere { .. } => inverse_mass * here.map(|other| n.dot(all[other.collision].touch.normal).abs()).sum::<f32>(),
            Self::Capsule { .. } => inverse_mass * here.count() as f32,
            Self::Network { .. } => {
                let mut others: Vec<usize> = here.map(|other| other.collision).collect();
                others.dedup();
                let sides =
                    others.iter().flat_map(|other| all[*other].parts().iter().map(|part| (part, all[*other].touch.normal)));
                sides.filter(|(part, _)| part.body == body).map(|(part, n)| self.velocity(part, n).abs()).sum()
            }
        }
    }

    fn put_changes(&self, outcome: &mut Outcome) {
        let changes = &mut outcome.changes;
        match self {
            Self::Sphere { sphere, velocity, .. } => {
                changes.push(Change { sphere: *sphere, velocity: *velocity, ..Change::default() });
            }
            Self::Capsule { capsule, velocity, spin } => {
                let velocities = capsule.end_velocities(*velocity, *spin);
                changes.extend((0..2).map(|end| Change {
                    sphere: capsule.ends[end],
                    position: Vec3::ZERO,
                    velocity: velocities[end],
                    angular_momentum: capsule.inertia[end] * *spin,
                }));
            }
            Self::Network { network, velocities, .. } => {
                let of = |(sphere, velocity): (&u32, &DVec3)| Change {
                    sphere: *sphere,
                    velocity: velocity.as_vec3(),
                    ..Change::default()
                };
                changes.extend(network.spheres.iter().zip(velocities).map(of));
            }
        }
    }
}

/// Calls `take` for each sphere that gets a share of a part, with the place of the sphere in the network and the share.
fn each_place(network: &Network, part: &Part, mut take: impl FnMut(usize, f32)) {
    for (sphere, share) in part.shares.into_iter().filter(|(_, share)| *share != 0.0) {
        if let Some(place) = network.place(sphere) {
            take(place, share);
        }
    }
}

/// A collision of the cluster.
struct Row<'a> {
    collision: &'a Collision,
    /// The bodies of its parts, by their places in the cluster.
    bodies: [usize; 4],
    /// The scale Gt, or 0 if rods keep the contact from moving.
    scale: f32,
    /// Whether it is the only collision on its bodies and touches each of them with one side only.
    is_only: bool,
    restitution: f32,
    impulse: f32,
}

impl Row<'_> {
    fn parts(&self) -> impl Iterator<Item = (&Part, usize)> {
        self.collision.parts().iter().zip(self.bodies)
    }

    /// What the changes of the bodies have taken from the approach velocity.
    fn reduction(&self, moved: &[Moved]) -> f32 {
        self.parts().map(|(part, place)| part.sign * moved[place].velocity(part, self.collision.touch.normal)).sum()
    }

    /// What the impulses have to take from the approach velocity, where this one is not 0.
    fn wanted(&self) -> f32 {
        (1.0 + self.restitution) * self.collision.approach
    }
}

/// Solves a cluster. `members` are the numbers of its collisions in `all`.
pub(super) fn solve(view: &View, all: &[Collision], touching: &[Touching], members: &[usize]) -> Outcome {
    let mut bodies: Vec<Body> = members.iter().flat_map(|member| all[*member].parts()).map(|part| part.body).collect();
    bodies.sort_unstable();
    bodies.dedup();
    let mut moved: Vec<Moved> = bodies.iter().map(|body| Moved::of(view, *body)).collect();
    let mut rows: Vec<Row> = members
        .iter()
        .map(|member| {
            let collision = &all[*member];
            let restitution = Surface::of(view, collision.a, collision.b).restitution;
            let mut row = Row { collision, bodies: [0; 4], scale: 0.0, is_only: false, restitution, impulse: 0.0 };
            for (place, part) in row.bodies.iter_mut().zip(collision.parts()) {
                *place = bodies.binary_search(&part.body).unwrap_or_default();
            }
            row.scale = scale_of(&row, &mut moved, all, touching);
            row.is_only = collision.parts().iter().all(|part| of_body(part.body, touching).count() == 1);
            row
        })
        .collect();
    if let Some(impulses) = pair_impulses(&rows, &mut moved, touching) {
        rows.iter_mut().zip(impulses).for_each(|(row, impulse)| row.impulse = impulse);
        update_bodies(&rows, &mut moved);
    } else {
        sweep_all(&mut rows, &mut moved);
    }
    let of = |row: &Row| Impulse { key: row.collision.key(view), size: row.impulse, direction: row.collision.touch.normal };
    let mut outcome = Outcome { impulses: rows.iter().map(of).collect(), ..Outcome::default() };
    for body in &moved {
        body.put_changes(&mut outcome);
        outcome.is_unsolved |= matches!(body, Moved::Network { network, .. } if network.is_unsolved);
    }
    outcome
}

/// The impulses of two collisions that are the only ones on their bodies, none of which is a network, and share one of these
/// bodies.
fn pair_impulses(rows: &[Row], moved: &mut [Moved], touching: &[Touching]) -> Option<[f32; 2]> {
    let [one, other] = rows else { return None };
    let has_one_neighbour = |row: &Row| {
        let others = row.collision.parts().iter().map(|part| of_body(part.body, touching).count() - 1);
        others.sum::<usize>() == 1
    };
    let is_network = |body: &Moved| matches!(body, Moved::Network { .. });
    if moved.iter().any(is_network) || !(has_one_neighbour(one) && has_one_neighbour(other)) {
        return None;
    }
    let by_unit = [one, other].map(|row| {
        moved.iter_mut().for_each(Moved::clear);
        row.parts().for_each(|(part, place)| moved[place].push(part, row.collision.touch.normal, part.sign));
        [one.reduction(moved), other.reduction(moved)]
    });
    let coupling = [[by_unit[0][0], by_unit[1][0]], [by_unit[0][1], by_unit[1][1]]];
    pair::impulses(coupling, [one.wanted(), other.wanted()])
}

/// Solves the collisions by sweeps.
fn sweep_all(rows: &mut [Row], moved: &mut [Moved]) {
    moved.iter_mut().for_each(|body| {
        body.clear();
        body.update();
    });
    for number in 0..SWEEPS as usize {
        let has_changed = sweep(rows, moved, SWEEP_SIZES[number / 2]);
        if !has_changed {
            break;
        }
        update_bodies(rows, moved);
    }
}

/// The scale Gt of a collision, or 0 if rods keep the contact from moving.
fn scale_of(row: &Row, moved: &mut [Moved], all: &[Collision], touching: &[Touching]) -> f32 {
    let n = row.collision.touch.normal;
    let (mut scale, mut total_inverse_mass) = (0.0, 0.0);
    for (part, place) in row.parts() {
        let inverse_mass = moved[place].inverse_mass(part, n);
        scale += moved[place].sum_of_couplings(part.body, n, inverse_mass, all, touching);
        total_inverse_mass += inverse_mass;
    }
    if total_inverse_mass < BLOCKED * row.collision.inverse_mass() { 0.0 } else { scale }
}

/// The collisions that touch a body.
fn of_body(body: Body, touching: &[Touching]) -> impl Iterator<Item = &Touching> {
    let first = touching.partition_point(|touching| touching.body < body);
    touching[first..].iter().take_while(move |touching| touching.body == body)
}

/// Makes one sweep. Returns whether any impulse has changed.
fn sweep(rows: &mut [Row], moved: &[Moved], factor: f32) -> bool {
    let mut has_changed = false;
    for row in rows.iter_mut().filter(|row| row.scale > 0.0) {
        let factor = if row.is_only { 1.0 } else { factor };
        let impulse = (row.impulse + (row.wanted() - row.reduction(moved)) * factor / row.scale).max(0.0);
        has_changed |= impulse != row.impulse;
        row.impulse = impulse;
    }
    has_changed
}

/// Computes the changes of all bodies by all impulses.
fn update_bodies(rows: &[Row], moved: &mut [Moved]) {
    moved.iter_mut().for_each(Moved::clear);
    for row in rows {
        for (part, place) in row.parts() {
            moved[place].push(part, row.collision.touch.normal, part.sign * row.impulse);
        }
    }
    moved.iter_mut().for_each(Moved::update);
}
