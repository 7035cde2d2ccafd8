//! The kernel of many worlds with one plausible mistake each. The comparison with simulations of their own must reject every one.

#![cfg(feature = "gpu")]

use rockfall::generate::creature;
use rockfall::glam::Vec3;
use rockfall::model::part::Part;
use rockfall::step::catalog::OUTSIDE;
use rockfall::step::stage::Stage;
use rockfall::step::wgsl::Wgsl;
use rockfall::{
    Backend, Cuboid, Integrator, Muscle, Options, Polygon, Report, Scene, Simulation, Sphere, SphereState, Spring, Tether,
    WorldPath, Worlds,
};

use crate::verdicts::{Key, Verdicts};

const DT: f32 = 0.005;
const STEPS: u64 = 40;

/// Correct text of the kernel, and wrong text.
struct Mistake(&'static str, &'static str);

static MISTAKES: &[Mistake] = &[
    Mistake("(name & END_B) != 0u", "(name & END_B) == 0u"),
    Mistake("own_springs.x + k / SPRING_NAMES", "own_springs.x"),
    Mistake("at < attached.y;", "at + 1u < attached.y;"),
    Mistake("first += WORLD_THREADS", "first += 2u * WORLD_THREADS"),
    Mistake("((number & 1u) == 1u)", "(number == 1u)"),
    Mistake("(is_symplectic_euler | (evaluated == 3u)) {\n        status.steps", "(evaluated == 0u) {\n        status.steps"),
    Mistake("changes[region] += 2.0 * change", "changes[region] += change"),
    Mistake("0.98 * margin * margin", "98.0 * margin * margin"),
    Mistake("own.w + other.w + margin + margin_of(other.w, state[velocity_at(id)].xyz)", "own.w + other.w"),
    Mistake("atomicStore(&moved[own_world], evaluations + 1u)", "atomicStore(&moved[own_world], 1u)"),
    Mistake("atomicStore(&moved[own_world], 1u)", "atomicStore(&moved[own_world], 0u)"),
    Mistake("mates.x & ~sphere_bits()", "0u"),
    Mistake("mates.x & sphere_bits()", "mates.x & 1u"),
    Mistake("k + 2u < own_springs.y", "k + 3u < own_springs.y"),
    Mistake("own_springs.x + own_springs.y", "own_springs.x + own_springs.y + 1u"),
    Mistake("reach + rounding(own, size)", "0.5 * reach"),
    Mistake("abs(distance) > reach", "abs(distance) > 0.5 * reach"),
    Mistake("return 32u + id", "return id"),
    Mistake("GROUP_MASK) == group", "GROUP_MASK) != group + 7u"),
    Mistake("(evaluated == 0u) | (inverse_mass(local)", "(evaluated == 4u) | (inverse_mass(local)"),
    Mistake("if evaluated == 0u {\n        last_contacts", "if evaluated == 1u {\n        last_contacts"),
    Mistake("(step.flags & FLAG_CONTINUE) == 0u", "(step.flags & FLAG_CONTINUE) != 0u"),
    Mistake("any(by.xyz != vec3f(0.0))", "any(by.xyz == vec3f(0.0))"),
    Mistake("is_symplectic_euler | (k == 0u)", "(k == 0u)"),
    Mistake("turn_own(symplectic_euler_sphere(i, load))", "turn_own(2.0 * symplectic_euler_sphere(i, load))"),
    Mistake("own_rows = own_world * 3u", "own_rows = own_world * 2u"),
    Mistake("first_spring = own_world * WORLD_SPRINGS", "first_spring = 0u"),
    Mistake("vec4u(first_spring) + ", ""),
    Mistake("group, groups) * GROUP_WORLDS + own_world", "group, groups) * GROUP_WORLDS"),
    Mistake("& (local < WORLD_THREADS)", "& (local < WORLD_THREADS - 1u)"),
    Mistake("atomicLoad(&awake) == 0u", "atomicLoad(&awake) != 0u"),
    Mistake("let stride = stride_of(step.boxes)", "let stride = stride_of(1u)"),
    Mistake("let stride = stride_of(step.polygons)", "let stride = stride_of(1u)"),
    Mistake("topology[muscle + 3u * stride]", "topology[muscle + 3u]"),
    Mistake("start[2].xyz, evaluated == 0u)", "start[2].xyz, evaluated == 1u)"),
];

