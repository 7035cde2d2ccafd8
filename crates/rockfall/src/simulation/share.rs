//! The spheres of one process of a cluster: their states as rows of words, without an edit, on both backends.

#[cfg(feature = "gpu")]
use std::future::poll_fn;
#[cfg(feature = "gpu")]
use std::pin::pin;
#[cfg(feature = "gpu")]
use std::sync::Arc;
#[cfg(feature = "gpu")]
use std::task::Poll;

use bytemuck::cast_slice;
use glam::{Quat, Vec3};

use crate::checkpoint::{Checkpoint, KeptSpring};
use crate::error::Result;
#[cfg(feature = "gpu")]
use crate::exec::gpu::share::Link;
use crate::model::layout::{RATE_WORDS, RESIDUE_REGION};
use crate::model::shared::{SENT_WORDS, Shared};
use crate::model::status::REBUILD_REQUESTED;
use crate::scene::Sphere;
use crate::simulation::{Simulation, engine};

/// Words of the motion of a sphere: position, its low part, velocity, angular momentum.
const MOTION_WORDS: usize = 12;
/// The regions of the state that have these vectors.
const REGIONS: [usize; 4] = [0, 3, 1, 2];
/// Words of the rates of velocity Verlet.
const KEPT_WORDS: usize = RATE_WORDS as usize;
/// Words of the whole state of a sphere: those above, the orientation, then the residues. Residues are not sent: no copy needs them.
pub(crate) const ROW_WORDS: usize = RESIDUES_AT + 4;
const RESIDUES_AT: usize = MOTION_WORDS + KEPT_WORDS + 4;

/// Where the words that are sent to another process begin in the whole row: the motion; with velocity Verlet the velocity, the angular momentum and the rates. The position of a
/// copy is exact then, because it follows in a drift from the state before.
const SENT_FROM: [usize; 2] = [0, 6];

/// The state of a sphere as the bits of its numbers.
pub(crate) type Row = [u32; ROW_WORDS];

/// Writes the state of a row to a sphere of a scene, and returns its rates and its residues. A fixed sphere only turns.
pub(crate) fn put_in_scene(row: &Row, sphere: &mut Sphere) -> ([f32; KEPT_WORDS], [u32; 4]) {
    let numbers = row.map(f32::from_bits);
    let vector = |at: usize| Vec3::from_slice(&numbers[at..]);
    sphere.orientation = Quat::from_slice(&numbers[MOTION_WORDS + KEPT_WORDS..RESIDUES_AT]);
    if !sphere.fixed {
        (sphere.position, sphere.position_low) = (vector(0), vector(3));
        (sphere.velocity, sphere.angular_momentum) = (vector(6), vector(9));
    }
    (std::array::from_fn(|at| numbers[MOTION_WORDS + at]), std::array::from_fn(|at| row[RESIDUES_AT + at]))
}

/// Reads and writes the rows of what a process shares, where its simulation keeps them.
#[derive(Debug)]
pub(crate) struct Rows {
    shared: Shared,
    /// Where the words that are sent begin in a row.
    sent_from: usize,
    /// The places of spheres in memory, by insertion index.
    slots: Vec<u32>,
    /// The version of these places.
    packings: u64,
    #[cfg(feature = "gpu")]
    link: Option<Arc<Link>>,
}

impl Rows {
    /// Prepares what a simulation shares. Only the contacts of the own spheres are counted from now on.
    pub(crate) fn new(simulation: &mut Simulation, shared: Shared) -> Result<Self> {
        let mut own = vec![false; simulation.world.step.layout.spheres as usize];
        shared.own.iter().for_each(|index| own[*index as usize] = true);
        let is_verlet = !simulation.world.rates.is_empty();
        #[cfg(feature = "gpu")]
        let link =
            simulation.engine.gpu_world().map(|world| Link::new(world.gpu(), &shared, is_verlet).map(Arc::new)).transpose()?;
        #[cfg(feature = "gpu")]
        link.iter().for_each(|link| simulation.engine.set_link(Arc::clone(link)));
        // All cores compute forces on the CPU, so nothing is gained there by what is computed early.
        let sent = if simulation.engine.dispatches() { shared.sent.concat() } else { Vec::new() };
        simulation.world.set_own(own, sent);
        simulation.engine.upload_topology(&simulation.world)?;
        let (slots, packings) = (Vec::new(), 0);
        Ok(Self {
            shared,
            sent_from: SENT_FROM[usize::from(is_verlet)],
            slots,
            packings,
            #[cfg(feature = "gpu")]
            link,
        })
    }

