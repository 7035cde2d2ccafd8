//! Periodic and sheared boxes.

use super::*;
use crate::Shear;

/// A scene that is periodic along some axes, from 0 to these lengths.
fn periodic(mut scene: Scene, lengths: [Option<f32>; 3]) -> Scene {
    for (axis, length) in lengths.into_iter().enumerate() {
        scene.set_periodic(axis, length.map(|length| [0.0, length])).unwrap();
    }
    scene
}

/// Numbers of spheres that are outside of the box along at least 1, 2 and 3 axes.
fn outside(state: &Checkpoint) -> [usize; 3] {
    let bounds = state.scene.periodic();
    let is_out = |axis: usize, sphere: &Sphere| {
        bounds[axis].is_some_and(|[from, to]| sphere.position[axis] < from || sphere.position[axis] > to)
    };
    let axes = |sphere: &Sphere| (0..3).filter(|axis| is_out(*axis, sphere)).count();
    [1, 2, 3].map(|least| state.scene.spheres().iter().filter(|sphere| axes(sphere) >= least).count())
}

/// Grains that fly about in a cube without walls, and pass its faces, edges and corners.
fn cube() -> Scene {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.gravity = 0.0;
    let mut numbers = Numbers(5);
    for k in 0..216_u32 {
        let k = (k * 77) % 216;
        let place = [k % 6, k / 6 % 6, k / 36].map(|n| 0.5 * n as f32);
        let velocity = [3.0, 2.5, 3.5].map(|mean| mean + 6.0 * (numbers.next() - 0.5));
        scene.add_sphere(Sphere::new(place, 0.12 + 0.12 * numbers.next()).velocity(velocity)).unwrap();
    }
    periodic(scene, [Some(3.0); 3])
}

#[test]
fn a_gas_passes_faces_and_corners_to_the_same_bits() {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let (state, divisions) = check(cube(), integrator, 250, 0.002);
        assert!(divisions > 5 && state.report.contacts > 10, "{divisions}, {:?}", state.report);
        let outside = outside(&state);
        assert!(outside[0] > 50 && outside[2] > 5, "{outside:?}");
    }
}

/// Grains of sizes 1:`ratio` that stream along a chute without end, over a fixed sphere. Its ends meet in the middle of the grains.
pub(super) fn chute(ratio: f32) -> Scene {
    let (mut scene, sand) = sandbox(ContactLaw::HertzMindlin);
    scene.settings.gravity_direction = [0.9, -0.4, 0.0].into();
    for (low, high) in
        [([0.0, -0.5, -0.5], [4.0, 0.0, 1.5]), ([0.0, 0.0, -0.5], [4.0, 2.0, 0.0]), ([0.0, 0.0, 1.0], [4.0, 2.0, 1.5])]
    {
        scene.add_box(Cuboid::between(low, high).material(sand)).unwrap();
    }
    let mut numbers = Numbers(11);
    for k in 0..200_u32 {
        let k = (k * 77) % 200;
        let [x, y, z] = [k % 20, k / 100, k / 20 % 5].map(|n| n as f32);
        let radius = if k % 9 == 0 { 0.1 } else { 0.1 / ratio * (1.0 + (ratio - 1.0) * numbers.next()) };
        let place = [0.2 * x - 2.0, 0.1 + 0.2 * y, 0.1 + 0.2 * z].map(|at| at + 0.01 * (numbers.next() - 0.5));
        let sphere = Sphere::new(place, radius).velocity([8.0, 0.0, 0.5 - numbers.next()]).material(sand);
        scene.add_sphere(sphere).unwrap();
    }
    scene.add_sphere(Sphere::new([3.95, -0.14, 0.5], 0.15).fixed().material(sand)).unwrap();
    periodic(scene, [Some(4.0), None, None])
}

#[test]
fn grains_travel_several_periods_to_the_same_bits() {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let (state, divisions) = check(chute(1.0), integrator, 1200, 0.001);
        assert!(divisions > 10 && state.springs.len() > 50, "{divisions}, {}", state.springs.len());
        let periods = state.scene.spheres().iter().map(|sphere| sphere.position.x / 4.0).fold(0.0, f32::max);
        assert!(periods > 2.0, "{periods}");
    }
}

