//! Joints: closed forms and conservation (docs/physics sections 11.11 and 11.14).

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};

use super::scene::{DT, G, Random, Scene, close};
use crate::rigid::frame::{energy, kinetic_energy, momenta, motions_of_joints};
use crate::rigid::joints::{Drive, End, Joint, Joints, Kind};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};
use crate::rotate::back;

/// The world as a body.
const WORLD: usize = 0;

impl Scene {
    /// A joint between two bodies, with its anchor and its axis in the world.
    pub(super) fn joint(&mut self, kind: Kind, [a, b]: [usize; 2], at: Vec3, axis: Vec3) -> usize {
        self.joint_to(kind, [a, b], [at, at], axis)
    }

    /// The same with an anchor for each body.
    pub(super) fn joint_to(&mut self, kind: Kind, bodies: [usize; 2], at: [Vec3; 2], axis: Vec3) -> usize {
        let turn = Quat::from_rotation_arc(Vec3::X, axis.normalize());
        let end = |side: usize| {
            let pose = self.world.bodies[bodies[side]].pose;
            let inverse = back(pose.turn);
            End { body: bodies[side] as u32, place: inverse * (at[side] - pose.position), turn: inverse * turn }
        };
        let locked = kind == Kind::DISTANCE;
        let drive = Drive { locked, target: if locked { at[0].distance(at[1]) } else { 0.0 }, ..Drive::default() };
        let joint = Joint { kind, ends: [end(0), end(1)], drive, strength: [f32::INFINITY; 2], collides: false };
        let mut list = self.world.joints.list.clone();
        list.push(joint);
        let has_mass: Vec<bool> = self.world.bodies.iter().map(|body| body.inverse_mass > 0.0).collect();
        self.world.joints = Joints::new(list, &has_mass);
        self.world.joints.list.len() - 1
    }

    pub(super) fn drive(&mut self, joint: usize, change: impl FnOnce(&mut Drive)) {
        change(&mut self.world.joints.list[joint].drive);
    }

    /// The anchors of a joint.
    pub(super) fn anchors(&self, joint: usize) -> [Vec3; 2] {
        self.world.joints.list[joint].ends.map(|end| {
            let pose = self.world.bodies[end.body as usize].pose;
            pose.position + pose.turn * end.place
        })
    }

    fn opening(&self, joint: usize) -> f32 {
        let [a, b] = self.anchors(joint);
        a.distance(b)
    }

    /// A rod of the radius 0.02 from one point to another.
    pub(super) fn rod(&mut self, from: Vec3, to: Vec3, mass: f32) -> usize {
        let along = to - from;
        let shape = Shape { core: Core::Segment { half: 0.5 * along.length() }, radius: 0.02 };
        self.body(shape, Pose::new(0.5 * (from + to), Quat::from_rotation_arc(Vec3::Y, along.normalize())), mass)
    }
}

/// The complete elliptic integral of the first kind, by the arithmetic-geometric mean.
pub(super) fn elliptic(modulus: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - modulus * modulus).sqrt());
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::PI / (2.0 * a)
}

/// The moment of inertia of a body about an axis through its centre.
pub(super) fn moment(scene: &Scene, body: usize, axis: Vec3) -> f32 {
    let body = &scene.world.bodies[body];
    let inner = back(body.pose.turn) * axis;
    (inner * inner * body.moments).element_sum()
}

