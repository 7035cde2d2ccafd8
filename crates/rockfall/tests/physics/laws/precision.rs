//! Double precision of positions (docs/physics section 5.8): small bodies far from the origin move as at the origin.

use rockfall::{
    Backend, BroadPhase, Checkpoint, ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Polygon, Precision, Scene,
    Simulation, Sphere, SphereId, Spring, Tether,
};

use super::{assert_close, options, scene_with};
use crate::common::bits_of;

const INTEGRATORS: [Integrator; 2] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// A scene with double precision and one material.
fn scene_of(young: f32, density: f32, e: f32, mu: f32) -> (Scene, MaterialId) {
    let mut scene = scene_with(ContactLaw::HertzMindlin);
    scene.settings.precision = Precision::Double;
    let material = Material::new("solid").young(young).poisson(0.25).density(density);
    let material = scene.add_material(material).expect("a valid material");
    scene
        .set_pair(material, material, Pair::default().restitution(e).friction(mu).rolling_friction(0.05))
        .expect("a valid pair");
    (scene, material)
}

fn opened(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    Simulation::with_options(scene, options(backend).integrator(integrator)).expect("the simulation opens")
}

fn add(scene: &mut Scene, material: MaterialId, centre: [f64; 3], radius: f32, velocity: [f32; 3]) -> SphereId {
    let density = scene.material(material).expect("a material").density.expect("a density");
    let sphere = Sphere::new([0.0; 3], radius).density(density).material(material);
    scene.add_sphere(sphere.centred_at(centre).velocity(velocity)).expect("a valid sphere")
}

/// Ten grains of radius 1 mm and 1 GPa on a floor, 10 m from the origin. The contact under k grains carries k m g and overlaps by
/// (3 k m g / (4 E* sqrt R*))^(2/3), which is 0.03 to 0.4 micrometres. On the CPU the grains fall into these places from overlaps of 0.
fn a_column_rests_with_the_overlaps_of_the_closed_form(backend: Backend) {
    const COUNT: usize = 10;
    for (integrator, on_polygon) in INTEGRATORS.into_iter().zip([false, true]) {
        let (mut scene, material) = scene_of(1e9, 2500.0, 0.3, 0.3);
        scene.settings.gravity = 9.81;
        scene.settings.linear_damping = 3000.0;
        let (radius, floor) = (f64::from(1e-3_f32), 10.0);
        if on_polygon {
            let face = Polygon::new([9.5, floor as f32, 9.5], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]).material(material);
            scene.add_polygon(face).expect("a valid polygon");
        } else {
            scene.add_box(Cuboid::between([9.5, 9.5, 9.5], [10.5, 10.0, 10.5]).material(material)).expect("a valid box");
        }
        let mass = f64::from(Sphere::new([0.0; 3], 1e-3).density(2500.0).mass);
        let young = 1e9 / (2.0 * (1.0 - 0.25 * 0.25));
        let expected: Vec<f64> = (0..COUNT)
            .map(|index| {
                let effective: f64 = if index == 0 { radius } else { 0.5 * radius };
                (3.0 * (COUNT - index) as f64 * mass * 9.81 / (4.0 * young * effective.sqrt())).powf(2.0 / 3.0)
            })
            .collect();
        let (steps, dt, start) = crate::common::on(backend, (40_000, 2e-6_f32, 0.0), (200, 2e-6, 1.0));
        let mut y = floor - radius;
        let ids: Vec<SphereId> = expected
            .iter()
            .map(|overlap| {
                y += 2.0 * radius - start * overlap;
                add(&mut scene, material, [10.0, y, 10.0], 1e-3, [0.0; 3])
            })
            .collect();
        let mut simulation = opened(scene, backend, integrator);
        simulation.run(steps, dt).expect("steps");
        let state = simulation.sync().expect("the state");
        let mut below = floor - radius;
        let mut worst = 0.0_f64;
        for (id, overlap) in ids.iter().zip(&expected) {
            let y = state.sphere(*id).expect("a sphere").centre()[1];
            worst = worst.max(((2.0 * radius - (y - below)) / overlap - 1.0).abs());
            below = y;
        }
        println!("{backend} {integrator}: overlaps differ by {worst:.1e}");
        assert!(worst < 1e-4, "{integrator}: {worst}");
        // The same is true for the contacts that are reported.
        let deepest = simulation.max_overlap().expect("overlaps").units;
        assert_close(f64::from(deepest), expected[0].max(expected[1]), 0.01, "deepest overlap");
    }
}

