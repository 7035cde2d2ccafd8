//! Motion under laws: closed forms, and the backends compared.

use rockfall::glam::Vec3Swizzles;
use rockfall::model::world::World;
use rockfall::{BroadPhase, Material, Pair};

use super::*;

both!(
    drag_slows_exponentially,
    drag_on_both_spheres_slows_a_dimer_and_its_turn,
    charge_in_a_magnetic_field_circles,
    sphere_in_a_trap_swings,
    torque_turns_a_sphere,
    force_follows_the_time_of_the_simulation,
    changed_parameter_acts_from_the_next_step,
    added_and_removed_laws_act_from_the_next_step,
    runs_are_repeatable,
);

fn run<const N: usize>(simulations: [&mut Simulation; N], steps: u64) {
    for simulation in simulations {
        simulation.run(steps, DT).expect("steps");
    }
}

fn free_ball(velocity: [f32; 3], radius: f32) -> Scene {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([1.0, 0.0, 0.0], radius).velocity(velocity).mass(2.0)]);
    scene
}

/// The same law on both backends, or from its WGSL on the CPU.
fn laws(backend: Backend, law: &ForceLaw) -> Vec<ForceLaw> {
    on(backend, vec![law.clone(), without_function(law)], vec![law.clone()])
}

/// v = v0 exp(-c t / m).
fn drag_slows_exponentially(backend: Backend) {
    for law in laws(backend, &drag()) {
        let mut simulation = with_laws(free_ball([3.0, -1.0, 2.0], 0.5), backend, [law]);
        simulation.run(64, DT).expect("steps");
        let left = (-0.75_f64 / 2.0).exp();
        near(simulation.spheres().expect("the state")[0].velocity, [3.0, -1.0, 2.0].map(|v| v * left), 3e-6, "velocity");
    }
}

/// The drag c of each of two spheres at the distance b from the centre: V decays with 2 c / M, the angular momentum with 2 c b² / J.
fn drag_on_both_spheres_slows_a_dimer_and_its_turn(backend: Backend) {
    for law in laws(backend, &drag()) {
        let mut scene = weightless();
        scene.settings.set("contact_law", "linear").expect("a law");
        let stuff = scene.add_material(Material::new("stuff")).expect("a material");
        scene.set_pair(stuff, stuff, Pair::default().stiffness(1e3)).expect("a pair");
        let dimer = Shape::new().material(stuff).sphere([-1.0, 0.0, 0.0], 0.5).sphere([1.0, 0.0, 0.0], 0.5).mass(2.0);
        let dimer = scene.add_shape(dimer).expect("a shape");
        let placement = Placement::new(dimer).velocity([1.0, 2.0, -3.0]).spin([0.0, 0.0, 0.5]);
        let body = scene.add_body(placement).expect("a body");
        let mut simulation = with_laws(scene, backend, [law]);
        // A law with history has no RK4.
        simulation.run(1024, DT / 16.0).expect("steps");
        let (left, inertia) = ((-0.75_f64).exp(), 2.0_f64 * (1.0 + 0.4 * 0.25));
        let body = simulation.sync().expect("the state").body(body).expect("the body");
        near(body.velocity, [1.0_f64, 2.0, -3.0].map(|v| v * left), 1e-3, "velocity");
        near(body.angular_momentum, [0.0, 0.0, 0.5 * inertia * (-2.0_f64 * 0.75 / inertia).exp()], 1e-3, "angular momentum");
    }
}

/// A charge q r³ of mass m circles with the angular velocity -q r³ B / m about z, and keeps its speed.
fn charge_in_a_magnetic_field_circles(backend: Backend) {
    for law in laws(backend, &magnet()) {
        let mut simulation = with_laws(free_ball([1.0, 0.0, 0.5], 0.5), backend, [law]);
        simulation.run(64, DT).expect("steps");
        let angle = -8.0 * 0.125 * 2.0 / 2.0 * 1.0_f64;
        near(simulation.spheres().expect("the state")[0].velocity, [angle.cos(), angle.sin(), 0.5], 5e-6, "velocity");
    }
}

/// x = x0 + d cos(sqrt(k/m) t), with the trap at (0.25, 0.5, 0).
fn sphere_in_a_trap_swings(backend: Backend) {
    for law in laws(backend, &trap()) {
        let mut simulation = with_laws(free_ball([0.0; 3], 0.5), backend, [law]);
        simulation.run(64, DT).expect("steps");
        let swing = (1.5_f64).sqrt().cos();
        let expected = [0.25 + 0.75 * swing, 0.5 - 0.5 * swing, 0.0];
        near(simulation.spheres().expect("the state")[0].position, expected, 3e-6, "position");
    }
}

