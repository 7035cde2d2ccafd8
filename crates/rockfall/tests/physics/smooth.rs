//! Smooth walls (docs/physics section 2.17): planes, cones, cylinders and balls, against closed forms and other shapes.

use std::f64::consts::{FRAC_PI_2, TAU};

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    Backend, Body, BroadPhase, ContactLaw, Gauge, GaugeReading, Integrator, Material, MaterialId, Motion, MotionTerm, Options,
    Pair, Polygon, Scene, Simulation, Sphere,
};

use crate::common::{bits, close, near, on, open, with};
use crate::faults::scenes::{Random, kinetic};
use crate::meshes::{elastic, spheres};

/// Grains of the linear law, in gravity 9.81.
fn grains(friction: f32, restitution: f32) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &ContactLaw::Linear.to_string()).expect("a law");
        settings.gravity = 9.81;
    });
    let glass = scene.add_material(Material::new("glass").density(2_500.0)).expect("a valid material");
    let pair = Pair::default().restitution(restitution).friction(friction).stiffness(1e4);
    scene.set_pair(glass, glass, pair).expect("a valid pair");
    (scene, glass)
}

/// Grains that fall and roll on a plane do what they do on a parallelogram, to the bit.
fn a_plane_is_a_large_parallelogram(backend: Backend) {
    let run = |wall: Polygon| {
        let (mut scene, glass) = grains(0.4, 0.5);
        scene.add_polygon(wall.material(glass)).expect("a valid wall");
        let mut random = Random::new(3);
        for k in 0..on(backend, 12, 5) {
            let place = [0.25 * k as f64 - 1.4, random.between(0.1, 0.12), random.between(-1.0, 1.0)];
            let velocity = [random.between(-0.3, 0.3), 0.0, random.between(-0.5, 0.5)];
            let grain = Sphere::new(place.map(|x| x as f32), 0.1).mass(2.0).velocity(velocity.map(|x| x as f32));
            scene.add_sphere(grain.material(glass)).expect("a valid sphere");
        }
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 1_000, 150), 5e-4).expect("steps");
        let contacts = simulation.report().contacts;
        (bits(&spheres(&mut simulation)), contacts)
    };
    let plane = run(Polygon::plane([0.3, 0.0, -0.2], [0.0, 2.0, 0.0]));
    assert!(plane.1 > 0, "no grain touches the floor");
    assert_eq!(plane, run(Polygon::new([8.3, 0.0, 7.8], [0.0, 0.0, -16.0], [-16.0, 0.0, 0.0])));
}

