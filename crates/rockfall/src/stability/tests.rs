use super::*;
use crate::{ContactLaw, Muscle, Precision, Spring, Tether};

#[test]
fn a_muscle_needs_ten_steps_in_a_period() {
    let mut scene = Scene::new();
    let ends = [0.0, 1.0].map(|x| scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.1)).unwrap());
    let spring = Spring::new(ends[0], ends[1], 1.0, 1.0);
    scene.add_spring(spring.muscle(Muscle::new(0.0, 100.0, 0.0))).unwrap();
    scene.add_spring(spring.muscle(Muscle::new(0.1, 4.0, 0.0))).unwrap();
    scene.add_spring(spring.muscle(Muscle::new(0.1, 5.0, 0.0))).unwrap();
    assert_eq!(scene.fast_muscle(0.0199), None);
    let fast = scene.fast_muscle(0.04).unwrap();
    assert_eq!((fast.spring, fast.frequency, fast.largest_dt), (2, 5.0, 0.02));
    assert!((fast.steps - 5.0).abs() < 1e-6);
    assert!(
        scene
            .concerns(0.04, Integrator::Rk4)
            .iter()
            .any(|concern| concern.contains("the muscle of the spring from sphere number 0 to sphere number 1"))
    );
    assert!(f64::from(scene.suggestion(0.04, Integrator::Rk4).unwrap().time_step) <= 0.02);
}

#[test]
fn all_springs_of_a_sphere_are_summed_and_fixed_spheres_do_not_count() {
    let mut scene = Scene::new();
    let fixed = scene.add_sphere(Sphere::new([0.0; 3], 0.1).fixed()).unwrap();
    let ball = scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).mass(0.5)).unwrap();
    scene.add_spring(Spring::new(fixed, ball, 4000.0, 1.0)).unwrap();
    scene.add_tether(Tether::new(ball, [2.0, 0.0, 0.0], 1000.0).damping(1.0)).unwrap();
    // K = (4000 + 1000) / 0.5: the edge is sqrt(8 / 10000) = 0.0283.
    assert!(scene.stability(0.028, Integrator::Rk4).is_empty());
    let warnings = scene.stability(0.029, Integrator::Rk4);
    let whats: Vec<Stiff> = warnings.iter().map(|warning| warning.what).collect();
    assert_eq!(whats, [Stiff::Spring(0), Stiff::Tether(0)]);
    assert_eq!((warnings[0].stiffness, warnings[0].damping), (10000.0, 2.0));
    assert!((warnings[0].largest_dt - 0.0008_f64.sqrt()).abs() < 1e-9);
}

#[test]
fn the_contact_force_has_its_own_bound() {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
    scene.settings.contact_force = 30000.0;
    assert!(scene.stability(0.02, Integrator::Rk4).is_empty(), "nothing to touch");
    scene.add_sphere(Sphere::new([1.0; 3], 0.1)).unwrap();
    let warnings = scene.stability(0.02, Integrator::Rk4);
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].what, Stiff::Contact);
    let text = warnings[0].describe(&scene);
    assert!(text.contains("the largest time step that works is 0.0163 s"), "{text}");
    scene.settings.contact_force = 19000.0;
    assert!(scene.stability(0.02, Integrator::Rk4).is_empty());
    assert_eq!(scene.stability(0.02, Integrator::SymplecticEuler).len(), 1);
    scene.settings.contact_damping = 140.0;
    assert_eq!(scene.stability(0.02, Integrator::Rk4).len(), 1);
}

#[test]
fn printed_numbers_are_never_rounded_up() {
    let rounded = [0.02, 0.0282843, 0.01999, 1.0, 12345.0, 0.0].map(rounded_down);
    assert_eq!(rounded, [0.02, 0.0282, 0.0199, 1.0, 12300.0, 0.0]);
}

fn balls<const N: usize>(balls: [Sphere; N]) -> Scene {
    let mut scene = Scene::new();
    for ball in balls {
        scene.add_sphere(ball).unwrap();
    }
    scene
}

#[test]
fn a_crowd_counts_bodies_that_can_touch_in_one_group() {
    let ball = |x: f32| Sphere::new([x, 0.0, 0.0], 0.1);
    assert_eq!(balls([ball(0.0)]).crowd(), Crowd::None);
    assert_eq!(balls([ball(0.0), ball(1.0)]).crowd(), Crowd::Pair);
    assert_eq!(balls([ball(0.0), ball(1.0), ball(2.0).fixed()]).crowd(), Crowd::Few);
    assert_eq!(balls([ball(0.0), ball(1.0), ball(2.0)]).crowd(), Crowd::Many);
    assert_eq!(balls([ball(0.0), ball(1.0), ball(2.0).group(1)]).crowd(), Crowd::Pair);
    assert_eq!(balls([ball(0.0).fixed(), ball(1.0).fixed(), ball(2.0).fixed()]).crowd(), Crowd::None);
}

