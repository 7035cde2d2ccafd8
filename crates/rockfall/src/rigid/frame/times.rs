//! When the bodies of a block touch (docs/physics section 11.7).

use glam::{Vec3, Vec3A};

use crate::rigid::frame::bodies::{Bodies, Motion};
use crate::rigid::frame::contacts::{Block, Contacts, Pair, Place, Point, Row, View};
use crate::rigid::frame::detect::least_radius;
use crate::rigid::frame::refresh::{apart, place, places};
use crate::rigid::frame::turn::about;
use crate::rigid::pose::Pose;
use crate::rigid::world::RigidWorld;
use crate::rotate::{product, unit};

/// Newton steps of a search.
const STEPS: usize = 8;
/// A round contact touches at a gap of this share of the radius.
const TOUCH: f32 = 1e-4;
/// A hit that is late by at most this share of the rest of a substep happens at its end.
const LATE: f32 = 0.01;
/// The latest impact, in parts of a substep: rows divide by what is left.
const LAST: f32 = 1.0 - 1e-6;
/// A block without restitution has impacts if a point closes by this share of the radius in a substep.
const FAST: f32 = 0.1;

/// What a search for impacts needs of a substep.
#[derive(Clone, Copy)]
pub(super) struct Scope<'a> {
    pub(super) world: &'a RigidWorld,
    pub(super) h: f32,
}

/// An impact of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// When, in s of the substep.
    pub(super) time: f32,
    /// Points with a gap of at most this take part.
    pub(super) depth: f32,
    /// No hit point is so deep that it must be pushed out now.
    pub(super) may_wait: bool,
}

/// Poses and motions of two bodies at a time.
pub(super) type State = ([Pose; 2], [Motion; 2]);

