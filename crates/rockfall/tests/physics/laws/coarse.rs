//! The warning of positions that are too coarse for the overlaps at rest (docs/physics section 6.2), and what happens there.

use rockfall::{Backend, ContactLaw, Cuboid, Integrator, Material, Pair, Precision, Scene, Simulation, Sphere};

use super::{assert_close, options, scene_with};

const LAWS: [ContactLaw; 3] = [ContactLaw::Thesis, ContactLaw::Linear, ContactLaw::HertzMindlin];
const RADIUS: f32 = 1.0 / 1024.0;
/// Time step, in s: about a quarter of 1/omega of a contact.
const STEP: f32 = 1.5e-5;
const BALLS: usize = 5;

/// A column of balls of radius 1/1024 that touch, on a floor at this height, and the overlap of a ball on another under its own weight.
fn column(law: ContactLaw, height: f32) -> (Scene, f64) {
    let mut scene = scene_with(law);
    let mut material = Material::new("solid").density(2500.0);
    (scene.settings.gravity, scene.settings.precision) = (10.0, Precision::Single);
    match law {
        ContactLaw::Thesis => {
            (scene.settings.contact_force, scene.settings.contact_damping, scene.settings.friction) = (3e8, 7e3, 0.0);
        }
        _ => material = material.young(1e9).poisson(0.25),
    }
    let material = scene.add_material(material).expect("a valid material");
    let pair = Pair::default().restitution(0.3);
    let pair = if law == ContactLaw::Linear { pair.stiffness(3e3) } else { pair };
    scene.set_pair(material, material, pair).expect("a valid pair");
    let floor = Cuboid::between([-1.0, height - 1.0, -1.0], [1.0, height, 1.0]);
    scene.add_box(floor.material(material)).expect("a valid box");
    let mut mass = 0.0;
    for index in 0..BALLS {
        let ball = Sphere::new([0.0, height + (2 * index + 1) as f32 * RADIUS, 0.0], RADIUS).density(2500.0).material(material);
        mass = f64::from(ball.mass);
        scene.add_sphere(ball).expect("a valid ball");
    }
    let weight = 10.0 * mass;
    let overlap = match law {
        ContactLaw::Linear => weight / 3e3,
        ContactLaw::Thesis => 10.0 / 3e8,
        _ => {
            let young = 1e9 / (2.0 * (1.0 - 0.25 * 0.25));
            (3.0 * weight / (4.0 * young * (0.5 * f64::from(RADIUS)).sqrt())).powf(2.0 / 3.0)
        }
    };
    (scene, overlap)
}

/// Worst difference between the mean overlaps of the column and the closed form, in overlaps of a ball under its own weight.
fn worst_error(law: ContactLaw, height: f32) -> f64 {
    const SAMPLES: u32 = 200;
    let (scene, alone) = column(law, height);
    let mut simulation =
        Simulation::with_options(scene, options(Backend::Cpu).integrator(Integrator::SymplecticEuler)).expect("opens");
    simulation.run(20_000, STEP).expect("steps");
    let mut means = [0.0; BALLS];
    for _ in 0..SAMPLES {
        simulation.run(20, STEP).expect("steps");
        let mut below = f64::from(height) - f64::from(RADIUS);
        for (mean, sphere) in means.iter_mut().zip(simulation.spheres().expect("states")) {
            let y = f64::from(sphere.position.y);
            *mean += (2.0 * f64::from(RADIUS) - (y - below)) / alone / f64::from(SAMPLES);
            below = y;
        }
    }
    let expected = |index: usize| {
        let load = (BALLS - index) as f64;
        match law {
            // The reduced mass at the floor is twice that between two balls. The factor of a linear spring is the same.
            ContactLaw::Thesis if index > 0 => 2.0 * load,
            ContactLaw::HertzMindlin if index == 0 => load.powf(2.0 / 3.0) / 2_f64.cbrt(),
            ContactLaw::HertzMindlin => load.powf(2.0 / 3.0),
            _ => load,
        }
    };
    means.iter().enumerate().map(|(index, mean)| (mean - expected(index)).abs()).fold(0.0, f64::max)
}

/// The height of the column is a power of 2, so the resolution changes by a factor of 2 from one to the next. The bound lies between
/// heights of 1/8 and 1/4: 0.44 to 0.46, and 0.88 to 0.92 of the overlap at rest.
#[test]
fn check_compares_the_resolution_with_the_overlap_at_rest() {
    for law in LAWS {
        let fine = column(law, 0.125).0;
        assert_eq!(fine.coarse(), None, "{law}");
        let (coarse, alone) = column(law, 0.25);
        let warning = coarse.coarse().expect("a warning");
        let resolution = f64::from(0.25_f32.next_up() - 0.25);
        assert_eq!((warning.resolution, warning.overlap.map(|overlap| overlap.0)), (resolution, Some(law)));
        assert_close(warning.overlap.expect("an overlap").1, alone, 1e-6, "overlap at rest");
        // The overlap is 0.03 µm of about 1 mm, so the criterion of the radius does not matter.
        assert!(warning.resolution < 1e-4 * warning.radius);
        let text = warning.describe(&coarse);
        assert!(text.ends_with("or set precision double"), "{text}");
        assert!(text.contains("move the scene nearer to the origin"), "{text}");
        let with = |change: &dyn Fn(&mut Scene)| {
            let mut scene = column(law, 0.25).0;
            change(&mut scene);
            scene.coarse()
        };
        // Nothing presses the balls without gravity. Double precision resolves their overlaps.
        assert_eq!(with(&|scene| scene.settings.gravity = 0.0), None);
        assert_eq!(with(&|scene| scene.settings.precision = Precision::Double), None);
        assert_eq!(with(&|scene| scene.settings.precision = Precision::Auto), None);
    }
}

#[test]
fn overlaps_at_rest_are_wrong_where_check_warns() {
    for law in LAWS {
        let [fine, coarse, worse] = [0.125, 0.25, 8.0].map(|height| worst_error(law, height));
        println!("{law}: {fine} {coarse} {worse}");
        // Just below the bound, just above it, and 56 times above it.
        assert!(fine < 0.28 && coarse > fine && worse > 5.0, "{law}: {fine} {coarse} {worse}");
    }
}
