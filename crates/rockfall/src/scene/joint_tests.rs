use std::f32::consts::FRAC_PI_2;

use glam::{DVec3, Quat, Vec3};

use super::*;
use crate::error::BadStage;
use crate::scene::{Capsule, ObjectId, Placement, Rod, Scene, Shape, Sphere, Tag};
use crate::settings::ContactLaw;
use crate::{Backend, Checkpoint, Options, Simulation};

/// Two bars, the second one named `door`, and two spheres of which the second one is fixed.
fn sample() -> (Scene, [RigidBodyId; 2], [SphereId; 2]) {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::Rigid;
    let shape = scene.add_shape(Shape::new().sphere([0.0; 3], 0.5).sphere([1.0, 0.0, 0.0], 0.5)).unwrap();
    let bodies = [0.0, 3.0].map(|x| scene.add_body(Placement::new(shape).at([x, 1.0, 0.0])).unwrap());
    scene.set_tag(bodies[1], Tag::new().name("door")).unwrap();
    let ball = scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.5)).unwrap();
    let nail = scene.add_sphere(Sphere::new([2.0, 5.0, 0.0], 0.5).fixed()).unwrap();
    (scene, bodies, [ball, nail])
}

#[test]
fn ends_follow_their_bodies() {
    let (mut scene, [a, b], [ball, nail]) = sample();
    let at = DVec3::new(2.0, 1.0, 0.5);
    let hinge = scene.add_joint(Joint::hinge(a, b, at, [0.0, 2.0, 0.0])).unwrap();
    let link = scene.add_joint(Joint::distance(ball, nail, [0.0, 5.0, 0.5], [2.0, 5.0, 0.5])).unwrap();
    let [one, other] = scene.joint(hinge).unwrap().ends().unwrap();
    // From the centres of mass, which are at 0.5 and 3.5.
    assert_eq!((one.place, other.place), (Vec3::new(1.5, 0.0, 0.5), Vec3::new(-1.5, 0.0, 0.5)));
    assert!((one.turn * Vec3::X).distance(Vec3::Y) < 1e-6 && one.turn == other.turn, "{one:?}");
    // Those of loose spheres begin at the sphere, those of fixed ones at the origin.
    let [one, other] = scene.joint(link).unwrap().ends().unwrap();
    assert_eq!((one.place, other.place), (Vec3::new(0.0, 0.0, 0.5), Vec3::new(2.0, 5.0, 0.5)));
    assert_eq!(scene.joint(link).unwrap().length, Some(2.0));

    scene.update_body(b, |body| body.orientation = Quat::from_rotation_y(FRAC_PI_2)).unwrap();
    let [one, other] = scene.joint_anchors(hinge).unwrap();
    assert!(one.distance(at.as_vec3()) < 1e-6 && other.distance(Vec3::new(4.0, 1.0, 1.5)) < 1e-6, "{one} {other}");
}

/// A sphere of a rigid body stands for the body.
#[test]
fn a_sphere_of_a_body_is_the_body() {
    let (mut scene, [a, b], _) = sample();
    let of_a = scene.body(a).unwrap().spheres()[1];
    let id = scene.add_joint(Joint::ball(of_a, b, [2.0, 1.0, 0.0])).unwrap();
    assert_eq!(scene.joint(id).unwrap().anchors(), [Anchor::Body(a), Anchor::Body(b)]);
    let error = scene.add_joint(Joint::ball(of_a, a, [2.0, 1.0, 0.0])).unwrap_err().to_string();
    assert_eq!(error, "joint.b: rigid body number 0 is not allowed, expected another body than a");
}