/// Balls that cross each other's way, two groups, a fixed ball that is hit, tethers, a force, a polygon, and so many boxes that
/// some objects do not fit into the first 32.
fn balls() -> Scene {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.contact_force = 2000.0;
    scene.settings.contact_damping = 20.0;
    let ball = |scene: &mut Scene, sphere: Sphere| scene.add_sphere(sphere).expect("a valid sphere");
    ball(&mut scene, Sphere::new([0.0, 0.5, 0.0], 0.1).velocity([2.0, 0.0, 0.0]));
    ball(&mut scene, Sphere::new([0.4, 0.52, 0.0], 0.1).velocity([-2.0, 0.0, 0.3]));
    // It starts to move within the steps.
    let pulled = ball(&mut scene, Sphere::new([2.0, 0.5, 0.0], 0.05).force([60.0, 0.0, 0.0]));
    ball(&mut scene, Sphere::new([2.4, 0.5, 0.01], 0.1).angular_momentum([0.0, 0.01, 0.002]));
    ball(&mut scene, Sphere::new([4.0, 0.5, 0.0], 0.1).fixed());
    // It is held to the fixed ball.
    let held = ball(&mut scene, Sphere::new([4.0, 0.69, 0.02], 0.1));
    ball(&mut scene, Sphere::new([4.05, 0.7, 0.0], 0.1).group(3));
    ball(&mut scene, Sphere::new([8.0, 0.19, 8.0], 0.1).velocity([1.0, 0.0, 0.0]));
    ball(&mut scene, Sphere::new([20.0, 0.3, 0.0], 0.1).velocity([0.0, -4.0, 0.0]));
    scene.add_tether(Tether::new(pulled, [2.0, 1.0, 0.0], 30.0)).expect("a valid tether");
    scene.add_tether(Tether::new(held, [4.0, 0.5, 0.0], 100.0).length(0.1)).expect("a valid tether");
    for k in 0..30 {
        let low = Vec3::new(k as f32 - 10.0, -1.0, 0.0);
        scene.add_box(Cuboid::between(low - Vec3::Z, low + Vec3::new(1.0, 1.0, 10.0))).expect("a valid box");
    }
    for corner in [Vec3::new(19.0, 0.15, -2.0), Vec3::new(6.0, 0.1, 6.0)] {
        scene.add_polygon(Polygon::new(corner, Vec3::Z * 4.0, Vec3::X * 4.0)).expect("a valid polygon");
    }
    scene
}

/// Worlds of similar sizes, all of which run in one kernel.
fn scenes() -> Vec<Scene> {
    let mut torn = balls();
    let id = torn.sphere_ids().next().expect("a sphere");
    torn.add_tether(Tether::new(id, [9.0, 9.0, 0.0], 3e38)).expect("a valid tether");
    let mut tense = creature(12, 4).expect("a creature");
    let ids: Vec<_> = tense.sphere_ids().collect();
    for (k, pair) in ids.windows(2).enumerate() {
        let muscle = Muscle::new(0.3, 3.0, 0.1 * k as f32);
        tense.add_spring(Spring::new(pair[0], pair[1], 400.0, 0.3).muscle(muscle)).expect("a valid spring");
    }
    vec![balls(), torn, tense, creature(11, 6).expect("a creature")]
}

type Seen = (Vec<SphereState>, Report, bool);

fn seen_alone(scene: &Scene, integrator: Integrator, backend: Backend) -> Seen {
    let options = Options::new().backend(backend).integrator(integrator);
    let mut simulation = Simulation::with_options(scene.clone(), options).expect("it opens");
    let stopped = simulation.run(STEPS, DT).is_err();
    (simulation.spheres().expect("states"), simulation.report(), stopped)
}

/// The first two worlds share a workgroup, and so do the last two.
fn seen_in_worlds(integrator: Integrator, kernel: Option<&'static Stage>) -> Vec<Seen> {
    let options = Options::new().backend(Backend::Gpu).integrator(integrator);
    let mut worlds = Worlds::new(scenes(), options).expect("worlds");
    worlds.share_workgroups(true);
    if let Some(kernel) = kernel {
        worlds.set_kernel(kernel);
    }
    for steps in [7, STEPS - 7] {
        worlds.run(steps, DT).expect("steps");
    }
    let count = worlds.len();
    let see = |world: usize| {
        let report = worlds.report(world, None).expect("a report");
        assert_eq!(report.path, WorldPath::Device);
        (worlds.states(world).expect("states"), report.report, report.stopped.is_some())
    };
    (0..count).map(see).collect()
}