/// Velocity and spin of a ball after an oblique impact of the tests of Chung and Ooi: aluminium oxide, radius 2.5 mm, 3.9 m/s, 50
/// degrees. The plane is at `height`.
fn rebound(backend: Backend, integrator: Integrator, origin: f64) -> [f64; 3] {
    let (mut scene, material) = scene_of(380e9, 4000.0, 0.98, 0.092);
    let (radius, speed) = (0.0025_f32, 3.9_f64);
    let corner = |offset: f64| (origin + offset) as f32;
    let low = [corner(-0.5), corner(-0.5), corner(-0.5)];
    scene.add_box(Cuboid::between(low, [corner(0.5), corner(0.0), corner(0.5)]).material(material)).expect("a valid box");
    let (sin, cos) = 50.0_f64.to_radians().sin_cos();
    let velocity = [(speed * sin) as f32, (-speed * cos) as f32, 0.0];
    let id = add(&mut scene, material, [origin, origin + f64::from(radius), origin], radius, velocity);
    // The impact takes 6.4 microseconds.
    let steps = crate::common::on(backend, 400, 100);
    let mut simulation = opened(scene, backend, integrator);
    simulation.run(steps, 1e-5 / steps as f32).expect("steps");
    let sphere = *simulation.sync().expect("the state").sphere(id).expect("a sphere");
    assert_eq!(simulation.report().contacts, 0, "the impact has ended");
    [sphere.velocity.x.into(), sphere.velocity.y.into(), f64::from(sphere.spin().z)]
}

fn an_impact_10_m_away_equals_that_at_the_origin(backend: Backend) {
    for integrator in INTEGRATORS {
        let [here, there] = [0.0, 10.0].map(|origin| rebound(backend, integrator, origin));
        for (here, there) in here.into_iter().zip(there) {
            println!("{backend} {integrator}: {here} {there}");
            assert_close(there, here, 1e-3, "rebound");
        }
    }
}

