//! Warnings of `Scene::stability` and related functions against runs: the bounds hold, and beyond them the predicted
//! effect occurs. These tests use the CPU backend only, because the other backend computes the same steps.

use rockfall::generate::Kind;
use rockfall::stability::{Effect, Stiff, Warning};
use rockfall::{Backend, Cuboid, Integrator, Options, Polygon, Scene, Simulation, Sphere};

// Velocity Verlet has the bounds of symplectic Euler. Whether a pile with impulses comes to rest up to them with velocity Verlet is an
// open question of docs/physics.
const INTEGRATORS: [Integrator; 2] = [Integrator::Rk4, Integrator::SymplecticEuler];

/// Spheres that fall into a box, with a damping ratio. With this gravity they rest with an overlap of 4.7 % of the
/// smallest radius, just below the limit of the warning.
fn pile(damping_ratio: f32) -> Scene {
    let mut scene = Kind::Pile.generate(300, 1).unwrap();
    scene.settings.gravity = 7.0;
    scene.settings.contact_damping = 2.0 * damping_ratio * scene.settings.contact_force.sqrt();
    scene
}

/// The smallest time step for which there is a warning, or one of `Effect::Unstable` if `unstable` is set. Found by
/// bisection.
fn least_dt(scene: &Scene, integrator: Integrator, unstable: bool) -> f32 {
    let has = |dt: f32| {
        let warnings = scene.stability(dt, integrator);
        warnings.iter().any(|warning| !unstable || warning.effect == Effect::Unstable)
    };
    let (mut without, mut with) = (1e-4_f32, 1.0);
    assert!(!has(without) && has(with));
    for _ in 0..40 {
        let middle = 0.5 * (without + with);
        if has(middle) { with = middle } else { without = middle }
    }
    with
}

/// Result of a run of a pile.
#[derive(Debug)]
struct Outcome {
    /// Mean kinetic energy during the last fifth, divided by the kinetic energy after one step of free fall.
    shaking: f64,
    /// Energy at the end divided by that at the start.
    energy: f64,
}

fn run(scene: Scene, integrator: Integrator, dt: f32) -> Outcome {
    const SECONDS: f32 = 25.0;
    let mass: f64 = scene.spheres().iter().map(|sphere| f64::from(sphere.mass)).sum();
    let step_energy = 0.5 * mass * f64::from(scene.settings.gravity * dt).powi(2);
    let options = Options::new().backend(Backend::Cpu).integrator(integrator).keep_going(true);
    let mut simulation = Simulation::with_options(scene, options).unwrap();
    let start = simulation.energy().unwrap().total();
    let steps = (SECONDS / dt) as u64;
    simulation.run(steps * 4 / 5, dt).unwrap();
    let mut kinetic = 0.0;
    for _ in 0..20 {
        simulation.run(steps / 100, dt).unwrap();
        kinetic += simulation.energy().unwrap().kinetic / 20.0;
    }
    Outcome { shaking: kinetic / step_energy, energy: simulation.energy().unwrap().total() / start }
}

/// Damping ratios: almost none, and that of the default constants.
const DAMPINGS: [f32; 2] = [0.05, 0.2];

#[test]
fn a_pile_comes_to_rest_up_to_the_bound() {
    for integrator in INTEGRATORS {
        for damping in DAMPINGS {
            let scene = pile(damping);
            let bound = least_dt(&scene, integrator, false);
            for share in [0.5, 0.99] {
                let outcome = run(scene.clone(), integrator, share * bound);
                // Kinetic energy is that of v + a h/2, where a leaves out contacts (docs/physics section 5.2).
                let at_rest = if integrator == Integrator::SymplecticEuler { 0.25 } else { 0.0 };
                let shaking = outcome.shaking - at_rest;
                assert!(shaking.abs() < 0.1, "{integrator}, damping {damping}, {share} of the bound: {outcome:?}");
            }
        }
    }
}