/// A plane that is not along an axis: a grain without friction slides with g sin a.
fn a_grain_slides_down_a_plane(backend: Backend) {
    let angle = 0.4_f64;
    let (mut scene, glass) = grains(0.0, 0.5);
    let normal = DVec3::new(angle.sin(), angle.cos(), 0.0);
    scene.add_polygon(Polygon::plane([0.0; 3], normal.as_vec3()).material(glass)).expect("a valid wall");
    // The overlap at rest.
    let radius = 0.1;
    let height = radius - 2.0 * 9.81 * angle.cos() / 1e4;
    scene.add_sphere(Sphere::new((height * normal).as_vec3(), radius as f32).mass(2.0).material(glass)).expect("a sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(1_000, 1e-4).expect("steps");
    let ball = spheres(&mut simulation)[0];
    let slid = 0.1 * 9.81 * angle.sin();
    near(ball.velocity, slid * DVec3::new(angle.cos(), -angle.sin(), 0.0), 1e-3 * slid, "velocity");
}

/// A ball that rolls in a horizontal tube has the frequency omega^2 = 5 g / (7 (R - r)), and one that slides g / (R - r).
fn a_ball_swings_in_a_tube(backend: Backend) {
    let (reach, radius, angle) = (0.09_f64, 0.01_f64, 0.05_f64);
    for (friction, share) in [(0.8, 5.0 / 7.0), (0.0, 1.0)] {
        let (mut scene, glass) = grains(friction, 0.5);
        let tube = Polygon::cylinder([0.0, 0.0, -0.1], [0.0, 0.0, 1.0], 0.1, 0.2).inside(true);
        scene.add_polygon(tube.material(glass)).expect("a valid wall");
        let place = [reach * angle.sin(), -reach * angle.cos(), 0.0].map(|x| x as f32);
        let ball = Sphere::new(place, radius as f32).density(2_500.0).material(glass);
        scene.add_sphere(ball).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let rate = (share * 9.81 / reach).sqrt();
        let dt = on(backend, 2e-5, 1e-4);
        let quarter = FRAC_PI_2 / rate * (1.0 + angle * angle / 16.0);
        simulation.run((quarter / f64::from(dt)).round() as u64, dt).expect("steps");
        let ball = spheres(&mut simulation)[0];
        let tolerance = on(backend, 0.005, 0.02);
        close(f64::from(ball.position.x), 0.0, tolerance * reach * angle, "place after a quarter of a period");
        close(f64::from(ball.velocity.x), -angle * reach * rate, tolerance * angle * reach * rate, "velocity at the bottom");
    }
}

/// A ball without friction goes round in a cone at the height h above the apex of the cone of its centre, with v^2 = g h.
fn a_ball_orbits_in_a_cone(backend: Backend) {
    let (mut scene, glass) = grains(0.0, 1.0);
    // 45 degrees: the radius is the height. The narrow end comes first.
    let cone = Polygon::cone([0.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.1, 1.1], 1.0).inside(true);
    scene.add_polygon(cone.material(glass)).expect("a valid wall");
    let (radius, way) = (0.05_f64, 0.6_f64);
    // The contact carries m g / sin 45.
    let overlap = 2.0 * 9.81 * 2.0_f64.sqrt() / 1e4;
    let apex = (radius - overlap) * 2.0_f64.sqrt();
    let speed = (9.81 * way).sqrt();
    let ball = Sphere::new([way as f32, (apex + way) as f32, 0.0], radius as f32).mass(2.0);
    scene.add_sphere(ball.velocity([0.0, 0.0, speed as f32]).material(glass)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let turn = TAU * way / speed;
    let steps = on(backend, 20_000_u64, 2_000);
    for quarter in 1..=4 {
        simulation.run(steps / 4, (turn / steps as f64) as f32).expect("steps");
        let ball = spheres(&mut simulation)[0];
        let (sin, cos) = (f64::from(quarter) * FRAC_PI_2).sin_cos();
        near(ball.position, [way * cos, apex + way, way * sin], 2e-3, &format!("place after {quarter} quarters"));
        near(ball.velocity, [-speed * sin, 0.0, speed * cos], 1e-2, &format!("velocity after {quarter} quarters"));
    }
}

/// A surface: its point for two parameters from 0 to 1.
type Surface = Box<dyn Fn(f64, f64) -> DVec3>;

/// The vector to the nearest point of a surface, by search in ever smaller windows.
fn to_nearest(surface: &Surface, place: DVec3) -> DVec3 {
    let (mut centre, mut half) = ([0.5, 0.5], 0.5);
    for _ in 0..14 {
        let steps = (-20..=20).map(|k| f64::from(k) / 20.0 * half);
        let around = steps.clone().flat_map(|i| steps.clone().map(move |k| [i, k]));
        let places = around.map(|[i, k]| [(centre[0] + i).clamp(0.0, 1.0), centre[1] + k]);
        let distance = |at: &[f64; 2]| surface(at[0], at[1]).distance(place);
        centre = places.min_by(|one, other| distance(one).total_cmp(&distance(other))).expect("places");
        half *= 0.3;
    }
    surface(centre[0], centre[1]) - place
}

/// Where a ball on a straight path touches a surface first: the direction to its nearest point, by bisection in f64.
fn normal_of_hit(surface: &Surface, x: DVec3, v: DVec3, radius: f64, time: f64) -> DVec3 {
    let to = |time: f64| to_nearest(surface, x + time * v);
    let first = (0..=40).map(|k| f64::from(k) / 40.0 * time).find(|time| to(*time).length() <= radius).expect("a hit");
    let (mut low, mut high) = (first - time / 40.0, first);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if to(middle).length() > radius { low = middle } else { high = middle }
    }
    to(low).normalize()
}

/// Elastic balls are reflected at the direction to the nearest point: of a cone from outside and from inside, of its rims, of a ball, and of a
/// cylinder in the box of a periodic scene. With `continuous_collisions` also with long steps.
fn walls_reflect(backend: Backend) {
    let (start, axis, radii) = (Vec3::new(0.1, -0.5, 0.0), Vec3::new(0.2, 1.0, -0.3), [0.5, 0.3]);
    let (unit, beside) = (axis.normalize(), axis.normalize().any_orthonormal_vector());
    let cone = |inside| (Polygon::cone(start, axis, radii, 1.0).inside(inside), surface_of_cone(start, axis, radii));
    let ball = |radius, inside| (Polygon::ball([0.1, 0.1, 0.0], radius).inside(inside), surface_of_ball(radius));
    // With the time in which each ball hits the wall once.
    let cases = [
        (cone(false), [1.0, 0.1, 0.1], [-2.0, 0.3, 0.2], 0.42),
        (cone(true), [0.1, 0.0, -0.1], [2.0, 0.4, 0.9], 0.24),
        // The lower rim from below, and the upper one from above.
        (cone(false), [0.65, -0.95, 0.05], [-0.2, 2.0, 0.0], 0.42),
        (cone(true), (start + 1.4 * unit + 0.2 * beside).to_array(), (-2.0 * unit + 0.1 * beside).to_array(), 0.22),
        (ball(0.5, false), [1.0, 0.3, 0.2], [-2.0, 0.1, 0.0], 0.42),
        (ball(0.9, true), [0.1, 0.3, 0.2], [2.0, 1.0, 0.0], 0.42),
    ];
    for (number, ((wall, surface), place, velocity, time)) in cases.into_iter().enumerate() {
        let (place, velocity) = (Vec3::from(place), Vec3::from(velocity));
        for continuous in [false, true] {
            let mut scene = elastic();
            scene.settings.continuous_collisions = continuous;
            scene.add_polygon(wall).expect("a valid wall");
            scene.add_sphere(Sphere::new(place, 0.12).velocity(velocity)).expect("a valid sphere");
            let mut simulation = open(scene, backend, Integrator::Rk4);
            // A long step ends well behind the wall. The next one handles the crossing.
            let (steps, dt) = if continuous { (2, time) } else { ((time / 0.002) as u64, 0.002) };
            simulation.run(steps, dt).expect("steps");
            assert_eq!(simulation.report().total_collisions, 1, "case {number}, {continuous}");
            let v = velocity.as_dvec3();
            let n = normal_of_hit(&surface, place.as_dvec3(), v, 0.12, time.into());
            near(spheres(&mut simulation)[0].velocity, v - 2.0 * v.dot(n) * n, 2e-3, &format!("case {number}, {continuous}"));
        }
    }
}

/// The ball about (0.1, 0.1, 0).
fn surface_of_ball(radius: f32) -> Surface {
    Box::new(move |one, other| {
        let (polar, turn) = (0.5 * TAU * one, TAU * other);
        let unit = DVec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin());
        DVec3::new(0.1, 0.1, 0.0) + f64::from(radius) * unit
    })
}

