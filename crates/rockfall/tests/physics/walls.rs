//! Walls that move on prescribed paths (docs/physics section 2.12), against closed forms.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, Checkpoint, ContactLaw, Cuboid, Integrator, Material, Motion, MotionId, MotionTerm, Options, Pair,
    Polygon, Scene, Simulation, Sphere, SphereState, Tag,
};

use crate::common::{bits_of, close, near, on, open, with};

const INTEGRATORS: [Integrator; 3] = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// A scene of smooth bodies without gravity. All contacts that approach collide, with restitution `e`.
fn smooth(e: f32) -> Scene {
    with(|settings| {
        (settings.gravity, settings.activation_threshold, settings.restitution) = (0.0, 0.0, e);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    })
}

fn slide(scene: &mut Scene, velocity: [f64; 3]) -> MotionId {
    scene.add_motion(Motion::new("slide", MotionTerm::translation(velocity))).expect("a valid motion")
}

/// A face in the plane x = `x`, which points along +x or -x: of a box or a polygon.
fn add_face(scene: &mut Scene, x: f32, forward: bool, is_box: bool, motion: Option<MotionId>) {
    if is_box {
        let [min, max] = if forward { [x - 1.0, x] } else { [x, x + 1.0] };
        let mut cuboid = Cuboid::between([min, -2.0, -2.0], [max, 2.0, 2.0]);
        cuboid.motion = motion;
        scene.add_box(cuboid).expect("a valid box");
    } else {
        let edges = [[0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
        let [left, right] = if forward { edges } else { [edges[1], edges[0]] };
        let mut polygon = Polygon::new([x, -2.0, -2.0], left, right);
        polygon.motion = motion;
        scene.add_polygon(polygon).expect("a valid polygon");
    }
}

fn only(simulation: &mut Simulation) -> SphereState {
    simulation.spheres().expect("spheres are read back")[0]
}

/// A racket at speed u returns a ball of velocity v with (1 + e) u - e v, from where they meet. A ball at rest, in a group of its own
/// with a racket of its own, gets (1 + e) u.
fn a_racket_returns_a_ball(backend: Backend) {
    for (integrator, is_box, e) in
        INTEGRATORS.into_iter().flat_map(|integrator| [(integrator, true, 1.0_f32), (integrator, false, 0.5)])
    {
        let mut scene = smooth(e);
        let motion = slide(&mut scene, [1.0, 0.0, 0.0]);
        add_face(&mut scene, 0.0, true, is_box, Some(motion));
        scene.add_sphere(Sphere::new([1.0, 0.1, 0.0], 0.1).velocity([-2.0, 0.3, 0.0])).expect("a valid sphere");
        scene.add_box(Cuboid::between([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]).motion(motion).group(1)).expect("a valid box");
        scene.add_sphere(Sphere::new([0.4, 0.0, 0.0], 0.1).group(1)).expect("a valid sphere");
        let mut simulation = open(scene, backend, integrator);
        simulation.run(40, 0.02).expect("steps");
        let struck = simulation.spheres().expect("spheres are read back")[1];
        near(struck.velocity, [1.0 + f64::from(e), 0.0, 0.0], 1e-5, &format!("velocity of the ball at rest, {integrator}"));
        near(struck.position, [0.4 + 0.5 * (1.0 + f64::from(e)), 0.0, 0.0], 1e-5, "place of the ball at rest");
        let (ball, e) = (only(&mut simulation), f64::from(e));
        let speed = (1.0 + e) + 2.0 * e;
        near(ball.velocity, [speed, 0.3, 0.0], 1e-5, &format!("velocity, {integrator}, e = {e}"));
        let place = 0.4 + speed * (0.8 - 0.3);
        near(ball.position, [place, 0.1 + 0.8 * 0.3, 0.0], 1e-5, &format!("place, {integrator}, e = {e}"));
    }
}

/// A wall that closes in at u adds 2 u to the speed of an elastic ball at every hit: v_k = v_0 + 2 k u.
fn a_closing_wall_speeds_a_ball_up(backend: Backend) {
    for (integrator, is_box) in INTEGRATORS.into_iter().zip([true, false, true]) {
        let mut scene = smooth(1.0);
        let motion = slide(&mut scene, [-0.5, 0.0, 0.0]);
        add_face(&mut scene, 0.0, true, !is_box, None);
        add_face(&mut scene, 3.0, false, is_box, Some(motion));
        scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).velocity([1.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = open(scene, backend, integrator);
        let mut seen = vec![1.0];
        for _ in 0..on(backend, 200, 80) {
            simulation.run(2, 0.01).expect("steps");
            let speed = f64::from(only(&mut simulation).velocity.x.abs());
            if (speed - seen[seen.len() - 1]).abs() > 0.5 {
                seen.push(speed);
            }
        }
        let hits = on(backend, 3, 1);
        assert!(seen.len() > hits, "{integrator}: {seen:?}");
        for (hit, speed) in seen.iter().enumerate() {
            close(*speed, 1.0 + hit as f64, 1e-4, &format!("{integrator}, speed after {hit} hits"));
        }
    }
}

/// A bat that turns hits a ball at the time and in the direction that the geometry gives.
fn a_bat_that_turns_hits_a_ball(backend: Backend) {
    let (spin, start, speed, radius) = (1.5, DVec3::new(1.0, 0.6, 0.0), 1.0, 0.1);
    let height = |time: f64| {
        let (normal, ball) = (normal_at(spin * time), start - speed * time * DVec3::Y);
        normal.dot(ball) - radius
    };
    let (mut before, mut after) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (before + after);
        *(if height(middle) > 0.0 { &mut before } else { &mut after }) = middle;
    }
    let (normal, hit) = (normal_at(spin * before), start - speed * before * DVec3::Y);
    let wall = spin * DVec3::Z.cross(hit - radius * normal);
    let velocity = -speed * DVec3::Y;
    let expected = velocity + 1.8 * (wall - velocity).dot(normal) * normal;
    for integrator in INTEGRATORS {
        let mut scene = smooth(0.8);
        let turn = MotionTerm::turn(spin, [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]);
        let motion = scene.add_motion(Motion::new("bat", turn)).expect("a valid motion");
        scene.add_box(Cuboid::between([-0.5, -0.2, -1.0], [2.0, 0.0, 1.0]).motion(motion)).expect("a valid box");
        scene.add_sphere(Sphere::new(start.as_vec3(), 0.1).velocity(velocity.as_vec3())).expect("a valid sphere");
        let mut simulation = open(scene, backend, integrator);
        simulation.run(40, 0.01).expect("steps");
        let ball = only(&mut simulation);
        near(ball.velocity, expected, 2e-3, &format!("velocity, {integrator}"));
        near(ball.position, hit + (0.4 - before) * expected, 2e-3, &format!("place, {integrator}"));
    }
}

fn normal_at(angle: f64) -> DVec3 {
    DVec3::new(-angle.sin(), angle.cos(), 0.0)
}

/// A scene with a law with history, and its only material.
fn grains(law: ContactLaw, e: f32, friction: f32) -> (Scene, rockfall::MaterialId) {
    let mut scene = Scene::new();
    scene.settings.contact_law = law;
    (scene.settings.collisions, scene.settings.gravity) = (false, 0.0);
    let hard = scene.add_material(Material::new("hard").density(1.0).young(1e6).poisson(0.25)).expect("a valid material");
    let pair = Pair::default().restitution(e).friction(friction).stiffness(1e4);
    scene.set_pair(hard, hard, pair).expect("a valid pair");
    (scene, hard)
}

const LAWS: [ContactLaw; 2] = [ContactLaw::Linear, ContactLaw::HertzMindlin];

/// The racket again, with contact forces.
fn a_racket_with_contact_forces_returns_a_ball(backend: Backend) {
    for (law, integrator) in LAWS.into_iter().zip([Integrator::SymplecticEuler, Integrator::VelocityVerlet]) {
        let (mut scene, hard) = grains(law, 0.6, 0.0);
        let motion = slide(&mut scene, [1.0, 0.0, 0.0]);
        let wall = Cuboid::between([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]).material(hard);
        scene.add_box(wall.motion(motion)).expect("a valid box");
        let ball = Sphere::new([0.12, 0.0, 0.0], 0.1).density(1.0).velocity([-2.0, 0.0, 0.0]).material(hard);
        scene.add_sphere(ball).expect("a valid sphere");
        scene.add_box(wall.motion(motion).group(1)).expect("a valid box");
        let resting = Sphere::new([0.105, 0.0, 0.0], 0.1).density(1.0).material(hard);
        scene.add_sphere(resting.group(1)).expect("a valid sphere");
        let mut simulation = open(scene, backend, integrator);
        simulation.run(on(backend, 3000, 300), on(backend, 1e-5, 1e-4)).expect("steps");
        let balls = simulation.spheres().expect("spheres are read back");
        for (ball, expected) in balls.iter().zip([1.6 + 1.2, 1.6]) {
            close(ball.velocity.x, expected, on(backend, 0.02, 0.1), &format!("{law}"));
        }
    }
}

/// A belt at U carries a sphere along: it slips for 2 U / (7 mu g), and then rolls with the velocity 2 U / 7.
fn a_belt_carries_a_sphere_along(backend: Backend) {
    for law in LAWS {
        let (mut scene, hard) = grains(law, 0.2, 0.5);
        scene.settings.gravity = 10.0;
        let motion = slide(&mut scene, [0.7, 0.0, 0.0]);
        let belt = Polygon::new([-5.0, 0.0, -2.0], [0.0, 0.0, 4.0], [10.0, 0.0, 0.0]).material(hard);
        scene.add_polygon(belt.motion(motion)).expect("a valid polygon");
        scene.add_sphere(Sphere::new([0.0, 0.1, 0.0], 0.1).density(1.0).material(hard)).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 3000, 1000), 1e-4).expect("steps");
        let ball = only(&mut simulation);
        close(ball.velocity.x, 0.2, 2e-3, &format!("{law}, velocity"));
        // The surface of the ball goes with the belt.
        let spin = ball.angular_momentum.z / (0.4 * ball.mass * 0.01);
        close(ball.velocity.x + 0.1 * spin, 0.7, 2e-3, &format!("{law}, spin"));
    }
}

