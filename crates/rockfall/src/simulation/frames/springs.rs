//! Springs, tethers and muscles of a scene as those of the law `rigid` (docs/physics section 11.9).

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::build::Builder;
use super::{Frames, Owner};
use crate::error::Result;
use crate::model::muscles::MuscleClock;
use crate::rigid::spring_bound::SpringBound;
use crate::rigid::springs::{MuscleWords, Spring};
use crate::scene::{AnyForm, RunDefaults, Scene, SphereId, Tether, WholeBody};

/// An end of a spring.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) body: u32,
    /// In coordinates of the body.
    pub(super) place: Vec3,
    /// Velocity of the surface of a fixed sphere, in units/s.
    belt: Vec3,
}

/// The places of the spheres of a body, from its centre of mass and in its coordinates.
fn places(whole: &WholeBody<'_>) -> Vec<Vec3> {
    match whole.form {
        AnyForm::Shape(_, shape) => {
            let centre = whole.kinetics.centre;
            shape.all_spheres().iter().map(|part| (part.centre.as_dvec3() - centre).as_vec3()).collect()
        }
        AnyForm::Implied(form) => form.places.iter().map(|place| place.as_vec3()).collect(),
    }
}

/// Where each sphere that is not fixed belongs.
pub(super) fn ends_of_spheres(scene: &Scene, owners: &[Owner]) -> HashMap<SphereId, End> {
    let bodies: Vec<WholeBody<'_>> = scene.whole_bodies().collect();
    let mut ends = HashMap::new();
    for (body, owner) in (0..).zip(owners) {
        match *owner {
            Owner::World | Owner::Motion(_) => (),
            Owner::Sphere(id) => drop(ends.insert(id, End { body, place: Vec3::ZERO, belt: Vec3::ZERO })),
            Owner::Body(number) => {
                let whole = &bodies[number];
                let end = |place| End { body, place, belt: Vec3::ZERO };
                ends.extend(whole.spheres.iter().copied().zip(places(whole).into_iter().map(end)));
            }
        }
    }
    ends
}

impl Builder<'_> {
    /// All springs in order of addition, then all tethers.
    pub(super) fn springs(&mut self) -> Result<()> {
        let scene = self.scene;
        if scene.springs().is_empty() && scene.tethers().is_empty() {
            return Ok(());
        }
        let ends = ends_of_spheres(scene, &self.owners);
        let base = self.base;
        let local = |point: DVec3| (point - base).as_vec3();
        let end = |id: SphereId| -> Result<End> {
            let sphere = scene.sphere(id)?;
            // A fixed sphere never moves, but its surface may.
            let fixed = End { body: 0, place: local(sphere.centre().into()), belt: sphere.velocity };
            Ok(ends.get(&id).copied().unwrap_or(fixed))
        };
        for spring in scene.springs() {
            let muscle = spring.muscle.map(|muscle| {
                self.world.springs.muscles.push([muscle.amplitude.to_bits(), 0, 0, 0, 0]);
                self.world.springs.muscles.len() as u32 - 1
            });
            let ends = [end(spring.a)?, end(spring.b)?];
            self.spring(ends, [spring.stiffness, spring.damping, spring.length], muscle);
        }
        for Tether { sphere, point, stiffness, length, damping } in scene.tethers() {
            let point = End { body: 0, place: local(point.as_dvec3()), belt: Vec3::ZERO };
            self.spring([end(*sphere)?, point], [*stiffness, *damping, *length], None);
        }
        Ok(())
    }

    fn spring(&mut self, [a, b]: [End; 2], [stiffness, damping, length]: [f32; 3], muscle: Option<u32>) {
        // It does nothing.
        if a.body == b.body {
            return;
        }
        self.world.springs.list.push(Spring {
            bodies: [a.body, b.body],
            places: [a.place, b.place],
            stiffness,
            damping,
            length,
            belt: b.belt - a.belt,
            muscle,
        });
    }
}

impl Frames {
    /// Sets the phases of all muscles for the next frame.
    pub(super) fn set_muscles(&mut self, scene: &Scene, clock: &MuscleClock) {
        let muscles = &mut self.world.springs.muscles;
        if muscles.is_empty() {
            return;
        }
        let present = scene.springs().iter().filter_map(|spring| spring.muscle);
        muscles.clear();
        muscles.extend(present.map(|muscle| -> MuscleWords { clock.record_of_substeps(&muscle, self.substeps) }));
        #[cfg(all(feature = "gpu", not(target_family = "wasm")))]
        if let Some(device) = &mut self.device {
            device.set_muscles(&self.world);
        }
    }

    /// Takes as many substeps as the springs need, if the scene leaves their number to the solver. It never takes fewer than before.
    pub(super) fn suit_springs(&mut self, scene: &Scene, dt: f32) {
        if self.substeps > 0 && scene.run.substeps.is_none() && !self.world.springs.list.is_empty() {
            let wanted = SpringBound::of(&self.world).substeps(dt).min(RunDefaults::MAX_SUBSTEPS);
            self.substeps = self.substeps.max(wanted);
        }
    }
}
