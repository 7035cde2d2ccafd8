//! The copy of a state on which observations are computed: on the host, by the stages of the CPU backend, with spheres in order of
//! addition.
//!
//! A simulation keeps its copy. What follows from the objects and the settings alone is packed again only after they change. AABBs
//! and lists are built again only when a sphere has left its AABB, as in a step.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::exec::cpu;
use crate::model::layout::{FLAG_CONTINUOUS, FLAG_SHEARED, GRAIN, LAW_THESIS};
use crate::model::lists::Lists;
use crate::model::muscles::MuscleClock;
use crate::model::status::{REJECTED_COUNT, REJECTED_ESCAPED, REJECTED_HISTORY, REJECTED_PAIRS, Status};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::travel::outside;
use crate::physics::walls::{Reach, escape};
use crate::scene::Scene;
use crate::settings::{BroadPhase, Integrator};
use crate::simulation::drive::MAX_ATTEMPTS;
use crate::simulation::lists::{room_for, widen_after_escape};
use crate::simulation::springs::put_springs;
use crate::simulation::{Simulation, engine};
use crate::step::collisions::{find_collisions, synchronise};
use crate::step::forces::{loads, rod_loads};
use crate::step::schedule::{Phase, Run};
use crate::step::walls::move_walls::place_walls;
use crate::user_laws::set::UserLaws;

/// An integrator and a method that finds pairs.
pub(crate) type Methods = (Integrator, BroadPhase);

/// What an observation needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Detail {
    /// Lists that hold every pair in contact.
    Pairs,
    /// The collision flags of these pairs too.
    Collisions,
    /// The springs of contacts before the next step too.
    Springs,
    /// The contact forces of a law with history too.
    Forces,
}

impl Simulation {
    /// The scene in its current state, and a copy with AABBs and lists of its own.
    pub(super) fn observed(&mut self, detail: Detail) -> Result<(&Scene, &World)> {
        self.sync()?;
        let (step, methods) = (self.report.steps, self.methods());
        let mut world = match self.observation.take() {
            Some(mut world) => {
                self.move_on(&mut world);
                if holds_pairs(&world) {
                    cpu::run(&mut world, &finding(methods, detail));
                } else {
                    find(&mut world, methods, step)?;
                }
                world
            }
            None => {
                let laws = &self.world.user_laws;
                Box::new(observe(&self.scene, self.time_step, methods, step, &self.muscle_clock, laws)?)
            }
        };
        // With JKR cohesion, the spring of a contact tells whether a neck connects its bodies, and with polygons, whether a body passes.
        let layout = &world.step.layout;
        let tell = layout.neck > 0.0 || layout.law != LAW_THESIS && layout.polygons > 0;
        if detail >= Detail::Springs || tell {
            let device = self.engine.waiter();
            let springs = engine::block_on(device, self.springs())?;
            put_springs(&mut world, &self.scene, &springs);
        }
        if detail == Detail::Forces {
            find_loads(&mut world);
        }
        Ok((&self.scene, self.observation.insert(world)))
    }

    /// The integrator and the method that finds pairs.
    pub(super) fn methods(&self) -> Methods {
        (self.integrator(), self.broad_phase_method())
    }

    /// Gives a copy of an earlier state the positions, velocities and times of the current one.
    fn move_on(&self, world: &mut World) {
        world.status = Status::default();
        world.set_spheres(&self.scene);
        world.set_muscles(&self.scene, &self.muscle_clock);
        place_walls(world, &self.scene, &self.muscle_clock);
        world.set_time_step(self.time_step);
        world.set_shear(&self.scene, 0);
        self.put_lists_of_observation(world);
    }
}

/// The state of a scene after `step` steps of `dt` seconds, with AABBs, lists and collision flags.
pub(crate) fn observe(
    scene: &Scene,
    dt: f32,
    methods: Methods,
    step: u64,
    clock: &MuscleClock,
    laws: &UserLaws,
) -> Result<World> {
    let mut world = World::build_with(scene, laws.clone())?;
    world.set_integrator(methods.0);
    world.set_muscles(scene, clock);
    place_walls(&mut world, scene, clock);
    world.set_time_step(dt);
    world.set_shear(scene, 0);
    // The contacts of the present state, and not those within the last step.
    world.set_flags(FLAG_CONTINUOUS, 0);
    find(&mut world, methods, step)?;
    Ok(world)
}