/// Friction impulses carry a sphere along, too.
fn friction_impulses_act_between_a_ball_and_a_belt(backend: Backend) {
    let mut scene = with(|settings| (settings.coulomb_friction, settings.gravity) = (0.5, 10.0));
    let motion = slide(&mut scene, [0.7, 0.0, 0.0]);
    let belt = Cuboid::between([-5.0, -1.0, -2.0], [5.0, 0.0, 2.0]).motion(motion);
    scene.add_box(belt).expect("a valid box");
    let height = 0.5 - 10.0 / scene.settings.contact_force;
    scene.add_sphere(Sphere::new([0.0, height, 0.0], 0.5)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    simulation.run(100, 0.005).expect("steps");
    // The arm of the impulse is shorter than the radius by the overlap.
    let expected = 0.7 / (1.0 + 2.5 * f64::from(height / 0.5).powi(2));
    close(only(&mut simulation).velocity.x, expected, 1e-4, "velocity");
}

/// With continuous collisions, a racket that jumps over a ball within a step returns it.
fn a_racket_cannot_jump_over_a_ball(backend: Backend) {
    for is_box in [true, false] {
        let mut scene = smooth(1.0);
        scene.settings.continuous_collisions = true;
        let motion = slide(&mut scene, [30.0, 0.0, 0.0]);
        if is_box {
            let plate = Cuboid::between([-0.02, -2.0, -2.0], [0.0, 2.0, 2.0]).motion(motion);
            scene.add_box(plate).expect("a valid box");
        } else {
            add_face(&mut scene, 0.0, true, false, Some(motion));
        }
        scene.add_sphere(Sphere::new([0.8, 0.0, 0.0], 0.1).velocity([-1.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        simulation.run(8, 0.02).expect("steps");
        let ball = only(&mut simulation);
        near(ball.velocity, [61.0, 0.0, 0.0], 1e-3, "velocity");
        let hit = 0.7 / 31.0;
        near(ball.position, [0.8 - hit + 61.0 * (0.16 - hit), 0.0, 0.0], 1e-3, "place");
    }
}

/// Balls in a box with a lid that swings and a floor that shakes, in the world's side walls.
fn shaken(law: Option<ContactLaw>) -> Scene {
    let (mut scene, hard) = match law {
        Some(law) => {
            let (scene, hard) = grains(law, 0.6, 0.4);
            (scene, Some(hard))
        }
        None => (Scene::new(), None),
    };
    scene.settings.gravity = 10.0;
    let shake = MotionTerm::oscillation([0.0, 0.05, 0.0], 4.0).phase(0.1);
    let swing = MotionTerm::turn(3.0, [1.0, 0.0, 0.2], [0.0, 0.9, 0.0]);
    let floor = scene.add_motion(Motion::new("floor", shake)).expect("a valid motion");
    let paddle = scene.add_motion(Motion::new("paddle", shake.during(0.05, 0.3)).and(swing)).expect("a valid motion");
    let of = |mut cuboid: Cuboid, motion| {
        (cuboid.material, cuboid.motion) = (hard, motion);
        cuboid
    };
    for (min, max, motion) in [
        ([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0], Some(floor)),
        ([-0.8, 0.85, -0.3], [0.8, 0.95, 0.3], Some(paddle)),
        ([-2.0, -1.0, -1.0], [-0.8, 3.0, 1.0], None),
        ([0.8, -1.0, -1.0], [2.0, 3.0, 1.0], None),
    ] {
        scene.add_box(of(Cuboid::between(min, max), motion)).expect("a valid box");
    }
    for (corner, left, right, motion) in [
        ([-1.0, -1.0, -0.8], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0], None),
        ([-1.0, -1.0, 0.8], [0.0, 4.0, 0.0], [2.0, 0.0, 0.0], None),
        ([-1.0, 2.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], Some(floor)),
    ] {
        let mut face = Polygon::new(corner, left, right);
        (face.material, face.motion) = (hard, motion);
        scene.add_polygon(face).expect("a valid polygon");
    }
    for k in 0..60_u8 {
        let [x, y, z] = [k % 5, k / 20, k / 5 % 4].map(f32::from);
        let mut ball = Sphere::new([0.31 * x - 0.6, 0.12 + 0.54 * y + 0.01 * z, 0.4 * z - 0.55 + 0.01 * x], 0.11).density(1.0);
        ball.material = hard;
        scene.add_sphere(ball).expect("a valid sphere");
    }
    scene
}

/// Results do not depend on how pairs are found, and a run that is resumed goes on with the same bits.
fn lists_and_checkpoints_do_not_change_results(backend: Backend) {
    let kinds =
        [(None, Integrator::Rk4), (Some(ContactLaw::Linear), Integrator::SymplecticEuler), (None, Integrator::SymplecticEuler)];
    for (law, integrator) in kinds {
        let scene = shaken(law);
        let dt = if law.is_some() { 5e-4 } else { 0.01 };
        let steps = on(backend, 90, 24);
        let run = |broad_phase| {
            let options = Options::new().backend(backend).integrator(integrator).broad_phase(broad_phase);
            let mut simulation = Simulation::with_options(scene.clone(), options).expect("the simulation opens");
            simulation.run(steps / 2, 0.003).expect("steps");
            simulation.run(steps, dt).expect("steps");
            simulation
        };
        let mut grid = run(BroadPhase::Grid);
        let checkpoint =
            Checkpoint::from_bytes(&grid.checkpoint().expect("a checkpoint").to_bytes(), "memory").expect("intact");
        let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
        let state = bits_of(&mut grid);
        let rises = |ball: &SphereState| ball.velocity.y > 0.1;
        assert!(grid.spheres().expect("spheres are read back").iter().any(rises), "the floor throws balls up");
        for broad_phase in [BroadPhase::BruteForce, BroadPhase::SortAndSkip] {
            assert!(bits_of(&mut run(broad_phase)) == state, "{broad_phase}, {integrator}");
        }
        for simulation in [&mut grid, &mut resumed] {
            simulation.run(steps, dt).expect("steps");
        }
        assert!(bits_of(&mut grid) == bits_of(&mut resumed), "{integrator}: resumed");
        let mut one_by_one = open(scene, backend, integrator);
        for step in 0..steps / 2 + steps {
            one_by_one.step(if step < steps / 2 { 0.003 } else { dt }).expect("a step");
        }
        assert!(bits_of(&mut one_by_one) == state, "{integrator}: step by step");
    }
}

/// A plate that lies flush on a floor and belongs to another body touches a ball as well.
fn shapes_of_other_bodies_are_not_hidden(backend: Backend) {
    let contacts = |moves: bool| {
        let mut scene = smooth(1.0);
        let motion = scene.add_motion(Motion::new("still", MotionTerm::default())).expect("a valid motion");
        scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [0.0, 0.0, 1.0])).expect("a valid box");
        let mut plate = Cuboid::between([0.0, -1.0, -1.0], [1.0, 0.0, 1.0]);
        plate.motion = moves.then_some(motion);
        scene.add_box(plate).expect("a valid box");
        scene.add_sphere(Sphere::new([0.0, 0.99, 0.0], 1.0)).expect("a valid sphere");
        open(scene, backend, Integrator::Rk4).step(1e-3).expect("a step").contacts
    };
    assert_eq!([false, true].map(contacts), [1, 2]);
}

/// A snapshot begins where the simulation is. Contacts of the present state are those with the walls where they are.
fn snapshots_and_observations_have_the_walls_where_they_are(backend: Backend) {
    let mut scene = smooth(1.0);
    let motion = slide(&mut scene, [0.0, 1.0, 0.0]);
    let plate = Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]).motion(motion);
    scene.add_box(plate).expect("a valid box");
    scene.add_sphere(Sphere::new([0.0, 0.609, 0.0], 0.5)).expect("a valid sphere");
    scene.settings.collisions = false;
    let mut simulation = open(scene, backend, Integrator::Rk4);
    assert_eq!(simulation.contacts().expect("contacts").len(), 0);
    simulation.run(10, 0.01).expect("steps");
    assert_eq!(simulation.contacts().expect("contacts").len(), 0);
    let scene = simulation.snapshot().expect("a snapshot");
    let wall = scene.motion(motion).expect("the motion").terms[0];
    assert_eq!((wall.from, scene.boxes()[0].corner), (-0.1, Vec3::splat(-1.0)));
    let mut again = open(scene, backend, Integrator::Rk4);
    simulation.run(1, 0.01).expect("a step");
    again.run(1, 0.01).expect("a step");
    assert_eq!(simulation.contacts().expect("contacts").len(), 1);
    simulation.run(10, 0.01).expect("steps");
    again.run(10, 0.01).expect("steps");
    assert_eq!(bits_of(&mut simulation), bits_of(&mut again));
}

