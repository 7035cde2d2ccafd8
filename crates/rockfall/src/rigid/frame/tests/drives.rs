//! Drives of joints against closed forms: efforts, drags, armatures, dampers in a row (docs/physics section 11.14).

use std::f32::consts::PI;

use glam::Vec3;

use super::joints::{elliptic, moment};
use super::scene::{DT, G, Scene, close};
use crate::rigid::frame::{kinetic_energy, momenta, motions_of_joints};
use crate::rigid::joints::Kind;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;

const WORLD: usize = 0;

/// A rod of the length 1 and the mass 1 that a joint holds to the world at its end, and its moment about that end.
fn rod(kind: Kind, to: Vec3, substeps: u32, weightless: bool) -> (Scene, usize, usize, f32) {
    let scene = Scene::new(0.5, 0.0).substeps(substeps);
    let mut scene = if weightless { scene.weightless() } else { scene };
    let rod = scene.rod(Vec3::ZERO, to, 1.0);
    let joint = scene.joint(kind, [WORLD, rod], Vec3::ZERO, Vec3::Z);
    let about = moment(&scene, rod, Vec3::Z) + 0.25;
    (scene, rod, joint, about)
}

/// An effort turns a rod with a rotor by its torque over the sum of both moments, and pushes a slider by its force over the sum of masses.
#[test]
fn efforts_accelerate_bodies_and_rotors() {
    for armature in [0.0, 0.1, 3.0, 100.0] {
        for kind in [Kind::HINGE, Kind::SLIDER, Kind::BALL] {
            // The effort of a ball acts about one axis, its rotor about all of them.
            if kind == Kind::BALL && armature > 10.0 {
                continue;
            }
            let (mut scene, _, joint, about) = rod(kind, Vec3::X, 4, true);
            let inertia = if kind == Kind::SLIDER { 1.0 } else { about };
            scene.drive(joint, |drive| (drive.effort, drive.armature) = (2.0 * (inertia + armature), armature));
            scene.run(0.5);
            let found = motions_of_joints(&scene.world)[joint].speed;
            eprintln!("{kind:?}, armature {armature}: {found}");
            close(found, 1.0, 2e-3);
        }
    }
}

/// A pendulum with a rotor swings as one of a greater moment. Its energy with that of the rotor does not rise.
#[test]
fn rotors_slow_pendulums() {
    for (kind, armature, substeps, most) in
        [(Kind::HINGE, 0.3, 4, 3e-3), (Kind::HINGE, 5.0, 4, 3e-3), (Kind::HINGE, 0.3, 16, 1e-3), (Kind::BALL, 0.3, 16, 1e-3)]
    {
        let start = PI / 3.0;
        let (mut scene, rod, joint, about) = rod(kind, Vec3::new(start.sin(), -start.cos(), 0.0), substeps, false);
        scene.drive(joint, |drive| drive.armature = armature);
        let wanted = 4.0 * elliptic((0.5 * f64::from(start)).sin()) * f64::from(((about + armature) / (0.5 * G)).sqrt());
        let energy = |scene: &Scene| {
            let speed = scene.spin(rod).z;
            crate::rigid::frame::energy(&scene.world) + f64::from(0.5 * armature * speed * speed)
        };
        let first = energy(&scene);
        let (mut passages, mut time, mut before, mut highest) = (Vec::new(), 0.0, scene.at(rod).x, f64::NEG_INFINITY);
        while passages.len() < 5 {
            scene.step();
            time += f64::from(DT);
            let now = scene.at(rod).x;
            if before > 0.0 && now <= 0.0 {
                passages.push(time - f64::from(DT * now / (now - before)));
                highest = highest.max(energy(&scene));
            }
            before = now;
        }
        let period = (passages[4] - passages[0]) / 4.0;
        let (rise, lost) = (highest - first, first - energy(&scene));
        eprintln!(
            "{kind:?} {substeps}, armature {armature}: period {period} of {wanted}, E +{rise:.1e} -{lost:.1e} of {}",
            0.25 * G
        );
        assert!((period / wanted - 1.0).abs() < most, "{period}, not {wanted}");
        assert!(rise < 2e-3 * f64::from(0.25 * G) && lost < 0.05 * f64::from(0.25 * G), "{rise} {lost}");
    }
}

