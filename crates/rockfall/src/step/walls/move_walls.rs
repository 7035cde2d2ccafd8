//! Moves boxes and polygons to where their motions put them (docs/physics section 2.12).
//!
//! Pass 0 puts them to the start of the step, passes 1 and 2 to its middle, pass 3 to its end. A shape is computed from its geometry as
//! it is written and from the pose of its body in the table `poses`, so it depends on the time alone. The stage also writes the velocity
//! and the acceleration of its corner and the angular velocity, for contacts.
//!
//! After pass 0 the step is rejected if a shape is outside its AABB. In pass 3, new lists are requested if a shape may soon leave
//! it. The shapes are also moved in rejected steps, because lists for their repetition are built after pass 0, and because
//! the shapes do not depend on what was before.

use glam::{Mat3, Vec3};

use crate::model::buffer::Buffer;
use crate::model::counters::Tally;
use crate::model::dispatch::Threads;
use crate::model::layout::{BOX_WORDS, POLYGON_WORDS, POSE_FLOATS, WALL_BODY, WALL_WORDS};
use crate::model::muscles::MuscleClock;
use crate::model::part::part;
use crate::model::status::ESCAPED_ON_WALLS;
use crate::model::step::Layout;
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::walls::{Reach, escape};
use crate::scene::Scene;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "move_walls",
    wgsl: Wgsl::File(part!("step/walls/move_walls.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        write("topology", Buffer::Topology),
        read("poses", Buffer::Poses),
        read("aabbs", Buffer::Aabbs),
        write("status", Buffer::Status),
    ],
    threads: Threads::Walls,
    moves: |_| NONE,
    cpu: move_walls,
};

/// Puts the walls of a world where they are at the time of a clock.
pub(crate) fn place_walls(world: &mut World, scene: &Scene, clock: &MuscleClock) {
    world.set_poses(scene, clock, world.status.steps, 0);
    move_walls(world, 0);
}

/// The pose of a body.
struct Pose {
    /// R - 1.
    turn: Mat3,
    /// The reference point as it is written, and its displacement, velocity and acceleration.
    point: Vec3,
    displacement: Vec3,
    velocity: Vec3,
    acceleration: Vec3,
    spin: Vec3,
}

impl Pose {
    fn of(record: &[f32]) -> Self {
        let vector = |place: usize| Vec3::from_slice(&record[4 * place..]);
        Self {
            turn: Mat3::from_cols(vector(0), vector(1), vector(2)).transpose(),
            point: vector(3),
            displacement: vector(4),
            velocity: vector(5),
            acceleration: vector(6),
            spin: vector(7),
        }
    }

    /// Where a corner is. One that does not turn is moved by the displacement alone.
    fn of_corner(&self, corner: Vec3) -> Vec3 {
        corner + (self.turn * (corner - self.point) + self.displacement)
    }

    fn of_edge(&self, edge: Vec3) -> Vec3 {
        edge + self.turn * edge
    }

    /// The record of a shape whose corner is now at `corner`, without the number of the body.
    fn motion_of(&self, corner: Vec3) -> [Vec3; 3] {
        let lever = corner - (self.point + self.displacement);
        let around = self.spin.cross(lever);
        [self.velocity + around, self.spin, self.acceleration + self.spin.cross(around)]
    }
}

fn move_walls(world: &mut World, pass: u32) {
    if world.step.layout.walls_at == 0 {
        return;
    }
    let Layout { boxes, polygons, bodies, walls_at, boxes_at, polygons_at, .. } = world.step.layout;
    let half_steps = 2 * world.status.steps.wrapping_sub(world.step.constants.pose_step) + [0, 1, 1, 2][pass as usize];
    // A world that a program runs on its own has no more poses.
    let half_steps = half_steps.min(world.step.constants.pose_rows.saturating_sub(1));
    let pose = |body: u32| {
        let at = ((half_steps * bodies + body - 1) * POSE_FLOATS) as usize;
        Pose::of(&world.poses[at..][..POSE_FLOATS as usize])
    };
    let written_at = walls_at + (boxes + polygons) * WALL_WORDS;
    for index in 0..boxes + polygons {
        let record = (walls_at + index * WALL_WORDS) as usize;
        let body = world.topology[record + WALL_BODY];
        if body == 0 {
            continue;
        }
        let (offset, to, words) = if index < boxes {
            (index * BOX_WORDS, boxes_at + index * BOX_WORDS, BOX_WORDS)
        } else {
            let polygon = index - boxes;
            (boxes * BOX_WORDS + polygon * POLYGON_WORDS, polygons_at + polygon * POLYGON_WORDS, POLYGON_WORDS)
        };
        let pose = pose(body);
        let written = |place: usize| {
            let at = (written_at + offset) as usize + 3 * place;
            Vec3::from_array(std::array::from_fn(|axis| f32::from_bits(world.topology[at + axis])))
        };
        let vectors: Vec<Vec3> = (0..words as usize / 3)
            .map(|place| if place == 0 { pose.of_corner(written(0)) } else { pose.of_edge(written(place)) })
            .collect();
        let motion = pose.motion_of(vectors[0]);
        let mut put = |at: usize, vector: Vec3| {
            world.topology[at..at + 3].copy_from_slice(&vector.to_array().map(f32::to_bits));
        };
        (0..).zip(&vectors).for_each(|(place, vector)| put(to as usize + 3 * place, *vector));
        (0..).zip(motion).for_each(|(place, vector)| put(record + 4 * place, vector));
    }
    if pass > 0 && world.status.rejected == 0 {
        check(world, pass).add_to(&mut world.status);
    }
}

/// Which shapes are outside their AABBs, and whether one may soon be.
fn check(world: &World, pass: u32) -> Tally {
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let mut tally = Tally::default();
    for id in world.step.movers()..world.step.objects() {
        let object: Object = view.object(id);
        if let Some(reach) = Reach::of(&view, object) {
            let aabb = &world.aabbs[id as usize];
            tally.note_escape(ESCAPED_ON_WALLS + pass - 1, escape(&view, aabb, &reach, 0.0));
            tally.rebuild |= pass == 3 && escape(&view, aabb, &reach, world.step.lists.list_interval) > 0.0;
        }
    }
    tally
}
