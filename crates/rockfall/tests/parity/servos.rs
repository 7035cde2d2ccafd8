//! Servos (docs/physics section 2.18): random bodies at random walls that follow servos, in groups of their own.

use glam::{DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::layout::{HISTORY_WORDS, LINK_KEY};
use rockfall::model::world::World;
use rockfall::step::schedule::{PLACE, Phase, Run};
use rockfall::{
    BroadPhase, ContactLaw, Cuboid, Integrator, Material, Motion, MotionTerm, Pair, Polygon, Precision, Rod, Scene, Servo,
    Sphere, Surface,
};

use crate::assert_scenario_matches;
use crate::decisions::Findings;
use crate::trace::{Scenario, Trace, with_step_settings};

/// The stages of servos, and what they move.
const CONCERNED: [&str; 3] = ["drive_servos", "move_walls", "servo_loads"];
/// Groups of bodies that touch each other.
const GROUPS: u16 = 90;
/// Period along each axis, of traces with periodic boundaries.
const PERIOD: f32 = 4.0;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// A plate, a shaft, and a motion between them.
fn motions() -> [Motion; 3] {
    let mut plate = Servo::force([3.0, -40.0, 5.0], 500.0);
    (plate.displacement, plate.velocity) = (0.013, 0.11);
    let mut shaft = Servo::torque(-9.0, [0.2, 0.3, -1.0], [0.1, -0.4, 0.2], 500.0);
    (shaft.displacement, shaft.velocity) = (-0.017, 0.13);
    let slide = MotionTerm::translation([0.0, 0.1, 0.0]);
    [Motion::servo("plate", plate), Motion::new("slide", slide), Motion::servo("shaft", shaft)]
}

fn scene(seed: u64, law: ContactLaw, rods: bool, periodic: bool) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    scene.settings.contact_law = law;
    scene.settings.collisions = false;
    // A square-root law that is not at its bound, so that the friction depends on it.
    scene.settings.friction = 3.0;
    let rubber = scene.add_material(Material::new("rubber").density(1.0).young(2e4).poisson(0.3)).unwrap();
    let mut pair = Pair::default().restitution(0.4).stiffness(900.0);
    if law != ContactLaw::Thesis {
        pair = pair.friction(0.4).rolling_friction(0.1);
    }
    scene.set_pair(rubber, rubber, pair).unwrap();
    let motions = motions().map(|motion| scene.add_motion(motion).unwrap());
    if periodic {
        scene.settings.precision = Precision::Double;
        (0..3).for_each(|axis| scene.set_periodic(axis, Some([-0.1, PERIOD - 0.1])).unwrap());
    }
    for group in 0..GROUPS {
        let motion = motions.get(usize::from(group % 4)).copied();
        let turn = Quat::from_scaled_axis(vector(&mut random, 0.4));
        for _ in 0..random.random_range(1..3) {
            let [x, z] = [turn * Vec3::X, turn * Vec3::Z].map(|edge| random.random_range(0.8..1.6) * edge);
            let corner = vector(&mut random, 0.1) - 0.45 * (x + z);
            if group % 3 == 0 {
                let down = -random.random_range(0.3..0.8) * (turn * Vec3::Y);
                let mut cuboid = Cuboid::new(corner, x, down, z).group(group).material(rubber);
                cuboid.motion = motion;
                scene.add_box(cuboid).unwrap();
            } else {
                let mut polygon = Polygon::new(corner, z, x).group(group).material(rubber);
                polygon.motion = motion;
                polygon.surface = if group % 3 == 1 { Surface::Triangle } else { Surface::Parallelogram };
                scene.add_polygon(polygon).unwrap();
            }
        }
        let radius = random.random_range(0.15..0.3);
        let way = if periodic { PERIOD * Vec3::new(f32::from(group % 3) - 1.0, 0.0, 1.0) } else { Vec3::ZERO };
        let place = vector(&mut random, 0.25) * Vec3::new(1.0, 0.0, 1.0) + random.random_range(0.7..0.9) * radius * Vec3::Y;
        let ball = Sphere::new(place + way, radius).mass(1.5).velocity(vector(&mut random, 0.2)).group(group).material(rubber);
        let ball = scene.add_sphere(ball.angular_momentum(vector(&mut random, 0.05))).unwrap();
        if rods && group % 6 == 0 {
            let beside = place + way + Vec3::new(0.9, -0.05, 0.2);
            let other = scene.add_sphere(Sphere::new(beside, 0.8 * radius).group(group).material(rubber)).unwrap();
            scene.add_rod(Rod::new(ball, other, 0.7 * radius).group(group).material(rubber)).unwrap();
        }
    }
    scene
}