#[test]
fn a_pile_shakes_within_a_factor_of_the_bound() {
    for (integrator, factor) in [(Integrator::Rk4, 2.7), (Integrator::SymplecticEuler, 1.8)] {
        for damping in DAMPINGS {
            let scene = pile(damping);
            let dt = factor * least_dt(&scene, integrator, false);
            let outcome = run(scene, integrator, dt);
            assert!(outcome.shaking > 0.1, "{integrator}, damping {damping}: {outcome:?}");
        }
    }
}

#[test]
fn a_pile_explodes_within_twice_the_bound() {
    for integrator in INTEGRATORS {
        for damping in DAMPINGS {
            let scene = pile(damping);
            let dt = 2.0 * least_dt(&scene, integrator, true);
            let outcome = run(scene, integrator, dt);
            assert!(outcome.energy > 2.0, "{integrator}, damping {damping}: {outcome:?}");
        }
    }
}

/// The deepest overlap of two spheres, or of one with the floor y = 0, divided by the smaller radius.
fn deepest(scene: &Scene) -> f32 {
    let spheres = scene.spheres();
    let of_sphere = |(index, one): (usize, &Sphere)| {
        let pairs = spheres[index + 1..].iter().map(|other| {
            let overlap = one.radius + other.radius - one.position.distance(other.position);
            overlap / one.radius.min(other.radius)
        });
        pairs.fold(1.0 - one.position.y / one.radius, f32::max)
    };
    spheres.iter().enumerate().map(of_sphere).fold(0.0, f32::max)
}

/// Two piles, and a column of twenty balls in a shaft.
fn deep_scenes() -> [Scene; 3] {
    let mut column = Scene::new();
    for ball in 0..20_u8 {
        column.add_sphere(Sphere::new([0.001 * f32::from(ball % 3), 0.2 + 0.41 * f32::from(ball), 0.0], 0.2)).unwrap();
    }
    for (min, max) in [
        ([-3.0, -1.0, -3.0], [3.0, 0.0, 3.0]),
        ([-1.2, 0.0, -1.0], [-0.205, 9.0, 1.0]),
        ([0.205, 0.0, -1.0], [1.2, 9.0, 1.0]),
        ([-0.205, 0.0, -1.2], [0.205, 9.0, -0.205]),
        ([-0.205, 0.0, 0.205], [0.205, 9.0, 1.2]),
    ] {
        column.add_box(Cuboid::between(min, max)).unwrap();
    }
    [Kind::Pile.generate(20, 2).unwrap(), Kind::Pile.generate(300, 2).unwrap(), column]
}

#[test]
fn overlaps_at_rest_stay_below_the_requested_value() {
    for (index, mut scene) in deep_scenes().into_iter().enumerate() {
        for share in [0.02, 0.1] {
            scene.settings.gravity = 10.0;
            scene.settings.resting_overlap = share;
            let (integrator, dt) = (Integrator::Rk4, 0.02);
            let parts = scene.substeps_for(dt, integrator);
            let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(Backend::Cpu)).unwrap();
            assert_eq!(simulation.settings(), &scene.resolved_settings());
            simulation.run(1000 * u64::from(parts), dt / parts as f32).unwrap();
            let kinetic = simulation.energy().unwrap().kinetic;
            let deepest = deepest(simulation.sync().unwrap()) / share;
            assert!(kinetic < 1.0 && (0.1..1.0).contains(&deepest), "scene {index}, {share}: {deepest}, kinetic {kinetic}");
        }
    }
}

#[test]
fn constants_are_chosen_at_the_start_and_when_settings_change() {
    let [_, mut scene, _] = deep_scenes();
    scene.settings.resting_overlap = 0.02;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
    let first = *simulation.settings();
    simulation.run(50, 0.01).unwrap();
    simulation.add_sphere(Sphere::new([0.0, 9.0, 0.0], 0.01)).unwrap();
    simulation.run(50, 0.01).unwrap();
    assert_eq!(*simulation.settings(), first, "motion and another sphere must not change them");
    let mut resumed = Simulation::resume(simulation.checkpoint().unwrap()).unwrap();
    assert_eq!(*resumed.settings(), first, "resuming must not change them");
    resumed.set_settings(first.with(|settings| settings.friction = 7.0)).unwrap();
    assert_eq!(resumed.settings().contact_force, first.contact_force);
    resumed.set_settings(first.with(|settings| settings.gravity = 2.0)).unwrap();
    assert!(resumed.settings().contact_force > 1.5 * first.contact_force);
}

