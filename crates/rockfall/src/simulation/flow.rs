//! Spheres and rigid bodies that come in through inlets and leave through outlets, between two steps (docs/physics section 2.15).

use glam::{DVec3, Vec3};

use crate::error::Result;
use crate::scene::{Inlet, InletState, ObjectId, Outlet, Passed, RigidBody, Scene, Sequence, ShapeId, SphereId, shared};
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;

mod room;

use room::Room;

/// Places that are tried for a sphere each time before it waits.
const TRIES: u64 = 100;
/// Most spheres that an inlet inserts at a time, and most that are counted as waiting.
const MOST: u64 = 1 << 16;
/// Steps between two looks where nothing gives a time scale.
const FEW_STEPS: u64 = 10;

/// What came in and left since the start of a simulation, and what is inside. The ends of a capsule count as two spheres, and a rigid body
/// as one.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Flow {
    /// The inlets, in order of addition.
    pub inlets: Vec<Inflow>,
    /// The outlets, in order of addition.
    pub outlets: Vec<Outflow>,
    /// Number of spheres in the scene that are not fixed.
    pub spheres: u64,
    /// Their mass.
    pub mass: f64,
}

/// What came in through an inlet.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Inflow {
    /// Name of the inlet.
    pub name: String,
    /// Number of spheres that came in.
    pub spheres: u64,
    /// Their mass.
    pub mass: f64,
    /// Number of spheres that are due and not in yet, because there is no room or the inlet acts in a later step; at most 65,536.
    pub waiting: u64,
}

/// What left through an outlet.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Outflow {
    /// Name of the outlet.
    pub name: String,
    /// Number of spheres that left.
    pub spheres: u64,
    /// Their mass.
    pub mass: f64,
}

impl Simulation {
    /// What came in through inlets and left through outlets since the start, and what is inside. Reads nothing back.
    ///
    /// In a scene to which a program adds nothing, what came in minus what left is the change of what is inside, exactly.
    pub fn flow(&self) -> Flow {
        let mut state = self.flow.clone();
        state.complete(&self.scene);
        let time = self.muscle_clock.written_time();
        let inside = inside(&self.scene);
        let inlets = self.scene.inlets().iter().zip(&state.inlets).enumerate().map(|(number, (inlet, state))| Inflow {
            name: inlet.name.clone(),
            spheres: state.passed.spheres,
            mass: state.passed.mass.value(),
            waiting: waiting(&self.scene, number, inlet, state, time),
        });
        let outlets = self.scene.outlets().iter().zip(&state.outlets).map(|(outlet, passed)| Outflow {
            name: outlet.name.clone(),
            spheres: passed.spheres,
            mass: passed.mass.value(),
        });
        Flow { inlets: inlets.collect(), outlets: outlets.collect(), spheres: inside.spheres, mass: inside.mass.value() }
    }

    /// Lets inlets and outlets act, if they do so before the next step. Returns the number of steps up to the next such time.
    pub(super) async fn pass(&mut self) -> Result<u64> {
        if self.scene.inlets.is_empty() && self.scene.outlets.is_empty() {
            return Ok(u64::MAX);
        }
        self.flow.complete(&self.scene);
        self.muscle_clock.set_time_step(self.time_step);
        let step = self.report.steps;
        // Not between the phases of a step, and once before a step that is repeated.
        if self.status.collided == 0 && self.flow.acted != Some(step) {
            self.flow.acted = Some(step);
            for number in 0..self.scene.outlets.len() {
                if step.is_multiple_of(self.outlet_steps(&self.scene.outlets[number])) {
                    self.pull().await?;
                    self.let_out(number)?;
                }
            }
            for number in 0..self.scene.inlets.len() {
                let inlet = &self.scene.inlets[number];
                let (state, time) = (&self.flow.inlets[number], self.muscle_clock.written_time());
                if step.is_multiple_of(self.inlet_steps(inlet))
                    && is_due(&self.scene.sequence(inlet, number), inlet, state, time)
                {
                    self.pull().await?;
                    self.let_in(number)?;
                }
            }
            self.flush_async().await?;
        }
        Ok(self.steps_to_next(step))
    }

