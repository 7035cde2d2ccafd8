//! Joints under the contact law `rigid` (docs/physics section 11.14) through the interface of a program.

use std::path::Path;

use rockfall::glam::{Vec2, Vec3};
use rockfall::{Anchor, Backend, Checkpoint, Joint, RigidBodyId, Scene, Simulation};

use crate::common::{bits_of, on, simulation};

both! {
    a_four_bar_linkage_keeps_to_the_equation_of_freudenstein,
    a_slider_crank_moves_as_its_triangle,
    motors_and_targets_change_while_it_runs,
    split_and_resumed_runs_have_the_same_bits,
    joints_and_bodies_come_and_go,
    a_broken_joint_stays_broken,
    springs_of_joints_store_energy,
}

const FRAME: f32 = 1.0 / 60.0;

fn read(text: &str) -> Scene {
    Scene::parse(text, Path::new("joints.txt")).unwrap_or_else(|error| panic!("{error}\n{text}")).scene
}

fn run(simulation: &mut Simulation, frames: u64) {
    simulation.run(frames, FRAME).expect("frames");
}

/// A bar from one point of the plane z = 0 to another one, with its name.
fn bar(name: &str, from: Vec2, to: Vec2) -> String {
    let (middle, along) = (0.5 * (from + to), to - from);
    let (half, angle) = (0.5 * along.length(), along.y.atan2(along.x).to_degrees());
    format!(
        "@body {name} density=2700\nB {} -0.05 -0.05 {} 0 0 0 0.1 0 0 0 0.1\n@end\n@place {name} at={},{},0 axis=0,0,1 turn={angle} name={name}\n",
        -half,
        2.0 * half,
        middle.x,
        middle.y
    )
}

fn hinge(a: &str, b: &str, at: Vec2, more: &str) -> String {
    format!("@joint hinge {a} {b} at={},{},0 axis=0,0,1 {more}\n", at.x, at.y)
}

/// Bars pass through each other.
const HEAD: &str = "set contact_law rigid\nset gravity 9.81\n@run substeps=16\n";

/// Crank a, coupler b, rocker c and ground d: K1 cos(rocker) - K2 cos(crank) + K3 = cos(crank - rocker).
fn a_four_bar_linkage_keeps_to_the_equation_of_freudenstein(backend: Backend) {
    let (a, b, c, d) = (0.6_f32, 1.8_f32, 1.4_f32, 2.0_f32);
    let (start, end) = (Vec2::ZERO, Vec2::new(d, 0.0));
    let crank = Vec2::new(0.0, a);
    // The third corner of the triangle of the coupler and the rocker.
    let apart = end - crank;
    let along = (b * b - c * c + apart.length_squared()) / (2.0 * apart.length());
    let across = (b * b - along * along).sqrt();
    let top = crank + (along * apart + across * apart.perp()) / apart.length();
    let text = [
        HEAD.to_owned(),
        bar("crank", start, crank),
        bar("coupler", crank, top),
        bar("rocker", end, top),
        hinge("world", "crank", start, "speed=3 torque=500 name=crank"),
        hinge("crank", "coupler", crank, ""),
        hinge("coupler", "rocker", top, ""),
        hinge("world", "rocker", end, "name=rocker"),
        // The crank and the rocker pass through each other, too.
        "@joint distance crank rocker at=0,0,0 to=2,0,0 limits=0..9\n".to_owned(),
    ];
    let mut simulation = simulation(read(&text.concat()), backend);
    let (crank_start, rocker_start) = (std::f32::consts::FRAC_PI_2, (top - end).to_angle());
    let mut turned = 0.0_f32;
    for _ in 0..on(backend, 300, 30) {
        run(&mut simulation, 1);
        let joints = simulation.joints().expect("joints");
        let [crank, rocker] = [crank_start + joints[0].position, rocker_start + joints[3].position];
        let off = d / a * rocker.cos() - d / c * crank.cos() + (a * a - b * b + c * c + d * d) / (2.0 * a * c)
            - (crank - rocker).cos();
        assert!(off.abs() < 2e-3, "crank {crank}, rocker {rocker}: {off}");
        assert!(joints.iter().all(|joint| joint.error < 1e-3), "{joints:?}");
        turned += joints[0].speed * FRAME;
    }
    assert!(turned > 0.8 * 3.0 * FRAME * on(backend, 300, 30) as f32, "{turned}");
}

