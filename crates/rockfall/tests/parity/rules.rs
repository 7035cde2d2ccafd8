//! Scenes whose decisions cannot be kept unambiguous: exact values that a rule decides, numbers that stop being finite, and
//! thousands of bodies.

use std::future::Future;

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::exec::gpu::Gpu;
use rockfall::model::layout::{SLICE, WORKGROUP};
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, Capsule, Cuboid, Integrator, Polygon, Rod, Scene, Sphere, SphereId, Spring, wgpu};

use crate::broken::rewritten;
use crate::compare::{BY_RULE, differences, listed};
use crate::device::{GPU, on_gpu, open};
use crate::trace::{enable_sweeps, grouped};

/// Runs steps on the CPU, asserts that the kernel of each stage gives the same, and returns the world after the steps.
fn assert_steps_match(gpu: &Gpu, scene: &Scene, runs: &[Run], steps: u32, margin: f32) -> World {
    assert_steps_match_with_kernels(gpu, scene, runs, steps, margin, &|run| run)
}

/// Like [`assert_steps_match`], but with kernels that `kernel` has changed.
fn assert_steps_match_with_kernels(
    gpu: &Gpu,
    scene: &Scene,
    runs: &[Run],
    steps: u32,
    margin: f32,
    kernel: &dyn Fn(Run) -> Run,
) -> World {
    let mut world = World::build(scene).unwrap();
    world.step.constants.dt = 0.005;
    world.step.lists.margin_scale = margin;
    world.set_pair_rows(world.movers().div_ceil(SLICE) * 100);
    enable_sweeps(&mut world);
    let groups = grouped(runs);
    for (step, group) in (0..steps).flat_map(|step| groups.iter().map(move |group| (step, group))) {
        let kernels: Vec<Run> = group.iter().map(|run| kernel(*run)).collect();
        let after = on_gpu(gpu, &world, &kernels);
        let wrong = differences(group, &world, &after, BY_RULE);
        let (stage, pass) = (group[0].stage.name, group[0].pass);
        assert!(wrong.is_empty(), "step {step}, {stage} pass {pass}: {}", listed(&wrong));
        group.iter().for_each(|run| run.on_cpu(&mut world));
    }
    world
}

fn stages(phases: &[Phase], integrator: Integrator) -> Vec<Run> {
    phases.iter().flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce)).copied().collect()
}

