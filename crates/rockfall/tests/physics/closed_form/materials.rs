//! Properties of pairs of materials: restitution and friction (docs/physics section 4.10).

use rockfall::{Backend, Capsule, Cuboid, Material, MaterialId, Pair, Rod, Scene, Simulation, Sphere};

use crate::common::*;

/// Adds materials without constants.
fn materials<const N: usize>(scene: &mut Scene, names: [&str; N]) -> [MaterialId; N] {
    names.map(|name| scene.add_material(Material::new(name)).expect("a valid material"))
}

fn restitution(scene: &mut Scene, one: MaterialId, other: MaterialId, e: f32) {
    scene.set_pair(one, other, Pair::default().restitution(e)).expect("a valid pair");
}

fn friction(scene: &mut Scene, one: MaterialId, other: MaterialId, mu: f32) {
    scene.set_pair(one, other, Pair::default().friction(mu)).expect("a valid pair");
}

/// A floor whose upper face is y = 0.
fn floor_of(scene: &mut Scene, material: MaterialId) {
    let floor = Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]).material(material);
    scene.add_box(floor).expect("a valid box");
}

/// Four balls and a capsule fall on a floor at 2 and touch it: each rebounds with 2 e of its own pair. The ball without a
/// material has the value of steel with itself, because that is the only one given. Rubber and steel: sqrt(0.16 * 0.81).
fn every_pair_rebounds_with_its_own_restitution(backend: Backend) {
    let mut scene = weightless();
    let [steel, glass, clay, rubber] = materials(&mut scene, ["steel", "glass", "clay", "rubber"]);
    for (one, other, e) in [(steel, steel, 0.81), (glass, steel, 0.95), (steel, clay, 0.0), (rubber, rubber, 0.16)] {
        restitution(&mut scene, one, other, e);
    }
    floor_of(&mut scene, steel);
    let ball = |x: f32| late(Sphere::new([x, 0.5, 0.0], 0.5).velocity([0.0, -2.0, 0.0]));
    let (glass_ball, clay_ball, rubber_ball) =
        (ball(0.0).material(glass), ball(3.0).material(clay), ball(6.0).material(rubber));
    spheres(&mut scene, [glass_ball, clay_ball, rubber_ball, ball(9.0)]);
    let capsule = Capsule::new([0.0, 0.4999, 5.0], [2.0, 0.4999, 5.0], 0.5).velocity([0.0, -2.0, 0.0]);
    scene.add_capsule(capsule.material(glass)).expect("a valid capsule");
    let after = collide(scene, backend);
    let up = |speed: f64| [0.0, speed, 0.0];
    velocities(&after[..4], [up(1.9), up(0.0), up(2.0 * 0.36), up(1.62)]);
    for end in &after[4..] {
        near(end.velocity, up(1.9), 1e-3, "the end of the capsule");
    }
}

/// A ball between two others that close in on it at 1 each, with e1 and e2. Each contact leaves with e times its approach
/// velocity: vA - vB = -e1, vB - vC = -e2, vA + vB + vC = 0, so vB = (e1 - e2) / 3. Sweeps solve the two collisions together;
/// the tolerance is that of eight sweeps.
fn collisions_that_share_a_body_have_their_own_restitution(backend: Backend) {
    let mut scene = weightless();
    let [hard, soft, middle] = materials(&mut scene, ["hard", "soft", "middle"]);
    restitution(&mut scene, hard, middle, 0.9);
    restitution(&mut scene, soft, middle, 0.3);
    let ball =
        |x: f32, v: f32, material: MaterialId| Sphere::new([x, 0.0, 0.0], 0.5).velocity([v, 0.0, 0.0]).material(material);
    spheres(&mut scene, [ball(-0.99, 1.0, hard), ball(0.0, 0.0, middle), ball(0.99, -1.0, soft)]);
    let after = collide(scene, backend);
    for (sphere, expected) in after.iter().zip([0.2 - 0.9, 0.2, 0.2 + 0.3]) {
        near(sphere.velocity, [expected, 0.0, 0.0], 0.01, "velocity");
    }
}

/// Balls that slide at 3 on a floor lose mu G t, as long as they slide; one without friction keeps its velocity. The constant
/// `coulomb_friction` of the scene holds for the ball of a material that has no friction given.
fn sliding_balls_are_slowed_by_the_friction_of_their_pair(backend: Backend) {
    let mut scene = with(|settings| settings.coulomb_friction = 0.3);
    let [floor, ice, wood, other] = materials(&mut scene, ["floor", "ice", "wood", "other"]);
    friction(&mut scene, ice, floor, 0.0);
    friction(&mut scene, wood, floor, 0.1);
    restitution(&mut scene, other, floor, 0.5);
    floor_of(&mut scene, floor);
    let ball = |z: f32, material| Sphere::new([0.0, 0.499, z], 0.5).velocity([3.0, 0.0, 0.0]).material(material);
    spheres(&mut scene, [ball(0.0, ice), ball(3.0, wood), ball(6.0, other)]);
    let mut simulation = simulation(scene, backend);
    simulation.run(32, DT).expect("steps");
    let after = simulation.spheres().expect("spheres are read back");
    for (sphere, mu) in after.iter().zip([0.0, 0.1, 0.3]) {
        close(sphere.velocity.x, 3.0 - mu * 0.5, 0.01, "velocity");
    }
}

