//! Joints on a device (docs/physics section 11.14): closed forms, conservation, and runs that go on.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};

use super::super::scene::{DT, G, Random, Scene, close};
use super::device::{bits, open};
use crate::rigid::common::FrameReport;
use crate::rigid::frame::{bodies_alone, energy, momenta};
use crate::rigid::gpu::RigidGpu;
use crate::rigid::gpu::world::GpuWorld;
use crate::rigid::joints::{Drive, End, Joint, Joints, Kind};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
use crate::rigid::world::{Body, RigidWorld};
use crate::rotate::product;

const HALF: Vec3 = Vec3::new(0.5, 0.05, 0.05);

/// A joint at a place of the world, with its axis along a direction.
fn link(scene: &Scene, kind: Kind, bodies: [usize; 2], at: Vec3, axis: Vec3) -> Joint {
    let frame = Quat::from_rotation_arc(Vec3::X, axis.normalize());
    let ends = bodies.map(|body| {
        let pose = scene.world.bodies[body].pose;
        End { body: body as u32, place: pose.inner(at), turn: product(pose.turn.inverse(), frame) }
    });
    Joint { kind, ends, drive: Drive::default(), strength: [f32::INFINITY; 2], collides: false }
}

fn with_joints(mut scene: Scene, list: Vec<Joint>) -> Scene {
    let has_mass: Vec<bool> = scene.world.bodies.iter().map(|body| body.inverse_mass > 0.0).collect();
    scene.world.joints = Joints::new(list, &has_mass);
    scene
}

/// A rod of the length and mass 1 that begins at a height of 5 and lies along x, held there by the world.
fn rod(kind: Kind, drive: Drive) -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    let body = scene.cuboid(HALF, Vec3::new(0.5, 5.0, 0.0));
    let joint = link(&scene, kind, [0, body], Vec3::new(0.0, 5.0, 0.0), Vec3::Z);
    with_joints(scene, vec![Joint { drive, ..joint }])
}

/// Moment of the rod about its end.
fn moment() -> f32 {
    (1.0 + 0.01) / 12.0 + 0.25
}

/// Runs frames on a device and looks at the state after each one.
fn run(scene: &mut Scene, gpu: &Arc<RigidGpu>, frames: usize, mut look: impl FnMut(usize, &RigidWorld, &FrameReport)) {
    let world = &mut scene.world;
    let on_device = GpuWorld::new(gpu, world, &bodies_alone(world));
    let mut on_device = on_device.unwrap();
    for frame in 0..frames {
        let report = on_device.advance(DT, scene.substeps, true).unwrap();
        on_device.download(world).unwrap();
        look(frame, world, &report);
    }
    on_device.download_history(world).unwrap();
}

/// D and the rotation of B against A, along the axes of the joint.
fn off(world: &RigidWorld, joint: usize) -> [Vec3; 2] {
    let [a, b] = world.joints.list[joint].ends;
    let [one, two] = [a, b].map(|end| world.bodies[end.body as usize].pose);
    let [from, to] = [product(one.turn, a.turn), product(two.turn, b.turn)];
    let twist = product(from.inverse(), to);
    [from.inverse() * (two.point(b.place) - one.point(a.place)), twist.to_scaled_axis()]
}

/// How far a joint is off in places, and in angles.
fn deviation(world: &RigidWorld, joint: usize) -> [f32; 2] {
    let [apart, twist] = off(world, joint);
    let Joint { kind, drive, .. } = &world.joints.list[joint];
    let sum = |bits: u8, vector: Vec3| {
        let parts = (0..3).filter(|axis| bits >> axis & 1 == 1).map(|axis| vector[axis]);
        parts.map(|part| part * part).sum::<f32>().sqrt()
    };
    let line = if drive.locked { (apart.length() - drive.target).abs() } else { 0.0 };
    [sum(kind.linear, apart) + line, sum(kind.angular, twist)]
}

