//! Rigid bodies of a few spheres.

use glam::{Quat, Vec3, Vec4};

use super::{Cells, Random, ball, tank};
use crate::error::Result;
use crate::scene::{Placement, Scene, Shape};

const CELL: f32 = 0.8;
/// Distance of the farthest point of a shape from its centre. With the random offset, bodies stay inside their cells.
const REACH: f32 = 0.34;
/// Mass of a body.
const MASS: f32 = 2.0;

pub(super) fn clumps(spheres: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = Scene::new();
    let shapes = [(2, dimer()), (3, trimer()), (5, tetrapod())];
    let mut known = Vec::new();
    for (count, shape) in shapes {
        known.push((count, scene.add_shape(shape.mass(MASS))?));
    }
    // The content of each cell is chosen first, because the number of cells determines the width of the box.
    let mut left = spheres;
    let mut chosen = Vec::new();
    while left > 0 {
        let (count, shape) = known[random.below(3) as usize];
        let is_body = count <= left;
        chosen.push(is_body.then_some(shape));
        left -= if is_body { count } else { 1 };
    }
    let cells = Cells::new(chosen.len() as u32, CELL, 0.2);
    for (index, shape) in (0..).zip(chosen) {
        let Some(shape) = shape else {
            scene.add_sphere(ball(random, &cells, index, [0.15, 0.25]))?;
            continue;
        };
        let place = cells.centre(index) + random.offset(0.49 * CELL - REACH);
        scene.add_body(Placement::new(shape).at(place).turned(turn(random)))?;
    }
    scene.round_positions();
    let half = cells.half_width();
    tank(&mut scene, [half; 2], 0.8 * cells.top())?;
    Ok(scene)
}

/// A random rotation, uniform over all of them.
pub(super) fn turn(random: &mut Random) -> Quat {
    loop {
        let mut draw = || random.between(-1.0, 1.0);
        let point = Vec4::new(draw(), draw(), draw(), draw());
        if (0.01..=1.0).contains(&point.length_squared()) {
            return Quat::from_vec4(point.normalize());
        }
    }
}

fn dimer() -> Shape {
    Shape::new().name("dimer").sphere([-0.125, 0.0, 0.0], 0.2).sphere([0.125, 0.0, 0.0], 0.2)
}

/// Three spheres around the origin.
fn trimer() -> Shape {
    let place = |x: f32, y: f32| Vec3::new(x, y, 0.0) * 0.15;
    let root = 0.75_f32.sqrt();
    let shape = Shape::new().name("trimer").sphere(place(1.0, 0.0), 0.18);
    shape.sphere(place(-0.5, root), 0.18).sphere(place(-0.5, -root), 0.18)
}

/// A sphere with four legs, which point to the corners of a tetrahedron.
fn tetrapod() -> Shape {
    let legs = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let shape = Shape::new().name("tetrapod").sphere([0.0; 3], 0.14);
    let with_leg =
        |shape: Shape, (number, leg): (usize, [f32; 3])| shape.sphere(Vec3::from_array(leg) * 0.13, 0.1).rod(0, number, 0.08);
    (1..).zip(legs).fold(shape, with_leg)
}