/// A pair with `friction=0` has no friction force of the square-root law either. Another pair keeps it: the ball begins to spin.
fn a_pair_without_friction_has_no_friction_force(backend: Backend) {
    let mut scene = with(|settings| settings.collisions = false);
    let [floor, ice] = materials(&mut scene, ["floor", "ice"]);
    friction(&mut scene, ice, floor, 0.0);
    floor_of(&mut scene, floor);
    let ball = |z: f32| Sphere::new([0.0, 0.49, z], 0.5).velocity([1.0, 0.0, 0.0]);
    spheres(&mut scene, [ball(0.0).material(ice), ball(3.0)]);
    let found = loads(scene, backend);
    assert_eq!((found[0].force.x, found[0].torque.z), (0.0, 0.0));
    // 50 * 0.01 * sqrt(1), with the arm 0.49.
    close(found[1].force.x, -0.5, 3e-5, "friction without a material");
}

/// A ball hits a floor at (2, -2): j = (1 + e) 2, and the friction impulse is mu j while it slides: dvx = -mu (1 + e) 2. With
/// mu = 0.1 and 0.2 and e = 0.5 this is 0.3 and 0.6. The collision displaces the ball by `LATE` 3, so its arm is 0.5 + `LATE`.
/// Stopping the slip takes 2 / (1 + 10 arm²) = 0.559 of impulse, so the second one rolls.
fn collisions_have_the_friction_of_their_pair(backend: Backend) {
    let mut scene = weightless();
    let [floor, smooth, rough, none] = materials(&mut scene, ["floor", "smooth", "rough", "none"]);
    for (material, mu) in [(smooth, 0.1), (rough, 0.2), (none, 0.0)] {
        let pair = Pair::default().restitution(0.5).friction(mu);
        scene.set_pair(material, floor, pair).expect("a valid pair");
    }
    floor_of(&mut scene, floor);
    let ball = |z: f32, material| late(Sphere::new([0.0, 0.5, z], 0.5).velocity([2.0, -2.0, 0.0]).material(material));
    spheres(&mut scene, [ball(0.0, smooth), ball(3.0, rough), ball(6.0, none)]);
    let mut simulation = simulation(scene, backend);
    simulation.handle_collisions().expect("collisions");
    let after = simulation.spheres().expect("spheres are read back");
    let arm = 0.5 + f64::from(LATE);
    for (sphere, lost) in after.iter().zip([0.3, 2.0 / (1.0 + 10.0 * arm * arm), 0.0]) {
        near(sphere.velocity, [2.0 - lost, 1.0, 0.0], 2e-3, "velocity");
    }
}

/// A rod of its own material lies across a moving rod: the collision of two rods takes e from the rods, not from their spheres.
fn rods_have_a_material_of_their_own(backend: Backend) {
    let mut scene = weightless();
    let [of_rods, of_spheres] = materials(&mut scene, ["rods", "spheres"]);
    restitution(&mut scene, of_rods, of_rods, 0.25);
    restitution(&mut scene, of_spheres, of_spheres, 1.0);
    let mut add = |ends: [[f32; 3]; 2], v: f32| {
        let ball = |place: [f32; 3]| late(Sphere::new(place, 0.05).velocity([0.0, v, 0.0]).material(of_spheres));
        let [one, two] = spheres(&mut scene, ends.map(ball));
        scene.add_rod(Rod::new(one, two, 0.1).material(of_rods)).expect("a valid rod");
    };
    add([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], 1.0);
    add([[0.0, 0.2, -1.0], [0.0, 0.2, 1.0]], -1.0);
    // u = 2, and both rods have M(1/2) = 2: they part with 0.25 * 2.
    let up = |v: f64| [0.0, v, 0.0];
    velocities(&collide(scene, backend), [up(-0.25), up(-0.25), up(0.25), up(0.25)]);
}

/// Properties can be changed between steps, and materials can be added to a running simulation.
fn pairs_change_while_a_simulation_runs(backend: Backend) {
    let mut scene = weightless();
    let [floor] = materials(&mut scene, ["floor"]);
    floor_of(&mut scene, floor);
    spheres(&mut scene, [late(Sphere::new([0.0, 0.5, 0.0], 0.5).velocity([0.0, -2.0, 0.0]))]);
    let mut running: Simulation = simulation(scene, backend);
    let bounce = |running: &mut Simulation, speed: f64| {
        running.handle_collisions().expect("collisions");
        let ball = running.spheres().expect("spheres are read back")[0];
        close(ball.velocity.y, speed, 1e-4, "velocity");
        running.update_positions(DT).expect("forces");
        let id = running.scene().sphere_ids().next().expect("a ball");
        running.set_position(id, [0.0, 0.5 - LATE * 2.0, 0.0]).expect("a position");
        running.set_velocity(id, [0.0, -2.0, 0.0]).expect("a velocity");
    };
    bounce(&mut running, 1.5);
    running.set_pair(floor, floor, Pair::default().restitution(0.5)).expect("a valid pair");
    bounce(&mut running, 1.0);
    let pair = Pair::default().restitution(0.25).friction(0.5);
    running.set_pair(floor, floor, pair).expect("a valid pair");
    bounce(&mut running, 0.5);
    let cork = running.add_material(Material::new("cork")).expect("a valid material");
    running.set_pair(cork, floor, Pair::default().restitution(0.0)).expect("a valid pair");
    let ball = Sphere::new([3.0, 0.5 - LATE * 2.0, 0.0], 0.5).velocity([0.0, -2.0, 0.0]).material(cork);
    running.add_sphere(ball).expect("a valid sphere");
    bounce(&mut running, 0.5);
    let cork_ball = running.spheres().expect("spheres are read back")[1];
    close(cork_ball.velocity.y, 0.0, 1e-4, "velocity of the cork ball");
}

both!(
    every_pair_rebounds_with_its_own_restitution,
    collisions_that_share_a_body_have_their_own_restitution,
    sliding_balls_are_slowed_by_the_friction_of_their_pair,
    a_pair_without_friction_has_no_friction_force,
    collisions_have_the_friction_of_their_pair,
    rods_have_a_material_of_their_own,
    pairs_change_while_a_simulation_runs,
);
