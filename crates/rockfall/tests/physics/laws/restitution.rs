//! The restitution of an impact is the one that the pair asks for.

use rockfall::{Backend, Capsule, ContactLaw, Cuboid, Pair, Polygon, Rod, Sphere};

use super::{assert_close, ball, pair, scene_with, simulation, soft};

/// For each restitution: two balls at 1 relative to each other, a ball on a box, one on a polygon, one on a fixed rod, and a
/// upright capsule. All of them rebound with e times the speed of the impact, within 1 % (3 % with the few steps of the
/// test on the GPU).
fn impacts_rebound_with_the_restitution_of_their_pair(law: ContactLaw, backend: Backend) {
    // The force of the dashpot begins with a jump, so the rebound is off by a part of the force of one step. A restitution of 0.1
    // within 1 % needs some 500 steps per impact.
    let (wanted, steps, tolerance) =
        crate::common::on(backend, (&[0.1, 0.3, 0.5, 0.8, 0.97, 1.0][..], 6000, 0.01), (&[0.5, 0.9][..], 600, 0.03));
    let mut scene = scene_with(law);
    let floor = soft(&mut scene, "floor");
    let down = |sphere: Sphere| sphere.velocity([0.0, -1.0, 0.0]);
    let mut starts = Vec::new();
    for (k, e) in wanted.iter().enumerate() {
        let own = soft(&mut scene, &format!("e{k}"));
        pair(&mut scene, own, own, *e, 0.0);
        pair(&mut scene, own, floor, *e, 0.0);
        let z = 10.0 * k as f32;
        let [left, right] = [0.0, 1.001].map(|x| ball(&scene, own, [x, 20.0, z], 0.5));
        starts.push(scene.add_sphere(left.velocity([0.5, 0.0, 0.0])).expect("a valid sphere"));
        starts.push(scene.add_sphere(right.velocity([-0.5, 0.0, 0.0])).expect("a valid sphere"));
        scene.add_box(Cuboid::between([8.0, -1.0, z - 2.0], [12.0, 0.0, z + 2.0]).material(floor)).expect("a valid box");
        starts.push(scene.add_sphere(down(ball(&scene, own, [10.0, 0.501, z], 0.5))).expect("a valid sphere"));
        let plate = Polygon::new([18.0, 0.0, z - 2.0], [0.0, 0.0, 4.0], [4.0, 0.0, 0.0]).material(floor);
        scene.add_polygon(plate).expect("a valid polygon");
        starts.push(scene.add_sphere(down(ball(&scene, own, [20.0, 0.501, z], 0.5))).expect("a valid sphere"));
        let ends = [28.0, 32.0].map(|x| Sphere::new([x, -0.3, z], 0.1).fixed().material(floor));
        let [one, two] = ends.map(|end| scene.add_sphere(end).expect("a valid sphere"));
        scene.add_rod(Rod::new(one, two, 0.3).material(floor)).expect("a valid rod");
        starts.push(scene.add_sphere(down(ball(&scene, own, [30.0, 0.501, z], 0.5))).expect("a valid sphere"));
        scene.add_box(Cuboid::between([38.0, -1.0, z - 2.0], [44.0, 0.0, z + 2.0]).material(floor)).expect("a valid box");
        let capsule = Capsule::new([40.0, 0.501, z], [40.0, 2.501, z], 0.5).density(1.0).velocity([0.0, -1.0, 0.0]);
        let id = scene.add_capsule(capsule.material(own)).expect("a valid capsule");
        starts.push(scene.capsule(id).expect("the capsule").end1);
    }
    let mut simulation = simulation(scene, backend);
    simulation.run(steps, 0.12 / steps as f32).expect("steps");
    let scene = simulation.sync().expect("the state");
    let velocity = |id| scene.sphere(id).expect("a sphere").velocity;
    for (e, ids) in wanted.iter().zip(starts.chunks_exact(6)) {
        let apart = f64::from(velocity(ids[1]).x - velocity(ids[0]).x);
        assert_close(apart, (*e).into(), tolerance, &format!("{law}, two balls, e = {e}"));
        for (id, what) in ids[2..].iter().zip(["box", "polygon", "rod", "capsule"]) {
            assert_close(velocity(*id).y.into(), (*e).into(), tolerance, &format!("{law}, {what}, e = {e}"));
        }
    }
}

/// An elastic impact at the characteristic velocity of `linear` is as deep as by Hertz, (15 m* V² / (16 E* sqrt R*))^(2/5). The
/// other impact speed differs by a factor of 2, and its depth too, because the spring is linear.
fn impacts_at_the_characteristic_velocity_are_as_deep_as_by_hertz(backend: Backend) {
    for (factor, plane) in [(1.0_f32, false), (2.0, false), (1.0, true)] {
        let mut scene = scene_with(ContactLaw::Linear);
        let material = soft(&mut scene, "soft");
        let properties = Pair::default().restitution(1.0).characteristic_velocity(0.5);
        scene.set_pair(material, material, properties).expect("a valid pair");
        let falling = ball(&scene, material, [0.0, 0.801, 0.0], 0.5).velocity([0.0, -0.5 * factor, 0.0]);
        let (mut mass, mut radius) = (f64::from(falling.mass), 0.5_f64);
        scene.add_sphere(falling).expect("a valid sphere");
        if plane {
            scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.301, 1.0]).material(material)).expect("a valid box");
        } else {
            let other = ball(&scene, material, [0.0; 3], 0.3);
            (mass, radius) = (mass * f64::from(other.mass) / (mass + f64::from(other.mass)), 0.15 / 0.8);
            scene.add_sphere(other).expect("a valid sphere");
        }
        let time = scene.law_time().expect("a time").seconds;
        assert!(time > 0.0);
        let mut simulation = simulation(scene, backend);
        let (steps, dt) = crate::common::on(backend, (2000, 5e-5), (200, 5e-4));
        let deepest = (0..steps).map(|_| simulation.run(1, dt).expect("a step").max_overlap).fold(0.0, f32::max);
        let young = 1e5 / (2.0 * (1.0 - 0.0625));
        let hertz = (15.0 * mass * 0.25 / (16.0 * young * radius.sqrt())).powf(0.4);
        assert_close(deepest.into(), f64::from(factor) * hertz, 0.01, "deepest overlap");
    }
}

fn linear_impacts_rebound_with_the_restitution_of_their_pair(backend: Backend) {
    impacts_rebound_with_the_restitution_of_their_pair(ContactLaw::Linear, backend);
}

fn hertz_mindlin_impacts_rebound_with_the_restitution_of_their_pair(backend: Backend) {
    impacts_rebound_with_the_restitution_of_their_pair(ContactLaw::HertzMindlin, backend);
}

both!(
    impacts_at_the_characteristic_velocity_are_as_deep_as_by_hertz,
    linear_impacts_rebound_with_the_restitution_of_their_pair,
    hertz_mindlin_impacts_rebound_with_the_restitution_of_their_pair,
);
