//! The objects of a checkpoint. Each kind takes a fixed number of 32-bit words. Objects refer to others by insertion index.

use std::io::{self, Write};

use glam::{Quat, Vec3};

use super::words::{Damage, Words};
use crate::scene::{
    CapsuleParts, Counts, Cuboid, Handle, MaterialId, MotionId, Muscle, Polygon, Registry, Rod, Scene, Sphere, Spring, Surface,
    Tether,
};

/// Maximum number of bytes written at once.
const CHUNK: usize = 1 << 16;

/// An object that is stored as N words.
trait Record<const N: usize>: Sized {
    fn pack(&self, scene: &Scene) -> [u32; N];
    fn unpack(words: [u32; N], scene: &Scene) -> Result<Self, Damage>;
}

/// Size of all objects and references, in bytes.
pub(super) fn length(scene: &Scene) -> usize {
    let Counts { spheres, rods, capsules, springs, tethers, boxes, polygons, .. } = scene.counts();
    let references = if scene.references.is_empty() { 0 } else { 2 * spheres };
    4 * (references + 19 * spheres + 5 * rods + 3 * capsules + 9 * springs + 7 * tethers + 17 * boxes + 15 * polygons)
}

pub(super) fn write(scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    write_all(scene.spheres(), scene, out)?;
    write_all(scene.rods(), scene, out)?;
    write_all(scene.capsules(), scene, out)?;
    write_all(scene.springs(), scene, out)?;
    write_all(scene.tethers(), scene, out)?;
    write_all(scene.boxes(), scene, out)?;
    write_all(scene.polygons(), scene, out)?;
    if !scene.references.is_empty() {
        for id in scene.sphere_ids() {
            out.write_all(&scene.reference(id).map_or(-1, i64::from).to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_all<const N: usize>(objects: &[impl Record<N>], scene: &Scene, out: &mut impl Write) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(CHUNK);
    for chunk in objects.chunks((CHUNK / (4 * N)).max(1)) {
        bytes.clear();
        for object in chunk {
            let words = object.pack(scene).map(u32::to_le);
            bytes.extend_from_slice(bytemuck::cast_slice(&words));
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

pub(super) fn read(words: &mut Words, counts: &Counts, scene: &mut Scene) -> Result<(), Damage> {
    read_all(words, counts.spheres, scene, |scene, sphere: Sphere| {
        // A step may leave an orientation whose length is not quite 1. No other value depends on it.
        let turn = sphere.orientation;
        if !(turn.is_finite() && (0.5..2.0).contains(&turn.length_squared())) {
            return Err(Damage::new(format!("the orientation of a sphere is {turn}, expected a unit quaternion")));
        }
        Sphere { orientation: Quat::IDENTITY, ..sphere }.validate()?;
        scene.spheres.add(sphere);
        Ok(())
    })?;
    read_all(words, counts.rods, scene, |scene, rod| Ok(scene.add_rod(rod).map(drop)?))?;
    read_all(words, counts.capsules, scene, |scene, parts| {
        scene.capsules.add(parts);
        Ok(())
    })?;
    read_all(words, counts.springs, scene, |scene, spring| Ok(scene.add_spring(spring).map(drop)?))?;
    read_all(words, counts.tethers, scene, |scene, tether| Ok(scene.add_tether(tether).map(drop)?))?;
    read_all(words, counts.boxes, scene, |scene, cuboid| Ok(scene.add_box(cuboid).map(drop)?))?;
    read_all(words, counts.polygons, scene, |scene, polygon| Ok(scene.add_polygon(polygon).map(drop)?))?;
    if !words.is_empty() {
        for index in 0..counts.spheres {
            let reference = words.u64()?.cast_signed();
            if reference != -1 {
                let reference = u32::try_from(reference)
                    .map_err(|_| Damage::new(format!("the reference {reference} of a sphere is not a 32-bit number")))?;
                scene.references.set(scene.spheres.handle_at(index), reference);
            }
        }
    }
    Ok(())
}

fn read_all<T: Record<N>, const N: usize>(
    words: &mut Words,
    count: usize,
    scene: &mut Scene,
    add: impl Fn(&mut Scene, T) -> Result<(), Damage>,
) -> Result<(), Damage> {
    let length = count.checked_mul(4 * N).ok_or_else(|| Damage::new("it has more objects than fit in memory"))?;
    for bytes in words.take(length)?.chunks_exact(4 * N) {
        let mut record = Words::new(bytes);
        let mut packed = [0; N];
        for word in &mut packed {
            *word = record.u32()?;
        }
        let object = T::unpack(packed, scene)?;
        add(scene, object)?;
    }
    Ok(())
}

impl Record<19> for Sphere {
    fn pack(&self, scene: &Scene) -> [u32; 19] {
        let Self {
            position: x,
            // Stored before the objects.
            position_low: _,
            velocity: v,
            angular_momentum: l,
            orientation: q,
            mass,
            radius,
            fixed,
            force: f,
            group,
            material,
        } = *self;
        let mut words = [0; 19];
        let numbers =
            [x.x, x.y, x.z, v.x, v.y, v.z, l.x, l.y, l.z, q.x, q.y, q.z, q.w, mass, radius, f.x, f.y, f.z].map(f32::to_bits);
        words[..18].copy_from_slice(&numbers);
        words[18] = tag(scene, group, fixed, material);
        words
    }

    fn unpack(words: [u32; 19], scene: &Scene) -> Result<Self, Damage> {
        let number = |place: usize| f32::from_bits(words[place]);
        let (group, fixed, material) = read_tag(words[18], scene)?;
        Ok(Self {
            position: vector(&words[0..]),
            position_low: Vec3::ZERO,
            velocity: vector(&words[3..]),
            angular_momentum: vector(&words[6..]),
            orientation: Quat::from_xyzw(number(9), number(10), number(11), number(12)),
            mass: number(13),
            radius: number(14),
            fixed,
            force: vector(&words[15..]),
            group,
            material,
        })
    }
}

impl Record<5> for Rod {
    fn pack(&self, scene: &Scene) -> [u32; 5] {
        let Self { end1, end2, radius, length, group, material } = *self;
        let tag = tag(scene, group, length.is_some(), material);
        let (radius, length) = (radius.to_bits(), length.unwrap_or(0.0).to_bits());
        [index(&scene.spheres, end1), index(&scene.spheres, end2), radius, length, tag]
    }

    fn unpack([end1, end2, radius, length, tag]: [u32; 5], scene: &Scene) -> Result<Self, Damage> {
        let (group, held, material) = read_tag(tag, scene)?;
        Ok(Self {
            end1: handle(&scene.spheres, end1)?,
            end2: handle(&scene.spheres, end2)?,
            radius: f32::from_bits(radius),
            length: held.then_some(f32::from_bits(length)),
            group,
            material,
        })
    }
}

impl Record<3> for CapsuleParts {
    fn pack(&self, scene: &Scene) -> [u32; 3] {
        let Self { end1, end2, rod } = *self;
        [index(&scene.spheres, end1), index(&scene.spheres, end2), index(&scene.rods, rod)]
    }

    fn unpack([end1, end2, rod]: [u32; 3], scene: &Scene) -> Result<Self, Damage> {
        Ok(Self { end1: handle(&scene.spheres, end1)?, end2: handle(&scene.spheres, end2)?, rod: handle(&scene.rods, rod)? })
    }
}

/// The words of a spring without a muscle, whether it has one, and the words of the muscle.
impl Record<9> for Spring {
    fn pack(&self, scene: &Scene) -> [u32; 9] {
        let Self { a, b, stiffness, length, damping, muscle } = *self;
        let mut words = [0; 9];
        words[..2].copy_from_slice(&[a, b].map(|end| index(&scene.spheres, end)));
        words[2..5].copy_from_slice(&[stiffness, length, damping].map(f32::to_bits));
        if let Some(Muscle { amplitude, frequency, phase }) = muscle {
            words[5] = 1;
            words[6..].copy_from_slice(&[amplitude, frequency, phase].map(f32::to_bits));
        }
        words
    }

    fn unpack(words: [u32; 9], scene: &Scene) -> Result<Self, Damage> {
        let [a, b, stiffness, length, damping, has_muscle, rest @ ..] = words;
        let [stiffness, length, damping] = [stiffness, length, damping].map(f32::from_bits);
        let spring = Self::new(handle(&scene.spheres, a)?, handle(&scene.spheres, b)?, stiffness, length).damping(damping);
        let [amplitude, frequency, phase] = rest.map(f32::from_bits);
        match has_muscle {
            0 => Ok(spring),
            1 => Ok(spring.muscle(Muscle::new(amplitude, frequency, phase))),
            other => Err(Damage::new(format!("the flag of a muscle is {other}, expected 0 or 1"))),
        }
    }
}

impl Record<7> for Tether {
    fn pack(&self, scene: &Scene) -> [u32; 7] {
        let Self { sphere, point, stiffness, length, damping } = *self;
        let [x, y, z, stiffness, length, damping] = [point.x, point.y, point.z, stiffness, length, damping].map(f32::to_bits);
        [index(&scene.spheres, sphere), x, y, z, stiffness, length, damping]
    }

    fn unpack(words: [u32; 7], scene: &Scene) -> Result<Self, Damage> {
        let [stiffness, length, damping] = [words[4], words[5], words[6]].map(f32::from_bits);
        Ok(Self { sphere: handle(&scene.spheres, words[0])?, point: vector(&words[1..]), stiffness, length, damping })
    }
}

impl Record<17> for Cuboid {
    fn pack(&self, scene: &Scene) -> [u32; 17] {
        let Self { corner, edges: [i, j, k], group, material, motion, surface_velocity } = *self;
        let mut words = [tag(scene, group, false, material); 17];
        words[13] = body(scene, motion);
        put(&mut words[14..], [surface_velocity]);
        put(&mut words, [corner, i, j, k]);
        words
    }

    fn unpack(words: [u32; 17], scene: &Scene) -> Result<Self, Damage> {
        let (group, _, material) = read_tag(words[12], scene)?;
        let edges = [vector(&words[3..]), vector(&words[6..]), vector(&words[9..])];
        let (motion, surface_velocity) = (read_body(words[13], scene)?, vector(&words[14..]));
        Ok(Self { corner: vector(&words), edges, group, material, motion, surface_velocity })
    }
}

impl Record<15> for Polygon {
    fn pack(&self, scene: &Scene) -> [u32; 15] {
        let Self { corner, left, right, surface, group, material, motion, surface_velocity } = *self;
        let mut words = [tag(scene, group, false, material); 15];
        words[14] = surface.number();
        words[10] = body(scene, motion);
        put(&mut words[11..], [surface_velocity]);
        put(&mut words, [corner, left, right]);
        words
    }

    fn unpack(words: [u32; 15], scene: &Scene) -> Result<Self, Damage> {
        let (group, _, material) = read_tag(words[9], scene)?;
        let surface = Surface::of_number(words[14])
            .ok_or_else(|| Damage::new(format!("a polygon has the unknown surface {}", words[14])))?;
        let [corner, left, right] = [vector(&words), vector(&words[3..]), vector(&words[6..])];
        let (motion, surface_velocity) = (read_body(words[10], scene)?, vector(&words[11..]));
        Ok(Self { corner, left, right, surface, group, material, motion, surface_velocity })
    }
}

/// Writes vectors to the first words.
fn put<const V: usize>(words: &mut [u32], vectors: [Vec3; V]) {
    for (place, number) in words.iter_mut().zip(vectors.iter().flat_map(|vector| vector.to_array())) {
        *place = number.to_bits();
    }
}

fn vector(words: &[u32]) -> Vec3 {
    Vec3::new(f32::from_bits(words[0]), f32::from_bits(words[1]), f32::from_bits(words[2]))
}

/// Bit of the flag in a tag. The number of the material is above it.
const FLAG_SHIFT: u32 = 16;

/// Packs a group, a flag and a material into a word. Versions 1 and 2 have no material, which is the number 0.
fn tag(scene: &Scene, group: u16, flag: bool, material: Option<MaterialId>) -> u32 {
    // The scene contains the materials of all its objects.
    let number = scene.material_number(material).unwrap_or_default();
    u32::from(group) | u32::from(flag) << FLAG_SHIFT | u32::from(number) << (FLAG_SHIFT + 1)
}

/// Splits a word into group, flag and material.
fn read_tag(word: u32, scene: &Scene) -> Result<(u16, bool, Option<MaterialId>), Damage> {
    let (flag, number) = (word >> FLAG_SHIFT & 1 == 1, word >> (FLAG_SHIFT + 1));
    if number as usize > scene.materials().len() {
        return Err(Damage::new(format!("an object has the unknown flags {word:#x}")));
    }
    Ok((word as u16, flag, scene.material_of_number(number as u16)))
}

/// The number of the body that follows a motion, 0 for the world. The scene contains the motions of all its objects.
fn body(scene: &Scene, motion: Option<MotionId>) -> u32 {
    scene.body_number(motion).unwrap_or_default()
}

fn read_body(number: u32, scene: &Scene) -> Result<Option<MotionId>, Damage> {
    number.checked_sub(1).map(|index| handle(&scene.motions, index)).transpose()
}

/// The insertion index of an object. The scene contains every object that it refers to.
fn index<T>(registry: &Registry<T>, handle: Handle<T>) -> u32 {
    registry.index(handle).map_or(u32::MAX, |index| index as u32)
}

fn handle<T>(registry: &Registry<T>, index: u32) -> Result<Handle<T>, Damage> {
    if (index as usize) < registry.len() {
        return Ok(registry.handle_at(index as usize));
    }
    Err(Damage::new(format!("an object refers to index {index} of {} objects", registry.len())))
}
