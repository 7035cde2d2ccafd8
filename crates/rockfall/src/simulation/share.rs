//! The spheres of one process of a cluster: their states as rows of words, without an edit.

use bytemuck::cast_slice;
use glam::{Quat, Vec3, Vec4};

use crate::checkpoint::{Checkpoint, KeptSpring};
use crate::error::Result;
use crate::model::layout::RATE_WORDS;
use crate::scene::Sphere;
use crate::simulation::{Simulation, engine};

/// Words that a contact with the sphere depends on: position, its low part, velocity, angular momentum.
const MOTION_WORDS: usize = 12;
/// Words of the rates of velocity Verlet.
const KEPT_WORDS: usize = RATE_WORDS as usize;
/// Words of the whole state of a sphere: those above, then the orientation.
pub(crate) const ROW_WORDS: usize = MOTION_WORDS + KEPT_WORDS + 4;

/// The state of a sphere as the bits of its numbers.
pub(crate) type Row = [u32; ROW_WORDS];

/// Writes the state of a row to a sphere of a scene, and returns its rates. A fixed sphere only turns.
pub(crate) fn put_in_scene(row: &Row, sphere: &mut Sphere) -> [f32; KEPT_WORDS] {
    let numbers = row.map(f32::from_bits);
    let vector = |at: usize| Vec3::from_slice(&numbers[at..]);
    sphere.orientation = Quat::from_slice(&numbers[MOTION_WORDS + KEPT_WORDS..]);
    if !sphere.fixed {
        (sphere.position, sphere.position_low) = (vector(0), vector(3));
        (sphere.velocity, sphere.angular_momentum) = (vector(6), vector(9));
    }
    std::array::from_fn(|at| numbers[MOTION_WORDS + at])
}

/// The places of the spheres of a simulation in memory, by insertion index, until memory is sorted again.
#[derive(Debug, Default)]
pub(crate) struct Places {
    packings: u64,
    slots: Vec<u32>,
}

impl Places {
    /// Finds the places again if memory has been sorted.
    pub(crate) fn update(&mut self, simulation: &Simulation) {
        if self.packings == simulation.packings && !self.slots.is_empty() {
            return;
        }
        let world = &simulation.world;
        self.packings = simulation.packings;
        self.slots = vec![0; world.step.layout.spheres as usize];
        (0..self.slots.len()).for_each(|slot| self.slots[world.insertion_index(slot)] = slot as u32);
    }
}

/// Access to the state on the host. Only for the CPU backend.
impl Simulation {
    /// Number of words of a row that a contact and the next step depend on.
    pub(crate) fn shared_words(&self) -> usize {
        MOTION_WORDS + if self.world.rates.is_empty() { 0 } else { KEPT_WORDS }
    }

    /// The state of a sphere by its insertion index.
    pub(crate) fn row(&self, places: &Places, index: u32) -> Row {
        let (world, slot) = (&self.world, places.slots[index as usize] as usize);
        let spheres = places.slots.len();
        let region = |region: usize| world.states[0][region * spheres + slot].truncate().to_array().map(f32::to_bits);
        let mut row = [0; ROW_WORDS];
        // The low parts of positions are in region 3.
        for (part, number) in [0, 3, 1, 2].into_iter().enumerate() {
            row[3 * part..3 * part + 3].copy_from_slice(&region(number));
        }
        if !world.rates.is_empty() {
            let rates = &world.rates[index as usize * KEPT_WORDS..][..KEPT_WORDS];
            row[MOTION_WORDS..][..KEPT_WORDS].copy_from_slice(cast_slice(rates));
        }
        row[MOTION_WORDS + KEPT_WORDS..].copy_from_slice(&world.orientations[slot].to_array().map(f32::to_bits));
        row
    }

    /// Replaces the motion of a sphere by the first [`Simulation::shared_words`] words of a row. This is no edit: forces are not
    /// evaluated again. A sphere that has left its AABB makes the next step build its lists again, as after a step.
    pub(crate) fn put_row(&mut self, places: &Places, index: u32, words: &[u32]) {
        let spheres = places.slots.len();
        let (world, slot) = (&mut self.world, places.slots[index as usize] as usize);
        for (part, number) in [0, 3, 1, 2].into_iter().enumerate() {
            let row = &mut world.states[0][number * spheres + slot];
            let vector = Vec3::from_array(std::array::from_fn(|at| f32::from_bits(words[3 * part + at])));
            *row = vector.extend(row.w);
        }
        if !world.rates.is_empty() {
            let rates = &mut world.rates[index as usize * KEPT_WORDS..][..KEPT_WORDS];
            rates.copy_from_slice(cast_slice(&words[MOTION_WORDS..][..KEPT_WORDS]));
        }
        self.synced = false;
    }

    /// Where a sphere is along an axis, and how far it moves along it before the next evaluation of forces, in units: with velocity
    /// Verlet by the drift of the next step, otherwise not at all.
    pub(crate) fn ahead(&self, places: &Places, index: u32, axis: usize, dt: f32) -> [f64; 2] {
        let spheres = places.slots.len();
        let slot = places.slots[index as usize] as usize;
        let at = |region: usize| -> f64 { component(self.world.states[0][region * spheres + slot], axis).into() };
        if self.world.rates.is_empty() {
            return [at(0), 0.0];
        }
        let rate = f64::from(self.world.rates[index as usize * KEPT_WORDS + axis]);
        let dt = f64::from(dt);
        [at(0), ((at(1) + 0.5 * dt * rate) * dt).abs()]
    }

    /// Says which spheres belong to this process, by insertion index. Only the contacts of those are counted.
    pub(crate) fn set_own(&mut self, own: Vec<bool>) {
        self.world.own = own;
    }

    /// The springs of all contacts, by their handles.
    pub(crate) fn kept_springs(&mut self) -> Result<Vec<KeptSpring>> {
        engine::block_on(None, self.springs())
    }

    /// Gives a checkpoint what the steps so far have left beyond the state of the spheres and the settings of lists.
    pub(crate) fn put_history(&self, checkpoint: &mut Checkpoint) {
        checkpoint.history.lengths_due = self.status.lengths_due != 0;
        checkpoint.history.clock = self.muscle_clock;
        checkpoint.time_step = self.time_step;
    }

    /// Gives a checkpoint the settings of the lists, on which no result depends.
    pub(crate) fn put_list_plan(&self, checkpoint: &mut Checkpoint) {
        let plan = self.lists.settings();
        (checkpoint.history.margin_scale, checkpoint.history.lookahead) = (plan.margin, plan.lookahead.max(1.0));
    }

    /// Factor by which a sphere reaches further than its radius, because of necks of cohesion.
    pub(crate) fn reach(&self) -> f32 {
        1.0 + self.world.step.layout.neck
    }

    /// Whether steps have friction impulses, which solve chains of contacts together.
    pub(crate) fn has_friction_impulses(&self) -> bool {
        self.world.step.traits().friction_impulses
    }
}

fn component(row: Vec4, axis: usize) -> f32 {
    row.to_array()[axis]
}