#[test]
fn pendulums_keep_their_anchors() {
    let gpu = open();
    let mut scenes = vec![
        ("ball", rod(Kind::BALL, Drive::default())),
        ("hinge", rod(Kind::HINGE, Drive::default())),
        ("slider", rod(Kind::SLIDER, Drive::default())),
        ("fixed", rod(Kind::FIXED, Drive::default())),
    ];
    let mut scene = rod(Kind::DISTANCE, Drive { locked: true, target: 1.0, ..Drive::default() });
    scene.world.joints.list[0].ends[0].place = Vec3::new(-1.0, 5.0, 0.0);
    scenes.push(("distance", scene));
    for (name, mut scene) in scenes {
        let is_tilted = name == "slider";
        if is_tilted {
            scene.world.gravity = Vec3::new(0.0, -G, -1.0);
        }
        let (before, mut place, mut angle) = (energy(&scene.world), 0.0_f32, 0.0_f32);
        run(&mut scene, &gpu, 120, |_, world, _| {
            let [own_place, own_angle] = deviation(world, 0);
            (place, angle) = (place.max(own_place), angle.max(own_angle));
        });
        let energy = energy(&scene.world) - before;
        eprintln!("{name}: {place:.1e} units, {angle:.1e} rad off, energy {energy:.3} J");
        assert!(place < 1e-3 && angle < 3e-3, "{name}");
        assert!(energy.abs() < 0.1, "{name}");
        if is_tilted {
            close(scene.at(1).z, -2.0, 0.02);
        }
    }
}

#[test]
fn free_chain_keeps_its_momenta() {
    let gpu = open();
    let mut scene = Scene::new(0.5, 0.0).weightless();
    let mut random = Random(7);
    for k in 0..5 {
        let body = scene.cuboid(Vec3::new(0.5, 0.2, 0.3), Vec3::new(1.2 * k as f32, 5.0, 0.0));
        scene.throw(body, random.vector(), 2.0 * random.vector());
    }
    let kinds = [Kind::BALL, Kind::HINGE, Kind::BALL, Kind::DISTANCE];
    let joint = |k: usize| {
        let joint = link(&scene, kinds[k], [k + 1, k + 2], Vec3::new(1.2 * k as f32 + 0.6, 5.0, 0.0), Vec3::Z);
        let drive = Drive { limits: [-1.0, 1.0], ..Drive::default() };
        let line = Drive { limits: [0.0, 0.5], ..Drive::default() };
        Joint { drive: if k == 3 { line } else { drive }, ..joint }
    };
    let list = (0..4).map(joint).collect();
    let mut scene = with_joints(scene, list);
    let (p, l) = momenta(&scene.world);
    let size = |world: &RigidWorld| {
        let of_body = |body: &Body| {
            let moving = body.velocity.length() / body.inverse_mass.max(1e-9);
            [moving, body.pose.position.length() * moving + body.momentum.length()]
        };
        world.bodies[1..].iter().map(of_body).fold([0.0; 2], |sum, next| [sum[0] + next[0], sum[1] + next[1]])
    };
    let sizes = size(&scene.world).map(f64::from);
    let mut worst = [0.0_f64; 2];
    run(&mut scene, &gpu, 120, |_, world, _| {
        let (p_now, l_now) = momenta(world);
        worst = [worst[0].max((p_now - p).length() / sizes[0]), worst[1].max((l_now - l).length() / sizes[1])];
    });
    let place = (0..3).map(|joint| deviation(&scene.world, joint)[0]).fold(0.0, f32::max);
    eprintln!("momentum {:.1e}, angular momentum {:.1e} off; anchors {place:.1e}", worst[0], worst[1]);
    assert!(worst[0] < 1e-5 && worst[1] < 1e-5);
    assert!(p.length() > 0.0 && l != DVec3::ZERO && place < 1e-3);
}

