//! Picking and holding bodies, and mouse drags.

use rockfall::Body;
use rockfall::glam::{Vec2, Vec3};
use rockfall_viewer::window::controls::{Controls, Modifiers};
use rockfall_viewer::window::hold::Sight;
use rockfall_viewer::window::session::Session;
use rockfall_viewer::window::viewer::{Button, Viewer};

use crate::common::*;

/// Returns a line of sight from 10 units in front of a sphere's centre towards it.
pub(crate) fn sight_of(session: &mut Session, sphere: usize) -> Sight {
    let centre = session.simulation().spheres().expect("spheres are read")[sphere].position;
    Sight { origin: centre + 10.0 * Vec3::Z, direction: Vec3::NEG_Z, forward: Vec3::NEG_Z }
}

fn positions(session: &mut Session) -> Vec<Vec3> {
    session.simulation().spheres().expect("spheres are read").iter().map(|sphere| sphere.position).collect()
}

/// Returns the position of a point of the scene in the picture, in pixels.
fn pixel(viewer: &Viewer, point: Vec3) -> Vec2 {
    let ndc = viewer.camera.view_projection(viewer.aspect()).project_point3(point);
    (Vec2::new(ndc.x, -ndc.y) + 1.0) * 0.5 * viewer.size()
}

#[test]
fn only_the_held_body_follows_the_pointer() {
    let mut session = session(FLOATING);
    let sight = sight_of(&mut session, 0);
    session.hold(&sight);
    assert!(session.held().is_some());
    // Three units up and one to the left, at the same depth.
    let moved = Sight { origin: sight.origin, direction: Vec3::new(-1.0, 3.0, -9.5).normalize(), forward: sight.forward };
    session.drag(&moved);
    session.set_running(true);
    for frame in 0..200 {
        session.frame(f64::from(frame) * 0.02, 0.02, |_| ());
    }
    let now = positions(&mut session);
    assert!(now[0].distance(Vec3::new(-3.0, 3.0, 0.0)) < 0.02, "{}", now[0]);
    assert_eq!(now[1], Vec3::new(2.0, 0.0, 0.0));
    session.release();
    assert!(session.held().is_none());
    assert_eq!(session.simulation().scene().counts().tethers, 0);
}

/// A held body hangs still below the pointer, whatever the time step.
#[test]
fn holding_is_stable() {
    for time_step in [0.001, 0.02, 0.05] {
        let mut session = session("set gravity 5\nS 1 0 9 0 0 0 0 0 0 0 1 0.5\n");
        session.set_time_step(time_step);
        let sight = sight_of(&mut session, 0);
        session.hold(&sight);
        session.set_running(true);
        let steps = (4.0 / time_step) as u32;
        (0..steps).for_each(|_| session.frame(0.0, 0.0, |_| ()));
        // It hangs m g / k = 5 / 100 below the pointer.
        let height = heights(&mut session)[0];
        assert!((height - 8.95).abs() < 1e-3, "{height} at a time step of {time_step}");
    }
}

/// A tether damps only along itself. A body that moves across it would circle around the pointer.
#[test]
fn a_held_body_comes_to_rest_under_the_pointer() {
    let mut session = session("set gravity 0\nS 1 0 0 0 0 6 0 0 0 0 1 0.5\n");
    let sight = sight_of(&mut session, 0);
    session.hold(&sight);
    let moved = Sight { origin: sight.origin + 2.0 * Vec3::X, ..sight };
    session.drag(&moved);
    session.set_running(true);
    (0..75).for_each(|_| session.frame(0.0, 0.0, |_| ()));
    let place = positions(&mut session)[0];
    assert!(place.distance(Vec3::new(2.0, 0.0, 0.0)) < 0.01, "{place}");
}

/// A capsule that is held at one end hangs below the pointer and does not swing on.
#[test]
fn a_held_capsule_comes_to_rest_below_the_pointer() {
    let mut session = session("set gravity 9.81\nC 0 5 0 2 5 0 0 0 0 1 0.2\n");
    let sight = Sight { origin: Vec3::new(0.0, 5.0, 9.0), direction: Vec3::NEG_Z, forward: Vec3::NEG_Z };
    session.hold(&sight);
    session.set_running(true);
    (0..250).for_each(|_| session.frame(0.0, 0.0, |_| ()));
    let [one, two] = positions(&mut session)[..] else { panic!("two ends") };
    assert!(one.x.abs() < 0.02 && two.x.abs() < 0.02 && two.y < one.y - 1.9, "{one} {two}");
}