/// A crank r and a rod l: the slider is at r cos + sqrt(l² - r² sin²).
fn a_slider_crank_moves_as_its_triangle(backend: Backend) {
    let (r, l) = (0.5_f32, 1.5_f32);
    let (top, end) = (Vec2::new(0.0, r), Vec2::new((l * l - r * r).sqrt(), 0.0));
    let text = [
        HEAD.to_owned(),
        bar("crank", Vec2::ZERO, top),
        bar("rod", top, end),
        "@body piston mass=5\nB -0.1 -0.1 -0.1 0.2 0 0 0 0.2 0 0 0 0.2\n@end\n".to_owned(),
        format!("@place piston at={},0,0 name=piston\n", end.x),
        hinge("world", "crank", Vec2::ZERO, "speed=4 torque=500"),
        hinge("crank", "rod", top, ""),
        hinge("rod", "piston", end, ""),
        format!("@joint slider world piston at={},0,0 axis=1,0,0\n", end.x),
        "@joint distance crank piston at=0,0,0 to=0,0,0 limits=0..9\n".to_owned(),
    ];
    let mut simulation = simulation(read(&text.concat()), backend);
    let mut greatest = 0.0_f32;
    for _ in 0..on(backend, 240, 30) {
        run(&mut simulation, 1);
        let joints = simulation.joints().expect("joints");
        let angle = std::f32::consts::FRAC_PI_2 + joints[0].position;
        let wanted = r * angle.cos() + (l * l - (r * angle.sin()).powi(2)).sqrt() - end.x;
        assert!((joints[3].position - wanted).abs() < 1e-3, "{} {wanted}", joints[3].position);
        greatest = greatest.max(joints[3].position.abs());
    }
    assert!(greatest > 0.3, "{greatest}");
}

const DOOR: &str = "set contact_law rigid\nset gravity 0\n@body door mass=20\nB 0 0 -0.02 0.9 0 0 0 2 0 0 0 0.04\n@end\n\
                    @place door at=0,0.01,0 name=door\n@joint hinge world door at=0,1,0 axis=0,1,0 limits=0..110 name=hinge\n";

/// A motor, then a spring towards a target, then new limits.
fn motors_and_targets_change_while_it_runs(backend: Backend) {
    let mut simulation = simulation(read(DOOR), backend);
    let hinge = simulation.scene().joint_named("hinge").expect("a hinge");
    let position = |simulation: &mut Simulation| simulation.joints().expect("joints")[0].position;
    run(&mut simulation, 5);
    assert!(position(&mut simulation).abs() < 1e-4);
    simulation.update_joint(hinge, |joint| *joint = joint.clone().motor(1.0).max_force(50.0)).expect("a motor");
    run(&mut simulation, 60);
    let open = position(&mut simulation);
    assert!((open - 1.0).abs() < 0.1, "{open}");
    let change = |joint: &mut Joint| {
        joint.speed = None;
        *joint = joint.clone().spring(400.0, 80.0).target(0.4);
    };
    simulation.update_joint(hinge, change).expect("a spring");
    run(&mut simulation, 180);
    let open = position(&mut simulation);
    assert!((open - 0.4).abs() < 2e-3, "{open}");
    simulation.update_joint(hinge, |joint| *joint = joint.clone().limits(0.0, 0.2).target(0.5)).expect("limits");
    run(&mut simulation, 60);
    let open = position(&mut simulation);
    assert!((open - 0.2).abs() < 5e-3, "{open}");
    // A value out of its range changes nothing.
    assert!(simulation.update_joint(hinge, |joint| joint.stiffness = -1.0).is_err());
    assert_eq!(simulation.scene().joint(hinge).expect("it").stiffness, 400.0);
}

/// A chain that hangs from the world over a floor, with limits, friction and a motor.
fn chain() -> Scene {
    let mut text =
        "set contact_law rigid\nset gravity 9.81\n@body link mass=1\nC 0 -0.2 0 0 0.2 0 0 0 0 - 0.05\n@end\n".to_owned();
    for k in 0..6 {
        let at = 0.5 * k as f32;
        text += &format!("@place link at={},2,0 axis=0,0,1 turn=90 name=link{k} velocity=0,0,{}\n", at + 0.25, 0.3 * k as f32);
    }
    text += "@joint hinge world link0 at=0,2,0 axis=0,0,1 speed=-1 torque=4\n";
    for k in 1..6 {
        let kind = ["ball", "hinge"][k % 2];
        text += &format!("@joint {kind} link{} link{k} at={},2,0 axis=0,0,1 friction=0.2 damping=0.1 ", k - 1, 0.5 * k as f32);
        text += if kind == "ball" { "cone=60 twist=-20..20\n" } else { "limits=-70..40\n" };
    }
    read(&(text + "B -5 -1 -5 10 0 0 0 1 0 0 0 10\n"))
}