/// Greatest kinetic energy of a pile of balls of radius 0.5 in a walled box at a distance from the origin, after it has come to rest on
/// the CPU with double precision and has gone on with the given backend and precision.
fn restlessness(backend: Backend, distance: f64, precision: Precision) -> f64 {
    let (mut scene, material) = scene_of(2e5, 1.0, 0.2, 0.5);
    scene.settings.gravity = 10.0;
    scene.settings.linear_damping = 2.0;
    scene.settings.angular_damping = 2.0;
    let place = |x: f64, y: f64, z: f64| [distance + x, distance + y, distance + z];
    let single = |x: f64, y: f64, z: f64| place(x, y, z).map(|coordinate| coordinate as f32);
    for (low, high) in [
        (single(-4.0, -1.0, -4.0), single(4.0, 0.0, 4.0)),
        (single(-4.0, 0.0, -4.0), single(-2.0, 8.0, 4.0)),
        (single(2.0, 0.0, -4.0), single(4.0, 8.0, 4.0)),
        (single(-4.0, 0.0, -4.0), single(4.0, 8.0, -2.0)),
        (single(-4.0, 0.0, 2.0), single(4.0, 8.0, 4.0)),
    ] {
        scene.add_box(Cuboid::between(low, high).material(material)).expect("a valid box");
    }
    for k in 0..60 {
        let (x, z, y) = (f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
        let centre = place(1.1 * x - 1.15 + 0.03 * z, 0.5 + 0.98 * y, 1.1 * z - 1.15 + 0.02 * y);
        add(&mut scene, material, centre, 0.5, [0.0; 3]);
    }
    let mut simulation = opened(scene, Backend::Cpu, Integrator::VelocityVerlet);
    simulation.run(20_000, 1e-3).expect("steps");
    let mut checkpoint = simulation.checkpoint().expect("a checkpoint");
    checkpoint.options.backend = backend;
    checkpoint.scene.settings.precision = precision;
    let mut simulation = Simulation::resume(checkpoint).expect("resumed");
    let energies = (0..5).map(|_| {
        simulation.run(crate::common::on(backend, 200, 40), 1e-3).expect("steps");
        simulation.energy().expect("energy").kinetic
    });
    energies.fold(0.0, f64::max)
}

fn a_pile_far_away_comes_to_rest_as_at_the_origin(backend: Backend) {
    let near = restlessness(backend, 0.0, Precision::Double);
    let far = restlessness(backend, 1e5, Precision::Double);
    let coarse = restlessness(backend, 1e5, Precision::Single);
    println!("{backend}: {near:e} at the origin, {far:e} far away, {coarse:e} with single precision");
    // Ten times the greatest energy that was measured; with single precision it was 0.8 or more.
    assert!(near < 2e-11 && far < 2e-11, "{near} {far}");
    assert!(coarse > 0.1, "{coarse}");
}

/// A heap with a spring and a tether, 1000 units from the origin.
fn heap() -> Scene {
    let (mut scene, material) = scene_of(1e5, 1.0, 0.3, 0.6);
    scene.settings.gravity = 10.0;
    let at = |offset: [f64; 3]| offset.map(|x| 1000.0 + x);
    scene
        .add_box(
            Cuboid::between(at([-4.0, -1.0, -4.0]).map(|x| x as f32), at([4.0, 0.0, 4.0]).map(|x| x as f32)).material(material),
        )
        .expect("a valid box");
    let ids: Vec<SphereId> = (0..18)
        .map(|k| {
            let (x, z, y) = (f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
            let centre = at([1.05 * x - 1.0 + 0.031 * z, 0.49 + 0.97 * y, 1.05 * z - 1.0 + 0.017 * y]);
            add(&mut scene, material, centre, if k % 4 == 1 { 0.3 } else { 0.5 }, [0.3 * x as f32, -1.0, 0.2])
        })
        .collect();
    scene.add_spring(Spring::new(ids[0], ids[17], 20.0, 1.5).damping(0.1)).expect("a valid spring");
    scene.add_tether(Tether::new(ids[9], [1001.0, 1003.0, 1000.0], 10.0).length(1.0)).expect("a valid tether");
    scene
}

/// The result does not depend on the broad phase, on when memory is sorted, or on how a run is divided and resumed.
fn low_parts_are_kept_bit_for_bit(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (2000_u64, 3e-4), (200, 1e-3));
    for integrator in INTEGRATORS {
        let open = |method: BroadPhase| {
            let options = options(backend).integrator(integrator).broad_phase(method);
            Simulation::with_options(heap(), options).expect("the simulation opens")
        };
        let mut whole = open(BroadPhase::Grid);
        whole.run(steps, dt).expect("steps");
        let expected = bits_of(&mut whole);
        assert!(whole.spheres().expect("states").iter().any(|sphere| sphere.position_low.x != 0.0));
        for method in [BroadPhase::BruteForce, BroadPhase::SortAndSkip] {
            let mut other = open(method);
            other.run(steps, dt).expect("steps");
            assert!(bits_of(&mut other) == expected, "{integrator}, {method}");
        }
        let mut parts = open(BroadPhase::Grid);
        for part in 0..4 {
            parts.run(steps / 4, dt).expect("steps");
            match part {
                0 => parts.sort_memory().expect("sorted memory"),
                1 => {
                    let bytes = parts.checkpoint().expect("a checkpoint").to_bytes();
                    parts = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("valid")).expect("resumed");
                }
                2 => {
                    let checkpoint = parts.checkpoint().expect("a checkpoint");
                    parts.run(3, dt).expect("steps");
                    parts.restore(&checkpoint).expect("restored");
                }
                _ => {}
            }
        }
        assert!(bits_of(&mut parts) == expected, "{integrator}, in parts");
    }
}

