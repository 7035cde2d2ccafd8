//! Geometry of contacts in a pose of their bodies, and the rows that follow from it (docs/physics sections 11.4 and 11.8).

use glam::{Mat3A, Vec2, Vec3, Vec3A};

use crate::rigid::collide::{MOST_POINTS, collide};
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Block, Impulse, Pair, Place, Point, Row, View};
use crate::rigid::frame::seams::hidden;
use crate::rigid::pose::Pose;
use crate::rigid::world::RigidWorld;

/// From the centre of a to that of b.
pub(super) fn apart([a, b]: &[Pose; 2]) -> Vec3A {
    (b.position - a.position).into()
}

/// The rotations of two bodies.
fn turns(poses: &[Pose; 2]) -> [Mat3A; 2] {
    poses.map(|pose| Mat3A::from_quat(pose.turn))
}

/// The places of a point on both surfaces from the centre of body a, for the turns and the way of its bodies.
#[inline(always)]
fn seen(point: &Point, [a, b]: &[Mat3A; 2], apart: Vec3A) -> [Vec3A; 2] {
    [*a * point.on_a, apart + *b * point.on_b]
}

/// The points of a pair with its bodies in given poses.
pub(super) fn place(world: &RigidWorld, pair: &Pair, points: &[Point], poses: &[Pose; 2]) -> Place {
    if pair.round
        && let Some(found) = found_anew(world, pair, poses)
    {
        return found;
    }
    let (turns, apart) = (turns(poses), apart(poses));
    let mut place = Place { normal: turns[0] * pair.inner_normal, count: pair.count.into(), ..Place::default() };
    for (k, point) in points[..place.count].iter().enumerate() {
        [place.on_a[k], place.on_b[k]] = seen(point, &turns, apart);
        place.ids[k] = point.id;
    }
    place
}

/// The closest points of a round contact.
fn found_anew(world: &RigidWorld, pair: &Pair, [a, b]: &[Pose; 2]) -> Option<Place> {
    let [one, other] = pair.colliders.map(|collider| &world.colliders[collider as usize]);
    let [near, far] = [one, other].map(|collider| &world.shapes[collider.shape as usize]);
    // Relative to the centre of a, so that nothing is lost far from the origin.
    let own = Pose::new(Vec3::ZERO, a.turn).compose(&one.place);
    let theirs = Pose::new(b.position - a.position, b.turn).compose(&other.place);
    let manifold = collide(near, far, &own.relative(&theirs), f32::INFINITY)?;
    let mut place = Place { normal: (own.turn * manifold.normal).into(), ..Place::default() };
    place.count = manifold.count.min(pair.room.into());
    for (k, point) in manifold.points[..place.count].iter().enumerate() {
        (place.on_a[k], place.on_b[k], place.ids[k]) = (own.point(point.on_a).into(), own.point(point.on_b).into(), point.id);
    }
    Some(place)
}

/// Two unit vectors that make a right-handed frame with a unit vector.
pub(super) fn tangents(n: Vec3A) -> [Vec3A; 2] {
    let sign = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [Vec3A::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3A::new(b, sign + n.y * n.y * a, -n.y)]
}

/// Forms the rows of a block anew.
pub(super) fn refresh(world: &RigidWorld, bodies: &Bodies, view: View<'_>, h: f32) {
    let poses = bodies.poses_of(view.block.bodies);
    let apart = apart(&poses);
    view.block.time = h;
    renew_block(world, view, &poses, |on_a, on_b, gap| {
        let common = 0.5 * (on_a + on_b);
        Row::new(common, common - apart, gap)
    });
}

/// Gives all pairs of a block their geometry in a pose, and their rows.
pub(super) fn renew_block(world: &RigidWorld, mut view: View<'_>, poses: &[Pose; 2], row: impl Fn(Vec3A, Vec3A, f32) -> Row) {
    if view.block.seams {
        renew_seams(world, &mut view, poses, row);
        return;
    }
    let (turns, apart) = (turns(poses), apart(poses));
    for k in 0..view.pairs.len() {
        let pair = &mut view.pairs[k];
        let first = (pair.first - view.block.first_point) as usize;
        if !pair.round {
            let range = first..first + usize::from(pair.count);
            let normal = turns[0] * pair.inner_normal;
            lean(world, pair, normal, &mut view.impulses[range.clone()], poses);
            for (place, point) in view.rows[range.clone()].iter_mut().zip(&view.points[range]) {
                let [on_a, on_b] = seen(point, &turns, apart);
                *place = row(on_a, on_b, (on_b - on_a).dot(normal));
            }
            continue;
        }
        let found = place(world, pair, &view.points[first..first + usize::from(pair.room)], poses);
        renew_pair(world, &mut view, k, &found, poses, &row);
    }
}

fn renew_pair(
    world: &RigidWorld,
    view: &mut View<'_>,
    k: usize,
    found: &Place,
    poses: &[Pose; 2],
    row: &impl Fn(Vec3A, Vec3A, f32) -> Row,
) {
    let pair = &mut view.pairs[k];
    let first = (pair.first - view.block.first_point) as usize;
    let range = first..first + usize::from(pair.room);
    turn(world, pair, found, &mut view.points[range.clone()], &mut view.impulses[range.clone()], poses);
    for (k, place) in view.rows[range].iter_mut().enumerate().take(found.count) {
        *place = row(found.on_a[k], found.on_b[k], found.gap(k));
    }
}