/// A cone of length 1.
fn surface_of_cone(start: Vec3, axis: Vec3, radii: [f32; 2]) -> Surface {
    let axis = axis.as_dvec3().normalize();
    let (one, other) = axis.any_orthonormal_pair();
    let [first, last] = radii.map(f64::from);
    Box::new(move |share, turn| {
        let (radius, turn) = (first + share * (last - first), TAU * turn);
        start.as_dvec3() + share * axis + radius * (turn.cos() * one + turn.sin() * other)
    })
}

/// Elastic balls stay inside a ball and gain no energy, also with steps in which they would pass the wall.
fn balls_stay_in_a_ball(backend: Backend) {
    for (continuous, dt) in [(false, 0.002), (true, 0.1)] {
        let mut scene = elastic();
        scene.settings.continuous_collisions = continuous;
        scene.add_polygon(Polygon::ball([0.0; 3], 1.0).inside(true)).expect("a valid wall");
        let mut random = Random::new(7);
        let groups = if continuous { 8 } else { 1 };
        for group in 0..8 {
            let mut vector = |most: f64| [0; 3].map(|_| random.between(-most, most) as f32);
            let ball = Sphere::new(vector(0.4), 0.06).velocity(vector(1.0));
            scene.add_sphere(ball.group(group % groups)).expect("a valid sphere");
            if group > 0 && continuous {
                scene.add_polygon(Polygon::ball([0.0; 3], 1.0).inside(true).group(group)).expect("a valid wall");
            }
        }
        let mut simulation = open(scene, backend, Integrator::Rk4);
        let before = kinetic(&spheres(&mut simulation));
        let steps = if continuous { 400 } else { on(backend, 4_000, 500) };
        simulation.run(steps, dt).expect("steps");
        let states = spheres(&mut simulation);
        let after = kinetic(&states);
        assert!(after < 1.001 * before && after > 0.9 * before, "energy {after}, {before} before");
        assert!(states.iter().all(|ball| ball.position.length() < 1.0), "{states:?}");
        assert!(simulation.report().total_collisions > on(backend, 20, 3));
    }
}

