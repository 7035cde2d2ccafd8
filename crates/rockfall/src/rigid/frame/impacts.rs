//! Impacts: blocks that close are reflected at their time of contact (docs/physics section 11.7).

use glam::{Quat, Vec2, Vec3, Vec3A};
use rayon::prelude::*;

use crate::rigid::frame::bodies::{Bodies, Mass};
use crate::rigid::frame::contacts::{Block, COLOURS, Contacts, Impulse, Lever, Pair, Row, View, for_each, is_crowd};
use crate::rigid::frame::refresh::{apart, belt, places, renew_block, tangents};
use crate::rigid::frame::rows::{Sides, friction_row};
use crate::rigid::frame::times::{Hit, Scope, State};
use crate::rigid::pose::Pose;
use crate::rigid::world::RigidWorld;
use crate::rotate::{product, unit};

/// Rounds over the colours in a substep.
const ROUNDS: usize = 2;
/// Sweeps of the inelastic impulses, and of friction.
const SWEEPS: usize = 16;
const FRICTION_SWEEPS: usize = 4;

/// All impacts of a substep. Whether any body was reflected, and so has another pose at its start.
pub(super) fn impacts(world: &RigidWorld, contacts: &mut Contacts, bodies: &mut Bodies, h: f32) -> bool {
    let scope = Scope { world, h };
    contacts.blocks.iter_mut().for_each(|block| block.waits = false);
    let mut any = false;
    for _ in 0..ROUNDS {
        for colour in 0..COLOURS {
            for (k, hit) in hits(&scope, contacts, bodies, contacts.colour(colour)) {
                let Some(Reflected { ends, strikes }) = reflect(&scope, contacts, bodies, k, &hit, [1.0; 2]) else { continue };
                any = true;
                note(contacts, &strikes);
                for (side, i) in contacts.blocks[k].sides().into_iter().enumerate() {
                    put(bodies, i, &ends[side], hit.time);
                }
            }
        }
        any |= left_over(&scope, contacts, bodies);
        if !any {
            return false;
        }
    }
    wait(&scope, contacts, bodies);
    carry(&scope, contacts, bodies);
    true
}

/// The blocks of a range that are hit. Blocks of one colour do not change each other's.
fn hits(scope: &Scope<'_>, contacts: &Contacts, bodies: &Bodies, range: std::ops::Range<usize>) -> Vec<(usize, Hit)> {
    let find = |k: usize| scope.find(bodies, contacts, k).map(|hit| (k, hit));
    if !is_crowd(range.len()) {
        range.filter_map(find).collect()
    } else {
        range.into_par_iter().with_min_len(128).filter_map(find).collect()
    }
}

/// Adds the impulses of impacts to their pairs.
fn note(contacts: &mut Contacts, strikes: &[(usize, f32)]) {
    for (pair, normal) in strikes {
        contacts.pairs[*pair].struck += normal;
    }
}

/// A block after its impact.
struct Reflected {
    ends: [After; 2],
    /// Of each point its pair and the normal impulse.
    strikes: Vec<(usize, f32)>,
}

/// A body after an impact, at the start of the substep, on the path that leads through the impact.
#[derive(Clone, Copy, Debug)]
struct After {
    pose: Pose,
    velocity: Vec3A,
    momentum: Vec3A,
}

fn put(bodies: &mut Bodies, i: usize, after: &After, time: f32) {
    if bodies.constants[i].dynamic {
        if !bodies.fits(i, &after.pose) {
            return bodies.halt(i);
        }
        bodies.poses[i] = after.pose;
        bodies.motions[i].velocity = after.velocity;
        bodies.momenta[i] = after.momentum;
        bodies.clocks[i] = bodies.clocks[i].max(time);
        bodies.respin(i);
    }
}

/// All left-over blocks that are hit, at once: bodies are split among them, and take the mean. Whether any is reflected.
fn left_over(scope: &Scope<'_>, contacts: &mut Contacts, bodies: &mut Bodies) -> bool {
    let hits = hits(scope, contacts, bodies, contacts.colour(COLOURS));
    if hits.is_empty() {
        return false;
    }
    let mut counts = vec![0_u32; bodies.count()];
    hits.iter().flat_map(|(k, _)| contacts.blocks[*k].sides()).for_each(|i| counts[i] += 1);
    let before: &Bodies = &bodies.clone();
    let mut any = false;
    for (k, hit) in &hits {
        let shares = contacts.blocks[*k].sides().map(|i| if before.constants[i].dynamic { counts[i] as f32 } else { 1.0 });
        let Some(Reflected { ends, strikes }) = reflect(scope, contacts, before, *k, hit, shares) else { continue };
        any = true;
        note(contacts, &strikes);
        for (side, i) in contacts.blocks[*k].sides().into_iter().enumerate() {
            let share = 1.0 / counts[i] as f32;
            let after = mean(bodies, before, i, &ends[side], share);
            put(bodies, i, &after, hit.time);
        }
    }
    any
}

