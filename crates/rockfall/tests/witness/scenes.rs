//! Random scenes: small clusters of objects of all kinds, and settings.

use std::collections::HashMap;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{Integrator, MotionId, Scene, Settings, Sphere, SphereId};

use crate::draw::{Draw, direction};

/// Settings and time step of one step.
#[derive(Clone, Copy)]
pub(crate) struct Regime {
    pub(crate) settings: Settings,
    pub(crate) dt: f32,
}

/// Clusters, the integrator, and the regimes, which the steps use in turn.
pub(crate) struct Plan {
    pub(crate) integrator: Integrator,
    pub(crate) regimes: Vec<Regime>,
    pub(crate) clusters: Vec<Scene>,
}

/// Kinds of clusters.
const RECIPES: [fn(&mut Draw); 22] = [
    Draw::duel,
    Draw::crowd,
    Draw::corner,
    Draw::rods,
    Draw::capsule_duel,
    Draw::capsules,
    Draw::pendulum,
    Draw::frame,
    Draw::springs,
    Draw::box_and_rods,
    Draw::box_and_balls,
    Draw::rollers,
    Draw::groups,
    Draw::everything,
    Draw::tied,
    Draw::parallel,
    Draw::folded,
    Draw::tiles,
    Draw::tiles_and_sheets,
    Draw::overlaid,
    Draw::groove,
    Draw::sunk,
];

/// Number of kinds of clusters.
pub(crate) const KINDS: usize = RECIPES.len();

/// A plan with `count` clusters, of all kinds in turn, and a number of regimes.
pub(crate) fn plan(seed: u64, count: usize, regimes: usize) -> Plan {
    let mut rng = Pcg64Mcg::seed_from_u64(seed ^ 0x5eed);
    let clusters = (0..count).map(|number| {
        // Clusters may overlap in space, because they are in different groups (`together`).
        let cell = |k: usize| if count > 1 { 4.0 * (k % 3) as f32 - 4.0 } else { 0.0 };
        let middle = Vec3::new(cell(number), cell(number / 3), cell(number / 9));
        let mut draw = Draw { rng: Pcg64Mcg::seed_from_u64(seed << 8 | number as u64), scene: Scene::new(), middle };
        RECIPES[(seed as usize + number) % KINDS](&mut draw);
        // From other numbers, so that the bodies do not depend on the walls.
        draw.rng = Pcg64Mcg::seed_from_u64(!(seed << 8 | number as u64));
        if draw.chance(0.3) {
            draw.move_walls();
        }
        without_stretching(&draw.scene)
    });
    let clusters: Vec<Scene> = clusters.collect();
    let size = if rng.random_bool(0.2) { 10.0_f32.powf(rng.random_range(-2.0..2.0)) } else { 1.0 };
    let heavy = if rng.random_bool(0.2) { 100.0 } else { 1.0 };
    let clusters = clusters.iter().map(|cluster| sized(cluster, size, heavy)).collect();
    let integrator = if rng.random_bool(0.65) { Integrator::Rk4 } else { Integrator::SymplecticEuler };
    let regimes = (0..regimes).map(|_| {
        let dt = [0.002, 0.005, 0.01, 0.02][rng.random_range(0..4)] * rng.random_range(0.8..1.2);
        Regime { settings: settings(&mut rng), dt }
    });
    Plan { integrator, regimes: regimes.collect(), clusters }
}

fn settings(rng: &mut Pcg64Mcg) -> Settings {
    let mut settings = Settings::default().with(|settings| {
        settings.restitution = [1.0, 0.75, rng.random_range(0.0..1.0)][rng.random_range(0..3)];
        settings.gravity = [0.0, 1.0, rng.random_range(0.0..12.0)][rng.random_range(0..3)];
        settings.gravity_direction = direction(rng);
        settings.activation_threshold = [1.0, rng.random_range(0.0..0.5)][rng.random_range(0..2)];
        settings.contact_force = [1000.0, rng.random_range(100.0..2000.0)][rng.random_range(0..2)];
        settings.contact_damping = [12.5, 0.0, rng.random_range(0.0..30.0)][rng.random_range(0..3)];
        settings.friction = [50.0, 0.0, 5000.0][rng.random_range(0..3)];
        settings.collisions = rng.random_bool(0.85);
        settings.contact_pull = rng.random_bool(0.1);
    });
    if rng.random_bool(0.3) {
        settings.coulomb_friction = rng.random_range(0.05..1.0);
    }
    if rng.random_bool(0.3) {
        settings.collision_friction = rng.random_range(0.05..1.0);
    }
    // From a copy, so that the numbers that follow do not depend on it.
    let mut copy = rng.clone();
    if copy.random_bool(0.2) {
        settings.linear_damping = copy.random_range(0.1..5.0);
        settings.angular_damping = copy.random_range(0.1..5.0);
    }
    settings
}

/// The scene without velocities that would stretch its capsules. The specification does not define collisions of a
/// capsule whose ends approach or separate, and every step removes such velocities.
fn without_stretching(scene: &Scene) -> Scene {
    let ids: Vec<SphereId> = scene.sphere_ids().collect();
    let mut spheres = scene.spheres().to_vec();
    let rods_at = |id: SphereId| scene.rods().iter().filter(|rod| rod.end1 == id || rod.end2 == id).count();
    for rod in scene.rods().iter().filter(|rod| rod.length.is_some()) {
        let ends = [rod.end1, rod.end2];
        let [one, two] = ends.map(|end| ids.iter().position(|&known| known == end).expect("a sphere of the scene"));
        if ends.map(rods_at) == [1; 2] && !spheres[one].fixed && !spheres[two].fixed {
            let axis = (spheres[two].position - spheres[one].position).normalize();
            let opening = (spheres[two].velocity - spheres[one].velocity).dot(axis);
            spheres[two].velocity -= opening * axis;
        }
    }
    rebuilt(scene, |at, _| spheres[at])
}

