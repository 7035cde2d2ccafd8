//! The machines in `scenes/` do what they are made for.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use rockfall::glam::{DVec2, Vec3};
use rockfall::{Backend, JointReading, Options, RigidBody, RigidBodyId, Scene, Simulation};

const DT: f32 = 1.0 / 60.0;
const G: f64 = 9.81;

/// A scene of the project on the CPU.
fn opened(name: &str) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name).with_extension("txt");
    let scene = Scene::load(path).expect("a valid scene").scene;
    Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("the simulation opens")
}

fn named(scene: &Scene, name: &str) -> RigidBodyId {
    let mut ids = scene.body_ids();
    let is_it = |id: &RigidBodyId| scene.tag(*id).unwrap().and_then(|tag| tag.name.as_deref()) == Some(name);
    ids.find(is_it).unwrap_or_else(|| panic!("no body {name}"))
}

fn body<'a>(scene: &'a Scene, name: &str) -> &'a RigidBody {
    scene.body(named(scene, name)).expect("a body")
}

/// What the joint of a name does.
fn joint(simulation: &mut Simulation, name: &str) -> JointReading {
    let place = simulation.scene().joints().iter().position(|joint| joint.name.as_deref() == Some(name));
    simulation.joints().expect("joints")[place.expect("a joint of this name")]
}

/// The complete elliptic integral of the first kind, by the arithmetic-geometric mean.
fn elliptic(modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - modulus * modulus).sqrt());
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// The clock ticks by contacts alone. Its period is that of the pendulum, and the wheel turns by a tooth in each.
#[test]
fn the_escapement_keeps_the_period_of_its_pendulum() {
    let mut simulation = opened("escapement");
    let scene = simulation.scene();
    let pendulum = body(scene, "pendulum");
    let mass = scene.shape(pendulum.shape).unwrap().mass_properties_of().unwrap();
    let pivot = scene.joint_anchors(scene.joint_named("pendulum").unwrap()).unwrap()[0];
    let arm = DVec2::new(pendulum.centre()[0], pendulum.centre()[1]) - DVec2::new(pivot.x.into(), pivot.y.into());
    let about = mass.inertia[2] + mass.mass * arm.length_squared();

    simulation.run(600, DT).unwrap();
    // Its own angle is 0 where it begins, turned by 5 degrees.
    let angle = |simulation: &mut Simulation| f64::from(joint(simulation, "pendulum").position) + 5.0_f64.to_radians();
    let (mut passages, mut greatest, mut least) = (Vec::new(), 0.0_f64, f64::INFINITY);
    let mut turned = 0.0;
    let (mut before, mut wheel) = (angle(&mut simulation), f64::from(joint(&mut simulation, "wheel").position));
    for frame in 0..60 * 60 {
        simulation.run(1, DT).unwrap();
        let now = angle(&mut simulation);
        (greatest, least) = (greatest.max(now), least.min(now));
        let next = f64::from(joint(&mut simulation, "wheel").position);
        if before < 0.0 && now >= 0.0 {
            passages.push((f64::from(frame) - now / (now - before), turned));
        }
        turned += next - wheel - TAU * ((next - wheel) / TAU).round();
        (before, wheel) = (now, next);
    }
    let beats = passages.len() - 1;
    let [first, last] = [passages[0], passages[beats]];
    let period = f64::from(DT) * (last.0 - first.0) / beats as f64;
    let wanted = 4.0 * elliptic((0.25 * (greatest - least)).sin()) * (about / (mass.mass * G * arm.length())).sqrt();
    let teeth = (last.1 - first.1) / (TAU / 30.0) / beats as f64;
    eprintln!(
        "{beats} periods of {period} s, {wanted} s by the elliptic integral for {least} to {greatest}; {teeth} teeth each"
    );
    assert!(beats >= 28, "{beats}");
    assert!((period / wanted - 1.0).abs() < 0.02, "{period}, not {wanted}");
    assert!((teeth - 1.0).abs() < 0.01, "{teeth}");
    assert!(greatest > 0.03 && least < -0.03, "{least} to {greatest}");
}