    /// What is shared.
    pub(crate) fn shared(&self) -> &Shared {
        &self.shared
    }

    /// Empty messages of the right lengths, to and from every process.
    pub(crate) fn messages(&self) -> [Vec<Vec<u32>>; 2] {
        let empty = |spheres: &[Vec<u32>]| spheres.iter().map(|spheres| vec![0; spheres.len() * SENT_WORDS]).collect();
        [empty(&self.shared.sent), empty(&self.shared.received)]
    }

    /// Takes a step of `dt` seconds. On a GPU, the rows that are sent are computed first. While the device computes the others, `exchange`
    /// replaces the rows of a first message by those of a second one, which are then put. Returns whether it was called, if the step was
    /// taken.
    pub(crate) fn step(
        &self,
        simulation: &mut Simulation,
        dt: f32,
        [to, from]: &mut [Vec<Vec<u32>>; 2],
        mut exchange: impl FnMut(&[Vec<u32>], &mut [Vec<u32>]),
    ) -> (Result<()>, bool) {
        let mut is_exchanged = false;
        #[cfg(feature = "gpu")]
        if let Some(link) = &self.link {
            link.begin();
            let sharing = async {
                link.take_early(to).await?;
                is_exchanged = true;
                exchange(to, from);
                link.put_early(from, dt)
            };
            let waiter = simulation.engine.waiter();
            let done = engine::block_on(waiter, during(simulation.run_async(1, dt), sharing));
            return (done, is_exchanged);
        }
        (simulation.run(1, dt).map(drop), is_exchanged)
    }

    /// Whether the last step was repeated, so that the rows that were exchanged during it may be wrong.
    pub(crate) fn was_repeated(&self) -> bool {
        #[cfg(feature = "gpu")]
        return self.link.as_ref().is_some_and(|link| link.submissions() > 1);
        #[cfg(not(feature = "gpu"))]
        false
    }

    /// Reads the rows that are sent after a step.
    pub(crate) fn take(&mut self, simulation: &Simulation, to: &mut [Vec<u32>]) -> Result<()> {
        #[cfg(feature = "gpu")]
        if let (Some(link), Some(world)) = (&self.link, simulation.engine.gpu_world()) {
            return engine::block_on(simulation.engine.waiter(), link.take(&world.shared_arrays(false)?, to));
        }
        self.find(simulation);
        for (words, sent) in to.iter_mut().zip(&self.shared.sent) {
            let rows = words.chunks_exact_mut(SENT_WORDS).zip(sent);
            rows.for_each(|(row, index)| row.copy_from_slice(&self.row(simulation, *index)[self.sent_from..][..SENT_WORDS]));
        }
        Ok(())
    }

    /// Replaces the motion of the copies by rows that were received. This is no edit: forces are not evaluated again. A sphere that has
    /// left its AABB makes the next step build its lists again, as after a step. The next step has `dt` seconds.
    pub(crate) fn put(&mut self, simulation: &mut Simulation, from: &[Vec<u32>], dt: f32) -> Result<()> {
        simulation.synced = false;
        #[cfg(feature = "gpu")]
        if let (Some(link), Some(world)) = (&self.link, simulation.engine.gpu_world()) {
            return link.put(&world.shared_arrays(false)?, from, dt);
        }
        for (words, received) in from.iter().zip(&self.shared.received) {
            let rows = words.chunks_exact(SENT_WORDS).zip(received);
            rows.for_each(|(row, index)| self.put_row(simulation, *index, row));
        }
        Ok(())
    }

    /// The whole states of the own spheres.
    pub(crate) fn own_rows(&mut self, simulation: &mut Simulation) -> Result<Vec<Row>> {
        let waiter = simulation.engine.waiter();
        let Simulation { engine, world, .. } = simulation;
        engine::block_on(waiter, async {
            engine.download_spheres(world).await?;
            if world.rates.is_empty() { Ok(()) } else { engine.download_rates(world).await }
        })?;
        self.find(simulation);
        Ok(self.shared.own.iter().map(|index| self.row(simulation, *index)).collect())
    }