/// A rod that swings by 60 degrees on a hinge: the period by the elliptic integral, and its energy.
#[test]
fn pendulums_swing_with_the_period_of_the_elliptic_integral() {
    for (kind, substeps, most) in [(Kind::HINGE, 4, 2e-3), (Kind::HINGE, 16, 5e-4), (Kind::BALL, 16, 5e-4)] {
        let mut scene = Scene::new(0.5, 0.0).substeps(substeps);
        let start = PI / 3.0;
        let end = Vec3::new(start.sin(), -start.cos(), 0.0);
        let rod = scene.rod(Vec3::ZERO, end, 1.0);
        let joint = scene.joint(kind, [WORLD, rod], Vec3::ZERO, Vec3::Z);
        let about = moment(&scene, rod, Vec3::Z) + 0.25;
        let wanted = 4.0 * elliptic((0.5 * f64::from(start)).sin()) * f64::from((about / (0.5 * G)).sqrt());
        // Passages of the lowest point to the left, by linear interpolation.
        let (mut passages, mut time, mut before) = (Vec::new(), 0.0, scene.at(rod).x);
        let first = energy(&scene.world);
        let depth = f64::from(0.5 * G);
        while passages.len() < 8 {
            scene.step();
            time += f64::from(DT);
            let now = scene.at(rod).x;
            if before > 0.0 && now <= 0.0 {
                passages.push(time - f64::from(DT * now / (now - before)));
            }
            before = now;
            // The energy of a symplectic Euler step oscillates by m g h v / 2.
            let wobble = 0.5 * f64::from(G * DT / substeps as f32 * scene.velocity(rod).y.abs());
            assert!(energy(&scene.world) < first + wobble + 1e-4 * depth, "{} of {depth}", energy(&scene.world) - first);
        }
        let period = (passages[7] - passages[0]) / 7.0;
        let lost = (first - energy(&scene.world)) / depth;
        eprintln!("{kind:?} {substeps}: period {period} of {wanted}, open by {}, lost {lost}", scene.opening(joint));
        assert!((period / wanted - 1.0).abs() < most, "{period}, not {wanted}");
        assert!(lost < 0.05, "{lost}");
    }
}

/// A chain of 12 links of 0.3 with 40 times the mass of a link at its end opens by at most 6 % of a link.
#[test]
fn a_chain_with_a_heavy_end_stays_closed() {
    for (links, heavy, substeps, most) in [(12, 40.0, 16, 0.06), (50, 100.0, 16, 0.08)] {
        let mut scene = Scene::new(0.5, 0.0).substeps(substeps);
        let point = |k: usize| 0.3 * k as f32 * Vec3::X;
        let mut before = WORLD;
        for k in 0..=links {
            let next = if k == links {
                scene.body(Shape::ball(0.2), Pose::new(point(k) + 0.2 * Vec3::X, Quat::IDENTITY), heavy)
            } else {
                scene.rod(point(k), point(k + 1), 1.0)
            };
            scene.joint(Kind::BALL, [before, next], point(k), Vec3::X);
            before = next;
        }
        let first = energy(&scene.world);
        let (mut worst, mut highest) = (0.0_f32, f64::NEG_INFINITY);
        for _ in 0..(6.0 / DT) as u32 {
            scene.step();
            worst = (0..=links).map(|joint| scene.opening(joint)).fold(worst, f32::max);
            highest = highest.max(energy(&scene.world));
        }
        let fall = f64::from(G * heavy * 0.3 * links as f32);
        eprintln!(
            "{links} links, {substeps}: opens by {} of a link, E rises by {:.1e} of the fall",
            worst / 0.3,
            (highest - first) / fall
        );
        assert!(worst < most * 0.3, "{}", worst / 0.3);
        assert!(highest < first + 1e-3 * fall, "{}", (highest - first) / fall);
    }
}