impl Scope<'_> {
    /// The latest clock of the bodies of a block.
    pub(super) fn start(&self, bodies: &Bodies, block: &Block) -> f32 {
        let [a, b] = block.sides();
        bodies.clocks[a].max(bodies.clocks[b])
    }

    /// Both bodies of a block at a time, before the kick.
    pub(super) fn state(&self, bodies: &Bodies, block: &Block, time: f32) -> State {
        let [(pose_a, a), (mut pose_b, b)] = block.sides().map(|i| bodies.at(i, time, self.gravity()));
        pose_b.position += bodies.image(block.bodies);
        ([pose_a, pose_b], [a, b])
    }

    /// Acceleration of the field.
    pub(super) fn gravity(&self) -> Vec3A {
        self.world.gravity.into()
    }

    /// Least speed of an impact.
    fn least_speed(&self) -> f32 {
        self.world.gravity.length() * self.h
    }

    /// The impact of a block in this substep, if there is one.
    pub(super) fn find(&self, bodies: &Bodies, contacts: &Contacts, k: usize) -> Option<Hit> {
        let block = &contacts.blocks[k];
        let radius = least_radius(bodies, block);
        let enough = if block.elastic { 0.0 } else { FAST * radius / self.h };
        let gain = if block.fixed { self.least_speed() } else { 0.0 };
        if closing_bound(bodies, block) + gain <= enough.max(self.least_speed()) {
            return None;
        }
        let start = self.start(bodies, block);
        let state = self.state(bodies, block, start);
        let field = self.relative_field(bodies, block);
        let mut hits = Hits { earliest: f32::INFINITY, depth: 0.0, may_wait: true };
        for (place_of_pair, pair) in contacts.pairs[block.pair_range()].iter().enumerate() {
            let range = pair.first as usize..pair.first as usize + usize::from(pair.room);
            let points = &contacts.points[range.clone()];
            // With clocks at 0 the rows are those of this state.
            let now = if start == 0.0 && !block.seams {
                of_rows(pair, &contacts.rows[range])
            } else {
                place(self.world, pair, points, &state.0)
            };
            let a_n = -field.dot(now.normal);
            for i in 0..now.count {
                let (gap, u) = (now.gap(i), approach(&now, i, &state));
                let faster = (u + a_n.max(0.0) * (self.h - start)) > self.least_speed();
                if !faster || u <= enough {
                    continue;
                }
                let hit = if gap <= 0.0 {
                    (u > self.least_speed()).then_some((0.0, u))
                } else if pair.round {
                    self.touch(bodies, block, pair, points, start, gap, u, a_n, radius)
                } else {
                    self.root(gap, u, a_n, self.h - start, radius).map(|t| (t, u))
                };
                if let Some((t, speed)) = hit
                    && !self.is_hidden(bodies, contacts, block, place_of_pair, start + t)
                {
                    hits.add(
                        (start + t).min(LAST * self.h),
                        (speed + 0.5 * a_n.abs() * self.h) * self.h,
                        gap > -2.0 * u * self.h,
                    );
                }
            }
        }
        hits.first()
    }

    /// Whether another static shape hides that of a pair at a time.
    fn is_hidden(&self, bodies: &Bodies, contacts: &Contacts, block: &Block, k: usize, time: f32) -> bool {
        let pairs = &contacts.pairs[block.pair_range()];
        block.seams && {
            let (poses, _) = self.state(bodies, block, time);
            places(self.world, block, pairs, &contacts.points, 0, &poses)[k].count == 0
        }
    }

    /// Acceleration of b relative to a by the field.
    fn relative_field(&self, bodies: &Bodies, block: &Block) -> Vec3A {
        let [a, b] = block.sides().map(|i| if bodies.constants[i].dynamic { self.gravity() } else { Vec3A::ZERO });
        b - a
    }

    /// First time at which a gap closes with an approach speed and an acceleration.
    fn root(&self, gap: f32, u: f32, a_n: f32, rest: f32, radius: f32) -> Option<f32> {
        let square = u * u + 2.0 * a_n * gap;
        let t = 2.0 * gap / (u + square.max(0.0).sqrt());
        (square >= 0.0 && t >= 0.0 && t <= rest + late(u, rest, radius) && u + a_n * t > self.least_speed())
            .then_some(t.min(rest))
    }

    /// When a round contact touches, and how fast.
    #[allow(clippy::too_many_arguments)]
    fn touch(
        &self,
        bodies: &Bodies,
        block: &Block,
        pair: &Pair,
        points: &[Point],
        start: f32,
        gap: f32,
        u: f32,
        a_n: f32,
        radius: f32,
    ) -> Option<(f32, f32)> {
        let rest = self.h - start;
        // The gap is convex along straight paths, so the tangent line is below it.
        if gap - u * (rest + late(u, rest, radius)) - 0.5 * a_n.max(0.0) * rest * rest > 0.0 {
            return None;
        }
        let path = |t: f32| self.state(bodies, block, start + t);
        match search(self.world, pair, points, rest, radius, &path) {
            End::Touch { time, speed } if speed > self.least_speed() => Some((time, speed)),
            _ => None,
        }
    }

    /// Sets what the gaps of round contacts keep beyond their tangent lines: a body that passes is not deflected.
    pub(super) fn spare(&self, bodies: &Bodies, view: &mut View<'_>) {
        let block = *view.block;
        let start = self.start(bodies, &block);
        let rest = self.h - start;
        let [a, b] = block.sides();
        for pair in view.pairs.iter().filter(|pair| pair.round) {
            let first = (pair.first - block.first_point) as usize;
            let points = &view.points[first..first + usize::from(pair.room)];
            for row in &mut view.rows[first..first + usize::from(pair.count)] {
                let u = (bodies.motions[a].at(row.arm_a) - bodies.motions[b].at(row.arm_b)).dot(pair.normal);
                row.spare = 0.0;
                if row.gap <= 0.0 || u * rest <= row.gap {
                    continue;
                }
                let path = |t: f32| self.kicked(bodies, &block, start + t);
                let radius = least_radius(bodies, &block);
                if let End::Miss { least } = search(self.world, pair, points, rest, radius, &path) {
                    row.spare = (least - row.gap + u * rest).max(0.0);
                }
            }
        }
    }

    /// Both bodies of a block at a time with the present motions, after the kick.
    fn kicked(&self, bodies: &Bodies, block: &Block, time: f32) -> State {
        let gravity = self.gravity();
        let [(pose_a, a), (mut pose_b, b)] = block.sides().map(|i| {
            let (pose, motion) = (bodies.poses[i], bodies.motions[i]);
            let field = if bodies.constants[i].dynamic { gravity } else { Vec3A::ZERO };
            let velocity = motion.velocity - (self.h - time) * field;
            let position = pose.position + Vec3::from(time * velocity - 0.5 * time * time * field);
            let turn = if motion.spin == Vec3A::ZERO { pose.turn } else { unit(product(about(time * motion.spin), pose.turn)) };
            (Pose::new(position, turn), Motion { velocity, ..motion })
        });
        pose_b.position += bodies.image(block.bodies);
        ([pose_a, pose_b], [a, b])
    }
}

