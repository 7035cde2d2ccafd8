//! Static surfaces of several shapes, without bumps at their seams (docs/physics section 11.4).

use glam::{Quat, Vec3};

use crate::rigid::broad::Aabb;
use crate::rigid::collide::collide;
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Found, Pair, Place};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};
use crate::rigid::world::RigidWorld;

/// Thickness of the skin of static shapes, as a share of the least half width of the moving body.
const SKIN: f32 = 1e-3;
/// Normals that differ by less than 0.01 rad are one.
const SAME: f32 = 0.999_95;

/// Shapes of a body that may cover points on each other, in the order of the least x of their AABBs in coordinates of the body.
struct Covers<'a> {
    world: &'a RigidWorld,
    skin: f32,
    shapes: Vec<(Aabb, u32)>,
    /// The greatest width of an AABB along x.
    widest: f32,
}

impl<'a> Covers<'a> {
    fn new(world: &'a RigidWorld, colliders: impl Iterator<Item = u32>, skin: f32) -> Self {
        let bounds = |number: u32| {
            let collider = &world.colliders[number as usize];
            let Aabb { min, max } = world.shapes[collider.shape as usize].aabb(&collider.place);
            // Room for the skin and for rounding.
            let room = Vec3::splat(1.1 * skin) + 1e-5 * min.abs().max(max.abs());
            Aabb { min: min - room, max: max + room }
        };
        let mut shapes: Vec<(Aabb, u32)> = colliders.map(|number| (bounds(number), number)).collect();
        shapes.sort_unstable_by(|(one, _), (other, _)| one.min.x.total_cmp(&other.min.x));
        let widest = shapes.iter().map(|(bounds, _)| bounds.max.x - bounds.min.x).fold(0.0, f32::max);
        Self { world, skin, shapes, widest }
    }

    /// Whether another shape than `own` covers a place.
    fn cover(&self, own: u32, place: Vec3) -> bool {
        let first = self.shapes.partition_point(|(bounds, _)| bounds.min.x < place.x - self.widest);
        let near = self.shapes[first..].iter().take_while(|(bounds, _)| bounds.min.x <= place.x);
        near.filter(|(bounds, other)| *other != own && place.cmpge(bounds.min).all() && place.cmple(bounds.max).all()).any(
            |(_, other)| {
                let collider = &self.world.colliders[*other as usize];
                let point = collider.place.relative(&Pose::new(place, Quat::IDENTITY));
                collide(&self.world.shapes[collider.shape as usize], &Shape::ball(self.skin), &point, 0.0).is_some()
            },
        )
    }
}

/// Which side of a pair has no mass, if one has none.
fn static_side(bodies: &Bodies, owners: [u32; 2]) -> Option<usize> {
    owners.iter().position(|body| !bodies.constants[*body as usize].dynamic)
}

/// Leaves out points on static shapes that another static shape of the same body covers: the sides of tiles in a floor. A pair
/// may lose all points. If all pairs would lose all of them, as deep inside two walls that overlap, the one nearest to its surface
/// keeps them.
pub(super) fn expose(world: &RigidWorld, bodies: &Bodies, same: &mut [Found]) {
    let Some(side) = static_side(bodies, same[0].bodies).filter(|_| same.len() > 1) else { return };
    let [still, moving] = [same[0].bodies[side], same[0].bodies[1 - side]].map(|body| body as usize);
    let skin = SKIN * 0.5 * world.bodies[moving].width;
    // A shape that the body is inside of covers nothing: the way out of it may lead into the other one.
    let is_inside = |found: &&Found| least_gap(found) < -0.5 * world.bodies[moving].width;
    let covers = Covers::new(world, same.iter().filter(|found| !is_inside(found)).map(|found| found.colliders[side]), skin);
    let exposed = |found: &Found| -> Vec<usize> {
        let first = &world.colliders[found.colliders[0] as usize];
        // From the shape a to the body without mass.
        let seen = bodies.poses[still].relative(&bodies.poses[first.body as usize]).compose(&first.place);
        let outward = if side == 0 { found.manifold.normal } else { -found.manifold.normal };
        let normal = seen.turn * outward;
        let on = |k: usize| {
            let point = &found.manifold.points[k];
            seen.point(if side == 0 { point.on_a } else { point.on_b })
        };
        let count = found.manifold.count;
        let middle = (0..count).map(on).sum::<Vec3>() / count as f32;
        let inward = |k: usize| (middle - on(k)).clamp_length_max(3.0 * skin);
        (0..count).filter(|k| !covers.cover(found.colliders[side], on(*k) + 2.0 * skin * normal + inward(*k))).collect()
    };
    let all = |found: &Found| (0..found.manifold.count).collect::<Vec<_>>();
    let mut kept: Vec<Vec<usize>> =
        same.iter().map(|found| if is_round(world, found) { all(found) } else { exposed(found) }).collect();
    if kept.iter().all(Vec::is_empty) {
        let depths = same.iter().map(|found| least_gap(found).abs());
        let nearest = depths.enumerate().min_by(|(_, one), (_, other)| one.total_cmp(other));
        nearest.into_iter().for_each(|(k, _)| kept[k] = all(&same[k]));
    }
    for (found, kept) in same.iter_mut().zip(kept) {
        for (to, from) in kept.iter().enumerate() {
            found.manifold.points[to] = found.manifold.points[*from];
        }
        found.manifold.count = kept.len();
    }
}