/// Whether an object at y = 0 stops a ball that falls on it without gravity, wherever the first step of the ball ends.
fn is_caught(scene: &Scene, ball: &Sphere, dt: f32) -> bool {
    let distance = ball.velocity.length() * dt;
    (0..40_u8).all(|phase| {
        let mut scene = scene.clone();
        let up = distance * (1.0 + f32::from(phase) / 40.0) + ball.radius * 2.0;
        let mut ball = *ball;
        ball.position = [0.0, up, 0.0].into();
        let id = scene.add_sphere(ball).unwrap();
        let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap();
        simulation.run(20, dt).unwrap();
        simulation.sphere(id).unwrap().velocity.y > 0.0
    })
}

#[test]
fn balls_pass_through_thin_objects_only_beyond_the_bound() {
    let mut scenes = [0; 3].map(|_| Scene::new());
    scenes[0].add_box(Cuboid::between([-5.0, -0.1, -5.0], [5.0, 0.0, 5.0])).unwrap();
    scenes[1].add_polygon(Polygon::new([-5.0, 0.0, -5.0], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0])).unwrap();
    scenes[2].add_sphere(Sphere::new([0.0, -0.2, 0.0], 0.2).fixed()).unwrap();
    for (index, mut scene) in scenes.into_iter().enumerate() {
        scene.settings.gravity = 0.0;
        let ball = Sphere::new([0.0, 1.0, 0.0], 0.2).velocity([0.0, -10.0, 0.0]);
        let mut whole = scene.clone();
        whole.add_sphere(ball).unwrap();
        let tunnelling = whole.tunnelling(1.0).unwrap();
        let bound = tunnelling.largest_dt as f32;
        assert!(is_caught(&scene, &ball, 0.98 * bound), "scene {index}: {tunnelling}");
        assert!(!is_caught(&scene, &ball, 1.1 * bound), "scene {index}: {tunnelling}");
    }
}

/// Necks of JKR cohesion that are long, or that oscillate faster than the time step resolves.
#[test]
fn necks_that_are_long_or_fast_are_reported() {
    let concerns = |gamma: f32, dt: f32| {
        let text = format!(
            "set contact_law hertz-mindlin\nset gravity 0\n@material m density=1 young=1e5 poisson=0.25\n\
             @pair m m surface_energy={gamma} cohesion=jkr friction=0\n@use m\nS 1  0 0 0  0 0 0  0 0 0  - 0.5\nS 2  2 0 0  0 0 0  0 0 0  - 0.3\n"
        );
        let scene = Scene::parse(&text, std::path::Path::new("a.txt")).expect("a scene").scene;
        scene.concerns(dt, Integrator::SymplecticEuler)
    };
    // E* = 53,333. k³ = pi gamma / (4 E*), and the tear is 3 k² r^(1/3) / r = 0.0145 radii for gamma = 20.
    assert_eq!(concerns(20.0, 1e-5), Vec::<String>::new());
    // 100 times the surface energy, 100^(2/3) = 21.5 times the distance.
    let long = concerns(2000.0, 1e-5);
    assert!(long.len() == 1 && long[0].contains("tear at a distance of up to 63.8 % of the smallest radius"), "{long:?}");
    // pi sqrt(m / 2 / (1.2 E* a)) with m = 0.1131, a = k (r / 2)^(2/3) 6^(2/3): 0.0119 s for gamma = 20.
    let fast = concerns(20.0, 7.5e-4);
    let neck = fast.iter().find(|text| text.contains("half a period")).expect("a warning");
    assert!(neck.contains("of sphere 2 oscillates") && neck.contains("at most 0.00059"), "{fast:?}");
    assert!(concerns(0.0, 7.5e-4).iter().all(|text| !text.contains("jkr")));
}