/// A free tree of rods with every kind of joint keeps its momentum and its angular momentum, and its energy.
#[test]
fn free_mechanisms_keep_their_momenta() {
    let kinds = [Kind::BALL, Kind::HINGE, Kind::SLIDER, Kind::FIXED, Kind::DISTANCE];
    for (kind, substeps) in kinds.into_iter().flat_map(|kind| [(kind, 4), (kind, 8), (kind, 16)]) {
        let mut scene = Scene::new(0.5, 0.0).weightless().substeps(substeps);
        let mut random = Random(7);
        let mut before = scene.rod(Vec3::ZERO, Vec3::X, 1.0);
        scene.throw(before, random.vector(), 3.0 * random.vector());
        for k in 1..5 {
            let from = Vec3::new(k as f32, 0.1 * k as f32, 0.0);
            let next = scene.rod(from, from + Vec3::new(0.8, 0.3, 0.2), 1.0 + k as f32);
            scene.throw(next, random.vector(), 3.0 * random.vector());
            let at = if kind == Kind::DISTANCE { [from, from + 0.4 * Vec3::Z] } else { [from, from] };
            scene.joint_to(kind, [before, next], at, Vec3::new(0.3, 1.0, 0.2));
            before = next;
        }
        // Links that are not neighbours pass through each other.
        for (group, collider) in (0..).zip(&mut scene.world.colliders) {
            collider.group.own = group;
        }
        // The joints take the speeds that they do not allow.
        scene.run(0.5);
        let (first, (p, l)) = (kinetic_energy(&scene.world), momenta(&scene.world));
        let mut highest = 0.0_f64;
        for _ in 0..1200 {
            scene.step();
            highest = highest.max(kinetic_energy(&scene.world));
        }
        let (p_end, l_end) = momenta(&scene.world);
        let end = kinetic_energy(&scene.world);
        eprintln!(
            "{kind:?} {substeps}: dP {:.1e}, dL {:.1e} of {:.1}, E {:.4} to {:.4} of {first:.4}",
            (p_end - p).length(),
            (l_end - l).length(),
            l.length(),
            highest,
            end
        );
        assert!((p_end - p).length() < 2e-5 * p.length(), "{kind:?}: {p} {p_end}");
        assert!((l_end - l).length() < 5e-4 * l.length(), "{kind:?}: {l} {l_end}");
        let most = if substeps == 4 { 1.01 } else { 1.002 };
        // Short rods between fast ends turn by much in a substep, which loses energy.
        let least = if kind == Kind::DISTANCE { 0.3 } else { 0.95 };
        assert!(highest < most * first && end > least * first, "{kind:?}: {highest} and {end} of {first}");
    }
}

/// Two bodies with a weld move as one body of their mass and moments.
#[test]
fn a_weld_is_one_body() {
    let mut scene = Scene::new(0.5, 0.0).weightless().substeps(8);
    let [a, b] = [-0.5, 0.5].map(|x| scene.cuboid(Vec3::splat(0.5), x * Vec3::X));
    scene.joint(Kind::FIXED, [a, b], Vec3::ZERO, Vec3::X);
    let mut one = Scene::new(0.5, 0.0).weightless().substeps(8);
    let whole = one.body(Shape::cuboid(Vec3::new(1.0, 0.5, 0.5)), Pose::IDENTITY, 2.0);
    let (velocity, spin) = (Vec3::new(0.3, 0.1, -0.2), Vec3::new(1.5, 0.4, 2.0));
    one.throw(whole, velocity, spin);
    for (body, x) in [(a, -0.5), (b, 0.5)] {
        scene.throw(body, velocity + spin.cross(x * Vec3::X), spin);
    }
    scene.run(3.0);
    one.run(3.0);
    let middle = 0.5 * (scene.at(a) + scene.at(b));
    assert!(middle.distance(one.at(whole)) < 1e-3, "{middle} {}", one.at(whole));
    let turn = scene.world.bodies[a].pose.turn.angle_between(one.world.bodies[whole].pose.turn);
    assert!(turn < 0.03, "turned by {turn} more");
    let [l, l_one] = [&scene, &one].map(|scene| momenta(&scene.world).1);
    assert!((l - l_one).length() < 1e-3, "{l} {l_one}");
}

