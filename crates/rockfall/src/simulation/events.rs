//! Events: contacts that begin and end, and what enters and leaves sensors.
//!
//! Both are differences of two states: the pairs that touch, and what is in the boxes of sensors. So a simulation
//! keeps nothing that changes steps, and one that is resumed goes on from what its first state has.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::error::{Error, Result};
use crate::scene::ObjectId;
use crate::simulation::Simulation;

mod contacts;
mod parties;
mod sensors;

use contacts::Touching;
use sensors::Inside;

/// An object that takes part in an event. What moves as a whole is one object: a rigid body, a capsule, and a frame of
/// rods of the law `rigid`, which goes by its first sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Party {
    /// Its handle: of a sphere, rod, capsule, rigid body, box or polygon. It is stale if the object has been removed.
    pub id: ObjectId,
    /// Its index among those of its kind, in order of addition, when the event was noted; that before its removal if
    /// it is gone.
    pub index: usize,
}

impl Party {
    /// Name of the kind: `sphere`, `rod`, `capsule`, `body`, `box` or `polygon`.
    pub fn kind(&self) -> &'static str {
        match self.id {
            ObjectId::Sphere(_) => "sphere",
            ObjectId::Rod(_) => "rod",
            ObjectId::Capsule(_) => "capsule",
            ObjectId::Body(_) => "body",
            ObjectId::Box(_) => "box",
            ObjectId::Polygon(_) => "polygon",
            ObjectId::Spring(_) => "spring",
        }
    }
}

/// Whether a contact begins or ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ContactChange {
    /// It begins: the objects touch and did not do so a step before.
    Begin,
    /// It ends: the objects touched a step before.
    End,
}

/// A contact of two objects that began or ended in a step. There is one event for all points of the pair.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ContactEvent {
    /// Number of steps done, with the one in which it happened.
    pub step: u64,
    /// Time after that step, in s.
    pub time: f64,
    /// Whether the contact began or ended.
    pub change: ContactChange,
    /// The first object, in the order spheres, rods, capsules, rigid bodies, boxes, polygons.
    pub a: Party,
    /// The other object.
    pub b: Party,
    /// The point with the deepest overlap, in units, in the state in which the contact began, or the last one in which
    /// it was there.
    pub point: Vec3,
    /// Unit normal at that point, from A to B.
    pub normal: Vec3,
    /// Force of all points on B in the state in which the contact began, in mass units/s². A collision counts with its
    /// impulse divided by the time step, and an impact within a frame with its normal impulse divided by the frame. 0
    /// at the end.
    pub force: Vec3,
}

/// Whether an object enters or leaves a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SensorChange {
    /// Its centre is in the box and was not a step before.
    Enter,
    /// Its centre was in the box a step before.
    Leave,
}

/// An object that entered or left a [`Sensor`](crate::Sensor) in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SensorEvent {
    /// Number of steps done, with the one in which it happened.
    pub step: u64,
    /// Time after that step, in s.
    pub time: f64,
    /// Whether the object entered or left.
    pub change: SensorChange,
    /// Index of the sensor in [`Scene::sensors`](crate::Scene::sensors).
    pub sensor: usize,
    /// The sphere, capsule or rigid body.
    pub object: Party,
    /// Its centre after the step, in units; the last one in the box if the object is gone.
    pub centre: DVec3,
}

/// What is watched, and what happened since it was last asked for.
#[derive(Debug, Default)]
pub(super) struct Watched {
    contacts: Option<Noted<Touching, ContactEvent>>,
    sensors: Option<Noted<Inside, SensorEvent>>,
}

/// What a state has, and the events up to it.
#[derive(Debug)]
struct Noted<State, Event> {
    now: Vec<State>,
    events: Vec<Event>,
}

impl<State, Event> Noted<State, Event> {
    fn of(now: Vec<State>) -> Self {
        Self { now, events: Vec::new() }
    }
}

impl Simulation {
    /// Begins or stops to note where contacts begin and end, for [`Simulation::contact_events`]. Pairs that touch in
    /// the present state have begun already. Nothing changes if contacts are watched already. To stop drops the events
    /// that were not asked for.
    ///
    /// It changes no result, but the state is read back and its contacts are found after every step, so that a plain
    /// run is faster. A checkpoint does not have it: a resumed simulation begins with the pairs that touch in its
    /// first state, which are those of the simulation that goes on.
    ///
    /// # Errors
    /// As for [`Simulation::contacts`].
    pub fn watch_contacts(&mut self, on: bool) -> Result<()> {
        if self.watched.contacts.is_some() != on {
            self.watched.contacts = if on { Some(Noted::of(self.touching()?)) } else { None };
        }
        Ok(())
    }