/// Adds the change of a copy at its share to the present state of a body.
fn mean(bodies: &Bodies, before: &Bodies, i: usize, copy: &After, share: f32) -> After {
    let (pose, old) = (bodies.poses[i], before.poses[i]);
    let mut change = product(copy.pose.turn, old.turn.conjugate());
    change = if change.w < 0.0 { -change } else { change };
    let part = Quat::from_xyzw(share * change.x, share * change.y, share * change.z, 1.0);
    After {
        pose: Pose::new(pose.position + share * (copy.pose.position - old.position), unit(product(part, pose.turn))),
        velocity: bodies.motions[i].velocity + share * (copy.velocity - before.motions[i].velocity),
        momentum: bodies.momenta[i] + share * (copy.momentum - before.momenta[i]),
    }
}

/// A point that takes part in an impact.
struct Joined {
    /// Its pair, by its place and as it is at the time of contact.
    place: usize,
    pair: Pair,
    row: Row,
    lever: Lever,
    normal: f32,
    tangent: Vec2,
    /// Approach speed before the impact.
    speed: f32,
}

/// The bodies of a block after its impact, with inverse masses multiplied by `shares`; `None` if no impulse acts.
fn reflect(
    scope: &Scope<'_>,
    contacts: &Contacts,
    bodies: &Bodies,
    k: usize,
    hit: &Hit,
    shares: [f32; 2],
) -> Option<Reflected> {
    let block = &contacts.blocks[k];
    let (state, image) = (scope.state(bodies, block, hit.time), bodies.image(block.bodies));
    let masses = [0, 1].map(|s| mass_at(bodies, block.sides()[s], state.0[s].turn).split(shares[s]));
    let [a, b] = state.1;
    let mut sides = Sides { a, b, mass_a: &masses[0], mass_b: &masses[1] };
    let mut points = joined(scope, contacts, block, &state, &sides, hit.depth);
    let scale = inelastic(&mut points, sides)?;
    restitute(&mut points, &mut sides, scale);
    let strikes = points.iter().map(|point| (point.place, point.normal)).collect();
    let ends = [0, 1].map(|s| {
        let moment = points.iter().fold(Vec3A::ZERO, |sum, point| {
            let [t1, t2] = point.pair.tangents;
            let push = point.normal * point.pair.normal + (point.tangent.x * t1 + point.tangent.y * t2);
            if s == 0 { sum - point.row.arm_a.cross(push) } else { sum + point.row.arm_b.cross(push) }
        });
        let i = block.sides()[s];
        let momentum = bodies.momenta[i] + shares[s] * moment;
        let mut pose = state.0[s];
        pose.position -= [Vec3::ZERO, image][s];
        back(scope, bodies, i, &pose, [sides.a, sides.b][s].velocity, momentum, hit.time)
    });
    Some(Reflected { ends, strikes })
}

fn mass_at(bodies: &Bodies, i: usize, turn: Quat) -> Mass {
    let mass = bodies.masses[i];
    if mass.inverse_mass == 0.0 {
        return mass;
    }
    Mass { inverse_inertia: bodies.constants[i].moments.inverse_inertia(turn), ..mass }
}

/// The points of a block at the time of contact that are as near as those that are hit.
fn joined(scope: &Scope<'_>, contacts: &Contacts, block: &Block, state: &State, sides: &Sides<'_>, depth: f32) -> Vec<Joined> {
    let poses = &state.0;
    let apart = apart(poses);
    let mut points = Vec::with_capacity(block.points as usize);
    let pairs = &contacts.pairs[block.pair_range()];
    let nows = places(scope.world, block, pairs, &contacts.points, 0, poses);
    for ((place, pair), now) in block.pair_range().zip(pairs).zip(nows) {
        let mut turned = Pair { normal: now.normal, tangents: tangents(now.normal), ..*pair };
        turned.belt = belt(scope.world, &turned, poses);
        for k in (0..now.count).filter(|k| now.gap(*k) <= depth) {
            let common = 0.5 * (now.on_a[k] + now.on_b[k]);
            let row = Row::new(common, common - apart, now.gap(k));
            let mut lever = Lever::default();
            sides.form(&turned, &row, &mut lever);
            let speed = -sides.normal_speed(&turned, &lever);
            points.push(Joined { place, pair: turned, row, lever, normal: 0.0, tangent: Vec2::ZERO, speed });
        }
    }
    points
}