/// The places of all pairs of a block in a pose. Those that are hidden have no points.
pub(super) fn places(
    world: &RigidWorld,
    block: &Block,
    pairs: &[Pair],
    points: &[Point],
    first: u32,
    poses: &[Pose; 2],
) -> Vec<Place> {
    let range = |pair: &Pair| (pair.first - first) as usize..(pair.first - first) as usize + usize::from(pair.room);
    let mut places: Vec<Place> = pairs.iter().map(|pair| place(world, pair, &points[range(pair)], poses)).collect();
    if block.seams {
        for (k, by) in hidden(world, pairs, &places).into_iter().enumerate() {
            places[k].count = if by.is_some() { 0 } else { places[k].count };
        }
    }
    places
}

/// A ball on static shapes that hide each other: the one that hides another one takes over its impulse.
fn renew_seams(world: &RigidWorld, view: &mut View<'_>, poses: &[Pose; 2], row: impl Fn(Vec3A, Vec3A, f32) -> Row) {
    let first = view.block.first_point;
    let mut all: Vec<Place> = view
        .pairs
        .iter()
        .map(|pair| place(world, pair, &view.points[(pair.first - first) as usize..][..usize::from(pair.room)], poses))
        .collect();
    let hidden = hidden(world, view.pairs, &all);
    let mut gifts = Vec::new();
    for (k, by) in hidden.into_iter().enumerate() {
        let Some(by) = by else { continue };
        all[k].count = 0;
        let (pair, impulse) = (&view.pairs[k], view.impulses[(view.pairs[k].first - first) as usize]);
        // The biased pass may have left it friction alone.
        if impulse != Impulse::default() {
            let outer = impulse.tangent.x * pair.tangents[0] + impulse.tangent.y * pair.tangents[1];
            gifts.push((by, impulse.normal, outer));
        }
    }
    for (k, found) in all.iter().enumerate() {
        renew_pair(world, view, k, found, poses, &row);
    }
    for (to, normal, outer) in gifts {
        let pair = &view.pairs[to];
        let impulse = &mut view.impulses[(pair.first - first) as usize];
        impulse.normal += normal;
        impulse.tangent += Vec2::new(outer.dot(pair.tangents[0]), outer.dot(pair.tangents[1]));
    }
}

/// Gives a pair its new normal and points.
fn turn(world: &RigidWorld, pair: &mut Pair, found: &Place, points: &mut [Point], impulses: &mut [Impulse], poses: &[Pose; 2]) {
    if pair.round {
        renew(pair, found, points, impulses, poses);
    }
    lean(world, pair, found.normal, &mut impulses[..found.count], poses);
}

/// Gives a pair a new normal. Friction impulses are projected on the new tangent plane.
fn lean(world: &RigidWorld, pair: &mut Pair, normal: Vec3A, impulses: &mut [Impulse], poses: &[Pose; 2]) {
    let old = std::mem::replace(&mut pair.tangents, tangents(normal));
    pair.normal = normal;
    for impulse in impulses {
        let outer = impulse.tangent.x * old[0] + impulse.tangent.y * old[1];
        impulse.tangent = Vec2::new(outer.dot(pair.tangents[0]), outer.dot(pair.tangents[1]));
    }
    pair.belt = belt(world, pair, poses);
}

/// Stores the points of a round contact. Their impulses follow the ids.
fn renew(pair: &mut Pair, found: &Place, points: &mut [Point], impulses: &mut [Impulse], poses: &[Pose; 2]) {
    let [a, b] = poses.map(|pose| pose.turn.inverse());
    let apart = apart(poses);
    // Two points of a capsule may have changed places, or one may have come or gone. The only point of a pair is the same.
    let count = usize::from(pair.count);
    let only = found.count == 1 && count == 1;
    let mut before = [(u32::MAX, Impulse::default()); MOST_POINTS];
    for (k, known) in before.iter_mut().enumerate().take(count) {
        *known = (points[k].id, impulses[k]);
    }
    for (k, (point, impulse)) in points.iter_mut().zip(&mut *impulses).enumerate() {
        if k >= found.count {
            *impulse = Impulse::default();
            continue;
        }
        *point = Point { on_a: a * found.on_a[k], on_b: b * (found.on_b[k] - apart), id: found.ids[k] };
        let same = before[..count].iter().find(|(id, _)| only || *id == point.id);
        *impulse = same.map_or(Impulse::default(), |(_, impulse)| *impulse);
    }
    pair.count = found.count as u8;
    pair.inner_normal = a * found.normal;
}

/// Velocity of the surface of b less that of a, along the tangents.
pub(super) fn belt(world: &RigidWorld, pair: &Pair, poses: &[Pose; 2]) -> Vec2 {
    let [own, theirs] = [0, 1].map(|s| {
        let collider = &world.colliders[pair.colliders[s] as usize];
        let still = collider.surface_velocity == Vec3::ZERO;
        Vec3A::from(if still { Vec3::ZERO } else { poses[s].turn * collider.surface_velocity })
    });
    Vec2::new((theirs - own).dot(pair.tangents[0]), (theirs - own).dot(pair.tangents[1]))
}
