//! Contacts that begin and end within a step (docs/physics section 3.10), against closed forms.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{Backend, BroadPhase, Cuboid, Integrator, Options, Polygon, Scene, Simulation, Sphere, SphereState};

use crate::common::{bits_of, close, euler, near, on, simulation, with};

use crate::faults::scenes::{Random, after, angular, in_gravity, kinetic};

/// An empty scene of smooth elastic bodies without gravity. All contacts that approach collide.
fn elastic(continuous: bool) -> Scene {
    with(|settings| {
        settings.continuous_collisions = continuous;
        (settings.gravity, settings.activation_threshold) = (0.0, 0.0);
        (settings.restitution, settings.friction, settings.contact_damping) = (1.0, 0.0, 0.0);
    })
}

/// A state of two spheres: positions, velocities.
type Pair = ([DVec3; 2], [DVec3; 2]);

/// The state of two free elastic spheres of radius 0.5 after a time. They meet once.
fn closed_form((x, v): Pair, masses: [f64; 2], time: f64) -> Pair {
    let (d, p) = (x[1] - x[0], v[1] - v[0]);
    let (a, b, c) = (p.length_squared(), d.dot(p), d.length_squared() - 1.0);
    let hit = (-b - (b * b - a * c).sqrt()) / a;
    let n = d + hit * p;
    let j = -2.0 * p.dot(n) / (1.0 / masses[0] + 1.0 / masses[1]);
    let after = [v[0] - j / masses[0] * n, v[1] + j / masses[1] * n];
    ([0, 1].map(|k| x[k] + hit * v[k] + (time - hit) * after[k]), after)
}

const GRAZING_STEP: f32 = 0.1;

/// Pairs of spheres that graze each other, each pair in a group of its own, so that all are near the origin.
fn grazing(continuous: bool, pairs: u16) -> (Scene, Vec<[f64; 2]>) {
    let (mut random, mut scene, mut masses) = (Random::new(11), elastic(continuous), Vec::new());
    for group in 0..pairs {
        let [speed, side] = [random.between(4.0, 10.0), random.between(0.9, 0.999)];
        let (turn, tilt) = (random.between(0.0, std::f64::consts::TAU), random.between(-1.5, 1.5));
        let along = DVec3::new(turn.cos() * tilt.cos(), tilt.sin(), turn.sin() * tilt.cos());
        let across = along.any_orthonormal_vector();
        // The overlap ends before the pair has gone on by twice its length.
        let start = random.between(0.6, 1.5);
        let of = [random.between(0.5, 2.0), random.between(0.5, 2.0)];
        let drift = DVec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.0);
        for (sign, mass) in [(-0.5, of[0]), (0.5, of[1])] {
            let place = sign * (start * along + side * across);
            let ball = Sphere::new(place.as_vec3(), 0.5).mass(mass as f32).velocity((drift - sign * speed * along).as_vec3());
            scene.add_sphere(ball.group(group)).expect("a valid sphere");
        }
        masses.push(of.map(|mass| f64::from(mass as f32)));
    }
    (scene, masses)
}

fn state(states: &[SphereState]) -> Pair {
    ([0, 1].map(|k| states[k].position.as_dvec3()), [0, 1].map(|k| states[k].velocity.as_dvec3()))
}

/// Number of pairs that have met without a collision.
fn missed(before: &[SphereState], after: &[SphereState]) -> usize {
    let pairs = before.chunks(2).zip(after.chunks(2));
    pairs.filter(|(before, after)| before[0].velocity.distance(after[0].velocity) < 1e-3).count()
}

