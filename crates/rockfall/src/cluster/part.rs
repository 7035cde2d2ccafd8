//! The spheres of one process, and their copies on others.

use std::time::Instant;

use crate::checkpoint::Checkpoint;
use crate::cluster::domain::Domain;
use crate::cluster::ranks::Ranks;
use crate::cluster::state;
use crate::cluster::work::{Work, timed};
use crate::error::{Error, Result};
use crate::model::shared::Shared;
use crate::options::{Optimization, Options};
use crate::report::Report;
use crate::scene::{Scene, SphereId};
use crate::simulation::Simulation;
use crate::simulation::share::Rows;

/// Least distance that a sphere may move until spheres are divided again, in radii of the largest one.
const LEAST_ROOM: f64 = 0.5;
/// The same as a fraction of the mean thickness of the slabs: a division takes as long as very many steps, and more copies are few in a thick
/// slab.
const SHARE_OF_SLAB: f64 = 0.005;
/// Steps for which the room lasts at least at the present speeds.
const STEPS_OF_ROOM: f64 = 4.0;

/// The own spheres of a process, the copies that it has of others, and who gets copies of its own.
#[derive(Debug)]
pub(super) struct Part {
    local: Simulation,
    rows: Rows,
    domain: Domain,
    rank: u32,
    /// Whether no sphere can touch one of which there is no copy, in a step of `dt` seconds.
    has_room: bool,
    has_wrong_copies: bool,
    dt: f32,
    /// Messages to and from every process.
    messages: [Vec<Vec<u32>>; 2],
}

impl Part {
    /// Divides the spheres of a state and takes the part of process `rank` of `size`. `spare` is a simulation that is used again. Spheres
    /// reach further than their radius by the factor `reach`; steps have `dt` seconds.
    pub(super) fn new(
        spare: Option<Simulation>,
        whole: &Checkpoint,
        [rank, size]: [usize; 2],
        reach: f64,
        dt: f32,
    ) -> Result<Self> {
        let spheres = whole.scene.spheres();
        let domain = Domain::of(&whole.scene, size);
        let (room, depth) = room_and_depth(whole, &domain, reach, dt);
        let is_here = |index: usize| {
            let sphere = &spheres[index];
            domain.owners[index] as usize == rank || sphere.fixed || domain.needs_copy(rank, sphere, depth)
        };
        let present: Vec<u32> = (0..spheres.len()).filter(|index| is_here(*index)).map(|index| index as u32).collect();
        let mut checkpoint = local_checkpoint(whole, &present)?;
        // It decides whether velocities have residues.
        checkpoint.time_step = dt;
        let mut local = match spare {
            Some(mut local) => {
                local.put_list_plan(&mut checkpoint);
                local.restore(&checkpoint)?;
                local
            }
            None => Simulation::resume(checkpoint)?,
        };
        let mut shared = Shared { axis: domain.axis(), room, ..Shared::default() };
        (shared.sent, shared.received) = (vec![Vec::new(); size], vec![Vec::new(); size]);
        for (place, index) in (0..).zip(&present) {
            let (sphere, owner) = (&spheres[*index as usize], domain.owners[*index as usize] as usize);
            if owner != rank {
                shared.received[owner].extend((!sphere.fixed).then_some(place));
                continue;
            }
            shared.own.push(place);
            shared.starts.push(sphere.position.to_array()[domain.axis()]);
            let others = (0..size).filter(|other| *other != rank && domain.needs_copy(*other, sphere, depth));
            others.for_each(|other| shared.sent[other].push(place));
        }
        let rows = Rows::new(&mut local, shared)?;
        let messages = rows.messages();
        Ok(Self { local, rows, domain, rank: rank as u32, has_room: true, has_wrong_copies: false, dt, messages })
    }

    /// The simulation of the part, for another state.
    pub(super) fn into_simulation(mut self) -> Simulation {
        self.local.unshare();
        self.local
    }

    /// How the spheres are divided.
    pub(super) fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Gives a checkpoint what the steps have left beyond the state of the spheres.
    pub(super) fn put_history(&self, checkpoint: &mut Checkpoint) {
        self.local.put_history(checkpoint);
    }

    /// Number of own spheres, and of copies.
    pub(super) fn counts(&self) -> [usize; 2] {
        let Shared { own, received, .. } = self.rows.shared();
        [own.len(), received.iter().map(Vec::len).sum()]
    }

    /// The counts of the last step, of the contacts that this process counts.
    pub(super) fn report(&self) -> Report {
        self.local.report()
    }

    /// Whether all own spheres are close enough to where they were when spheres were divided, also at the next evaluation of forces.
    pub(super) fn has_room(&self, dt: f32) -> bool {
        self.has_room && dt <= self.dt
    }

    /// Whether the copies that others have of the own spheres may be wrong: a step was repeated after its rows had been sent.
    pub(super) fn has_wrong_copies(&self) -> bool {
        self.has_wrong_copies
    }

    /// Whether the next step builds lists.
    pub(super) fn wants_lists(&self) -> bool {
        self.local.wants_lists()
    }

    /// Lets the next step build lists.
    pub(super) fn request_lists(&mut self) {
        self.local.request_lists();
    }