/// Under the law `rigid` a box hangs from the point that was picked, and the pointer takes this point along.
#[test]
fn a_box_is_held_at_the_point_that_was_picked() {
    let shape = "@body box mass=3\nB -1 -0.5 -0.5  2 0 0  0 1 0  0 0 1\n@end\n";
    let mut session = session(&format!("set contact_law rigid\nset gravity 9.81\n{shape}@place box at=0,5,0\n"));
    let sight = Sight { origin: Vec3::new(0.9, 5.0, 9.0), direction: Vec3::NEG_Z, forward: Vec3::NEG_Z };
    session.hold(&sight);
    assert!(session.held().is_some());
    assert_eq!(session.simulation().scene().counts().tethers, 0);
    session.drag(&Sight { origin: sight.origin + 2.0 * Vec3::Y, ..sight });
    session.set_running(true);
    (0..400).for_each(|_| session.frame(0.0, 0.0, |_| ()));
    let place = session.simulation().sync().expect("states").bodies()[0].position;
    let below = Vec3::new(0.9, 7.0 - Vec3::new(0.9, 0.0, 0.5).length(), 0.5);
    assert!(place.distance(below) < 0.02, "{place} {below}");
    session.release();
    (0..30).for_each(|_| session.frame(0.0, 0.0, |_| ()));
    let place = session.simulation().sync().expect("states").bodies()[0].position;
    assert!(place.y < below.y - 0.5, "{place}");
}

/// Ten balls are connected by springs. The held one carries all of them.
#[test]
fn a_held_body_carries_the_bodies_connected_to_it() {
    let mut text = "set gravity 1\n".to_owned();
    for ball in 0..10 {
        text += &format!("S {ball} 0 {} 0 0 0 0 0 0 0 1 0.2\n", 20 - ball);
    }
    for ball in 1..10 {
        text += &format!("K {} {ball} 500 1 5\n", ball - 1);
    }
    let mut session = session(&text);
    let sight = sight_of(&mut session, 0);
    session.hold(&sight);
    session.set_running(true);
    (0..1000).for_each(|_| session.frame(0.0, 0.0, |_| ()));
    let heights = heights(&mut session);
    assert!((heights[0] - 20.0).abs() < 0.05, "{heights:?}");
}

/// Rods and springs cannot follow the pointer beyond their reach. They hold, and come to rest.
#[test]
fn a_pull_beyond_the_reach_of_a_network_does_not_overload_it() {
    let bridge = include_str!("../../../../scenes/bridge.txt");
    let cube = include_str!("../../../../scenes/soft-cube.txt");
    let ways = [Vec3::new(1.0, 3.0, 0.0), Vec3::new(-30.0, 20.0, -10.0), Vec3::new(0.0, -9.0, 3.0)];
    for (text, held, connected) in [(bridge, 9, 2..16), (cube, 60, 0..125)] {
        for way in ways {
            let mut session = session(text);
            session.set_running(true);
            (0..100).for_each(|_| session.frame(0.0, 0.0, |_| ()));
            let sight = sight_of(&mut session, held);
            session.hold(&sight);
            session.drag(&Sight { origin: sight.origin + way, ..sight });
            let mut fastest = 0.0_f32;
            let mut speeds = Vec::new();
            for _ in 0..1200 {
                session.frame(0.0, 0.0, |_| ());
                let spheres = session.simulation().spheres().expect("spheres are read");
                speeds = spheres[connected.clone()].iter().map(|sphere| sphere.velocity.length()).collect();
                fastest = speeds.iter().copied().fold(fastest, f32::max);
            }
            let last = speeds.iter().copied().fold(0.0, f32::max);
            assert!(fastest < 10.0 && last < 1.0, "{way}: {fastest} units/s, {last} at the end");
        }
    }
}

#[test]
fn bodies_that_cannot_be_held_give_a_message() {
    let mut session = session("S 1 0 0 0 0 0 0 0 0 0 1 0.5 1\nB 5 -1 -1 2 0 0 0 2 0 0 0 2\n");
    let sight = sight_of(&mut session, 0);
    session.hold(&sight);
    assert!(session.held().is_none() && messages(&session)[0].contains("fixed"));
    session.hold(&Sight { origin: Vec3::new(6.0, 0.0, 9.0), ..sight });
    assert!(session.held().is_none() && messages(&session)[0].contains("never move"));
    session.hold(&Sight { origin: Vec3::new(90.0, 0.0, 9.0), ..sight });
    assert!(session.held().is_none());
}