/// 200 grazing pairs at a large time step: none is missed, and each moves as in the closed form.
fn grazing_pairs_are_not_missed(backend: Backend) {
    let steps = 5;
    for integrator in Integrator::ALL {
        let run = |continuous: bool| {
            let (scene, masses) = grazing(continuous, 200);
            let options = Options::new().backend(backend).integrator(integrator);
            let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
            let before = simulation.spheres().expect("spheres");
            let after = after(&mut simulation, steps, GRAZING_STEP);
            (before, after, simulation.report().total_collisions, masses)
        };
        let (before, without, ..) = run(false);
        assert!(missed(&before, &without) > 60, "{} pairs are missed without the option", missed(&before, &without));
        let (before, after, collisions, masses) = run(true);
        assert_eq!((missed(&before, &after), collisions), (0, 200), "{integrator}");
        for ((before, after), masses) in before.chunks(2).zip(after.chunks(2)).zip(masses) {
            let time = f64::from(steps as f32 * GRAZING_STEP);
            let (x, v) = closed_form(state(before), masses, time);
            for k in 0..2 {
                near(after[k].velocity, v[k], 1e-3, "velocity");
                near(after[k].position, x[k], 1e-3, "position");
            }
            close(kinetic(after), kinetic(before), 1e-5 * kinetic(before), "kinetic energy");
            let momentum = |states: &[SphereState]| -> DVec3 {
                states.iter().map(|state| f64::from(state.mass) * state.velocity.as_dvec3()).sum()
            };
            near(momentum(after), momentum(before), 5e-6, "momentum");
            near(angular(after), angular(before), 5e-5, "angular momentum");
        }
    }
}

/// A crossing keeps e of the approach velocity, and one that approaches more slowly than the threshold is left out.
fn restitution_and_threshold_are_those_of_other_collisions(backend: Backend) {
    for (restitution, threshold) in [(0.0, 0.0), (0.5, 0.0), (0.5, 30.0)] {
        let mut scene = elastic(true);
        (scene.settings.restitution, scene.settings.activation_threshold) = (restitution, threshold);
        crate::common::spheres(
            &mut scene,
            [Sphere::new([-0.9, 0.8, 0.0], 0.5).velocity([20.0, 0.0, 0.0]), Sphere::new([0.0; 3], 0.5).mass(1e30)],
        );
        // n = (0.6, -0.8) at the first contact. The approach velocity is 12; the threshold is half of the setting.
        let states = after(&mut euler(scene, backend), 2, 0.1);
        let dv = if threshold > 20.0 { 0.0 } else { -12.0 * (1.0 + f64::from(restitution)) };
        near(states[0].velocity, [20.0 + 0.6 * dv, -0.8 * dv, 0.0], 1e-4, "velocity");
    }
}

/// A bullet passes a gap that is wider than itself, and not one that is narrower.
fn a_bullet_passes_a_gap_that_is_wide_enough(backend: Backend) {
    for (gap, collisions) in [(0.204, 0), (0.196, 1)] {
        let mut scene = elastic(true);
        let post = |side: f32| Sphere::new([0.0, side * (0.5 + 0.5 * gap), 0.0], 0.5).fixed();
        let bullet = Sphere::new([-1.0, 0.001, 0.0], 0.1).velocity([40.0, 0.0, 0.0]);
        crate::common::spheres(&mut scene, [post(-1.0), post(1.0), bullet]);
        let mut simulation = simulation(scene, backend);
        let states = after(&mut simulation, 2, 0.05);
        assert_eq!(simulation.report().total_collisions, collisions, "gap {gap}");
        assert_eq!(states[2].velocity.y == 0.0, collisions == 0, "gap {gap}");
    }
}

/// A bullet that flies through a plate in one step is reflected by the face, as far away as if it had been there.
fn a_bullet_is_reflected_by_a_thin_box(backend: Backend) {
    bullet_is_reflected(backend, |scene| {
        scene.add_box(Cuboid::between([-0.005, -5.0, -5.0], [0.005, 5.0, 5.0])).expect("a valid box");
        0.005
    });
}

fn a_bullet_is_reflected_by_a_polygon(backend: Backend) {
    bullet_is_reflected(backend, |scene| {
        // The normal L x R is -x.
        scene.add_polygon(Polygon::new([0.0, -5.0, -5.0], [0.0, 0.0, 10.0], [0.0, 10.0, 0.0])).expect("a valid polygon");
        0.0
    });
}