/// The least separation of the points of a pair.
fn least_gap(Found { manifold, .. }: &Found) -> f32 {
    let gaps = manifold.points[..manifold.count].iter().map(|point| (point.on_b - point.on_a).dot(manifold.normal));
    gaps.fold(f32::INFINITY, f32::min)
}

fn is_round(world: &RigidWorld, found: &Found) -> bool {
    found.colliders.iter().any(|k| world.shapes[world.colliders[*k as usize].shape as usize].is_round())
}

/// On which side of a pair a ball with mass is, if the other side is no ball. Static balls are no part of a surface:
/// they neither hide nor are hidden.
pub(super) fn ball_side(world: &RigidWorld, pair: &Pair) -> Option<usize> {
    let colliders = pair.colliders.map(|k| &world.colliders[k as usize]);
    let is_ball = colliders.map(|collider| matches!(world.shapes[collider.shape as usize].core, Core::Point));
    let has_mass = colliders.map(|collider| world.bodies[collider.body as usize].inverse_mass > 0.0);
    (0..2).find(|side| is_ball[*side] && has_mass[*side] && !is_ball[1 - *side])
}

/// For each place of a ball on static shapes the nearer place that hides it, if there is one.
pub(super) fn hidden(world: &RigidWorld, pairs: &[Pair], places: &[Place]) -> Vec<Option<usize>> {
    struct Candidate {
        ball: u32,
        radius: f32,
        distance: f32,
        /// From the centre of the ball to the shape.
        normal: Vec3,
    }
    let candidate = |pair: &Pair, place: &Place| {
        let side = ball_side(world, pair).filter(|_| pair.round && place.count == 1)?;
        let radius = world.shapes[world.colliders[pair.colliders[side] as usize].shape as usize].radius;
        let normal = Vec3::from(if side == 0 { place.normal } else { -place.normal });
        Some(Candidate { ball: pair.colliders[side], radius, distance: place.gap(0) + radius, normal })
    };
    let all: Vec<Option<Candidate>> = pairs.iter().zip(places).map(|(pair, place)| candidate(pair, place)).collect();
    let mut order: Vec<usize> = (0..all.len()).filter(|k| all[*k].is_some()).collect();
    let distance = |k: &usize| all[*k].as_ref().map_or(0.0, |candidate| candidate.distance);
    order.sort_by(|i, j| distance(i).total_cmp(&distance(j)));
    let mut hidden = vec![None; all.len()];
    for (rank, j) in order.iter().enumerate() {
        let Some(later) = &all[*j] else { continue };
        let hides = |i: &&usize| {
            let Some(earlier) = all[**i].as_ref().filter(|earlier| earlier.ball == later.ball && hidden[**i].is_none()) else {
                return false;
            };
            let cosine = later.normal.dot(earlier.normal);
            later.distance * cosine >= earlier.distance - 1e-5 * later.radius || cosine >= SAME
        };
        hidden[*j] = order[..rank].iter().find(hides).copied();
    }
    hidden
}
