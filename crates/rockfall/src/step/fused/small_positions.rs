//! Runs the phase of positions of a small scene without rods on one thread of the CPU, for RK4.
//!
//! It computes the same, bit for bit, as the stages that it replaces, and takes a fraction of their time: every spring is evaluated
//! once for both of its ends, four springs at a time, and no stage starts or ends.

use glam::{Vec3, Vec4};

use crate::model::counters::{Tally, count_builds};
use crate::model::lanes::{LANES, Vec3x4};
use crate::model::layout::{GRAIN, KIND_FORCE, KIND_TETHER, LAW_THESIS, MUSCLE_WORDS};
use crate::model::lists::Lists;
use crate::model::muscles::MusclesOfFour;
use crate::model::state::Motion;
use crate::model::traits::Traits;
use crate::model::view::{TINY, View};
use crate::model::world::World;
use crate::physics::forces::attached::tether_force;
use crate::physics::forces::contacts::{Contacts, Load};
use crate::physics::forces::rates_of;
use crate::physics::laws::history::{Histories, Owned};
use crate::settings::{BroadPhase, Integrator};
use crate::step::forces::loads::note_place;
use crate::step::integrate::advance::next_state;
use crate::step::integrate::finish::finished;
use crate::step::integrate::turn::turn_for;
use crate::step::integrate::{end_step, find_passages};
use crate::step::schedule::{Phase, Run};

/// Whether [`update_positions`] computes the phase of positions of a scene. The stages of larger scenes are divided among threads.
fn fits(traits: &Traits) -> bool {
    traits.law == LAW_THESIS
        && !traits.residues
        && !traits.rods
        && !traits.walls
        && !traits.rigid
        && !traits.sheared
        && (1..2 * GRAIN as u32).contains(&traits.spheres)
}

/// Returns how many of the stages of a step come before the phase of positions, if [`update_positions`] can replace that phase.
pub(crate) fn stages_before(world: &World, stages: &[Run]) -> Option<usize> {
    let replaced = Phase::UpdatePositions.stages(Integrator::Rk4, BroadPhase::BruteForce);
    let first = stages.len().checked_sub(replaced.len())?;
    let is_same = |(one, other): (&Run, &Run)| one.stage.is(other.stage) && one.pass == other.pass;
    (world.joins_steps && fits(&world.step.traits()) && stages[first..].iter().zip(replaced).all(is_same)).then_some(first)
}

/// Runs the phase.
pub(crate) fn update_positions(world: &mut World) {
    if world.status.rejected != 0 {
        end_step::end_step(world, 0);
        return;
    }
    count_builds(&mut world.status);
    let mut springs = Springs::new(world);
    for pass in 0..3 {
        advance(world, &mut springs, pass);
        if world.status.rejected != 0 {
            return;
        }
    }
    finish(world, &mut springs);
    if world.step.traits().counts_passages() {
        find_passages::find_passages(world, 3);
    }
    end_step::end_step(world, 0);
}

/// Computes loads and the next stage state, as the stages `loads` and `advance` do.
fn advance(world: &mut World, springs: &mut Springs, pass: u32) {
    let (done, todo) = world.states.split_at_mut(pass as usize + 1);
    let start = View::new(&world.step, &world.topology, &done[0]);
    let view = View::new(&world.step, &world.topology, &done[pass as usize])
        .at_evaluation(&world.status, pass)
        .with_laws(&world.user_laws);
    let lists = Lists::new(&world.step, &world.lists);
    let mut tally = Tally::default();
    // Stages 2 and 3 are at the same time.
    springs.evaluate(&Contacts { view: &view, lists: &lists, histories: Histories::new(&[]) }, pass, pass != 2, &mut tally);
    for sphere in 0..world.step.layout.spheres {
        let next = if view.is_fixed(sphere) {
            Motion::of(&start, sphere)
        } else {
            let rates = rates_of(&view, sphere, &springs.loads[sphere as usize]);
            next_state(&start, &view, pass, sphere, &rates, &mut tally)
        };
        note_place(&view, &world.aabbs, pass, sphere, &mut tally);
        set(&mut todo[0], &start, sphere, next);
    }
    tally.add_to(&mut world.status);
}

/// Computes loads and the state after the step, and turns the spheres, as the stages `loads` and `finish` do.
fn finish(world: &mut World, springs: &mut Springs) {
    let [start, y2, y3, y4] = &mut world.states;
    let views = [&*y2, y3, y4].map(|state| {
        View::new(&world.step, &world.topology, state).at_evaluation(&world.status, 3).with_laws(&world.user_laws)
    });
    let last = &views[2];
    let lists = Lists::new(&world.step, &world.lists);
    let mut tally = Tally::default();
    (0..world.step.layout.spheres).for_each(|sphere| note_place(last, &world.aabbs, 3, sphere, &mut tally));
    tally.add_to(&mut world.status);
    if world.status.rejected != 0 {
        return;
    }
    let mut tally = Tally::default();
    springs.evaluate(&Contacts { view: last, lists: &lists, histories: Histories::new(&[]) }, 3, true, &mut tally);
    let n = world.step.layout.spheres as usize;
    for sphere in 0..world.step.layout.spheres {
        let place = sphere as usize;
        let [position, velocity, angular_momentum, low] = [0, n, 2 * n, 3 * n].map(|region| start[region + place].truncate());
        let before = Motion { position, low, velocity, angular_momentum, residues: Vec4::ZERO };
        let rates = || rates_of(last, sphere, &springs.loads[place]);
        let (motion, spin) = finished(before, &views, sphere, rates, &mut tally);
        set(start, last, sphere, motion);
        turn_for(&mut world.orientations[place], spin, world.step.constants.dt);
    }
    tally.add_to(&mut world.status);
}