/// Makes the springs of contacts longer than those of one step.
fn lengthen_springs(world: &mut World) {
    for record in world.histories.chunks_exact_mut(HISTORY_WORDS as usize) {
        if record[HISTORY_WORDS as usize - 1] & LINK_KEY == 0 {
            record[..3].iter_mut().for_each(|word| *word = (3.0 * f32::from_bits(*word)).to_bits());
        }
    }
}

/// Scenarios of the stages of servos in the second step of a scene.
pub(crate) fn trace(seed: u64, law: ContactLaw, integrator: Integrator, [rods, periodic]: [bool; 2]) -> Trace {
    let scene = scene(seed, law, rods, periodic);
    let mut world = World::build_in_space(&scene).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    let bodies = scene.motions().len();
    world.poses = vec![0.0; 7 * bodies * 32];
    (world.step.constants.pose_rows, world.step.constants.pose_step) = (7, world.status.steps);
    world.step.constants.dt = 1e-3;
    world.step.lists.margin_scale = 40.0;
    let phases = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::Grid));
    let runs: Vec<Run> = PLACE.iter().chain(phases).filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for step in 0..2 {
        for run in &runs {
            if step == 1 && CONCERNED.contains(&run.stage.name) {
                scenarios.push(Scenario { runs: vec![*run], before: world.clone() });
            }
            run.on_cpu(&mut world);
        }
        assert_eq!((world.status.rejected, world.status.steps), (0, step + 1), "seed {seed}");
        lengthen_springs(&mut world);
    }
    Trace { scenarios, findings: Findings::default(), after: world }
}

/// Compares the stages of a trace. Both servos must have loads.
fn check(seed: u64, law: ContactLaw, integrator: Integrator, kinds: [bool; 2]) {
    let trace = trace(seed, law, integrator, kinds);
    trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
    let movers = trace.after.movers() as usize;
    for (number, loads) in trace.after.servo_loads.chunks_exact(movers).enumerate() {
        let loaded = loads.iter().filter(|load| load.x != 0.0 && load.y > 0.0).count();
        assert!(loaded > 8, "seed {seed}, servo {number}: {loaded} bodies load it");
    }
    let servo = trace.after.servos[0];
    assert!(servo.z != 0.11 && servo.x > 0.013, "the plate has moved: {servo}");
}

#[test]
fn backends_agree_on_servos() {
    check(1, ContactLaw::Thesis, Integrator::Rk4, [false, false]);
    check(2, ContactLaw::HertzMindlin, Integrator::VelocityVerlet, [false, false]);
    check(3, ContactLaw::Linear, Integrator::SymplecticEuler, [true, false]);
    check(4, ContactLaw::Thesis, Integrator::VelocityVerlet, [true, true]);
}

/// The pose of a shaft after many turns.
#[test]
fn backends_agree_on_the_angle_of_a_shaft() {
    for angle in [0.7, 3.1, -40.0, 1234.5, 98_765.4_f64] {
        let mut scene = scene(5, ContactLaw::Thesis, false, false);
        let shaft = scene.find_motion("shaft").unwrap();
        scene.update_motion(shaft, |motion| motion.servo.as_mut().unwrap().displacement = angle).unwrap();
        let mut world = with_step_settings(World::build(&scene).unwrap());
        world.poses = vec![0.0; 3 * 3 * 32];
        (world.step.constants.pose_rows, world.step.constants.pose_step) = (3, world.status.steps);
        assert_scenario_matches(5, &Scenario { runs: vec![PLACE[0]], before: world.clone() });
        PLACE[0].on_cpu(&mut world);
        // The third row of R - 1 at the start, against the rotation in f64.
        let axis = DVec3::new(0.2, 0.3, -1.0).normalize();
        let turned = glam::DMat3::from_axis_angle(axis, angle).row(2) - DVec3::Z;
        let row = DVec3::from_array(std::array::from_fn(|k| f64::from(world.poses[2 * 32 + 8 + k])));
        assert!((row - turned).length() < 4e-7, "{angle}: {row} {turned}");
    }
}
