//! Broad and narrow phase of a frame: margins, pairs and manifolds, in blocks (docs/physics sections 11.3 and 11.4).

use rayon::prelude::*;

use glam::{Vec3, Vec3A};

use crate::rigid::broad::{self, Aabb};
use crate::rigid::collide::collide;
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Block, Contacts, Found, Impulse, Lever, Pair, Point, Row, is_crowd};
use crate::rigid::frame::seams::{ball_side, expose};
use crate::rigid::shape::{Core, Shape};
use crate::rigid::world::{Collider, RigidWorld, Surface};

/// All manifolds of a frame, in the order of their colliders. Of a frame that is repeated, the bodies and the manifolds before are
/// known: where no margin has changed, those are the same.
pub(super) fn manifolds(world: &RigidWorld, bodies: &Bodies, before: Option<(&Bodies, &[Found])>) -> Vec<Found> {
    let pairs = candidates(world, bodies);
    let margins = |bodies: &Bodies, pair: (u32, u32)| {
        [pair.0, pair.1].map(|k| bodies.constants[world.colliders[k as usize].body as usize].margin)
    };
    let manifold = |pair: &(u32, u32)| match before {
        Some((old, found)) if margins(old, *pair) == margins(bodies, *pair) => {
            let key = |found: &Found| (found.colliders[0].min(found.colliders[1]), found.colliders[0].max(found.colliders[1]));
            found.binary_search_by_key(pair, key).ok().map(|place| found[place])
        }
        _ => manifold(world, bodies, *pair),
    };
    // Few pairs are done by one thread: tasks would cost more than they do.
    if !is_crowd(pairs.len()) {
        pairs.iter().filter_map(manifold).collect()
    } else {
        pairs.par_iter().with_min_len(64).filter_map(manifold).collect()
    }
}

/// Pairs of colliders that may touch and whose AABBs overlap.
pub(super) fn candidates(world: &RigidWorld, bodies: &Bodies) -> Vec<(u32, u32)> {
    let boxes: Vec<Aabb> = world.colliders.iter().map(|collider| bounds(world, bodies, collider)).collect();
    let apart = world.joints.apart_now();
    let may_touch = |i: usize, j: usize| {
        let [a, b] = [i, j].map(|k| &world.colliders[k]);
        let [heavy, light] = [a, b].map(|collider| bodies.masses[collider.body as usize].inverse_mass);
        a.body != b.body && a.group.touches(b.group) && (heavy > 0.0 || light > 0.0) && !apart.contains(a.body, b.body)
    };
    let has_image = |i: usize| bodies.masses[world.colliders[i].body as usize].inverse_mass > 0.0;
    let image = |i: usize, j: usize| bodies.image([i, j].map(|k| world.colliders[k].body));
    broad::pairs_of_images(&boxes, &world.periods, has_image, image, may_touch)
}

/// The AABB of a collider, grown by the margin of its body.
fn bounds(world: &RigidWorld, bodies: &Bodies, collider: &Collider) -> Aabb {
    let body = collider.body as usize;
    let margin = Vec3::splat(bodies.constants[body].margin);
    let Aabb { min, max } = world.shapes[collider.shape as usize].aabb(&bodies.poses[body].compose(&collider.place));
    Aabb { min: min - margin, max: max + margin }
}

fn manifold(world: &RigidWorld, bodies: &Bodies, (i, j): (u32, u32)) -> Option<Found> {
    let body = |collider: u32| world.colliders[collider as usize].body;
    let colliders = if body(i) <= body(j) { [i, j] } else { [j, i] };
    let [a, b] = colliders.map(|k| &world.colliders[k as usize]);
    let [body_a, body_b] = bodies.poses_of([a.body, b.body]);
    let (pose_a, pose_b) = (body_a.compose(&a.place), body_b.compose(&b.place));
    let reach = bodies.constants[a.body as usize].margin + bodies.constants[b.body as usize].margin;
    let [shape_a, shape_b] = [a, b].map(|collider| &world.shapes[collider.shape as usize]);
    let manifold = collide(shape_a, shape_b, &pose_a.relative(&pose_b), reach)?;
    Some(Found { bodies: [a.body, b.body], colliders, manifold })
}

/// Blocks of the manifolds, in the order (a, b), with their pairs and points in the order of their colliders.
pub(super) fn blocks(world: &RigidWorld, bodies: &Bodies, found: Vec<Found>, dt: f32) -> Contacts {
    blocks_with(world, bodies, found, dt, expose)
}

