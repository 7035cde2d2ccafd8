//! AABBs of all objects, static ones too, grown by the motion of the step.
//!
//! A sphere moves by at most its margin, `(lookahead - lead) 1.05 |v| dt + (0.05 lookahead - 0.03) r + (margin_scale - 1) 0.02 r`,
//! before its list is made again; where it moves further, `find_collisions`, `advance` or `leap` void the step, the host raises
//! `margin_scale`, and the step is run again.
//! A rod takes the hull of its ends, each with its own margin and the radius of the rod.

use glam::Vec3;
use rayon::prelude::*;

use crate::cpu::GRAIN;
use crate::cpu::travel::{may_travel, place_ahead};
use crate::cpu::view::{Object, View};
use crate::layout::Aabb;
use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "update_aabbs",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/one_state.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("stage/update_aabbs.wgsl"),
    ],
    bindings: &[
        read("state", Buffer::Start),
        read("words", Buffer::Words),
        write("aabbs", Buffer::Aabbs),
        read("status", Buffer::Status),
    ],
    threads: Threads::WideObjects,
    cpu: update_aabbs,
};

fn update_aabbs(world: &mut World, _pass: u32) {
    if world.status.rebuild == 0 {
        return;
    }
    let objects = world.objects();
    let view = View::new(&world.step, &world.words, &world.states[0]);
    (0..objects).into_par_iter().with_min_len(GRAIN).map(|id| aabb(&view, id)).collect_into_vec(&mut world.aabbs);
}

fn aabb(view: &View, id: u32) -> Aabb {
    let (min, max) = match view.object(id) {
        Object::Sphere(sphere) => ball(view, sphere, view.radius(sphere)),
        Object::Rod(rod) => {
            let rod = view.rod(rod);
            let [one, two] = rod.ends.map(|end| ball(view, end, rod.radius));
            (one.0.min(two.0), one.1.max(two.1))
        }
        Object::Cuboid(cuboid) => {
            let cuboid = view.cuboid(cuboid);
            hull(cuboid.corner, &cuboid.edges)
        }
        Object::Polygon(polygon) => {
            let polygon = view.polygon(polygon);
            hull(polygon.corner, &[polygon.left, polygon.right])
        }
    };
    Aabb { min: min.to_array(), id, max: max.to_array(), tag: view.tag(id) }
}

/// All places that a ball of this radius about a sphere's centre may be found in within the step.
fn ball(view: &View, sphere: u32, radius: f32) -> (Vec3, Vec3) {
    let reach = radius + margin(view, sphere);
    let middle = place_ahead(view.step, view.position(sphere), view.motion(sphere));
    (middle - reach, middle + reach)
}

fn margin(view: &View, sphere: u32) -> f32 {
    if view.is_fixed(sphere) {
        return 0.0;
    }
    let radius = view.radius(sphere);
    let travel = may_travel(view.step, view.velocity(sphere), radius, view.step.lookahead);
    travel + (view.step.margin_scale - 1.0) * 0.02 * radius
}

fn hull(corner: Vec3, edges: &[Vec3]) -> (Vec3, Vec3) {
    edges.iter().fold((corner, corner), |(min, max), edge| (min + edge.min(Vec3::ZERO), max + edge.max(Vec3::ZERO)))
}
