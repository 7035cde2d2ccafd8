//! Bodies of several boxes: blocks of several manifolds.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, Quat, Vec3};

use super::scene::{DT, G, Scene, close};
use crate::rigid::frame::{Frame, kinetic_energy};
use crate::rigid::pose::Pose;
use crate::rigid::shape::Shape;
use crate::rigid::world::{Body, RigidWorld};

const SUBSTEPS: u32 = 4;

/// A body of boxes with the mass 1, whose centre of mass is at a place: half edges and middle of each. All lie in the plane y = 0.
fn compound(scene: &mut Scene, parts: &[(Vec3, Vec3)], at: Vec3, turn: Quat) -> usize {
    let volume = |half: &Vec3| f64::from(8.0 * half.x * half.y * half.z);
    let whole: f64 = parts.iter().map(|(half, _)| volume(half)).sum();
    let share = |half: &Vec3| volume(half) / whole;
    let centre: DVec3 = parts.iter().map(|(half, middle)| share(half) * middle.as_dvec3()).sum();
    let mut tensor = DMat3::ZERO;
    for (half, middle) in parts {
        let (squares, d) = (half.as_dvec3() * half.as_dvec3(), middle.as_dvec3() - centre);
        let own = DVec3::new(squares.y + squares.z, squares.x + squares.z, squares.x + squares.y) / 3.0;
        let beside = DMat3::from_diagonal(DVec3::splat(d.length_squared())) - DMat3::from_cols(d.x * d, d.y * d, d.z * d);
        tensor += share(half) * (DMat3::from_diagonal(own) + beside);
    }
    // The principal axes are turned about y.
    let angle = 0.5 * (2.0 * tensor.z_axis.x).atan2(tensor.x_axis.x - tensor.z_axis.z);
    let axes = Quat::from_rotation_y(-angle as f32);
    let axis = DMat3::from_rotation_y(-angle);
    let moments = axis.transpose() * tensor * axis;
    assert!(moments.z_axis.x.abs() < 1e-12, "{moments}");
    let moments = DVec3::new(moments.x_axis.x, moments.y_axis.y, moments.z_axis.z).as_vec3();
    let mut body = Body::loose(Pose::new(at, turn), 1.0, moments, axes);
    let corners = |(half, middle): &(Vec3, Vec3)| (middle.as_dvec3() - centre).length() as f32 + half.length();
    body.radius = parts.iter().map(corners).fold(0.0, f32::max);
    body.width = parts.iter().map(|(half, _)| 2.0 * half.min_element()).fold(f32::INFINITY, f32::min);
    scene.world.bodies.push(body);
    let number = scene.world.bodies.len() - 1;
    for (half, middle) in parts {
        scene.attach(number, Shape::cuboid(*half), Pose::new(*middle - centre.as_vec3(), Quat::IDENTITY));
    }
    number
}

/// By how much a weight at a place presses two bodies together there. Each point between them is a spring of the stiffness w² / K, and
/// neither body bends. Also the number of pairs that have points.
fn sink(world: &RigidWorld, bodies: [u32; 2], weight: f64, place: DVec3) -> (f64, usize) {
    let frame = Frame::open(world, DT, SUBSTEPS);
    let block = frame.contacts.blocks.iter().find(|block| block.bodies == bodies).expect("a block");
    let both = bodies.map(|body| &world.bodies[body as usize]);
    let frequency = if bodies[0] == 0 { 0.36 } else { 0.18 };
    let w = TAU * frequency / (f64::from(DT) / f64::from(SUBSTEPS));
    let (mut sums, mut pairs) = (DMat3::ZERO, 0);
    for pair in &frame.contacts.pairs[block.pair_range()] {
        pairs += usize::from(pair.count > 0);
        for k in pair.first as usize..pair.first as usize + usize::from(pair.count) {
            let at = both[0].pose.position.as_dvec3() + DVec3::from(Vec3::from(frame.contacts.rows[k].arm_a));
            let resists = |body: &Body| {
                let moment = (at - body.pose.position.as_dvec3()).cross(DVec3::Y);
                f64::from(body.inverse_mass) + moment.dot(body.inverse_inertia.as_dmat3() * moment)
            };
            let stiffness = w * w / both.map(resists).iter().sum::<f64>();
            let row = DVec3::new(1.0, at.x - place.x, at.z - place.z);
            sums += DMat3::from_cols(stiffness * row.x * row, stiffness * row.y * row, stiffness * row.z * row);
        }
    }
    ((sums.inverse() * DVec3::new(weight, 0.0, 0.0)).x, pairs)
}

/// Problem 49: bodies of two boxes on each other. All manifolds of two bodies are one block, and each of its points is a spring.
#[test]
fn ells_rest_on_each_other() {
    let ell = [(Vec3::new(1.0, 0.25, 0.5), Vec3::new(0.5, 0.0, 0.0)), (Vec3::new(0.5, 0.25, 0.5), Vec3::new(0.0, 0.0, 1.0))];
    let halves = [-0.25, 0.25].map(|x| (Vec3::new(0.25, 0.25, 0.5), Vec3::new(x, 0.0, 0.0)));
    for (name, parts, turn, least_pairs) in
        [("aligned", ell, 0.0, 2), ("a quarter", ell, 1.0, 3), ("half a turn", ell, 2.0, 2), ("one box", halves, 0.0, 2)]
    {
        let mut scene = Scene::new(0.5, 0.0);
        scene.floor();
        let turn = Quat::from_rotation_y(turn * std::f32::consts::FRAC_PI_2);
        let low = compound(&mut scene, &parts, Vec3::new(0.0, 0.25, 0.0), Quat::IDENTITY);
        let high = compound(&mut scene, &parts, Vec3::new(0.0, 0.75, 0.0), turn);
        scene.run(4.0);
        let place = scene.at(high).as_dvec3();
        let (below, _) = sink(&scene.world, [0, low as u32], 2.0 * f64::from(G), place);
        let (between, pairs) = sink(&scene.world, [low as u32, high as u32], f64::from(G), place);
        let found = 0.75 - scene.at(high).y;
        assert!(pairs >= least_pairs, "{name}: {pairs} pairs");
        close(found, (below + between) as f32, 0.02 * (below + between) as f32);
        assert!(kinetic_energy(&scene.world) < 1e-6, "{}", kinetic_energy(&scene.world));
    }
}
