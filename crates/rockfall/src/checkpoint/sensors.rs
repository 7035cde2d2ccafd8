//! Sensors in a checkpoint: the length of what follows in bytes, 0 if there are none; the number of sensors, each with
//! its name and the corners of its box. What is inside follows from the state.

use super::flow::{put_corners, read_corners};
use super::words::{Damage, Head, Words};
use crate::scene::{Scene, Sensor};

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut head = Head::default();
    if !scene.sensors().is_empty() {
        head.u32(scene.sensors().len() as u32);
    }
    for Sensor { name, corners } in scene.sensors() {
        head.text(name);
        put_corners(&mut head, corners);
    }
    head.block()
}

pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let words = &mut Words::new(given);
    for _ in 0..words.u32()? {
        scene.add_sensor(Sensor { name: words.text()?, corners: read_corners(words)? })?;
    }
    if scene.sensors().is_empty() {
        return Err(Damage::new("its list of sensors is empty"));
    }
    words.end()
}
