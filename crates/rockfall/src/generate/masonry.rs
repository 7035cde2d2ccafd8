//! A wall of bricks, an arch of stones, and a pile of convex hulls, with hard contacts.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_6};

use glam::{Quat, Vec2, Vec3};

use super::clumps::turn;
use super::{Cells, Random, tank};
use crate::error::Result;
use crate::scene::{Cuboid, Placement, Scene, Shape, ShapeId, Sphere};

/// Length, height and depth of a brick of the wall.
const BRICK: Vec3 = Vec3::new(0.5, 0.2, 0.25);
/// Space between neighbours at the start, in units.
const JOINT: f32 = 1e-4;
/// Length of a stone of the arch along the middle of the ring.
const STONE: f32 = 0.4;
/// Thickness of the ring as a share of its radius. A semicircle stands from 0.1075 on (Milankovitch 1907).
const THICKNESS: f32 = 0.25;
/// Side of the cell of a hull.
const CELL: f32 = 0.8;
/// Number of different hulls, and of their points.
const HULLS: u32 = 8;
const POINTS: u32 = 10;

/// A wall in running bond, and a heavy ball that flies at it.
pub(super) fn bricks(bodies: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = hard();
    let bricks = bodies - 1;
    let columns = (1.6 * f64::from(bricks)).sqrt().ceil().max(2.0) as u32;
    let mut height = 0.0;
    if bricks > 0 {
        let shape = scene.add_shape(Shape::new().cuboid(Cuboid::between(-0.5 * BRICK, 0.5 * BRICK)).name("brick").mass(1.0))?;
        let (mut left, mut row) = (bricks, 0);
        while left > 0 {
            let own = (columns - row % 2).min(left);
            let first = -0.5 * (columns - 1 - row % 2) as f32;
            height = (row as f32 + 1.0) * (BRICK.y + JOINT);
            for column in 0..own {
                let x = (first + column as f32) * (BRICK.x + JOINT);
                scene.add_body(Placement::new(shape).at(Vec3::new(x, height - 0.5 * BRICK.y, 0.0)))?;
            }
            (left, row) = (left - own, row + 1);
        }
    }
    let speed = random.between(8.0, 10.0);
    let ball = Sphere::new([random.between(-0.2, 0.2), 0.4 * height + 0.5, -4.0], 0.25).mass(8.0);
    scene.add_sphere(ball.velocity([0.0, 1.0, speed]))?;
    ground(&mut scene, 0.5 * columns as f32 * BRICK.x + 6.0)?;
    Ok(scene)
}

/// A semicircular arch, and a ball that falls on it.
pub(super) fn arch(bodies: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = hard();
    scene.settings.coulomb_friction = 0.8;
    let stones = bodies - 1;
    // Fewer than three stones are no arch, and fall.
    let half = (FRAC_PI_2 / stones.max(1) as f32).min(FRAC_PI_6);
    let radius = (0.5 * STONE / half).max(1.0);
    let thickness = THICKNESS * radius;
    if stones > 0 {
        let shape = stone(&mut scene, radius, thickness, half)?;
        for number in 0..stones {
            let angle = FRAC_PI_2 + half * (2.0 * number as f32 + 1.0 - stones as f32);
            let place = radius * Vec2::from_angle(angle);
            let turn = Quat::from_rotation_z(angle - FRAC_PI_2);
            scene.add_body(Placement::new(shape).at(place.extend(0.0)).turned(turn))?;
        }
    }
    let top = radius + 0.5 * thickness;
    let size = 0.1 * radius;
    let ball = Sphere::new([random.between(-0.2, 0.2) * radius, top + 2.0 * size, 0.0], size);
    scene.add_sphere(ball.mass(if stones > 0 { 0.5 } else { 1.0 }))?;
    ground(&mut scene, 2.0 * radius + 2.0)?;
    Ok(scene)
}

/// A stone about the middle of the ring, with y outward.
fn stone(scene: &mut Scene, radius: f32, thickness: f32, half: f32) -> Result<ShapeId> {
    let depth = 0.5 * thickness;
    let mut corners = Vec::with_capacity(8);
    for distance in [radius - 0.5 * thickness, radius + 0.5 * thickness] {
        for side in [-1.0, 1.0] {
            // Faces of neighbours are parallel, and apart by twice this.
            let (sin, cos) = half.sin_cos();
            let face = Vec2::new(side * (distance * sin - 0.5 * JOINT * cos), distance * cos + 0.5 * JOINT * sin - radius);
            corners.extend([-depth, depth].map(|z| face.extend(z)));
        }
    }
    scene.add_shape(Shape::new().name("stone").mass(1.0).add_hull(corners)?)
}

/// Convex hulls that fall into a walled box.
pub(super) fn hulls(bodies: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = hard();
    let cells = Cells::new(bodies, CELL, 0.2);
    let mut shapes = Vec::new();
    for number in 0..HULLS.min(bodies) {
        let axes = Vec3::new(random.between(0.16, 0.22), random.between(0.16, 0.22), random.between(0.16, 0.22));
        let points: Vec<Vec3> = (0..POINTS).map(|_| axes * random.direction()).collect();
        shapes.push(scene.add_shape(Shape::new().name(format!("rock{number}")).mass(1.0).add_hull(points)?)?);
    }
    for index in 0..bodies {
        let place = cells.centre(index) + random.offset(0.02);
        let shape = shapes[index as usize % shapes.len()];
        scene.add_body(Placement::new(shape).at(place).turned(turn(random)))?;
    }
    scene.round_positions();
    let half = cells.half_width();
    tank(&mut scene, [half; 2], 0.8 * cells.top())?;
    Ok(scene)
}

fn hard() -> Scene {
    let mut scene = Scene::new();
    scene.settings.contact_law = crate::settings::ContactLaw::Rigid;
    (scene.settings.gravity, scene.settings.coulomb_friction) = (10.0, 0.5);
    scene
}

fn ground(scene: &mut Scene, half: f32) -> Result<()> {
    scene.round_positions();
    scene.add_box(Cuboid::between([-half, -0.5, -half], [half, 0.0, half])).map(drop)
}
