//! Computes the AABBs of all objects, including static ones, grown by the motion of the step.
//!
//! The AABB of a moving sphere encloses a ball about the place that the sphere reaches after `lead` steps. The radius of this
//! ball is the radius r of the sphere plus the margin
//!
//! ```text
//! (lookahead - lead) 1.05 |v| dt + (0.05 lookahead - 0.03) u + (margin_scale - 1) 0.02 u
//! ```
//!
//! with the unit u = r.
//! In scenes with JKR cohesion, `neck` r is added, the distance at which contacts tear. So a contact keeps its list entries
//! until it ends. A fixed sphere has no margin. Where contacts that begin
//! and end within a step are handled (`FLAG_CONTINUOUS`), the first two terms are at least 1.001 (lead + 1) |v| dt + 0.02 u, so that
//! the ball also holds the path of the last step.
//!
//! The centre of the sphere must stay within the margin of that place until its list is rebuilt. If it moves further,
//! `find_collisions`, `advance`, `symplectic_euler` or `drift` rejects the step. It is repeated with new lists. If lists may be rebuilt
//! in every step, 0.02 u (1.25 d + 1), but at most 0.2 u, is then added to the margin. Here d is the distance by which a body
//! left its AABB, in units of 0.02 u. The limit keeps one body far outside from making all lists long. If the larger margin
//! does not suffice, the host raises `margin_scale`.
//!
//! Every AABB is larger by a part of its largest coordinate, so that rounding far from the origin does not lose a pair.
//!
//! The AABB of a box or polygon that moves on a prescribed path is grown by a bound for the way of its vertices within `lookahead` steps
//! (`physics/walls.rs`). `move_walls` rejects a step in which it leaves that AABB.
//!
//! The AABB of a rod is the hull of two such balls, one for each end. A ball has the radius of the rod and the margin of its
//! end.

use glam::Vec3;
use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::layout::{FLAG_CONTINUOUS, FLAG_PERIODIC, ROUNDING_MARGIN};
use crate::model::part::part;
use crate::model::period::Periods;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::step::{Aabb, Step};
use crate::model::view::{Object, View};
use crate::model::world::World;
use crate::physics::smooth::unbounded;
use crate::physics::travel::{MOST_OF_REPEAT, margin_for_escape, position_ahead, trail, travel_bound};
use crate::physics::walls::{Reach, hull, hull_of_polygon};
use crate::step::moves::{Moves, NONE};
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "update_aabbs",
    wgsl: Wgsl::File(part!("step/aabbs/update_aabbs.wgsl")),
    bindings: &[
        read("state", Buffer::Start),
        read("topology", Buffer::Topology),
        write("aabbs", Buffer::Aabbs),
        read("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    // Reads position and velocity.
    moves: |_| Moves { rows: 2, tags: 1, aabbs: 1, rods: 1, ..NONE },
    cpu: update_aabbs,
};

fn update_aabbs(world: &mut World, _pass: u32) {
    if !world.status.builds_lists(REBUILD_REQUESTED) {
        return;
    }
    let objects = world.objects();
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let repeat = repeat_margin(world);
    let aabbs = (0..objects).into_par_iter().with_min_len(GRAIN).map(|id| aabb(&view, repeat, id));
    aabbs.collect_into_vec(&mut world.aabbs);
}

fn aabb(view: &View, repeat: f32, id: u32) -> Aabb {
    let bounds = |sphere: u32, radius: f32| ball_bounds(view, margin(view, repeat, sphere), sphere, radius);
    let (min, max) = match view.object(id) {
        Object::Sphere(sphere) => bounds(sphere, view.radius(sphere)),
        Object::Rod(rod) => {
            // Both ends are beside each other, also in periodic scenes.
            let rod = view.rod(rod);
            let [one, two] = rod.ends.map(|end| bounds(end, rod.radius));
            (one.0.min(two.0), one.1.max(two.1))
        }
        Object::Cuboid(cuboid) => {
            let cuboid = view.cuboid(cuboid);
            wall_bounds(view, repeat, id, hull(cuboid.corner, &cuboid.edges))
        }
        Object::Polygon(polygon) => {
            let record = view.polygon(polygon);
            let bounds = wall_bounds(view, repeat, id, hull_of_polygon(&record));
            unbounded(&record, view.body(view.object(id)) != 0, bounds)
        }
    };
    let aabb = Aabb { min: min.to_array(), id, max: max.to_array(), tag: view.tag(id) };
    Periods::of(view.step).map_or(aabb, |periods| periods.brought_back(aabb))
}

/// Returns the bounds of all places that a ball of this radius about the centre of a sphere may reach before lists are rebuilt.
fn ball_bounds(view: &View, margin: f32, sphere: u32, radius: f32) -> (Vec3, Vec3) {
    let reach = radius + view.step.layout.neck * radius + margin;
    let motion = image_velocity(view, sphere).extend(view.motion(sphere).w);
    let middle = position_ahead(view.step, view.position(sphere), motion);
    grown(view.step, (middle - reach, middle + reach))
}

/// Returns the bounds of all places that a box or polygon may reach before lists are rebuilt.
fn wall_bounds(view: &View, repeat: f32, id: u32, (min, max): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let margin = Reach::of(view, view.object(id)).map_or(0.0, |reach| reach.margin(view.step, repeat));
    grown(view.step, (min - margin, max + margin))
}

/// Bounds with room for rounding: twice as much in periodic scenes, where AABBs are compared with images.
fn grown(step: &Step, (min, max): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let share = if step.constants.flags & FLAG_PERIODIC != 0 { 2.0 * ROUNDING_MARGIN } else { ROUNDING_MARGIN };
    let room = share * min.abs().max(max.abs()).max_element();
    (min - room, max + room)
}

/// Part of the margin of a step that is repeated, in units of the radius.
fn repeat_margin(world: &World) -> f32 {
    let World { step, status, .. } = world;
    if !status.has_only_escaped() || step.lists.list_interval != 1.0 {
        return 0.0;
    }
    0.02 * margin_for_escape(f32::from_bits(status.escape_ratio)).min(MOST_OF_REPEAT)
}

/// Velocity of a sphere; in a sheared scene, that of its image in the box.
fn image_velocity(view: &View, sphere: u32) -> Vec3 {
    let velocity = view.velocity(sphere);
    Periods::of(view.step).map_or(velocity, |periods| velocity + periods.velocity_in_box(view.position(sphere)))
}

fn margin(view: &View, repeat: f32, sphere: u32) -> f32 {
    if view.is_fixed(sphere) {
        return 0.0;
    }
    let (unit, velocity) = (view.radius(sphere), image_velocity(view, sphere));
    let travel = travel_bound(view.step, velocity, unit, view.step.lists.lookahead);
    let is_continuous = view.step.constants.flags & FLAG_CONTINUOUS != 0;
    let travel = if is_continuous { travel.max(trail(view.step, velocity, unit)) } else { travel };
    // What the images of two bodies slide in a step, and as much again where a face of the box is between a sphere and the centre of its AABB.
    let travel = travel + Periods::of(view.step).map_or(0.0, |periods| periods.slide_in(3.0 * view.step.constants.dt));
    let spare = (view.step.lists.margin_scale - 1.0) * 0.02;
    travel + (spare + repeat) * unit
}
