//! Machines with walls that move, with grains in them, in SI units: a box that is shaken, a shear cell, a mixer, and a screw.

use std::f32::consts::PI;
use std::f64::consts::TAU;

use glam::{DVec3, Vec2, Vec3};

use super::grains::{CELL, DENSITY, GRAVITY, grains, lattice};
use super::{Cells, FLOOR, Random, STEEL, furnish};
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::{Colour, Cuboid, Look, MaterialId, Motion, MotionTerm, Pair, Polygon, Scene, Sphere, Tag};

/// Young's modulus, in Pa. With it, overlaps stay below 1 % of the radius.
const YOUNG: f32 = 5e6;
/// Radius of the grains, in m.
const RADIUS: f32 = 0.003;
/// Time step: a tenth of the Rayleigh time of a grain, in s.
pub(super) const MACHINE_STEP: f32 = 3e-5;
/// Colour of what turns.
const BRASS: Colour = Colour([0xc9, 0x9f, 0x58]);
/// Facets of a full turn of a cylinder or a screw.
const FACETS: u32 = 96;

/// An empty scene, and the material of its grains and walls.
fn empty() -> Result<(Scene, MaterialId)> {
    let (mut scene, grain) = grains(YOUNG)?;
    scene.set_pair(grain, grain, Pair::default().restitution(0.6).friction(0.4).rolling_friction(0.05))?;
    Ok((scene, grain))
}

fn grain(place: Vec3, random: &mut Random, material: MaterialId) -> Sphere {
    let radius = random.between(0.85, 1.0) * RADIUS;
    let offset = random.offset(0.9 * (CELL - 1.0) * RADIUS);
    Sphere::new(place + offset, radius).density(DENSITY).material(material)
}

/// A box that is shaken up and down with three times the acceleration of gravity, at 20 Hz.
pub(super) fn vibrated(spheres: u32, random: &mut Random) -> Result<Scene> {
    const FREQUENCY: f64 = 20.0;
    const GAMMA: f64 = 3.0;
    /// Thickness of the floor and of the walls, in m.
    const THICK: f32 = 0.01;
    const WALL: f32 = 0.003;
    let (mut scene, material) = empty()?;
    let rate = TAU * FREQUENCY;
    let amplitude = DVec3::Y * (GAMMA * f64::from(GRAVITY) / (rate * rate));
    let motion = scene.add_motion(Motion::new("shaker", MotionTerm::oscillation(amplitude, FREQUENCY)))?;
    let cells = Cells::new(spheres, 2.0 * CELL * RADIUS, 0.0);
    for index in 0..spheres {
        scene.add_sphere(grain(cells.centre(index), random, material))?;
    }
    let (half, top) = (cells.half_width() + RADIUS, cells.top() + 20.0 * RADIUS);
    let out = half + WALL;
    let walls = [
        ([-out, -THICK, -out], [out, 0.0, out]),
        ([-out, 0.0, -out], [-half, top, out]),
        ([half, 0.0, -out], [out, top, out]),
        ([-half, 0.0, -out], [half, top, -half]),
        ([-half, 0.0, half], [half, top, out]),
    ];
    let mut add = |(from, to)| scene.add_box(Cuboid::between(from, to).material(material).motion(motion));
    let [floor, left, right, back, front] = walls;
    let boxes = [add(floor)?, add(left)?, add(right)?, add(back)?, add(front)?];
    furnish(&mut scene, boxes)?;
    Ok(scene)
}

/// A layer of grains between two ribbed plates that slide past each other, in a box that is periodic along them. The upper plate first
/// comes down.
pub(super) fn shear_cell(spheres: u32, random: &mut Random) -> Result<Scene> {
    /// Speed of a plate, in m/s, the time in which the upper one comes down, in s, and the part of the volume that is then filled.
    const SPEED: f64 = 0.1;
    const PRESS: f64 = 0.2;
    const FILLED: f32 = 0.53;
    const THICK: f32 = 2.0 * RADIUS;
    let (mut scene, material) = empty()?;
    let cell = 2.0 * CELL * RADIUS;
    let side = ((spheres as f32 / 2.0).cbrt().ceil() as u32).max(6);
    let length = side as f32 * cell;
    [0, 2].into_iter().try_for_each(|axis| scene.set_periodic(axis, Some([0.0, length])))?;
    for index in 0..spheres {
        let [x, y, z] = [index % side, index / (side * side), index / side % side].map(|place| (place as f32 + 0.5) * cell);
        scene.add_sphere(grain(Vec3::new(x, y + RADIUS, z), random, material))?;
    }
    let solid: f32 = scene.spheres().iter().map(|sphere| 4.0 / 3.0 * PI * sphere.radius.powi(3)).sum();
    let top = (spheres.div_ceil(side * side) as f32) * cell + 2.0 * RADIUS;
    let pressed = (solid / (FILLED * length * length)).min(0.9 * top);
    let slide = |name: &str, speed: f64| Motion::new(name, MotionTerm::translation([speed, 0.0, 0.0]));
    let down = MotionTerm::translation([0.0, -f64::from(top - pressed) / PRESS, 0.0]).during(0.0, PRESS);
    let base = scene.add_motion(slide("base", -SPEED))?;
    let lid = scene.add_motion(slide("lid", SPEED).and(down))?;
    let mut add = |motion, from: [f32; 2], low: f32, high: f32| {
        let cuboid = Cuboid::between([from[0], low, 0.0], [from[1], high, length]);
        let plate = scene.add_box(cuboid.material(material).motion(motion))?;
        scene.set_tag(plate, Tag::new().look(Look::Plain).colour(STEEL))
    };
    add(base, [0.0, length], -THICK, 0.0)?;
    add(lid, [0.0, length], top, top + THICK)?;
    for rib in 0..side / 2 {
        let from = 2.0 * cell * rib as f32;
        add(base, [from, from + RADIUS], 0.0, RADIUS)?;
        add(lid, [from, from + RADIUS], top - RADIUS, top)?;
    }
    Ok(scene)
}

