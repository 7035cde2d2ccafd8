//! Coarse-grained fields against closed forms.

use glam::DVec3;
use rockfall::{Backend, ContactLaw, Cuboid, Integrator, Material, Options, Pair, Scene, Simulation, Sphere};
use rockfall_trajectory::fields::{Fields, Kernel, Smoothing, Sources};

const KERNELS: [Kernel; 2] = [Kernel::Gaussian, Kernel::Heaviside];

fn simulation(scene: Scene) -> Simulation {
    let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

fn fields(simulation: &mut Simulation, kernel: Kernel, width: f64, spacing: f64) -> (Sources, Smoothing, Fields) {
    let sources = Sources::of(simulation).expect("sources");
    let smoothing = Smoothing::new(kernel, width).expect("a width");
    let grid = sources.grid(smoothing, spacing).expect("a grid");
    let fields = sources.fields(grid, smoothing);
    (sources, smoothing, fields)
}

/// An empty scene with the law hertz-mindlin, and its material.
fn grains(gravity: f32) -> (Scene, rockfall::MaterialId) {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::HertzMindlin;
    scene.settings.collisions = false;
    scene.settings.gravity = gravity;
    let material = scene.add_material(Material::new("m").density(1.0).young(1e5).poisson(0.25)).expect("a material");
    scene.set_pair(material, material, Pair::default().restitution(0.3).friction(0.4)).expect("a pair");
    (scene, material)
}

/// A column of three balls at rest on a floor.
fn column() -> Simulation {
    let (mut scene, material) = grains(10.0);
    scene.add_box(Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]).material(material)).expect("a box");
    for y in [0.5, 1.5, 2.5] {
        scene.add_sphere(Sphere::new([0.0, y, 0.0], 0.5).density(1.0).material(material)).expect("a sphere");
    }
    let mut simulation = simulation(scene);
    simulation.run(40_000, 5e-5).expect("steps");
    simulation
}

/// A cloud of balls that move and touch.
fn cloud() -> Simulation {
    let (mut scene, material) = grains(10.0);
    scene.add_box(Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0]).material(material)).expect("a box");
    for k in 0..60_u8 {
        let [x, y, z] = [k % 4, k / 16, k / 4 % 4].map(|place| 0.5 * f32::from(place) + 0.001 * f32::from(k));
        let velocity = [f32::from(k % 7) - 3.0, f32::from(k % 5) - 4.0, f32::from(k % 3) - 1.0];
        let sphere = Sphere::new([x - 0.8, y + 0.26, z - 0.8], 0.25).density(1.0).velocity(velocity).material(material);
        scene.add_sphere(sphere).expect("a sphere");
    }
    let mut simulation = simulation(scene);
    simulation.run(2000, 1e-4).expect("steps");
    simulation
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{what}: {found}, expected {expected}");
}

/// The integral of the density is the mass, and that of density times velocity is the momentum, for both kernels.
#[test]
fn mass_and_momentum_are_those_of_the_bodies() {
    let mut simulation = cloud();
    let scene = simulation.sync().expect("the state");
    let mass: f64 = scene.spheres().iter().map(|sphere| f64::from(sphere.mass)).sum();
    let momentum: DVec3 = scene.spheres().iter().map(|sphere| f64::from(sphere.mass) * sphere.velocity.as_dvec3()).sum();
    for (kernel, tolerance) in KERNELS.into_iter().zip([1e-3, 2e-2]) {
        let (_, _, fields) = fields(&mut simulation, kernel, 0.3, 0.06);
        let cell = 0.06_f64.powi(3);
        close(fields.density.iter().sum::<f64>() * cell, mass, tolerance, "mass");
        let found: DVec3 =
            fields.density.iter().zip(&fields.velocity).map(|(density, velocity)| *density * *velocity * cell).sum();
        assert!((found - momentum).length() < tolerance * momentum.length(), "{found} of {momentum}");
    }
}

/// The integral of the contact stress of a column at rest is minus the sum of branch times force: m g for the upper contact, 2 m g
/// for the lower one, each with a branch of nearly 1, and 3 m g with a branch of nearly 0.5 at the floor.
#[test]
fn stress_of_a_column_is_that_of_its_contacts() {
    let mut simulation = column();
    let scene = simulation.sync().expect("the state");
    let weight = 10.0 * f64::from(scene.spheres()[0].mass);
    let heights: Vec<f64> = scene.spheres().iter().map(|sphere| sphere.position.y.into()).collect();
    let expected = -weight * ((heights[2] - heights[1]) + 2.0 * (heights[1] - heights[0]) + 3.0 * heights[0]);
    for (kernel, spacing, tolerance) in [(Kernel::Gaussian, 0.1, 2e-3), (Kernel::Heaviside, 0.03, 2e-2)] {
        let (_, _, fields) = fields(&mut simulation, kernel, 0.5, spacing);
        let cell = spacing.powi(3);
        let total: f64 = fields.contact_stress.iter().map(|stress| stress.y_axis.y).sum();
        close(total * cell, expected, tolerance, "stress along gravity");
        let wall: f64 = fields.wall_force.iter().map(|force| force.y).sum();
        close(wall * cell, 3.0 * weight, tolerance, "force of the floor");
        let pressure: f64 = fields.pressure().sum();
        close(pressure * cell, -expected / 3.0, tolerance, "pressure");
        // Moments of inertia and rounding leave next to no stress across.
        assert!(fields.contact_stress.iter().all(|stress| stress.x_axis.y.abs() < 1e-3 * weight));
    }
}