#[test]
fn wrong_joints_are_refused() {
    let (mut scene, [a, b], [_, nail]) = sample();
    let other = Scene::new().add_sphere(Sphere::new([0.0; 3], 1.0)).unwrap();
    let at = [2.0, 1.0, 0.0];
    let hinge = || Joint::hinge(a, b, at, [0.0, 1.0, 0.0]);
    let ball = || Joint::ball(a, b, at);
    let fixed = || Joint::fixed(a, b, at);
    let link = || Joint::distance(a, b, at, [2.0, 4.0, 0.0]);
    let frame = JointFrame { place: Vec3::ZERO, turn: Quat::IDENTITY };
    scene.add_joint(ball().name("taken")).unwrap();
    for (joint, message) in [
        (Joint::ball(b, b, at), "joint.b: rigid body number 1 ('door') is not allowed, expected another body than a"),
        (Joint::ball(Anchor::World, nail, at), "joint.b: the world and sphere"),
        (Joint::ball(a, other, at), "the sphere is not in the scene"),
        (Joint::ball(a, b, [f64::NAN, 0.0, 0.0]), "joint.at: [NaN, 0.0, 0.0] is not allowed, expected three finite numbers"),
        (Joint::distance(a, b, at, [1e39, 0.0, 0.0]), "joint.to: [inf, 0.0, 0.0] is not allowed"),
        (ball().axis([0.0; 3]), "joint.axis: [0.0, 0.0, 0.0] is not allowed, expected a direction, not 0"),
        (link().axis([1.0, 0.0, 0.0]), "joint.axis: [1.0, 0.0, 0.0] is not allowed, expected none"),
        (fixed().axis([1.0, 0.0, 0.0]), "joint.axis: [1.0, 0.0, 0.0] is not allowed, expected none"),
        (ball().frames([frame, JointFrame { turn: Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..frame }]), "joint.turn: [2.0, 0.0"),
        (ball().frames([JointFrame { place: Vec3::NAN, ..frame }, frame]), "joint.place: [NaN, NaN, NaN] is not allowed"),
        (hinge().limits(0.5, 0.25), "joint.limits: [0.5, 0.25] is not allowed, expected two finite numbers in ascending order"),
        (hinge().limits(0.0, f32::INFINITY), "joint.limits: [0.0, inf] is not allowed"),
        (hinge().limits(0.25, 0.5), "joint.limits: [0.25, 0.5] is not allowed, expected a range that contains 0"),
        (hinge().limits(-4.0, 4.0), "joint.limits: [-4.0, 4.0] is not allowed, expected a range of at most one turn"),
        (link().limits(0.0, 2.0), "joint.limits: [0.0, 2.0] is not allowed, expected a range that contains the distance"),
        (link().limits(-1.0, 5.0), "joint.limits: [-1.0, 5.0] is not allowed, expected distances, not negative"),
        (link().length(-1.0), "joint.length: -1.0 is not allowed"),
        (ball().cone(4.0), "joint.cone: 4.0 is not allowed, expected an angle from 0 to half a turn"),
        (ball().cone(f32::NAN), "joint.cone: NaN is not allowed"),
        (hinge().cone(1.0), "joint.cone: 1.0 is not allowed, expected nothing in a hinge"),
        (ball().length(1.0), "joint.length: 1.0 is not allowed, expected nothing in a ball joint"),
        (fixed().limits(0.0, 1.0), "joint.limits: 0.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().motor(1.0), "joint.speed: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().spring(1.0, 0.0), "joint.stiffness: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().spring(0.0, 1.0), "joint.damping: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().friction(1.0), "joint.friction: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().target(1.0), "joint.target: 1.0 is not allowed, expected nothing in a fixed joint"),
        (hinge().motor(f32::INFINITY), "joint.speed: inf is not allowed, expected a finite number"),
        (hinge().spring(1.0, 0.0).target(f32::NAN), "joint.target: NaN is not allowed"),
        (link().spring(1.0, 0.0).target(-1.0), "joint.target: -1.0 is not allowed, expected a finite number, not negative"),
        (hinge().spring(0.0, 1.0).target(1.0), "joint.target: 1.0 is not allowed, expected a target together with a stiffness"),
        (hinge().spring(-1.0, 0.0), "joint.stiffness: -1.0 is not allowed"),
        (hinge().spring(1.0, -1.0), "joint.damping: -1.0 is not allowed"),
        (hinge().friction(f32::INFINITY), "joint.friction: inf is not allowed"),
        (hinge().motor(1.0).max_force(-1.0), "joint.max_force: -1.0 is not allowed"),
        (fixed().max_force(1.0), "joint.max_force: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().effort(1.0), "joint.effort: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().drag(1.0), "joint.drag: 1.0 is not allowed, expected nothing in a fixed joint"),
        (fixed().armature(1.0), "joint.armature: 1.0 is not allowed, expected nothing in a fixed joint"),
        (hinge().effort(f32::INFINITY), "joint.effort: inf is not allowed, expected a finite number"),
        (hinge().drag(-1.0), "joint.drag: -1.0 is not allowed"),
        (hinge().armature(f32::NAN), "joint.armature: NaN is not allowed"),
        (hinge().breaks_at(0.0, 1.0), "joint.break_force: 0.0 is not allowed"),
        (hinge().breaks_at(1.0, f32::NAN), "joint.break_torque: NaN is not allowed"),
        (hinge().name("a b"), "joint.name: 'a b' is not allowed, expected one word"),
        (hinge().name("taken"), "joint.name: 'taken' is not allowed, expected a name that no other joint has"),
    ] {
        let error = scene.add_joint(joint.clone()).unwrap_err().to_string();
        assert!(error.contains(message), "{joint:?}\n{error}");
    }
    assert_eq!(scene.joints().len(), 1);
}

#[test]
fn joints_are_found_and_changed() {
    let (mut scene, [a, b], _) = sample();
    let joint = Joint::hinge(a, b, [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]).name("knee").limits(-1.0, 1.0);
    let id = scene.add_joint(joint.colliding()).unwrap();
    assert_eq!((scene.joint_named("knee").unwrap(), scene.joint_ids().collect::<Vec<_>>()), (id, vec![id]));
    assert!(scene.joint_named("knees").unwrap_err().to_string().contains("did you mean 'knee'?"));

    let before = scene.joint(id).unwrap().clone();
    scene
        .update_joint(id, |joint| {
            (joint.speed, joint.max_force, joint.limits) = (Some(2.0), 5.0, Some([0.5, 1.0]));
            (joint.kind, joint.b, joint.collides, joint.name) = (JointKind::Ball, Anchor::World, false, None);
        })
        .unwrap();
    let expected = Joint { speed: Some(2.0), max_force: 5.0, limits: Some([0.5, 1.0]), ..before };
    assert_eq!(scene.joint(id).unwrap(), &expected);
    assert!(scene.update_joint(id, |joint| joint.stiffness = -1.0).is_err());
    assert_eq!(scene.joint(id).unwrap(), &expected);
    assert!(expected.rest() == 0.0 && !expected.has_spring() && !expected.is_locked());
}

#[test]
fn distance_joints_are_locked_unless_something_acts() {
    let (_, [a, b], _) = sample();
    let link = || Joint::distance(a, b, [0.0; 3], [2.0, 0.0, 0.0]);
    assert!(link().is_locked() && link().breaks_at(1.0, 1.0).is_locked());
    let others =
        [link().limits(0.0, 3.0), link().motor(1.0), link().spring(1.0, 0.0), link().spring(0.0, 1.0), link().friction(1.0)];
    assert!(others.iter().all(|joint| !joint.is_locked()));
}

#[test]
fn joints_go_with_their_bodies() {
    let (mut scene, [a, b], [ball, nail]) = sample();
    let at = [2.0, 1.0, 0.0];
    let joints = [
        Joint::ball(a, b, at),
        Joint::ball(Anchor::World, b, at),
        Joint::ball(ball, a, at),
        Joint::ball(nail, a, at),
        Joint::ball(Anchor::World, a, at),
    ];
    let ids = joints.map(|joint| scene.add_joint(joint).unwrap());
    let left = |scene: &Scene| ids.iter().map(|id| scene.joint(*id).is_ok()).collect::<Vec<_>>();
    let mut bare = scene.clone();
    scene.remove_sphere(ball).unwrap();
    assert_eq!(left(&scene), [true, true, false, true, true]);
    scene.remove_body(b).unwrap();
    assert_eq!(left(&scene), [false, false, false, true, true]);
    scene.remove_joint(ids[3]).unwrap();
    assert_eq!(left(&scene), [false, false, false, false, true]);
    assert!(scene.remove_joints(&[ids[4], ids[3]]).is_err());
    assert_eq!(scene.joints().len(), 1);
    bare.remove_bodies(&[a, b]).unwrap();
    assert!(bare.joints().is_empty());
}

#[test]
fn only_the_law_rigid_has_joints() {
    let (mut scene, [a, b], _) = sample();
    let integrator = scene.integrator(Default::default());
    scene.add_joint(Joint::ball(a, b, [2.0, 1.0, 0.0]).name("hip")).unwrap();
    scene.check_contact_law(integrator).unwrap();
    scene.settings.contact_law = ContactLaw::Thesis;
    let error = scene.check_contact_law(integrator).unwrap_err().to_string();
    let expected = "thesis with a joint ('hip') is not allowed, expected rigid: joints need `set contact_law rigid`";
    assert!(error.ends_with(expected), "{error}");
    assert!(Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).is_err());
}