/// The same scene in another unit of length, and with another mass for every third sphere.
fn sized(scene: &Scene, size: f32, heavy: f32) -> Scene {
    let mut new = Scene::new();
    let factor = |at: usize| if at.is_multiple_of(3) { heavy } else { 1.0 };
    let change = |at: usize, mut sphere: Sphere| {
        let mass = factor(at);
        sphere.position *= size;
        sphere.velocity *= size;
        sphere.angular_momentum *= mass * size * size;
        sphere.mass *= mass;
        sphere.radius *= size;
        sphere.force *= mass * size;
        sphere
    };
    copy_spheres(scene, &mut new, change);
    copy_rest(scene, &mut new, &Copy { size, ..PLAIN });
    new
}

/// A scene with changed spheres.
pub(crate) fn rebuilt(scene: &Scene, change: impl Fn(usize, Sphere) -> Sphere) -> Scene {
    let mut new = Scene::new();
    copy_spheres(scene, &mut new, change);
    copy_rest(scene, &mut new, &PLAIN);
    new
}

/// Number of groups reserved for one cluster, because known scenes use several groups.
const GROUPS: u16 = 10;

/// How objects are copied to another scene.
struct Copy {
    /// Index of the first copied sphere in the target scene.
    offset: usize,
    /// Factor of all lengths.
    size: f32,
    /// Number added to all groups.
    groups: u16,
}

/// A copy without changes.
const PLAIN: Copy = Copy { offset: 0, size: 1.0, groups: 0 };

/// Adds the spheres of a scene to another one. `change` makes a copy of a sphere.
fn copy_spheres(from: &Scene, to: &mut Scene, change: impl Fn(usize, Sphere) -> Sphere) {
    for (at, sphere) in from.spheres().iter().enumerate() {
        to.add_sphere(change(at, *sphere)).expect("a valid sphere");
    }
}

/// Adds all objects of a scene except its spheres to another scene.
fn copy_rest(from: &Scene, to: &mut Scene, copy: &Copy) {
    let &Copy { offset, size, groups } = copy;
    let (old, new): (Vec<SphereId>, Vec<SphereId>) = (from.sphere_ids().collect(), to.sphere_ids().collect());
    let map = |id: SphereId| new[offset + old.iter().position(|&known| known == id).expect("a sphere of the scene")];
    for mut rod in from.rods().iter().copied() {
        (rod.end1, rod.end2) = (map(rod.end1), map(rod.end2));
        rod.radius *= size;
        rod.length = rod.length.map(|length| size * length);
        rod.group += groups;
        to.add_rod(rod).expect("a valid rod");
    }
    for mut spring in from.springs().iter().copied() {
        (spring.a, spring.b) = (map(spring.a), map(spring.b));
        spring.length *= size;
        to.add_spring(spring).expect("a valid spring");
    }
    for mut tether in from.tethers().iter().copied() {
        tether.sphere = map(tether.sphere);
        tether.point *= size;
        tether.length *= size;
        to.add_tether(tether).expect("a valid tether");
    }
    let motions = copy_motions(from, to, size);
    for mut cuboid in from.boxes().iter().copied() {
        cuboid.motion = cuboid.motion.map(|id| motions[&id]);
        cuboid.surface_velocity *= size;
        cuboid.corner *= size;
        cuboid.edges = cuboid.edges.map(|edge| size * edge);
        cuboid.group += groups;
        to.add_box(cuboid).expect("a valid box");
    }
    for mut polygon in from.polygons().iter().copied() {
        polygon.motion = polygon.motion.map(|id| motions[&id]);
        polygon.surface_velocity *= size;
        polygon.corner *= size;
        polygon.left *= size;
        polygon.right *= size;
        polygon.group += groups;
        to.add_polygon(polygon).expect("a valid polygon");
    }
}

/// Adds the motions of a scene to another scene, under other names.
fn copy_motions(from: &Scene, to: &mut Scene, size: f32) -> HashMap<MotionId, MotionId> {
    let mut copies = HashMap::new();
    for (id, motion) in from.motion_ids().zip(from.motions()) {
        let mut motion = motion.clone();
        for term in &mut motion.terms {
            for way in [&mut term.velocity, &mut term.amplitude, &mut term.through] {
                *way *= f64::from(size);
            }
        }
        motion.name = format!("motion{}", to.motions().len());
        copies.insert(id, to.add_motion(motion).expect("a valid motion"));
    }
    copies
}

/// All clusters in one scene, each in its own groups.
pub(crate) fn together(plan: &Plan) -> Scene {
    let mut scene = Scene::new();
    for (number, cluster) in plan.clusters.iter().enumerate() {
        let offset = scene.spheres().len();
        let groups = GROUPS * number as u16;
        let grouped = |_: usize, sphere: Sphere| sphere.group(groups + sphere.group);
        copy_spheres(cluster, &mut scene, grouped);
        copy_rest(cluster, &mut scene, &Copy { offset, size: 1.0, groups });
    }
    scene
}
