//! Networks of rods: collisions of large ones, forces along rods, and collisions elsewhere.

use rockfall::{Backend, Integrator, SphereState};

use super::ELASTIC;
use super::scenes::{after, angular, kinetic, open, opened, scene, within};

const INTEGRATORS: [Integrator; 3] = [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet];
/// A floor at y = 0.
const FLOOR: &str = "B -60 -5 -60 120 0 0 0 5 0 0 0 120\n";

/// A straight chain of 150 rods, one degree from upright, meets a box at 2. Its energy is 302, and the rods pass the impulse on to
/// all of its balls. With 64 iterations, which reach only 64 rods, it got an energy of 254,420 within 50 steps.
fn an_upright_chain_gains_no_energy(backend: Backend) {
    let (sin, cos) = 1.0_f64.to_radians().sin_cos();
    let place = |k: i32| (0.2 * f64::from(k) * sin, 0.35 + 0.2 * f64::from(k) * cos);
    let balls: String = (0..=150).map(|k| format!("S {k} {} {} 0 0 -2 0 0 0 0 1 0.05 0\n", place(k).0, place(k).1)).collect();
    let rods: String = (0..150).map(|k| format!("R {k} {} 0.03 0.2\n", k + 1)).collect();
    for integrator in INTEGRATORS {
        let mut simulation = opened(scene(&format!("set gravity 0\n{balls}{rods}{FLOOR}")), backend, integrator);
        simulation.run(8, 0.02).expect("steps");
        within(kinetic(&simulation.spheres().expect("spheres")), 302.0, 1e-4, "energy before the collision");
        let energy = kinetic(&after(&mut simulation, 42, 0.02));
        assert!(simulation.report().total_collisions > 0, "{integrator}: the chain must hit the box");
        assert!((100.0..=302.0).contains(&energy), "{integrator}: energy {energy}");
    }
}

/// A flat net of balls and level rods lands flat on a box, e = 1. The rods pass nothing on along the normals, so every ball
/// turns back at once. When the number of contacts bounded the step of the sweeps, a chain of nine balls kept 0.40 of its energy,
/// and a net of 5 x 5 balls 0.0015.
fn a_flat_net_keeps_its_energy(backend: Backend) {
    for (rows, columns) in [(1, 9), (5, 5)] {
        let name = |row: i32, column: i32| columns * row + column;
        let all = || (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let ball = |(row, column)| {
            format!("S {} {} 0.1 {} 0 -2 0 0 0 0 1 0.05 0\n", name(row, column), 0.3 * f64::from(column), 0.3 * f64::from(row))
        };
        let rod = |one, other| format!("R {one} {other} 0.02 0.3\n");
        let across =
            all().filter(|(_, column)| column + 1 < columns).map(|(row, column)| rod(name(row, column), name(row, column + 1)));
        let along = all().filter(|(row, _)| row + 1 < rows).map(|(row, column)| rod(name(row, column), name(row + 1, column)));
        let text: String = all().map(ball).chain(across).chain(along).collect();
        let mut simulation = open(&format!("{ELASTIC}{text}{FLOOR}"), backend);
        let spheres = after(&mut simulation, 10, 0.02);
        within(kinetic(&spheres), 2.0 * f64::from(rows * columns), 1e-4, "energy");
        assert!(spheres.iter().all(|sphere| sphere.velocity.y > 1.99), "every ball must turn back");
    }
}

/// Two balls on a rod, and a spring between them that pulls with 50. The pair spins at 1 rad/s. Only internal forces act, so L
/// keeps its 0.5. RK4 loses (A dt^2 / l)^2 / 6 of it in a step, with A = 100: 1.33 % per second at dt = 0.02, where `concerns` warns,
/// and less than 0.1 % per second at the time step that it suggests.
fn the_force_along_a_prestressed_rod_is_bounded(backend: Backend) {
    let text = "set gravity 0\nS 1 -0.5 0 0 0 -0.5 0 0 0 0 1 0.1 0\nS 2 0.5 0 0 0 0.5 0 0 0 0 1 0.1 0\n\
                R 1 2 0.05 1\nK 1 2 200 0.75 0\n";
    let lost_in_a_second = |integrator, dt: f32| {
        let spheres = after(&mut opened(scene(text), backend, integrator), (1.0 / dt) as u64, dt);
        1.0 - angular(&spheres).z / 0.5
    };
    let concerns = |integrator, dt| scene(text).concerns(dt, integrator).join("\n");
    within(lost_in_a_second(Integrator::Rk4, 0.02), 0.0133, 0.1, "loss in a second");
    let said = concerns(Integrator::Rk4, 0.02);
    assert!(said.contains("loses 1.33 % of its angular momentum") && said.contains("0.00843 s"), "{said}");
    assert!(lost_in_a_second(Integrator::Rk4, 0.0084) < 0.001);
    assert_eq!(concerns(Integrator::Rk4, 0.0084), "");
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        assert!(lost_in_a_second(integrator, 0.02).abs() < 1e-5, "{integrator}");
        assert_eq!(concerns(integrator, 0.02), "");
    }
}

/// A tetrahedron and a capsule spin freely. Collisions elsewhere do not change one bit of them. When the lengths of all rods
/// were restored after a collision anywhere, the tetrahedron gained 0.5 % of its energy in 20 s.
fn collisions_elsewhere_do_not_change_rods(backend: Backend) {
    let free = "S 0 0.25 0.25 0.25 0.05 -0.175 0.125 0 0 0 1 0.05 0\nS 1 0.25 -0.25 -0.25 -0.05 0.325 -0.375 0 0 0 1 0.05 0\n\
                S 2 -0.25 0.25 -0.25 -0.2 0.175 0.375 0 0 0 1 0.05 0\nS 3 -0.25 -0.25 0.25 0.2 -0.325 -0.125 0 0 0 1 0.05 0\n\
                R 0 1 0.02 0.70710678\nR 0 2 0.02 0.70710678\nR 1 2 0.02 0.70710678\nR 0 3 0.02 0.70710678\n\
                R 1 3 0.02 0.70710678\nR 2 3 0.02 0.70710678\n\
                S 4 5 0 0 1 0.3 0 0.1 0 0 1 0.1 0\nS 5 5.5 0.2 0.3 1 -0.7 1 0 0 0 2 0.1 0\nR 4 5 0.1 0.6164414\n";
    // A ball that flies to and fro between two boxes.
    let ball = "S 6 60 0 0 5 0 0 0 0 0 1 0.3 0\nB 61 -1 -1 1 0 0 0 2 0 0 0 2\nB 58 -1 -1 1 0 0 0 2 0 0 0 2\n";
    for integrator in INTEGRATORS {
        let state = |text: &str| {
            let mut simulation = opened(scene(text), backend, integrator);
            let spheres = after(&mut simulation, 200, 0.02);
            (spheres, simulation.report().total_collisions)
        };
        let (alone, none) = state(&format!("{ELASTIC}{free}"));
        let (together, some) = state(&format!("{ELASTIC}{free}{ball}"));
        assert!(none == 0 && some > 5, "{integrator}: {none} and {some} collisions");
        let bits = |sphere: &SphereState| {
            [sphere.position, sphere.velocity, sphere.angular_momentum].map(|vector| vector.to_array().map(f32::to_bits))
        };
        assert!(alone.iter().map(bits).eq(together[..6].iter().map(bits)), "{integrator}: the rods have changed");
    }
}

both! {
    a_flat_net_keeps_its_energy,
    an_upright_chain_gains_no_energy,
    collisions_elsewhere_do_not_change_rods,
    the_force_along_a_prestressed_rod_is_bounded,
}
