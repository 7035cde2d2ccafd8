//! The eight tests of Chung and Ooi, Granular Matter 13 (2011) 643, in SI units, with the law `hertz-mindlin` on the CPU.
//!
//! Expected values are those of Hertz's theory, and for contacts that slide all the time those of a rigid body under Coulomb's
//! law: the tangential impulse is mu times the normal impulse.

use rockfall::{Backend, ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Scene, Simulation, Sphere};

use super::{assert_close, ball, options, scene_with};

/// The integrators that the law allows. All tests run with both.
const INTEGRATORS: [Integrator; 2] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// Young's modulus in Pa, Poisson's ratio, density in kg/m³.
#[derive(Clone, Copy)]
struct Solid(f32, f32, f32);

const GLASS: Solid = Solid(48e9, 0.20, 2800.0);
const LIMESTONE: Solid = Solid(20e9, 0.25, 2500.0);
const ALUMINIUM: Solid = Solid(70e9, 0.30, 2699.0);
const MAGNESIUM: Solid = Solid(40e9, 0.35, 1800.0);
const ALUMINA: Solid = Solid(380e9, 0.23, 4000.0);
const STEEL: Solid = Solid(208e9, 0.30, 7850.0);
const NYLON: Solid = Solid(2.5e9, 0.40, 1000.0);

fn scene_of(solid: Solid, e: f32, mu: f32) -> (Scene, MaterialId) {
    let mut scene = scene_with(ContactLaw::HertzMindlin);
    let Solid(young, poisson, density) = solid;
    let material = Material::new("solid").young(young).poisson(poisson).density(density);
    let material = scene.add_material(material).expect("a valid material");
    scene.set_pair(material, material, Pair::default().restitution(e).friction(mu)).expect("a valid pair");
    (scene, material)
}

/// A plane y = 0 in a scene of a ball of radius `radius`.
fn plane(scene: &mut Scene, material: MaterialId, radius: f32) {
    let size = 40.0 * radius;
    let floor = Cuboid::between([-size, -size, -size], [size, 0.0, size]).material(material);
    scene.add_box(floor).expect("a valid box");
}

/// Duration, deepest overlap in m, and number of spheres' states of an impact.
struct Impact {
    duration: f64,
    overlap: f64,
    simulation: Simulation,
}

/// Runs an impact at a time step of a 400th of Hertz's duration, until the bodies are apart.
fn impact(scene: Scene, hertz: f64, integrator: Integrator) -> Impact {
    let dt = hertz / 400.0;
    let options = options(Backend::Cpu).integrator(integrator);
    let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
    let (mut steps, mut overlap) = (0, 0.0_f64);
    for step in 0..4000 {
        let report = simulation.run(1, dt as f32).expect("a step");
        if report.contacts > 0 {
            steps += 1;
            overlap = overlap.max(report.max_overlap.into());
        } else if steps > 0 {
            break;
        }
        assert!(step < 3999, "the impact does not end");
    }
    Impact { duration: f64::from(steps) * dt, overlap, simulation }
}

/// E*, R*, m* of two equal solids.
struct Reduced {
    young: f64,
    radius: f64,
    mass: f64,
}

impl Reduced {
    fn new(Solid(young, poisson, density): Solid, radius: f64, with_plane: bool) -> Self {
        let young = f64::from(young) / (2.0 * (1.0 - f64::from(poisson).powi(2)));
        let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * f64::from(density);
        let half = if with_plane { 1.0 } else { 0.5 };
        Self { young, radius: half * radius, mass: half * mass }
    }

    /// Duration of an elastic impact, 2.94 (15/16 m* / (E* sqrt R*))^(2/5) u^(-1/5), written with the exact constant.
    fn duration(&self, speed: f64) -> f64 {
        2.943_275 * self.overlap(speed) / speed
    }

    /// Deepest overlap, (15 m* u² / (16 E* sqrt R*))^(2/5).
    fn overlap(&self, speed: f64) -> f64 {
        (15.0 * self.mass * speed * speed / (16.0 * self.young * self.radius.sqrt())).powf(0.4)
    }
}