#[test]
fn limits_and_cones_stop() {
    let gpu = open();
    let mut scene = rod(Kind::HINGE, Drive { limits: [-0.5, 0.7], ..Drive::default() });
    let mut least = 0.0_f32;
    run(&mut scene, &gpu, 120, |_, world, _| least = least.min(off(world, 0)[1].x));
    eprintln!("limit: least angle {least}, at rest {}", off(&scene.world, 0)[1].x);
    assert!(least > -0.51);
    close(off(&scene.world, 0)[1].x, -0.5, 3e-3);
    close(scene.spin(1).length(), 0.0, 1e-3);
    // What holds it there: the weight at half the length.
    let state = scene.world.joints.states[0];
    close(state.torque.z, 0.5 * G * 0.5_f32.cos(), 0.02 * G);
    close(state.force.y, G, 0.01 * G);
    // The axis of a ball joint along the rod.
    let mut scene = Scene::new(0.5, 0.0);
    let body = scene.cuboid(HALF, Vec3::new(0.5, 5.0, 0.0));
    let joint = link(&scene, Kind::BALL, [0, body], Vec3::new(0.0, 5.0, 0.0), Vec3::X);
    let mut scene = with_joints(scene, vec![Joint { drive: Drive { cone: 0.4, ..Drive::default() }, ..joint }]);
    let mut widest = 0.0_f32;
    let angle = |world: &RigidWorld| (world.bodies[1].pose.turn * Vec3::X).angle_between(Vec3::X);
    run(&mut scene, &gpu, 120, |_, world, _| widest = widest.max(angle(world)));
    eprintln!("cone: widest {widest}, at rest {}", angle(&scene.world));
    assert!(widest < 0.41);
    close(angle(&scene.world), 0.4, 3e-3);
    // A rope.
    let mut scene = Scene::new(0.5, 0.0);
    let ball = scene.ball(0.1, Vec3::new(0.0, 5.0, 0.0));
    let joint = link(&scene, Kind::DISTANCE, [0, ball], Vec3::new(0.0, 5.0, 0.0), Vec3::X);
    let mut scene = with_joints(scene, vec![Joint { drive: Drive { limits: [0.0, 1.0], ..Drive::default() }, ..joint }]);
    run(&mut scene, &gpu, 90, |_, _, _| ());
    close(scene.at(1).y, 4.0, 1e-3);
}

#[test]
fn drives_do_what_they_say() {
    let gpu = open();
    // A motor with enough torque, and one whose torque is too small for its speed.
    for (most, wanted) in [(100.0, 3.0), (0.2, 0.2 / moment())] {
        let mut scene = rod(Kind::HINGE, Drive { speed: 3.0, motor_limit: most, ..Drive::default() }).weightless();
        run(&mut scene, &gpu, 60, |_, _, _| ());
        eprintln!("motor: {} of {wanted}", scene.spin(1).z);
        close(scene.spin(1).z, wanted, 2e-3 * wanted);
    }
    // Friction takes the spin linearly.
    let mut scene = rod(Kind::HINGE, Drive { friction: 0.2, ..Drive::default() }).weightless();
    scene.throw(1, Vec3::new(0.0, 0.5, 0.0), Vec3::Z);
    let mut half = 0.0;
    run(&mut scene, &gpu, 120, |frame, world, _| {
        if frame == 59 {
            half = world.bodies[1].spin.z;
        }
    });
    eprintln!("friction: {half}, then {}", scene.spin(1).z);
    close(half, 1.0 - 0.2 / moment(), 2e-3);
    close(scene.spin(1).z, 0.0, 1e-4);
    // A spring with the period of 1 s.
    let mut scene = rod(Kind::SLIDER, Drive { stiffness: TAU * TAU, target: 0.2, ..Drive::default() }).weightless();
    let mut turned = 0.0;
    run(&mut scene, &gpu, 60, |frame, world, _| {
        if frame == 29 {
            turned = world.bodies[1].pose.position.z;
        }
    });
    eprintln!("spring: {turned}, then {}", scene.at(1).z);
    close(turned, 0.4, 2e-3);
    close(scene.at(1).z, 0.0, 2e-3);
    // A stiff one holds its target, whose angle counts the shorter way around.
    let drive = Drive { stiffness: 1e5, damping: 10.0, target: 0.1 - TAU, ..Drive::default() };
    let mut scene = rod(Kind::HINGE, drive);
    run(&mut scene, &gpu, 180, |_, _, _| ());
    eprintln!("stiff spring: {:?}, spin {}", off(&scene.world, 0)[1], scene.spin(1));
    close(off(&scene.world, 0)[1].x, 0.1, 1e-3);
}

