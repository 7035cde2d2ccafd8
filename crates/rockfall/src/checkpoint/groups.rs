//! Groups with a list of those that they meet, in a checkpoint: the length of what follows in bytes, 0 if there are none; the number of
//! groups, each with its number, the length of its list, and the list.

use super::words::{Damage, Head, Words};
use crate::scene::Scene;

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut head = Head::default();
    let count = scene.groups.lists().count();
    if count > 0 {
        head.u32(count as u32);
    }
    for (group, met) in scene.groups.lists() {
        head.u32(group.into());
        head.u32(met.len() as u32);
        met.iter().for_each(|other| head.u32((*other).into()));
    }
    head.block()
}

pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let mut words = Words::new(given);
    for _ in 0..words.u32()? {
        let own = group(&mut words)?;
        let met = (0..words.u32()?).map(|_| group(&mut words)).collect::<Result<Vec<u16>, Damage>>()?;
        scene.set_group_meets(own, met)?;
    }
    words.end()
}

fn group(words: &mut Words) -> Result<u16, Damage> {
    let group = words.u32()?;
    group.try_into().map_err(|_| Damage::new(format!("a group has the number {group}, expected 0 to {}", u16::MAX)))
}