/// A slider with an armature of its mass falls half as fast.
#[test]
fn rotors_have_no_weight() {
    let mut scene = Scene::new(0.5, 0.0);
    let block = scene.cuboid(Vec3::splat(0.5), Vec3::ZERO);
    let slider = scene.joint(Kind::SLIDER, [WORLD, block], Vec3::ZERO, Vec3::Y);
    scene.drive(slider, |drive| drive.armature = 1.0);
    scene.run(1.0);
    close(scene.velocity(block).y, -0.5 * G, 1e-2);
}

/// A motor spins up a wheel and its rotor and keeps their speed; a limit stops both at once.
#[test]
fn motors_and_limits_take_rotors_along() {
    for armature in [0.5, 50.0] {
        let mut scene = Scene::new(0.5, 0.0);
        let wheel = scene.cuboid(Vec3::new(0.5, 0.5, 0.2), Vec3::ZERO);
        let hinge = scene.joint(Kind::HINGE, [WORLD, wheel], Vec3::ZERO, Vec3::Z);
        let about = moment(&scene, wheel, Vec3::Z);
        let torque = about + armature;
        scene.drive(hinge, |drive| (drive.speed, drive.motor_limit, drive.armature) = (2.0, torque, armature));
        scene.run(1.0);
        close(scene.spin(wheel).z, 1.0, 1e-2);
        scene.run(2.0);
        close(scene.spin(wheel).z, 2.0, 1e-3);
        scene.drive(hinge, |drive| (drive.motor_limit, drive.limits) = (0.0, [-10.0, 10.0]));
        let at = motions_of_joints(&scene.world)[hinge].position;
        scene.drive(hinge, |drive| drive.limits = [at - 3.0, at + 0.2]);
        scene.run(2.0);
        let motion = motions_of_joints(&scene.world)[hinge];
        eprintln!("armature {armature}: {motion:?}, limit {}", at + 0.2);
        close(motion.position, at + 0.2, 2e-2);
        assert!(motion.speed.abs() < 1e-3, "{motion:?}");
    }
}

/// The bound holds for an effort and a spring together, and not for a drag.
#[test]
fn bounds_hold_for_efforts_and_springs_alone() {
    let (mut scene, rod, joint, about) = rod(Kind::HINGE, Vec3::X, 4, true);
    scene.drive(joint, |drive| (drive.effort, drive.spring_limit) = (100.0, 0.5));
    scene.run(0.5);
    close(scene.spin(rod).z, 0.25 / about, 2e-3);
    // A drag of 10 stops what turns in spite of the bound: the rate is the torque over the drag.
    scene.drive(joint, |drive| drive.drag = 10.0);
    scene.run(1.0);
    close(scene.spin(rod).z, 0.05, 1e-4);
    // The spring pulls back with much more than the effort pushes.
    scene.drive(joint, |drive| (drive.effort, drive.stiffness, drive.target) = (0.2, 1e3, -1.0));
    scene.run(1.0);
    close(scene.spin(rod).z, -0.05, 1e-4);
    // Damping is part of what is bounded.
    scene.drive(joint, |drive| (drive.effort, drive.stiffness, drive.drag, drive.damping) = (0.0, 0.0, 0.0, 100.0));
    let spin = 2.0 * Vec3::Z;
    scene.throw(rod, spin.cross(scene.at(rod)), spin);
    scene.run(0.1);
    close(scene.spin(rod).z, 2.0 - 0.05 / about, 2e-2);
}