    /// Takes a step of `dt` seconds, and exchanges the states of spheres with the processes that have copies of them: on a GPU during the
    /// step, if it can. Returns what failed in this process.
    ///
    /// # Errors
    /// As for [`Ranks::exchange`].
    pub(super) fn step(&mut self, dt: f32, ranks: &mut impl Ranks, work: &mut Work) -> Result<Result<()>> {
        let start = Instant::now();
        let mut sent = Ok(());
        let mut during = 0.0;
        let exchange = |to: &[Vec<u32>], from: &mut [Vec<u32>]| sent = timed(&mut during, || ranks.exchange(to, from));
        let (done, is_exchanged) = self.rows.step(&mut self.local, dt, &mut self.messages, exchange);
        sent?;
        work.steps += start.elapsed().as_secs_f64() - during;
        work.exchange += during;
        let done = done.map_err(|error| match error {
            Error::NonFinite { sphere, step, stage } => Error::NonFinite { sphere: self.index_in_whole(sphere), step, stage },
            other => other,
        });
        if !is_exchanged {
            return Ok(done.and(self.exchange(dt, ranks, work)?));
        }
        self.has_wrong_copies = self.rows.was_repeated();
        Ok(done.and(self.look(dt)))
    }

    /// Sends the states of spheres to the processes that have copies of them, and gives the own copies the states that others send. The next
    /// step has `dt` seconds. Returns what failed in this process.
    ///
    /// # Errors
    /// As for [`Ranks::exchange`].
    pub(super) fn exchange(&mut self, dt: f32, ranks: &mut impl Ranks, work: &mut Work) -> Result<Result<()>> {
        self.has_wrong_copies = false;
        let Self { local, rows, messages: [to, from], .. } = self;
        let taken = timed(&mut work.rows, || rows.take(local, to));
        timed(&mut work.exchange, || ranks.exchange(to, from))?;
        let put = timed(&mut work.rows, || rows.put(local, from, dt));
        Ok(taken.and(put).and(self.look(dt)))
    }

    /// Notes whether spheres have room for a step of `dt` seconds.
    fn look(&mut self, dt: f32) -> Result<()> {
        self.dt = dt;
        self.has_room = self.rows.has_room(&self.local, dt)?;
        Ok(())
    }

    /// The state of the own spheres, for all processes.
    pub(super) fn words(&mut self, whole: &Scene) -> Result<Vec<u32>> {
        let springs = self.local.kept_springs()?;
        let report = self.local.report();
        let rows = self.rows.own_rows(&mut self.local)?;
        let mut words = vec![report.contacts, report.max_overlap.to_bits(), rows.len() as u32];
        words.extend(rows.as_flattened());
        springs.iter().for_each(|spring| state::add_spring(spring, whole, &self.domain, self.rank, &mut words));
        Ok(words)
    }

    /// The index in the whole scene of a sphere with this local index.
    fn index_in_whole(&self, local: usize) -> usize {
        let mut own = self
            .rows
            .shared()
            .own
            .iter()
            .zip((0..self.domain.owners.len()).filter(|index| self.domain.owners[*index] == self.rank));
        // The state of a copy is not finite only where that of its owner is not, which reports it too.
        own.find(|(place, _)| **place as usize == local).map_or(local, |(_, index)| index)
    }
}

/// How far spheres may move along an axis until they are divided again, and how far from the own spheres of a process others are copied,
/// in units.
fn room_and_depth(whole: &Checkpoint, domain: &Domain, reach: f64, dt: f32) -> (f64, f64) {
    let moving = || whole.scene.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
    let radius = moving().map(|(_, sphere)| f64::from(sphere.radius)).fold(0.0, f64::max);
    let speed = moving().map(|(index, sphere)| {
        let rate = whole.rates.get(index).map_or(0.0, |rates| rates[domain.axis()]);
        f64::from(sphere.velocity.to_array()[domain.axis()].abs() + 0.5 * dt * rate.abs())
    });
    let fastest = speed.fold(0.0, f64::max);
    let least = (LEAST_ROOM * radius).max(SHARE_OF_SLAB * domain.thickness());
    let room = least.max(STEPS_OF_ROOM * fastest * f64::from(dt));
    (room, 2.0 * radius * reach + 2.0 * room)
}

/// The state of some of the spheres, given by their indices in ascending order, and of all walls.
fn local_checkpoint(whole: &Checkpoint, present: &[u32]) -> Result<Checkpoint> {
    let mut local = whole.clone();
    let mut present_next = present.iter().peekable();
    let is_absent = |index: usize| present_next.next_if(|next| **next as usize == index).is_none();
    let absent: Vec<bool> = (0..whole.scene.spheres().len()).map(is_absent).collect();
    let ids: Vec<SphereId> = whole.scene.sphere_ids().zip(&absent).filter_map(|(id, absent)| absent.then_some(id)).collect();
    local.scene.remove_spheres(&ids)?;
    // They measure the whole scene, in the gathered state, or act on it between two steps.
    local.scene.gauges.clear();
    local.scene.inlets.clear();
    local.scene.outlets.clear();
    local.scene.sensors.clear();
    if !whole.rates.is_empty() {
        local.rates = present.iter().map(|index| whole.rates[*index as usize]).collect();
    }
    if !whole.residues.is_empty() {
        local.residues = present.iter().map(|index| whole.residues[*index as usize]).collect();
    }
    local.options = Options { pair_capacity: None, ..whole.options.clone() }
        .without(Optimization::JoinedSteps)
        .without(Optimization::ListInterval);
    Ok(local)
}