/// The law of the thesis has neither rolling resistance nor cohesion. A scene that asks for them is told so.
#[test]
fn properties_that_the_law_does_not_use_are_reported() {
    let pair = "@material m young=1e5 poisson=0.2\n@pair m m stiffness=1e3 rolling_friction=0.1 surface_energy=2\n";
    let concerns = |text: &str| {
        let scene = Scene::parse(&(text.to_owned() + pair), std::path::Path::new("a.txt")).expect("a scene").scene;
        scene.concerns(1e-3, Integrator::SymplecticEuler)
    };
    let found = concerns("");
    assert!(found.iter().any(|text| text.contains("rolling_friction, surface_energy of pairs has no effect")), "{found:?}");
    assert_eq!(concerns("set contact_law linear\n"), Vec::<String>::new());
}

/// A chain of fixed lengths, let go level, keeps its energy in the first swing at the step that `stability` asks for, and gains more
/// than all of it at five times this step. A pendulum of one rod and a chain that nothing holds have no bound.
#[test]
fn a_chain_keeps_its_energy_at_the_step_of_the_warning() {
    let chain = |links: u32, last: f32, held: u8| {
        let mut text = format!("set gravity 9.81\nset collisions off\nS 0 0 0 0 0 0 0 0 0 0 1 0.01 {held}\n");
        for link in 1..=links {
            let mass = if link == links { last } else { 1.0 };
            let x = 0.2 * f64::from(link);
            text += &format!("S {link} {x} 0 0 0 0 0 0 0 0 {mass} 0.01\nR {} {link} 0.004 0.2\n", link - 1);
        }
        Scene::parse(&text, std::path::Path::new("a.txt")).unwrap().scene
    };
    for (links, last) in [(5, 10.0), (20, 1.0), (20, 100.0)] {
        let scene = chain(links, last, 1);
        let warnings = scene.stability(0.02, Integrator::VelocityVerlet);
        let [Warning { what: Stiff::Chain(_), largest_dt, .. }] = warnings[..] else { panic!("{warnings:?}") };
        // The rod at the support carries all, and the next one all but its own mass. Both pull at the first sphere.
        let mass = f64::from(links) - 1.0 + f64::from(last);
        let stiffness = 2.0 * 3.0 * 9.81 * (2.0 * mass - 1.0) / 0.2;
        assert!((largest_dt * stiffness.sqrt() - 0.4).abs() < 1e-4, "{warnings:?}");
        let weight = 9.81 * 0.2 * (f64::from(links * (links - 1)) / 2.0 + f64::from(last) * f64::from(links));
        let gain = |dt: f64, integrator: Integrator| {
            let options = Options::new().backend(Backend::Cpu).integrator(integrator).keep_going(true);
            let mut simulation = Simulation::with_options(scene.clone(), options).unwrap();
            let mut most = f64::NEG_INFINITY;
            for _ in 0..(2.0 / dt) as u32 {
                simulation.run(1, dt as f32).unwrap();
                most = most.max(simulation.energy().unwrap().total());
            }
            most / weight
        };
        for integrator in [Integrator::Rk4, Integrator::VelocityVerlet] {
            assert!(gain(0.99 * largest_dt, integrator) < 0.01, "{links} {last} {integrator}");
        }
        assert!(gain(5.0 * largest_dt, Integrator::VelocityVerlet) > 1.0, "{links} {last}");
    }
    assert_eq!(chain(1, 100.0, 1).stability(0.02, Integrator::Rk4), []);
    assert_eq!(chain(5, 100.0, 0).stability(0.02, Integrator::Rk4), []);
}