/// Hinges in a row with dampers turn slowly under the weight of what follows: each with the torque there over its damping, which is what
/// implicit Euler of the whole chain gives where inertia does not count.
#[test]
fn dampers_in_a_row_are_solved_together() {
    for (links, damping, seconds) in [(2, 1e2, 1.0), (2, 1e4, 1.0), (4, 1e2, 1.0), (4, 1e3, 4.0), (4, 1e4, 4.0)] {
        let mut scene = Scene::new(0.5, 0.0);
        let point = |k: usize| 0.3 * k as f32 * Vec3::X;
        let mut before = WORLD;
        let bodies: Vec<usize> = (0..links)
            .map(|k| {
                let next = scene.rod(point(k), point(k + 1), 1.0);
                let joint = scene.joint(Kind::HINGE, [before, next], point(k), Vec3::Z);
                scene.drive(joint, |drive| drive.damping = damping);
                before = next;
                next
            })
            .collect();
        scene.run(seconds);
        let (mut worst, mut rates) = (0.0_f32, Vec::new());
        for _ in 0..20 {
            scene.step();
            rates.clear();
            for (joint, motion) in motions_of_joints(&scene.world).into_iter().enumerate() {
                let [anchor, _] = scene.anchors(joint);
                let torque: f32 = bodies[joint..].iter().map(|body| -G * (scene.at(*body).x - anchor.x)).sum();
                rates.push([motion.speed, torque / damping]);
            }
            let most = rates.iter().map(|[_, wanted]| wanted.abs()).fold(0.0, f32::max);
            worst = rates.iter().map(|[found, wanted]| (found - wanted).abs() / most).fold(worst, f32::max);
        }
        eprintln!("{links} links, damping {damping}: {worst} of {rates:?}");
        assert!(worst < 0.05, "{links} links, damping {damping}: {worst}, {rates:?}");
    }
}

/// A body that spins on a ball joint with damping slows down by its moment, with a rotor by the sum of both.
#[test]
fn damped_balls_slow_down() {
    for (damping, drag, armature) in [(0.2, 0.0, 0.0), (0.05, 0.05, 0.1), (0.0, 0.3, 1.0)] {
        let mut scene = Scene::new(0.5, 0.0).weightless().substeps(8);
        let ball = scene.body(Shape::ball(0.5), Pose::IDENTITY, 1.0);
        let joint = scene.joint(Kind::BALL, [WORLD, ball], Vec3::ZERO, Vec3::Z);
        scene.drive(joint, |drive| (drive.damping, drive.drag, drive.armature) = (damping, drag, armature));
        scene.throw(ball, Vec3::ZERO, Vec3::new(1.0, -2.0, 0.5));
        let about = moment(&scene, ball, Vec3::Z);
        scene.run(0.5);
        let wanted = (-(damping + drag) * 0.5 / (about + armature)).exp();
        let found = scene.spin(ball).length() / Vec3::new(1.0, -2.0, 0.5).length();
        eprintln!("damping {damping}, drag {drag}, armature {armature}: {found} of {wanted}");
        close(found, wanted, 1e-2);
    }
}

/// A free pair of rods with a spring, a drag and a rotor keeps its momenta, and does not gain energy.
#[test]
fn drives_keep_momenta() {
    let mut scene = Scene::new(0.5, 0.0).weightless().substeps(8);
    let [a, b] = [scene.rod(Vec3::ZERO, Vec3::X, 1.0), scene.rod(Vec3::X, 2.0 * Vec3::X, 2.0)];
    let joint = scene.joint(Kind::HINGE, [a, b], Vec3::X, Vec3::Z);
    scene.drive(joint, |drive| (drive.stiffness, drive.target, drive.armature) = (20.0, 0.5, 0.4));
    scene.throw(a, 0.3 * Vec3::Y, 0.5 * Vec3::X);
    scene.run(0.5);
    let (p, l) = momenta(&scene.world);
    let energy = |scene: &Scene| {
        let motion = motions_of_joints(&scene.world)[0];
        let off = motion.position - 0.5;
        kinetic_energy(&scene.world) + f64::from(0.5 * (0.4 * motion.speed * motion.speed + 20.0 * off * off))
    };
    let first = energy(&scene);
    let mut highest = 0.0_f64;
    for _ in 0..600 {
        scene.step();
        highest = highest.max(energy(&scene));
    }
    let (p_end, l_end) = momenta(&scene.world);
    eprintln!("E {first} to {}, at most {highest}; dP {} dL {}", energy(&scene), (p_end - p).length(), (l_end - l).length());
    assert!(highest < 1.05 * first, "{highest} of {first}");
    assert!((p_end - p).length() < 1e-4 && (l_end - l).length() < 1e-3, "{p} {p_end}, {l} {l_end}");
}