/// Hits of the points of a block.
struct Hits {
    earliest: f32,
    depth: f32,
    may_wait: bool,
}

impl Hits {
    fn add(&mut self, time: f32, depth: f32, may_wait: bool) {
        self.earliest = self.earliest.min(time);
        self.depth = self.depth.max(depth);
        self.may_wait &= may_wait;
    }

    fn first(&self) -> Option<Hit> {
        let Self { earliest, depth, may_wait } = *self;
        (earliest < f32::INFINITY).then_some(Hit { time: earliest, depth, may_wait })
    }
}

/// More than the speed at which any point of two bodies closes.
fn closing_bound(bodies: &Bodies, block: &Block) -> f32 {
    let [a, b] = block.sides().map(|i| {
        let spin = bodies.motions[i].spin;
        if spin == Vec3A::ZERO { 0.0 } else { spin.length() * bodies.constants[i].radius }
    });
    let [from, to] = block.sides().map(|i| bodies.motions[i].velocity);
    // Half as much again, for arms that end between two bodies.
    1.5 * ((to - from).length() + a + b)
}

/// The points of a pair as its rows have them.
fn of_rows(pair: &Pair, rows: &[Row]) -> Place {
    let mut now = Place { normal: pair.normal, count: pair.count.into(), ..Place::default() };
    for (k, row) in rows.iter().enumerate().take(now.count) {
        // The surfaces on either side of the common point.
        let half = 0.5 * row.gap * pair.normal;
        (now.on_a[k], now.on_b[k]) = (row.arm_a - half, row.arm_a + half);
    }
    now
}

/// Approach speed at a point, whose bodies are in a state.
fn approach(now: &Place, k: usize, (poses, motions): &State) -> f32 {
    let common = 0.5 * (now.on_a[k] + now.on_b[k]);
    (motions[0].at(common) - motions[1].at(common - apart(poses))).dot(now.normal)
}

/// When a gap closes at a speed; never if it grows.
fn comes((gap, speed): (f32, f32)) -> f32 {
    if speed > 0.0 { gap / speed } else { f32::INFINITY }
}

/// How a search ends.
enum End {
    /// After a time, with an approach speed.
    Touch { time: f32, speed: f32 },
    /// With the least gap on the way.
    Miss { least: f32 },
}

/// By how much a hit may be late. The rows of this substep would stop a body that is at the surface at its end up to rounding, and the
/// impact would be lost.
fn late(u: f32, rest: f32, radius: f32) -> f32 {
    (LATE * rest).min(TOUCH * radius / u)
}

/// Newton steps towards the first touch of a round contact. Gaps are convex along a straight path, so they come from below. One end of a
/// capsule may leave while the other one comes.
fn search(world: &RigidWorld, pair: &Pair, points: &[Point], rest: f32, radius: f32, path: &impl Fn(f32) -> State) -> End {
    let (mut t, mut least) = (0.0, f32::INFINITY);
    for _ in 0..STEPS {
        let state = path(t);
        let now = place(world, pair, points, &state.0);
        let gaps = (0..now.count).map(|k| (now.gap(k), approach(&now, k, &state)));
        least = gaps.clone().fold(least, |least, (gap, _)| least.min(gap));
        let Some((gap, speed)) = gaps.min_by(|one, two| comes(*one).total_cmp(&comes(*two)).then(one.0.total_cmp(&two.0)))
        else {
            break;
        };
        if gap < TOUCH * radius {
            return End::Touch { time: t, speed };
        }
        if speed <= 0.0 {
            break;
        }
        if t + gap / speed > rest + late(speed, rest, radius) {
            least = least.min(gap - speed * (rest - t));
            break;
        }
        t = (t + gap / speed).min(rest);
    }
    End::Miss { least }
}