/// A capsule moves as a body from the first step on, whose orientation its spheres get. Its joint stays where it is.
#[test]
fn joints_of_capsules_stay_in_their_places() {
    let (mut scene, [a, _], _) = sample();
    let capsule = scene.add_capsule(Capsule::new([5.0, 0.0, 0.0], [5.0, 2.0, 0.0], 0.25)).unwrap();
    let parts = *scene.capsule(capsule).unwrap();
    let id = scene.add_joint(Joint::hinge(a, parts.end2, [4.0, 3.0, 0.5], [0.0, 0.0, 1.0])).unwrap();
    scene.imply_bodies();
    assert!(scene.sphere(parts.end2).unwrap().orientation.angle_between(Quat::IDENTITY) > 0.1);
    let joint = scene.joint(id).unwrap();
    let [(one, turn), (other, other_turn)] = scene.joint_poses_of(joint, true).unwrap();
    assert!(one.distance(other) < 1e-6 && turn.angle_between(other_turn) < 1e-6, "{one} {other} {turn} {other_turn}");

    let mut stiff = scene.clone();
    stiff.add_joint(Joint::ball(parts.end1, parts.end2, [5.0, 1.0, 0.0])).unwrap();
    let error = stiff.check_joints().unwrap_err().to_string();
    assert!(error.contains("expected spheres that rods do not hold together"), "{error}");
    // Another rod changes nothing.
    scene.add_rod(Rod::new(parts.end1, parts.end2, 0.1)).unwrap();
    scene.check_joints().unwrap();
}

