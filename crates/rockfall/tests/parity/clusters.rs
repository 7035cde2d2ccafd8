//! Random scenes of many small clusters. The clusters are so far apart that they do not interact, so a cluster with an
//! ambiguous decision can be drawn again without a change to the others.

use glam::Vec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rockfall::{CohesionModel, ContactLaw, Material, MaterialId, Pair, Rod, RollingModel, Scene, Spring, Tether};

use crate::random::Draw;
use crate::trace::{Only, Plan};

/// Distance between the centres of neighbouring clusters, in units.
const SPACING: f32 = 9.0;

type Recipe = fn(&mut Draw);

/// All kinds of clusters. Kinds whose objects rarely overlap are listed more than once.
const RECIPES: [Recipe; 33] = [
    |d| d.sphere_pair(),
    |d| d.sphere_pair(),
    |d| d.capsule_and_sphere(),
    |d| d.sphere_on_floor(),
    |d| d.spheres(6),
    |d| d.shallow_overlaps(),
    |d| d.sphere_on_rod(false),
    |d| d.sphere_on_rod(true),
    |d| d.rods(2),
    |d| d.rods(4),
    |d| d.parallel_rods(),
    |d| d.capsules(2),
    |d| d.capsules(3),
    |d| d.box_and_spheres(),
    |d| d.box_and_spheres(),
    |d| d.box_and_rods(2),
    |d| d.box_and_rods(4),
    |d| d.box_and_vertex_rods(),
    |d| d.polygon(),
    |d| d.smooth_wall(),
    |d| d.chain(),
    |d| d.frame(),
    |d| d.attached(),
    |d| d.groups(),
    |d| d.crowd(),
    |d| d.giant(),
    |d| d.corner(),
    |d| d.struck_network(),
    |d| d.struck_network(),
    |d| d.tiles(),
    |d| d.overlaid(),
    |d| d.groove(),
    |d| d.sunk(),
];

/// Kinds without rods.
const WITHOUT_RODS: [Recipe; 13] = [
    |d| d.sphere_pair(),
    |d| d.sphere_on_floor(),
    |d| d.spheres(6),
    |d| d.shallow_overlaps(),
    |d| d.box_and_spheres(),
    |d| d.attached(),
    |d| d.groups(),
    |d| d.giant(),
    |d| d.corner(),
    |d| d.tiles(),
    |d| d.overlaid(),
    |d| d.groove(),
    |d| d.sunk(),
];

/// Kinds whose collisions most often share no body.
const LONE: [Recipe; 10] = [
    |d| d.sphere_pair(),
    |d| d.sphere_on_floor(),
    |d| d.corner(),
    |d| d.shallow_overlaps(),
    |d| d.attached(),
    |d| d.tiles(),
    |d| d.capsule_and_sphere(),
    |d| d.struck_rod(),
    |d| d.sphere_on_rod(true),
    |d| d.box_and_vertex_rods(),
];
/// Number of kinds at the start of `LONE` that have no rods.
const LONE_WITHOUT_RODS: usize = 6;

/// Kinds without networks and without large spheres.
const FEW: [Recipe; 9] = [
    |d| d.spheres(5),
    |d| d.sphere_on_floor(),
    |d| d.box_and_spheres(),
    |d| d.sphere_pair(),
    |d| d.tiles(),
    |d| d.capsules(2),
    |d| d.capsules(3),
    |d| d.struck_rod(),
    |d| d.polygon(),
];
/// Number of kinds at the start of `FEW` that have no rods.
const FEW_WITHOUT_RODS: usize = 5;

/// A scene of clusters, and the cluster of each object.
pub(crate) struct Clusters {
    pub(crate) scene: Scene,
    /// Cluster of each object, by object id.
    pub(crate) cluster_of: Vec<usize>,
}

