//! Rods that touch edges of polygons and smooth walls between their ends (docs/physics section 2.19), against closed forms.

use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, Capsule, ContactLaw, Integrator, Material, Mesh, Options, Pair, Polygon, Scene, Simulation,
    SphereState,
};

use crate::common::{bits, close, near, on, open, with};
use crate::faults::scenes::{Random, in_gravity, kinetic, opened, scene};

/// Radius and half of the length of the capsules. Their mass is 1.
const RADIUS: f64 = 0.125;
const REACH: f64 = 0.5;

/// A scene of elastic bodies without gravity. All contacts that approach collide.
fn elastic() -> Scene {
    with(|settings| {
        (settings.gravity, settings.activation_threshold, settings.restitution) = (0.0, 0.0, 1.0);
        (settings.friction, settings.contact_damping) = (0.0, 0.0);
    })
}

fn spheres(simulation: &mut Simulation) -> Vec<SphereState> {
    simulation.spheres().expect("spheres are read back")
}

/// Two triangles that meet in a ridge along z, at y = 0.
fn ridge() -> Vec<Polygon> {
    let (one, two) = ([0.0, 0.0, -2.0], [0.0, 0.0, 2.5]);
    vec![Polygon::triangle(one, two, [-2.0, -1.0, 0.0]), Polygon::triangle(two, one, [2.0, -1.0, 0.5])]
}

/// A pyramid of four triangles with its vertex at y = 0.
fn pyramid() -> Vec<Polygon> {
    let foot = [[-1.0, -1.0, -1.0], [1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, -1.0, 1.0]];
    (0..4).map(|k| Polygon::triangle([0.0; 3], foot[k], foot[(k + 1) % 4])).collect()
}

/// Walls on which a capsule along x lies with the middle of its axis, at the height y = 0. None of them touches its ends.
fn walls() -> Vec<(&'static str, Vec<Polygon>)> {
    vec![
        ("ridge", ridge()),
        ("vertex", pyramid()),
        ("edge of a parallelogram", vec![Polygon::new([0.0, 0.0, -2.0], [-2.0, -0.5, 0.0], [0.0, 0.0, 4.0])]),
        ("cylinder", vec![Polygon::cylinder([0.0, -0.25, -1.0], [0.0, 0.0, 1.0], 0.25, 2.0)]),
        ("ball", vec![Polygon::ball([0.0, -0.25, 0.0], 0.25)]),
        // Its axis rises by as much as it becomes narrower, so that the line at the top is horizontal.
        ("cone", vec![Polygon::cone([0.0, -0.8, -0.025], [0.0, 0.6, 0.8], [1.0, 0.25], 1.0)]),
    ]
}

fn add(scene: &mut Scene, walls: Vec<Polygon>) {
    for wall in walls {
        scene.add_polygon(wall).expect("a valid wall");
    }
}

/// A capsule along x whose axis has the height `up`, and whose middle is at `x`.
fn across(x: f64, up: f64) -> Capsule {
    let end = |side: f64| [x + side * REACH, up, 0.0].map(|x| x as f32);
    Capsule::new(end(-1.0), end(1.0), RADIUS as f32)
}

/// The overlaps of a capsule with walls.
fn overlaps(walls: &[Polygon], capsule: Capsule) -> Vec<f32> {
    let mut scene = with(|settings| settings.gravity = 0.0);
    add(&mut scene, walls.to_vec());
    scene.add_capsule(capsule).expect("a valid capsule");
    let mut simulation = open(scene, Backend::Cpu, Integrator::Rk4);
    simulation.contacts().expect("contacts").iter().map(|contact| contact.overlap).collect()
}

/// A capsule that lies across a wall has one contact, in the middle of its axis, from the distance of its radius on.
#[test]
fn a_capsule_across_a_wall_touches_it_once() {
    for (name, walls) in walls() {
        assert_eq!(overlaps(&walls, across(0.0, RADIUS + 1e-4)).len(), 0, "{name}");
        assert_eq!(overlaps(&walls, across(0.0, RADIUS - 1e-4)).len(), 1, "{name}");
        assert_eq!(overlaps(&walls, across(0.0, RADIUS - 1e-2)).len(), 1, "{name}");
    }
}

