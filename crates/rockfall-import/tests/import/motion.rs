//! How imported robots move.

use std::f64::consts::TAU;

use rockfall::{Backend, Options, Simulation};

use crate::common::import;

/// The period of a hinge, from the times at which it passes 0 upward.
fn period(text: &str, name: &str) -> f64 {
    let scene = import(text).unwrap().scene;
    let place = scene.joint_ids().position(|id| scene.joint(id).unwrap().name.as_deref() == Some(name)).unwrap();
    let mut simulation = Simulation::with_options(scene, Options::default().backend(Backend::Cpu)).unwrap();
    let (mut before, mut passes) = (0.0, Vec::new());
    let step = 1.0 / 240.0;
    for number in 0..2400 {
        simulation.run(1, step as f32).unwrap();
        let position = f64::from(simulation.joints().unwrap()[place].position) - START;
        if before < 0.0 && position >= 0.0 {
            passes.push(step * (f64::from(number) + before / (before - position)));
        }
        before = position;
    }
    let (first, last) = (passes[0], passes[passes.len() - 1]);
    (last - first) / (passes.len() - 1) as f64
}

/// The pendulum hangs at an angle of 0.1 rad, so its joint is at -0.1 when it hangs down.
const START: f64 = -0.1;

/// A rod of 1 m and 2 kg that hangs from its end.
fn expected() -> f64 {
    let (mass, arm, inertia): (f64, f64, f64) = (2.0, 0.5, 2.0 / 12.0);
    let amplitude = 0.1_f64;
    TAU * ((inertia + mass * arm * arm) / (mass * 9.81 * arm)).sqrt() * (1.0 + amplitude * amplitude / 16.0)
}

#[test]
fn compound_pendulum_of_a_urdf_file() {
    let text = r#"<robot name="pendulum"><link name="world"/><link name="rod">
      <inertial><origin xyz="0 0 -0.5"/><mass value="2"/><inertia ixx="0.1666666667" iyy="0.1666666667" izz="0.001"/></inertial>
      <collision><origin xyz="0 0 -0.5"/><geometry><box size="0.05 0.05 1"/></geometry></collision></link>
      <joint name="hinge" type="continuous"><parent link="world"/><child link="rod"/>
      <origin xyz="0 0 2" rpy="0 0.1 0"/><axis xyz="0 1 0"/></joint>
    </robot>"#;
    let found = period(text, "hinge");
    assert!((found / expected() - 1.0).abs() < 5e-3, "{found}, expected {}", expected());
}

#[test]
fn compound_pendulum_of_an_mjcf_file() {
    let text = r#"<mujoco><compiler angle="radian"/><worldbody><body name="rod" pos="0 0 2" euler="0 0.1 0">
      <joint name="hinge" axis="0 1 0"/><inertial pos="0 0 -0.5" mass="2" diaginertia="0.1666666667 0.1666666667 0.001"/>
      <geom type="capsule" fromto="0 0 0 0 0 -1" size="0.02"/></body></worldbody></mujoco>"#;
    let found = period(text, "hinge");
    assert!((found / expected() - 1.0).abs() < 5e-3, "{found}, expected {}", expected());
}

/// A body with three joints in a plane falls and turns as a free one.
#[test]
fn planar_root_falls_freely() {
    let text = r#"<mujoco><worldbody><body name="torso" pos="0 0 5">
      <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/><joint name="turn" axis="0 1 0"/>
      <geom type="capsule" size="0.05 0.2"/></body></worldbody></mujoco>"#;
    let scene = import(text).unwrap().scene;
    let mut simulation = Simulation::with_options(scene, Options::default().backend(Backend::Cpu)).unwrap();
    simulation.run(30, 1.0 / 60.0).unwrap();
    let joints = simulation.joints().unwrap();
    let fall = -0.5 * 9.81 * 0.25;
    assert!(joints[0].position.abs() < 1e-4 && joints[2].position.abs() < 1e-3, "{joints:?}");
    assert!((f64::from(joints[1].position) / fall - 1.0).abs() < 0.02, "{} {fall}", joints[1].position);
}
