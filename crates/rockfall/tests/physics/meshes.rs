//! Triangles and meshes as walls (docs/physics sections 2.7 and 2.11), against closed forms and smooth shapes.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, ContactAction, ContactLaw, Cuboid, Integrator, Material, Mesh, Motion, MotionTerm, Options, Pair,
    Polygon, Scene, Simulation, Sphere, SphereState,
};

use crate::common::{bits, close, near, on, open, with};
use crate::faults::scenes::{Random, in_gravity, kinetic};

/// A scene of smooth elastic bodies without gravity. All contacts that approach collide.
pub(crate) fn elastic() -> Scene {
    with(|settings| {
        (settings.gravity, settings.activation_threshold, settings.restitution) = (0.0, 0.0, 1.0);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    })
}

/// Grains of a law with history, in gravity 9.81.
fn grains(law: ContactLaw, friction: f32) -> (Scene, rockfall::MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        settings.gravity = 9.81;
    });
    let glass = Material::new("glass").density(2_500.0).young(1e7).poisson(0.25);
    let glass = scene.add_material(glass).expect("a valid material");
    let pair = Pair::default().restitution(0.5).friction(friction);
    let pair = if law == ContactLaw::Linear { pair.stiffness(1e4) } else { pair };
    scene.set_pair(glass, glass, pair).expect("a valid pair");
    (scene, glass)
}

pub(crate) fn spheres(simulation: &mut Simulation) -> Vec<SphereState> {
    simulation.spheres().expect("spheres are read back")
}

/// The square from -2 to 2 in the plane y = 0, cut into cells whose sides are multiples of 1/64, each of two triangles. `shuffle` mixes
/// triangles and vertices.
fn plane(seed: u64, shuffle: bool) -> Mesh {
    let mut random = Random::new(seed);
    let mut cuts = || {
        let mut cuts = vec![-2.0_f64];
        while let Some(last) = cuts.last().copied().filter(|last| *last < 2.0) {
            cuts.push((last + (64.0 * random.between(0.05, 0.6)).round() / 64.0).min(2.0));
        }
        cuts
    };
    let (across, along) = (cuts(), cuts());
    let at = |x: usize, z: usize| (x * along.len() + z) as u32;
    let vertices = across.iter().flat_map(|x| along.iter().map(|z| [*x as f32, 0.0, *z as f32])).collect();
    let mut triangles = Vec::new();
    for (x, z) in (1..across.len()).flat_map(|x| (1..along.len()).map(move |z| (x, z))) {
        let [a, b, c, d] = [at(x - 1, z - 1), at(x, z - 1), at(x, z), at(x - 1, z)];
        let turned = random.between(0.0, 1.0) < 0.5;
        triangles.extend(if turned { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    if shuffle {
        for place in (1..triangles.len()).rev() {
            triangles.swap(place, random.between(0.0, place as f64 + 1.0) as usize);
            triangles[place].rotate_left(random.between(0.0, 3.0) as usize);
        }
    }
    Mesh::new(vertices, triangles).expect("a valid mesh")
}

fn add(scene: &mut Scene, mesh: &Mesh) {
    scene.add_mesh(mesh, |triangle| triangle).expect("a valid mesh");
}

/// Grains that fall and roll on a plane of triangles do what they do on one of two triangles, to the bit: whatever the triangles, their
/// order and that of their vertices.
fn a_tessellated_plane_is_a_plane(backend: Backend) {
    for (law, integrator) in [
        (ContactLaw::Thesis, Integrator::Rk4),
        (ContactLaw::Linear, Integrator::VelocityVerlet),
        (ContactLaw::HertzMindlin, Integrator::SymplecticEuler),
    ] {
        let run = |mesh: &Mesh| {
            let (mut scene, glass) = grains(law, 0.4);
            scene.add_mesh(mesh, |triangle| triangle.material(glass)).expect("a valid mesh");
            let mut random = Random::new(3);
            for k in 0..on(backend, 12, 5) {
                let place = [0.25 * k as f64 - 1.4, random.between(0.1, 0.12), random.between(-1.0, 1.0)];
                let velocity = [random.between(-0.3, 0.3), 0.0, random.between(-0.5, 0.5)];
                let grain = Sphere::new(place.map(|x| x as f32), 0.1).mass(2.0).velocity(velocity.map(|x| x as f32));
                scene.add_sphere(grain.material(glass)).expect("a valid sphere");
            }
            let mut simulation = open(scene, backend, integrator);
            let dt = if law == ContactLaw::Thesis { 0.005 } else { 5e-4 };
            simulation.run(on(backend, 1_000, 150), dt).expect("steps");
            let contacts = simulation.report().contacts;
            (bits(&spheres(&mut simulation)), contacts)
        };
        let square = vec![[-2.0, 0.0, -2.0], [2.0, 0.0, -2.0], [2.0, 0.0, 2.0], [-2.0, 0.0, 2.0]];
        let one = run(&Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]]).expect("a square"));
        assert!(one.1 > 0, "no grain touches the floor");
        for seed in 0..on(backend, 4, 1) {
            assert_eq!(run(&plane(seed, false)), one, "{law} {seed}");
            assert_eq!(run(&plane(seed, true)), one, "{law} {seed} shuffled");
        }
    }
}