/// A plane and a ball that move are rackets: they return a ball of velocity v with (1 + e) u - e v.
fn smooth_walls_that_move_are_rackets(backend: Backend) {
    for wall in [Polygon::plane([0.0; 3], [1.0, 0.0, 0.0]), Polygon::ball([-0.5, 0.0, 0.0], 0.5)] {
        for integrator in [Integrator::Rk4, Integrator::VelocityVerlet] {
            let mut scene = elastic();
            scene.settings.restitution = 0.5;
            let motion = scene.add_motion(Motion::new("slide", MotionTerm::translation([1.0, 0.0, 0.0]))).expect("a motion");
            scene.add_polygon(wall.motion(motion)).expect("a valid wall");
            scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).velocity([-2.0, 0.0, 0.0])).expect("a valid sphere");
            let mut simulation = open(scene, backend, integrator);
            simulation.run(40, 0.02).expect("steps");
            near(spheres(&mut simulation)[0].velocity, [1.5 + 1.0, 0.0, 0.0], 1e-4, &format!("velocity, {integrator}"));
        }
    }
}

/// A drum of smooth walls that turns, with grains.
fn drum(backend: Backend, spin: f64) -> Scene {
    let (mut scene, glass) = grains(0.5, 0.3);
    let motion = scene.add_motion(Motion::new("drum", MotionTerm::turn(spin, [0.0, 0.0, 1.0], [0.0; 3]))).expect("a motion");
    let shell = Polygon::cylinder([0.0, 0.0, -0.3], [0.0, 0.0, 1.0], 1.0, 0.6).inside(true);
    let caps = [(-0.3, 1.0), (0.3, -1.0)].map(|(z, side)| Polygon::plane([0.0, 0.0, z], [0.0, 0.0, side]));
    for wall in [shell, caps[0], caps[1]] {
        scene.add_polygon(wall.material(glass).motion(motion)).expect("a valid wall");
    }
    let mut random = Random::new(5);
    let count = on(backend, 120, 25);
    for k in 0..count {
        let (angle, ring) = (TAU * f64::from(k % 15) / 15.0, 0.75 - 0.16 * f64::from(k / 15 / 2));
        let z = -0.15 + 0.3 * f64::from(k / 15 % 2) + random.between(-0.02, 0.02);
        let place = [ring * angle.cos(), ring * angle.sin(), z].map(|x| x as f32);
        let grain = Sphere::new(place, random.between(0.04, 0.07) as f32).mass(1.0);
        scene.add_sphere(grain.material(glass)).expect("a valid sphere");
    }
    scene
}