    /// Finds the places of spheres in memory again if it has been sorted.
    fn find(&mut self, simulation: &Simulation) {
        if self.packings == simulation.packings && !self.slots.is_empty() {
            return;
        }
        let world = &simulation.world;
        self.packings = simulation.packings;
        self.slots = vec![0; world.step.layout.spheres as usize];
        (0..self.slots.len()).for_each(|slot| self.slots[world.insertion_index(slot)] = slot as u32);
    }

    /// The state of a sphere on the host.
    fn row(&self, simulation: &Simulation, index: u32) -> Row {
        let (world, slot) = (&simulation.world, self.slots[index as usize] as usize);
        let region = |region: usize| world.states[0][region * self.slots.len() + slot].truncate().to_array().map(f32::to_bits);
        let mut row = [0; ROW_WORDS];
        for (part, number) in REGIONS.into_iter().enumerate() {
            row[3 * part..3 * part + 3].copy_from_slice(&region(number));
        }
        if !world.rates.is_empty() {
            let rates = &world.rates[index as usize * KEPT_WORDS..][..KEPT_WORDS];
            row[MOTION_WORDS..][..KEPT_WORDS].copy_from_slice(cast_slice(rates));
        }
        if world.step.has_residues() {
            let residues = world.states[0][RESIDUE_REGION as usize * self.slots.len() + slot];
            row[RESIDUES_AT..].copy_from_slice(&residues.to_array().map(f32::to_bits));
        }
        row[MOTION_WORDS + KEPT_WORDS..RESIDUES_AT].copy_from_slice(&world.orientations[slot].to_array().map(f32::to_bits));
        row
    }

    fn put_row(&self, simulation: &mut Simulation, index: u32, words: &[u32]) {
        let (world, slot) = (&mut simulation.world, self.slots[index as usize] as usize);
        let mut words = words.chunks_exact(3).map(|words| Vec3::from_array([0, 1, 2].map(|at| f32::from_bits(words[at]))));
        for (region, vector) in REGIONS[self.sent_from / 3..].iter().zip(&mut words) {
            let row = &mut world.states[0][region * self.slots.len() + slot];
            *row = vector.extend(row.w);
        }
        let rates = world.rates.get_mut(index as usize * KEPT_WORDS..).unwrap_or_default();
        rates.chunks_exact_mut(3).zip(words).for_each(|(rates, vector)| rates.copy_from_slice(&vector.to_array()));
    }

    /// Whether all own spheres are close enough to where they were when spheres were divided, also at the next evaluation of forces, in a
    /// step of `dt` seconds. With velocity Verlet that is after the drift.
    pub(crate) fn has_room(&self, simulation: &Simulation, dt: f32) -> Result<bool> {
        #[cfg(feature = "gpu")]
        if let Some(link) = &self.link {
            return engine::block_on(simulation.engine.waiter(), link.is_far()).map(|is_far| !is_far);
        }
        let (world, axis) = (&simulation.world, self.shared.axis);
        Ok(self.shared.own.iter().zip(&self.shared.starts).all(|(index, start)| {
            let slot = self.slots[*index as usize] as usize;
            let at = |region: usize| f64::from(world.states[0][region * self.slots.len() + slot].to_array()[axis]);
            let rate = world.rates.get(*index as usize * KEPT_WORDS + axis);
            let dt = f64::from(dt);
            let drift = rate.map_or(0.0, |rate| ((at(1) + 0.5 * dt * f64::from(*rate)) * dt).abs());
            (at(0) - f64::from(*start)).abs() + drift <= self.shared.room
        }))
    }
}

/// Polls `other` while `first` goes on, and once after it.
#[cfg(feature = "gpu")]
async fn during<T>(first: impl Future<Output = Result<T>>, other: impl Future<Output = Result<()>>) -> Result<()> {
    let (mut first, mut other) = (pin!(first), pin!(other));
    let mut done = Poll::Pending;
    poll_fn(|context| {
        let result = first.as_mut().poll(context);
        if done.is_pending() {
            done = other.as_mut().poll(context);
        }
        result.map(|result| match std::mem::replace(&mut done, Poll::Pending) {
            Poll::Ready(other) => result.and(other),
            Poll::Pending => result.map(drop),
        })
    })
    .await
}

