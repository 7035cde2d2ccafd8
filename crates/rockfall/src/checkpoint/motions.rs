//! The motions of walls in a checkpoint: their number, then the name, the terms and the servo of each.

use glam::DVec3;

use super::words::{Damage, Head, Words};
use crate::scene::{Motion, MotionTerm, Scene, Servo, Sought};

/// What a motion seeks.
const NOTHING: u32 = 0;
const FORCE: u32 = 1;
const TORQUE: u32 = 2;

pub(super) fn put(head: &mut Head, scene: &Scene) {
    head.u32(scene.motions().len() as u32);
    for Motion { name, terms, servo } in scene.motions() {
        head.text(name);
        head.u32(terms.len() as u32);
        for MotionTerm { velocity, amplitude, frequency, phase, spin, axis, through, from, to } in terms {
            let vectors = [velocity, amplitude, axis, through].into_iter().flat_map(|vector| vector.to_array());
            vectors.chain([*frequency, *phase, *spin, *from, *to]).for_each(|number| head.f64(number));
        }
        put_servo(head, servo.as_ref());
    }
}

fn put_servo(head: &mut Head, servo: Option<&Servo>) {
    let Some(Servo { seeks, speed, displacement, velocity }) = servo else { return head.u32(NOTHING) };
    match seeks {
        Sought::Force(force) => {
            head.u32(FORCE);
            force.to_array().into_iter().for_each(|number| head.f64(number));
        }
        Sought::Torque { torque, axis, through } => {
            head.u32(TORQUE);
            head.f64(*torque);
            [axis, through].into_iter().flat_map(|vector| vector.to_array()).for_each(|number| head.f64(number));
        }
    }
    [*speed, *displacement, *velocity].into_iter().for_each(|number| head.f64(number));
}

pub(super) fn read(words: &mut Words, scene: &mut Scene) -> Result<(), Damage> {
    for _ in 0..words.u32()? {
        let name = words.text()?;
        let mut motion = Motion::new(name, MotionTerm::default());
        motion.terms.clear();
        for _ in 0..words.u32()? {
            let (velocity, amplitude, axis, through) = (vector(words)?, vector(words)?, vector(words)?, vector(words)?);
            let (frequency, phase, spin) = (words.f64()?, words.f64()?, words.f64()?);
            let (from, to) = (words.f64()?, words.f64()?);
            motion.terms.push(MotionTerm { velocity, amplitude, frequency, phase, spin, axis, through, from, to });
        }
        motion.servo = read_servo(words)?;
        scene.add_motion(motion)?;
    }
    Ok(())
}

fn read_servo(words: &mut Words) -> Result<Option<Servo>, Damage> {
    let seeks = match words.u32()? {
        NOTHING => return Ok(None),
        FORCE => Sought::Force(vector(words)?),
        TORQUE => Sought::Torque { torque: words.f64()?, axis: vector(words)?, through: vector(words)? },
        kind => return Err(Damage::new(format!("a motion seeks something of kind {kind}, expected 0 to 2"))),
    };
    let (speed, displacement, velocity) = (words.f64()?, words.f64()?, words.f64()?);
    Ok(Some(Servo { seeks, speed, displacement, velocity }))
}

fn vector(words: &mut Words) -> Result<DVec3, Damage> {
    Ok(DVec3::new(words.f64()?, words.f64()?, words.f64()?))
}