/// Positions that are set have no low part from before, those that are set in f64 have theirs, and another precision in the
/// middle of a run keeps them.
fn edits_set_all_digits(backend: Backend) {
    let (mut scene, material) = scene_of(1e5, 1.0, 0.3, 0.6);
    let id = add(&mut scene, material, [1_000.000_01, 0.0, 0.0], 0.5, [1e-3, 0.0, 0.0]);
    let mut simulation = opened(scene, backend, Integrator::VelocityVerlet);
    let x = |simulation: &mut Simulation| simulation.sphere(id).expect("a sphere").centre()[0];
    assert_close(x(&mut simulation) - 1000.0, 1e-5, 1e-6, "start");
    simulation.run(10, 1e-3).expect("steps");
    assert_close(x(&mut simulation) - 1000.0, 2e-5, 1e-5, "after ten steps");
    simulation.set_position(id, [1000.0, 0.0, 0.0]).expect("an edit");
    assert_eq!(x(&mut simulation), 1000.0);
    simulation.set_centre(id, [1_000.000_003, 0.0, 0.0]).expect("an edit");
    simulation.run(10, 1e-3).expect("steps");
    assert_close(x(&mut simulation) - 1000.0, 1.3e-5, 1e-5, "after ten more");
    let mut settings = *simulation.settings();
    settings.precision = Precision::Single;
    simulation.set_settings(settings).expect("single precision");
    simulation.run(10, 1e-3).expect("steps");
    assert_close(x(&mut simulation) - 1000.0, 2.3e-5, 1e-5, "single precision keeps them");
    settings.precision = Precision::Double;
    simulation.set_settings(settings).expect("double precision");
    simulation.run(10, 1e-3).expect("steps");
    assert_close(x(&mut simulation) - 1000.0, 3.3e-5, 1e-5, "double precision again");
}

both_in_turn! {
    a_column_rests_with_the_overlaps_of_the_closed_form,
    an_impact_10_m_away_equals_that_at_the_origin,
    a_pile_far_away_comes_to_rest_as_at_the_origin,
    low_parts_are_kept_bit_for_bit,
    edits_set_all_digits,
}

#[test]
fn scene_text_has_all_digits() {
    let text = "set contact_law hertz-mindlin\nset precision double\n@material m young=1e9 poisson=0.25\n@use m\n\
                S 0 10.000000123 -0.1 1e5 0 0 0 0 0 0 1 0.5\n";
    let read = |text: &str| Scene::parse(text, "text".as_ref()).expect("a valid text").scene;
    let scene = read(text);
    assert_eq!(scene.spheres()[0].position.x, 10.0);
    let error = (scene.spheres()[0].centre()[0] - 10.000_000_123).abs();
    assert!(error < 1e-14, "{error}");
    assert!((scene.spheres()[0].centre()[1] + 0.1).abs() < 1e-15);
    assert_eq!(read(&scene.to_text()).spheres()[0].centre(), scene.spheres()[0].centre());
    // With single precision the digits are rounded, and the text is that of f32 numbers.
    let single = read(&text.replace("double", "single"));
    assert_eq!(single.spheres()[0].position_low, glam::Vec3::ZERO);
    assert!(single.to_text().contains("S 0 10 -0.1 100000 "), "{}", single.to_text());
}

#[test]
fn check_suggests_double_precision_where_positions_are_too_coarse() {
    let (mut scene, material) = scene_of(1e5, 1.0, 0.3, 0.6);
    add(&mut scene, material, [1e6, 0.0, 0.0], 0.5, [0.0; 3]);
    assert!(scene.coarse().is_none());
    scene.settings.precision = Precision::Single;
    let warning = scene.coarse().expect("a warning").describe(&scene);
    assert!(warning.ends_with("or set precision double"), "{warning}");
    scene.settings.precision = Precision::Auto;
    assert_eq!((scene.coarse(), scene.chosen_precision().precision), (None, Precision::Double));
}

/// Worlds with double precision advance as simulations do.
#[cfg(feature = "gpu")]
#[test]
fn worlds_keep_low_parts() {
    use crate::common::bits;

    for backend in [Backend::Cpu, Backend::Gpu] {
        let options = options(backend);
        let mut alone = Simulation::with_options(heap(), options.clone()).expect("the simulation opens");
        let mut worlds = rockfall::Worlds::new([heap(), heap()], options).expect("worlds");
        alone.run(20, 1e-3).expect("steps");
        worlds.run(20, 1e-3).expect("steps");
        assert_eq!(bits(&worlds.states(1).expect("states")), bits_of(&mut alone), "{backend}");
        // Setting the states of another world gives all digits too.
        let states = worlds.states(1).expect("states");
        worlds.set_states(0, &states).expect("states");
        assert_eq!(bits(&worlds.states(0).expect("states")), bits(&states), "{backend}");
    }
}