#[test]
fn spheres_that_rods_of_fixed_length_join_touch_nothing() {
    let mut scene = balls([Sphere::new([0.0; 3], 0.1).fixed(), Sphere::new([1.0, 0.0, 0.0], 0.1)]);
    let ids: Vec<crate::SphereId> = scene.sphere_ids().collect();
    let rod = scene.add_rod(crate::Rod::new(ids[0], ids[1], 0.01)).unwrap();
    assert_ne!(scene.crowd(), Crowd::None);
    scene.update_rod(rod, |rod| rod.length = Some(1.0)).unwrap();
    assert_eq!(scene.crowd(), Crowd::None);
    scene.settings.gravity = 10.0;
    assert_eq!(scene.sinking(Integrator::Rk4), None);
    scene.add_sphere(Sphere::new([2.0, 0.0, 0.0], 0.1)).unwrap();
    assert_ne!(scene.crowd(), Crowd::None);
    assert!(scene.sinking(Integrator::Rk4).is_some());
}

#[test]
fn a_rod_that_jumps_or_holds_nothing_is_odd() {
    let mut scene = balls([Sphere::new([0.0; 3], 0.1).fixed(), Sphere::new([1.0, 0.0, 0.0], 0.1)]);
    let ids: Vec<crate::SphereId> = scene.sphere_ids().collect();
    let rod = scene.add_rod(crate::Rod::new(ids[0], ids[1], 0.01)).unwrap();
    let free = scene.odd_rods();
    assert_eq!((free.len(), free[0].rod, free[0].length, free[0].distance), (1, rod, None, 1.0));
    assert!(free[0].describe(&scene).starts_with("the rod from sphere number 0 to sphere number 1 has no length"));
    for (length, odd) in [(1.0, 0), (1.009, 0), (1.02, 1), (0.98, 1)] {
        scene.update_rod(rod, |rod| rod.length = Some(length)).unwrap();
        assert_eq!(scene.odd_rods().len(), odd, "{length}");
    }
    // Neither end of a rod between loose spheres needs to be held.
    let mut loose = balls([Sphere::new([0.0; 3], 0.1), Sphere::new([9.0, 0.0, 0.0], 0.1)]);
    let ids: Vec<crate::SphereId> = loose.sphere_ids().collect();
    loose.add_rod(crate::Rod::new(ids[0], ids[1], 0.01)).unwrap();
    assert_eq!(loose.odd_rods(), []);
}

#[test]
fn a_crowd_is_restless_before_it_is_unstable() {
    let mut scene = balls([0.0, 1.0, 2.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)));
    let effect = |scene: &Scene, dt| scene.stability(dt, Integrator::Rk4).first().map(|warning| warning.effect);
    // The defaults, Cc = 1000 and Cd = 12.5: dt² Cc = 0.5 at 0.02236.
    assert_eq!(effect(&scene, 0.0223), None);
    assert_eq!(effect(&scene, 0.0225), Some(Effect::Restless));
    assert_eq!(effect(&scene, 0.064), Some(Effect::Unstable));
    let text = scene.stability(0.03, Integrator::Rk4)[0].describe(&scene);
    assert!(text.contains("do not come to rest") && text.ends_with("the largest time step that works is 0.0223 s"), "{text}");
    // Elastic spheres without damping never come to rest.
    (scene.settings.restitution, scene.settings.contact_damping) = (1.0, 0.0);
    assert_eq!(effect(&scene, 0.04), None);
    assert_eq!(effect(&scene, 0.045), Some(Effect::Unstable));
}

#[test]
fn substeps_are_as_few_as_possible() {
    let mut scene = balls([0.0, 1.0, 2.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.1)));
    for (force, dt) in [(1000.0, 0.02), (1000.0, 0.0224), (5000.0, 0.02), (1e6, 0.3), (0.5, 2.0)] {
        scene.settings.contact_force = force;
        for integrator in Integrator::ALL {
            let parts = scene.substeps_for(dt, integrator);
            let warnings = |parts: u32| scene.stability(dt / parts as f32, integrator).len();
            assert_eq!(warnings(parts), 0, "{force} {dt} {integrator}: {parts}");
            assert!(parts == 1 || warnings(parts - 1) > 0, "{force} {dt} {integrator}: {parts}");
        }
    }
}

