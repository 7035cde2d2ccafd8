//! Frames of machines with all kinds of joints on a device are those of the CPU.

use std::sync::Arc;

use glam::Vec3;

use super::super::scene::{DT, Random, Scene};
use super::device::{apart, bits, open};
use crate::rigid::frame::bodies_alone;
use crate::rigid::gpu::RigidGpu;
use crate::rigid::gpu::world::GpuWorld;
use crate::rigid::joints::Kind;

/// A chain of bodies over a floor, with a joint of each kind and every drive, and a second one that hangs from the world.
fn machine() -> Scene {
    let mut scene = Scene::new(0.5, 0.0).substeps(4);
    scene.floor();
    let mut random = Random(11);
    for (side, anchored) in [(-3.0, false), (3.0, true)] {
        let start = Vec3::new(side, 2.0, 0.0);
        let mut before = if anchored { 0 } else { scene.cuboid(Vec3::splat(0.3), start - 0.3 * Vec3::X) };
        let kinds = [Kind::BALL, Kind::HINGE, Kind::SLIDER, Kind::FIXED, Kind::DISTANCE, Kind::HINGE, Kind::BALL];
        for (k, kind) in kinds.into_iter().enumerate() {
            let at = start + 0.8 * k as f32 * Vec3::X;
            let next = scene.cuboid(Vec3::new(0.4, 0.15, 0.2), at + 0.4 * Vec3::X);
            scene.throw(next, random.vector(), 2.0 * random.vector());
            let to = if kind == Kind::DISTANCE { at + Vec3::new(0.1, 0.2, 0.0) } else { at };
            let joint = scene.joint_to(kind, [before, next], [at, to], Vec3::new(0.2, 0.3, 1.0));
            scene.drive(joint, |drive| match k {
                0 | 2 => (drive.armature, drive.drag) = (0.03 + 0.1 * k as f32, 0.05),
                1 => (drive.armature, drive.effort, drive.spring_limit) = (0.05, 1.5, 8.0),
                5 => (drive.armature, drive.drag, drive.effort) = (0.02, 0.2, -3.0),
                6 => drive.effort = 0.3,
                _ => (),
            });
            scene.drive(joint, |drive| match k {
                0 => (drive.cone, drive.friction, drive.damping, drive.limits) = (0.7, 0.2, 0.1, [-0.4, 0.3]),
                1 => (drive.stiffness, drive.damping, drive.target, drive.friction) = (30.0, 0.5, 0.4, 0.1),
                2 => (drive.limits, drive.speed, drive.motor_limit) = ([-0.2, 0.3], 0.5, 15.0),
                5 => (drive.limits, drive.speed, drive.motor_limit, drive.spring_limit) = ([-0.5, 5.9], -1.0, 3.0, 2.0),
                6 => (drive.stiffness, drive.target) = (5.0, 0.2),
                _ => (),
            });
            before = next;
        }
    }
    scene.world.joints.list[3].strength = [60.0, 20.0];
    scene
}

/// The greatest differences of places, speeds and loads from the CPU in whole frames, each from the state of the CPU; how many joints
/// broke; and the first frame in which others broke on the device.
struct Apart {
    most: [f32; 3],
    broken: u32,
    unequal: Option<usize>,
}

fn compare(gpu: &Arc<RigidGpu>, frames: usize) -> Apart {
    let mut scene = machine();
    let mut found = Apart { most: [0.0; 3], broken: 0, unequal: None };
    let mut on_device = GpuWorld::new(gpu, &scene.world, &bodies_alone(&scene.world)).unwrap();
    for frame in 0..frames {
        let mut other = scene.world.clone();
        on_device.put(&scene.world, &bodies_alone(&scene.world)).unwrap();
        let report = on_device.advance(DT, scene.substeps, true).unwrap();
        on_device.download(&mut other).unwrap();
        scene.step();
        found.broken += report.broken;
        let [place, speed] = apart(&scene.world, &other);
        let (mut load, mut is_equal) = (0.0_f32, report.broken == scene.last.broken);
        for (own, twin) in other.joints.states.iter().zip(&scene.world.joints.states) {
            is_equal &= own.broken == twin.broken;
            let size = 1.0 + twin.force.length() + twin.torque.length();
            load = load.max((own.force.distance(twin.force) + own.torque.distance(twin.torque)) / size);
        }
        found.unequal = found.unequal.or((!is_equal).then_some(frame));
        // NaN is apart, too.
        found.most =
            [0, 1, 2].map(|k| if [place, speed, load][k] <= found.most[k] { found.most[k] } else { [place, speed, load][k] });
    }
    found
}

impl Apart {
    fn is_close(&self) -> bool {
        let [place, speed, load] = self.most;
        place < 2e-4 && speed < 2e-2 && load < 5e-2 && self.unequal.is_none()
    }
}

/// Joints break in the same frames.
#[test]
fn machines_agree() {
    let found = compare(&open(), 120);
    eprintln!("machines: {:?} apart, {} broken", found.most, found.broken);
    assert!(found.is_close() && found.broken > 0, "{:?} {:?}", found.most, found.unequal);
}

/// Workgroups that have whole mechanisms give the bits of a dispatch for each colour.
#[test]
fn shared_dispatches_change_nothing() {
    let plain = open();
    let run = |gpu: &Arc<RigidGpu>| {
        let mut world = machine().world;
        let mut on_device = GpuWorld::new(gpu, &world, &bodies_alone(&world)).unwrap();
        for _ in 0..60 {
            on_device.advance(DT, 4, true).unwrap();
        }
        on_device.download(&mut world).unwrap();
        bits(&world)
    };
    assert_eq!(run(&plain), run(&plain.merging()));
}

/// The right text of a kernel, and a wrong one.
const MISTAKES: &[[&str; 2]] = &[
    ["let low_y = e.x / d.x;", "let low_y = 0.0;"],
    ["let k = straight + (dot(turn_a, response_a) + dot(turn_b, response_b));", "let k = straight + dot(turn_a, response_a);"],
    ["joint.apart * joint.axes, old, biased)", "vec3f(0.0), old, biased)"],
    ["let kept = armature * joint_states[at + 6u].x - old;", "let kept = -old;"],
    ["(*axis).share = taken / (1.0 + taken);", "(*axis).share = 0.0;"],
    ["axis.answer = gain * against;", "axis.answer = vec3f(0.0);"],
    ["let push = h * axis.x - ", "let push = -"],
    ["let there = select(2u * call.biased - 1u - step, step, is_first);", "let there = step % call.biased;"],
];

#[test]
fn mistakes_in_joints_are_rejected() {
    let gpu = open().merging();
    let accepted: Vec<&str> = MISTAKES
        .iter()
        .filter(|mistake| compare(&gpu.with_mistake(**mistake), 30).is_close())
        .map(|mistake| mistake[1])
        .collect();
    assert!(accepted.is_empty(), "{accepted:#?}");
}