/// An upright drum with a shaft and four blades at its bottom that turn once a second.
pub(super) fn mixer(spheres: u32, random: &mut Random) -> Result<Scene> {
    let (mut scene, material) = empty()?;
    // A bed as high as 0.4 of the radius, above the blades, which stick out of it when it has come down.
    let drum = (spheres as f32 / (0.4 * 3.0)).cbrt().max(3.0) * 2.0 * CELL * RADIUS;
    let shaft = 0.1 * drum;
    let disc: Vec<Vec2> = disc(drum).into_iter().filter(|place| place.length() > shaft + CELL * RADIUS).collect();
    for index in 0..spheres as usize {
        let (place, layer) = (disc[index % disc.len()], index / disc.len());
        let height = 0.4 * drum + (layer as f32 + 1.0) * 2.0 * CELL * RADIUS;
        scene.add_sphere(grain(Vec3::new(place.x, height, place.y), random, material))?;
    }
    let (radius, height) = (f64::from(drum), f64::from(1.6 * drum));
    let wall = Mesh::cylinder(radius, height, FACETS)?.transformed(1.0, DVec3::X, -90.0, DVec3::ZERO)?;
    add_glass(&mut scene, &wall, material)?;
    let wide = 1.15 * drum;
    let floor = scene.add_box(Cuboid::between([-wide, -0.2 * drum, -wide], [wide, 0.0, wide]).material(material))?;
    scene.set_tag(floor, Tag::new().look(Look::Wood).colour(FLOOR))?;
    let motion = scene.add_motion(Motion::new("blades", MotionTerm::turn(TAU, DVec3::Y, DVec3::ZERO)))?;
    let blades = blades(radius, f64::from(RADIUS))?;
    for id in scene.add_mesh(&blades, |triangle| triangle.material(material).motion(motion))?.ids {
        scene.set_tag(id, Tag::new().colour(BRASS))?;
    }
    let shaft = Polygon::cylinder([0.0; 3], [0.0, 1.0, 0.0], shaft, 1.8 * drum).material(material).motion(motion);
    let shaft = scene.add_polygon(shaft)?;
    scene.set_tag(shaft, Tag::new().colour(STEEL))?;
    Ok(scene)
}

/// Four plates that rise from the bottom by 45 degrees, from near the axis to near the wall.
fn blades(radius: f64, gap: f64) -> Result<Mesh> {
    let (inner, outer, high) = (0.1 * radius, radius - 2.0 * gap, 0.35 * radius);
    let corners = [(inner, gap, 0.0), (outer, gap, 0.0), (outer, gap + high, -high), (inner, gap + high, -high)];
    let turned = |quarter: u32| {
        corners.map(|(x, y, z)| {
            let (x, z) = [(x, z), (-z, x), (-x, -z), (z, -x)][quarter as usize];
            [x as f32, y as f32, z as f32]
        })
    };
    let triangles = (0..4).flat_map(|blade| [[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|at| at + 4 * blade)));
    Mesh::new((0..4).flat_map(turned).collect(), triangles.collect())
}