    /// The contacts that began and ended since the last call, or since they are watched. They are in the order of
    /// steps; within a step those that end come first, and then both are in the order in which
    /// [`Simulation::contacts`] has the first point of each pair.
    ///
    /// Two objects touch while [`Simulation::contacts`] has a point of theirs with an overlap of at least 0 or with a
    /// force. Under the law `rigid` they also touch while they are apart by at most 0.001 radii of the smaller body,
    /// so that what rocks does not part for a frame, and an impact within a frame begins in that frame and ends in the
    /// next one. Under other laws, what touches and parts within one step has no event. Phases that run alone are seen
    /// when [`Simulation::update_positions`] has run.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless contacts are watched ([`Simulation::watch_contacts`]).
    pub fn contact_events(&mut self) -> Result<Vec<ContactEvent>> {
        let expected = "contacts that are watched: call watch_contacts before the steps";
        match &mut self.watched.contacts {
            Some(noted) => Ok(std::mem::take(&mut noted.events)),
            None => Err(Error::Invalid { field: "contact_events", value: "no contacts are watched".to_owned(), expected }),
        }
    }

    /// Begins or stops to note what enters and leaves the sensors of the scene, for [`Simulation::sensor_events`].
    /// What is inside in the present state has entered already. Nothing changes if they are watched already. To stop
    /// drops the events that were not asked for.
    ///
    /// It changes no result, but the state is read back after every step. As for [`Simulation::watch_contacts`], a
    /// resumed simulation begins with what is inside in its first state.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub fn watch_sensors(&mut self, on: bool) -> Result<()> {
        if self.watched.sensors.is_some() != on {
            self.watched.sensors = if on { Some(Noted::of(self.inside()?)) } else { None };
        }
        Ok(())
    }

    /// What entered and left sensors since the last call, or since they are watched: rigid bodies, capsules, frames of
    /// rods of the law `rigid` and all other spheres that are not fixed, by their centres. They are in the order of
    /// steps, within a step in that of sensors, and for each of them what leaves comes first. What passes a sensor
    /// within one step has no event.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless sensors are watched ([`Simulation::watch_sensors`]).
    pub fn sensor_events(&mut self) -> Result<Vec<SensorEvent>> {
        let expected = "sensors that are watched: call watch_sensors before the steps";
        match &mut self.watched.sensors {
            Some(noted) => Ok(std::mem::take(&mut noted.events)),
            None => Err(Error::Invalid { field: "sensor_events", value: "no sensors are watched".to_owned(), expected }),
        }
    }

    /// Whether the state after every step is looked at.
    pub(super) fn is_watched(&self) -> bool {
        self.watched.contacts.is_some() || self.watched.sensors.is_some()
    }

    /// Begins anew with the present state, after a jump to another one.
    pub(super) fn watch_anew(&mut self) -> Result<()> {
        if self.watched.contacts.is_some() {
            self.watched.contacts = Some(Noted::of(self.touching()?));
        }
        if self.watched.sensors.is_some() {
            self.watched.sensors = Some(Noted::of(self.inside()?));
        }
        Ok(())
    }

    /// Notes the differences between the state before the last step and that after it.
    pub(super) async fn note_events(&mut self) -> Result<()> {
        self.sync_async().await?;
        let when = (self.report.steps, self.report.time);
        if self.watched.contacts.is_some() {
            let now = self.touching()?;
            if let Some(noted) = &mut self.watched.contacts {
                contacts::note(noted, now, when);
            }
        }
        if self.watched.sensors.is_some() {
            let now = self.inside()?;
            if let Some(noted) = &mut self.watched.sensors {
                sensors::note(noted, now, when, &self.scene);
            }
        }
        Ok(())
    }
}

/// The places of items by their keys.
fn places<Key: std::hash::Hash + Eq, Item>(items: &[Item], key: impl Fn(&Item) -> Key) -> HashMap<Key, usize> {
    items.iter().enumerate().map(|(place, item)| (key(item), place)).collect()
}
