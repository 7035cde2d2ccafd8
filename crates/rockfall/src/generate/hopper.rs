//! Spheres that run through a slot between two slopes into a box.

use glam::Vec3;

use super::{Cells, Random, ball, tank};
use crate::error::Result;
use crate::scene::{BoxId, Colour, Cuboid, Look, Scene, Tag};

const CELL: f32 = 0.42;
const SLOPES: Colour = Colour([0xb8, 0x74, 0x3a]);

/// The sizes of a hopper, in units.
struct Sizes {
    /// Half the width in x of the box, and in z of the box and the slot.
    half: f32,
    half_depth: f32,
    /// Half the width of the slot, in x.
    half_slot: f32,
    slot_height: f32,
}

impl Sizes {
    fn new(spheres: u32) -> Self {
        // The box below must hold all spheres of the block above. It is as wide as the block, and the slopes take none of its
        // room.
        let size = Cells::new(spheres, CELL, 0.0);
        let half = size.half_width().max(1.5);
        // The slot is several spheres wide. In a narrower one the spheres would form an arch and block it.
        Self { half, half_depth: size.half_width(), half_slot: (0.2 * half).max(0.8), slot_height: size.top() + 1.0 }
    }
}

/// Describes the opening, and a box that closes it.
pub(super) fn note(spheres: u32) -> String {
    const GATE: f32 = 0.3;
    // The ends of the gate are inside the slopes.
    const INSIDE: f32 = 0.2;
    let Sizes { half_depth, half_slot, slot_height, .. } = Sizes::new(spheres);
    let [x, y, z] = [half_slot + INSIDE, slot_height - GATE, half_depth].map(rounded);
    let [width, depth] = [2.0 * x, 2.0 * z].map(rounded);
    let [slot, height] = [half_slot, slot_height].map(rounded);
    format!(
        "The opening is at y = {height}, from x = -{slot} to {slot}. To close it with a gate, add this line without the #:\n\
         B -{x} {y} -{z} {width} 0 0 0 {GATE} 0 0 0 {depth}\n"
    )
}

/// Rounds to a thousandth of a unit.
fn rounded(number: f32) -> f32 {
    ((f64::from(number) * 1e3).round() / 1e3) as f32
}

pub(super) fn hopper(spheres: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = Scene::new();
    let Sizes { half, half_depth, half_slot, slot_height } = Sizes::new(spheres);
    let slope_top = slot_height + half - half_slot;
    let cells = Cells::new(spheres, CELL, slope_top + 0.2);
    for index in 0..spheres {
        scene.add_sphere(ball(random, &cells, index, [0.12, 0.2]))?;
    }
    tank(&mut scene, [half, half_depth], cells.top())?;
    for side in [-1.0, 1.0] {
        let upper = Vec3::new(side * half, slope_top, 0.0);
        let lower = Vec3::new(side * half_slot, slot_height, 0.0);
        let slope = slope(&mut scene, upper, lower, half_depth)?;
        scene.set_tag(slope, Tag::new().look(Look::Wood).colour(SLOPES))?;
    }
    Ok(scene)
}

/// Adds a slab whose upper side runs from `upper` down to `lower` and extends `half_depth` to either side in z.
fn slope(scene: &mut Scene, upper: Vec3, lower: Vec3, half_depth: f32) -> Result<BoxId> {
    const THICK: f32 = 0.4;
    let along = lower - upper;
    let across = Vec3::Z * (2.0 * half_depth);
    let normal = along.cross(across).normalize();
    let down = if normal.y > 0.0 { -normal } else { normal };
    let corner = upper - 0.5 * across;
    scene.add_box(Cuboid::new(corner, along, THICK * down, across))
}