/// A level tube whose lower half has grains in it, with a screw that turns once a second and takes them along x. Both ends are closed.
pub(super) fn screw(spheres: u32, random: &mut Random) -> Result<Scene> {
    const ASPECT: f32 = 6.0;
    const TUBE: Colour = Colour([0xc9, 0xd1, 0xd6]);
    let (mut scene, material) = empty()?;
    let cell = 2.0 * CELL * RADIUS;
    let mut tube = (spheres as f32 * cell.powi(3) / ASPECT).cbrt().max(4.0 * cell);
    let (shaft, pitch, places) = loop {
        let (shaft, pitch, middle) = (0.25 * tube, 1.2 * tube, 0.5 * ASPECT * tube);
        let all = lattice(tube, middle, cell, u32::MAX).into_iter().map(|place| place + middle * Vec3::Z);
        let half: Vec<Vec3> = all.filter(|place| place.y < 0.0 && is_clear(*place, shaft, pitch)).collect();
        if half.len() >= spheres as usize {
            break (shaft, pitch, half);
        }
        tube *= 1.02;
    };
    for place in places.into_iter().take(spheres as usize) {
        scene.add_sphere(grain(Vec3::new(place.z, place.y, -place.x), random, material))?;
    }
    // The flight leaves a gap in which no grain gets stuck.
    let (middle, flight) = (0.5 * ASPECT * tube, tube - 0.75 * RADIUS);
    let length = f64::from(ASPECT * tube);
    let motion = scene.add_motion(Motion::new("screw", MotionTerm::turn(-TAU, DVec3::X, DVec3::ZERO)))?;
    let turns = length / f64::from(pitch);
    let walls = [
        (Mesh::cylinder(tube.into(), length, FACETS)?, None, TUBE),
        (Mesh::cylinder(shaft.into(), length, FACETS / 2)?, Some(motion), BRASS),
        (Mesh::helix(shaft.into(), flight.into(), pitch.into(), turns, FACETS)?, Some(motion), BRASS),
    ];
    for (mesh, motion, colour) in walls {
        let along_x = mesh.transformed(1.0, DVec3::Y, 90.0, DVec3::ZERO)?;
        for id in scene.add_mesh(&along_x, |triangle| Polygon { motion, ..triangle.material(material) })?.ids {
            scene.set_tag(id, Tag::new().colour(colour))?;
        }
    }
    let wide = 1.2 * tube;
    for [from, to] in [[-0.2 * tube, 0.0], [2.0 * middle, 2.0 * middle + 0.2 * tube]] {
        let end = scene.add_box(Cuboid::between([from, -wide, -wide], [to, wide, wide]).material(material))?;
        scene.set_tag(end, Tag::new().colour(TUBE))?;
    }
    Ok(scene)
}

/// Adds a wall that can be looked through.
fn add_glass(scene: &mut Scene, mesh: &Mesh, material: MaterialId) -> Result<()> {
    for id in scene.add_mesh(mesh, |triangle| triangle.material(material))?.ids {
        scene.set_tag(id, Tag::new().look(Look::Glass))?;
    }
    Ok(())
}

/// Whether a grain at a place touches neither the shaft of a screw nor its flight, which begins at the x axis and turns once per pitch.
fn is_clear(place: Vec3, shaft: f32, pitch: f32) -> bool {
    let from_axis = place.truncate().length();
    let ahead = place.z / pitch - place.y.atan2(place.x) / TAU as f32;
    let apart = (ahead - ahead.round()).abs() * pitch;
    // The flight is steeper near the shaft.
    let slope = pitch / (TAU as f32 * from_axis.max(shaft));
    from_axis > shaft + 1.1 * RADIUS && apart / (1.0 + slope * slope).sqrt() > 1.1 * CELL * RADIUS
}

/// The places of the cells of a square lattice in a disc, in x and y.
fn disc(radius: f32) -> Vec<Vec2> {
    let cell = 2.0 * CELL * RADIUS;
    let half = (radius / cell) as i32 + 1;
    let places = (-half..=half).flat_map(|x| (-half..=half).map(move |y| cell * Vec2::new(x as f32, y as f32)));
    places.filter(|place| place.length() < radius - 0.5 * cell).collect()
}

/// What the author of a scene of a machine should know.
pub(super) fn note(name: &str) -> String {
    format!("SI units. The walls follow the motion `{name}`; change its numbers in the line @motion.\n")
}

#[cfg(test)]
mod tests {
    use super::super::Kind;
    use super::*;

    /// Grains of the machines start apart from the walls and from each other.
    #[test]
    fn grains_start_free() {
        for kind in [Kind::Vibrated, Kind::ShearCell, Kind::Mixer, Kind::Screw] {
            for spheres in [1, 50, 700] {
                let scene = kind.generate(spheres, 3).unwrap();
                assert_eq!(scene.counts().spheres, spheres as usize, "{kind}");
                let placement = scene.placement().unwrap();
                assert!(placement.deepest < 1e-3 && placement.falling.is_empty(), "{kind} {spheres}: {placement:?}");
                assert!(!scene.motions().is_empty() && scene.run.dt == Some(MACHINE_STEP), "{kind}");
            }
        }
    }
}
