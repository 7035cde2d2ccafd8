//! External forces, torques and impulses on placed bodies under the law `rigid` (docs/physics sections 11.1 and 11.9).

use std::path::Path;

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, Error, Meter, Options, RigidBodyId, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;
/// A box of the mass 2 with the moments of inertia 1, 2 and 3 about its centre.
const BOX: &str = "@body box mass=2 centre=0,0,0 inertia=1,2,3,0,0,0\nB -0.5 -0.5 -0.5 1 0 0  0 1 0  0 0 1\n@end\n";

fn parse(text: &str) -> rockfall::Result<Scene> {
    Ok(Scene::parse(text, Path::new("test"))?.scene)
}

fn scene(text: &str) -> Scene {
    parse(&format!("set contact_law rigid\nset gravity 0\n{BOX}{text}")).expect("a valid scene")
}

fn open(text: &str, backend: Backend) -> (Simulation, RigidBodyId) {
    let simulation = Simulation::with_options(scene(text), Options::new().backend(backend)).expect("it opens");
    let id = simulation.scene().body_ids().last().expect("a body");
    (simulation, id)
}

both! {
    a_force_moves_a_body_along_the_parabola,
    a_torque_turns_a_body_about_an_axis,
    a_body_that_a_force_carries_hovers,
    an_impulse_at_a_point_changes_velocity_and_momentum,
    a_force_at_a_point_turns_the_body,
    a_resumed_run_has_the_same_force,
    a_force_between_springs_is_felt,
    a_box_that_slides_to_rest_loses_its_kinetic_energy,
    a_ball_that_bounces_loses_what_its_restitution_says,
}

/// x = F t^2 / 2 m, from the scene and from the program, to the last digits: rows change nothing.
fn a_force_moves_a_body_along_the_parabola(backend: Backend) {
    let (mut simulation, body) = open("@place box at=0,0,0 force=3,0,0\n", backend);
    simulation.run(60, FRAME).expect("1 s");
    let at = simulation.sync().expect("states").body(body).expect("it is there").position;
    assert!((at - Vec3::new(0.75, 0.0, 0.0)).length() < 1e-5, "{at}");
    simulation.set_body_force(body, [-3.0, 0.0, 4.0]).expect("a force");
    simulation.run(60, FRAME).expect("1 s");
    let at = simulation.sync().expect("states").body(body).expect("it is there").position;
    // It flies on with 1.5 units/s and is braked.
    assert!((at - Vec3::new(1.5, 0.0, 1.0)).length() < 1e-5, "{at}");
    let own = simulation.scene().body(body).expect("it is there");
    assert_eq!((own.force, own.torque), (Vec3::new(-3.0, 0.0, 4.0), Vec3::ZERO));
}

/// L = tau t, and the angle is tau t^2 / 2 J about a principal axis. The turn of a substep has the momentum at its end.
fn a_torque_turns_a_body_about_an_axis(backend: Backend) {
    let (mut simulation, body) = open("@place box at=0,0,0\n", backend);
    simulation.set_body_torque(body, [0.0, 1.2, 0.0]).expect("a torque");
    simulation.run(60, FRAME).expect("1 s");
    let own = simulation.sync().expect("states").body(body).expect("it is there").clone();
    assert!((own.angular_momentum - Vec3::new(0.0, 1.2, 0.0)).length() < 1e-5, "{}", own.angular_momentum);
    let angle = 2.0 * own.orientation.y.atan2(own.orientation.w);
    // tau h t / 2 J more, at 4 substeps.
    assert!((angle - 0.3).abs() < 2e-3, "{angle}");
}

/// Without a change of the velocity nothing moves, whatever the field.
fn a_body_that_a_force_carries_hovers(backend: Backend) {
    let text = format!("set contact_law rigid\nset gravity 9.81\n{BOX}@place box at=0,3,0 force=0,19.62,0\n");
    let scene = parse(&text).expect("a valid scene");
    let mut simulation = Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens");
    simulation.run(60, FRAME).expect("1 s");
    let at = simulation.sync().expect("states").bodies()[0].position;
    assert!((at.y - 3.0).abs() < 1e-5, "{at}");
}