/// The impulses after which no point approaches. What they are multiplied by to be exact in energy, `None` if there are none.
fn inelastic(points: &mut [Joined], mut sides: Sides<'_>) -> Option<f32> {
    for _ in 0..SWEEPS {
        for Joined { pair, lever, normal, .. } in points.iter_mut() {
            let before = *normal;
            *normal = (before - sides.normal_speed(pair, lever) * lever.inverse_normal).max(0.0);
            sides.push(pair, lever, *normal - before);
        }
    }
    let (mut work, mut lost) = (0.0, 0.0);
    for Joined { pair, lever, normal, speed, .. } in points.iter() {
        work += normal * speed;
        lost += normal * (speed + sides.normal_speed(pair, lever));
    }
    (lost > 0.0).then(|| work / lost)
}

/// Applies the impulses with restitution, and friction within their bounds.
fn restitute(points: &mut [Joined], sides: &mut Sides<'_>, scale: f32) {
    // Several pairs of two bodies may differ in e: the mean, weighted with the impulses, is between them.
    let (mut sum, mut weighted) = (0.0, 0.0);
    for Joined { pair, normal, .. } in points.iter() {
        sum += normal;
        weighted += normal * pair.restitution;
    }
    let factor = (1.0 + weighted / sum) * scale;
    for Joined { pair, lever, normal, .. } in points.iter_mut() {
        *normal *= factor;
        sides.push(pair, lever, *normal);
    }
    for _ in 0..FRICTION_SWEEPS {
        for Joined { pair, lever, normal, tangent, .. } in points.iter_mut().filter(|point| point.normal > 0.0) {
            let bound = pair.friction * *normal;
            friction_row(pair, lever, tangent, sides, bound);
        }
    }
}

/// Carries a body from a time back to the start of the substep, on its new path.
fn back(scope: &Scope<'_>, bodies: &Bodies, i: usize, pose: &Pose, velocity: Vec3A, momentum: Vec3A, time: f32) -> After {
    let gravity = scope.gravity();
    if time == 0.0 {
        return After { pose: *pose, velocity, momentum };
    }
    let position = pose.position - Vec3::from(time * velocity - 0.5 * time * time * gravity);
    let turn = bodies.constants[i].moments.turned(pose.turn, momentum, -time);
    After { pose: Pose::new(position, turn), velocity: velocity - time * gravity, momentum }
}

/// Blocks that are still hit have no rows in this substep, unless they are deep.
fn wait(scope: &Scope<'_>, contacts: &mut Contacts, bodies: &Bodies) {
    let all = hits(scope, contacts, bodies, 0..contacts.blocks.len());
    for (k, _) in all.into_iter().filter(|(_, hit)| hit.may_wait) {
        let block = &mut contacts.blocks[k];
        block.waits = true;
        let range = block.first_point as usize..(block.first_point + block.points) as usize;
        contacts.impulses[range].fill(Impulse::default());
    }
}

/// Forms the rows of blocks with a clock anew: gaps at the time of the clock, arms at the start of the substep.
fn carry(scope: &Scope<'_>, contacts: &mut Contacts, bodies: &Bodies) {
    let count = contacts.blocks.len();
    let mut done = vec![(); count];
    for_each(contacts.part(0..count), &mut done, &|view| {
        let start = scope.start(bodies, view.block);
        if start > 0.0 {
            carry_block(scope, bodies, view, start);
        }
    });
}

fn carry_block(scope: &Scope<'_>, bodies: &Bodies, view: View<'_>, start: f32) {
    let (poses, _) = scope.state(bodies, view.block, start);
    let sides = view.block.sides();
    let now = bodies.poses_of(view.block.bodies);
    let loose = sides.map(|i| bodies.constants[i].dynamic);
    let (apart, apart_now) = (apart(&poses), apart(&now));
    view.block.time = scope.h - start;
    renew_block(scope.world, view, &poses, |on_a, on_b, gap| {
        // With the displacement of the centre alone: the arm, and so the speed at the point, is that at the contact.
        let on_b = apart_now + (on_b - apart);
        let common = match loose {
            [true, true] => 0.5 * (on_a + on_b),
            [true, false] => on_a,
            _ => on_b,
        };
        Row::new(common, common - apart_now, gap)
    });
}