/// `wall` adds a wall whose face looks to -x and returns its distance from the plane x = 0.
fn bullet_is_reflected(backend: Backend, wall: impl Fn(&mut Scene) -> f64) {
    for (integrator, dt) in [(Integrator::Rk4, 0.05), (Integrator::SymplecticEuler, 0.03), (Integrator::VelocityVerlet, 0.05)] {
        let run = |continuous: bool| {
            let mut scene = elastic(continuous);
            let face = wall(&mut scene);
            scene.add_sphere(Sphere::new([-1.0, 0.0, 0.2], 0.05).velocity([40.0, 3.0, -2.0])).expect("a valid sphere");
            let options = Options::new().backend(backend).integrator(integrator);
            let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
            (after(&mut simulation, 3, dt)[0], face, simulation.report().total_collisions)
        };
        assert!(run(false).0.velocity.x > 39.0, "it is not seen without the option");
        let (bullet, face, collisions) = run(true);
        assert_eq!(collisions, 1, "{integrator}");
        let time = f64::from(3.0 * dt);
        near(bullet.velocity, [-40.0, 3.0, -2.0], 1e-4, "velocity");
        near(bullet.position, [-2.0 * (face + 0.05) + 1.0 - 40.0 * time, 3.0 * time, 0.2 - 2.0 * time], 1e-4, "position");
    }
}

/// A bullet that comes from behind a polygon passes it.
fn a_bullet_from_behind_passes_a_polygon(backend: Backend) {
    let mut scene = elastic(true);
    scene.add_polygon(Polygon::new([0.0, -5.0, -5.0], [0.0, 0.0, 10.0], [0.0, 10.0, 0.0])).expect("a valid polygon");
    scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.05).velocity([-40.0, 0.0, 0.0])).expect("a valid sphere");
    let mut simulation = simulation(scene, backend);
    near(after(&mut simulation, 3, 0.05)[0].velocity, [-40.0, 0.0, 0.0], 1e-5, "velocity");
}