fn an_impulse_at_a_point_changes_velocity_and_momentum(backend: Backend) {
    let (mut simulation, body) = open("@place box at=1000,0,0 velocity=0,1,0\n", backend);
    simulation.run(6, FRAME).expect("0.1 s");
    simulation.apply_body_impulse(body, [0.0, 0.0, 4.0], DVec3::new(1000.5, 0.1, 0.0)).expect("an impulse");
    let own = simulation.scene().body(body).expect("it is there").clone();
    assert!((own.velocity - Vec3::new(0.0, 1.0, 2.0)).length() < 1e-5, "{}", own.velocity);
    assert!((own.angular_momentum - Vec3::new(0.0, -2.0, 0.0)).length() < 1e-4, "{}", own.angular_momentum);
    simulation.run(60, FRAME).expect("1 s");
    let own = simulation.sync().expect("states").body(body).expect("it is there").clone();
    assert!((own.position - Vec3::new(1000.0, 1.1, 2.0)).length() < 1e-3, "{}", own.position);
    assert!((own.angular_momentum - Vec3::new(0.0, -2.0, 0.0)).length() < 1e-4, "{}", own.angular_momentum);
}

fn a_force_at_a_point_turns_the_body(backend: Backend) {
    let (mut simulation, body) = open("@place box at=0,0,0 force=0,0,-1\n", backend);
    simulation.add_body_force(body, [0.0, 0.0, 3.0], DVec3::new(0.5, 0.0, 0.0)).expect("a force");
    simulation.run(6, FRAME).expect("0.1 s");
    let own = simulation.sync().expect("states").body(body).expect("it is there").clone();
    assert_eq!((own.force, own.torque), (Vec3::new(0.0, 0.0, 2.0), Vec3::new(0.0, -1.5, 0.0)));
    assert!((own.velocity - Vec3::new(0.0, 0.0, 0.1)).length() < 1e-5, "{}", own.velocity);
    assert!((own.angular_momentum - Vec3::new(0.0, -0.15, 0.0)).length() < 1e-5, "{}", own.angular_momentum);
}

/// From a file, and bit for bit.
fn a_resumed_run_has_the_same_force(backend: Backend) {
    let (mut simulation, body) = open("@place box at=0,5,0\n@place box at=0,0,0 force=1,2,3\n", backend);
    simulation.set_body_torque(body, [0.3, 0.2, 0.1]).expect("a torque");
    simulation.run(3, FRAME).expect("some frames");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let checkpoint = rockfall::Checkpoint::from_bytes(&bytes, "test").expect("it can be read");
    let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
    for simulation in [&mut simulation, &mut resumed] {
        simulation.run(30, FRAME).expect("some frames");
    }
    let [one, other] = [&mut simulation, &mut resumed].map(|simulation| {
        let own = &simulation.sync().expect("states").bodies()[1];
        (own.position, own.orientation, own.velocity, own.angular_momentum, own.force, own.torque)
    });
    assert_eq!(one, other);
    assert_eq!(resumed.scene().bodies()[1].force, Vec3::new(1.0, 2.0, 3.0));
}

/// On the end of a spring a body comes to rest where the spring pulls as much as the force that was set meanwhile.
fn a_force_between_springs_is_felt(backend: Backend) {
    let text = "@body ball mass=1\nS 1 0 0 0  0 0 0  0 0 0  1 0.2\n@end\n@place ball at=0,0,0 first=1\nT 1  0 0 0  50 0 14\n";
    let (mut simulation, body) = open(text, backend);
    simulation.run(2, FRAME).expect("some frames");
    simulation.set_body_force(body, [0.0, 5.0, 0.0]).expect("a force");
    simulation.run(180, FRAME).expect("3 s");
    let at = simulation.sync().expect("states").body(body).expect("it is there").position;
    assert!((at - Vec3::new(0.0, 0.1, 0.0)).length() < 1e-4, "{at}");
}

/// A scene that is written and read again has the same forces.
#[test]
fn text_keeps_forces() {
    let scene = scene("@place box at=0,0,0 force=1,-2,0.5 torque=0,0,3\n@place box at=2,0,0\n");
    let again = parse(&scene.to_text()).expect("it can be read");
    let loads = |scene: &Scene| scene.bodies().iter().map(|body| (body.force, body.torque)).collect::<Vec<_>>();
    assert_eq!(loads(&again), loads(&scene));
    assert_eq!(loads(&scene)[0], (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.0, 0.0, 3.0)));
}