/// Test 1: elastic normal impact of two equal spheres, at 10 m/s each. Test 2: of a sphere on a plane, at 0.2 m/s.
#[test]
fn elastic_impacts_have_the_duration_and_depth_of_hertz() {
    let cases =
        [(GLASS, 0.01, 10.0, false), (LIMESTONE, 0.01, 10.0, false), (ALUMINIUM, 0.1, 0.2, true), (MAGNESIUM, 0.1, 0.2, true)];
    for (integrator, (solid, radius, speed, with_plane)) in
        INTEGRATORS.into_iter().flat_map(|one| cases.map(|case| (one, case)))
    {
        let (mut scene, material) = scene_of(solid, 1.0, 0.0);
        let reduced = Reduced::new(solid, radius, with_plane);
        let closing = if with_plane { speed } else { 2.0 * speed };
        let (hertz, r) = (reduced.duration(closing), radius as f32);
        if with_plane {
            plane(&mut scene, material, r);
        } else {
            let above = ball(&scene, material, [0.0, 3.0 * r, 0.0], r).velocity([0.0, -speed as f32, 0.0]);
            scene.add_sphere(above).expect("a valid sphere");
        }
        let up = if with_plane { -speed } else { speed };
        let below = ball(&scene, material, [0.0, r, 0.0], r).velocity([0.0, up as f32, 0.0]);
        let id = scene.add_sphere(below).expect("a valid sphere");
        let Impact { duration, overlap, mut simulation } = impact(scene, hertz, integrator);
        assert_close(duration, hertz, 0.01, "duration");
        assert_close(overlap, reduced.overlap(closing), 0.005, "deepest overlap");
        let velocity = simulation.sync().expect("the state").sphere(id).expect("the sphere").velocity.y;
        assert_close(f64::from(velocity), -up, 0.001, "rebound");
    }
}

/// Test 3: the speed of rebound of an aluminium oxide sphere of radius 2.5 mm at 3.9 m/s is e times that speed.
#[test]
fn the_rebound_is_in_proportion_to_the_restitution() {
    for integrator in INTEGRATORS {
        for e in [0.1, 0.2, 0.4, 0.6, 0.8, 1.0] {
            let (normal, _, _) = oblique(integrator, ALUMINA, 0.0025, e, 0.0, [0.0, 3.9], 0.0);
            assert_close(normal, f64::from(e) * 3.9, 0.01, "rebound");
        }
    }
}

/// An impact on a plane at velocity (x, -y) with a spin about z. Returns the velocity along y and x and the spin afterwards.
fn oblique(
    integrator: Integrator,
    solid: Solid,
    radius: f32,
    e: f32,
    mu: f32,
    [along, normal]: [f32; 2],
    spin: f32,
) -> (f64, f64, f64) {
    let (mut scene, material) = scene_of(solid, e, mu);
    plane(&mut scene, material, radius);
    let ball = ball(&scene, material, [0.0, radius, 0.0], radius).velocity([along, -normal, 0.0]);
    let id = scene.add_sphere(ball.angular_momentum([0.0, 0.0, spin * ball.inertia()])).expect("a valid sphere");
    let hertz = Reduced::new(solid, radius.into(), true).duration(normal.into());
    let mut after = impact(scene, hertz, integrator).simulation;
    let sphere = *after.sync().expect("the state").sphere(id).expect("the sphere");
    (sphere.velocity.y.into(), sphere.velocity.x.into(), sphere.spin().z.into())
}

