//! Spheres that run through a slot between two slopes into a box.

use glam::Vec3;

use super::{Cells, Random, ball, walled_box};
use crate::error::Result;
use crate::scene::{Cuboid, Scene};

pub(super) fn hopper(spheres: u32, random: &mut Random) -> Result<Scene> {
    const CELL: f32 = 0.42;
    let mut scene = Scene::new();
    // The box below holds what the block above holds: it is as wide, and the slopes fill none of it.
    let size = Cells::new(spheres, CELL, 0.0);
    let half = size.half_width().max(1.5);
    // Several spheres wide, else they arch and block it.
    let half_slot = (0.2 * half).max(0.8);
    let slot_height = size.top() + 1.0;
    let slope_top = slot_height + half - half_slot;
    let cells = Cells::new(spheres, CELL, slope_top + 0.2);
    for index in 0..spheres {
        scene.add_sphere(ball(random, &cells, index, [0.12, 0.2]))?;
    }
    walled_box(&mut scene, half, size.half_width(), cells.top() + 1.0)?;
    for side in [-1.0, 1.0] {
        let upper = Vec3::new(side * half, slope_top, 0.0);
        let lower = Vec3::new(side * half_slot, slot_height, 0.0);
        slope(&mut scene, upper, lower, size.half_width())?;
    }
    Ok(scene)
}

/// A slab whose upper side runs from `upper` down to `lower`, and `half_depth` to either side in z.
fn slope(scene: &mut Scene, upper: Vec3, lower: Vec3, half_depth: f32) -> Result<()> {
    const THICK: f32 = 1.0;
    let along = lower - upper;
    let across = Vec3::Z * (2.0 * half_depth);
    let normal = along.cross(across).normalize();
    let down = if normal.y > 0.0 { -normal } else { normal };
    let corner = upper - 0.5 * across;
    scene.add_box(Cuboid::new(corner, along, THICK * down, across))?;
    Ok(())
}