#[test]
fn a_small_ball_sinks() {
    let mut scene = balls([0.0, 1.0, 2.0].map(|x| Sphere::new([x, 0.0, 0.0], 0.005)));
    scene.settings.gravity = -9.81;
    let sinking = scene.sinking(Integrator::Rk4).unwrap();
    assert!((sinking.overlap - 0.00981).abs() < 1e-8);
    let text = sinking.to_string();
    assert!(text.contains("196 % of the smallest radius") && text.contains("`set resting_overlap 0.02`"), "{text}");
    // 9.81 / (0.05 * 0.005) = 39240, rounded up; 12.5 sqrt(39.3) = 78.36; sqrt(0.5 / 39300) = 0.003567.
    assert!(
        text.ends_with("a contact_force of 39300 or more, with a contact_damping of 78.3 and a time step of at most 0.00356 s"),
        "{text}"
    );
    scene.settings.contact_force = sinking.contact_force as f32;
    assert_eq!(scene.sinking(Integrator::Rk4), None);
    scene.settings.contact_force = 1000.0;
    scene.settings.resting_overlap = 0.02;
    assert_eq!(scene.sinking(Integrator::Rk4), None);
}

#[test]
fn a_resting_overlap_chooses_the_contact_force_of_a_column() {
    let mut scene = balls([0.1, 0.3, 0.5, 0.7].map(|y| Sphere::new([0.0, y, 0.0], 0.1).mass(3.0)));
    // Otherwise these are chosen, too.
    (scene.settings.contact_law, scene.settings.precision) = (ContactLaw::Thesis, Precision::Single);
    assert_eq!(scene.resolved_settings(), scene.settings);
    scene.settings.gravity = 9.0;
    scene.settings.resting_overlap = 0.05;
    let settings = scene.resolved_settings();
    // The lowest carries four bodies: 3 * 2 * 4 * 9 / (0.05 * 0.1).
    assert!((settings.contact_force / 43200.0 - 1.0).abs() < 1e-5, "{}", settings.contact_force);
    let ratio = |settings: &Settings| settings.contact_damping / settings.contact_force.sqrt();
    assert!((ratio(&settings) / ratio(&scene.settings) - 1.0).abs() < 1e-5);
    // Side by side, each body carries only itself.
    let mut flat = balls([0.0, 0.2, 0.4, 0.6].map(|x| Sphere::new([x, 0.0, 0.0], 0.1).mass(3.0)));
    flat.settings = scene.settings;
    assert!((flat.resolved_settings().contact_force / 10800.0 - 1.0).abs() < 1e-5);
    // Resolving the settings again changes nothing.
    scene.settings = settings;
    assert_eq!(scene.resolved_settings().contact_force, settings.contact_force);
    scene.settings.gravity = 0.0;
    assert_eq!(scene.resolved_settings(), scene.settings);
}

#[test]
fn the_speed_is_that_of_a_fall_through_the_scene() {
    let mut scene = balls([Sphere::new([0.0, 5.1, 0.0], 0.1).velocity([3.0, 0.0, 0.0])]);
    assert_eq!(scene.tunnelling(1.0), None, "nothing to pass through");
    scene.add_box(crate::Cuboid::between([-1.0, -0.2, -1.0], [1.0, 0.0, 1.0])).unwrap();
    scene.settings.gravity = 10.0;
    let tunnelling = scene.tunnelling(0.05).unwrap();
    // Down by 5: sqrt(9 + 100) = 10.44; the ball's radius and half the box: 0.2.
    assert_eq!(tunnelling.what, Thin::Box(0));
    assert!((tunnelling.speed - 109_f64.sqrt()).abs() < 1e-6 && (tunnelling.depth - 0.2).abs() < 1e-7);
    assert!(tunnelling.to_string().ends_with("the largest time step that works is 0.0191 s"), "{tunnelling}");
    assert_eq!(scene.tunnelling(0.0191), None);
    scene.add_polygon(crate::Polygon::new([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0])).unwrap();
    assert_eq!(scene.tunnelling(0.0191).map(|tunnelling| tunnelling.what), Some(Thin::Polygon));
}

#[test]
fn a_negative_gravity_is_a_concern() {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
    let about_gravity =
        |scene: &Scene| scene.intent().iter().any(|concern| concern.contains("gravity is a magnitude: set gravity 9.81"));
    scene.settings.gravity = 9.81;
    assert!(!about_gravity(&scene));
    scene.settings.gravity = -9.81;
    assert!(about_gravity(&scene), "{:?}", scene.intent());
}