/// Builds the scene of a plan. `attempts[k]` is the number of times that cluster k has been drawn before; it selects the seed.
pub(crate) fn clusters(plan: &Plan, attempts: &[u64]) -> Clusters {
    let Plan { seed, settings, rods, only, .. } = *plan;
    let recipes: &[Recipe] = match (only, rods) {
        (Only::All, true) => &RECIPES,
        (Only::All, false) => &WITHOUT_RODS,
        (Only::Lone, true) => &LONE,
        (Only::Lone, false) => &LONE[..LONE_WITHOUT_RODS],
        (Only::Few, true) => &FEW,
        (Only::Few, false) => &FEW[..FEW_WITHOUT_RODS],
    };
    let mut scene = Scene::new();
    scene.settings = settings;
    let mut owners: [Vec<usize>; 4] = Default::default();
    let mut giants = Vec::new();
    let mut clusters_of_giants = Vec::new();
    let side = (attempts.len() as f32).cbrt().ceil() as usize;
    for (cluster, attempt) in attempts.iter().enumerate() {
        let cell = [cluster % side, cluster / side % side, cluster / side / side];
        let middle = SPACING * Vec3::from_array(cell.map(|k| k as f32 - 0.5 * (side - 1) as f32));
        let draw_seed = seed << 40 | (cluster as u64) << 20 | attempt;
        let mut draw = Draw {
            scene: &mut scene,
            rng: Pcg64Mcg::seed_from_u64(draw_seed),
            middle,
            giants: &mut giants,
            muscles: seed % 3 != 1,
        };
        // Avoid special values, such as coordinates that are exact multiples of the spacing.
        let jitter = draw.vector(0.1);
        draw.middle += jitter;
        recipes[(cluster + seed as usize) % recipes.len()](&mut draw);
        let counts = scene.counts();
        for (owner, count) in owners.iter_mut().zip([counts.spheres, counts.rods, counts.boxes, counts.polygons]) {
            owner.resize(count, cluster);
        }
        clusters_of_giants.resize(giants.len(), cluster);
    }
    for giant in giants {
        scene.add_sphere(giant).unwrap();
    }
    owners[0].extend(clusters_of_giants);
    if plan.materials {
        scene = with_materials(&scene);
    }
    Clusters { scene, cluster_of: owners.concat() }
}

/// The same scene with materials: every third object has none, unless the contact law needs it, some pairs are not given, and some have no friction.
fn with_materials(scene: &Scene) -> Scene {
    let mut made = Scene::new();
    made.settings = scene.settings;
    let materials = [("hard", 2e3), ("soft", 5e2)].map(|(name, young)| Material::new(name).young(young).poisson(0.3));
    let [hard, soft] = materials.map(|material| made.add_material(material).unwrap());
    let hard_pair = Pair::default().restitution(0.9).friction(0.4).stiffness(300.0);
    let hard_pair =
        hard_pair.rolling_friction(0.2).rolling_model(RollingModel::SpringDashpot).twisting_friction(0.3).surface_energy(0.1);
    made.set_pair(hard, hard, hard_pair).unwrap();
    made.set_pair(hard, soft, Pair::default().restitution(0.3).friction(0.0)).unwrap();
    let soft_pair =
        Pair::default().characteristic_velocity(0.5).rolling_friction(0.3).rolling_model(RollingModel::ConstantTorque);
    let has_necks = scene.settings.contact_law == ContactLaw::HertzMindlin;
    let soft_pair = if has_necks { soft_pair.surface_energy(0.2).cohesion(CohesionModel::Jkr) } else { soft_pair };
    made.set_pair(soft, soft, soft_pair).unwrap();
    let has_history = scene.settings.contact_law.has_history();
    let mut place = 0;
    let mut next = || -> Option<MaterialId> {
        place += 1;
        // The laws with history need a material for every object.
        [if has_history { Some(hard) } else { None }, Some(hard), Some(soft)][place % 3]
    };
    let old: Vec<_> = scene.sphere_ids().collect();
    let mut spheres = Vec::new();
    for sphere in scene.spheres() {
        let mut sphere = *sphere;
        sphere.material = next();
        spheres.push(made.add_sphere(sphere).unwrap());
    }
    let same = |id| spheres[old.iter().position(|other| *other == id).unwrap()];
    for rod in scene.rods() {
        let mut copy = Rod::new(same(rod.end1), same(rod.end2), rod.radius).group(rod.group);
        (copy.length, copy.material) = (rod.length, next());
        made.add_rod(copy).unwrap();
    }
    for spring in scene.springs() {
        let copy = Spring::new(same(spring.a), same(spring.b), spring.stiffness, spring.length);
        made.add_spring(copy.damping(spring.damping)).unwrap();
    }
    for tether in scene.tethers() {
        let copy = Tether::new(same(tether.sphere), tether.point, tether.stiffness).length(tether.length);
        made.add_tether(copy.damping(tether.damping)).unwrap();
    }
    for cuboid in scene.boxes() {
        let mut copy = *cuboid;
        copy.material = next();
        made.add_box(copy).unwrap();
    }
    for polygon in scene.polygons() {
        let mut copy = *polygon;
        copy.material = next();
        made.add_polygon(copy).unwrap();
    }
    made
}