/// A drum of smooth walls gives the same bits with every broad phase, and holds its grains.
fn broad_phases_agree_on_smooth_walls(backend: Backend) {
    let run = |method: BroadPhase| {
        let options = Options::new().backend(backend).broad_phase(method).integrator(Integrator::VelocityVerlet);
        let mut simulation = Simulation::with_options(drum(backend, 2.0), options).expect("the simulation opens");
        simulation.run(on(backend, 4_000, 150), 5e-4).expect("steps");
        let states = spheres(&mut simulation);
        assert!(states.iter().all(|ball| ball.position.truncate().length() < 1.0 && ball.position.z.abs() < 0.3));
        bits(&states)
    };
    let all = [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip].map(run);
    assert!(all.iter().all(|states| *states == all[0]));
}

/// A grain slips in a cylinder that turns about its axis: the load on the wall is N outwards and mu N against the turn.
fn a_turning_cylinder_takes_grains_along(backend: Backend) {
    let (mut scene, glass) = grains(0.1, 0.3);
    let motion = scene.add_motion(Motion::new("drum", MotionTerm::turn(20.0, [0.0, 0.0, 1.0], [0.0; 3]))).expect("a motion");
    let shell = Polygon::cylinder([0.0, 0.0, -0.3], [0.0, 0.0, 1.0], 1.0, 0.6).inside(true);
    scene.add_polygon(shell.material(glass).motion(motion)).expect("a valid wall");
    scene.add_gauge(Gauge::wall("load", "drum")).expect("a gauge");
    scene.add_sphere(Sphere::new([0.0, -0.9, 0.0], 0.1).mass(2.0).material(glass)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(1_000, 2e-4).expect("steps");
    let GaugeReading::Wall(load) = simulation.gauges().expect("gauges")[0] else { panic!("a gauge of a wall") };
    let out = spheres(&mut simulation)[0].position.as_dvec3().normalize();
    let force = load.force;
    let normal = force.dot(out);
    assert!(normal > 0.8 * 2.0 * 9.81, "{force:?}");
    close(force.dot(DVec3::Z.cross(out)), -0.1 * normal, 1e-3 * normal, "friction");
    close(load.torque.z, -0.1 * normal, 1e-3 * normal, "torque");
}

/// A grain in a pipe that crosses the faces of a periodic box swings as in one without.
fn a_pipe_spans_a_periodic_box(backend: Backend) {
    let run = |periodic: bool| {
        let (mut scene, glass) = grains(0.3, 0.5);
        let length = if periodic { 1.0 } else { 20.0 };
        if periodic {
            scene.set_periodic(2, Some([-0.5, 0.5])).expect("a valid box");
        }
        let pipe = Polygon::cylinder([0.0, 0.0, -0.5], [0.0, 0.0, 1.0], 0.5, length).inside(true);
        scene.add_polygon(pipe.material(glass)).expect("a valid wall");
        let ball = Sphere::new([0.1, -0.38, 0.3], 0.1).mass(2.0).velocity([0.0, 0.0, 2.0]);
        scene.add_sphere(ball.material(glass)).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 6_000, 1_500), 2e-4).expect("steps");
        spheres(&mut simulation)[0]
    };
    let [open, closed] = [run(false), run(true)];
    near(closed.position.truncate().extend(0.0), open.position.truncate().extend(0.0).as_dvec3(), 1e-4, "place");
    near(closed.velocity, open.velocity.as_dvec3(), 1e-3, "velocity");
}

