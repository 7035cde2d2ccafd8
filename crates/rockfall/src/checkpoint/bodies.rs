//! Shapes and rigid bodies in a checkpoint: the length of what follows in bytes, 0 if there are none; the number of shapes, each with its
//! mass, spheres, rods, boxes and hulls; the number of bodies, each with its shape, its first sphere, its first rod and its state; their
//! external forces and torques, left out if all are 0. Mass properties follow from the shapes.

use glam::{Quat, Vec3};

use super::tags;
use super::words::{Damage, Head, Words};
use crate::rigid::shape::MOST_VERTICES;
use crate::scene::{Cuboid, MaterialId, RigidBody, Scene, Shape, ShapeBox, ShapeMass, ShapeRod, ShapeSphere, Tag, shared};

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut head = Head::default();
    if scene.shapes().is_empty() {
        return head.block();
    }
    head.u32(scene.shapes().len() as u32);
    scene.shapes().iter().for_each(|shape| put_shape(&mut head, scene, shape));
    head.u64(scene.bodies().len() as u64);
    scene.bodies().iter().for_each(|body| put_body(&mut head, scene, body));
    if scene.bodies().iter().any(|body| body.force != Vec3::ZERO || body.torque != Vec3::ZERO) {
        let loads = scene.bodies().iter().flat_map(|body| [body.force, body.torque]);
        loads.flat_map(|load| load.to_array()).for_each(|number| head.f32(number));
    }
    head.block()
}

/// Adds the shapes and bodies to a scene that has all other objects.
pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let mut words = Words::new(given);
    for _ in 0..words.u32()? {
        let shape = read_shape(&mut words, scene)?;
        scene.add_shape(shape)?;
    }
    for _ in 0..words.u64()? {
        let body = read_body(&mut words, scene)?;
        body.validate()?;
        scene.keep_body(body);
    }
    if !words.is_empty() {
        for body in scene.bodies.objects_mut() {
            (body.force, body.torque) = (words.vec3()?, words.vec3()?);
            body.validate()?;
        }
    }
    words.end()
}