/// Writes a motion, with the radius, inverse mass and inverse inertia that the sphere has in `view`.
fn set(state: &mut [Vec4], view: &View, sphere: u32, motion: Motion) {
    let (place, n) = (sphere as usize, view.step.layout.spheres as usize);
    state[place] = motion.position.extend(view.radius(sphere));
    state[n + place] = motion.velocity.extend(view.inverse_mass(sphere));
    state[2 * n + place] = motion.angular_momentum.extend(view.inverse_inertia(sphere));
    if let Some(low) = state.get_mut(3 * n + place) {
        *low = motion.low.extend(0.0);
    }
}

/// Four springs. The last ones may be unused: they have equal ends.
#[derive(Clone, Copy, Default)]
struct Four {
    a: [u32; LANES],
    b: [u32; LANES],
    stiffness: Vec4,
    /// Rest lengths, without and with muscles.
    constant_length: Vec4,
    length: Vec4,
    damping: Vec4,
    muscles: MusclesOfFour,
}

/// The springs of a world, and the load on each sphere.
struct Springs {
    fours: Vec<Four>,
    loads: Vec<Load>,
    /// Whether there are tethers or external forces.
    has_others: bool,
}

impl Springs {
    fn new(world: &World) -> Self {
        let step = &world.step;
        let count = world.step.spring_count();
        let view = View::new(step, &world.topology, &world.states[0]);
        let mut fours = vec![Four::default(); (count as usize).div_ceil(LANES)];
        for (four, first) in fours.iter_mut().zip((0..).step_by(LANES)) {
            let springs = first..count.min(first + LANES as u32);
            for (lane, spring) in springs.clone().enumerate() {
                let record = view.plain_spring(spring);
                [four.a[lane], four.b[lane]] = record.ends;
                four.stiffness[lane] = record.stiffness;
                four.constant_length[lane] = record.length;
                four.damping[lane] = record.damping;
            }
            four.length = four.constant_length;
            if step.layout.muscles_at != 0 {
                let mut records = [[0; MUSCLE_WORDS as usize]; LANES];
                records.iter_mut().zip(springs).for_each(|(record, spring)| *record = view.muscle(spring));
                four.muscles = MusclesOfFour::of(&records);
            }
        }
        // Every other attachment has a word of adjacency, which ends the topology buffer. A spring has two.
        let words = match step.layout.adjacency_at {
            0 => 0,
            at => world.topology.len() as u32 - at - 2 * step.layout.spheres,
        };
        Self { fours, loads: vec![Load::default(); step.layout.spheres as usize], has_others: words > 2 * count }
    }

    /// Computes the loads. Contacts come first, then springs, tethers and external forces, on every sphere in the order of its
    /// attachments: springs, tethers, forces, each in insertion order. `has_new_time` tells whether the rest lengths of muscles change.
    fn evaluate(&mut self, contacts: &Contacts, pass: u32, has_new_time: bool, tally: &mut Tally) {
        let view = contacts.view;
        for (sphere, load) in (0..).zip(&mut self.loads) {
            let mut counts = (pass == 0).then_some(&mut *tally);
            *load = Load::default();
            if !view.is_fixed(sphere) {
                *load = contacts.sphere_load(sphere, &mut Owned::default(), counts);
            } else if let Some(tally) = &mut counts {
                contacts.count(sphere, tally);
            }
        }
        let has_muscles = view.step.layout.muscles_at != 0;
        for four in &mut self.fours {
            if has_muscles && has_new_time {
                four.length = four.muscles.lengths(four.constant_length, view.half_steps());
            }
            let forces = four.forces(view);
            for ((a, b), force) in four.a.iter().zip(four.b).zip(forces) {
                self.loads[*a as usize].force += force;
                // The force on the other end is computed from negated vectors, so it is the same with the other sign.
                self.loads[b as usize].force -= force;
            }
        }
        if self.has_others {
            self.add_others(view);
        }
    }

    fn add_others(&mut self, view: &View) {
        for (sphere, load) in (0..).zip(&mut self.loads) {
            for attachment in view.attachments(sphere) {
                match attachment.kind {
                    KIND_TETHER => load.force += tether_force(view, attachment.index, sphere),
                    KIND_FORCE => load.force += view.external_force(attachment.index),
                    _ => {}
                }
            }
        }
    }
}

impl Four {
    /// The forces on the ends A. The operations are those for a single spring.
    #[inline]
    fn forces(&self, view: &View) -> [Vec3; LANES] {
        let at = |ends: [u32; LANES]| Vec3x4::from_rows(ends.map(|end| view.place(end))).0;
        let motion = |ends: [u32; LANES]| Vec3x4::from_rows(ends.map(|end| view.motion(end))).0;
        let d = at(self.b) - at(self.a);
        let velocity = motion(self.b) - motion(self.a);
        let dd = d.dot(d);
        let distance = dd.sqrt();
        let n = d / distance;
        let size = self.stiffness * (distance - self.length) + self.damping * velocity.dot(n);
        let force = n * size;
        let coincide = dd.cmple(Vec4::splat(TINY));
        force.or_zero(!coincide).to_rows()
    }
}
