//! Rigid bodies of one box.

use glam::{DVec3, Quat, Vec3};

use super::clumps::turn;
use super::{Cells, Kind, Random, tank};
use crate::error::Result;
use crate::scene::{Cuboid, Placement, Scene, Shape, ShapeId, Sphere};

/// Edges of a brick.
const BRICK: Vec3 = Vec3::new(0.5, 0.3, 0.4);
/// Side of the cell of a brick. A brick that is turned at random stays inside.
const CELL: f32 = 0.8;
/// Thickness, height and width of a domino.
const DOMINO: Vec3 = Vec3::new(0.2, 1.5, 0.7);
/// Distance of dominoes along their row.
const SPACING: f64 = 0.6;
/// Distance of the turns of the spiral.
const TURN: f64 = 1.6;
const RADIUS: f64 = 1.5;
/// Height of the dominoes above the floor at the start.
const CLEARANCE: f32 = 1e-3;
/// The time of a frame, in s.
pub(super) const FRAME: f32 = 1.0 / 60.0;

/// Boxes or dominoes with hard contacts.
pub(super) fn hard(kind: Kind, bodies: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = if kind == Kind::Dominoes { dominoes(bodies, random) } else { boxes(bodies, random) }?;
    scene.settings.set("contact_law", "rigid")?;
    (scene.settings.gravity, scene.settings.coulomb_friction) = (10.0, 0.4);
    Ok(scene)
}

/// A box around the origin.
fn block(edges: Vec3) -> Shape {
    Shape::new().cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges))
}

/// Boxes that fall into a walled box.
fn boxes(bricks: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = Scene::new();
    let cells = Cells::new(bricks, CELL, 0.2);
    if bricks > 0 {
        let shape = scene.add_shape(block(BRICK).name("brick").mass(1.0))?;
        let room = 0.5 * (0.98 * CELL - BRICK.length());
        for index in 0..bricks {
            let place = cells.centre(index) + random.offset(room);
            scene.add_body(Placement::new(shape).at(place).turned(turn(random)))?;
        }
    }
    scene.round_positions();
    let half = cells.half_width();
    tank(&mut scene, [half; 2], 0.8 * cells.top())?;
    Ok(scene)
}

/// Dominoes along a spiral, and a ball that is thrown at the outer one.
fn dominoes(bodies: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = Scene::new();
    let dominoes = bodies - 1;
    let shape = if dominoes > 0 { Some(scene.add_shape(block(DOMINO).name("domino").mass(1.0))?) } else { None };
    // The spiral r = RADIUS + TURN angle / (2 pi), from its end inwards.
    let mut angle = angle_at(SPACING * f64::from(dominoes));
    let mut last = place_on_spiral(angle);
    for _ in 0..dominoes {
        last = place_on_spiral(angle);
        place_domino(&mut scene, shape, last, angle)?;
        angle -= SPACING / radius_at(angle);
    }
    let outer = place_on_spiral(angle_at(SPACING * f64::from(dominoes)));
    let extent = outer.length().max(last.length()) as f32 + 3.0;
    let speed = random.between(3.5, 4.5);
    add_ball(&mut scene, speed, outer.as_vec3())?;
    scene.round_positions();
    scene.add_box(Cuboid::between([-extent, -0.5, -extent], [extent, 0.0, extent]))?;
    Ok(scene)
}

fn place_domino(scene: &mut Scene, shape: Option<ShapeId>, place: DVec3, angle: f64) -> Result<()> {
    let Some(shape) = shape else { return Ok(()) };
    // Its face looks along the spiral.
    let turn = Quat::from_rotation_y((-angle - 0.5 * std::f64::consts::PI) as f32);
    let centre = place + DVec3::Y * f64::from(0.5 * DOMINO.y + CLEARANCE);
    scene.add_body(Placement::new(shape).at(centre).turned(turn)).map(drop)
}

fn radius_at(angle: f64) -> f64 {
    RADIUS + TURN * angle / std::f64::consts::TAU
}

fn place_on_spiral(angle: f64) -> DVec3 {
    let (sin, cos) = angle.sin_cos();
    radius_at(angle) * DVec3::new(cos, 0.0, sin)
}

/// The angle of the spiral at a distance along it from its inner end.
fn angle_at(length: f64) -> f64 {
    let growth = TURN / std::f64::consts::TAU;
    ((RADIUS * RADIUS + 2.0 * growth * length).sqrt() - RADIUS) / growth
}

/// The ball that flies at the domino at `outer` with a speed in units/s.
fn add_ball(scene: &mut Scene, speed: f32, outer: Vec3) -> Result<()> {
    let way = Vec3::new(-outer.z, 0.0, outer.x).normalize_or(Vec3::X);
    let start = outer + Vec3::Y * (0.8 * DOMINO.y) + 0.8 * way;
    scene.add_sphere(Sphere::new(start, 0.15).mass(0.5).velocity(-speed * way)).map(drop)
}
