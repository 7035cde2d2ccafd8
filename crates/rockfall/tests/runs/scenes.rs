//! The scenes in `scenes/` behave as their descriptions say, at the default time step, at half and at a quarter of it.
//!
//! There is one test per scene. Overlaps of bodies at rest stay below 5 % of the smaller radius, so that the scenes
//! look right.

use std::path::Path;

use rockfall::generate::Kind;
use rockfall::glam::Vec3;
use rockfall::{Backend, Body, Integrator, Options, RigidBody, Scene, Simulation, SphereState};

const STEPS: [f32; 3] = [0.02, 0.01, 0.005];

fn load(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name).with_extension("txt");
    Scene::load(path).expect("a valid scene").scene
}

fn open(scene: Scene, integrator: Integrator) -> Simulation {
    let options = Options::new().backend(Backend::Cpu).integrator(integrator);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// Opens the scene once for each time step.
fn opened(name: &str) -> impl Iterator<Item = (f32, Simulation)> {
    STEPS.into_iter().map(move |dt| (dt, open(load(name), Integrator::Rk4)))
}

/// Runs for a number of seconds and returns the spheres.
fn after(simulation: &mut Simulation, seconds: f32, dt: f32) -> Vec<SphereState> {
    simulation.run((seconds / dt).round() as u64, dt).expect("steps");
    assert_eq!(simulation.report().non_finite, 0, "every state must stay finite");
    simulation.spheres().expect("spheres are read back")
}

/// The deepest overlap relative to the smaller radius. It is the smallest of several samples, because bodies that still
/// vibrate are not at rest.
fn resting_overlap(simulation: &mut Simulation, dt: f32) -> f32 {
    let deepest = |simulation: &mut Simulation| {
        let contacts = simulation.contacts().expect("contacts");
        let scene = simulation.scene();
        let radius = |body: Body| match body {
            Body::Sphere(id) => scene.sphere(id).expect("a sphere").radius,
            Body::Rod(id) => scene.rod(id).expect("a rod").radius,
            _ => f32::INFINITY,
        };
        let part = |contact: &rockfall::Contact| contact.overlap / radius(contact.a).min(radius(contact.b));
        contacts.iter().map(part).fold(0.0, f32::max)
    };
    let mut least = f32::INFINITY;
    for _ in 0..20 {
        simulation.run(7, dt).expect("steps");
        least = least.min(deepest(simulation));
    }
    least
}

/// The largest relative error of the length of a rod.
fn stretch(simulation: &mut Simulation) -> f32 {
    let scene = simulation.sync().expect("the scene is read back");
    let place = |id| scene.sphere(id).expect("a sphere").position;
    let error =
        |rod: &rockfall::Rod| rod.length.map_or(0.0, |length| (place(rod.end1).distance(place(rod.end2)) / length - 1.0).abs());
    scene.rods().iter().map(error).fold(0.0, f32::max)
}

/// The last ball swings as far as the first one started, and the three balls between them hardly move.
#[test]
fn the_cradle_passes_the_swing_to_the_last_ball() {
    for (dt, mut simulation) in opened("cradle") {
        let mut highest = 0.0_f32;
        let mut between = 0.0_f32;
        for _ in 0..10 {
            let spheres = after(&mut simulation, 0.2, dt);
            highest = highest.max(spheres[9].position.y);
            for ball in 6..9 {
                between = between.max((spheres[ball].position.x - spheres[ball - 5].position.x).abs());
            }
        }
        // The first ball starts 0.5425 above its lowest position at 1.
        assert!(highest > 1.46 && highest < 1.56, "dt {dt}: the last ball rises to {highest}");
        assert!(between < 0.2, "dt {dt}: a ball between moves by {between}");
    }
}

/// Every rod keeps its length while the bridge sags and sways.
#[test]
fn the_bridge_keeps_its_lengths_and_holds() {
    for (dt, mut simulation) in opened("bridge") {
        for _ in 0..20 {
            let spheres = after(&mut simulation, 2.0, dt);
            assert!(stretch(&mut simulation) < 1e-3, "dt {dt}: {}", stretch(&mut simulation));
            let lowest = spheres[..18].iter().map(|sphere| sphere.position.y).fold(f32::INFINITY, f32::min);
            assert!(lowest > 2.0, "dt {dt}: the bridge sags to {lowest}");
        }
        let overlap = resting_overlap(&mut simulation, dt);
        assert!(overlap < 0.05, "dt {dt}: overlap {overlap} of a radius");
    }
}

/// The tower stands until the ball hits its middle. Then all of it falls.
#[test]
fn the_tower_of_capsules_stands_until_the_ball_hits_it() {
    for (dt, mut simulation) in opened("capsules") {
        let tops = |spheres: &[SphereState]| {
            spheres.iter().filter(|sphere| sphere.radius < 0.3).map(|sphere| sphere.position.y).fold(0.0, f32::max)
        };
        let before = tops(&after(&mut simulation, 0.0, dt));
        let standing = tops(&after(&mut simulation, 1.1, dt));
        assert!(standing > before - 0.1, "dt {dt}: the height of the tower falls from {before} to {standing}");
        let overlap = resting_overlap(&mut open(without_ball(), Integrator::Rk4), dt);
        assert!(overlap < 0.05, "dt {dt}: overlap {overlap} of a radius");
        // A capsule may roll up another one before it comes to rest.
        let fallen = tops(&after(&mut simulation, 30.0, dt));
        assert!(fallen < 1.0, "dt {dt}: after the hit the top is at {fallen}");
    }
}

/// The tower without the ball.
fn without_ball() -> Scene {
    let mut scene = load("capsules");
    let ball = scene.sphere_ids().find(|id| scene.sphere(*id).is_ok_and(|sphere| sphere.radius > 0.3)).expect("the ball");
    scene.remove_sphere(ball).expect("the ball is removed");
    scene
}

/// All balls move down the slope, along the rollers and into the bin.
#[test]
fn the_conveyor_carries_all_balls_into_the_bin() {
    for (dt, mut simulation) in opened("conveyor") {
        let spheres = after(&mut simulation, 40.0, dt);
        let in_bin = |sphere: &&SphereState| {
            sphere.position.x > 10.8 && sphere.position.x < 14.0 && sphere.position.y < 0.0 && sphere.position.y > -4.0
        };
        let moving = spheres.iter().filter(|sphere| !sphere.fixed);
        let (all, carried) = (moving.clone().count(), moving.filter(in_bin).count());
        assert_eq!(carried, all, "dt {dt}: number of balls in the bin");
        let overlap = resting_overlap(&mut simulation, dt);
        assert!(overlap < 0.05, "dt {dt}: overlap {overlap} of a radius");
    }
}

/// The cube falls on the floor, rebounds, and finally comes to rest there.
#[test]
fn the_soft_cube_rebounds_and_comes_to_rest() {
    for (dt, mut simulation) in opened("soft-cube") {
        let middle =
            |spheres: &[SphereState]| spheres.iter().map(|sphere| sphere.position).sum::<Vec3>() / spheres.len() as f32;
        let start = middle(&simulation.spheres().expect("spheres"));
        let (mut lowest, mut rebound) = (f32::INFINITY, 0.0_f32);
        for _ in 0..60 {
            let spheres = after(&mut simulation, 0.1, dt);
            let height = middle(&spheres).y;
            lowest = lowest.min(height);
            rebound = rebound.max(height - lowest);
        }
        assert!(
            lowest < start.y - 0.1 && rebound > 0.02,
            "dt {dt}: the cube falls from {} to {lowest} and rebounds by {rebound}",
            start.y
        );
        let spheres = after(&mut simulation, 54.0, dt);
        assert!(middle(&spheres).y < 1.2, "dt {dt}: the cube lies at {}", middle(&spheres));
        let fastest = spheres.iter().map(|sphere| sphere.velocity.length()).fold(0.0, f32::max);
        assert!(fastest < 0.2, "dt {dt}: the cube still moves at {fastest}");
        let overlap = resting_overlap(&mut simulation, dt);
        assert!(overlap < 0.05, "dt {dt}: overlap {overlap} of a radius");
    }
}

/// The rocks fall down the stair, and the boulders knock the pins over.
#[test]
fn the_rockfall_knocks_the_pins_over() {
    for (dt, mut simulation) in opened("rockfall") {
        after(&mut simulation, 20.0, dt);
        let scene = simulation.sync().expect("the scene is read back").clone();
        let fallen = scene.capsules().iter().filter(|pin| {
            let [one, two] = [pin.end1, pin.end2].map(|id| scene.sphere(id).expect("an end").position);
            // The ends of a pin are 0.78 apart. Pins that have left the yard lie lower.
            (two.y - one.y).abs() < 0.4 || one.y < -1.0
        });
        assert!(fallen.count() >= 8, "dt {dt}: most of the ten pins must have fallen");
        let down = scene.spheres().iter().filter(|sphere| sphere.position.y < 1.0 && sphere.position.x > 2.3);
        assert!(down.count() > scene.spheres().len() / 2, "dt {dt}: most rocks must have reached the yard");
        let overlap = resting_overlap(&mut simulation, dt);
        assert!(overlap < 0.05, "dt {dt}: overlap {overlap} of a radius");
    }
}

/// The parts of the bodies that have turned away from the vertical by 26 degrees.
fn fallen(simulation: &mut Simulation) -> usize {
    let scene = simulation.sync().expect("the state");
    let up = |body: &RigidBody| (body.orientation * Vec3::Y).y;
    scene.bodies().iter().filter(|body| up(body) < 0.9).count()
}

/// Every domino stands still until the one before it hits it. All of them fall and overlap little.
#[test]
fn all_dominoes_fall() {
    let scene = load("dominoes");
    assert_eq!(scene.bodies().len(), 36);
    for dt in [1.0 / 60.0, 1.0 / 120.0] {
        let mut simulation = open(scene.clone(), Integrator::Rk4);
        let mut fallen_at = |time: f32| {
            simulation.run((time / dt) as u64, dt).expect("frames");
            fallen(&mut simulation)
        };
        assert_eq!(fallen_at(0.3), 0, "dt {dt}: before the ball");
        let half = fallen_at(2.2);
        assert!((8..28).contains(&half), "dt {dt}: half of them, {half}");
        assert_eq!(fallen_at(4.0), 36, "dt {dt}");
        let overlap = simulation.report().max_overlap;
        assert!(overlap < 0.005, "dt {dt}: overlap {overlap}");
    }
}

/// What is built of bricks and of cards stands still without the ball, which is the last sphere, and falls with it.
#[test]
fn what_is_built_stands_until_the_ball_hits_it() {
    for (name, seconds) in [("tower", 4.0), ("cards", 4.0)] {
        for dt in [1.0 / 60.0, 1.0 / 120.0] {
            let mut scene = load(name);
            let mut whole = open(scene.clone(), Integrator::Rk4);
            whole.run((seconds / dt) as u64, dt).expect("frames");
            let start: Vec<Vec3> = scene.bodies().iter().map(|body| body.position).collect();
            let ways = |simulation: &mut Simulation| -> Vec<f32> {
                let end = simulation.sync().expect("the state").bodies();
                start.iter().zip(end).map(|(start, body)| start.distance(body.position)).collect()
            };
            // A brick may land flat.
            let thrown = ways(&mut whole).iter().filter(|way| **way > 0.3).count();
            assert!(thrown > 5, "{name}, dt {dt}: the ball moves {thrown}");
            let ball = scene.sphere_ids().last().expect("a ball");
            scene.remove_spheres(&[ball]).expect("it is removed");
            let mut still = open(scene, Integrator::Rk4);
            still.run((seconds / dt) as u64, dt).expect("frames");
            let moved = ways(&mut still).into_iter().fold(0.0_f32, f32::max);
            assert!(moved < 2e-3, "{name}, dt {dt}: moved by {moved}");
        }
    }
}

/// The examples of the thesis run. In the second one, references that are used again refer to the last sphere.
#[test]
fn the_examples_of_the_thesis_run() {
    for name in ["thesis-example", "thesis-example-reused"] {
        for (dt, mut simulation) in opened(name) {
            let spheres = after(&mut simulation, 5.0, dt);
            assert!(spheres.iter().all(|sphere| sphere.position.is_finite()), "{name}, dt {dt}");
        }
    }
}

/// In generated scenes a single body at rest overlaps by less than 5 % of its radius. A contact in a pile bears the
/// weight of several bodies: 8 % in piles of 200 spheres (11 % of the radius of a rod below blobs), and more in higher
/// ones.
#[test]
fn generated_scenes_have_small_overlaps() {
    // Grains and boxes have constants and a time step of their own.
    for kind in Kind::ALL.into_iter().filter(|kind| kind.time_step() == 0.02) {
        let scene = kind.generate(200, 1).expect("a scene");
        let least =
            scene.spheres().iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.radius).fold(f32::INFINITY, f32::min);
        let overlap = scene.settings.gravity / scene.settings.contact_force / least;
        assert!(overlap < 0.05, "{kind}: overlap {overlap} of a radius");
        assert!(0.02 * 0.02 * scene.settings.contact_force <= 0.5, "{kind}: too stiff for piles");
        let mut simulation = open(scene, Integrator::Rk4);
        after(&mut simulation, 10.0, 0.02);
        let overlap = resting_overlap(&mut simulation, 0.02);
        assert!(overlap < 0.15, "{kind}: overlap {overlap} of a radius in a pile");
    }
}