/// A ball of mass 1 at 5 units/s is stopped by a wall if the contact is as stiff as `deep_impact` asks for, and passes it if
/// the contact is a tenth softer. The depth of an elastic impact is 5 sqrt(1 / 1000) = 0.158 with the first two laws, and with
/// E* = 15,000 it is (15 * 25 / (16 * 15000 sqrt(0.1)))^0.4 = 0.1195.
#[test]
fn a_wall_holds_what_the_depth_of_an_impact_says() {
    type Law = fn(f64) -> String;
    let thesis: Law =
        |stiff| format!("set collisions off\nset contact_damping 0\nset friction 0\nset contact_force {}\n", 1e3 * stiff);
    let linear: Law = |stiff| {
        format!(
            "set contact_law linear\n@material m density=1\n@pair m m stiffness={} restitution=1 friction=0\n@use m\n",
            1e3 * stiff
        )
    };
    let hertz: Law = |stiff| {
        format!(
            "set contact_law hertz-mindlin\n@material m young={} poisson=0\n@pair m m restitution=1 friction=0\n@use m\n",
            3e4 * stiff
        )
    };
    let scene = |text: &str| Scene::parse(text, std::path::Path::new("a.txt")).unwrap().scene;
    for (law, depth) in [(thesis, 0.158_11), (linear, 0.158_11), (hertz, 0.119_5)] {
        for (wall, limit) in [
            ("P -1 0 -1 0 0 2 2 0 0", 0.1),
            ("@triangle -9 0 -9 18 0 0 9 0 18", 0.1),
            ("B -1 -0.02 -1 2 0 0 0 0.02 0 0 0 2", 0.11),
        ] {
            let with = |stiff: f64| scene(&format!("set gravity 0\n{}{wall}\nS 1 0 0.3 0 0 -5 0 0 0 0 1 0.1\n", law(stiff)));
            let impact = with(1.0).deep_impact().expect("a warning");
            assert!((impact.depth / depth - 1.0).abs() < 1e-3 && (impact.limit - limit).abs() < 1e-6, "{impact:?}");
            assert_eq!(with(1.001 * impact.factor).deep_impact(), None, "{wall}");
            let stays = |stiff: f64| {
                let options = Options::new().backend(Backend::Cpu).integrator(Integrator::VelocityVerlet);
                let mut simulation = Simulation::with_options(with(stiff), options).unwrap();
                simulation.run(3000, 1e-4).unwrap();
                simulation.sync().unwrap().spheres()[0].position.y > 0.0
            };
            assert!(stays(1.02 * impact.factor) && !stays(0.9 * impact.factor), "{wall}: {impact:?}");
        }
    }
    // Impulses stop a body whatever the contact force is.
    assert_eq!(scene("set gravity 0\nP -1 0 -1 0 0 2 2 0 0\nS 1 0 0.3 0 0 -50 0 0 0 0 1 0.1\n").deep_impact(), None);
}

/// Constants that have no effect are named with the reason.
#[test]
fn constants_without_effect_are_named() {
    let idle = |text: &str| {
        let scene = Scene::parse(text, std::path::Path::new("a.txt")).unwrap().scene;
        scene.idle_settings().into_iter().map(|(name, reason)| format!("{name}: {reason}")).collect::<Vec<_>>()
    };
    let law = "set contact_law linear\nset continuous_collisions on\nset friction 3\nset restitution 0.1\nset mesh_angle 5\n";
    assert_eq!(
        idle(law),
        [
            "continuous_collisions: collisions are off, because contact law linear computes the whole impact",
            "friction: contact law linear does not use it",
            "mesh_angle: the scene has no triangles"
        ]
    );
    assert_eq!(
        idle(&format!("{law}set collisions on\n@triangle 0 0 0 1 0 0 0 0 1\n")),
        ["friction: contact law linear does not use it"]
    );
    let thesis = "set gravity 0\nset collisions off\nset restitution 0.5\nset contact_force 5\n\
                  set resting_overlap 0.1\nset friction 2\n";
    assert_eq!(idle(thesis), ["restitution: collisions are off", "resting_overlap: gravity is 0"]);
    assert_eq!(idle("set coulomb_friction 0.5\nset friction 2\n"), ["friction: coulomb_friction takes its place"]);
    assert_eq!(idle("set coulomb_friction 0.5\nset restitution 0.5\nset continuous_collisions on\n"), Vec::<String>::new());
}