fn put_shape(head: &mut Head, scene: &Scene, shape: &Shape) {
    head.text(shape.name.as_deref().unwrap_or_default());
    let (kind, numbers) = match shape.mass {
        ShapeMass::Mass(mass) => (0, [mass, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ShapeMass::Density(density) => (1, [density, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ShapeMass::Given { mass, centre: c, inertia: [xx, yy, zz, xy, xz, yz] } => {
            (2, [mass, c.x, c.y, c.z, xx, yy, zz, xy, xz, yz])
        }
    };
    head.u32(kind);
    numbers.into_iter().for_each(|number| head.f32(number));
    head.u32(shape.spheres.len() as u32);
    for ShapeSphere { centre, radius, group, material, tag } in &shape.spheres {
        centre.to_array().into_iter().chain([*radius]).for_each(|number| head.f32(number));
        put_part(head, scene, *group, *material, tag.as_deref());
    }
    head.u32(shape.rods.len() as u32);
    for ShapeRod { end1, end2, radius, group, material, tag } in &shape.rods {
        [end1, end2].into_iter().for_each(|end| head.u32(*end as u32));
        head.f32(*radius);
        put_part(head, scene, *group, *material, tag.as_deref());
    }
    head.f32(shape.rounding);
    head.u32(shape.boxes.len() as u32);
    for ShapeBox { cuboid, tag, .. } in &shape.boxes {
        let vectors = [cuboid.corner].into_iter().chain(cuboid.edges);
        vectors.flat_map(|v| v.to_array()).for_each(|number| head.f32(number));
        put_part(head, scene, cuboid.group, cuboid.material, tag.as_deref());
    }
    head.u32(shape.hulls.len() as u32);
    for hull in &shape.hulls {
        head.u32(hull.points().len() as u32);
        hull.points().iter().flat_map(|point| point.to_array()).for_each(|number| head.f32(number));
        put_part(head, scene, hull.group(), hull.material(), hull.tag.as_deref());
    }
}

fn read_shape(words: &mut Words, scene: &Scene) -> Result<Shape, Damage> {
    let mut shape = Shape::new();
    shape.name = Some(words.text()?).filter(|name| !name.is_empty());
    let kind = words.u32()?;
    let mut numbers = [0.0; 10];
    for number in &mut numbers {
        *number = words.f32()?;
    }
    let [mass, x, y, z, inertia @ ..] = numbers;
    shape = match kind {
        0 => shape.mass(mass),
        1 => shape.density(mass),
        2 => shape.mass_properties(mass, [x, y, z], inertia),
        other => return Err(Damage::new(format!("a shape has a mass of kind {other}, expected 0 to 2"))),
    };
    for _ in 0..words.u32()? {
        let (centre, radius) = (words.vec3()?, words.f32()?);
        shape = read_part(shape, words, scene)?.sphere(centre, radius);
    }
    for _ in 0..words.u32()? {
        let ([a, b], radius) = ([words.u32()?, words.u32()?].map(|end| end as usize), words.f32()?);
        shape = read_part(shape, words, scene)?.rod(a, b, radius);
    }
    shape = shape.rounding(words.f32()?);
    for _ in 0..words.u32()? {
        let [corner, i, j, k] = [words.vec3()?, words.vec3()?, words.vec3()?, words.vec3()?];
        shape = read_part(shape, words, scene)?.cuboid(Cuboid::new(corner, i, j, k));
    }
    for _ in 0..words.u32()? {
        let count = words.u32()?;
        if count > MOST_VERTICES {
            return Err(Damage::new(format!("a hull has {count} vertices, expected at most {MOST_VERTICES}")));
        }
        let points = (0..count).map(|_| words.vec3()).collect::<Result<_, _>>()?;
        shape = read_part(shape, words, scene)?;
        shape.push_hull(points)?;
    }
    Ok(shape)
}

/// Writes the group, the material and the tag of a part.
fn put_part(head: &mut Head, scene: &Scene, group: u16, material: Option<MaterialId>, tag: Option<&Tag>) {
    head.u32(u32::from(group));
    // The scene contains the materials of all its objects.
    head.u32(scene.material_number(material).unwrap_or_default().into());
    tags::put_tag(head, tag.unwrap_or(&Tag::default()));
}

/// Reads the group, the material and the tag of the part that is added next.
fn read_part(shape: Shape, words: &mut Words, scene: &Scene) -> Result<Shape, Damage> {
    let (group, material) = (words.u32()?, words.u32()?);
    let group = group.try_into().map_err(|_| Damage::new(format!("a part of a shape has the group {group}")))?;
    if material as usize > scene.materials().len() {
        let count = scene.materials().len();
        return Err(Damage::new(format!("a part of a shape has the material {material} of {count}")));
    }
    Ok(shape.with(group, scene.material_of_number(material as u16), shared(tags::read(words)?)))
}

fn put_body(head: &mut Head, scene: &Scene, body: &RigidBody) {
    let RigidBody { shape, position, position_low, orientation: q, velocity, angular_momentum, spheres, rods, .. } = body;
    head.u32(scene.shapes.index(*shape).unwrap_or_default() as u32);
    // The spheres of a body follow each other in the scene, and so do its rods.
    let first_sphere = spheres.first().and_then(|id| scene.spheres.index(*id).ok());
    let first_rod = rods.first().and_then(|id| scene.rods.index(*id).ok());
    [first_sphere, first_rod].into_iter().for_each(|index| head.u32(index.unwrap_or_default() as u32));
    let vectors = [position, position_low, velocity, angular_momentum].into_iter().flat_map(|vector| vector.to_array());
    vectors.chain([q.x, q.y, q.z, q.w]).for_each(|number| head.f32(number));
}

fn read_body(words: &mut Words, scene: &Scene) -> Result<RigidBody, Damage> {
    let [index, first_sphere, first_rod] = [words.u32()?, words.u32()?, words.u32()?].map(|index| index as usize);
    let shape =
        scene.shapes().get(index).ok_or_else(|| Damage::new(format!("a body has the shape {index}, which is missing")))?;
    let (spheres, rods) = (first_sphere..first_sphere + shape.sphere_count(), first_rod..first_rod + shape.rods.len());
    if spheres.end > scene.spheres().len() || rods.end > scene.rods().len() && !rods.is_empty() {
        return Err(Damage::new(format!("the parts of a body begin at sphere {first_sphere} and rod {first_rod}")));
    }
    let spheres: Vec<_> = spheres.map(|index| scene.spheres.handle_at(index)).collect();
    let rods: Vec<_> = rods.map(|index| scene.rods.handle_at(index)).collect();
    let ends = |part: &ShapeRod| Some((*spheres.get(part.end1)?, *spheres.get(part.end2)?));
    let fits = rods.iter().zip(&shape.rods).all(|(id, part)| scene.rod(*id).ok().map(|rod| (rod.end1, rod.end2)) == ends(part));
    if !fits || spheres.iter().any(|id| scene.body_of_sphere(*id).is_some()) {
        return Err(Damage::new("a rod of a body has other ends than in its shape, or two bodies share a part"));
    }
    let (position, position_low, velocity, angular_momentum) = (words.vec3()?, words.vec3()?, words.vec3()?, words.vec3()?);
    let orientation = Quat::from_xyzw(words.f32()?, words.f32()?, words.f32()?, words.f32()?);
    let shape = scene.shapes.handle_at(index);
    let (force, torque) = (Vec3::ZERO, Vec3::ZERO);
    Ok(RigidBody { shape, position, position_low, orientation, velocity, angular_momentum, force, torque, spheres, rods })
}
