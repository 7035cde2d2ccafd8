//! What the law `rigid` keeps of its bodies when the scene is edited.

use std::collections::HashMap;

use super::Frames;
use crate::rigid::world::{Collider, RigidWorld};
use crate::scene::Body as Part;

impl Frames {
    /// Takes over what another world has learnt of the colliders and joints that both have: impulses, colours and margins.
    pub(super) fn keep(&mut self, before: &Self) {
        self.substeps = before.substeps;
        let numbers: HashMap<_, u32> = numbered(&self.parts).zip(0..).collect();
        let of_old: Vec<_> = numbered(&before.parts).map(|part| numbers.get(&part).copied()).collect();
        let same = |old: usize| {
            let new = of_old[old]?;
            let colliders =
                [(&before.world, old), (&self.world, new as usize)].map(|(world, at)| (world, &world.colliders[at]));
            is_same(colliders).then_some(new)
        };
        let colliders: Vec<Option<u32>> = (0..before.parts.len()).map(same).collect();
        let mut bodies = vec![None; before.world.bodies.len()];
        bodies[0] = Some(0);
        for (old, new) in before.world.colliders.iter().zip(&colliders) {
            if let Some(new) = new {
                bodies[old.body as usize] = Some(self.world.colliders[*new as usize].body);
            }
        }
        for (body, new) in before.world.bodies.iter().zip(&bodies) {
            if let Some(new) = new {
                self.world.bodies[*new as usize].margin_scale = body.margin_scale;
            }
        }
        self.world.history = before.world.history.renumbered(&colliders, &bodies);
        let states: HashMap<_, _> = before.joints.iter().zip(&before.world.joints.states).collect();
        for (id, state) in self.joints.iter().zip(&mut self.world.joints.states) {
            if let Some(known) = states.get(id) {
                *state = **known;
            }
        }
    }
}

/// What each collider is in the scene, and which one of that. Several colliders of one object follow each other.
fn numbered(parts: &[Part]) -> impl Iterator<Item = (Part, u32)> {
    let mut before = None;
    parts.iter().map(move |part| {
        let number = before.filter(|(last, _)| last == part).map_or(0, |(_, number)| number + 1);
        before = Some((*part, number));
        (*part, number)
    })
}

/// Whether two colliders are the same but for the numbers of their body and their shape.
fn is_same(colliders: [(&RigidWorld, &Collider); 2]) -> bool {
    let [(before, old), (after, new)] = colliders;
    (old.place, old.group, old.material) == (new.place, new.group, new.material)
        && before.shapes[old.shape as usize] == after.shapes[new.shape as usize]
}