/// A hinge falls on its limit and stays there; the load of the joint is the weight.
#[test]
fn limits_stop_hinges_and_sliders() {
    let mut scene = Scene::new(0.5, 0.0);
    let rod = scene.rod(Vec3::ZERO, Vec3::X, 2.0);
    let hinge = scene.joint(Kind::HINGE, [WORLD, rod], Vec3::ZERO, Vec3::Z);
    scene.drive(hinge, |drive| drive.limits = [-0.5, 2.9]);
    let block = scene.cuboid(Vec3::splat(0.5), Vec3::new(5.0, 0.0, 0.0));
    let slider = scene.joint(Kind::SLIDER, [WORLD, block], Vec3::new(5.0, 0.0, 0.0), Vec3::Y);
    scene.drive(slider, |drive| drive.limits = [-1.0, 1.0]);
    scene.run(5.0);
    let at = scene.at(rod);
    close(at.y.atan2(at.x), -0.5, 2e-3);
    close(scene.at(block).y, -1.0, 2e-3);
    for (joint, mass) in [(hinge, 2.0), (slider, 1.0)] {
        let load = scene.world.joints.states[joint];
        close(load.force.y, mass * G, 1e-2);
        assert!(load.force.x.abs() < 1e-2, "{load:?}");
    }
    // The limit bears the moment of the weight about the hinge.
    close(scene.world.joints.states[hinge].torque.z, 2.0 * G * 0.5 * 0.5_f32.cos(), 5e-2);
}

/// An angle beyond half a turn does not wrap at the limits.
#[test]
fn limits_of_almost_a_turn_hold() {
    for side in [-1.0, 1.0] {
        let mut scene = Scene::new(0.5, 0.0).weightless();
        let rod = scene.rod(Vec3::ZERO, Vec3::X, 1.0);
        let hinge = scene.joint(Kind::HINGE, [WORLD, rod], Vec3::ZERO, Vec3::Z);
        scene.drive(hinge, |drive| {
            drive.limits = [-0.2, 5.8];
            (drive.speed, drive.motor_limit) = (3.0 * side, 20.0);
        });
        scene.run(6.0);
        let at = scene.at(rod);
        let angle = at.y.atan2(at.x);
        let wanted = if side > 0.0 { 5.8 - 2.0 * PI } else { -0.2 };
        close(angle, wanted, 2e-2);
    }
}

/// A motor of any strength stops at its limits, and does not push through them.
#[test]
fn motors_stop_at_limits() {
    for (kind, speed) in [(Kind::HINGE, -0.5), (Kind::HINGE, 5.0), (Kind::SLIDER, 1.0), (Kind::SLIDER, -10.0)] {
        for force in [3.0, 1e4, f32::INFINITY] {
            let mut scene = Scene::new(0.5, 0.0).weightless();
            let rod = scene.rod(Vec3::ZERO, Vec3::X, 1.0);
            let joint = scene.joint(kind, [WORLD, rod], Vec3::ZERO, Vec3::Z);
            scene.drive(joint, |drive| (drive.speed, drive.motor_limit, drive.limits) = (speed, force, [-0.3, 0.3]));
            scene.run(3.0);
            let position = motions_of_joints(&scene.world)[joint].position;
            assert!((position - 0.3 * speed.signum()).abs() < 2e-2, "{kind:?} at {speed} with {force}: {position}");
            assert!(kinetic_energy(&scene.world) < 1e-4, "{kind:?} at {speed} with {force}");
        }
    }
}

/// A cone holds a ball joint, and the twist has its limits.
#[test]
fn cones_and_twists_hold_ball_joints() {
    let mut scene = Scene::new(0.5, 0.0);
    let rod = scene.rod(Vec3::ZERO, Vec3::X, 1.0);
    let joint = scene.joint(Kind::BALL, [WORLD, rod], Vec3::ZERO, Vec3::X);
    scene.drive(joint, |drive| {
        drive.cone = 0.6;
        drive.limits = [-0.3, 0.3];
    });
    scene.throw(rod, Vec3::ZERO, Vec3::new(20.0, 0.0, 0.0));
    let mut twist = 0.0_f32;
    for _ in 0..300 {
        scene.step();
        let turn = scene.world.bodies[rod].pose.turn * Quat::from_rotation_arc(Vec3::Y, Vec3::X).inverse();
        twist = twist.max((2.0 * turn.x.atan2(turn.w)).abs());
    }
    let at = scene.at(rod).normalize();
    close(at.dot(Vec3::X).acos(), 0.6, 5e-3);
    assert!(twist < 0.32, "{twist}");
}