    fn let_out(&mut self, number: usize) -> Result<()> {
        let gone = leaving(&self.scene, &self.scene.outlets[number]);
        for id in &gone {
            self.flow.outlets[number].add(self.scene.sphere(*id)?.mass);
        }
        let inside = |body: &RigidBody| self.scene.outlets[number].contains(DVec3::from_array(body.centre()));
        let bodies: Vec<_> =
            self.scene.body_ids().zip(self.scene.bodies()).filter(|(_, body)| inside(body)).map(|(id, _)| id).collect();
        for id in bodies {
            self.flow.outlets[number].add(body_mass(&self.scene, self.scene.body(id)?.shape));
            self.remove_body(id)?;
        }
        if !gone.is_empty() {
            self.remove_spheres(&gone)?;
        }
        Ok(())
    }

    fn let_in(&mut self, number: usize) -> Result<()> {
        let (scene, state) = (&mut self.scene, &mut self.flow.inlets[number]);
        let inlet = scene.inlets[number].clone();
        let (time, sequence) = (self.muscle_clock.written_time(), scene.sequence(&inlet, number));
        let tags: Vec<_> = inlet.kinds.iter().map(|(kind, _)| shared(kind.tag.clone())).collect();
        let mut room = Room::of(scene, &inlet, time);
        for _ in 0..MOST {
            let grain = sequence.grain(state.serial);
            if !is_due(&sequence, &inlet, state, time) {
                break;
            }
            let places = state.tries..state.tries + TRIES;
            let mut places = places.map(|attempt| inlet.place(number, state.serial, grain.radius, attempt));
            let Some(centre) = places.find(|centre| room.has_room(*centre, grain.radius)) else {
                state.tries += TRIES;
                break;
            };
            let kind = &inlet.kinds[grain.kind].0;
            let (id, spheres) = match kind.shape {
                Some(shape) => {
                    let id = scene.add_body(inlet.placement(shape, number, state.serial, centre))?;
                    (ObjectId::from(id), scene.body(id)?.spheres().to_vec())
                }
                None => {
                    let id = scene.add_sphere(inlet.sphere_of(kind, centre, grain.radius, grain.mass))?;
                    (ObjectId::from(id), vec![id])
                }
            };
            for sphere in spheres {
                scene.references.set(sphere, self.flow.next_reference);
                self.flow.next_reference = self.flow.next_reference.saturating_add(1);
            }
            scene.share_tag(id, &tags[grain.kind])?;
            room.add(centre, grain.radius);
            state.sum += inlet.share(&grain);
            state.passed.add(grain.mass);
            (state.serial, state.tries) = (state.serial + 1, 0);
            self.dirty = Dirty::Everything;
        }
        Ok(())
    }

    /// Number of steps from `step` to the next one before which an outlet looks at its box or a sphere is due.
    fn steps_to_next(&self, step: u64) -> u64 {
        let until = |every: u64| every - step % every;
        let outlets = self.scene.outlets().iter().map(|outlet| until(self.outlet_steps(outlet)));
        let inlets = self.scene.inlets().iter().enumerate().map(|(number, inlet)| {
            let needed = needed(&self.scene.sequence(inlet, number), inlet, &self.flow.inlets[number]);
            let Some(needed) = needed.filter(|needed| *needed <= inlet.due(f64::INFINITY)) else { return u64::MAX };
            let every = self.inlet_steps(inlet);
            // Where the next sphere is due later, the inlet is asked again then.
            let mut times = (0..1000).map(|times| until(every).saturating_add(every.saturating_mul(times)));
            let time_after = |steps: u64| self.muscle_clock.written_time_after(steps.saturating_mul(2));
            times.clone().find(|steps| needed <= inlet.due(time_after(*steps))).or(times.next_back()).unwrap_or(1)
        });
        outlets.chain(inlets).min().unwrap_or(u64::MAX)
    }

