//! Bodies of several spheres: rods, capsules, springs, soft blobs, chains.

use glam::{Mat3, Vec3};

use super::{Cells, Random, ball, tank};
use crate::error::Result;
use crate::scene::{Capsule, Cuboid, Look, Rod, Scene, Sphere, SphereId, Spring, Tag};

pub(super) fn mixed(spheres: u32, random: &mut Random) -> Result<Scene> {
    const CELL: f32 = 1.1;
    /// Half the distance of two ends, and their radius. With the random offset they stay inside the cell.
    const HALF: f32 = 0.3;
    const RADIUS: f32 = 0.18;
    let mut scene = Scene::new();
    // The content of each cell is chosen first, because the number of cells determines the width of the box.
    let mut left = spheres;
    let mut pairs = Vec::new();
    while left > 0 {
        let pair = left > 1 && random.below(5) != 0;
        pairs.push(pair);
        left -= if pair { 2 } else { 1 };
    }
    let cells = Cells::new(pairs.len() as u32, CELL, 0.2);
    for (index, pair) in pairs.into_iter().enumerate() {
        let index = index as u32;
        if !pair {
            scene.add_sphere(ball(random, &cells, index, [0.15, 0.25]))?;
            continue;
        }
        let centre = cells.centre(index) + random.offset(0.49 * CELL - HALF - RADIUS);
        let arm = HALF * random.direction();
        let kind = random.below(4);
        if kind < 2 {
            scene.add_capsule(Capsule::new(centre - arm, centre + arm, RADIUS).mass(2.0))?;
            continue;
        }
        let a = scene.add_sphere(Sphere::new(centre - arm, RADIUS))?;
        let b = scene.add_sphere(Sphere::new(centre + arm, RADIUS))?;
        // The example of the thesis: a rod thinner than its ends, held by a spring instead of a fixed length.
        if kind == 2 {
            scene.add_rod(Rod::new(a, b, 0.1))?;
        }
        scene.add_spring(Spring::new(a, b, 200.0, 2.0 * HALF).damping(1.0))?;
    }
    let half = cells.half_width();
    // The bodies fill a small part of their cells, and fall straight down into the tank.
    tank(&mut scene, [half; 2], 0.6 * cells.top())?;
    Ok(scene)
}

/// Number of spheres along an edge of a blob.
const SIDE: i32 = 3;
pub(super) const BLOB: u32 = (SIDE * SIDE * SIDE) as u32;

pub(super) fn soft(spheres: u32, random: &mut Random) -> Result<Scene> {
    // The ball that encloses a blob has a diameter of 0.84 sqrt(3) + 0.32 = 1.78.
    const CELL: f32 = 1.8;
    let mut scene = Scene::new();
    // Blobs that fall on each other press single spheres. In a high pile they would press too much.
    const LAYERS: u32 = 2;
    let cells = Cells::flat(spheres.div_ceil(BLOB), LAYERS, CELL, 0.9);
    for (index, first) in (0..spheres).step_by(BLOB as usize).enumerate() {
        blob(&mut scene, random, cells.centre(index as u32), BLOB.min(spheres - first))?;
    }
    let half = cells.half_width() + 0.5;
    tank(&mut scene, [half; 2], cells.top())?;
    // Blocks on the floor for the blobs to fall onto, one below every column.
    for column in 0..cells.across * cells.across {
        let at = cells.centre(column) + random.offset(0.3);
        let size = random.between(0.2, 0.4);
        let corner = Vec3::new(at.x - size, 0.0, at.z - size);
        let block = scene.add_box(Cuboid::between(corner, corner + Vec3::splat(2.0 * size)))?;
        scene.set_tag(block, Tag::new().look(Look::Plain))?;
    }
    Ok(scene)
}

