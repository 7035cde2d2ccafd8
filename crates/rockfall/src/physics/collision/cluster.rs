//! Collisions that share bodies, and those on networks: swept until their impulses agree (docs/physics.md sections 3.7 and 3.8).
//!
//! All impulses of a sweep are found from those of the one before, so that the order does not count:
//! `j <- max(0, j + s ((1 + e) u - du) / Gt)`, du what all impulses together have taken off the approach velocity u. Gt is so large that
//! the matrix G of the effects of all impulses is at most diag(Gt): per body, each collision counts as often as others are coupled with it
//! (Gershgorin). The sizes s of the sweeps are those of Chebyshev's polynomials.

use glam::{DVec3, Vec3};

use crate::model::impulse::Impulse;
use crate::model::layout::{SWEEP_SIZES, SWEEPS};
use crate::model::view::View;
use crate::physics::collision::body::{Body, Capsule, Part};
use crate::physics::collision::networks::Network;
use crate::physics::collision::{Change, Collision};

/// A contact that gives way by less than this part of what it would between loose spheres gets no impulse: rods are in the way.
const BLOCKED: f32 = 1e-6;

/// That a collision touches a body, by the collision's place among all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Touching {
    pub(super) body: Body,
    pub(super) collision: usize,
}

/// What a cluster's collisions do: its impulses in the order of its members, and the changes of spheres.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    pub(super) impulses: Vec<Impulse>,
    pub(super) changes: Vec<Change>,
}

/// A body and what impulses have changed of it.
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

    /// As if there had been no impulse.
    fn clear(&mut self) {
        match self {
            Self::Sphere { velocity, .. } => *velocity = Vec3::ZERO,
            Self::Capsule { velocity, spin, .. } => (*velocity, *spin) = (Vec3::ZERO, Vec3::ZERO),
            Self::Network { impulses, .. } => impulses.fill(DVec3::ZERO),
        }
    }

    /// Adds an impulse of this size along a contact's normal n.
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

    /// Works out what all impulses change together.
    fn settle(&mut self) {
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

    /// What a unit impulse changes the velocity along n by.
    fn inverse_mass(&mut self, part: &Part, n: Vec3) -> f32 {
        if !matches!(self, Self::Network { .. }) {
            return part.inverse_mass;
        }
        self.clear();
        self.push(part, n, 1.0);
        self.settle();
        self.velocity(part, n)
    }

    fn changes(&self, changes: &mut Vec<Change>) {
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

/// Hands over the places in a network of what shares in a part.
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
    /// Its parts' bodies, by their places in the cluster.
    bodies: [usize; 4],
    /// Gt; 0: it gets no impulse.
    yielding: f32,
    /// No other collision touches its bodies.
    is_only: bool,
    impulse: f32,
}

impl Row<'_> {
    fn parts(&self) -> impl Iterator<Item = (&Part, usize)> {
        self.collision.parts().iter().zip(self.bodies)
    }
}

/// The collisions of a cluster, of which `members` are the places among all.
pub(super) fn solve(view: &View, all: &[Collision], touching: &[Touching], members: &[usize]) -> Outcome {
    let mut bodies: Vec<Body> = members.iter().flat_map(|member| all[*member].parts()).map(|part| part.body).collect();
    bodies.sort_unstable();
    bodies.dedup();
    let mut moved: Vec<Moved> = bodies.iter().map(|body| Moved::of(view, *body)).collect();
    let mut rows: Vec<Row> = members
        .iter()
        .map(|member| {
            let collision = &all[*member];
            let mut row = Row { collision, bodies: [0; 4], yielding: 0.0, is_only: false, impulse: 0.0 };
            for (place, part) in row.bodies.iter_mut().zip(collision.parts()) {
                *place = bodies.binary_search(&part.body).unwrap_or_default();
            }
            row.yielding = yielding(&row, &mut moved, all, touching);
            row.is_only = collision.parts().iter().all(|part| of_body(part.body, touching).count() == 1);
            row
        })
        .collect();
    moved.iter_mut().for_each(|body| {
        body.clear();
        body.settle();
    });
    for number in 0..SWEEPS as usize {
        let has_changed = sweep(&mut rows, &moved, view.step.restitution, SWEEP_SIZES[number / 2]);
        if !has_changed {
            break;
        }
        push_all(&rows, &mut moved);
    }
    let of = |row: &Row| Impulse { key: row.collision.key(view), size: row.impulse, direction: row.collision.touch.normal };
    let mut outcome = Outcome { impulses: rows.iter().map(of).collect(), changes: Vec::new() };
    moved.iter().for_each(|body| body.changes(&mut outcome.changes));
    outcome
}

/// Gt of a collision, 0 where rods keep it from giving way.
fn yielding(row: &Row, moved: &mut [Moved], all: &[Collision], touching: &[Touching]) -> f32 {
    let n = row.collision.touch.normal;
    let (mut yielding, mut together) = (0.0, 0.0);
    for (part, place) in row.parts() {
        let inverse_mass = moved[place].inverse_mass(part, n);
        yielding += coupled(part.body, n, all, touching) * inverse_mass;
        together += inverse_mass;
    }
    if together < BLOCKED * row.collision.inverse_mass() { 0.0 } else { yielding }
}

/// N: as how many collisions those that touch a body count beside one of normal n, itself included.
fn coupled(body: Body, n: Vec3, all: &[Collision], touching: &[Touching]) -> f32 {
    let here = of_body(body, touching);
    match body {
        Body::Sphere(_) => here.map(|touching| n.dot(all[touching.collision].touch.normal).abs()).sum(),
        Body::Capsule(_) | Body::Network(_) => here.count() as f32,
    }
}

/// What touches a body.
fn of_body(body: Body, touching: &[Touching]) -> impl Iterator<Item = &Touching> {
    let first = touching.partition_point(|touching| touching.body < body);
    touching[first..].iter().take_while(move |touching| touching.body == body)
}

/// One sweep; whether any impulse has changed at all.
fn sweep(rows: &mut [Row], moved: &[Moved], restitution: f32, size: f32) -> bool {
    let mut has_changed = false;
    for row in rows.iter_mut().filter(|row| row.yielding > 0.0) {
        let n = row.collision.touch.normal;
        let gained: f32 = row.parts().map(|(part, place)| part.sign * moved[place].velocity(part, n)).sum();
        let approach = row.collision.approach;
        let size = if row.is_only { 1.0 } else { size };
        let impulse = (row.impulse + ((1.0 + restitution) * approach - gained) * size / row.yielding).max(0.0);
        has_changed |= impulse != row.impulse;
        row.impulse = impulse;
    }
    has_changed
}

/// The changes of all bodies by all impulses.
fn push_all(rows: &[Row], moved: &mut [Moved]) {
    moved.iter_mut().for_each(Moved::clear);
    for row in rows {
        for (part, place) in row.parts() {
            moved[place].push(part, row.collision.touch.normal, part.sign * row.impulse);
        }
    }
    moved.iter_mut().for_each(Moved::settle);
}
