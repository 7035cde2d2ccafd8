//! What is in the boxes of sensors in a state.

use std::collections::HashMap;

use glam::DVec3;

use super::parties::Parties;
use super::{Noted, Party, SensorChange, SensorEvent, places};
use crate::error::Result;
use crate::scene::{ObjectId, Scene, SphereId};
use crate::simulation::Simulation;

/// An object in a sensor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    sensor: usize,
    object: Party,
    centre: DVec3,
}

impl Inside {
    fn key(&self) -> (usize, ObjectId) {
        (self.sensor, self.object.id)
    }
}

impl Simulation {
    /// What is in sensors in the present state, sensor by sensor.
    pub(super) fn inside(&mut self) -> Result<Vec<Inside>> {
        let scene = self.sync()?;
        if scene.sensors().is_empty() {
            return Ok(Vec::new());
        }
        let centres = centres(scene)?;
        let of_sensor = |(number, sensor): (usize, &crate::scene::Sensor)| {
            let inside = centres.iter().filter(|(_, centre)| sensor.contains(*centre));
            inside.map(move |(object, centre)| Inside { sensor: number, object: *object, centre: *centre }).collect::<Vec<_>>()
        };
        Ok(scene.sensors().iter().enumerate().flat_map(of_sensor).collect())
    }
}

/// The centres of all objects that move: spheres, capsules and rigid bodies. In periodic scenes they are those in the
/// box.
fn centres(scene: &Scene) -> Result<Vec<(Party, DVec3)>> {
    let parties = Parties::of(scene);
    let in_box = |centre: DVec3| centre + scene.image_in_box(centre).0;
    let mut found = Vec::new();
    for (id, sphere) in scene.sphere_ids().zip(scene.spheres()) {
        let party = parties.of_sphere(id)?;
        if !sphere.fixed && party.id == id.into() {
            let centre = centre_of_frame(scene, id).unwrap_or_else(|| DVec3::from_array(sphere.centre()));
            found.push((party, in_box(centre)));
        }
    }
    for (index, (id, capsule)) in scene.capsule_ids().zip(scene.capsules()).enumerate() {
        let [one, two] = [scene.sphere(capsule.end1)?, scene.sphere(capsule.end2)?];
        if !(one.fixed && two.fixed) {
            let centre = 0.5 * (DVec3::from_array(one.centre()) + DVec3::from_array(two.centre()));
            found.push((Party { id: id.into(), index }, in_box(centre)));
        }
    }
    for (index, (id, body)) in scene.body_ids().zip(scene.bodies()).enumerate() {
        found.push((Party { id: id.into(), index }, in_box(DVec3::from_array(body.centre()))));
    }
    Ok(found)
}

/// The centre of mass of the frame of rods that a sphere is part of.
fn centre_of_frame(scene: &Scene, id: SphereId) -> Option<DVec3> {
    Some(scene.implied.get(scene.implied_of(id)?).ok()?.state.position.wide())
}

/// Adds what differs between the state before a step and the one after it.
pub(super) fn note(noted: &mut Noted<Inside, SensorEvent>, now: Vec<Inside>, (step, time): (u64, f64), scene: &Scene) {
    let (before, after) = (places(&noted.now, Inside::key), places(&now, Inside::key));
    let left: Vec<&Inside> = noted.now.iter().filter(|one| !after.contains_key(&one.key())).collect();
    let entered: Vec<&Inside> = now.iter().filter(|one| !before.contains_key(&one.key())).collect();
    if left.is_empty() && entered.is_empty() {
        noted.now = now;
        return;
    }
    let places: HashMap<ObjectId, DVec3> =
        centres(scene).unwrap_or_default().into_iter().map(|(party, centre)| (party.id, centre)).collect();
    let event = |change: SensorChange, one: &Inside| {
        let centre = places.get(&one.object.id).copied().unwrap_or(one.centre);
        SensorEvent { step, time, change, sensor: one.sensor, object: one.object, centre }
    };
    let mut events: Vec<SensorEvent> = left.into_iter().map(|one| event(SensorChange::Leave, one)).collect();
    events.extend(entered.into_iter().map(|one| event(SensorChange::Enter, one)));
    // A stable sort: what leaves a sensor stays in front of what enters it.
    events.sort_by_key(|event| event.sensor);
    noted.events.extend(events);
    noted.now = now;
}
