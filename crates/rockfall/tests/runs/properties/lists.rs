//! The results do not depend on how pairs were found or how a scene was built: they are bitwise identical.

use std::cell::Cell;

use glam::Vec3;
use proptest::prelude::*;
use rockfall::exec::cpu;
use rockfall::model::layout::SLICE;
use rockfall::model::world::World;
use rockfall::step::schedule::Phase;
use rockfall::{
    Backend, BoxId, BroadPhase, Capsule, CapsuleId, Cuboid, Error, Integrator, Options, Polygon, PolygonId, Rod, RodId, Scene,
    Simulation, Sphere, SphereId, SphereState, Spring, SpringId, Tether, TetherId,
};

use super::things::{Outcome, Thing, ball, check, direction, simulation, thing, vector, weightless};

fn backends() -> Vec<(Backend, u32)> {
    let cpu = (Backend::Cpu, 200);
    if cfg!(feature = "gpu") { vec![cpu, (Backend::Gpu, 3)] } else { vec![cpu] }
}

/// Bodies with forces that carry them out of their AABBs, whatever the margins are.
fn wild() -> impl Strategy<Value = Vec<Thing>> {
    let pushed = (thing(1.5, 4.0), vector(300.0)).prop_map(|(thing, force)| thing.map(|sphere| sphere.force(force)));
    prop::collection::vec(pushed, 2..10)
}

/// Runs the stages of the CPU backend with AABBs that contain everything, so that every pair is listed.
fn with_all_pairs(scene: &Scene, steps: u32, dt: f32) -> World {
    let mut world = World::build(scene).unwrap();
    world.step.constants.dt = dt;
    world.step.lists.margin_scale = 1e9;
    world.set_pair_rows(world.movers().div_ceil(SLICE) * world.objects() * 12);
    let phases = Phase::STEP.iter().flat_map(|phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce));
    let stages: Vec<_> = phases.copied().collect();
    for _ in 0..steps {
        cpu::run(&mut world, &stages);
        assert_eq!(world.status.rejected, 0, "{:?}", world.status);
    }
    world
}

fn assert_same(world: &World, spheres: &[SphereState]) -> Outcome {
    let n = spheres.len();
    for (place, sphere) in spheres.iter().enumerate() {
        prop_assert_eq!(world.states[0][place].truncate(), sphere.position);
        prop_assert_eq!(world.states[0][n + place].truncate(), sphere.velocity);
        prop_assert_eq!(world.states[0][2 * n + place].truncate(), sphere.angular_momentum);
        prop_assert_eq!(world.orientations[place], sphere.orientation.into());
    }
    Ok(())
}

/// With narrow AABBs and short lists, steps are rejected and repeated. This must not change the results.
#[test]
fn margins_and_capacities_do_not_change_the_results() {
    let replays = Cell::new(0);
    check(60, wild(), |things| -> Outcome {
        let mut scene = weightless(&things);
        scene.add_box(Cuboid::between((-1.0, -2.0, -1.0), (1.0, -1.0, 1.0))).unwrap();
        let world = with_all_pairs(&scene, 6, 0.01);
        let options = Options::new().backend(Backend::Cpu).pair_capacity(1);
        let mut simulation = Simulation::with_options(scene, options).unwrap();
        // AABBs for a step of almost no duration: every moving body leaves its AABB.
        simulation.set_time_step(1e-6).unwrap();
        simulation.update_aabbs().unwrap();
        simulation.broad_phase().unwrap();
        // A lone collision is moved back by up to one time step.
        simulation.set_time_step(0.01).unwrap();
        simulation.handle_collisions().unwrap();
        simulation.update_positions(0.01).unwrap();
        simulation.run(5, 0.01).unwrap();
        replays.set(replays.get() + simulation.report().replays);
        assert_same(&world, &simulation.spheres().unwrap())
    });
    assert!(replays.get() > 60, "{} replays", replays.get());
}