/// Balls that hit a triangle from both sides, on its face, its edges and its vertices, are reflected at the direction to the nearest
/// point.
fn both_sides_of_a_triangle_reflect(backend: Backend) {
    let corners = [Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(-1.0, 0.0, 1.0)];
    let down = |x: f32, z: f32| (Vec3::new(x, 0.4, z), Vec3::new(0.3, -2.0, 0.1));
    // On the face, beyond each edge, and beyond each vertex.
    let places =
        [down(-0.4, -0.4), down(-0.1, -1.05), down(-1.08, -0.2), down(0.05, 0.05), down(-1.05, -1.05), down(1.06, -1.02)];
    for (place, velocity) in places {
        for side in [1.0, -1.0] {
            for continuous in [false, true] {
                let mirror = Vec3::new(1.0, side, 1.0);
                let mut scene = elastic();
                scene.settings.continuous_collisions = continuous;
                scene.add_polygon(Polygon::triangle(corners[0], corners[1], corners[2])).expect("a valid triangle");
                scene.add_sphere(Sphere::new(place * mirror, 0.2).velocity(velocity * mirror)).expect("a valid sphere");
                let mut simulation = open(scene, backend, Integrator::Rk4);
                let dt = if continuous { 0.11 } else { 0.002 };
                simulation.run(if continuous { 3 } else { 150 }, dt).expect("steps");
                let ball = spheres(&mut simulation)[0];
                assert_eq!(simulation.report().total_collisions, 1, "{place} {side} {continuous}");
                let n = normal_of_hit(corners, (place * mirror).as_dvec3(), (velocity * mirror).as_dvec3(), 0.2);
                let v = (velocity * mirror).as_dvec3();
                near(ball.velocity, v - 2.0 * v.dot(n) * n, 2e-3, &format!("velocity at {place}, side {side}, {continuous}"));
            }
        }
    }
}

/// The direction to the nearest point of a triangle where a ball on a straight path touches it first, by bisection in f64.
fn normal_of_hit(corners: [Vec3; 3], x: DVec3, v: DVec3, radius: f64) -> DVec3 {
    let corners = corners.map(Vec3::as_dvec3);
    let to = |time: f64| nearest(corners, x + time * v) - (x + time * v);
    // The distance falls until the ball is nearest, so the first half of a path through the plane has one crossing.
    let (mut low, mut high) = (0.0, x.y / -v.y);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if to(middle).length() > radius { low = middle } else { high = middle }
    }
    to(low).normalize()
}

/// The nearest point of a triangle, by the least of its distances from points of a fine mesh, refined.
fn nearest(corners: [DVec3; 3], x: DVec3) -> DVec3 {
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a).normalize();
    let foot = x - (x - a).dot(n) * n;
    let inside = (0..3).all(|k| (corners[(k + 1) % 3] - corners[k]).cross(foot - corners[k]).dot(n) >= 0.0);
    if inside {
        return foot;
    }
    let on_edge = |k: usize| {
        let (start, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
        start + ((x - start).dot(edge) / edge.length_squared()).clamp(0.0, 1.0) * edge
    };
    (0..3).map(on_edge).min_by(|one, other| one.distance(x).total_cmp(&other.distance(x))).expect("three edges")
}