/// A motor speeds up a wheel by its torque over the moment, and keeps its speed.
#[test]
fn motors_spin_up_and_stall() {
    let mut scene = Scene::new(0.5, 0.0);
    let wheel = scene.cuboid(Vec3::new(0.5, 0.5, 0.2), Vec3::ZERO);
    let hinge = scene.joint(Kind::HINGE, [WORLD, wheel], Vec3::ZERO, Vec3::Z);
    scene.drive(hinge, |drive| (drive.speed, drive.motor_limit) = (10.0, 0.5));
    let about = moment(&scene, wheel, Vec3::Z);
    scene.run(1.0);
    close(scene.spin(wheel).z, 0.5 / about, 1e-2);
    close(scene.world.joints.states[hinge].torque.z, 0.5, 1e-3);
    scene.run(5.0);
    close(scene.spin(wheel).z, 10.0, 1e-3);
    // A brake: friction alone.
    scene.drive(hinge, |drive| (drive.motor_limit, drive.friction) = (0.0, 0.25));
    scene.run(1.0);
    close(scene.spin(wheel).z, 10.0 - 0.25 / about, 2e-2);
    scene.run(10.0);
    assert!(scene.spin(wheel).z.abs() < 1e-4, "{}", scene.spin(wheel));
    // A motor that is too weak for an arm stalls where its torque is that of the weight.
    let mut scene = Scene::new(0.5, 0.0).substeps(8);
    let arm = scene.rod(Vec3::ZERO, -Vec3::Y, 1.0);
    let hinge = scene.joint(Kind::HINGE, [WORLD, arm], Vec3::ZERO, Vec3::Z);
    scene.drive(hinge, |drive| {
        (drive.speed, drive.motor_limit) = (0.1, 0.5 * G * 0.5);
        drive.damping = 0.5;
    });
    scene.run(20.0);
    let at = scene.at(arm);
    close(at.x.atan2(-at.y), (0.5_f32).asin(), 2e-2);
}

/// A torsion spring has the frequency of its stiffness over the moment, and keeps its amplitude; a stiff one does not gain energy.
#[test]
fn torsion_springs_swing() {
    for (w, substeps) in [(10.0_f32, 4), (100.0, 4), (400.0, 4)] {
        let mut scene = Scene::new(0.5, 0.0).weightless().substeps(substeps);
        let wheel = scene.cuboid(Vec3::new(0.5, 0.5, 0.2), Vec3::ZERO);
        let hinge = scene.joint(Kind::HINGE, [WORLD, wheel], Vec3::ZERO, Vec3::Z);
        let about = moment(&scene, wheel, Vec3::Z);
        scene.drive(hinge, |drive| (drive.stiffness, drive.target) = (w * w * about, 0.5));
        let (mut greatest, mut late) = (0.0_f32, 0.0_f32);
        for frame in 0..570 {
            scene.step();
            let turn = scene.world.bodies[wheel].pose.turn;
            let off = (2.0 * turn.z.atan2(turn.w) - 0.5).abs();
            greatest = greatest.max(off);
            if frame >= 500 {
                late = late.max(off);
            }
        }
        eprintln!("w {w}: amplitude {greatest}, at the end {late}");
        assert!(greatest < 0.52, "{greatest}");
        assert!(w > 50.0 || (late - 0.5).abs() < 5e-3, "{late}");
    }
}

/// A joint breaks at the force of statics and not before. Its body falls, and is reported.
#[test]
fn joints_break_at_the_force_of_statics() {
    for (strength, breaks) in [(0.98, true), (1.02, false)] {
        let mut scene = Scene::new(0.5, 0.0);
        let block = scene.cuboid(Vec3::splat(0.5), Vec3::ZERO);
        let joint = scene.joint(Kind::FIXED, [WORLD, block], 0.5 * Vec3::Y, Vec3::X);
        scene.world.joints.list[joint].strength[0] = strength * G;
        let mut broken = 0;
        for _ in 0..60 {
            scene.step();
            broken += scene.last.broken;
        }
        assert_eq!((broken, scene.at(block).y < -1.0), (u32::from(breaks), breaks), "{strength}: {}", scene.at(block));
    }
}

