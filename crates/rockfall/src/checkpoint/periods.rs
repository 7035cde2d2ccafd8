//! The periods of a scene in a checkpoint: for each axis whether it is periodic, and the bounds of the box.

use super::words::{Damage, Head, Words};
use crate::scene::Scene;

pub(super) fn put(head: &mut Head, scene: &Scene) {
    for bounds in scene.periodic() {
        head.u32(bounds.is_some().into());
        bounds.unwrap_or_default().into_iter().for_each(|bound| head.f32(bound));
    }
}

pub(super) fn read(words: &mut Words, scene: &mut Scene) -> Result<(), Damage> {
    for axis in 0..3 {
        let (is_periodic, bounds) = (words.u32()? != 0, [words.f32()?, words.f32()?]);
        scene.set_periodic(axis, is_periodic.then_some(bounds))?;
    }
    Ok(())
}