#[test]
fn sizes_of_one_to_five_meet_across_the_periodic_face_to_the_same_bits() {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let (state, divisions) = check(chute(5.0), integrator, 500, 0.0005);
        assert!(divisions > 2 && state.springs.len() > 30, "{divisions}, {}", state.springs.len());
    }
}

/// A box that is hardly wider than the copies are deep: both sides of a slab meet, and each process has copies of almost all spheres.
#[test]
fn a_process_has_one_copy_of_a_sphere_on_both_sides_of_its_slab() {
    let mut scene = Scene::new();
    scene.settings.collisions = false;
    scene.settings.gravity = 0.0;
    let mut numbers = Numbers(17);
    for k in 0..24_u8 {
        let velocity = [0; 3].map(|_| numbers.next() - 0.5);
        let place = [k % 4, k / 4 % 3, k / 12].map(|n| 0.38 * f32::from(n));
        scene.add_sphere(Sphere::new(place, 0.2).velocity(velocity)).unwrap();
    }
    let (state, _) = check(periodic(scene, [Some(1.5), Some(1.2), Some(0.8)]), Integrator::VelocityVerlet, 400, 0.002);
    assert!(state.report.contacts > 3, "{:?}", state.report);
}

#[test]
fn a_periodic_checkpoint_goes_on_with_another_number_of_processes() {
    let start = Simulation::with_options(chute(2.0), options(Integrator::VelocityVerlet)).unwrap().checkpoint().unwrap();
    let middle = shared(&start, 3, 300, 0.001).remove(1).0;
    for size in [1, 2, 4] {
        let other = shared(&start, size, 300, 0.001).remove(0).0;
        assert!(middle.to_bytes() == other.to_bytes(), "{size} processes");
    }
    let middle = Checkpoint::from_bytes(&middle.to_bytes(), "middle").unwrap();
    let expected = Checkpoint::from_bytes(&alone(&start, 600, 0.001).to_bytes(), "expected").unwrap();
    for size in [1, 2, 4] {
        let end = shared(&middle, size, 300, 0.001).remove(0).0;
        let end = Checkpoint::from_bytes(&end.to_bytes(), "end").unwrap();
        assert_eq!(end.scene.to_text(), expected.scene.to_text(), "{size} processes");
        assert_eq!(spring_bits(&end), spring_bits(&expected), "{size} processes");
    }
}

/// Grains in a box whose images slide along `flow`. Slabs are along the gradient or the third axis.
fn sheared(gradient: usize, flow: usize) -> Scene {
    let mut scene = cube();
    let lengths = [3.6, 3.3, 3.0];
    let speed = 1.5;
    for sphere in scene.spheres.objects_mut() {
        sphere.velocity[flow] += speed * sphere.position[gradient];
    }
    (0..3).for_each(|axis| scene.set_periodic(axis, Some([-0.25, lengths[axis] - 0.25])).unwrap());
    scene.set_shear(Some(Shear::new(gradient, flow, speed).with_turns(0.3))).unwrap();
    scene
}

#[test]
fn a_sheared_box_moves_to_the_same_bits() {
    for (gradient, flow, integrator) in [(1, 0, Integrator::VelocityVerlet), (0, 1, Integrator::SymplecticEuler)] {
        let (state, divisions) = check(sheared(gradient, flow), integrator, 250, 0.002);
        assert!(divisions > 3 && state.report.contacts > 5, "{divisions}, {:?}", state.report);
        let turns = state.scene.shear().unwrap().turns();
        assert!((turns - 0.3).abs() > 0.01, "{turns}");
        assert!(outside(&state)[1] > 10, "{:?}", outside(&state));
    }
}

/// The same on a GPU.
#[cfg(feature = "gpu")]
#[test]
fn processes_on_a_gpu_have_the_same_bits_in_periodic_boxes() {
    let _shared = crate::exec::gpu::SharedDevice::new();
    let (state, divisions) = check_on(Backend::Gpu, &[1, 3], chute(2.0), Integrator::VelocityVerlet, 90, 0.001);
    assert!(divisions > 1 && state.springs.len() > 30, "{divisions}, {}", state.springs.len());
    let (state, divisions) = check_on(Backend::Gpu, &[2], sheared(1, 0), Integrator::SymplecticEuler, 60, 0.002);
    assert!(divisions > 1 && state.report.contacts > 3, "{divisions}, {:?}", state.report);
}