/// A conical pendulum on a rod of fixed length keeps its height and its rate.
#[test]
fn conical_pendulums_keep_their_height() {
    let mut scene = Scene::new(0.5, 0.0).substeps(16);
    let angle = 0.7_f32;
    let at = Vec3::new(angle.sin(), -angle.cos(), 0.0);
    let ball = scene.ball(0.05, at);
    scene.joint_to(Kind::DISTANCE, [WORLD, ball], [Vec3::ZERO, at], Vec3::X);
    let rate = (G / angle.cos()).sqrt();
    scene.throw(ball, Vec3::new(0.0, 0.0, rate * at.x), Vec3::ZERO);
    for _ in 0..300 {
        scene.step();
        close(scene.at(ball).y, at.y, 5e-3);
        close(scene.at(ball).length(), 1.0, 1e-3);
    }
    let load = scene.world.joints.states[0].force.length();
    close(load, G / angle.cos(), 2e-2);
}

/// Atwood's machine without a wheel: sliders of two masses, whose distance joint to a bar on a hinge turns it.
#[test]
fn a_lever_lifts_by_the_ratio_of_its_arms() {
    let mut scene = Scene::new(0.5, 0.0).substeps(8);
    let bar = scene.rod(-1.0 * Vec3::X, 2.0 * Vec3::X, 0.06);
    scene.joint(Kind::HINGE, [WORLD, bar], Vec3::ZERO, Vec3::Z);
    let heavy = scene.body(Shape::ball(0.1), Pose::new(Vec3::new(-1.0, -1.0, 0.0), Quat::IDENTITY), 2.0);
    let light = scene.body(Shape::ball(0.1), Pose::new(Vec3::new(2.0, -1.0, 0.0), Quat::IDENTITY), 0.985);
    scene.joint_to(Kind::DISTANCE, [bar, heavy], [-Vec3::X, Vec3::new(-1.0, -1.0, 0.0)], Vec3::Y);
    scene.joint_to(Kind::DISTANCE, [bar, light], [2.0 * Vec3::X, Vec3::new(2.0, -1.0, 0.0)], Vec3::Y);
    scene.run(3.0);
    assert!(scene.at(heavy).distance(Vec3::new(-1.0, -1.0, 0.0)) < 2e-2, "{}", scene.at(heavy));
    assert!(scene.at(light).distance(Vec3::new(2.0, -1.0, 0.0)) < 2e-2, "{}", scene.at(light));
}

/// Bodies that a joint connects do not collide, unless the joint says so.
#[test]
fn bodies_of_a_joint_do_not_collide() {
    for collides in [false, true] {
        let mut scene = Scene::new(0.0, 0.0).weightless();
        let [a, b] = [0.0, 0.8].map(|x| scene.cuboid(Vec3::splat(0.5), x * Vec3::X));
        let joint = scene.joint(Kind::SLIDER, [a, b], Vec3::new(0.4, 0.0, 0.0), Vec3::X);
        scene.world.joints.list[joint].collides = collides;
        scene.run(2.0);
        let distance = scene.at(a).distance(scene.at(b));
        if collides { assert!(distance > 0.99, "{distance}") } else { close(distance, 0.8, 1e-4) }
    }
}

