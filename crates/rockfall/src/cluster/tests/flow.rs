//! Inlets and outlets.

use super::*;
use crate::{Inlet, Outlet, Rate};

/// Grains that rain on a column, and an outlet beside it into which grains roll.
fn rain() -> Scene {
    let mut scene = column(ContactLaw::HertzMindlin, |_| 0.1);
    let sand = scene.boxes()[0].material.unwrap();
    let above = [[0.0, 2.0, 0.0], [1.0, 2.6, 1.0]];
    let inlet = Inlet::new("rain", above, Rate::Number(150.0), 0.08).velocity([0.3, -2.0, 0.1]).material(sand).every(30);
    scene.add_inlet(inlet.during(0.02, 10.0).limit(30)).unwrap();
    scene.add_sphere(Sphere::new([1.1, 0.9, 0.5], 0.1).velocity([3.0, 0.0, 0.0]).material(sand)).unwrap();
    scene.add_outlet(Outlet::new("drain", [[1.15, -1.0, -3.0], [9.0, 2.0, 3.0]]).every(70)).unwrap();
    scene.add_gauge(Gauge::plane("through", [1.0, 0.0, 0.0], [1.0, -0.1, 0.0])).unwrap();
    scene
}

/// What came in, what left, and what the gauge has measured.
fn passed(state: &Checkpoint) -> String {
    let mut simulation = Simulation::resume(state.clone()).unwrap();
    format!("{:?} {:?}", simulation.flow(), simulation.gauges().unwrap())
}

#[test]
fn spheres_come_in_and_leave_with_the_same_bits() {
    for integrator in [Integrator::VelocityVerlet, Integrator::SymplecticEuler] {
        let start = Simulation::with_options(rain(), options(integrator)).unwrap().checkpoint().unwrap();
        let (expected, middle) = (alone(&start, 600, 0.0005), shared(&start, 2, 285, 0.0005).remove(1).0);
        assert_eq!(passed(&middle), passed(&alone(&start, 285, 0.0005)));
        for size in [1, 3, 4] {
            // Between two times at which something comes in.
            let end = shared(&middle, size, 315, 0.0005).remove(0).0;
            assert_same(&end, &expected, &format!("{size} processes"));
            assert_eq!(passed(&end), passed(&expected));
        }
        let flow = Simulation::resume(expected).unwrap().flow();
        assert!(flow.inlets[0].spheres > 20 && flow.outlets[0].spheres > 0, "{flow:?}");
    }
}

/// The same on a GPU.
#[cfg(feature = "gpu")]
#[test]
fn spheres_come_in_and_leave_with_the_same_bits_on_a_gpu() {
    let _shared = crate::exec::gpu::SharedDevice::new();
    let (state, _) = check_on(Backend::Gpu, &[2], rain(), Integrator::VelocityVerlet, 150, 0.0005);
    let flow = Simulation::resume(state).unwrap().flow();
    assert!(flow.inlets[0].spheres > 4 && flow.outlets[0].spheres > 0, "{flow:?}");
}