impl Simulation {
    /// The springs of all contacts, by their handles.
    pub(crate) fn kept_springs(&mut self) -> Result<Vec<KeptSpring>> {
        let waiter = self.engine.waiter();
        engine::block_on(waiter, self.springs())
    }

    /// Gives a checkpoint what the steps so far have left beyond the state of the spheres and the settings of lists.
    pub(crate) fn put_history(&self, checkpoint: &mut Checkpoint) {
        checkpoint.history.lengths_due = self.status.lengths_due != 0;
        checkpoint.history.clock = self.muscle_clock;
        // The images of a sheared scene have slid.
        checkpoint.scene.shear = self.scene.shear;
        checkpoint.time_step = self.time_step;
    }

    /// Gives a checkpoint the settings of the lists, on which no result depends.
    pub(crate) fn put_list_plan(&self, checkpoint: &mut Checkpoint) {
        let plan = self.lists.settings();
        (checkpoint.history.margin_scale, checkpoint.history.lookahead) = (plan.margin, plan.lookahead.max(1.0));
    }

    /// Whether the next step builds lists.
    pub(crate) fn wants_lists(&self) -> bool {
        self.status.rebuild & REBUILD_REQUESTED != 0
    }

    /// Lets the next step build lists. No result depends on it.
    pub(crate) fn request_lists(&mut self) {
        self.status.rebuild |= REBUILD_REQUESTED;
    }

    /// Ends what [`Rows::new`] has begun, before [`Simulation::restore`].
    pub(crate) fn unshare(&mut self) {
        self.world.own.clear();
        self.world.sent.clear();
    }

    /// Lets inlets and outlets act, if they do so before the next step, of `dt` seconds. Returns the number of steps up to the next such time.
    pub(crate) fn act(&mut self, dt: f32) -> Result<u64> {
        self.set_time_step(dt)?;
        let waiter = self.engine.waiter();
        engine::block_on(waiter, self.pass())
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

#[cfg(all(test, feature = "gpu", not(target_family = "wasm")))]
mod tests {
    use super::*;
    use crate::simulation::flight::tests::soft_pile;
    use crate::simulation::lists::{ListPolicy, MIN_MARGIN};
    use crate::{Backend, Integrator, Options};

    /// A pile with the springs of contacts, and every third sphere of it for another process.
    fn shared_pile(integrator: Integrator) -> (Simulation, Rows) {
        let options = Options::new().backend(Backend::Gpu).integrator(integrator);
        let mut simulation = Simulation::with_options(soft_pile(), options).unwrap();
        simulation.run(1, 0.02).unwrap();
        let count = simulation.scene.spheres().len() as u32;
        let own: Vec<u32> = (0..count).collect();
        let starts = vec![0.0; own.len()];
        let sent = vec![Vec::new(), own.iter().copied().filter(|index| index % 3 == 1).collect()];
        let shared = Shared { own, starts, sent, received: vec![Vec::new(); 2], axis: 0, room: 1e9 };
        let rows = Rows::new(&mut simulation, shared).unwrap();
        (simulation, rows)
    }

    /// What is sent during a step is what a read after it gives. Where spheres leave their AABBs, the step is repeated, which is noted.
    #[test]
    fn rows_are_sent_during_a_step_on_the_gpu() {
        for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
            let (mut simulation, mut rows) = shared_pile(integrator);
            let mut repeated = 0;
            for step in 0..40 {
                if step % 8 == 4 {
                    // Lists for more steps than they last.
                    simulation.lists = ListPolicy::new(4.0, MIN_MARGIN);
                }
                let (mut messages, mut early) = (rows.messages(), Vec::new());
                let before = messages[0].clone();
                let (done, is_exchanged) = rows.step(&mut simulation, 0.02, &mut messages, |to, _| early = to.to_vec());
                done.unwrap();
                assert!(is_exchanged && rows.has_room(&simulation, 0.02).unwrap(), "{integrator:?}, step {step}");
                let mut after = before.clone();
                rows.take(&simulation, &mut after).unwrap();
                assert!(after != before, "{integrator:?}, step {step}");
                if rows.was_repeated() {
                    repeated += 1;
                } else {
                    assert!(early == after, "{integrator:?}, step {step}");
                }
            }
            assert!((1..20).contains(&repeated), "{integrator:?}: {repeated} repeated steps");
        }
    }
}
