//! The springs of contacts in a checkpoint. Objects are named by their numbers.

use glam::Vec3;

use super::words::{Damage, Head, Words};
use super::{Checkpoint, KeptSpring};
use crate::scene::Scene;

/// A spring as it is stored: the numbers of the objects, the feature, displacement, overlap and moment.
pub(super) struct Stored {
    objects: [u32; 2],
    feature: u32,
    shift: Vec3,
    overlap: f32,
    moment: Vec3,
}

/// The number of springs, then 10 words each. Springs of objects that are no longer in the scene are left out.
pub(super) fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let number = |id| checkpoint.scene.number_of(id);
    let named: Vec<_> =
        checkpoint.springs.iter().filter_map(|spring| Some((number(spring.a)?, number(spring.b)?, spring))).collect();
    let mut head = Head::default();
    head.u64(named.len() as u64);
    for (a, b, KeptSpring { feature, shift, overlap, moment, .. }) in named {
        [a, b, *feature].into_iter().for_each(|word| head.u32(word));
        [shift.x, shift.y, shift.z, *overlap, moment.x, moment.y, moment.z].into_iter().for_each(|number| head.f32(number));
    }
    head.bytes
}

/// Reads the springs.
pub(super) fn read(words: &mut Words) -> Result<Vec<Stored>, Damage> {
    let count = words.u64()?;
    let mut springs = Vec::new();
    for _ in 0..count {
        let (objects, feature) = ([words.u32()?, words.u32()?], words.u32()?);
        let (shift, overlap, moment) = (words.vec3()?, words.f32()?, words.vec3()?);
        springs.push(Stored { objects, feature, shift, overlap, moment });
    }
    Ok(springs)
}

/// Replaces numbers by handles.
pub(super) fn named(springs: &[Stored], scene: &Scene) -> Result<Vec<KeptSpring>, Damage> {
    let ids = if springs.is_empty() { Vec::new() } else { scene.any_ids() };
    let counts = scene.counts();
    let movers = (counts.spheres + counts.rods) as u32;
    let name = |Stored { objects: [a, b], feature, shift, overlap, moment }: &Stored| {
        let is_known = *a < *b && *a < movers && (*b as usize) < ids.len() && *feature < crate::model::layout::BOX_FEATURES;
        let is_finite = shift.is_finite() && moment.is_finite() && overlap.is_finite() && *overlap >= 0.0;
        if !is_known || !is_finite {
            return Err(Damage::new(format!("the spring of the contact of objects {a} and {b} is out of range")));
        }
        let [a, b] = [*a, *b].map(|number| ids[number as usize]);
        Ok(KeptSpring { a, b, feature: *feature, shift: *shift, overlap: *overlap, moment: *moment })
    };
    springs.iter().map(name).collect()
}
