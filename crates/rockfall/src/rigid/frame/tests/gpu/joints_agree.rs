//! Frames of machines with all kinds of joints on a device are those of the CPU.

use glam::Vec3;

use super::super::scene::{DT, Random, Scene};
use super::device::{apart, open};
use crate::rigid::frame::bodies_alone;
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

/// Whole frames, each from the state of the CPU. Joints break in the same frames.
#[test]
fn machines_agree() {
    let gpu = open();
    let mut scene = machine();
    let (mut place, mut speed, mut impulse, mut broken) = (0.0_f32, 0.0_f32, 0.0_f32, 0);
    let mut on_device = GpuWorld::new(&gpu, &scene.world, &bodies_alone(&scene.world)).unwrap();
    for frame in 0..120 {
        let mut other = scene.world.clone();
        on_device.put(&scene.world, &bodies_alone(&scene.world)).unwrap();
        let report = on_device.advance(DT, scene.substeps, true).unwrap();
        on_device.download(&mut other).unwrap();
        scene.step();
        assert_eq!(report.broken, scene.last.broken, "frame {frame}");
        broken += report.broken;
        let [one, two] = apart(&scene.world, &other);
        (place, speed) = (place.max(one), speed.max(two));
        for (own, twin) in other.joints.states.iter().zip(&scene.world.joints.states) {
            assert_eq!(own.broken, twin.broken, "frame {frame}");
            let size = 1.0 + twin.force.length() + twin.torque.length();
            impulse = impulse.max((own.force.distance(twin.force) + own.torque.distance(twin.torque)) / size);
        }
    }
    eprintln!("machines: places {place:.1e}, speeds {speed:.1e}, loads {impulse:.1e} apart, {broken} broken");
    assert!(place < 2e-4 && speed < 2e-2 && impulse < 3e-2 && broken > 0);
}