/// A fixed end is never held.
#[test]
fn a_rod_is_held_at_its_nearer_end() {
    let text =
        |fixed: u8| format!("set gravity 0\nS 1 -3 0 0 0 0 0 0 0 0 1 0.1 {fixed}\nS 2 3 0 0 0 0 0 0 0 0 1 0.1\nR 1 2 0.3 6\n");
    for (fixed, at, held) in [(0, -1.0, 0), (0, 1.0, 1), (1, -1.0, 1)] {
        let mut session = session(&text(fixed));
        session.hold(&Sight { origin: Vec3::new(at, 0.0, 9.0), direction: Vec3::NEG_Z, forward: Vec3::NEG_Z });
        let ids: Vec<_> = session.simulation().scene().sphere_ids().collect();
        assert_eq!(session.held().map(|held| held.sphere), Some(ids[held]));
    }
}

#[test]
fn a_click_picks_a_body_and_shows_its_values() {
    let mut viewer = viewer(BALL);
    let at = pixel(&viewer, Vec3::new(0.0, 3.0, 0.0));
    viewer.point(Some(at));
    viewer.press(Button::Left, NONE);
    viewer.point(Some(at + 1.0));
    viewer.release(Button::Left, 0.0);
    assert!(matches!(viewer.session.picked(), Some(Body::Sphere(_))));
    let facts = viewer.session.watch.facts().expect("facts").clone();
    assert_eq!(facts.title, "sphere 1");
    let value = |name: &str| facts.values.iter().find(|(at, _)| *at == name).expect("a value").1.clone();
    assert_eq!(value("position"), "0.000 3.000 0.000 units");
    assert_eq!(value("net force"), "0.000 -1.000 0.000 mass units/s²");
    assert_eq!(value("contacts"), "0");
    // A click on the background picks nothing.
    viewer.point(Some(Vec2::new(2.0, 2.0)));
    viewer.press(Button::Left, NONE);
    viewer.release(Button::Left, 0.0);
    assert_eq!((viewer.session.picked(), viewer.session.watch.facts()), (None, None));
}

/// The force on a hanging ball has that of its rod, and follows gravity while the simulation is paused.
#[test]
fn the_net_force_of_a_picked_body_is_that_of_the_present_constants() {
    let hanging = "set gravity 10\nS 1 0 5 0 0 0 0 0 0 0 1 0.1 1\nS 2 0 4 0 0 0 0 0 0 0 2 0.1 0\nR 1 2 0.05 1\n";
    let force = |session: &Session| {
        let facts = session.watch.facts().expect("facts");
        facts.values.iter().find(|(name, _)| *name == "net force").expect("a force").1.clone()
    };
    let mut held = session(hanging);
    let ball = held.simulation().scene().sphere_ids().nth(1).expect("a ball");
    held.set_picked(Some(Body::Sphere(ball)));
    assert_eq!(force(&held).replace('-', ""), "0.000 0.000 0.000 mass units/s²");
    let mut free = session(BALL);
    let ball = free.simulation().scene().sphere_ids().next().expect("a ball");
    free.set_picked(Some(Body::Sphere(ball)));
    free.sample(false);
    free.change_settings(|settings| settings.gravity = 4.0);
    free.frame(2.0, 0.0, |_| ());
    free.sample(false);
    assert_eq!(force(&free), "0.000 -4.000 0.000 mass units/s²");
    assert_eq!(free.watch.energies().len(), 1);
}

/// Drags from the middle of the picture by 30 pixels to the right and 50 up.
fn drag(viewer: &mut Viewer, button: Button, held: Modifiers) {
    let start = Vec2::new(400.0, 300.0);
    viewer.point(Some(start));
    viewer.press(button, held);
    for step in 1..=10 {
        viewer.point(Some(start + step as f32 * Vec2::new(3.0, -5.0)));
    }
    viewer.release(button, 0.0);
}

