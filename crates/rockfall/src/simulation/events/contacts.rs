//! Pairs of objects that touch in a state.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use glam::Vec3;

use super::parties::{Parties, rank};
use super::{ContactChange, ContactEvent, Noted, Party, places};
use crate::error::Result;
use crate::scene::ObjectId;
use crate::simulation::Simulation;
use crate::simulation::observe::{Contact, ContactAction};

/// Two objects that touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    a: Party,
    b: Party,
    /// Where the overlap is deepest.
    point: Vec3,
    normal: Vec3,
    overlap: f32,
    /// Of all points on B.
    force: Vec3,
}

impl Touching {
    fn key(&self) -> [ObjectId; 2] {
        [self.a.id, self.b.id]
    }

    fn event(&self, change: ContactChange, (step, time): (u64, f64), force: Vec3) -> ContactEvent {
        let Self { a, b, point, normal, .. } = *self;
        ContactEvent { step, time, change, a, b, point, normal, force }
    }

    /// Adds another point of the pair.
    fn add(&mut self, other: &Self) {
        self.force += other.force;
        if other.overlap > self.overlap {
            (self.point, self.normal, self.overlap) = (other.point, other.normal, other.overlap);
        }
    }
}

impl Simulation {
    /// The pairs of objects that touch in the present state, in the order of their first contacts, then those that
    /// struck within the last frame and are apart.
    pub(super) fn touching(&mut self) -> Result<Vec<Touching>> {
        let contacts = if self.has_frames() { self.rigid_meetings()? } else { self.contacts()? };
        let parties = Parties::of(&self.scene);
        let mut found: Vec<Touching> = Vec::new();
        let mut known: HashMap<[ObjectId; 2], usize> = HashMap::new();
        for contact in &contacts {
            let Some(pair) = of_contact(contact, &parties, self.time_step)? else { continue };
            match known.entry(pair.key()) {
                Entry::Occupied(place) => found[*place.get()].add(&pair),
                Entry::Vacant(place) => {
                    place.insert(found.len());
                    found.push(pair);
                }
            }
        }
        Ok(found)
    }
}

/// The pair of a contact; `None` if its objects do not touch there, or are one.
fn of_contact(contact: &Contact, parties: &Parties<'_>, dt: f32) -> Result<Option<Touching>> {
    let force = match contact.action {
        ContactAction::Force(force) => force,
        ContactAction::Impulse(impulse) => impulse / dt,
    };
    if contact.overlap < 0.0 && force == Vec3::ZERO {
        return Ok(None);
    }
    let (a, b) = (parties.party(contact.a)?, parties.party(contact.b)?);
    let Contact { point, normal, overlap, .. } = *contact;
    let pair = if rank(&a) <= rank(&b) {
        Touching { a, b, point, normal, overlap, force }
    } else {
        Touching { a: b, b: a, point, normal: -normal, overlap, force: -force }
    };
    Ok((a.id != b.id).then_some(pair))
}

/// Adds what differs between the state before a step and the one after it.
pub(super) fn note(noted: &mut Noted<Touching, ContactEvent>, now: Vec<Touching>, when: (u64, f64)) {
    let (before, after) = (places(&noted.now, Touching::key), places(&now, Touching::key));
    let ended = noted.now.iter().filter(|pair| !after.contains_key(&pair.key()));
    noted.events.extend(ended.map(|pair| pair.event(ContactChange::End, when, Vec3::ZERO)));
    let begun = now.iter().filter(|pair| !before.contains_key(&pair.key()));
    noted.events.extend(begun.map(|pair| pair.event(ContactChange::Begin, when, pair.force)));
    noted.now = now;
}