fn at(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

fn add_sphere(scene: &mut Scene, place: Vec3, radius: f32, velocity: Vec3) -> SphereId {
    scene.add_sphere(Sphere::new(place, radius).velocity(velocity)).unwrap()
}

fn add_resting_spheres(scene: &mut Scene, places: &[(f32, f32, f32)]) {
    for (x, y, z) in places {
        add_sphere(scene, at(*x, *y, *z), 0.25, Vec3::ZERO);
    }
}

fn add_rod(scene: &mut Scene, from: Vec3, to: Vec3, length: Option<f32>) {
    let ends = [from, to].map(|end| {
        let ball = Sphere::new(end, 0.1).mass(2.0).velocity(0.1 * end);
        scene.add_sphere(ball).unwrap()
    });
    let rod = Rod::new(ends[0], ends[1], 0.2);
    scene.add_rod(length.map_or(rod, |length| rod.length(length))).unwrap();
}

/// Adds spheres in one point, on the axis of a rod, and exactly beside its end. Adds rods that intersect, that are in line, and
/// that are parallel.
fn add_degenerate_spheres_and_rods(scene: &mut Scene) {
    add_resting_spheres(scene, &[(0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (11.0, 0.0, 0.0), (12.0, 0.3, 0.0)]);
    add_rod(scene, at(10.0, 0.0, 0.0), at(12.0, 0.0, 0.0), None);
    add_rod(scene, at(11.5, 0.0, -1.0), at(11.5, 0.0, 1.0), Some(2.0));
    add_rod(scene, at(10.5, 0.25, 0.0), at(13.0, 0.25, 0.0), Some(2.4));
    add_rod(scene, at(12.0, 0.0, 0.0), at(14.0, 0.0, 0.0), None);
    // Two spheres in one point that approach each other along the normal that the rule for this case selects.
    for speed in [2.0, -2.0] {
        add_sphere(scene, at(5.0, 0.0, 0.0), 0.25, at(0.0, speed, 0.0));
    }
    // A heap of spheres, and a spring whose ends are in one point.
    for k in 0..3_u8 {
        let k = f32::from(k);
        add_sphere(scene, at(60.0, 0.39 * k, 0.0), 0.2, at(0.0, -3.0 * k, 0.0));
    }
    let ends = [0; 2].map(|_| add_sphere(scene, at(70.0, 0.0, 0.0), 0.25, Vec3::ZERO));
    scene.add_spring(Spring::new(ends[0], ends[1], 10.0, 1.0)).unwrap();
}

/// Adds a box with spheres inside, on a face and at an edge, and with rods across an edge, along an edge, inside, and near a
/// vertex. Adds a polygon with spheres in front, exactly on the face, behind, beside the edge, and one that leaves fast.
fn add_static_objects(scene: &mut Scene) {
    scene.add_box(Cuboid::between(at(20.0, 0.0, 0.0), at(22.0, 2.0, 3.0))).unwrap();
    add_resting_spheres(scene, &[(21.0, 1.0, 1.5), (20.1, 0.7, 1.0), (22.0, 1.0, 1.0), (22.1, 2.1, 1.0)]);
    add_rod(scene, at(19.0, 1.0, 1.0), at(21.0, -1.0, 1.0), Some(2.8));
    add_rod(scene, at(20.5, 2.1, 0.0), at(21.5, 2.1, 0.0), None);
    add_rod(scene, at(20.05, 0.05, 1.0), at(20.05, 0.05, 2.0), Some(1.0));
    add_rod(scene, at(21.0, 2.1, 3.1), at(23.0, 2.1, 3.1), None);
    add_rod(scene, at(21.9, 1.9, -1.0), at(21.9, 1.9, 1.0), None);
    let face = Polygon::new(at(30.0, 0.0, 0.0), at(0.0, 0.0, 4.0), at(4.0, 0.0, 1.0));
    scene.add_polygon(face).unwrap();
    for (x, y, speed) in [(31.0, 0.2, -1.0), (32.0, 0.0, 0.0), (33.0, -0.1, 0.0), (29.9, 0.1, 0.0), (32.5, 0.1, 9.0)] {
        add_sphere(scene, at(x, y, 2.0), 0.25, at(0.0, speed, 0.0));
    }
}

/// Adds two capsules that collide end to end, and a chain of rods of fixed length from a fixed sphere, which spheres hit.
fn add_capsules(scene: &mut Scene) {
    for (x, speed) in [(40.0, 3.0), (42.3, -3.0)] {
        let capsule = Capsule::new(at(x, 0.0, 0.0), at(x + 2.0, 0.0, 0.0), 0.2);
        scene.add_capsule(capsule.velocity(at(speed, 0.0, 0.0))).unwrap();
    }
    let held = Sphere::new(at(50.0, 0.0, 0.0), 0.2).fixed().velocity(at(0.0, 1.0, 0.0));
    let held = scene.add_sphere(held).unwrap();
    let [free, far, farther] =
        [(51.0, 0.0), (51.0, 1.0), (52.0, 1.0)].map(|(x, y)| add_sphere(scene, at(x, y, 0.0), 0.2, Vec3::ZERO));
    for (one, two, radius, length) in [(held, free, 0.2, 1.0), (free, far, 0.1, 1.0), (far, farther, 0.1, 1.1)] {
        scene.add_rod(Rod::new(one, two, radius).length(length)).unwrap();
    }
    add_sphere(scene, at(51.3, 0.1, 0.0), 0.2, at(-4.0, 0.0, 0.0));
    add_sphere(scene, at(52.3, 1.1, 0.1), 0.2, at(-4.0, 0.0, 0.0));
}

/// Adds a fixed sphere beside the end of a rod that is fixed too, so that neither side of the contact can move. For one step only:
/// as soon as the rod turns, the contact has a short lever, which enlarges errors by rounding ten thousand times.
fn add_sphere_at_the_hinge(scene: &mut Scene) {
    scene.add_sphere(Sphere::new(at(50.0, 0.3, 0.0), 0.2).fixed()).unwrap();
}

/// Both backends must follow the same rule when a distance is 0, two objects are parallel, a parameter is exactly 0 or 1, or a
/// body is inside another.
#[test]
fn both_backends_follow_the_same_rules_for_exact_values() {
    let mut scene = Scene::new();
    add_degenerate_spheres_and_rods(&mut scene);
    add_static_objects(&mut scene);
    add_capsules(&mut scene);
    let mut at_hinge = scene.clone();
    add_sphere_at_the_hinge(&mut at_hinge);
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let last = assert_steps_match(&GPU, &scene, &stages(&Phase::STEP, integrator), 3, 1e6).status;
        assert!(last.rejected == 0 && last.last_contacts > 20 && last.total_collisions_low > 5, "{last:?}");
        assert_steps_match(&GPU, &at_hinge, &stages(&Phase::STEP, integrator), 1, 1e6);
    }
}

/// Returns a run whose stage has the divisors in `geometry.wgsl` multiplied by a factor.
fn with_scaled_divisors(factor: &str, run: Run) -> Run {
    rewritten(run, "geometry.wgsl", |text| {
        ["nn", "aa", "squared", "face.squared", "squared_edges(box)"].iter().fold(text.to_owned(), |text, divisor| {
            let exact = format!(" / {divisor};");
            assert!(text.contains(&exact), "geometry.wgsl has no division by {divisor}");
            text.replace(&exact, &format!(" / ({factor} * {divisor});"))
        })
    })
}

/// WGSL allows an error of 2.5 units in the last place in a division, and many devices have such errors. They must not change a
/// decision that a rule makes.
#[test]
fn division_errors_do_not_change_decisions_by_rule() {
    let mut scene = Scene::new();
    add_degenerate_spheres_and_rods(&mut scene);
    add_static_objects(&mut scene);
    add_capsules(&mut scene);
    for factor in ["1.00000012", "0.99999994", "1.0000003", "0.9999997"] {
        // A new device, because a device caches kernels by name.
        let gpu = open();
        let stages = stages(&Phase::STEP, Integrator::Rk4);
        let world = assert_steps_match_with_kernels(&gpu, &scene, &stages, 3, 1e6, &|run| with_scaled_divisors(factor, run));
        assert!(world.status.last_contacts > 20, "{:?}", world.status);
    }
}

/// Returns a run whose stage has the divisions and square roots of the corrections of lengths multiplied by a factor.
fn with_scaled_lengths(factor: &str, run: Run) -> Run {
    let scaled = |run: Run, file: &str, places: &[(&str, &str)]| {
        rewritten(run, file, |text| {
            places.iter().fold(text.to_owned(), |text, (exact, inexact)| {
                assert!(text.contains(exact), "{file} has no {exact}");
                text.replace(exact, &inexact.replace("FACTOR", factor))
            })
        })
    };
    let run = scaled(
        run,
        "lengths.wgsl",
        &[
            ("n = d / distance;", "n = d / (FACTOR * distance);"),
            ("distance = sqrt(squared);", "distance = FACTOR * sqrt(squared);"),
            (" / sum)", " / (FACTOR * sum))"),
        ],
    );
    if run.stage.name != "constrain" {
        return run;
    }
    scaled(
        run,
        "constrain.wgsl",
        &[
            ("sqrt(discriminant)", "FACTOR * sqrt(discriminant)"),
            (" / sqrt(squared);", " / (FACTOR * sqrt(squared));"),
            (" / step.dt;", " / (FACTOR * step.dt);"),
            ("length(d)", "(FACTOR * length(d))"),
        ],
    )
}

/// Nor must such errors be enlarged where the lengths of rods are corrected.
#[test]
fn division_errors_are_not_enlarged_by_corrections_of_lengths() {
    let mut scene = Scene::new();
    add_degenerate_spheres_and_rods(&mut scene);
    add_static_objects(&mut scene);
    add_capsules(&mut scene);
    for factor in ["1.00000012", "0.9999997"] {
        let gpu = open();
        for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
            let stages = stages(&Phase::STEP, integrator);
            let kernel = |run| with_scaled_lengths(factor, run);
            assert_steps_match_with_kernels(&gpu, &scene, &stages, 3, 1e6, &kernel);
        }
    }
}