/// Elastic balls stay inside a closed mesh and gain no energy. They lose some where several contacts collide at once.
fn balls_stay_in_a_closed_mesh(backend: Backend) {
    for mesh in [Mesh::sphere(1.0, 2).expect("a sphere"), Mesh::sphere(1.0, 0).expect("an icosahedron")] {
        let mut scene = elastic();
        add(&mut scene, &mesh);
        let mut random = Random::new(7);
        for _ in 0..8 {
            let mut vector = |most: f64| [0; 3].map(|_| random.between(-most, most) as f32);
            scene.add_sphere(Sphere::new(vector(0.4), 0.06).velocity(vector(1.0))).expect("a valid sphere");
        }
        let mut simulation = open(scene, backend, Integrator::Rk4);
        let before = kinetic(&spheres(&mut simulation));
        simulation.run(on(backend, 4_000, 500), 0.002).expect("steps");
        let states = spheres(&mut simulation);
        let after = kinetic(&states);
        assert!(after < 1.001 * before && after > 0.9 * before, "energy {after}, {before} before");
        assert!(states.iter().all(|ball| ball.position.length() < 1.0), "{states:?}");
        assert!(simulation.report().total_collisions > on(backend, 20, 3));
    }
}

/// A grain that swings in a horizontal tube of 720 facets has the frequency of one in a smooth tube, omega^2 = 5 g / (7 (R - r)), while it
/// rolls, and loses no more than the law's damping.
fn a_ball_rolls_in_a_tube_of_facets_as_in_a_smooth_one(backend: Backend) {
    let facets = 720;
    let (mut scene, glass) = grains(ContactLaw::HertzMindlin, 0.8);
    let tube = Mesh::cylinder(0.1, 0.2, facets).expect("a tube");
    scene.add_mesh(&tube, |triangle| triangle.material(glass)).expect("a valid mesh");
    let radius = 0.01;
    // The middle of a facet is nearer to the axis than the vertices.
    let reach = 0.1 * (std::f64::consts::PI / f64::from(facets)).cos() - radius;
    let angle = 0.15_f64;
    let place = [(reach * angle.sin()) as f32, (-reach * angle.cos()) as f32, 0.1];
    scene.add_sphere(Sphere::new(place, radius as f32).density(2_500.0).material(glass)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let expected = (5.0 * 9.81 / (7.0 * reach)).sqrt();
    // A quarter of a period after the start, it is at the bottom.
    let dt = 1e-4;
    let quarter = std::f64::consts::FRAC_PI_2 / expected * (1.0 + angle * angle / 16.0);
    simulation.run((quarter / f64::from(dt)).round() as u64, dt).expect("steps");
    let ball = spheres(&mut simulation)[0];
    close(f64::from(ball.position.x), 0.0, 0.03 * reach * angle, "place after a quarter of a period");
    close(f64::from(ball.velocity.x), -angle * reach * expected, 0.03 * angle * reach * expected, "velocity at the bottom");
}

/// A ball rests in a V of two meshes that slope by 45 degrees: both push with m g / sqrt 2. In one that slopes by 4 degrees it has one
/// contact with a mesh and two with boxes.
fn hollow_edges_keep_both_contacts_above_the_angle_of_meshes(backend: Backend) {
    for (slope, expected) in [(45.0_f64, 2), (12.0, 2), (4.0, 1)] {
        let (mut scene, glass) = grains(ContactLaw::Linear, 0.0);
        let (sin, cos) = slope.to_radians().sin_cos();
        let [x, y] = [cos as f32, sin as f32];
        let vertices = vec![[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [x, y, -1.0], [x, y, 1.0], [-x, y, -1.0], [-x, y, 1.0]];
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]]).expect("a valid mesh");
        scene.add_mesh(&mesh, |triangle| triangle.material(glass)).expect("a valid mesh");
        let height = 0.1 / cos as f32 - 1e-5;
        scene.add_sphere(Sphere::new([0.0, height, 0.0], 0.1).mass(2.0).material(glass)).expect("a valid sphere");
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(on(backend, 20_000, 1_000), 1e-4).expect("steps");
        let contacts = simulation.contacts().expect("contacts");
        assert_eq!(contacts.len(), expected, "slope {slope}");
        if expected == 2 && backend == Backend::Cpu {
            let force = 2.0 * 9.81 / (2.0 * cos);
            for contact in contacts {
                let ContactAction::Force(found) = contact.action else { panic!("an impulse") };
                close(f64::from(found.length()), force, 0.02 * force, &format!("force at {slope}"));
            }
        }
    }
}