/// Adds the first `count` spheres of a cubic lattice at a random angle. Springs join neighbours along edges and face diagonals;
/// free rods along its outer edges form its skin.
fn blob(scene: &mut Scene, random: &mut Random, centre: Vec3, count: u32) -> Result<()> {
    const SPACING: f32 = 0.42;
    const RADIUS: f32 = 0.16;
    let turn = turn(random);
    let points: Vec<[i32; 3]> =
        (0..count as i32).map(|index| [index % SIDE, index / SIDE % SIDE, index / (SIDE * SIDE)]).collect();
    let mut ids: Vec<SphereId> = Vec::with_capacity(points.len());
    for (index, point) in points.iter().enumerate() {
        let place = Vec3::from_array(point.map(|part| SPACING * (part - SIDE / 2) as f32));
        let id = scene.add_sphere(Sphere::new(centre + turn * place, RADIUS))?;
        for (other, near) in points[..index].iter().zip(&ids) {
            let [x, y, z] = [0, 1, 2].map(|axis| (point[axis] - other[axis]).abs());
            let square = x * x + y * y + z * z;
            if x.max(y).max(z) > 1 || square > 2 {
                continue;
            }
            let length = SPACING * (square as f32).sqrt();
            scene.add_spring(Spring::new(*near, id, 60.0, length).damping(0.5))?;
            let outer = |axis: usize| point[axis] == other[axis] && point[axis] % (SIDE - 1) == 0;
            if square == 1 && (0..3).filter(|axis| outer(*axis)).count() == 2 {
                scene.add_rod(Rod::new(*near, id, 0.06))?;
            }
        }
        ids.push(id);
    }
    Ok(())
}

/// A random rotation.
fn turn(random: &mut Random) -> Mat3 {
    let x = random.direction();
    let y = x.any_orthonormal_vector();
    Mat3::from_cols(x, y, x.cross(y))
}

/// Number of spheres of a chain, including the fixed one.
pub(super) const CHAIN: u32 = 15;
/// Distance of the spheres of a chain, and their radius.
const LINK: f32 = 0.5;
const LINK_RADIUS: f32 = 0.15;

/// Chains that hang from beams and start pulled aside.
pub(super) fn chain(spheres: u32, random: &mut Random) -> Result<Scene> {
    /// Height of the fixed spheres, and their distances along the swing and across it.
    const HEIGHT: f32 = 8.0;
    const ALONG: f32 = 1.4;
    const ACROSS: f32 = 0.8;
    /// Greatest number of neighbouring chains that are pulled apart like a fan, so that they meet when they swing back, and the gap
    /// that the outer chains of two fans need.
    const FAN: u32 = 8;
    const GAP: f32 = 12.5;
    let mut scene = Scene::new();
    let chains = spheres.div_ceil(CHAIN);
    let mut places = chains.min(FAN);
    while u64::from(places).pow(2) < u64::from(chains) {
        places += 1;
    }
    let along = |place: u32| ALONG * place as f32 + GAP * (place / FAN) as f32;
    for chain in 0..chains {
        let (row, place) = (chain / places, chain % places);
        let hook = Vec3::new(along(place), HEIGHT, ACROSS * row as f32);
        // Up to 60 degrees to either side, different for every chain.
        let middle = 0.5 * (FAN.min(places - place / FAN * FAN) - 1) as f32;
        let aside = 1.7 * ((place % FAN) as f32 - middle) / middle.max(1.0);
        let aside = Vec3::new(aside + random.between(-0.05, 0.05), -1.0, random.between(-0.02, 0.02)).normalize();
        hang(&mut scene, hook, aside, CHAIN.min(spheres - chain * CHAIN))?;
    }
    for row in 0..chains.div_ceil(places) {
        let last = along(places.min(chains - row * places) - 1);
        let (low, z) = (HEIGHT + 1.1 * LINK_RADIUS, ACROSS * row as f32);
        // The fixed spheres of the rows behind it are seen through it.
        let beam = scene.add_box(Cuboid::between([-0.8, low, z - 0.1], [last + 0.8, low + 0.12, z + 0.1]))?;
        scene.set_tag(beam, Tag::new().look(Look::Glass))?;
    }
    Ok(scene)
}

/// Adds a chain that begins with a fixed sphere.
fn hang(scene: &mut Scene, hook: Vec3, along: Vec3, links: u32) -> Result<()> {
    let mut above: Option<SphereId> = None;
    for link in 0..links {
        let mut sphere = Sphere::new(hook + link as f32 * LINK * along, LINK_RADIUS);
        sphere.fixed = link == 0;
        let id = scene.add_sphere(sphere)?;
        if let Some(above) = above.replace(id) {
            scene.add_rod(Rod::new(above, id, 0.05).length(LINK))?;
        }
    }
    Ok(())
}