/// Test 4: oblique impacts at 3.9 m/s and several angles. Test 5: at a constant normal velocity of 5 m/s. Contacts that slide
/// all the time lose mu (1 + e) of the normal velocity, and gain 5/2 of that as spin. No impact gains energy.
#[test]
fn oblique_impacts_slide_or_stick() {
    for integrator in INTEGRATORS {
        let e = 0.98_f32;
        for degrees in [5.0_f32, 15.0, 25.0, 35.0, 50.0, 65.0, 80.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (radius, mu) = (0.0025, 0.092);
            let (y, x, spin) = oblique(integrator, ALUMINA, radius, e, mu, [3.9 * sin, 3.9 * cos], 0.0);
            assert_close(y, f64::from(e * 3.9 * cos), 0.01, "normal velocity");
            let energy = x * x + y * y + 0.4 * f64::from(radius).powi(2) * spin * spin;
            assert!(energy <= 3.9_f64.powi(2) * 1.0001, "{degrees} degrees: energy {energy}");
            if degrees > 30.0 {
                let lost = f64::from(mu * (1.0 + e) * 3.9 * cos);
                assert_close(f64::from(3.9 * sin) - x, lost, 0.01, "tangential velocity lost");
                assert_close(-spin * f64::from(radius), 2.5 * lost, 0.01, "spin");
            } else {
                assert!(x > 0.4 * f64::from(3.9 * sin) && x < f64::from(3.9 * sin), "{degrees} degrees: {x}");
            }
        }
        // An elastic and compliant contact that sticks at first; the largest angles slide.
        for solid in [STEEL, Solid(1e9, 0.4, 1400.0)] {
            for along in [0.5_f32, 2.0, 6.0, 12.0, 20.0] {
                let (y, x, spin) = oblique(integrator, solid, 0.1, 1.0, 0.3, [along, 5.0], 0.0);
                assert_close(y, 5.0, 0.005, "normal velocity");
                let energy = x * x + y * y + 0.4 * 0.01 * spin * spin;
                assert!(energy <= f64::from(along).powi(2) + 25.0 + 0.01, "{along}: energy {energy}");
                if along >= 12.0 {
                    assert_close(f64::from(along) - x, 0.3 * 2.0 * 5.0, 0.01, "tangential velocity lost");
                    // The arm is shorter than the radius by the overlap, which is up to 3.5 % of the softer ball.
                    assert_close(-spin * 0.1, 2.5 * 3.0, 0.035, "spin");
                }
            }
        }
    }
}

/// Test 6: a spinning sphere falls on a plane at 0.2 m/s, e = 0.5, mu = 0.4. Fast spins slide: it is thrown along by
/// mu (1 + e) 0.2 = 0.12 m/s.
#[test]
fn spinning_spheres_are_thrown_along_a_plane() {
    for integrator in INTEGRATORS {
        for solid in [ALUMINIUM, NYLON] {
            for spin in [10.0_f32, 20.0, 40.0] {
                let (y, x, after) = oblique(integrator, solid, 0.1, 0.5, 0.4, [0.0, 0.2], -spin);
                assert_close(y, 0.1, 0.01, "normal velocity");
                assert_close(x, 0.12, 0.01, "tangential velocity");
                assert_close(after, f64::from(-spin) + 2.5 * 0.12 / 0.1, 0.01, "spin");
            }
        }
    }
}

/// Test 7: two equal spheres with the same spin, at 0.2 m/s each. Test 8: two spheres of different sizes. The impulse is
/// J = (1 + e) m* u along the normal and mu J across it.
#[test]
fn spinning_spheres_throw_each_other() {
    for integrator in INTEGRATORS {
        for radii in [[0.1_f32, 0.1], [0.1, 0.05]] {
            for solid in [ALUMINIUM, NYLON] {
                let (mut scene, material) = scene_of(solid, 0.5, 0.4);
                let spin = 20.0_f32;
                let sides = [(-radii[0], 0.2_f32, radii[0]), (radii[1], -0.2, radii[1])];
                let spheres: [Sphere; 2] = sides.map(|(x, v, radius)| {
                    let ball = ball(&scene, material, [x, 0.0, 0.0], radius).velocity([v, 0.0, 0.0]);
                    ball.angular_momentum([0.0, 0.0, spin * ball.inertia()])
                });
                let ids = spheres.map(|sphere| scene.add_sphere(sphere).expect("a valid sphere"));
                let hertz = Reduced::new(solid, 0.1, true).duration(0.4);
                let mut after = impact(scene, hertz, integrator).simulation;
                let scene = after.sync().expect("the state");
                let [m, n] = spheres.map(|sphere| f64::from(sphere.mass));
                let impulse = 1.5 * 0.4 * m * n / (m + n);
                for ((sphere, id), sign) in spheres.iter().zip(ids).zip([-1.0, 1.0]) {
                    let now = scene.sphere(id).expect("a sphere");
                    let mass = f64::from(sphere.mass);
                    let velocity = f64::from(sphere.velocity.x) + sign * impulse / mass;
                    assert!((f64::from(now.velocity.x) - velocity).abs() < 0.004, "{} {velocity}", now.velocity.x);
                    // The surfaces move at +spin r and -spin r: the left sphere is pushed down, the right one up.
                    assert_close(now.velocity.y.into(), sign * 0.4 * impulse / mass, 0.015, "tangential velocity");
                    let slower = 2.5 * 0.4 * impulse / (mass * f64::from(sphere.radius));
                    assert_close(now.spin().z.into(), f64::from(spin) - slower, 0.01, "spin");
                }
            }
        }
    }
}