/// L' = -0.1 w = -0.1 L / I, with I = 2/5 m r².
fn torque_turns_a_sphere(backend: Backend) {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([0.25, 0.5, 0.0], 0.5).mass(2.0).angular_momentum([0.5, 0.25, -1.0])]);
    let mut simulation = with_laws(scene, backend, [trap()]);
    simulation.run(64, DT).expect("steps");
    let left = (-0.1_f64 / 0.2).exp();
    let state = simulation.spheres().expect("the state")[0];
    near(state.angular_momentum, [0.5, 0.25, -1.0].map(|l| l * left), 2e-6, "angular momentum");
}

/// m v' = cos(w t) gives v = sin(w t) / (m w), however the steps are divided among calls and time steps.
fn force_follows_the_time_of_the_simulation(backend: Backend) {
    let wave = ForceLaw::new("wave").parameter("w", 4.0).wgsl("force.y = cos(w * time);");
    for law in laws(backend, &wave) {
        let mut simulation = with_laws(free_ball([0.0; 3], 0.5), backend, [law]);
        simulation.run(32, DT).expect("steps");
        simulation.run(7, DT).expect("steps");
        simulation.run(50, 0.5 * DT).expect("steps");
        let time = f64::from(DT) * (32.0 + 7.0 + 25.0);
        near(simulation.spheres().expect("the state")[0].velocity, [0.0, (4.0 * time).sin() / 8.0, 0.0], 2e-6, "velocity");
    }
}

fn changed_parameter_acts_from_the_next_step(backend: Backend) {
    let push = ForceLaw::new("push").parameter("f", 2.0).wgsl("force.x = f;");
    let mut simulation = with_laws(free_ball([0.0; 3], 0.5), backend, [push]);
    simulation.run(4, DT).expect("steps");
    simulation.set_force_law_parameter("push", "f", -6.0).expect("a parameter");
    assert_eq!(simulation.force_laws()[0].parameters(), [("f".to_owned(), -6.0)]);
    simulation.step(DT).expect("a step");
    let expected = f64::from(DT) * (4.0 * 1.0 - 3.0);
    near(simulation.spheres().expect("the state")[0].velocity, [expected, 0.0, 0.0], 1e-7, "velocity");
}

fn added_and_removed_laws_act_from_the_next_step(backend: Backend) {
    let mut simulation = with_laws(free_ball([0.0; 3], 0.5), backend, []);
    simulation.step(DT).expect("a step");
    let push = |name: &str, f: f32| ForceLaw::new(name).parameter("f", f).wgsl("force.x = f;");
    simulation.add_force_law(push("right", 6.0)).expect("a law");
    simulation.step(DT).expect("a step");
    simulation.add_force_law(push("left", -2.0)).expect("a law");
    simulation.step(DT).expect("a step");
    simulation.remove_force_law("right").expect("a law");
    simulation.step(DT).expect("a step");
    let expected = f64::from(DT) * (3.0 + 2.0 - 1.0);
    near(simulation.spheres().expect("the state")[0].velocity, [expected, 0.0, 0.0], 1e-7, "velocity");
    let error = simulation.remove_force_law("right").expect_err("it was removed");
    assert_eq!(error.to_string(), "law 'right': there is no force law of this name, there are left");
}

/// Two runs, and a run in pieces, give the same bits.
fn runs_are_repeatable(backend: Backend) {
    let run = |pieces: &[u64]| {
        let mut simulation = with_laws(crowd(), backend, [drag(), without_function(&trap()), magnet()]);
        for steps in pieces {
            run([&mut simulation], *steps);
        }
        simulation.spheres().expect("the state")
    };
    let whole = run(&[12]);
    assert_eq!(whole, run(&[12]));
    assert_eq!(whole, run(&[5, 1, 6]));
}

/// All laws together on spheres of all sizes, rods, capsules and springs. One sphere is so large that it gets a workgroup.
#[cfg(feature = "gpu")]
#[test]
fn backends_agree_in_a_crowd() {
    assert_eq!(World::build_in_space(&crowd()).expect("a world").step.layout.large, 1);
    for integrator in Integrator::ALL {
        let open = |backend: Backend| {
            let options = Options::new().backend(backend).integrator(integrator).broad_phase(BroadPhase::Grid);
            let options = [drag(), trap(), magnet()].into_iter().fold(options, Options::force_law);
            Simulation::with_options(crowd(), options).expect("the simulation opens")
        };
        let (mut cpu, mut gpu) = (open(Backend::Cpu), open(Backend::Gpu));
        run([&mut cpu, &mut gpu], 10);
        assert_agree(&mut cpu, &mut gpu, 2e-5, &integrator.to_string());
    }
}