#[test]
fn drags_move_the_camera_but_pick_nothing() {
    let [alt, shift] = [Modifiers { alt: true, ..NONE }, Modifiers { shift: true, ..NONE }];
    // Which of target, eye and direction move.
    let cases = [
        (Controls::Standard, Button::Left, NONE, [false, true, true]),
        (Controls::Standard, Button::Left, alt, [true, true, false]),
        (Controls::Standard, Button::Left, shift, [true, true, false]),
        (Controls::Standard, Button::Right, NONE, [true, true, false]),
        (Controls::Standard, Button::Right, alt, [false, true, false]),
        (Controls::Standard, Button::Middle, NONE, [true, true, false]),
        (Controls::Thesis, Button::Left, NONE, [true, false, true]),
        (Controls::Thesis, Button::Right, NONE, [true, true, false]),
        (Controls::Thesis, Button::Middle, NONE, [false, true, true]),
    ];
    for (controls, button, held, expected) in cases {
        let mut viewer = viewer(BALL);
        viewer.controls = controls;
        let before = viewer.camera;
        drag(&mut viewer, button, held);
        let after = viewer.camera;
        let moved = [
            after.target.distance(before.target) > 1e-3,
            after.eye.distance(before.eye) > 1e-3,
            (after.axes().forward - before.axes().forward).length() > 1e-3,
        ];
        assert_eq!(moved, expected, "{controls} {button:?} {held:?}");
        assert_eq!(viewer.session.picked(), None);
        // After the release the pointer moves nothing.
        viewer.point(Some(Vec2::new(100.0, 100.0)));
        assert_eq!(viewer.camera, after);
    }
}

/// The picture follows the pointer in every drag of the standard controls.
#[test]
fn the_picture_follows_the_pointer() {
    for button in [Button::Left, Button::Right, Button::Middle] {
        let mut viewer = viewer(BALL);
        // The side of the ball that faces the camera.
        let ball = Vec3::new(0.0, 3.0, 0.0);
        let front = ball + 0.5 * (viewer.camera.eye - ball).normalize();
        let before = pixel(&viewer, front) - if button == Button::Left { pixel(&viewer, ball) } else { Vec2::ZERO };
        drag(&mut viewer, button, NONE);
        let moved = pixel(&viewer, front) - if button == Button::Left { pixel(&viewer, ball) } else { Vec2::ZERO } - before;
        assert!(moved.x > 0.0 && moved.y < 0.0, "{button:?}: {moved}");
    }
}

#[test]
fn the_wheel_zooms_to_the_body_under_the_pointer_and_not_through_it() {
    let mut viewer = viewer(FLOATING);
    let ball = Vec3::new(2.0, 0.0, 0.0);
    let at = pixel(&viewer, ball);
    viewer.point(Some(at));
    let before = viewer.camera.eye.distance(ball);
    viewer.scroll(4.0);
    assert!(pixel(&viewer, ball).distance(at) < 20.0, "{} was at {at}", pixel(&viewer, ball));
    assert!(viewer.camera.eye.distance(ball) < 0.7 * before);
    for _ in 0..100 {
        viewer.scroll(5.0);
    }
    let distance = viewer.camera.eye.distance(ball);
    assert!(distance > 0.6 && distance < 1.2, "the camera is {distance} from the middle of the ball");
    for _ in 0..200 {
        viewer.scroll(-5.0);
    }
    let far = viewer.camera.eye.length();
    assert!(far < 100.0 && viewer.camera.target.length() < 4.0, "the scene is out of sight: {far}");
}

#[test]
fn a_double_click_moves_the_camera_to_a_body() {
    let mut viewer = viewer(FLOATING);
    let ball = Vec3::new(2.0, 0.0, 0.0);
    let at = pixel(&viewer, ball);
    let click = |viewer: &mut Viewer, now: f64| {
        viewer.point(Some(at));
        viewer.press(Button::Left, NONE);
        viewer.release(Button::Left, now);
    };
    let before = viewer.camera;
    click(&mut viewer, 1.0);
    click(&mut viewer, 2.0);
    assert_eq!(viewer.camera, before, "two slow clicks only pick");
    click(&mut viewer, 2.2);
    assert!(viewer.camera.target.distance(ball) < 1e-4, "{}", viewer.camera.target);
    assert!(viewer.camera.eye.distance(ball) < before.eye.distance(ball));
}

/// The grabbed point, half a unit in front of the centre, follows the pointer.
#[test]
fn ctrl_and_drag_pull_the_ball_to_the_pointer() {
    let mut viewer = viewer(FLOATING);
    let camera = viewer.camera;
    let before = Vec3::new(-2.0, 0.0, 0.0);
    viewer.point(Some(pixel(&viewer, before)));
    viewer.press(Button::Left, CTRL);
    let to = Vec2::new(500.0, 150.0);
    viewer.point(Some(to));
    viewer.session.set_running(true);
    for _ in 0..200 {
        viewer.session.frame(0.0, 0.0, |_| ());
    }
    assert_eq!(viewer.camera, camera);
    let grabbed = positions(&mut viewer.session)[0] + 0.5 * (camera.eye - before).normalize();
    assert!(pixel(&viewer, grabbed).distance(to) < 2.0, "it is at {}", pixel(&viewer, grabbed));
    viewer.release(Button::Left, 0.0);
    assert!(viewer.session.held().is_none());
}