#[test]
fn drives_change_between_frames() {
    let gpu = open();
    let mut scene = rod(Kind::HINGE, Drive { speed: 3.0, motor_limit: 100.0, ..Drive::default() }).weightless();
    let world = &mut scene.world;
    let mut on_device = GpuWorld::new(&gpu, world, &bodies_alone(world)).unwrap();
    for (speed, most) in [(3.0, 100.0), (-2.0, 100.0), (5.0, 0.0)] {
        world.joints.list[0].drive = Drive { speed, motor_limit: most, ..Drive::default() };
        on_device.set_drives(&world.joints.list);
        (0..20).for_each(|_| _ = on_device.advance(DT, 4, true).unwrap());
        on_device.download(world).unwrap();
        close(world.bodies[1].spin.z, if most > 0.0 { speed } else { -2.0 }, 1e-3);
    }
}

/// A body hangs at a joint that bears a little more, or a little less, than its weight.
#[test]
fn joints_break_at_the_force_of_statics() {
    let gpu = open();
    for (share, breaks) in [(1.005, false), (0.995, true)] {
        let mut scene = Scene::new(0.5, 0.0);
        let body = scene.cuboid(Vec3::splat(0.5), Vec3::new(0.0, 5.0, 0.0));
        let joint = link(&scene, Kind::BALL, [0, body], Vec3::new(0.0, 5.5, 0.0), Vec3::X);
        let mut scene = with_joints(scene, vec![Joint { strength: [share * G, f32::INFINITY], ..joint }]);
        let (mut broken, mut first) = (0, None);
        run(&mut scene, &gpu, 30, |frame, world, report| {
            broken += report.broken;
            if first.is_none() && world.joints.states[0].broken {
                first = Some(frame);
            }
        });
        let state = scene.world.joints.states[0];
        eprintln!("{share}: broken in frame {first:?}, force {}", state.force);
        assert_eq!(broken, u32::from(breaks));
        assert_eq!(first.is_some(), breaks);
        if let Some(first) = first {
            let fallen = DT * (29 - first) as f32;
            close(scene.at(1).y, 5.0 - 0.5 * G * fallen * fallen, 0.03);
            close(scene.velocity(1).y, -G * fallen, 1e-3);
        } else {
            close(state.force.y, G, 1e-3 * G);
            close(scene.at(1).y, 5.0, 1e-3);
        }
    }
    // The torque of a cantilever. It begins with a frame of 1.1 times the torque of statics.
    for (share, breaks) in [(1.15, 0), (0.99, 1)] {
        let mut scene = rod(Kind::FIXED, Drive::default());
        scene.world.joints.list[0].strength = [f32::INFINITY, share * 0.5 * G];
        let mut broken = 0;
        run(&mut scene, &gpu, 30, |_, _, report| broken += report.broken);
        eprintln!("cantilever: {}", scene.world.joints.states[0].torque);
        assert_eq!(broken, breaks);
    }
}

/// Bodies of a joint overlap and are no pair, until it breaks.
#[test]
fn bodies_of_a_joint_do_not_collide() {
    let gpu = open();
    let mut scene = Scene::new(0.5, 0.0).weightless();
    let bodies = [0.0, 0.8].map(|x| scene.cuboid(Vec3::splat(0.5), Vec3::new(x, 0.0, 0.0)));
    scene.world.bodies[bodies[0]].force = Vec3::new(-1.0, 0.0, 0.0);
    scene.world.bodies[bodies[1]].force = Vec3::new(1.0, 0.0, 0.0);
    let joint = link(&scene, Kind::FIXED, bodies, Vec3::new(0.4, 0.0, 0.0), Vec3::X);
    let strong = with_joints(scene, vec![joint]);
    let contacts = |change: &dyn Fn(&mut Joint)| {
        let mut scene = Scene { world: strong.world.clone(), ..Scene::new(0.5, 0.0) };
        change(&mut scene.world.joints.list[0]);
        let (mut counts, mut broken) = (Vec::new(), Vec::new());
        run(&mut scene, &gpu, 3, |_, world, report| {
            counts.push(report.max_overlap > 0.1);
            broken.push(world.joints.states[0].broken);
        });
        (counts, broken)
    };
    assert_eq!(contacts(&|_| ()), (vec![false; 3], vec![false; 3]));
    assert!(contacts(&|joint| joint.collides = true).0[0]);
    let (overlaps, broken) = contacts(&|joint| joint.strength[0] = 0.9);
    assert_eq!((overlaps, broken), (vec![false, true, true], vec![true; 3]));
}