/// The four-bar linkage obeys Freudenstein's equation, and the slider-crank its closed form. Both cranks keep their speeds.
#[test]
fn the_linkages_obey_their_closed_forms() {
    let mut simulation = opened("linkage");
    let (d, a, b, c) = (2.0, 0.6, 1.8, 1.4);
    let [one, two, three] = [d / a, d / c, (a * a - b * b + c * c + d * d) / (2.0 * a * c)];
    let start = 1.3517_f64.atan2(-0.3645);
    let stroke = |angle: f64| 0.5 * angle.cos() + (1.5 * 1.5 - (0.5 * angle.sin()).powi(2)).sqrt();
    let (mut worst, mut open) = ([0.0_f64; 2], 0.0_f32);
    for _ in 0..600 {
        simulation.run(1, DT).unwrap();
        let all = simulation.joints().unwrap();
        let position = |joint: usize| f64::from(all[joint].position);
        let (crank, rocker) = (FRAC_PI_2 + position(0), start - position(3));
        let off = one * rocker.cos() - two * crank.cos() + three - (crank - rocker).cos();
        let way = stroke(FRAC_PI_2 + position(4)) - stroke(FRAC_PI_2) - position(7);
        worst = [worst[0].max(off.abs()), worst[1].max(way.abs())];
        open = all.iter().enumerate().filter(|(k, _)| *k != 7).map(|(_, joint)| joint.error).fold(open, f32::max);
    }
    let speeds = simulation.joints().unwrap();
    eprintln!("Freudenstein {}, stroke {}, open by {open}, speeds {} {}", worst[0], worst[1], speeds[0].speed, speeds[4].speed);
    assert!(worst[0] < 0.02 && worst[1] < 5e-3 && open < 5e-3, "{worst:?}, open by {open}");
    assert!((speeds[0].speed - 3.0).abs() < 0.05 && (speeds[4].speed - 4.0).abs() < 0.1, "{speeds:?}");
}

/// The chain of the crane holds its ball, and the ball makes a hole in the wall.
#[test]
fn the_crane_breaks_the_wall() {
    let mut simulation = opened("crane");
    let places = |scene: &Scene| scene.bodies().iter().map(|body| body.position).collect::<Vec<_>>();
    let before = places(simulation.scene());
    let mut open = 0.0_f32;
    for _ in 0..300 {
        simulation.run(1, DT).unwrap();
        open = simulation.joints().unwrap().iter().map(|joint| joint.error).fold(open, f32::max);
    }
    let after = places(simulation.sync().unwrap());
    let moved = before.iter().zip(&after).skip(9).filter(|(from, to)| from.distance(**to) > 0.3).count();
    let stays = before.iter().zip(&after).skip(9).filter(|(from, to)| from.distance(**to) < 0.05).count();
    eprintln!("{moved} of {} bricks moved, {stays} stay, the chain opens by {open}", before.len() - 9);
    assert!(moved > 8 && stays > 50, "{moved} {stays}");
    assert!(open < 0.06 * 0.5, "{open}");
}

/// The car drives a curve over its ridges and stays on its wheels.
#[test]
fn the_car_drives_on_its_wheels() {
    let mut simulation = opened("car");
    let (mut upright, mut way, mut before) = (1.0_f32, 0.0, body(simulation.scene(), "car").position);
    for _ in 0..42 {
        simulation.run(10, DT).unwrap();
        let car = body(simulation.sync().unwrap(), "car");
        upright = upright.min((car.orientation * Vec3::Y).y);
        way += car.position.distance(before);
        before = car.position;
    }
    let scene = simulation.sync().unwrap();
    let car = body(scene, "car");
    let forward = car.orientation * Vec3::Z;
    let (yaw, speed) = (f64::from(forward.x.atan2(forward.z)).to_degrees(), car.velocity.length());
    let low = ["wheel_fl", "wheel_fr", "wheel_rl", "wheel_rr"].map(|name| body(scene, name).position.y);
    eprintln!("way {way}, turned by {yaw}, speed {speed}, upright {upright}, wheels at {low:?}");
    assert!(upright > 0.9, "{upright}");
    assert!(way > 15.0 && yaw.abs() > 15.0, "{way} m, {yaw} degrees");
    assert!(low.iter().all(|height| (0.2..0.7).contains(height)), "{low:?}");
}

/// The ragdolls fall down the stairs in one piece, and their joints keep within their limits.
#[test]
fn ragdolls_fall_down_the_stairs() {
    let mut simulation = opened("ragdolls");
    let heads: Vec<RigidBodyId> = {
        let scene = simulation.scene();
        let is_head = |id: &RigidBodyId| {
            scene.tag(*id).unwrap().and_then(|tag| tag.name.clone()).is_some_and(|name| name.starts_with("head"))
        };
        scene.body_ids().filter(is_head).collect()
    };
    let (mut open, mut beyond) = (0.0_f32, 0.0_f32);
    let before: Vec<Vec3> = heads.iter().map(|id| simulation.scene().body(*id).unwrap().position).collect();
    for _ in 0..300 {
        simulation.run(1, DT).unwrap();
        let all = simulation.joints().unwrap();
        for (reading, joint) in all.iter().zip(simulation.scene().joints()) {
            open = open.max(reading.error);
            if let (Some([least, most]), rockfall::JointKind::Hinge) = (joint.limits, joint.kind) {
                beyond = beyond.max(least - reading.position).max(reading.position - most);
            }
        }
    }
    let scene = simulation.sync().unwrap();
    let fallen: Vec<f32> = heads.iter().zip(&before).map(|(id, from)| from.y - scene.body(*id).unwrap().position.y).collect();
    eprintln!("heads fell by {fallen:?}, joints open by {open}, hinges are beyond their limits by {beyond}");
    assert_eq!(fallen.len(), 3);
    assert!(fallen.iter().all(|way| *way > 1.5), "{fallen:?}");
    assert!(open < 0.05 && beyond < 0.2, "{open} {beyond}");
}