/// No scene in `scenes/` is too stiff for the default time step.
#[test]
fn no_scene_is_too_stiff_for_the_default_time_step() {
    for name in ["cradle", "bridge", "capsules", "conveyor", "soft-cube", "rockfall"] {
        let stiffness = load(name).settings.contact_force;
        assert!(0.02 * 0.02 * stiffness <= 0.5, "{name}: contact_force {stiffness}");
    }
}

/// The silo fills, and grains leave it by the belt.
#[test]
fn the_silo_is_fed_and_drained() {
    let scene = load("silo");
    let (dt, integrator) = (scene.run.dt.expect("a time step"), scene.run.integrator.expect("an integrator"));
    assert_eq!(scene.check_contact_law(scene.integrator(integrator)).map_err(|error| error.to_string()), Ok(()));
    assert_eq!((scene.counts().spheres, scene.inlet_concerns()), (0, Vec::<String>::new()));
    let options = Options::new().backend(Backend::Cpu).integrator(integrator);
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    simulation.run(16_000, dt).expect("steps");
    let flow = simulation.flow();
    assert_eq!(flow.inlets[0].mass - flow.outlets[0].mass, flow.mass, "{flow:?}");
    assert!(flow.inlets[0].waiting < 10 && flow.outlets[0].spheres > 20, "{flow:?}");
    // Nothing leaks through the walls: grains are in the silo, on the belt or right of it.
    let states = simulation.spheres().expect("states");
    let is_inside =
        |state: &&SphereState| state.position.y < 0.0 || state.position.x.abs() < 0.41 && state.position.z.abs() < 0.1;
    assert_eq!(states.iter().filter(|state| !is_inside(state)).count(), 0);
}
