//! All collisions of a step: which of them are lone, which share bodies, and their combined effects (docs/physics
//! sections 3.5 and 3.7).
//!
//! Every sum runs in insertion order, so the result depends neither on the order in memory nor on the number of threads.

use glam::Vec3;
use rayon::prelude::*;

use crate::disjoint::DisjointSets;
use crate::model::impulse::{Impulse, Key};
use crate::model::layout::GRAIN;
use crate::model::layout::{ENTRY_COLLIDES, ENTRY_OVERLAPS};
use crate::model::lists::Lists;
use crate::model::view::{Object, View};
use crate::physics::chain::touch;
use crate::physics::collision::body::Body;
use crate::physics::collision::cluster;
use crate::physics::collision::cluster::Touching;
use crate::physics::collision::{Change, Collision, lone};

/// Smallest number of collisions per parallel task.
const MIN_PER_TASK: usize = 16;
/// Normals are at right angles when the absolute cosine of their angle is at most this.
const RIGHT_ANGLE: f32 = 0.001;

/// The effects of the collisions of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outcome {
    /// Sorted by key.
    pub(crate) impulses: Vec<Impulse>,
    /// Sorted by sphere. Changes of one sphere are in the order in which they are summed.
    changes: Vec<Change>,
    /// Whether the rods of a network could not be solved.
    pub(crate) is_unsolved: bool,
}

impl Outcome {
    /// The sum of the changes of a sphere.
    pub(crate) fn change(&self, sphere: u32) -> Change {
        let first = self.changes.partition_point(|change| change.sphere < sphere);
        let own = self.changes[first..].iter().take_while(|change| change.sphere == sphere);
        own.fold(Change { sphere, ..Change::default() }, |sum, change| Change {
            sphere,
            position: sum.position + change.position,
            velocity: sum.velocity + change.velocity,
            angular_momentum: sum.angular_momentum + change.angular_momentum,
        })
    }
}

/// The impulse that a contact got, if any.
pub(crate) fn impulse_in(impulses: &[Impulse], key: Key) -> Option<&Impulse> {
    impulses.binary_search_by_key(&key, |impulse| impulse.key).ok().map(|place| &impulses[place])
}

/// Solves all collisions that are marked in the lists.
pub(crate) fn solve(view: &View, lists: &Lists) -> Outcome {
    let collisions = collisions(view, lists);
    let are_lone: Vec<bool> = collisions.par_iter().with_min_len(MIN_PER_TASK).map(|k| is_lone(view, lists, k)).collect();
    let lone = collisions.par_iter().zip(&are_lone).with_min_len(MIN_PER_TASK).filter(|(_, is_lone)| **is_lone);
    let lone: Vec<lone::Outcome> = lone.map(|(k, _)| lone::solve(view, k)).collect();
    let mut outcome = Outcome {
        impulses: lone.iter().map(|lone| lone.impulse).collect(),
        changes: lone.iter().flat_map(|lone| lone.changes()).copied().collect(),
        is_unsolved: false,
    };
    if lone.len() < collisions.len() {
        let touching = touching(&collisions);
        let clusters = clusters(&touching, &are_lone);
        let solved: Vec<cluster::Outcome> =
            clusters.par_iter().map(|members| cluster::solve(view, &collisions, &touching, members)).collect();
        for cluster in solved {
            outcome.impulses.extend(cluster.impulses);
            outcome.changes.extend(cluster.changes);
            outcome.is_unsolved |= cluster.is_unsolved;
        }
    }
    outcome.impulses.par_sort_unstable_by_key(|impulse| impulse.key);
    // The sort is stable, so the changes of a sphere by lone collisions come before those by its cluster.
    outcome.changes.par_sort_by_key(|change| change.sphere);
    outcome
}

/// All collisions, sorted by key.
fn collisions(view: &View, lists: &Lists) -> Vec<Collision> {
    let movers = (0..view.step.movers()).into_par_iter().with_min_len(GRAIN);
    let of_mover = |mover: u32| {
        let own = lists.row(mover).filter(move |entry| {
            entry.word & ENTRY_COLLIDES != 0 && view.insertion_index(mover) < view.insertion_index(entry.id())
        });
        own.filter_map(move |entry| Collision::between(view, mover, entry.id(), entry.feature()))
    };
    let mut collisions: Vec<Collision> = movers.filter(|mover| lists.collides(*mover)).flat_map_iter(of_mover).collect();
    collisions.par_sort_unstable_by_key(|collision| collision.key(view));
    collisions
}

/// Whether a collision is lone: no other pressed contact touches its bodies, and none of them is a network. A single sphere
/// may also have pressed contacts with boxes and polygons at right angles to the collision, because collisions in a
/// right-angled corner do not influence each other.
fn is_lone(view: &View, lists: &Lists, k: &Collision) -> bool {
    k.parts().iter().all(|part| !matches!(part.body, Body::Network(_)) && is_alone_on(view, lists, k, part.body))
}

fn is_alone_on(view: &View, lists: &Lists, k: &Collision, body: Body) -> bool {
    let mut is_undisturbed = true;
    body.each_row(view, |row| {
        is_undisturbed &= lists.row(row).filter(|entry| entry.word & ENTRY_OVERLAPS != 0).all(|entry| {
            let (a, b) = view.ordered(row, entry.id());
            (a, b, entry.feature()) == (k.a, k.b, k.feature)
                || body == Body::Sphere(row) && is_right_angled(view, row, entry.id(), k.touch.normal)
        });
    });
    is_undisturbed
}

/// Whether the contact of a sphere is with a box or a polygon, and its normal is at a right angle to n.
fn is_right_angled(view: &View, sphere: u32, other: u32, n: Vec3) -> bool {
    let is_static = matches!(view.object(other), Object::Cuboid(_) | Object::Polygon(_));
    is_static && touch(view, sphere, other, 0).is_some_and(|touch| touch.normal.dot(n).abs() <= RIGHT_ANGLE)
}

/// The bodies that each collision touches, sorted by body.
fn touching(collisions: &[Collision]) -> Vec<Touching> {
    let of = |(number, collision): (usize, &Collision)| {
        let bodies: Vec<_> = collision.parts().iter().map(|part| Touching { body: part.body, collision: number }).collect();
        bodies
    };
    let mut touching: Vec<Touching> = collisions.iter().enumerate().flat_map(of).collect();
    touching.par_sort_unstable();
    touching
}

/// Groups the collisions that are not lone into clusters: sets that are connected by shared bodies.
fn clusters(touching: &[Touching], are_lone: &[bool]) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(are_lone.len());
    for on_one in touching.chunk_by(|one, other| one.body == other.body) {
        sets.join(on_one.iter().map(|touching| touching.collision).filter(|collision| !are_lone[*collision]));
    }
    sets.group((0..are_lone.len()).filter(|collision| !are_lone[*collision]).map(|collision| (collision, collision)))
}
