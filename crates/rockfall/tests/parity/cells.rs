//! The decisions of the grid broad phase: on which level an object is, and in which cell a coordinate lies.

use rockfall::layout::{LEVEL_BIAS, TOP_LEVEL};
use rockfall::world::World;

use crate::decisions::Findings;

fn cell_size(world: &World, level: u32) -> f64 {
    f64::from(world.step.cell_size) * 2.0_f64.powi(level as i32 - LEVEL_BIAS as i32)
}

/// Distance from the next border of a cell, in cells.
fn border(coordinate: f64) -> f64 {
    (coordinate - coordinate.round()).abs()
}

pub(crate) fn decide(world: &World, findings: &mut Findings) {
    let bounds = |id: usize| {
        let aabb = &world.aabbs[id];
        [aabb.min.map(f64::from), aabb.max.map(f64::from)]
    };
    let mut used = Vec::new();
    for id in 0..world.aabbs.len() {
        let [min, max] = bounds(id);
        let largest = (0..3).map(|k| max[k] - min[k]).fold(0.0, f64::max);
        let level = (0..TOP_LEVEL).find(|level| largest <= cell_size(world, *level)).unwrap();
        let size = cell_size(world, level);
        findings.decide("level", id, largest / size - 1.0);
        findings.decide("level", id, 2.0 * largest / size - 1.0);
        for k in 0..3 {
            findings.decide("cell", id, border(0.5 * (min[k] + max[k]) / size));
        }
        used.push(level);
    }
    used.sort_unstable();
    used.dedup();
    for id in 0..world.movers() as usize {
        let [min, max] = bounds(id);
        for size in used.iter().map(|level| cell_size(world, *level)) {
            for k in 0..3 {
                let slack = 0.5005 * size + 1e-6 * min[k].abs().max(max[k].abs());
                findings.decide("cells around", id, border((min[k] - slack) / size));
                findings.decide("cells around", id, border((max[k] + slack) / size));
            }
        }
    }
}