/// A wall in front of all bodies is drawn without its faces, so a click goes through it.
#[test]
fn a_click_goes_through_a_wall_in_front_of_all_bodies() {
    let wall = "B -5 -5 4 10 0 0 0 10 0 0 0 1\n";
    let mut session = session(&format!("{BALL}{wall}"));
    let in_front = sight_of(&mut session, 0);
    session.pick(in_front.origin, in_front.direction);
    assert!(matches!(session.picked(), Some(Body::Sphere(_))), "{:?}", session.picked());
    // Beside the ball there is only the wall.
    session.pick(in_front.origin + 2.0 * Vec3::X, in_front.direction);
    assert!(matches!(session.picked(), Some(Body::Box(_))), "{:?}", session.picked());
    // From behind the ball it is not in front.
    let behind = Sight { origin: Vec3::new(0.0, 3.0, -10.0), direction: Vec3::Z, forward: Vec3::Z };
    session.pick(behind.origin + 2.0 * Vec3::X, behind.direction);
    assert!(matches!(session.picked(), Some(Body::Box(_))), "{:?}", session.picked());
}

/// A capsule is one body, wherever it is clicked.
#[test]
fn a_click_on_the_end_of_a_capsule_picks_the_capsule() {
    let mut session = session("C -2 0 0 2 0 0 0 0 0 1 0.4\n");
    for x in [-2.2, 0.0, 2.2] {
        session.pick(Vec3::new(x, 0.0, 9.0), Vec3::NEG_Z);
        assert!(matches!(session.picked(), Some(Body::Rod(_))), "{x}: {:?}", session.picked());
        assert_eq!(session.watch.facts().map(|facts| facts.title.as_str()), Some("capsule 0"));
    }
}

/// A body that is kept stays in the plots when another one is picked, and its motion goes on.
#[test]
fn several_bodies_are_plotted_together() {
    let mut session = session(FLOATING);
    let ids: Vec<_> = session.simulation().scene().sphere_ids().collect();
    session.set_picked(Some(Body::Sphere(ids[0])));
    session.toggle_kept();
    assert!(session.is_kept() && session.kept().count() == 0, "the picked body is in the plots once");
    session.set_picked(Some(Body::Sphere(ids[1])));
    (0..5).for_each(|_| session.single_step());
    let kept: Vec<_> = session.kept().collect();
    assert_eq!((kept.len(), kept[0].title.as_str(), kept[0].track.points().len()), (1, "sphere 1", 6));
    assert_eq!(session.track().points().len(), 6);
    session.set_picked(Some(Body::Sphere(ids[0])));
    session.toggle_kept();
    assert!(!session.is_kept());
}

/// A thrown sphere has a material of the scene, without which the law `hertz-mindlin` would refuse it.
#[test]
fn a_thrown_sphere_has_a_material_of_the_scene() {
    let wood = "set contact_law hertz-mindlin\n@material wood density=600 young=5e6 poisson=0.3\n@use wood\n\
                @pair wood wood friction=0.4\n";
    let mut viewer = viewer(&format!("{wood}{BALL}"));
    viewer.session.throw(Vec3::new(3.0, 3.0, 0.0), Vec3::Z);
    viewer.session.single_step();
    assert_eq!((positions(&mut viewer.session).len(), viewer.session.simulation_ref().report().steps), (2, 1));
    assert!(messages(&viewer.session).iter().all(|text| !text.contains("material")), "{:?}", messages(&viewer.session));
}

/// A second sphere of wood would need a stiffness of the pair wood wood.
#[test]
fn a_sphere_that_the_contact_law_refuses_is_removed_at_once() {
    let law =
        "set contact_law linear\n@material wood density=600\n@material iron density=600\n@pair wood iron stiffness=1000\n";
    let mut session =
        session(&format!("{law}@use wood\nS 1 0 3 0 0 0 0 0 0 0 1 0.5\n@use iron\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\n"));
    session.throw(Vec3::new(3.0, 3.0, 0.0), Vec3::Z);
    assert!(messages(&session).iter().any(|text| text.contains("'wood' 'wood'")), "{:?}", messages(&session));
    assert_eq!(positions(&mut session).len(), 1);
    assert!(!session.is_changed() && session.can_undo() == [false; 2]);
    session.single_step();
    assert_eq!(session.simulation_ref().report().steps, 1);
}