/// A body moves twenty units per step through a crowd. The result is the same as with all pairs, and a body that hits
/// nothing moves in a straight line.
#[test]
fn a_fast_body_passes_a_crowd_as_with_all_pairs() {
    let crowd = prop::collection::vec(ball(2.0, 1.0), 3..12);
    let hits = Cell::new(0);
    check(40, (crowd, direction(), -0.1_f32..0.1), |(balls, direction, phase)| -> Outcome {
        let things: Vec<_> = balls.into_iter().map(Thing::Sphere).collect();
        let start = -(20.0 * phase + 20.0) * direction;
        let flying = Sphere::new(start, 0.5).velocity(1000.0 * direction);
        let mut scene = weightless(&things);
        let id = scene.add_sphere(flying).unwrap();
        let world = with_all_pairs(&scene, 3, 0.02);
        let mut simulation = simulation(scene, Backend::Cpu);
        simulation.run(3, 0.02).unwrap();
        assert_same(&world, &simulation.spheres().unwrap())?;
        let state = simulation.sphere(id).unwrap();
        let has_collided = state.velocity != flying.velocity;
        prop_assert!(has_collided || state.position.distance(start + 60.0 * direction) < 1e-4, "{state:?}");
        hits.set(hits.get() + usize::from(has_collided));
        Ok(())
    });
    // A body that overlaps another after its centre has passed has no collision, because the two separate fast.
    assert!((5..40).contains(&hits.get()), "{} hits", hits.get());
}

/// A random change of a scene. Indices are taken modulo the number of objects.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there are few edits at a time")]
enum Edit {
    Add(Thing),
    AddCapsule(Vec3, Vec3),
    Join(usize, usize, u8, f32),
    AddStatic(Vec3, bool),
    Remove(usize, u8),
    Move(usize, Vec3),
    Push(usize, Vec3),
    Stiffen(usize, f32),
    Step,
}

fn edit() -> impl Strategy<Value = Edit> {
    let index = 0..64_usize;
    prop_oneof![
        4 => thing(2.0, 1.0).prop_map(Edit::Add),
        1 => (vector(2.0), direction()).prop_map(|(end, axis)| Edit::AddCapsule(end, end + axis)),
        3 => (index.clone(), index.clone(), 0..3_u8, 0.3_f32..1.5).prop_map(|(a, b, kind, l)| Edit::Join(a, b, kind, l)),
        1 => (vector(3.0), any::<bool>()).prop_map(|(place, is_box)| Edit::AddStatic(place, is_box)),
        3 => (index.clone(), 0..7_u8).prop_map(|(place, kind)| Edit::Remove(place, kind)),
        1 => (index.clone(), vector(2.0)).prop_map(|(place, to)| Edit::Move(place, to)),
        4 => (index.clone(), vector(5.0)).prop_map(|(place, force)| Edit::Push(place, force)),
        2 => (index, 1.0_f32..30.0).prop_map(|(place, stiffness)| Edit::Stiffen(place, stiffness)),
        3 => Just(Edit::Step),
    ]
}

/// A simulation under edits, with every handle that it returned.
struct Edited {
    simulation: Simulation,
    spheres: Vec<SphereId>,
    rods: Vec<RodId>,
    capsules: Vec<CapsuleId>,
    springs: Vec<SpringId>,
    tethers: Vec<TetherId>,
    boxes: Vec<BoxId>,
    polygons: Vec<PolygonId>,
}

fn pick<T: Copy>(ids: &[T], place: usize) -> Option<T> {
    ids.get(place % ids.len().max(1)).copied()
}