/// Whole steps in one dispatch.
#[cfg(feature = "gpu")]
#[test]
fn backends_agree_with_joined_steps() {
    let open = |backend: Backend| {
        let mut scene = weightless();
        let ball = |x: f32| Sphere::new([x, 0.0, 0.0], 0.2).velocity([0.0, 1.0, 0.3 * x]).angular_momentum([0.1, 0.2, 0.3]);
        spheres(&mut scene, [-1.0, 0.0, 1.5].map(ball));
        let options = Options::new().backend(backend);
        let options = [drag(), trap(), magnet()].into_iter().fold(options, Options::force_law);
        Simulation::with_options(scene, options).expect("the simulation opens")
    };
    let (mut cpu, mut gpu) = (open(Backend::Cpu), open(Backend::Gpu));
    run([&mut cpu, &mut gpu], 64);
    assert_agree(&mut cpu, &mut gpu, 2e-5, "joined steps");
}

/// The evaluation of WGSL on the CPU against functions of Rust, for what WGSL has.
#[test]
fn wgsl_on_the_cpu_equals_a_function() {
    let wgsl = "
        var sum = vec3f(0.0); // of a series
        var n = 0;
        for (var k = 1; k <= 6; k++) {
            if k % 2 == 0 || (k > 4 && mass > 1.0) { continue; }
            let x = f32(k) * a;
            sum += vec3f(sin(x), cos(x), exp(-x)) / f32(k);
            n += 1;
        }
        while n > 0 { n -= 2; if n == 1 { break; } }
        loop { n += 1; continuing { break if n >= 3; } }
        let far = select(position.zyx, vec3f(1.0), length(position) > 10.0);
        let flags = position < vec3f(0.5);
        force = sum + max(far, vec3f(0.1)) * clamp(f32(n), 0.0, 5.0);
        if any(flags) && !all(flags) { force.y += pow(abs(velocity.x), 1.5); } else { force.z = -1.0; }
        torque = normalize(cross(position, velocity)) * smoothstep(0.0, 4.0, dot(velocity, velocity));
        torque.x = mix(torque.x, floor(7.3), fract(2.25)) + sign(velocity.y) + select(0.0, 1.0, radius >= 0.3) + atan2(position.x, 2.0);";
    let function = |body: &ForceInput<'_>| {
        let ForceInput { position, velocity, radius, .. } = *body;
        let term = |k: f32| Vec3::new((k * 0.7).sin(), (k * 0.7).cos(), (-k * 0.7).exp()) / k;
        let mut force = term(1.0) + term(3.0) + position.zyx().max(Vec3::splat(0.1)) * 3.0;
        if position.cmplt(Vec3::splat(0.5)).any() && !position.cmplt(Vec3::splat(0.5)).all() {
            force.y += velocity.x.abs().powf(1.5);
        } else {
            force.z = -1.0;
        }
        let t = (velocity.length_squared() / 4.0).clamp(0.0, 1.0);
        let mut torque = position.cross(velocity).normalize() * (t * t * (3.0 - 2.0 * t));
        torque.x =
            torque.x * 0.75 + 7.0 * 0.25 + velocity.y.signum() + f32::from(u8::from(radius >= 0.3)) + (position.x / 2.0).atan();
        ForceLoad { force, torque }
    };
    let law = || ForceLaw::new("series").parameter("a", 0.7);
    let mut scene = weightless();
    spheres(
        &mut scene,
        [[1.0, 0.2, 0.9], [2.0, 0.7, 0.6], [0.1, 0.2, 0.3]]
            .map(|at| Sphere::new(at, 0.4).mass(2.0).velocity([1.0, 0.3, at[2]])),
    );
    let mut functions = with_laws(scene.clone(), Backend::Cpu, [law().function(function)]);
    let mut texts = with_laws(scene.clone(), Backend::Cpu, [law().wgsl(wgsl)]);
    run([&mut functions, &mut texts], 8);
    assert_agree(&mut functions, &mut texts, 2e-6, "function and WGSL");
    #[cfg(feature = "gpu")]
    {
        let mut gpu = with_laws(scene, Backend::Gpu, [law().wgsl(wgsl)]);
        gpu.run(8, DT).expect("steps");
        assert_agree(&mut gpu, &mut texts, 5e-6, "the GPU and WGSL on the CPU");
    }
}