fn split_and_resumed_runs_have_the_same_bits(backend: Backend) {
    let frames = on(backend, 90, 20);
    let state = |simulation: &mut Simulation| {
        let joints = simulation.joints().expect("joints");
        (bits_of(simulation), format!("{joints:?}"))
    };
    let mut whole = simulation(chain(), backend);
    run(&mut whole, frames);
    let whole = state(&mut whole);
    let mut split = simulation(chain(), backend);
    run(&mut split, frames / 2);
    let checkpoint = split.checkpoint().expect("a checkpoint");
    run(&mut split, frames - frames / 2);
    assert_eq!(state(&mut split), whole, "in two parts");
    let checkpoint = Checkpoint::from_bytes(&checkpoint.to_bytes(), "chain").expect("it reads");
    let mut resumed = Simulation::resume(checkpoint).expect("it goes on");
    run(&mut resumed, frames - frames / 2);
    assert_eq!(state(&mut resumed), whole, "from a checkpoint");
}

fn height(simulation: &mut Simulation, body: RigidBodyId) -> f32 {
    simulation.sync().expect("states").body(body).expect("a body").position.y
}

/// A joint that is removed lets its body fall, and a new one holds it where it is. A body takes its joints along.
fn joints_and_bodies_come_and_go(backend: Backend) {
    let mut scene = chain();
    let first = scene.joint_ids().next().expect("a joint");
    let bodies: Vec<RigidBodyId> = scene.body_ids().collect();
    scene.update_joint(first, |joint| joint.speed = None).expect("no motor");
    let mut simulation = simulation(scene, backend);
    run(&mut simulation, 3);
    simulation.remove_joints(&[first]).expect("it is there");
    run(&mut simulation, 10);
    let fallen = height(&mut simulation, bodies[0]);
    assert!(fallen < 1.95, "{fallen}");
    let at: Vec3 = simulation.scene().body(bodies[0]).expect("a body").position;
    let ball = simulation.add_joint(Joint::ball(Anchor::World, bodies[0], at)).expect("a joint");
    simulation.remove_bodies(&[bodies[3]]).expect("it is there");
    assert_eq!(simulation.scene().joints().len(), 4);
    run(&mut simulation, 30);
    let [one, other] = simulation.sync().expect("states").joint_anchors(ball).expect("anchors");
    assert!(one.distance(other) < 5e-3 && one == at, "{one} {other} {at}");
}

/// Also after a checkpoint and an edit. A scene of the state is without it in `rockfall run --save`.
fn a_broken_joint_stays_broken(backend: Backend) {
    let mut scene = read(&DOOR.replace("gravity 0", "gravity 9.81"));
    let hinge = scene.joint_named("hinge").expect("a hinge");
    scene.update_joint(hinge, |joint| joint.break_force = 100.0).expect("a strength");
    let mut simulation = simulation(scene, backend);
    run(&mut simulation, 5);
    assert!(simulation.joints().expect("joints")[0].broken);
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    let mut resumed = Simulation::resume(checkpoint).expect("it goes on");
    resumed.add_sphere(rockfall::Sphere::new([5.0, 0.0, 0.0], 0.1)).expect("a ball");
    run(&mut resumed, 5);
    assert!(resumed.joints().expect("joints")[0].broken);
    let body = resumed.scene().body_ids().next().expect("a door");
    assert!(height(&mut resumed, body) < 0.98, "{}", height(&mut resumed, body));
}

/// A spring that swings keeps its energy, of which it has all at the start. The angle from its target is the smaller one of both ways.
fn springs_of_joints_store_energy(backend: Backend) {
    let joint = |target: f32| {
        let mut scene = read(DOOR);
        let hinge = scene.joint_named("hinge").expect("a hinge");
        scene
            .update_joint(hinge, |joint| (joint.speed, joint.stiffness, joint.target) = (None, 50.0, Some(target)))
            .expect("a spring");
        simulation(scene, backend)
    };
    let spring = |simulation: &mut Simulation| simulation.energy().expect("energy").spring;
    let mut swinging = joint(0.4);
    assert!((spring(&mut swinging) - 0.5 * 50.0 * 0.16).abs() < 1e-4, "{}", spring(&mut swinging));
    let mut least = f64::INFINITY;
    for _ in 0..on(backend, 60, 30) {
        run(&mut swinging, 1);
        let energy = swinging.energy().expect("energy");
        assert!((energy.total() - 4.0).abs() < 0.04, "{energy:?}");
        least = least.min(energy.spring);
    }
    assert!(least < 1.0, "{least}");
    let turned = spring(&mut joint(std::f32::consts::TAU - 0.4));
    assert!((turned - 4.0).abs() < 1e-3, "{turned}");
}
