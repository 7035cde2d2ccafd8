//! The periods of a scene in a checkpoint: for each axis whether it is periodic, and the bounds of the box; the shear.

use super::words::{Damage, Head, Words};
use crate::scene::{Scene, Shear};

pub(super) fn put(head: &mut Head, scene: &Scene) {
    for bounds in scene.periodic() {
        head.u32(bounds.is_some().into());
        bounds.unwrap_or_default().into_iter().for_each(|bound| head.f32(bound));
    }
    let shear = scene.shear();
    head.u32(shear.is_some().into());
    let Shear { gradient, flow, rate, phase, .. } = shear.unwrap_or(Shear::new(0, 1, 0.0));
    [gradient, flow].into_iter().for_each(|axis| head.u32(axis as u32));
    head.f32(rate);
    head.u64(phase);
}

pub(super) fn read(words: &mut Words, scene: &mut Scene) -> Result<(), Damage> {
    for axis in 0..3 {
        let (is_periodic, bounds) = (words.u32()? != 0, [words.f32()?, words.f32()?]);
        scene.set_periodic(axis, is_periodic.then_some(bounds))?;
    }
    let is_sheared = words.u32()? != 0;
    let [gradient, flow] = [words.u32()? as usize, words.u32()? as usize];
    let shear = Shear::new(gradient, flow, words.f32()?);
    let shear = Shear { phase: words.u64()?, ..shear };
    scene.set_shear(is_sheared.then_some(shear))?;
    Ok(())
}