pub(crate) fn view_and_lists(world: &World) -> (View<'_>, Lists<'_>) {
    let view =
        View::new(&world.step, &world.topology, &world.states[0]).at_evaluation(&world.status, 0).with_laws(&world.user_laws);
    (view, Lists::new(&world.step, &world.lists))
}

/// Whether lists that were built for an earlier state hold every pair in contact: no sphere and no wall has left its AABB. Fixed spheres count too,
/// because an edit may move them. In a sheared scene they do not, because images slide.
fn holds_pairs(world: &World) -> bool {
    if world.step.constants.flags & FLAG_SHEARED != 0 {
        return false;
    }
    let view = View::new(&world.step, &world.topology, &world.states[0]);
    let spheres = (0..world.step.layout.spheres).into_par_iter().with_min_len(GRAIN);
    let holds_spheres = spheres.all(|sphere| outside(&view, &world.aabbs, sphere, view.position(sphere)) <= 0.0);
    let walls = || (world.step.movers()..world.step.objects()).filter(|_| world.step.layout.walls_at != 0);
    holds_spheres
        && walls().all(|id| {
            let reach = Reach::of(&view, view.object(id));
            reach.is_none_or(|reach| escape(&view, &world.aabbs[id as usize], &reach, 0.0) == 0.0)
        })
}

/// The stages that find the velocities at the time of the positions and, if they are needed, set collision flags.
fn finding((integrator, method): Methods, detail: Detail) -> Vec<Run> {
    let is_needed =
        |run: &&Run| run.stage.is(&synchronise::STAGE) || detail >= Detail::Collisions && run.stage.is(&find_collisions::STAGE);
    Phase::HandleCollisions.stages(integrator, method).iter().filter(is_needed).copied().collect()
}

/// Builds AABBs and lists, and sets collision flags.
fn find(world: &mut World, methods: Methods, step: u64) -> Result<()> {
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase].iter().flat_map(|phase| phase.stages(methods.0, methods.1));
    let stages: Vec<Run> = phases.copied().chain(finding(methods, Detail::Collisions)).collect();
    for attempts in 0..=MAX_ATTEMPTS {
        world.status = Status::default();
        cpu::run(world, &stages);
        let status = world.status;
        if status.rejected == 0 {
            return Ok(());
        }
        // As in a step (`handle_rejection`): longer lists, or larger AABBs where coordinates or velocities are so large that
        // rounding takes a body out of its own AABB.
        if status.rejected & REJECTED_ESCAPED != 0 {
            let escape = f32::from_bits(status.escape_ratio);
            widen_after_escape(world, escape, attempts);
        }
        if status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) != 0 {
            let too_many = status.rejected & REJECTED_COUNT != 0;
            let rows = room_for(if too_many { u32::MAX } else { status.pair_rows_needed }, world.movers())?;
            world.set_pair_rows(rows);
        }
    }
    let reason = format!("the contacts cannot be found, AABB margin {}", world.step.lists.margin_scale);
    Err(Error::Stuck { step, attempts: MAX_ATTEMPTS, reason })
}