/// In a column at rest, div(stress) + wall force + rho g vanishes everywhere. While bodies move, it is the rate of change of their
/// momentum: sum of (contact force + weight) phi.
#[test]
fn momentum_is_balanced_at_every_point() {
    let mut resting = column();
    let (sources, smoothing, _) = fields(&mut resting, Kernel::Gaussian, 0.4, 0.5);
    for y in [0.2, 0.6, 1.1, 1.5, 2.2, 2.9] {
        let [rest, weight] = sources.balance(DVec3::new(0.1, y, -0.05), smoothing);
        assert!(weight.y < -0.1 && rest.length() < 0.01 * weight.length(), "at {y}: {rest} of {weight}");
    }

    let mut moving = cloud();
    let (sources, smoothing, _) = fields(&mut moving, Kernel::Gaussian, 0.4, 0.5);
    let diagnostics = moving.diagnostics().expect("forces");
    let scene = moving.sync().expect("the state");
    let forces: Vec<(DVec3, DVec3)> = scene
        .spheres()
        .iter()
        .zip(diagnostics)
        .map(|(sphere, own)| (sphere.position.as_dvec3(), own.net_force.as_dvec3()))
        .collect();
    let mut greatest = 0.0_f64;
    for k in 0..20_u8 {
        let point = DVec3::new(0.11 * f64::from(k % 5) - 0.3, 0.1 + 0.07 * f64::from(k), 0.2 - 0.09 * f64::from(k % 4));
        let [found, weight] = sources.balance(point, smoothing);
        let expected: DVec3 = forces.iter().map(|(position, force)| smoothing.at(point - *position) * *force).sum();
        greatest = greatest.max(expected.length() / weight.length());
        assert!(
            (found - expected).length() < 1e-3 * (expected.length() + weight.length()),
            "at {point}: {found} of {expected}"
        );
    }
    assert!(greatest > 0.5, "the bodies must be accelerated: {greatest}");
}

/// Temperature and kinetic stress of bodies whose velocities are known: two equal balls at one place move apart with speed u along
/// x. Both masses have the same weight everywhere, so V = 0, T = u²/3 and the stress is -rho u² along x.
#[test]
fn temperature_is_the_mean_square_of_a_component() {
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    for speed in [-2.0, 2.0] {
        scene
            .add_sphere(Sphere::new([0.0; 3], 0.1).velocity([speed, 0.0, 0.0]).group(if speed > 0.0 { 1 } else { 2 }))
            .expect("a sphere");
    }
    let mut simulation = simulation(scene);
    let (_, _, fields) = fields(&mut simulation, Kernel::Gaussian, 0.3, 0.1);
    for (index, density) in fields.density.iter().enumerate().filter(|(_, density)| **density > 1e-3) {
        close(fields.temperature[index], 4.0 / 3.0, 1e-9, "temperature");
        close(fields.kinetic_stress[index].x_axis.x, -4.0 * density, 1e-9, "stress");
        assert!(fields.velocity[index].length() < 1e-9);
    }
}

#[test]
fn bad_arguments_are_named() {
    for width in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Smoothing::new(Kernel::Gaussian, width).expect_err("a bad width").to_string();
        assert!(error.starts_with("width: "), "{error}");
    }
    let mut simulation = column();
    let sources = Sources::of(&mut simulation).expect("sources");
    let smoothing = Smoothing::new("heaviside".parse().expect("a kernel"), 0.5).expect("a width");
    for spacing in [0.0, f64::NAN, 1e-4] {
        let error = sources.grid(smoothing, spacing).expect_err("a bad spacing").to_string();
        assert!(error.starts_with("spacing: "), "{error}");
    }
    let fields = sources.fields(sources.grid(smoothing, 0.5).expect("a grid"), smoothing);
    let error = fields.save("fields.txt").expect_err("a bad name").to_string();
    assert!(error.contains("expected a file .vti, .npz or .csv"), "{error}");
    assert!("gauss".parse::<Kernel>().is_err());
}
