//! The witness itself against conservation laws: boxes of rigid bodies (docs/physics.md sections 2.16, 3.9 and 3.11).

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{Cuboid, Integrator, Placement, Scene, Settings, Shape, Sphere};

use crate::boxes::Part;
use crate::closed::{close, kinetic, momentum};
use crate::draw::Draw;
use crate::geometry::{Feature, Thing};
use crate::scenes;
use crate::world::World;

/// Bodies with boxes that meet, without gravity.
fn bricks(seed: u64, settings: Settings) -> World {
    let mut draw = Draw { rng: Pcg64Mcg::seed_from_u64(seed), scene: Scene::new(), middle: Vec3::ZERO };
    draw.bricks();
    draw.scene.settings = settings;
    World::of(&draw.scene, Integrator::Rk4, 0.005)
}

fn smooth() -> Settings {
    Settings::default().with(|settings| {
        settings.gravity = 0.0;
        settings.restitution = 1.0;
        settings.contact_damping = 0.0;
        settings.friction = 0.0;
    })
}

/// Angular momentum of balls and bodies about the origin.
fn angular_momentum(world: &World) -> DVec3 {
    let own = world.balls.iter().enumerate().filter(|(at, _)| world.clump_at(*at).is_none());
    let of_balls: DVec3 = own.map(|(_, ball)| ball.mass * ball.x.cross(ball.v) + ball.l).sum();
    of_balls + world.clumps.iter().map(|clump| clump.mass * clump.x.cross(clump.v) + clump.l).sum::<DVec3>()
}

/// Impulses conserve both momenta. The momenta of scenes are of order 1.
#[test]
fn impulses_of_boxes_conserve_momentum() {
    let mut collisions = 0;
    for seed in 0..200 {
        let mut world = bricks(seed, smooth());
        let (before, turning) = (momentum(&world), angular_momentum(&world));
        let pressed = world.handle_collisions(true);
        collisions += pressed.iter().filter(|contact| contact.collides && world.has_box(&contact.pair)).count();
        close(momentum(&world).distance(before), 0.0, 1e-9);
        close(angular_momentum(&world).distance(turning), 0.0, 1e-9);
    }
    assert!(collisions > 200, "{collisions}");
}

/// Friction impulses conserve the momentum, and do not add energy.
#[test]
fn friction_impulses_of_boxes_add_no_energy() {
    let mut slower = 0;
    for seed in 0..200 {
        let rough = smooth().with(|settings| (settings.coulomb_friction, settings.collision_friction) = (0.4, 0.4));
        let (mut without, mut world) = (bricks(seed, smooth()), bricks(seed, rough));
        let before = momentum(&world);
        without.handle_collisions(true);
        world.handle_collisions(true);
        close(momentum(&world).distance(before), 0.0, 1e-9);
        assert!(kinetic(&world) <= kinetic(&without) + 1e-9, "seed {seed}");
        slower += usize::from(kinetic(&world) < kinetic(&without) - 1e-3);
    }
    assert!(slower > 50, "{slower}");
}

/// One ball hits a face, an edge or a vertex of a smooth elastic box: the energy stays. The impulse is exact after one sweep.
#[test]
fn a_single_elastic_hit_of_a_box_keeps_the_energy() {
    for (place, n) in [
        (Vec3::new(0.1, 0.7, -0.2), Vec3::Y),
        (Vec3::new(0.45, 0.45, 0.1), Vec3::new(1.0, 1.0, 0.0)),
        (Vec3::new(0.48, 0.48, 0.38), Vec3::new(1.0, 1.0, 1.0)),
    ] {
        let mut scene = Scene::new();
        scene.settings = smooth();
        let cuboid = Cuboid::new([-0.4, -0.4, -0.3], 0.8 * Vec3::X, 0.8 * Vec3::Y, 0.6 * Vec3::Z);
        let shape = scene.add_shape(Shape::new().cuboid(cuboid).rounding(0.1).mass(2.0)).expect("a valid shape");
        scene.add_body(Placement::new(shape).spin([0.3, 0.2, -0.1])).expect("a valid body");
        let shift = if place.y > 0.6 { 0.02 } else { 0.0 };
        scene.add_sphere(Sphere::new(place - shift * n, 0.3).velocity(-2.0 * n)).expect("a valid sphere");
        let mut world = World::of(&scene, Integrator::Rk4, 0.005);
        let before = kinetic(&world);
        let pressed = world.handle_collisions(true);
        assert!(pressed.len() == 1 && pressed[0].collides && !pressed[0].lone && pressed[0].j > 0.1, "{pressed:?}");
        close(kinetic(&world), before, 1e-12);
    }
}

/// The random scenes have all kinds of contacts of boxes.
#[test]
fn boxes_meet_in_all_ways() {
    let mut seen = std::collections::BTreeMap::<String, usize>::new();
    for seed in (0..60 * scenes::KINDS as u64).filter(|seed| seed % scenes::KINDS as u64 >= 25) {
        let plan = scenes::plan(seed, 1, 1);
        let world = World::of(&plan.clusters[0], plan.integrator, 0.0);
        let name = |thing: Thing, feature: Feature| match thing {
            Thing::Ball(ball) => match world.parts[ball] {
                Part::Sphere => "sphere",
                Part::Solid(_) => "solid",
                Part::Vertex(_) => "vertex",
            },
            Thing::Bar(bar) if world.is_edge(bar) => "edge",
            Thing::Bar(_) => "rod",
            Thing::Block(_) | Thing::Face(_) if matches!(feature, Feature::Corner(_)) => "wall corner",
            Thing::Block(_) => "wall box",
            Thing::Face(_) => "wall polygon",
        };
        for (pair, _) in world.touches().iter().filter(|(pair, _)| world.has_box(pair)) {
            let mut names = [name(pair.a, pair.feature), name(pair.b, pair.feature)];
            names.sort_unstable();
            *seen.entry(names.join(", ")).or_default() += 1;
        }
    }
    println!("{seen:?}");
    let all = [
        "solid, sphere",
        "solid, vertex",
        "edge, edge",
        "edge, rod",
        "rod, vertex",
        "vertex, wall box",
        "vertex, wall polygon",
    ];
    let walls = ["edge, wall box", "edge, wall polygon", "solid, wall corner"];
    for kind in all.iter().chain(&walls) {
        assert!(seen.get(*kind).is_some_and(|count| *count >= 5), "{kind}: {seen:?}");
    }
}