/// Returns `None` for the handle of a removed object. Panics on any other error.
fn unless_stale<T>(result: rockfall::Result<T>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(Error::StaleHandle { .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

impl Edited {
    fn new(backend: Backend) -> Self {
        let mut scene = weightless(&[]);
        scene.settings.gravity = 1.0;
        Self {
            simulation: simulation(scene, backend),
            spheres: Vec::new(),
            rods: Vec::new(),
            capsules: Vec::new(),
            springs: Vec::new(),
            tethers: Vec::new(),
            boxes: Vec::new(),
            polygons: Vec::new(),
        }
    }

    fn apply(&mut self, edit: &Edit) {
        let simulation = &mut self.simulation;
        match edit {
            Edit::Add(thing) => {
                let scene = weightless(std::slice::from_ref(thing));
                let ids: Vec<_> = scene.spheres().iter().map(|sphere| simulation.add_sphere(*sphere).unwrap()).collect();
                if let Some(rod) = scene.rods().first() {
                    let mut rod = *rod;
                    (rod.end1, rod.end2) = (ids[0], ids[1]);
                    self.rods.push(simulation.add_rod(rod).unwrap());
                }
                self.spheres.extend(ids);
            }
            Edit::AddCapsule(end1, end2) => {
                self.capsules.push(simulation.add_capsule(Capsule::new(*end1, *end2, 0.3)).unwrap());
            }
            Edit::Join(a, b, kind, length) => self.join(*a, *b, *kind, *length),
            Edit::AddStatic(place, true) => {
                let cuboid = Cuboid::between(*place, *place + Vec3::ONE);
                self.boxes.push(simulation.add_box(cuboid).unwrap());
            }
            Edit::AddStatic(place, false) => {
                let polygon = Polygon::new(*place, Vec3::Z, Vec3::X);
                self.polygons.push(simulation.add_polygon(polygon).unwrap());
            }
            Edit::Remove(place, kind) => self.remove(*place, *kind),
            Edit::Move(place, to) => {
                pick(&self.spheres, *place).map(|id| unless_stale(simulation.set_position(id, *to)));
            }
            Edit::Push(place, force) => {
                pick(&self.spheres, *place).map(|id| unless_stale(simulation.set_force(id, *force)));
            }
            Edit::Stiffen(place, stiffness) => {
                let change = |spring: &mut Spring| spring.stiffness = *stiffness;
                pick(&self.springs, *place).map(|id| unless_stale(simulation.update_spring(id, change)));
            }
            Edit::Step => {
                simulation.step(0.005).unwrap();
            }
        }
    }

    fn join(&mut self, a: usize, b: usize, kind: u8, length: f32) {
        let (Some(one), Some(other)) = (pick(&self.spheres, a), pick(&self.spheres, b)) else {
            return;
        };
        if one == other {
            return;
        }
        let simulation = &mut self.simulation;
        match kind {
            0 => self.rods.extend(unless_stale(simulation.add_rod(Rod::new(one, other, 0.1)))),
            1 => self.springs.extend(unless_stale(simulation.add_spring(Spring::new(one, other, 20.0, length)))),
            _ => self.tethers.extend(unless_stale(simulation.add_tether(Tether::new(one, Vec3::ONE, 10.0)))),
        }
    }

    fn remove(&mut self, place: usize, kind: u8) {
        let simulation = &mut self.simulation;
        match kind {
            0 => pick(&self.spheres, place).and_then(|id| unless_stale(simulation.remove_sphere(id))),
            1 => pick(&self.rods, place).and_then(|id| unless_stale(simulation.remove_rod(id))),
            2 => pick(&self.capsules, place).and_then(|id| unless_stale(simulation.remove_capsule(id))),
            3 => pick(&self.springs, place).and_then(|id| unless_stale(simulation.remove_spring(id))),
            4 => pick(&self.tethers, place).and_then(|id| unless_stale(simulation.remove_tether(id))),
            5 => pick(&self.boxes, place).and_then(|id| unless_stale(simulation.remove_box(id))),
            _ => pick(&self.polygons, place).and_then(|id| unless_stale(simulation.remove_polygon(id))),
        };
    }
}

/// An edited scene continues like one that was built in its present state.
#[test]
fn an_edited_scene_continues_like_a_new_one() {
    for (backend, cases) in backends() {
        check(cases, prop::collection::vec(edit(), 5..40), |edits| -> Outcome {
            let mut edited = Edited::new(backend);
            for edit in &edits {
                edited.apply(edit);
            }
            let simulation = &mut edited.simulation;
            // Set one sphere to its present position. This makes the edited scene restore its lengths in the next step,
            // as a new scene does in its first step.
            let scene = simulation.sync().unwrap();
            let first = scene.sphere_ids().next().map(|id| (id, scene.sphere(id).unwrap().centre()));
            if let Some((id, centre)) = first {
                simulation.set_centre(id, centre).unwrap();
            }
            // An f64 does not hold the last bits of a small low part, so the scene is taken afterwards.
            let scene = simulation.sync().unwrap().clone();
            let mut new_one = super::things::simulation(scene, backend);
            for _ in 0..3 {
                simulation.step(0.005).unwrap();
                new_one.step(0.005).unwrap();
                prop_assert_eq!(simulation.spheres().unwrap(), new_one.spheres().unwrap());
                let counted = |simulation: &Simulation| (simulation.report().contacts, simulation.report().collisions);
                prop_assert_eq!(counted(simulation), counted(&new_one));
            }
            Ok(())
        });
    }
}