/// A top whose point is held by a ball joint: the rate of slow precession.
#[test]
fn a_gyroscope_precesses() {
    let mut scene = Scene::new(0.0, 0.0).substeps(16);
    // A disc of 0.5 at 1 from the joint, with its axis level.
    let disc = scene.cuboid(Vec3::new(0.05, 0.4, 0.4), Vec3::X);
    scene.joint(Kind::BALL, [WORLD, disc], Vec3::ZERO, Vec3::X);
    let spin = 60.0;
    let about = moment(&scene, disc, Vec3::X);
    let rate = G / (about * spin);
    scene.throw(disc, Vec3::new(0.0, 0.0, -rate), Vec3::new(spin, rate, 0.0));
    scene.run(2.0);
    let at = scene.at(disc);
    let angle = (-at.z).atan2(at.x);
    let wanted = rate * 2.0;
    eprintln!("precession {angle} of {wanted}, height {}", at.y);
    assert!((angle - wanted).abs() < 0.05 * wanted && at.y.abs() < 0.05, "{angle} of {wanted}, {at}");
    assert!(wanted < FRAC_PI_2 * 4.0);
}

/// A light hub of many heavy bodies does not gain energy.
#[test]
fn light_hubs_of_heavy_bodies_are_stable() {
    for (count, hub, kind) in
        [(4, 0.01, Kind::BALL), (6, 0.1, Kind::FIXED), (8, 0.1, Kind::BALL), (20, 1.0, Kind::HINGE), (40, 1.0, Kind::BALL)]
    {
        let mut scene = Scene::new(0.5, 0.0).weightless();
        let mut random = Random(5);
        let middle = scene.body(Shape::ball(0.3), Pose::IDENTITY, hub);
        for _ in 0..count {
            let direction = random.vector().normalize();
            let ball = scene.body(Shape::ball(0.05), Pose::new(direction, Quat::IDENTITY), 1.0);
            scene.throw(ball, random.vector(), Vec3::ZERO);
            scene.joint(kind, [middle, ball], 0.3 * direction, random.vector());
        }
        for (group, collider) in (0..).zip(&mut scene.world.colliders) {
            collider.group.own = group;
        }
        scene.run(0.5);
        let first = kinetic_energy(&scene.world);
        let (mut highest, mut open) = (0.0_f64, 0.0_f32);
        for _ in 0..600 {
            scene.step();
            highest = highest.max(kinetic_energy(&scene.world));
            open = (0..count).map(|joint| scene.opening(joint)).fold(open, f32::max);
        }
        eprintln!("{count} at {hub}: E {highest:.4} and {:.4} of {first:.4}, open by {open}", kinetic_energy(&scene.world));
        assert!(highest < 1.05 * first && open < 0.2, "{count} bodies at a hub of {hub}: {highest} of {first}, open by {open}");
    }
}

/// Stiff drives of an arm, of a chain of arms and of a slider come to rest at their targets, and do not gain energy.
#[test]
fn stiff_drives_hold_their_targets() {
    for (kind, stiffness) in
        [(Kind::HINGE, 1e3), (Kind::HINGE, 1e5), (Kind::HINGE, 1e7), (Kind::SLIDER, 1e3), (Kind::SLIDER, 1e6)]
    {
        let mut scene = Scene::new(0.5, 0.0).weightless();
        let mut before = WORLD;
        let mut stored = 0.0;
        for k in 0..3 {
            let at = k as f32 * Vec3::X;
            let next = scene.rod(at, at + Vec3::X, 1.0);
            let joint = scene.joint(kind, [before, next], at, Vec3::Z);
            let target = 0.1 + 0.05 * k as f32;
            scene.drive(joint, |drive| (drive.stiffness, drive.target) = (stiffness, target));
            stored += 0.5 * stiffness * target * target;
            before = next;
        }
        let mut highest = 0.0_f64;
        for _ in 0..600 {
            scene.step();
            highest = highest.max(kinetic_energy(&scene.world));
        }
        let off = motions_of_joints(&scene.world);
        eprintln!(
            "{kind:?} {stiffness:.0e}: E {highest:.3} of {stored:.3}, then {:.1e}, {off:?}",
            kinetic_energy(&scene.world)
        );
        assert!(highest < 1.1 * f64::from(stored), "{kind:?} {stiffness}: {highest} of {stored}");
        if stiffness > 1e4 {
            for (k, motion) in off.iter().enumerate() {
                close(motion.position, 0.1 + 0.05 * k as f32, 1e-3);
            }
        }
    }
}
