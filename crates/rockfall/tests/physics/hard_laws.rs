//! Forces of a program under the law `rigid` (docs/physics sections 4.14 and 11.9).

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{Backend, ForceLaw, Options, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;
const BOX: &str = "@body box mass=4\nB -0.5 -0.5 -0.5  1 0 0  0 1 0  0 0 1\n@end\n";

fn open(text: &str, laws: Vec<ForceLaw>, backend: Backend) -> Simulation {
    let text = format!("set contact_law rigid\n@run substeps=8\n{BOX}{text}");
    let scene = Scene::parse(&text, Path::new("test")).expect("a valid scene").scene;
    let options = laws.into_iter().fold(Options::new().backend(backend), Options::force_law);
    Simulation::with_options(scene, options).expect("it opens")
}

/// Drag in proportion to the radius.
fn drag(rate: f32) -> ForceLaw {
    let text = "force = -rate * radius * velocity; torque = -rate * angular_velocity;";
    ForceLaw::new("drag").parameter("rate", rate).wgsl(text)
}

both! {
    bodies_reach_their_terminal_velocities,
    a_law_knows_the_time_and_the_place,
    laws_and_springs_act_together,
    two_runs_have_the_same_bits,
}

/// A ball and a box fall as v = (m g / c) (1 - e^(-c t / m)) with c = rate * radius, and the turn of the box fades. The radius of the box
/// is half its diagonal.
fn bodies_reach_their_terminal_velocities(backend: Backend) {
    let text = "set gravity 9.81\nS 1  0 500 0  0 0 0  0 0 0  2 0.5\n@place box at=5,500,0 spin=0,3,0\n";
    let mut simulation = open(text, vec![drag(4.0)], backend);
    let expected = |mass: f32, radius: f32, time: f32| {
        let rate = 4.0 * radius / mass;
        -9.81 / rate * (1.0 - (-rate * time).exp())
    };
    let half = 0.75_f32.sqrt();
    for (time, error) in [(0.5, 0.01), (10.0, 1e-3)] {
        while simulation.report().time < time - 1e-6 {
            simulation.step(FRAME).expect("a frame");
        }
        let scene = simulation.sync().expect("states");
        let (ball, own) = (scene.spheres()[0].velocity.y, &scene.bodies()[0]);
        let wanted = [expected(2.0, 0.5, time as f32), expected(4.0, half, time as f32)];
        assert!((ball / wanted[0] - 1.0).abs() < error, "{ball} {} after {time} s", wanted[0]);
        assert!((own.velocity.y / wanted[1] - 1.0).abs() < error, "{} {} after {time} s", own.velocity.y, wanted[1]);
        // J = m / 6.
        let turn = 2.0 * (-4.0 * time as f32 * 6.0 / 4.0).exp();
        assert!((own.angular_momentum.y - turn).abs() < 0.02, "{} {turn}", own.angular_momentum);
    }
    // Without the drag they fall on.
    let before = simulation.spheres().expect("states")[0].velocity.y;
    simulation.set_force_law_parameter("drag", "rate", 0.0).expect("a parameter");
    simulation.run(60, FRAME).expect("1 s");
    let after = simulation.spheres().expect("states")[0].velocity.y;
    assert!((after - before + 9.81).abs() < 1e-2, "{before} {after}");
}

/// A force that grows with the time, and one to a place far from the origin, where coordinates of the solver are not those of the scene.
fn a_law_knows_the_time_and_the_place(backend: Backend) {
    let law = ForceLaw::new("pull")
        .wgsl("force = vec3f(0.0, 6.0 * mass * time, 40.0 * mass * (5000.0 - position.z) - 12.0 * mass * velocity.z);");
    let mut simulation = open("set gravity 0\n@place box at=0,0,5000.5\n", vec![law], backend);
    simulation.run(60, FRAME).expect("1 s");
    simulation.run(60, FRAME).expect("1 s");
    let own = simulation.sync().expect("states").bodies()[0].clone();
    // 3 t^2, less h g t / 2 for a force at the start of each substep.
    assert!((own.velocity.y - 12.0).abs() < 0.02, "{}", own.velocity);
    assert!((own.position.z - 5000.0).abs() < 1e-3, "{}", own.position);
}

/// A spring holds what a law pulls.
fn laws_and_springs_act_together(backend: Backend) {
    let law = ForceLaw::new("wind").wgsl("force = vec3f(5.0 * mass, 0.0, 0.0);");
    let mut simulation = open(
        "set gravity 0\nS 1  0 0 0  0 0 0  0 0 0  2 0.2\nS 2  9 0 0  0 0 0  0 0 0  1 0.2\nT 1  0 0 0  50 0 20\n",
        vec![law],
        backend,
    );
    simulation.run(180, FRAME).expect("3 s");
    let spheres = simulation.spheres().expect("states");
    assert!((spheres[0].position - Vec3::new(0.2, 0.0, 0.0)).length() < 1e-3, "{}", spheres[0].position);
    assert!((spheres[1].velocity.x - 15.0).abs() < 1e-3, "{}", spheres[1].velocity);
}

fn two_runs_have_the_same_bits(backend: Backend) {
    let text = "set gravity 9.81\nB -9 -1 -9  18 0 0  0 1 0  0 0 18\nS 1  0 2 0  0 0 0  0 0 0  2 0.5\n\
                @place box at=0.3,0.5,0\n@place box at=0,3.5,0.2\n";
    let [one, other] = [0, 1].map(|_| {
        let mut simulation = open(text, vec![drag(0.7)], backend);
        simulation.run(120, FRAME).expect("2 s");
        let scene = simulation.sync().expect("states");
        let bits = |vector: Vec3| vector.to_array().map(f32::to_bits);
        scene.spheres().iter().map(|sphere| (bits(sphere.position), bits(sphere.velocity))).collect::<Vec<_>>()
    });
    assert_eq!(one, other);
}

/// The error names the law and the sphere.
#[test]
fn a_law_that_is_not_finite_is_named() {
    let law = ForceLaw::new("bad").wgsl("force = vec3f(mass / (position.y - position.y), 0.0, 0.0);");
    let mut simulation = open("set gravity 0\nS 1  0 1 0  0 0 0  0 0 0  2 0.5\n", vec![law], Backend::Cpu);
    let error = simulation.run(3, FRAME).expect_err("it is not finite").to_string();
    assert!(error.contains("bad"), "{error}");
}