/// Far from the origin, with double precision, a grain swings in a tilted cone as near the origin.
fn cones_are_exact_far_from_the_origin(backend: Backend) {
    let run = |far: f32| {
        let (mut scene, glass) = grains(0.3, 0.5);
        scene.settings.precision = rockfall::Precision::Double;
        let axis = Quat::from_rotation_x(0.3) * Vec3::Y;
        let way = Vec3::new(far, 0.0, -far);
        let cone = Polygon::cone(way, axis, [0.5, 0.9], 1.0).inside(true);
        scene.add_polygon(cone.material(glass)).expect("a valid wall");
        scene.add_sphere(Sphere::new(way + Vec3::new(0.25, 0.45, 0.3), 0.0625).mass(0.5).material(glass)).expect("a sphere");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 2_000, 800), 2e-4).expect("steps");
        spheres(&mut simulation)[0]
    };
    let (here, far) = (run(0.0), run(512.0));
    near(far.velocity, here.velocity.as_dvec3(), 2e-3, "velocity");
}

both! {
    a_plane_is_a_large_parallelogram,
    a_grain_slides_down_a_plane,
    a_ball_swings_in_a_tube,
    a_ball_orbits_in_a_cone,
    walls_reflect,
    balls_stay_in_a_ball,
    smooth_walls_that_move_are_rackets,
    broad_phases_agree_on_smooth_walls,
    a_turning_cylinder_takes_grains_along,
    a_pipe_spans_a_periodic_box,
    cones_are_exact_far_from_the_origin,
}

/// Rays meet smooth walls from both sides.
#[test]
fn rays_meet_smooth_walls() {
    let mut scene = with(|settings| settings.gravity = 0.0);
    scene.add_sphere(Sphere::new([0.0, 50.0, 0.0], 0.1)).expect("a sphere");
    let cone = Polygon::cone([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0], 2.0).inside(true);
    let cone = Body::Polygon(scene.add_polygon(cone).expect("a cone"));
    let ball = Body::Polygon(scene.add_polygon(Polygon::ball([10.0, 1.0, 0.0], 1.0)).expect("a ball"));
    let plane = Body::Polygon(scene.add_polygon(Polygon::plane([0.0, 0.0, -5.0], [0.0, 0.0, 1.0])).expect("a plane"));
    let mut simulation = open(scene, Backend::Cpu, Integrator::Rk4);
    let mut cast = |from: [f32; 3], to: [f32; 3]| {
        let hit = simulation.cast_ray(from, to).expect("a ray").expect("a hit");
        (hit.body, hit.distance, hit.normal)
    };
    let is = |(body, distance, normal): (Body, f32, Vec3), wall: Body, expected: f64, n: [f64; 3]| {
        assert_eq!(body, wall);
        close(f64::from(distance), expected, 1e-5, "distance");
        near(normal, n, 1e-5, "normal");
    };
    let slant = std::f64::consts::FRAC_1_SQRT_2;
    is(cast([-3.0, 1.0, 0.0], [2.0, 0.0, 0.0]), cone, 2.0, [-slant, -slant, 0.0]);
    is(cast([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), cone, 1.0, [-slant, slant, 0.0]);
    is(cast([5.0, 1.0, 0.0], [1.0, 0.0, 0.0]), ball, 4.0, [-1.0, 0.0, 0.0]);
    is(cast([10.0, 1.0, 0.0], [1.0, 0.0, 0.0]), ball, 1.0, [-1.0, 0.0, 0.0]);
    is(cast([100.0, 7.0, 0.0], [0.0, 0.0, -1.0]), plane, 5.0, [0.0, 0.0, 1.0]);
    assert_eq!(simulation.cast_ray([-3.0, 2.5, 0.0], [1.0, 0.0, 0.0]).expect("a ray"), None);
}