/// The same with what is done to all pairs of two bodies first.
pub(super) fn blocks_with(
    world: &RigidWorld,
    bodies: &Bodies,
    mut found: Vec<Found>,
    dt: f32,
    prepare: impl Fn(&RigidWorld, &Bodies, &mut [Found]),
) -> Contacts {
    found.sort_unstable_by_key(|pair| (pair.bodies, pair.colliders));
    let mut contacts = Contacts::default();
    for same in found.chunk_by_mut(|one, other| one.bodies == other.bodies) {
        prepare(world, bodies, same);
        let mut block = Block {
            bodies: same[0].bodies,
            first_pair: contacts.pairs.len() as u32,
            first_point: contacts.points.len() as u32,
            shares: [1.0; 2],
            ..Block::default()
        };
        block.fixed = block.sides().iter().any(|body| bodies.masses[*body].inverse_mass == 0.0);
        block.far = true;
        let reach = reach(bodies, &block, dt, world.gravity.length());
        let mut filled = 0;
        for found in same.iter().filter(|found| found.manifold.count > 0) {
            let pair = pair(world, found, contacts.points.len());
            block.elastic |= pair.restitution > 0.0;
            block.far &= found.manifold.points[..found.manifold.count]
                .iter()
                .all(|point| (point.on_b - point.on_a).dot(found.manifold.normal) > reach);
            filled += pair.room;
            let opens = filled == pair.room || filled > 4;
            filled = if opens { pair.room } else { filled };
            contacts.pairs.push(Pair { opens, ..pair });
            add_points(world, bodies, &mut contacts, found, pair.room);
        }
        block.pairs = contacts.pairs.len() as u32 - block.first_pair;
        block.points = contacts.points.len() as u32 - block.first_point;
        let balls = |pair: &Pair| ball_side(world, pair).is_some();
        block.seams = block.fixed && contacts.pairs[block.pair_range()].iter().filter(|pair| balls(pair)).count() > 1;
        if block.pairs > 0 {
            contacts.blocks.push(block);
        }
    }
    let points = contacts.points.len();
    contacts.rows = vec![Row::default(); points];
    contacts.levers = vec![Lever::default(); points];
    contacts.impulses = vec![Impulse::default(); points];
    contacts
}

/// How far apart two bodies may be to touch in this frame without a hit by a third one.
fn reach(bodies: &Bodies, block: &Block, dt: f32, field: f32) -> f32 {
    let [a, b] = block.sides();
    let [motion_a, motion_b] = [bodies.motions[a], bodies.motions[b]];
    // A body at rest may be infinite.
    let turn = |i: usize, spin: Vec3A| if spin == Vec3A::ZERO { 0.0 } else { spin.length() * bodies.constants[i].radius };
    let [turn_a, turn_b] = [turn(a, motion_a.spin), turn(b, motion_b.spin)];
    let speed = (motion_b.velocity - motion_a.velocity).length() + turn_a + turn_b;
    speed * dt + field * dt * dt + 0.02 * least_radius(bodies, block)
}

/// Radius of the smaller body of a block. Bodies without mass do not count.
pub(super) fn least_radius(bodies: &Bodies, block: &Block) -> f32 {
    let radius = |i: usize| if bodies.constants[i].dynamic { bodies.constants[i].radius } else { f32::INFINITY };
    let [a, b] = block.sides();
    radius(a).min(radius(b))
}

fn is_ball(shape: &Shape) -> bool {
    matches!(shape.core, Core::Point)
}

pub(super) fn pair(world: &RigidWorld, found: &Found, first: usize) -> Pair {
    let [a, b] = found.colliders.map(|k| &world.colliders[k as usize]);
    let Surface { friction, restitution } = world.surface(a.material, b.material);
    let [near, far] = [a, b].map(|collider| &world.shapes[collider.shape as usize]);
    let round = near.is_round() || far.is_round();
    let count = found.manifold.count as u8;
    Pair {
        colliders: found.colliders,
        first: first as u32,
        // A capsule may come to lie with its second end.
        room: if round && !is_ball(near) && !is_ball(far) { count.max(2) } else { count },
        count,
        round,
        friction,
        restitution,
        inner_normal: Vec3A::from(a.place.turn * found.manifold.normal),
        ..Pair::default()
    }
}

/// The points of a pair, in coordinates of the bodies.
pub(super) fn add_points(world: &RigidWorld, bodies: &Bodies, contacts: &mut Contacts, found: &Found, room: u8) {
    let place = &world.colliders[found.colliders[0] as usize].place;
    let [a, b] = bodies.poses_of(found.bodies);
    let (apart, back) = (Vec3A::from(b.position - a.position), b.turn.inverse());
    let end = contacts.points.len() + usize::from(room);
    for point in &found.manifold.points[..found.manifold.count] {
        let seen = Vec3A::from(place.point(point.on_b));
        let on_b = back * (a.turn * seen - apart);
        contacts.points.push(Point { on_a: place.point(point.on_a).into(), on_b, id: point.id });
    }
    contacts.points.resize(end, Point { id: u32::MAX, ..Point::default() });
}