/// Springs of extreme stiffness overflow. Both backends stop and report the same bodies, and the other bodies continue.
#[test]
fn both_backends_report_the_same_non_finite_bodies() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut scene = Scene::new();
        add_degenerate_spheres_and_rods(&mut scene);
        let ids: Vec<_> = scene.sphere_ids().collect();
        for (one, two) in [(0, 9), (1, 12)] {
            scene.add_spring(Spring::new(ids[one], ids[two], 3e38, 0.1)).unwrap();
        }
        let status = assert_steps_match(&GPU, &scene, &stages(&Phase::STEP, integrator), 1, 1e30).status;
        assert!(status.total_bad >= 4 && status.bad_step == 1 && status.rejected != 0, "{status:?}");
    }
}

/// Opens a device with a limit of 13 workgroups per dimension.
fn gpu_with_few_workgroups() -> Gpu {
    let open = async {
        let adapter = rockfall::exec::gpu::instance().request_adapter(&Default::default()).await.unwrap();
        let required_limits = wgpu::Limits { max_compute_workgroups_per_dimension: 13, ..adapter.limits() };
        let wanted = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        adapter.request_device(&wanted).await.unwrap()
    };
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    let std::task::Poll::Ready((device, queue)) = std::pin::pin!(open).poll(&mut context) else {
        panic!("a native device must be ready at once");
    };
    Gpu::on_device(device, queue)
}