/// Makes a joint of the spheres of two capsules.
type Join = fn([SphereId; 2], [SphereId; 2]) -> Joint;

/// Whichever sphere of a capsule has the joint, its bodies overlap without a warning, unless they collide.
#[test]
fn joined_capsules_may_overlap() {
    let of = |joint: Option<Join>| {
        let mut scene = Scene::new();
        scene.settings.contact_law = ContactLaw::Rigid;
        let mut capsule = |from: [f32; 3], to: [f32; 3]| {
            let id = scene.add_capsule(Capsule::new(from, to, 0.25)).unwrap();
            let parts = *scene.capsule(id).unwrap();
            [parts.end1, parts.end2]
        };
        let (one, other) = (capsule([0.0; 3], [0.0, 2.0, 0.0]), capsule([0.1, 2.0, 0.0], [2.0, 2.0, 0.0]));
        if let Some(joint) = joint {
            scene.add_joint(joint(one, other)).unwrap();
        }
        scene.overlap_concern()
    };
    assert!(of(None).is_some_and(|concern| concern.contains("overlap")));
    assert_eq!(of(Some(|one, other| Joint::ball(one[1], other[0], [0.0, 2.0, 0.0]))), None);
    assert_eq!(of(Some(|one, other| Joint::ball(one[0], other[1], [0.0, 2.0, 0.0]))), None);
    assert!(of(Some(|one, other| Joint::ball(one[1], other[0], [0.0, 2.0, 0.0]).colliding())).is_some());
}