/// The contact of a skew capsule with a cone is at the point of its axis that is nearest, which a search finds.
#[test]
fn the_nearest_point_of_an_axis_counts() {
    // The axis of the cone is z, the radius 1 - z / 2.
    let wall = [Polygon::cone([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.5], 1.0)];
    let mut random = Random::new(5);
    let mut touched = 0;
    for _ in 0..1_500 {
        let mut vector = |size: f64| [0; 3].map(|_| random.between(-size, size));
        let [place, half] = [vector(0.2), vector(0.8)].map(DVec3::from_array);
        let middle = DVec3::new(0.95, 0.0, 0.4) + place;
        let ends = [middle - half, middle + half];
        let height = |point: DVec3| (point.truncate().length() - 1.0 + 0.5 * point.z) / 1.25_f64.sqrt();
        let points = (0..=4_000).map(|k| ends[0].lerp(ends[1], f64::from(k) / 4_000.0));
        let nearest = points.min_by(|one, other| height(*one).total_cmp(&height(*other))).expect("a point");
        let is_inside = [0.0, 1.0].iter().all(|end| nearest.distance(ends[*end as usize]) > 1e-3) && height(nearest) >= 0.0;
        let foot = nearest.z - 0.5 * height(nearest) / 1.25_f64.sqrt();
        if !is_inside
            || !(0.05..0.95).contains(&foot)
            || height(nearest) > RADIUS - 1e-3
            || ends.map(height).iter().any(|h| *h < RADIUS)
        {
            continue;
        }
        touched += 1;
        let found = overlaps(&wall, Capsule::new(ends[0].as_vec3(), ends[1].as_vec3(), RADIUS as f32));
        assert_eq!(found.len(), 1, "{ends:?}");
        close(f64::from(found[0]), RADIUS - height(nearest), 1e-5, "overlap");
    }
    assert!(touched > 3, "{touched} capsules touch the cone");
}

/// A capsule at rest over a wall: one contact carries its weight, with the overlap G / C_c (docs/physics section 4.3).
fn a_balanced_capsule_is_carried(backend: Backend) {
    for (name, walls) in walls() {
        let mut scene = with(|settings| settings.gravity = 10.0);
        let rest = f64::from(10.0 / scene.settings.contact_force);
        add(&mut scene, walls);
        scene.add_capsule(across(0.0, RADIUS - rest)).expect("a valid capsule");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        simulation.run(on(backend, 100, 20), 1.0 / 256.0).expect("steps");
        assert_eq!(simulation.report().contacts, 1, "{name}");
        for end in spheres(&mut simulation) {
            close(f64::from(end.position.y), RADIUS - rest, 1e-3 * rest, name);
            close(f64::from(end.velocity.y), 0.0, 2e-4, name);
        }
    }
}

/// An elastic capsule that drops on a wall keeps its energy, and rises again.
fn a_dropped_capsule_keeps_its_energy(backend: Backend) {
    for (name, walls) in walls() {
        let mut scene = elastic();
        scene.settings.gravity = 10.0;
        add(&mut scene, walls);
        scene.add_capsule(across(0.0, RADIUS + 0.2)).expect("a valid capsule");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        let before = in_gravity(&spheres(&mut simulation), 10.0, 0.0);
        let dt = 1.0 / 256.0;
        simulation.run(on(backend, 300, 64), dt).expect("steps");
        assert!(simulation.report().total_collisions > 0, "{name}");
        close(in_gravity(&spheres(&mut simulation), 10.0, 0.0), before, 1e-3 * before, name);
    }
}