/// Scenes with more workgroups than fit in one dimension, more slices than the scan handles in one round, and lists of very
/// different lengths.
#[test]
fn both_backends_agree_on_thousands_of_spheres_in_2d_dispatches() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let mut scene = Scene::new();
    add_static_objects(&mut scene);
    for k in 0..9000 {
        let mut below = |most: f32| rng.random_range(0.0..most);
        // The density increases towards one side.
        let place = at(20.0 * below(1.0).powi(2), below(20.0), below(20.0));
        let ball = Sphere::new(place, 0.4).velocity(at(below(2.0), below(2.0), below(2.0)));
        scene.add_sphere(if k % 50 == 0 { ball.fixed() } else { ball }).unwrap();
    }
    let gpu = gpu_with_few_workgroups();
    let collide = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::HandleCollisions];
    // The two phases are tested separately. Where collisions remove overlaps as deep as these, bodies leave their AABBs.
    let integrate = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];
    for phases in [collide, integrate] {
        let runs = stages(&phases, Integrator::SymplecticEuler);
        let World { step, status, .. } = assert_steps_match(&gpu, &scene, &runs, 1, 15.0);
        assert!(step.layout.spheres.div_ceil(WORKGROUP) > 10 * 13, "{step:?}");
        assert!(status.rejected == 0 && status.total_counters().collisions + status.last_contacts > 1000, "{status:?}");
    }
}

/// A body outside its AABB rejects the step on both backends. How far the other threads of the stage get before they see this
/// is undefined. Therefore the rest of such a stage is not compared, except that the GPU must report an escape ratio between 1
/// and the largest one.
#[test]
fn escapes_reject_the_step_on_both_backends() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut scene = Scene::new();
        add_degenerate_spheres_and_rods(&mut scene);
        let mut world = World::build(&scene).unwrap();
        world.step.constants.dt = 0.02;
        world.step.lists.margin_scale = 1e-3;
        world.set_pair_rows(1 << 9);
        let mut rejected = 0;
        enable_sweeps(&mut world);
        for group in grouped(&stages(&Phase::STEP, integrator)) {
            let before = world.clone();
            group.iter().for_each(|run| run.on_cpu(&mut world));
            let gpu = on_gpu(&GPU, &before, &group).status;
            assert_eq!(gpu.rejected, world.status.rejected, "{}", group[0].stage.name);
            if world.status.rejected != 0 {
                rejected += 1;
                let [found, largest] = [gpu, world.status].map(|status| f32::from_bits(status.escape_ratio));
                assert!((1e-3..largest * 1.001).contains(&found), "{}: {found} {largest}", group[0].stage.name);
                assert_eq!(world.states[0], before.states[0]);
                // Continue with the next stage as if the step had not been rejected. The CPU always completes a stage.
                world.status.rejected = 0;
                world.status.escape_ratio = 0;
            }
        }
        assert!(rejected > 0);
    }
}