    /// Number of steps between two times at which an inlet may insert spheres: those in which a sphere moves on by its diameter.
    fn inlet_steps(&self, inlet: &Inlet) -> u64 {
        let (small, large) = inlet.bounds();
        let width = 2.0 * (small * large).sqrt();
        let speed = f64::from(inlet.velocity.length()) + (self.free_fall() * width).sqrt();
        inlet.every.unwrap_or_else(|| self.steps_in(width / speed))
    }

    /// Number of steps between two looks at an outlet: a sphere that has fallen from 50 times the height of the box crosses it in no
    /// less time.
    fn outlet_steps(&self, outlet: &Outlet) -> u64 {
        let height = (outlet.corners[1] - outlet.corners[0]).min_element();
        outlet.every.unwrap_or_else(|| self.steps_in(0.1 * (height / self.free_fall()).sqrt()))
    }

    fn free_fall(&self) -> f64 {
        let Vec3 { x, y, z } = self.gravity();
        DVec3::new(x.into(), y.into(), z.into()).length()
    }

    fn steps_in(&self, seconds: f64) -> u64 {
        if seconds.is_finite() { ((seconds / f64::from(self.time_step)) as u64).max(1) } else { FEW_STEPS }
    }
}

/// What is in a scene and not fixed.
fn inside(scene: &Scene) -> Passed {
    let mut inside = Passed::default();
    let alone = scene.sphere_ids().zip(scene.spheres()).filter(|(id, _)| scene.body_of_sphere(*id).is_none());
    alone.filter(|(_, sphere)| !sphere.fixed).for_each(|(_, sphere)| inside.add(sphere.mass));
    scene.bodies().iter().for_each(|body| inside.add(body_mass(scene, body.shape)));
    inside
}

/// The mass of a rigid body as it is counted.
fn body_mass(scene: &Scene, shape: ShapeId) -> f32 {
    scene.shape_mass(shape).map_or(0.0, |kinetics| kinetics.mass as f32)
}

/// What the rate counts of all spheres up to the next one, which is due when it has let in as much; `None` at the limit.
fn needed(sequence: &Sequence, inlet: &Inlet, state: &InletState) -> Option<f64> {
    let is_open = inlet.limit.is_none_or(|limit| state.serial < limit);
    is_open.then(|| state.sum + sequence.share(state.serial))
}

fn is_due(sequence: &Sequence, inlet: &Inlet, state: &InletState, time: f64) -> bool {
    needed(sequence, inlet, state).is_some_and(|needed| needed <= inlet.due(time))
}

/// Number of spheres that are due and not in yet.
fn waiting(scene: &Scene, number: usize, inlet: &Inlet, state: &InletState, time: f64) -> u64 {
    let (mut next, sequence) = (*state, scene.sequence(inlet, number));
    while next.serial - state.serial < MOST && is_due(&sequence, inlet, &next, time) {
        next.sum += sequence.share(next.serial);
        next.serial += 1;
    }
    next.serial - state.serial
}

/// The spheres that an outlet removes: those whose centre is in its box, and both ends of capsules whose centre is. Fixed spheres stay.
fn leaving(scene: &Scene, outlet: &Outlet) -> Vec<SphereId> {
    let mut of_capsules = std::collections::HashSet::new();
    let mut gone = Vec::new();
    for capsule in scene.capsules() {
        let ends = [capsule.end1, capsule.end2];
        of_capsules.extend(ends);
        let [one, other] = ends.map(|id| scene.sphere(id));
        if let (Ok(one), Ok(other)) = (one, other)
            && !(one.fixed || other.fixed)
            && outlet.contains((one.position.as_dvec3() + other.position.as_dvec3()) / 2.0)
        {
            gone.extend(ends);
        }
    }
    let spheres = scene.sphere_ids().zip(scene.spheres());
    let alone = spheres
        .filter(|(id, sphere)| !sphere.fixed && outlet.contains(sphere.position.as_dvec3()) && !of_capsules.contains(id))
        .filter(|(id, _)| scene.body_of_sphere(*id).is_none());
    gone.extend(alone.map(|(id, _)| id));
    gone
}
