//! The decisions of the grid broad phase: the level of each object, and the cell of each coordinate.

use rockfall::model::layout::{LEVEL_BIAS, TOP_LEVEL};
use rockfall::model::world::World;

use crate::decisions::Findings;

fn cell_size(world: &World, level: u32) -> f64 {
    f64::from(world.step.layout.cell_size) * 2.0_f64.powi(level as i32 - LEVEL_BIAS as i32)
}

/// Distance from the nearest border of a cell, in cells.
fn border(coordinate: f64) -> f64 {
    (coordinate - coordinate.round()).abs()
}

pub(crate) fn decide(world: &World, findings: &mut Findings) {
    for (id, aabb) in world.aabbs.iter().enumerate() {
        let (min, max) = (aabb.min.map(f64::from), aabb.max.map(f64::from));
        let largest = (0..3).map(|k| max[k] - min[k]).fold(0.0, f64::max);
        let level = (world.step.layout.least_level..TOP_LEVEL).find(|level| largest <= cell_size(world, *level)).unwrap();
        let size = cell_size(world, level);
        findings.decide("level", id, largest / size - 1.0);
        findings.decide("level", id, 2.0 * largest / size - 1.0);
        for k in 0..3 {
            let width = if k == 0 { 0.5 * size } else { size };
            findings.decide("cell", id, border(0.5 * (min[k] + max[k]) / width));
        }
    }
}