#[test]
fn messages_of_states_that_are_not_finite_name_joints() {
    let (scene, _, _) = sample();
    let error = Error::NonFinite { sphere: 0, step: 3, stage: BadStage::Forces1 };
    assert!(error.describe(&scene).contains("; a spring or the contact force may"), "{}", error.describe(&scene));
    let told = error.describe(&rich());
    assert!(told.contains("; a joint, a spring or the contact force may be too stiff for the time step"), "{told}");
}

/// Joints of all kinds, with everything that they can have.
fn rich() -> Scene {
    let (mut scene, [a, b], [ball, nail]) = sample();
    let at = [2.0, 1.0, 0.3];
    let hinge = Joint::hinge(a, b, at, [1.0, 2.0, -1.0]).limits(-0.7, 0.9).motor(-3.0).max_force(7.0).friction(0.1);
    scene.add_joint(hinge.name("knee").breaks_at(100.0, 20.0)).unwrap();
    scene.add_joint(Joint::slider(Anchor::World, b, at, [0.0, 0.0, 1.0]).spring(10.0, 0.5).target(0.25).colliding()).unwrap();
    scene.add_joint(Joint::ball(ball, a, [0.0, 4.0, 0.1]).cone(0.6).limits(-0.1, 0.2).axis([0.0, -1.0, 0.0])).unwrap();
    scene.add_joint(Joint::fixed(a, nail, [1.0, 3.0, 0.0])).unwrap();
    scene.add_joint(Joint::distance(nail, ball, [2.0, 5.0, 0.1], [0.0, 5.0, 0.0]).limits(0.5, 3.0)).unwrap();
    scene
}

#[test]
fn checkpoints_have_the_joints() {
    let mut simulation = Simulation::with_options(rich(), Options::new().backend(Backend::Cpu)).unwrap();
    let checkpoint = simulation.checkpoint().unwrap();
    let bytes = checkpoint.to_bytes();
    let read = Checkpoint::from_bytes(&bytes, "file.ckpt").unwrap();
    assert_eq!(read.to_bytes(), bytes);
    assert_eq!(read.scene.to_text(), checkpoint.scene.to_text());
    let plain = |scene: &Scene| {
        let joint = |joint: &Joint| Joint { a: Anchor::World, b: Anchor::World, ..joint.clone() };
        scene.joints().iter().map(joint).collect::<Vec<_>>()
    };
    assert_eq!((plain(&read.scene).len(), plain(&read.scene)), (5, plain(&checkpoint.scene)));
    let ends: Vec<_> = read.scene.joints().iter().flat_map(Joint::anchors).collect();
    let bodies: Vec<Anchor> = read.scene.body_ids().map(Anchor::from).collect();
    let spheres: Vec<Anchor> = read.scene.sphere_ids().map(Anchor::from).collect();
    let (a, b, ball, nail) = (bodies[0], bodies[1], spheres[4], spheres[5]);
    assert_eq!(ends, [a, b, Anchor::World, b, ball, a, a, nail, nail, ball]);
    assert!(matches!(read.scene.named("door").unwrap()[..], [.., ObjectId::Body(id)] if Anchor::from(id) == b));
}
