//! The motions of walls in a checkpoint: their number, then the name and the terms of each.

use glam::DVec3;

use super::words::{Damage, Head, Words};
use crate::scene::{Motion, MotionTerm, Scene};

pub(super) fn put(head: &mut Head, scene: &Scene) {
    head.u32(scene.motions().len() as u32);
    for Motion { name, terms } in scene.motions() {
        head.text(name);
        head.u32(terms.len() as u32);
        for MotionTerm { velocity, amplitude, frequency, phase, spin, axis, through, from, to } in terms {
            let vectors = [velocity, amplitude, axis, through].into_iter().flat_map(|vector| vector.to_array());
            vectors.chain([*frequency, *phase, *spin, *from, *to]).for_each(|number| head.f64(number));
        }
    }
}

pub(super) fn read(words: &mut Words, scene: &mut Scene) -> Result<(), Damage> {
    for _ in 0..words.u32()? {
        let name = words.text()?;
        let mut motion = Motion::new(name, MotionTerm::default());
        motion.terms.clear();
        for _ in 0..words.u32()? {
            let mut vector = || -> Result<DVec3, Damage> { Ok(DVec3::new(words.f64()?, words.f64()?, words.f64()?)) };
            let (velocity, amplitude, axis, through) = (vector()?, vector()?, vector()?, vector()?);
            let (frequency, phase, spin) = (words.f64()?, words.f64()?, words.f64()?);
            let (from, to) = (words.f64()?, words.f64()?);
            motion.terms.push(MotionTerm { velocity, amplitude, frequency, phase, spin, axis, through, from, to });
        }
        scene.add_motion(motion)?;
    }
    Ok(())
}