/// Computes the loads of all spheres.
fn find_loads(world: &mut World) {
    loop {
        (world.status.forces_due, world.status.history_blocks) = (1, 0);
        (rod_loads::STAGE.cpu)(world, 0);
        (loads::STAGE.cpu)(world, 0);
        if world.status.rejected & REJECTED_HISTORY == 0 {
            break;
        }
        world.status.rejected = 0;
        world.set_history_pool(world.status.history_blocks);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::{Backend, ContactLaw, Cuboid, Integrator, Material, Options, Pair, Scene, Simulation, Sphere};

    /// Balls of one material that fall on each other. The ball that is added last is fixed and apart from the others.
    fn heap(integrator: Integrator) -> Simulation {
        let mut scene = Scene::new();
        scene.settings.contact_law = ContactLaw::HertzMindlin;
        scene.settings.gravity = 10.0;
        scene.settings.collisions = false;
        let soft = scene.add_material(Material::new("soft").density(1.0).young(1e5).poisson(0.25)).unwrap();
        scene.set_pair(soft, soft, Pair::default().restitution(0.5).friction(0.5)).unwrap();
        scene.add_box(Cuboid::between([-9.0, -9.0, -9.0], [9.0, 0.0, 9.0]).material(soft)).unwrap();
        for k in 0..12_u8 {
            let [x, y] = [k % 2, k / 2].map(f32::from);
            let ball = Sphere::new([0.9 * x + 0.1 * y, 0.55 + 1.02 * y, 0.0], 0.5).density(1.0).material(soft);
            scene.add_sphere(ball).unwrap();
        }
        scene.add_sphere(Sphere::new([7.0, 5.0, 0.0], 0.5).density(1.0).material(soft).fixed()).unwrap();
        let options = Options::new().backend(Backend::Cpu).integrator(integrator);
        Simulation::with_options(scene, options).unwrap()
    }

    /// Everything that is observed.
    fn seen(simulation: &mut Simulation) -> String {
        let energy = simulation.energy().unwrap();
        let overlaps = [simulation.max_overlap().unwrap(), simulation.resting_overlap().unwrap()];
        format!("{energy:?} {overlaps:?} {:?} {:?}", simulation.contacts().unwrap(), simulation.diagnostics().unwrap())
    }

    /// Constants of pairs of materials, which take milliseconds to find, are packed once for all observations of a run.
    #[test]
    fn observations_of_an_unchanged_scene_reuse_what_is_packed() {
        let mut simulation = heap(Integrator::VelocityVerlet);
        simulation.energy().unwrap();
        let packed = |simulation: &Simulation| simulation.observation.as_ref().unwrap().topology.as_ptr();
        let first = packed(&simulation);
        for _ in 0..50 {
            simulation.run(7, 1e-3).unwrap();
            seen(&mut simulation);
            assert_eq!(packed(&simulation), first);
        }
    }

    /// What is observed on a copy that was reused is bitwise what is observed on a new one, after steps and after edits of every kind.
    #[test]
    fn reused_copies_show_what_new_ones_show() {
        for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
            let mut simulation = heap(integrator);
            let ids: Vec<_> = simulation.scene().sphere_ids().collect();
            let soft = simulation.scene().find_material("soft").unwrap();
            let mut before = seen(&mut simulation);
            for round in 0..16 {
                simulation.run(40, 1e-3).unwrap();
                match round {
                    1 => simulation.set_position(ids[3], [0.3, 9.0, 0.2]).unwrap(),
                    3 => simulation.set_velocity(ids[5], [0.0, -40.0, 0.0]).unwrap(),
                    5 => simulation.set_force(ids[4], [3.0, 0.0, 0.0]).unwrap(),
                    7 => simulation.set_pair(soft, soft, Pair::default().restitution(0.9).friction(0.1)).unwrap(),
                    9 => drop(simulation.add_sphere(Sphere::new([0.2, 9.0, 0.1], 0.4).material(soft)).unwrap()),
                    11 => simulation.remove_sphere(ids[0]).unwrap(),
                    13 => simulation.set_settings(simulation.settings().with(|settings| settings.gravity = 3.0)).unwrap(),
                    15 => {
                        // The lists then hold for all other balls.
                        seen(&mut simulation);
                        let beside = simulation.spheres().unwrap()[4].position + 0.9 * Vec3::Z;
                        simulation.set_position(ids[12], beside).unwrap();
                    }
                    _ => {}
                }
                let reused = seen(&mut simulation);
                simulation.observation = None;
                assert_eq!(reused, seen(&mut simulation), "{integrator}, round {round}");
                assert_ne!(reused, before, "{integrator}, round {round}");
                before = reused;
            }
        }
    }
}