/// A mesh that moves is a racket: it returns a ball of velocity v with (1 + e) u - e v.
fn a_mesh_that_moves_is_a_racket(backend: Backend) {
    for integrator in [Integrator::Rk4, Integrator::VelocityVerlet] {
        let mut scene = elastic();
        scene.settings.restitution = 0.5;
        let motion = scene.add_motion(Motion::new("slide", MotionTerm::translation([1.0, 0.0, 0.0]))).expect("a motion");
        let vertices = vec![[0.0, -2.0, -2.0], [0.0, 2.0, -2.0], [0.0, 2.0, 2.0], [0.0, -2.0, 2.0]];
        let racket = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).expect("a square");
        scene.add_mesh(&racket, |triangle| triangle.motion(motion)).expect("a valid mesh");
        scene.add_sphere(Sphere::new([1.0, 0.1, 0.3], 0.1).velocity([-2.0, 0.3, 0.0])).expect("a valid sphere");
        let mut simulation = open(scene, backend, integrator);
        simulation.run(40, 0.02).expect("steps");
        near(spheres(&mut simulation)[0].velocity, [1.5 + 1.0, 0.3, 0.0], 1e-4, &format!("velocity, {integrator}"));
    }
}

/// A heap of grains in a bowl of triangles has the same bits with every broad phase and number of threads.
fn broad_phases_agree_on_meshes(backend: Backend) {
    let run = |method: BroadPhase| {
        let mut scene = with(|settings| settings.gravity = 9.81);
        add(&mut scene, &Mesh::sphere(1.0, 2).expect("a sphere"));
        let mut random = Random::new(5);
        for _ in 0..on(backend, 60, 25) {
            let mut vector = |most: f64| [0; 3].map(|_| random.between(-most, most) as f32);
            let place = vector(0.5);
            scene.add_sphere(Sphere::new(place, random.between(0.03, 0.09) as f32)).expect("a valid sphere");
        }
        let options = Options::new().backend(backend).broad_phase(method);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        simulation.run(on(backend, 400, 60), 0.005).expect("steps");
        let states = spheres(&mut simulation);
        assert!(states.iter().all(|ball| ball.position.length() < 1.0), "a grain left the bowl");
        bits(&states)
    };
    let all = [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip].map(run);
    assert!(all.iter().all(|states| *states == all[0]));
}

/// A ball that slides down a ridge of two triangles follows a circular arc around the edge and keeps its energy.
fn a_ridge_is_rounded(backend: Backend) {
    let mut scene = elastic();
    (scene.settings.gravity, scene.settings.collisions) = (1.0, false);
    let roof =
        vec![[0.0, 0.0, -3.0], [0.0, 0.0, 3.0], [4.0, -4.0, -3.0], [4.0, -4.0, 3.0], [-4.0, -4.0, -3.0], [-4.0, -4.0, 3.0]];
    add(&mut scene, &Mesh::new(roof, vec![[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]]).expect("a roof"));
    scene.add_sphere(Sphere::new([0.0, 0.4999, 0.0], 0.5).velocity([0.2, 0.0, 0.0])).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let before = in_gravity(&spheres(&mut simulation), 1.0, 0.0);
    for _ in 0..on(backend, 40, 8) {
        simulation.run(20, 0.002).expect("steps");
        let after = in_gravity(&spheres(&mut simulation), 1.0, 0.0);
        // The elastic energy of the contact is left out.
        assert!(after < 1.001 * before && after > 0.99 * before, "energy {after}, {before} before");
    }
}

/// A box among triangles: a ball inside a box hides the triangles behind its face.
fn a_sunk_ball_touches_the_box_alone(backend: Backend) {
    let mut scene = with(|settings| settings.gravity = 0.0);
    scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0])).expect("a valid box");
    scene.add_polygon(Polygon::triangle([-0.2, -0.12, -0.2], [0.2, -0.12, -0.2], [0.0, -0.12, 0.3])).expect("a triangle");
    scene.add_sphere(Sphere::new([0.0, -0.02, 0.0], 0.1)).expect("a valid sphere");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    simulation.run(1, 1e-4).expect("a step");
    let contacts = simulation.contacts().expect("contacts");
    assert_eq!(contacts.len(), 1);
    near(contacts[0].normal, [0.0, -1.0, 0.0], 1e-6, "normal");
}

both! {
    a_tessellated_plane_is_a_plane,
    both_sides_of_a_triangle_reflect,
    balls_stay_in_a_closed_mesh,
    a_ball_rolls_in_a_tube_of_facets_as_in_a_smooth_one,
    hollow_edges_keep_both_contacts_above_the_angle_of_meshes,
    a_mesh_that_moves_is_a_racket,
    broad_phases_agree_on_meshes,
    a_ridge_is_rounded,
    a_sunk_ball_touches_the_box_alone,
}