/// A free capsule that hits a wall at the distance d from its middle turns with omega = j d / I, where
/// j = 2 u / (1 / M + d^2 / I) (docs/physics section 3.3).
fn an_eccentric_hit_turns_a_capsule(backend: Backend) {
    for (name, walls) in walls() {
        let (place, speed) = (0.2, 2.0);
        let mut scene = elastic();
        add(&mut scene, walls);
        scene.add_capsule(across(place, RADIUS + 0.01).velocity([0.0, -speed as f32, 0.0])).expect("a valid capsule");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        simulation.run(8, 1.0 / 512.0).expect("steps");
        let inertia = REACH * REACH + 0.4 * RADIUS * RADIUS;
        let impulse = 2.0 * speed / (1.0 + place * place / inertia);
        let [one, two] = spheres(&mut simulation).try_into().expect("two ends");
        let middle = 0.5 * (one.velocity + two.velocity);
        near(middle, DVec3::new(0.0, impulse - speed, 0.0), 1e-3, name);
        let turn =
            (two.position - one.position).as_dvec3().cross((two.velocity - one.velocity).as_dvec3()) / (4.0 * REACH * REACH);
        close(turn.z, -impulse * place / inertia, 2e-3, name);
        close(kinetic(&[one, two]), 0.5 * speed * speed, 1e-4, name);
    }
}

/// A capsule that lies along a cylinder touches it with both ends, and not in the middle. So does one along a ridge.
fn a_capsule_along_a_wall_touches_it_with_its_ends(backend: Backend) {
    for (name, walls) in walls().into_iter().filter(|(name, _)| ["ridge", "cylinder"].contains(name)) {
        for turn in [0.0, 1e-5, 1e-3] {
            let mut scene = with(|settings| settings.gravity = 10.0);
            let rest = 10.0 / f64::from(scene.settings.contact_force);
            add(&mut scene, walls.clone());
            let end = |side: f64| [side * turn * REACH, RADIUS - rest, side * REACH].map(|x| x as f32);
            scene.add_capsule(Capsule::new(end(-1.0), end(1.0), RADIUS as f32)).expect("a valid capsule");
            let mut simulation = open(scene, backend, Integrator::Rk4);
            simulation.step(1.0 / 256.0).expect("a step");
            assert_eq!(simulation.report().contacts, 2, "{name}, {turn}");
            for end in spheres(&mut simulation) {
                close(f64::from(end.position.y), RADIUS - rest, 1e-3 * rest, name);
            }
        }
    }
}

/// A capsule that reaches over the border of a table lies on its inner end and on the border.
fn a_capsule_lies_over_the_border_of_a_table(backend: Backend) {
    let table = Polygon::new([-2.75, 0.0, -2.0], [0.0, 0.0, 4.0], [3.0, 0.0, 0.0]);
    let mut scene = with(|settings| settings.gravity = 10.0);
    add(&mut scene, vec![table]);
    scene.add_capsule(across(0.0, RADIUS - 0.01)).expect("a valid capsule");
    let mut simulation = open(scene, backend, Integrator::Rk4);
    simulation.run(on(backend, 400, 60), 1.0 / 256.0).expect("steps");
    assert_eq!(simulation.report().contacts, 2);
    for end in spheres(&mut simulation) {
        close(f64::from(end.position.y), RADIUS, 0.03, "height of an end");
    }
}

/// A level capsule comes down with one end over a table and e = 1. Its end hits the face, and its axis the border. It keeps its
/// kinetic energy, 0.5, wherever the border is. It lost 2 to 12 %.
fn an_elastic_impact_over_the_border_of_a_table_keeps_its_energy(backend: Backend) {
    for border in on(backend, vec![-0.45, -0.3, -0.1, 0.0, 0.1, 0.3], vec![-0.1, 0.1]) {
        let mut scene = elastic();
        add(&mut scene, vec![Polygon::new([-2.0, 0.0, -2.0], [0.0, 0.0, 4.0], [2.0 + border, 0.0, 0.0])]);
        scene.add_capsule(across(0.0, RADIUS + 0.01).velocity(Vec3::NEG_Y)).expect("a valid capsule");
        let mut simulation = open(scene, backend, Integrator::Rk4);
        // Up to the first impact alone, and some later ones.
        for steps in [15, 200] {
            simulation.run(steps, 1e-3).expect("steps");
            assert!(simulation.report().total_collisions > 1, "both places collide");
            close(simulation.energy().expect("energies").kinetic, 0.5, 1e-3, &format!("border {border}"));
        }
    }
}

