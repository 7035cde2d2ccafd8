//! Walls that follow motions under the contact law `rigid` (docs/physics section 11.1), against closed forms.

use std::f32::consts::TAU;
use std::path::Path;

use glam::Vec3;
use rockfall::{Backend, Error, MotionTerm, Options, Scene, Simulation};

use crate::hard::check_split_and_resumed;

const FRAME: f32 = 1.0 / 60.0;
const CUBE: &str = "@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n";

fn parse(text: &str) -> Result<Scene, Error> {
    Scene::parse(&format!("set contact_law rigid\nset gravity 9.81\n{text}"), Path::new("test")).map(|parsed| parsed.scene)
}

fn open(text: &str, backend: Backend) -> Simulation {
    Simulation::with_options(parse(text).expect("a valid scene"), Options::new().backend(backend)).expect("it opens")
}

fn body(simulation: &mut Simulation) -> (Vec3, Vec3) {
    let body = &simulation.sync().expect("states").bodies()[0];
    (body.position, body.velocity)
}

both! {
    a_box_rides_on_a_table_that_oscillates,
    friction_carries_a_box_on_a_turntable,
    a_paddle_gives_a_ball_twice_its_velocity,
    a_box_on_a_quick_turntable_flies_off,
    tables_and_other_motions_push_a_box_along,
    split_and_resumed_runs_with_motions_have_the_same_bits,
    a_motion_that_goes_on_otherwise_is_followed,
}

/// The greatest acceleration of the table is half of the field, so the box stays on it.
fn a_box_rides_on_a_table_that_oscillates(backend: Backend) {
    let (frequency, amplitude) = (0.5_f32, 0.5_f32);
    let text = format!(
        "@motion table amplitude=0,{amplitude},0 frequency={frequency}\n@move table\nB -3 -1 -3  6 0 0  0 1 0  0 0 6\n@move -\n\
         {CUBE}@place cube at=0.2,0.5,0.1\n"
    );
    let mut simulation = open(&text, backend);
    for frame in 1..=180 {
        simulation.run(1, FRAME).expect("a frame");
        let (at, velocity) = body(&mut simulation);
        let angle = TAU * frequency * frame as f32 * FRAME;
        let height = 0.5 + amplitude * angle.sin();
        assert!((at.y - height).abs() < 5e-3, "frame {frame}: {} {height}", at.y);
        // The table takes the mean velocity of the frame.
        let speed = TAU * frequency * amplitude * (angle - 0.5 * TAU * frequency * FRAME).cos();
        assert!((velocity.y - speed).abs() < 0.05, "frame {frame}: {} {speed}", velocity.y);
        // Friction creeps where the load changes (section 11.12).
        assert!((at - Vec3::new(0.2, at.y, 0.1)).length() < 5e-3, "{at}");
    }
}

fn turntable(spin: f32, backend: Backend) -> Simulation {
    open(
        &format!(
            "set coulomb_friction 0.5\n@motion table spin={spin} axis=0,1,0 through=0,0,0\n@move table\n\
             B -8 -1 -8  16 0 0  0 1 0  0 0 16\n@move -\n{CUBE}@place cube at=2,0.5,0 velocity=0,0,{} spin=0,{spin},0\n",
            -2.0 * spin
        ),
        backend,
    )
}

/// Friction holds where spin² r < mu g. The box then turns with the table, about its axis and about its own.
fn friction_carries_a_box_on_a_turntable(backend: Backend) {
    let spin = 1.2;
    let mut simulation = turntable(spin, backend);
    simulation.run(120, FRAME).expect("2 s");
    let (at, _) = body(&mut simulation);
    let angle = spin * 2.0;
    let expected = Vec3::new(2.0 * angle.cos(), 0.5, -2.0 * angle.sin());
    assert!(at.distance(expected) < 0.02, "{at} {expected}");
    let turn = simulation.scene().bodies()[0].orientation * Vec3::X;
    assert!(turn.distance(Vec3::new(angle.cos(), 0.0, -angle.sin())) < 0.01, "{turn}");
}

/// With spin² r = 2 mu g it slides out.
fn a_box_on_a_quick_turntable_flies_off(backend: Backend) {
    let mut simulation = turntable((9.81_f32 / 2.0).sqrt(), backend);
    simulation.run(60, FRAME).expect("1 s");
    let (at, _) = body(&mut simulation);
    assert!(at.with_y(0.0).length() > 2.5, "{at}");
}