/// A wall that gets a new velocity while a simulation runs goes on from where it is: a ball that it pushes has its velocity, and the
/// face is where the sum of both ways puts it. Then it stops.
fn a_wall_goes_on_without_a_jump(backend: Backend) {
    let mut scene = smooth(0.0);
    let motion = slide(&mut scene, [1.0, 0.0, 0.0]);
    add_face(&mut scene, 0.0, true, true, Some(motion));
    scene.add_sphere(Sphere::new([0.5, 0.0, 0.0], 0.1)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    simulation.run(60, 0.01).expect("steps");
    near(only(&mut simulation).velocity, [1.0, 0.0, 0.0], 1e-5, "velocity with the wall");
    simulation.go_on(motion, MotionTerm::translation([3.0, 0.0, 0.0])).expect("a valid term");
    simulation.run(50, 0.01).expect("steps");
    near(only(&mut simulation).velocity, [3.0, 0.0, 0.0], 1e-4, "velocity with the faster wall");
    let face = simulation.cast_ray([5.0, 1.0, 0.0], [-1.0, 0.0, 0.0]).expect("a valid ray").expect("the wall");
    close(f64::from(face.point.x), 0.6 + 3.0 * 0.5, 1e-5, "place of the face");
    simulation.go_on(motion, MotionTerm::default()).expect("a valid term");
    simulation.run(20, 0.01).expect("steps");
    let face = simulation.cast_ray([5.0, 1.0, 0.0], [-1.0, 0.0, 0.0]).expect("a valid ray").expect("the wall");
    close(f64::from(face.point.x), 0.6 + 3.0 * 0.5, 1e-5, "place of the face at rest");
}

/// A ball that is put at rest on a belt of speed U slips for 2 U / (7 mu g) and then rolls at 2 U / 7, whether the belt is a box or a
/// polygon, at rest or carried along. The part of the surface velocity across the belt does not push it. A wall that faces along the
/// belt does not either.
fn a_belt_takes_a_ball_along(backend: Backend) {
    let (speed, friction, gravity) = (0.7, 0.2, 9.81);
    for (law, is_box, carried) in
        [(ContactLaw::Thesis, true, 0.0), (ContactLaw::HertzMindlin, true, 0.0), (ContactLaw::HertzMindlin, false, 0.3)]
    {
        let mut scene = with(|settings| {
            settings.set("contact_law", &law.to_string()).expect("a law");
            settings.gravity = gravity as f32;
            // At rest, the ball overlaps the belt by 1 % of its radius.
            (settings.contact_force, settings.contact_damping) = (2e4, 100.0);
        });
        let rubber = scene.add_material(Material::new("rubber").density(1_000.0).young(1e7).poisson(0.3)).expect("a material");
        let pair = Pair::default().restitution(0.3).friction(friction);
        scene.set_pair(rubber, rubber, pair).expect("a valid pair");
        let motion = slide(&mut scene, [0.0, 0.0, carried]);
        let surface = [speed as f32, 0.4, 0.0];
        if is_box {
            let belt = Cuboid::between([-3.0, -0.1, -3.0], [3.0, 0.0, 3.0]).surface_velocity(surface);
            scene.add_box(belt.material(rubber)).expect("a valid box");
        } else {
            let belt = Polygon::new([-3.0, 0.0, -3.0], [0.0, 0.0, 6.0], [6.0, 0.0, 0.0]).surface_velocity(surface);
            scene.add_polygon(belt.material(rubber).motion(motion)).expect("a valid polygon");
        }
        let (radius, mass) = (0.05_f32, 0.5);
        let ball = Sphere::new([-1.0, radius, 0.0], radius).mass(mass).velocity([0.0, 0.0, carried as f32]);
        // It rolls with what carries the belt from the start.
        scene.add_sphere(ball.material(rubber)).expect("a valid sphere");
        let integrator = if law == ContactLaw::Thesis { Integrator::Rk4 } else { Integrator::VelocityVerlet };
        let mut simulation = open(scene, backend, integrator);
        let dt = if law == ContactLaw::Thesis { 0.002_f64 } else { 5e-5 };
        let slips = 2.0 * speed / (7.0 * f64::from(friction) * gravity);
        simulation.run((0.5 * slips / dt) as u64, dt as f32).expect("steps");
        let half = only(&mut simulation);
        close(f64::from(half.velocity.x), speed / 7.0, 0.03 * speed, &format!("velocity while it slips, {law}"));
        simulation.run((0.8 * slips / dt) as u64, dt as f32).expect("steps");
        let ball = only(&mut simulation);
        close(f64::from(ball.velocity.x), 2.0 * speed / 7.0, 0.01 * speed, &format!("velocity when it rolls, {law}"));
        close(f64::from(ball.velocity.y), 0.0, 2e-3, "velocity across");
        close(f64::from(ball.velocity.z), carried, 5e-3, "velocity with the belt");
    }
}

/// A pile at rest in a box weighs what its grains weigh: the load on the floor is the weight, and the torque that of the weights.
fn a_floor_bears_the_weight(backend: Backend) {
    for law in [ContactLaw::Thesis, ContactLaw::HertzMindlin] {
        let mut scene = with(|settings| {
            settings.set("contact_law", &law.to_string()).expect("a law");
            settings.gravity = 9.81;
        });
        let glass = scene.add_material(Material::new("glass").density(2_500.0).young(1e6).poisson(0.3)).expect("a material");
        scene.set_pair(glass, glass, Pair::default().restitution(0.3).friction(0.5)).expect("a valid pair");
        let floor = scene.add_box(Cuboid::between([-1.0, -0.1, -1.0], [1.0, 0.0, 1.0]).material(glass)).expect("a valid box");
        scene.set_tag(floor, Tag::new().name("floor")).expect("a valid tag");
        let mut expected = DVec3::ZERO;
        for (x, y, mass) in [(0.3_f32, 0.1_f32, 1.0_f32), (0.3, 0.3, 2.0), (-0.5, 0.1, 0.5)] {
            scene.add_sphere(Sphere::new([x, y, 0.2], 0.1).mass(mass).material(glass)).expect("a valid sphere");
            expected += DVec3::new(f64::from(x), 0.0, 0.2).cross(DVec3::new(0.0, -9.81 * f64::from(mass), 0.0));
        }
        let (integrator, dt) =
            if law == ContactLaw::Thesis { (Integrator::Rk4, 0.005) } else { (Integrator::VelocityVerlet, 2e-4) };
        let mut simulation = open(scene, backend, integrator);
        simulation.run(on(backend, 10_000, 2_500), dt).expect("steps");
        let load = simulation.wall_load("floor").expect("a wall of that name");
        assert_eq!(load.contacts, 2, "{law}");
        let tolerance = if backend == Backend::Cpu { 0.01 } else { 0.05 };
        close(load.force.y, -9.81 * 3.5, tolerance * 35.0, &format!("weight, {law}"));
        near(load.torque.as_vec3(), expected, tolerance * 8.0, &format!("torque, {law}"));
        assert!(simulation.wall_load("wall").unwrap_err().to_string().contains("'wall'"));
    }
}

both! {
    a_floor_bears_the_weight,
    a_belt_takes_a_ball_along,
    a_wall_goes_on_without_a_jump,
    a_racket_returns_a_ball,
    a_closing_wall_speeds_a_ball_up,
    a_bat_that_turns_hits_a_ball,
    a_racket_with_contact_forces_returns_a_ball,
    a_belt_carries_a_sphere_along,
    friction_impulses_act_between_a_ball_and_a_belt,
    a_racket_cannot_jump_over_a_ball,
    lists_and_checkpoints_do_not_change_results,
    shapes_of_other_bodies_are_not_hidden,
    snapshots_and_observations_have_the_walls_where_they_are,
}