/// A capsule over the border of a polygon, from text. It lost a tenth of its energy.
fn a_capsule_over_a_border_keeps_its_energy(backend: Backend) {
    let text = "C -0.3 0.63 0  0.3 0.63 0  0 -1 0  3 0.6\nP -0.7 0 -1  0 0 2  0.62 0 0\n\
                set gravity 0\nset restitution 1\nset friction 0\nset contact_damping 0\n";
    let mut simulation = opened(scene(text), backend, Integrator::Rk4);
    simulation.run(250, 1e-3).expect("steps");
    assert!(simulation.report().total_collisions > 1, "both places collide");
    close(simulation.energy().expect("energies").kinetic, 1.5, 3e-3, "kinetic energy");
}

/// A box of twelve triangles with its top at y = 0, from -x to x and from -1 to 1.
fn block(x: f32) -> Mesh {
    let corner =
        |k: u32| [if k & 1 == 1 { x } else { -x }, if k & 2 == 2 { 0.0 } else { -1.0 }, if k & 4 == 4 { 1.0 } else { -1.0 }];
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).expect("a valid mesh")
}

/// A capsule on a block of triangles has two contacts: with both ends, with one end and one edge, or with both edges.
fn a_capsule_lies_on_a_block_of_triangles(backend: Backend) {
    for (half, place) in [(1.5_f32, 0.03), (0.4, 0.25), (0.3, 0.02)] {
        for turn in [0.0_f64, 0.3] {
            let mut scene = with(|settings| settings.gravity = 10.0);
            scene.add_mesh(&block(half), |triangle| triangle).expect("a valid mesh");
            let end = |side: f64| {
                [place + side * REACH * turn.cos(), RADIUS - 0.005, 0.1 + side * REACH * turn.sin()].map(|x| x as f32)
            };
            scene.add_capsule(Capsule::new(end(-1.0), end(1.0), RADIUS as f32)).expect("a valid capsule");
            let mut simulation = open(scene, backend, Integrator::Rk4);
            simulation.run(on(backend, 200, 20), 1.0 / 256.0).expect("steps");
            assert_eq!(simulation.report().contacts, 2, "{half}, turned by {turn}");
            let height: f64 = spheres(&mut simulation).iter().map(|end| 0.5 * f64::from(end.position.y)).sum();
            close(height, RADIUS - 0.005, 0.01, "height");
        }
    }
}