/// What a comparison looks at: bits of the states, counts, and whether the world is stopped.
fn bits((states, report, stopped): &Seen) -> (Vec<u32>, u64, u32, u32, bool) {
    let of = |state: &SphereState| {
        let vectors = [state.position, state.velocity, state.angular_momentum];
        vectors.iter().flat_map(Vec3::to_array).chain(state.orientation.to_array()).map(f32::to_bits).collect::<Vec<_>>()
    };
    (states.iter().flat_map(of).collect(), report.steps, report.contacts, report.max_overlap.to_bits(), *stopped)
}

const INTEGRATORS: [Integrator; 2] = [Integrator::Rk4, Integrator::SymplecticEuler];

/// The kernel with a mistake. A device keeps kernels by name, so it gets a name of its own.
fn broken(Mistake(right, wrong): &Mistake) -> &'static Stage {
    let stage = OUTSIDE[0];
    let name: &'static str = format!("{}_{:x}", stage.name, Key::of_code(&[right, wrong]).value()).leak();
    let mut parts = stage.parts();
    let is_of_worlds = |part: &&mut Part| part.file.starts_with("step/fused/");
    let found = match parts.iter_mut().filter(is_of_worlds).find(|part| part.text.contains(right)) {
        None => parts.iter_mut().find(|part| part.text.contains(right)),
        found => found,
    };
    let part = found.unwrap_or_else(|| panic!("the kernel has no {right:?}"));
    part.text = part.text.replacen(right, wrong, 1).leak();
    let own = parts.last_mut().expect("the file of the stage");
    own.text = own.text.replacen(&format!("fn {}(", stage.name), &format!("fn {name}("), 1).leak();
    Box::leak(Box::new(Stage { name, wgsl: Wgsl::Parts(parts.leak()), ..*stage }))
}

/// The key of the scenes and of what becomes of them. Results of the CPU backend stand for those of the device, which depend on its
/// driver.
fn key_of_input() -> Key {
    let mut key = Key::of_code(&[include_str!("broken.rs"), include_str!("../../src/step/wgsl.rs")]);
    for scene in scenes() {
        key.add(scene.to_text());
        for integrator in INTEGRATORS {
            key.add(format!("{:?}", bits(&seen_alone(&scene, integrator, Backend::Cpu))));
        }
    }
    key
}

#[test]
fn broken_kernels_of_worlds_are_rejected() {
    let _device = rockfall::gpu::SharedDevice::new();
    let expected = INTEGRATORS.map(|integrator| {
        let alone: Vec<_> = scenes().iter().map(|scene| bits(&seen_alone(scene, integrator, Backend::Gpu))).collect();
        let side_by_side: Vec<_> = seen_in_worlds(integrator, None).iter().map(bits).collect();
        assert!(alone == side_by_side, "{integrator}: the kernel without a mistake differs from simulations");
        alone
    });
    let verdicts = Verdicts::of("worlds");
    let input = key_of_input();
    let accepted = |Mistake(right, wrong): &&Mistake| {
        let kernel = broken(&Mistake(right, wrong));
        let key = |_: &()| {
            let mut key = input;
            kernel.parts().iter().for_each(|part| key.add(part.text));
            key.value()
        };
        let is_different = |(integrator, expected): (Integrator, &Vec<_>)| {
            seen_in_worlds(integrator, Some(kernel)).iter().map(bits).collect::<Vec<_>>() != *expected
        };
        let rejects = |_: &()| INTEGRATORS.into_iter().zip(&expected).any(is_different);
        !verdicts.rejects(&format!("{right} -> {wrong}"), std::iter::once(()), key, rejects)
    };
    let accepted: Vec<&str> = MISTAKES.iter().filter(accepted).map(|Mistake(_, wrong)| *wrong).collect();
    verdicts.finish();
    assert!(accepted.is_empty(), "no world reveals these mistakes: {accepted:?}");
}