#[test]
fn forces_that_nothing_feels_are_refused() {
    let ball = "@material a density=1000 young=1e7 poisson=0.3\n@pair a a restitution=0.5\n@use a\n\
                @body ball mass=1\nS 1 0 0 0  0 0 0  0 0 0  1 0.2\n@end\n";
    let text = format!("set contact_law hertz-mindlin\nset gravity 0\n{ball}@place ball at=0,0,0");
    let cpu = Options::new().backend(Backend::Cpu);
    let open = |text: &str| Simulation::with_options(parse(text).expect("a valid scene"), cpu.clone());
    let error = open(&format!("{text} force=1,0,0\n")).expect_err("no body of grains has a force").to_string();
    assert!(error.contains("body.force") && error.contains("set contact_law rigid"), "{error}");
    let mut simulation = open(&text).expect("it opens");
    let body = simulation.scene().body_ids().next().expect("a body");
    assert!(matches!(simulation.set_body_force(body, [1.0, 0.0, 0.0]), Err(Error::Invalid { field: "body.force", .. })));
    simulation.run(1, 1e-5).expect("nothing has changed");
    for (key, line) in [("force", "@place box at=0,0,0 fixed=1 force=1,0,0"), ("force", "@place box at=0,0,0 force=1,0")] {
        let error = parse(&format!("{BOX}{line}\n")).expect_err("it is refused").to_string();
        assert!(error.contains(key), "{error}");
    }
    let mut simulation = Simulation::with_options(scene("@place box at=0,0,0\n"), cpu.clone()).expect("it opens");
    let body = simulation.scene().body_ids().next().expect("a body");
    let error = simulation.set_body_torque(body, [f32::NAN, 0.0, 0.0]).expect_err("not finite");
    assert!(error.to_string().contains("body.torque"), "{error}");
}

/// What contacts have taken since the start, which nothing else takes or gives.
fn dissipated(simulation: &mut Simulation, seconds: f32) -> f64 {
    assert!(Meter::knows_dissipation(simulation.scene()));
    let before = simulation.energy().expect("energies").total();
    simulation.run((seconds / FRAME).round() as u64, FRAME).expect("some frames");
    before - simulation.energy().expect("energies").total()
}

const FLOOR: &str = "set contact_law rigid\nset gravity 9.81\nB -20 -1 -9  40 0 0  0 1 0  0 0 18\n";

/// m v^2 / 2 of friction.
fn a_box_that_slides_to_rest_loses_its_kinetic_energy(backend: Backend) {
    let scene = parse(&format!("{FLOOR}{BOX}@place box at=-5,0.5,0 velocity=4,0,0\n")).expect("a valid scene");
    let mut simulation = Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens");
    let lost = dissipated(&mut simulation, 3.0);
    assert!((lost / 16.0 - 1.0).abs() < 2e-3, "{lost}");
    assert!(simulation.scene().bodies()[0].velocity.length() < 1e-3);
}

/// (1 - e^2) m v^2 / 2 at the first bounce.
fn a_ball_that_bounces_loses_what_its_restitution_says(backend: Backend) {
    let text = format!("{FLOOR}set restitution 0.6\nS 1  0 2.3 0  0 0 0  0 0 0  2 0.3\n");
    let mut simulation =
        Simulation::with_options(parse(&text).expect("a valid scene"), Options::new().backend(backend)).expect("it opens");
    // It falls for 0.64 s and is in the air again.
    let lost = dissipated(&mut simulation, 0.75);
    let expected = (1.0 - 0.36) * 2.0 * 9.81 * 2.0;
    assert!((lost / expected - 1.0).abs() < 1e-3, "{lost} {expected}");
}

/// What moves bodies does work that nobody counts.
#[test]
fn dissipation_is_unknown_where_something_drives_bodies() {
    let knows = |text: &str| Meter::knows_dissipation(&scene(text));
    assert!(knows("@place box at=0,0,0\n"));
    let motion = "@motion lift velocity=0,1,0\n@move lift\nB -1 -3 -1  2 0 0  0 1 0  0 0 2\n@move -\n@place box at=0,0,0\n";
    for text in [
        "@place box at=0,0,0 force=1,0,0\n",
        "@place box at=0,0,0\n@joint hinge world 1 at=0,0,0 axis=0,0,1 speed=1 torque=2\n",
        motion,
    ] {
        let text = text.replace("world 1", "world box").replace("at=0,0,0\n@joint", "at=0,0,0 name=box\n@joint");
        assert!(!knows(&text), "{text}");
    }
}