/// The square from -2 to 2 in the plane y = 0 of n times n cells, each of two triangles.
fn floor(n: usize) -> Mesh {
    let at = |k: usize| -2.0 + 4.0 * k as f32 / n as f32;
    let vertices = (0..=n).flat_map(|x| (0..=n).map(move |z| [at(x), 0.0, at(z)])).collect();
    let index = |x: usize, z: usize| (x * (n + 1) + z) as u32;
    let cell = |x, z| {
        let [a, b, c, d] = [index(x, z), index(x + 1, z), index(x + 1, z + 1), index(x, z + 1)];
        if (x + z) % 3 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let triangles = (0..n).flat_map(|x| (0..n).flat_map(move |z| cell(x, z))).collect();
    Mesh::new(vertices, triangles).expect("a valid mesh")
}

/// Capsules that fall, roll and slide on a floor of triangles do what they do on a plane, to the bit: with their end spheres alone.
fn a_tessellated_floor_is_a_plane(backend: Backend) {
    for law in [ContactLaw::Thesis, ContactLaw::Linear] {
        let run = |mesh: Option<&Mesh>| {
            let mut scene = with(|settings| {
                settings.set("contact_law", &law.to_string()).expect("a law");
                settings.gravity = 9.81;
            });
            let glass = scene.add_material(Material::new("glass").density(2_500.0)).expect("a valid material");
            let pair = Pair::default().restitution(0.5).friction(0.4).stiffness(1e4);
            scene.set_pair(glass, glass, pair).expect("a valid pair");
            match mesh {
                Some(mesh) => drop(scene.add_mesh(mesh, |triangle| triangle.material(glass)).expect("a valid mesh")),
                None => drop(scene.add_polygon(Polygon::plane([0.0; 3], [0.0, 1.0, 0.0]).material(glass)).expect("a wall")),
            }
            for k in 0..5 {
                let (x, z, turn) = (0.6 * k as f32 - 1.2, 0.1 * k as f32 - 0.2, 0.7 * k as f32);
                let half = 0.25 * Vec3::new(turn.cos(), 0.05 * k as f32, turn.sin());
                let middle = Vec3::new(x, 0.14, z);
                let capsule = Capsule::new(middle - half, middle + half, 0.125).velocity([0.3, 0.0, 0.1 * k as f32]);
                scene.add_capsule(capsule.material(glass)).expect("a valid capsule");
            }
            let integrator = if law == ContactLaw::Thesis { Integrator::Rk4 } else { Integrator::VelocityVerlet };
            let mut simulation = open(scene, backend, integrator);
            let (dt, few) = if law == ContactLaw::Thesis { (0.005, 60) } else { (5e-4, 240) };
            simulation.run(on(backend, 400, few), dt).expect("steps");
            let report = simulation.report();
            (bits(&spheres(&mut simulation)), u64::from(report.contacts) + report.total_collisions)
        };
        let plane = run(None);
        assert!(plane.1 > 0, "no capsule touches the floor");
        for n in [1, 7, 16] {
            assert_eq!(run(Some(&floor(n))), plane, "{law}, {n} cells");
        }
    }
}

/// Capsules that tumble over all these walls.
fn pile() -> Scene {
    let mut scene = with(|settings| (settings.gravity, settings.restitution) = (10.0, 0.4));
    for (k, (_, walls)) in walls().into_iter().enumerate() {
        let way = Vec3::new(0.1 * k as f32, 0.0, 3.0 * k as f32);
        for mut wall in walls {
            wall.corner += way;
            scene.add_polygon(wall).expect("a valid wall");
        }
        for j in 0..3 {
            let up = Vec3::new(0.15 * j as f32 - 0.1, 0.2 + 0.3 * j as f32, 0.3 * j as f32 - 0.3) + way;
            let half = Vec3::new(0.5, 0.1 * j as f32, 0.2 - 0.15 * j as f32);
            scene.add_capsule(Capsule::new(up - half, up + half, 0.125)).expect("a valid capsule");
        }
    }
    scene
}

/// The three broad phases have the same lists, so results are equal to the bit.
fn results_do_not_depend_on_the_broad_phase(backend: Backend) {
    let run = |broad_phase: BroadPhase| {
        let options = Options::new().backend(backend).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(pile(), options).expect("the simulation opens");
        simulation.run(on(backend, 120, 40), 1.0 / 128.0).expect("steps");
        assert!(simulation.report().total_collisions > 0);
        bits(&spheres(&mut simulation))
    };
    let [first, rest @ ..] = [BroadPhase::BruteForce, BroadPhase::SortAndSkip, BroadPhase::Grid].map(run);
    assert!(rest.iter().all(|other| *other == first));
}

/// Both backends do the same, up to rounding, until the motion amplifies it.
#[cfg(feature = "gpu")]
#[test]
fn the_backends_agree() {
    let _device = rockfall::gpu::SharedDevice::new();
    let run = |backend| {
        let mut simulation = open(pile(), backend, Integrator::Rk4);
        simulation.run(25, 1.0 / 128.0).expect("steps");
        spheres(&mut simulation)
    };
    for (one, other) in run(Backend::Cpu).iter().zip(run(Backend::Gpu)) {
        near(one.position, other.position.as_dvec3(), 1e-4, "place");
        near(one.velocity, other.velocity.as_dvec3(), 5e-3, "velocity");
    }
}

both!(
    a_balanced_capsule_is_carried,
    a_dropped_capsule_keeps_its_energy,
    an_eccentric_hit_turns_a_capsule,
    a_capsule_along_a_wall_touches_it_with_its_ends,
    a_capsule_lies_over_the_border_of_a_table,
    an_elastic_impact_over_the_border_of_a_table_keeps_its_energy,
    a_capsule_over_a_border_keeps_its_energy,
    a_capsule_lies_on_a_block_of_triangles,
    a_tessellated_floor_is_a_plane,
    results_do_not_depend_on_the_broad_phase,
);