/// An elastic ball at rest leaves a wall that comes with v at 2 v.
fn a_paddle_gives_a_ball_twice_its_velocity(backend: Backend) {
    let text = "set gravity 0\nset restitution 1\n@motion paddle velocity=3,0,0\n@move paddle\nP -1 -2 -2  0 4 0  0 0 4\n@move -\n\
                S 1  0 0 0  0 0 0  0 0 0  1 0.25\n";
    let mut simulation = open(text, backend);
    simulation.run(60, FRAME).expect("1 s");
    let ball = simulation.sync().expect("states").spheres()[0];
    assert!((ball.velocity.x - 6.0).abs() < 1e-3, "{}", ball.velocity);
    // It is hit when the wall has come to its surface.
    let expected = 6.0 * (1.0 - 0.75 / 3.0);
    assert!((ball.position.x - expected).abs() < 0.02, "{} {expected}", ball.position);
}

/// A table of legs pushes a box, and it stays where the last leg ends.
fn tables_and_other_motions_push_a_box_along(backend: Backend) {
    let text = format!(
        "set coulomb_friction 0.5\nB -9 -1 -9  18 0 0  0 1 0  0 0 18\n@motion ram velocity=1,0,0 to=1\n@motion ram velocity=-1,0,0 from=2 to=3\n\
         @move ram\nB -1.6 0 -1  1 0 0  0 1 0  0 0 2\n@move -\n{CUBE}@place cube at=0,0.5,0\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(30, FRAME).expect("0.5 s");
    let (at, velocity) = body(&mut simulation);
    assert!((velocity.x - 1.0).abs() < 0.02 && (at.x - 0.4).abs() < 5e-3, "{at} {velocity}");
    simulation.run(150, FRAME).expect("2.5 s");
    let (at, velocity) = body(&mut simulation);
    // After its last push at 1 unit/s it slides v² / (2 mu g).
    let slide = 1.0 / (2.0 * 0.5 * 9.81);
    assert!((at.x - 0.9 - slide).abs() < 0.02 && velocity.length() < 1e-3, "{at} {velocity}");
    let wall = simulation.motion_states()[0];
    assert!(wall.position.length() < 1e-9, "{wall:?}");
}

fn split_and_resumed_runs_with_motions_have_the_same_bits(backend: Backend) {
    let text = format!(
        "@motion drum spin=2 axis=0,0,1 through=0,2,0\n@motion drum amplitude=0,0.2,0 frequency=2\n@move drum\n\
         B -2 0 -2  4 0 0  0 0.2 0  0 0 4\nB -2 0.2 -2  0.2 0 0  0 4 0  0 0 4\nB 1.8 0.2 -2  0.2 0 0  0 4 0  0 0 4\n@move -\n\
         {CUBE}@place cube at=0,1,0\n@place cube at=0.3,2.2,0.2\nS 1  -0.8 2 0  0 0 0  0 0 0  1 0.3\n"
    );
    check_split_and_resumed(|| open(&text, backend), 60, 5, &[1, 31]);
}

fn a_motion_that_goes_on_otherwise_is_followed(backend: Backend) {
    let text = format!(
        "set coulomb_friction 0.8\n@motion table velocity=1,0,0\n@move table\nB -9 -1 -9  18 0 0  0 1 0  0 0 18\n@move -\n\
         {CUBE}@place cube at=0,0.5,0 velocity=1,0,0\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(60, FRAME).expect("1 s");
    let motion = simulation.scene().find_motion("table").expect("a motion");
    simulation.go_on(motion, MotionTerm::translation([0.0, 0.0, 1.0])).expect("it goes on");
    simulation.run(120, FRAME).expect("2 s");
    let (at, velocity) = body(&mut simulation);
    assert!(velocity.distance(Vec3::Z) < 1e-3, "{velocity}");
    // It slides relative to the table by sqrt(2) from the old velocity to the new one.
    let slide = 2.0 / (2.0 * 0.8 * 9.81) / 2.0_f32.sqrt();
    assert!(at.distance(Vec3::new(1.0 + slide, 0.5, 2.0 - slide)) < 0.03, "{at} {slide}");
}

#[test]
fn what_cannot_follow_is_refused_by_name() {
    for (wall, name) in [
        ("@servo lid force=0,-30,0 speed=0.2\n@move lid\nB 0 1 0  1 0 0  0 0.1 0  0 0 1\n", "a servo"),
        ("@motion m spin=1 axis=0,0,1 through=0,0,0\n@move m\n@plane at=0,0,0 normal=0,1,0\n", "a plane that turns"),
    ] {
        let error = Simulation::with_options(parse(wall).expect("a scene"), Options::new()).expect_err("it is refused");
        assert!(error.to_string().contains(name), "{error}");
    }
}