/// A star with more joints at a body than contacts have colours, and a chain with drives that falls on the floor.
fn machines() -> Vec<(&'static str, Scene)> {
    let mut scene = Scene::new(0.5, 0.0).weightless();
    // Heavy: one sweep over many heavy bodies at a light one does not converge.
    let hub = scene.body(Shape::ball(1.0), Pose::IDENTITY, 400.0);
    scene.throw(hub, Vec3::ZERO, Vec3::new(0.0, 0.0, 2.0));
    let mut list = Vec::new();
    for k in 0..20 {
        let (sin, cos) = (TAU * k as f32 / 20.0).sin_cos();
        let body = scene.ball(0.2, Vec3::new(1.5 * cos, 1.5 * sin, 0.0));
        list.push(link(&scene, Kind::BALL, [hub, body], Vec3::new(cos, sin, 0.0), Vec3::Z));
    }
    let star = with_joints(scene, list);
    let mut scene = Scene::new(0.5, 0.3);
    scene.floor();
    let mut list = Vec::new();
    for k in 0..6 {
        let body = scene.cuboid(Vec3::new(0.5, 0.15, 0.2), Vec3::new(1.1 * k as f32, 0.5 + 0.3 * k as f32, 0.0));
        if k > 0 {
            let at = Vec3::new(1.1 * k as f32 - 0.55, 0.35 + 0.3 * k as f32, 0.0);
            let joint = link(&scene, [Kind::HINGE, Kind::BALL][k % 2], [body - 1, body], at, Vec3::Z);
            let drive = Drive { limits: [-0.3, 0.4], cone: 0.5, friction: 0.1, stiffness: 5.0, ..Drive::default() };
            list.push(Joint { drive, ..joint });
        }
    }
    vec![("star", star), ("chain", with_joints(scene, list))]
}

#[test]
fn runs_with_joints_have_the_same_bits() {
    let gpu = open();
    for (name, scene) in machines() {
        let go = |split: bool| {
            let mut world = scene.world.clone();
            let mut on_device = GpuWorld::new(&gpu, &world, &bodies_alone(&world)).unwrap();
            for frame in 0..40 {
                let report = on_device.advance(DT, 4, true).unwrap();
                if split && frame % 5 == 0 {
                    on_device.download(&mut world).unwrap();
                    on_device.download_history(&mut world).unwrap();
                    if frame % 2 == 0 {
                        on_device.put(&world, &bodies_alone(&world)).unwrap();
                    } else {
                        on_device = GpuWorld::new(&gpu, &world, &bodies_alone(&world)).unwrap();
                    }
                }
                assert_eq!(report.stopped, None, "{name}");
            }
            on_device.download(&mut world).unwrap();
            world
        };
        let one = go(false);
        let place = (0..one.joints.list.len()).map(|joint| deviation(&one, joint)[0]).fold(0.0, f32::max);
        eprintln!("{name}: {} colours, anchors {place:.1e} apart", one.joints.colours.len() - 1);
        assert!(place < 1e-2, "{name}");
        assert!(name != "star" || one.joints.colours.len() > 17);
        for split in [false, true] {
            let other = go(split);
            assert!(bits(&one) == bits(&other), "{name}, split {split}");
            assert!(one.joints == other.joints, "{name}, split {split}: states");
        }
    }
}
