//! Writes the constants of the uniform block: what the settings, the integrator and the clock give.

use glam::Vec4;

use crate::model::layout::{
    FLAG_COHESION, FLAG_COLLISIONS, FLAG_CONTINUOUS, FLAG_DOUBLE, FLAG_GROUPS, FLAG_HALF_STEP, FLAG_PAIR_FRICTION,
    FLAG_PERIODIC, FLAG_PULL, FLAG_RESIDUES, FLAG_RESISTANCE, FLAG_SERVOS, FLAG_SHEARED, FLAG_SMOOTH, FLAG_TRIANGLES,
    FLAG_VERLET, RATE_WORDS, SWEEPS_LISTED, SWEEPS_ON,
};
use crate::model::muscles::MuscleClock;
use crate::model::world::World;
use crate::phase::{wide, words};
use crate::scene::Scene;
use crate::settings::{Integrator, Precision, Settings};

/// Flags that follow from the settings.
const FLAGS_OF_SETTINGS: u32 = FLAG_COLLISIONS | FLAG_CONTINUOUS | FLAG_PULL | FLAG_DOUBLE;
/// Flags that follow from the objects, materials and pairs of the scene.
const FLAGS_OF_SCENE: u32 = FLAG_GROUPS
    | FLAG_TRIANGLES
    | FLAG_SMOOTH
    | FLAG_PAIR_FRICTION
    | FLAG_RESISTANCE
    | FLAG_COHESION
    | FLAG_PERIODIC
    | FLAG_SHEARED
    | FLAG_SERVOS;
/// Flags that follow from the integrator.
const FLAGS_OF_INTEGRATOR: u32 = FLAG_VERLET | FLAG_HALF_STEP;

impl World {
    /// Writes the settings. Another contact law takes effect when the topology is packed.
    pub fn set_settings(&mut self, settings: &Settings) {
        let Settings { gravity, gravity_direction, collisions, contact_pull, contact_law, precision, .. } = *settings;
        let constants = &mut self.step.constants;
        constants.set_constants(settings);
        if contact_law.has_history() {
            // Friction is part of the law.
            constants.coulomb_friction = 0.0;
        }
        constants.gravity = (gravity * gravity_direction).to_array();
        constants.mesh_cosine = libm::cos(f64::from(settings.mesh_angle).to_radians()) as f32;
        constants.gravity_size = gravity.abs() * gravity_direction.length();
        let bit = |on: bool, flag: u32| if on { flag } else { 0 };
        let chosen = bit(collisions, FLAG_COLLISIONS)
            | bit(collisions && settings.continuous_collisions, FLAG_CONTINUOUS)
            | bit(contact_pull, FLAG_PULL)
            | bit(precision == Precision::Double, FLAG_DOUBLE);
        self.set_flags(FLAGS_OF_SETTINGS, chosen);
        self.set_sweeps(self.step.constants.sweeps);
    }

    /// Writes the flags that follow from the objects, materials and pairs of the scene.
    pub(super) fn set_flags_of_scene(&mut self, flags: u32) {
        self.set_flags(FLAGS_OF_SCENE, flags);
    }

    /// Sets the integrator. Velocity Verlet keeps the rates of the last force evaluation, of spheres and rigid bodies.
    pub fn set_integrator(&mut self, integrator: Integrator) {
        let (flag, rates) = match integrator {
            Integrator::SymplecticEuler => (FLAG_HALF_STEP, 0),
            Integrator::VelocityVerlet => {
                (FLAG_VERLET, (self.step.layout.spheres + self.step.layout.rigid_bodies) * RATE_WORDS)
            }
            Integrator::Rk4 => (0, 0),
        };
        self.set_flags(FLAGS_OF_INTEGRATOR, flag);
        self.rates = vec![0.0; rates as usize];
        self.resize_states();
        self.status.forces_due = 1;
    }

    /// Sets whether velocities have residues (docs/physics section 5.10), which are 0 at first.
    pub fn set_residues(&mut self, has_residues: bool) {
        self.set_flags(FLAG_RESIDUES, if has_residues { FLAG_RESIDUES } else { 0 });
        self.resize_states();
    }

    fn resize_states(&mut self) {
        // States are empty where the device has them.
        for number in 0..self.states.len() {
            if !self.states[number].is_empty() {
                self.states[number].resize(self.rows_of_state(number), Vec4::ZERO);
            }
        }
    }

    /// Sets the time step in s.
    pub fn set_time_step(&mut self, dt: f32) {
        self.step.constants.dt = dt;
    }

    /// Sets how collisions are solved: one of the `SWEEPS_*` constants, at least the one that the scene needs.
    pub(crate) fn set_sweeps(&mut self, sweeps: u32) {
        // Networks can only be solved by sweeps.
        let least = if self.step.traits().networks { SWEEPS_ON } else { SWEEPS_LISTED };
        self.step.constants.sweeps = sweeps.max(least);
    }

    /// Writes the time to which the phases of the muscles refer.
    pub(super) fn set_muscle_time(&mut self, clock: &MuscleClock) {
        self.step.constants.muscle_step = clock.steps_since_base();
        self.step.constants.time_base = clock.base_time() as f32;
    }

    /// Writes where the images of a sheared scene are at the step `first`, at which the scene is, and how they slide on.
    pub fn set_shear(&mut self, scene: &Scene, first: u32) {
        let Some(shear) = scene.shear() else { return };
        self.shear_phase = shear.phase;
        self.put_shear(shear.phase);
        let constants = &mut self.step.constants;
        constants.pose_step = first;
        [constants.shear_change_low, constants.shear_change_high] = words(scene.shear_in_half_step(constants.dt));
    }

    /// Calls `run` with the images where they are in a pass of a stage on the CPU: 0 is at the start of the step, 1 and 2 in its middle, 3 at its end.
    pub(crate) fn at_time_of_pass(&mut self, pass: u32, run: impl FnOnce(&mut Self)) {
        let constants = &self.step.constants;
        if constants.flags & FLAG_SHEARED == 0 {
            return run(self);
        }
        let halves = 2 * self.status.steps.wrapping_sub(constants.pose_step) + pass.div_ceil(2).min(2);
        let change = wide([constants.shear_change_low, constants.shear_change_high]).wrapping_mul(halves.into());
        self.put_shear(self.shear_phase.wrapping_add(change));
        run(self);
        self.put_shear(self.shear_phase);
    }

    fn put_shear(&mut self, phase: u64) {
        [self.step.constants.shear_low, self.step.constants.shear_high] = words(phase);
    }

    /// Writes to which steps the rows of the poses of walls belong.
    pub(super) fn set_pose_rows(&mut self, first: u32, rows: u32) {
        (self.step.constants.pose_step, self.step.constants.pose_rows) = (first, rows);
    }

    /// Sets the flags of `mask` to `flags`.
    pub(crate) fn set_flags(&mut self, mask: u32, flags: u32) {
        let constants = &mut self.step.constants;
        constants.flags = constants.flags & !mask | flags & mask;
    }
}
