//! Sheared periodic boundaries (docs/physics section 2.14): spheres that touch images of each other, some boxes away.

use glam::Vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::world::World;
use rockfall::step::schedule::{Phase, Run};
use rockfall::{BroadPhase, ContactLaw, Integrator, Material, Pair, Precision, Scene, Shear, Sphere};

use crate::assert_scenario_matches;
use crate::decisions::Findings;
use crate::trace::{DT, Scenario, Trace, with_step_settings};

/// Periods of the box, and the displacement of the box above in periods.
const PERIOD: Vec3 = Vec3::new(8.0, 6.0, 5.0);
const TURNS: f64 = 0.3;
const RATE: f32 = 0.1;
/// Steps that the images have slid before the traced one.
const EARLIER: u32 = 2;

fn vector(random: &mut Pcg64Mcg, most: f32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.random_range(-most..most)))
}

/// Pairs that overlap, of which each sphere is written some boxes away, with the velocity of that image.
fn scene(seed: u64, law: ContactLaw) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut scene = Scene::new();
    (scene.settings.gravity, scene.settings.collisions, scene.settings.contact_law) = (0.0, false, law);
    scene.settings.precision = Precision::Double;
    let stuff = scene.add_material(Material::new("stuff").density(300.0).young(2e4).poisson(0.3)).unwrap();
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.6).friction(0.4)).unwrap();
    for (axis, period) in PERIOD.to_array().into_iter().enumerate() {
        scene.set_periodic(axis, Some([0.0, period])).unwrap();
    }
    let earlier = f64::from(EARLIER) * f64::from(DT * RATE * PERIOD.y / PERIOD.x);
    scene.set_shear(Some(Shear::new(1, 0, RATE).with_turns(TURNS - earlier))).unwrap();
    let mut away = |place: Vec3, velocity: Vec3| {
        let boxes = Vec3::from_array(std::array::from_fn(|_| random.random_range(-2_i8..3).into()));
        let slid = Vec3::new(boxes.y * TURNS as f32 * PERIOD.x, 0.0, 0.0);
        (place + boxes * PERIOD + slid, velocity + Vec3::new(boxes.y * RATE * PERIOD.y, 0.0, 0.0))
    };
    let mut places = Pcg64Mcg::seed_from_u64(seed ^ 0x5ea);
    for cell in 0..160 {
        // One pair in each cell of a grid that fills the box, so that many pairs lie across its faces.
        let cell = Vec3::new((cell % 8) as f32, (cell / 8 % 5) as f32 * 1.2, (cell / 40) as f32 * 1.25);
        let radius = places.random_range(0.2..0.25);
        let apart = (vector(&mut places, 1.0) + Vec3::new(0.0, 1.5, 0.0)).normalize() * (1.9 * radius);
        for side in [-0.5, 0.5] {
            let (place, velocity) = away(cell + side * apart, vector(&mut places, 0.5));
            let ball = Sphere::new(place, radius).velocity(velocity).angular_momentum(vector(&mut places, 0.01));
            scene.add_sphere(ball.material(stuff)).unwrap();
        }
    }
    scene
}

/// Scenarios of the stages in which images count.
pub(crate) fn trace(seed: u64, law: ContactLaw, integrator: Integrator, broad_phase: BroadPhase) -> Trace {
    let scene = scene(seed, law);
    let mut world = World::build(&scene).unwrap();
    world.set_integrator(integrator);
    let mut world = with_step_settings(world);
    world.set_pair_rows(world.movers() * 4);
    world.step.lists.margin_scale = 4.0;
    world.set_time_step(DT);
    world.set_shear(&scene, world.status.steps);
    world.status.steps += EARLIER;
    world.status.lengths_due = 0;
    let concerned = ["update_aabbs", "fill_pairs", "find_neighbours", "loads"];
    let runs = Phase::STEP.iter().flat_map(|phase| phase.stages(integrator, broad_phase));
    let runs: Vec<Run> = runs.filter(|run| run.applies(&world.step)).copied().collect();
    let mut scenarios = Vec::new();
    for run in runs {
        if concerned.contains(&run.stage.name) {
            scenarios.push(Scenario { runs: vec![run], before: world.clone() });
        }
        run.on_cpu(&mut world);
    }
    assert_eq!(world.status.rejected, 0, "the step is rejected");
    Trace { scenarios, findings: Findings::default(), after: world }
}

#[test]
fn backends_agree_on_sheared_boxes() {
    let ways = [
        (ContactLaw::Thesis, Integrator::Rk4, BroadPhase::Grid),
        (ContactLaw::HertzMindlin, Integrator::VelocityVerlet, BroadPhase::BruteForce),
        (ContactLaw::HertzMindlin, Integrator::SymplecticEuler, BroadPhase::Grid),
    ];
    for (seed, (law, integrator, broad_phase)) in (5..).zip(ways) {
        let trace = trace(seed, law, integrator, broad_phase);
        trace.scenarios.iter().for_each(|scenario| assert_scenario_matches(seed, scenario));
        assert!(trace.after.status.last_contacts > 100, "{law}: {} contacts", trace.after.status.last_contacts);
    }
}