/// Bullets that hit the edge or a corner of a small cube within a step: the normal is the direction from the bullet to it.
fn a_bullet_is_deflected_by_an_edge_and_a_corner(backend: Backend) {
    let diagonal = |n: [f64; 3], at: [f32; 3]| {
        let mut scene = elastic(true);
        scene.add_box(Cuboid::between([-0.1; 3], [0.1; 3])).expect("a valid box");
        scene.add_sphere(Sphere::new(at, 0.1).velocity([40.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = simulation(scene, backend);
        let states = after(&mut simulation, 2, 0.05);
        let (n, v) = (DVec3::from(n), DVec3::new(40.0, 0.0, 0.0));
        near(states[0].velocity, v - 2.0 * v.dot(n) * n, 2e-3, "velocity");
    };
    // The distance vector from the centre to the edge y = 0.1 is 0.1 (0.6, -0.8, 0), that to the corner 0.1 (2, -2, -1) / 3.
    diagonal([0.6, -0.8, 0.0], [-0.9, 0.18, 0.0]);
    diagonal([2.0 / 3.0, -2.0 / 3.0, -1.0 / 3.0], [-0.9, 0.1 + 0.2 / 3.0, 0.1 + 0.1 / 3.0]);
}

/// The same for the edge and the corner of a polygon. One whose centre is behind the plane passes it.
fn a_bullet_is_deflected_by_the_edge_of_a_polygon(backend: Backend) {
    let flies = |at: [f32; 3], expected: DVec3| {
        let mut scene = elastic(true);
        // The normal L x R is y.
        scene.add_polygon(Polygon::new([-0.1, 0.1, -9.9], [0.0, 0.0, 10.0], [10.0, 0.0, 0.0])).expect("a valid polygon");
        scene.add_sphere(Sphere::new(at, 0.1).velocity([40.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = simulation(scene, backend);
        near(after(&mut simulation, 2, 0.05)[0].velocity, expected, 2e-3, "velocity");
    };
    let v = DVec3::new(40.0, 0.0, 0.0);
    let reflected = |n: DVec3| v - 2.0 * v.dot(n) * n;
    flies([-0.9, 0.18, 0.0], reflected(DVec3::new(0.6, -0.8, 0.0)));
    flies([-0.9, 0.1 + 0.2 / 3.0, 0.1 + 0.1 / 3.0], reflected(DVec3::new(2.0, -2.0, -1.0) / 3.0));
    flies([-0.9, 0.08, 0.0], v);
    flies([-0.9, 0.21, 0.0], v);
}

/// Under gravity the energy of a ball that hits a thin floor in large steps stays what it is.
fn a_thin_floor_keeps_the_energy_under_gravity(backend: Backend) {
    for is_box in [true, false] {
        let mut scene = elastic(true);
        scene.settings.gravity = 10.0;
        if is_box {
            scene.add_box(Cuboid::between([-50.0, -0.01, -50.0], [50.0, 0.0, 50.0])).expect("a valid box");
        } else {
            scene.add_polygon(Polygon::new([-50.0, 0.0, -50.0], [0.0, 0.0, 100.0], [100.0, 0.0, 0.0])).expect("a polygon");
        }
        scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.05).mass(1.0).velocity([0.5, -3.0, 0.0])).expect("a valid sphere");
        let mut simulation = simulation(scene, backend);
        let states = after(&mut simulation, 300, 0.05);
        assert!(simulation.report().total_collisions >= 5, "{:?}", simulation.report());
        assert!(states[0].position.y > 0.0, "the ball is below the floor: {}", states[0].position);
        close(in_gravity(&states, 10.0, 0.0), 54.625, 0.3, "energy");
    }
}

/// Of two walls that a bullet would pass in a step, the first one reflects it, in whatever order they were added. The same holds
/// where the bullet ends its step in a block behind the first wall.
fn the_first_of_several_walls_counts(backend: Backend) {
    let plate = |x: f32| Cuboid::between([x, -5.0, -5.0], [x + 0.01, 5.0, 5.0]);
    let block = || Cuboid::between([0.8, -5.0, -5.0], [2.0, 5.0, 5.0]);
    for walls in [[plate(0.0), plate(0.3)], [plate(0.3), plate(0.0)], [plate(0.0), block()], [block(), plate(0.0)]] {
        let mut scene = elastic(true);
        for wall in walls {
            scene.add_box(wall).expect("a valid box");
        }
        scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.05).velocity([36.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = simulation(scene, backend);
        let states = after(&mut simulation, 2, 0.05);
        near(states[0].velocity, [-36.0, 0.0, 0.0], 1e-4, "velocity");
        near(states[0].position, [-2.7, 0.0, 0.0], 1e-4, "position");
        assert_eq!(simulation.report().total_collisions, 1);
    }
}

/// Of two balls in the way of a bullet, it hits the first one. The second one, which it would have passed later, stays at rest.
fn a_bullet_hits_the_first_of_two_balls(backend: Backend) {
    for places in [[0.0, 0.6], [0.6, 0.0]] {
        let mut scene = elastic(true);
        let ball = |x: f32| Sphere::new([x, 0.1, 0.0], 0.1).mass(1.0);
        crate::common::spheres(&mut scene, places.map(ball));
        scene.add_sphere(Sphere::new([-1.0, 0.0, 0.0], 0.1).mass(1.0).velocity([40.0, 0.0, 0.0])).expect("a valid sphere");
        let mut simulation = simulation(scene, backend);
        simulation.step(0.05).expect("a step");
        simulation.handle_collisions().expect("phase 3");
        let states = simulation.spheres().expect("spheres");
        let (first, second) = if places[0] == 0.0 { (0, 1) } else { (1, 0) };
        assert!(states[first].velocity.x > 1.0, "{:?}", states[first]);
        assert_eq!(states[second].velocity, Vec3::ZERO);
    }
}

/// Bodies have not moved before the first step, and not after an edit: a bullet that is put behind a wall has not passed it.
fn bodies_that_were_just_placed_have_not_crossed_anything(backend: Backend) {
    let mut scene = elastic(true);
    scene.add_box(Cuboid::between([-0.005, -5.0, -5.0], [0.005, 5.0, 5.0])).expect("a valid box");
    let id = scene.add_sphere(Sphere::new([0.5, 0.0, 0.0], 0.05).velocity([40.0, 0.0, 0.0])).expect("a valid sphere");
    let mut simulation = simulation(scene, backend);
    let states = after(&mut simulation, 3, 0.05);
    near(states[0].velocity, [40.0, 0.0, 0.0], 0.0, "velocity");
    simulation.set_position(id, [0.5, 0.0, 0.0]).expect("an edit");
    let states = after(&mut simulation, 3, 0.05);
    near(states[0].velocity, [40.0, 0.0, 0.0], 0.0, "velocity");
    near(states[0].position, [6.5, 0.0, 0.0], 1e-5, "position");
}

/// Small fast spheres in a cube of thin walls, among large ones: several of them cross something in each step.
fn gas(small: u8) -> Scene {
    let (mut random, mut scene) = (Random::new(3), elastic(true));
    for axis in 0..3 {
        for side in [-1.0_f32, 1.0] {
            let (mut low, mut high) = ([-2.1_f32; 3], [2.1_f32; 3]);
            (low[axis], high[axis]) = (side * 2.05 - 0.05, side * 2.05 + 0.05);
            scene.add_box(Cuboid::between(low, high)).expect("a valid box");
        }
    }
    for k in 0..8_u8 {
        let corner = [0, 1, 2].map(|bit| if k >> bit & 1 == 1 { 1.0 } else { -1.0 });
        let ball = Sphere::new(corner, 0.6).mass(1.0);
        scene.add_sphere(if k < 2 { ball.fixed() } else { ball }).expect("a valid sphere");
    }
    let mut placed: Vec<Vec3> = Vec::new();
    while placed.len() < usize::from(small) {
        let place = Vec3::from_array([0, 1, 2].map(|_| random.between(-1.9, 1.9) as f32));
        let is_free = (place.abs() - 1.0).length() > 0.7 && placed.iter().all(|other| other.distance(place) > 0.15);
        if is_free {
            placed.push(place);
            let velocity = [0, 1, 2].map(|_| random.between(-12.0, 12.0) as f32);
            scene.add_sphere(Sphere::new(place, 0.05).mass(0.1).velocity(velocity)).expect("a valid sphere");
        }
    }
    scene
}

fn gas_after(scene: Scene, backend: Backend, method: BroadPhase, integrator: Integrator, portions: &[u64]) -> (Vec<u32>, u64) {
    let options = Options::new().backend(backend).broad_phase(method).integrator(integrator);
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    for steps in portions {
        simulation.run(*steps, 0.04).expect("steps");
    }
    (bits_of(&mut simulation), simulation.report().total_collisions)
}

/// Broad phases and the way in which steps are run make no difference.
fn lists_and_batches_make_no_difference(backend: Backend) {
    let few = on(backend, 12, 6);
    for integrator in Integrator::ALL {
        let expected = gas_after(gas(60), backend, BroadPhase::BruteForce, integrator, &[2 * few]);
        assert!(expected.1 > 4 * few, "{} collisions", expected.1);
        for method in [BroadPhase::Grid, BroadPhase::SortAndSkip] {
            assert_eq!(gas_after(gas(60), backend, method, integrator, &[2 * few]), expected, "{method}, {integrator}");
        }
        let singly = vec![1; 2 * few as usize];
        assert_eq!(gas_after(gas(60), backend, BroadPhase::Grid, integrator, &singly), expected, "single steps, {integrator}");
    }
}

/// A simulation that is resumed from a checkpoint finds the crossings of the step before it.
fn a_resumed_simulation_continues_in_the_same_way(backend: Backend) {
    let steps = on(backend, 15, 6);
    let expected = gas_after(gas(60), backend, BroadPhase::Auto, Integrator::Rk4, &[2 * steps]);
    let mut first = simulation(gas(60), backend);
    first.run(steps, 0.04).expect("steps");
    let mut second = Simulation::resume(first.checkpoint().expect("a checkpoint")).expect("the simulation resumes");
    second.run(steps, 0.04).expect("steps");
    assert_eq!(bits_of(&mut second), expected.0);
}

/// Bullets that fly to and fro between two thin plates, each in a lane of its own, pass neither. They are where the closed form has
/// them, and energy is kept. Without the option, most of them escape.
fn bullets_stay_between_thin_plates(backend: Backend) {
    let (steps, lanes, dt) = (on(backend, 200, 40), 40_u8, 0.03_f32);
    let mut random = Random::new(5);
    let starts: Vec<[f32; 2]> =
        (0..lanes).map(|_| [random.between(-0.8, 0.8), random.between(5.0, 40.0)].map(|number| number as f32)).collect();
    let run = |continuous: bool| {
        let mut scene = elastic(continuous);
        for x in [-1.02, 1.0] {
            scene.add_box(Cuboid::between([x, -2.0, -9.0], [x + 0.02, 9.0, 9.0])).expect("a valid box");
        }
        for (lane, [x, speed]) in starts.iter().enumerate() {
            let bullet = Sphere::new([*x, 0.2 * lane as f32, 0.0], 0.05).velocity([*speed, 0.0, 1.0]);
            scene.add_sphere(bullet).expect("a valid sphere");
        }
        let mut simulation = simulation(scene, backend);
        let before = kinetic(&simulation.spheres().expect("spheres"));
        let states = after(&mut simulation, steps, dt);
        close(kinetic(&states) / before, 1.0, 1e-5, "kinetic energy");
        states
    };
    let escaped = run(false).iter().filter(|state| state.position.x.abs() > 1.1).count();
    assert!(escaped > 15, "{escaped} escape without the option");
    let (half, time) = (0.95, steps as f64 * f64::from(dt));
    for (state, [x, speed]) in run(true).iter().zip(starts) {
        // The way along a path that is folded at the plates.
        let folded = (f64::from(x) + half + f64::from(speed) * time).rem_euclid(4.0 * half);
        let expected = if folded < 2.0 * half { folded - half } else { 3.0 * half - folded };
        // A bullet that overlaps a plate has not been reflected yet.
        let now = f64::from(state.position.x);
        let late = if now.abs() > half { now.signum() * 2.0 * half - now } else { now };
        close(late, expected, 2e-3, "position");
        close(state.velocity.x.abs(), f64::from(speed), 1e-3, "speed");
    }
}

both!(
    grazing_pairs_are_not_missed,
    restitution_and_threshold_are_those_of_other_collisions,
    a_bullet_passes_a_gap_that_is_wide_enough,
    a_bullet_is_reflected_by_a_thin_box,
    a_bullet_is_reflected_by_a_polygon,
    a_bullet_from_behind_passes_a_polygon,
    a_bullet_is_deflected_by_an_edge_and_a_corner,
    a_bullet_is_deflected_by_the_edge_of_a_polygon,
    a_thin_floor_keeps_the_energy_under_gravity,
    the_first_of_several_walls_counts,
    a_bullet_hits_the_first_of_two_balls,
    bodies_that_were_just_placed_have_not_crossed_anything,
    lists_and_batches_make_no_difference,
    a_resumed_simulation_continues_in_the_same_way,
    bullets_stay_between_thin_plates,
);
