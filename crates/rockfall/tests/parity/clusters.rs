//! Random scenes of many small clusters, far enough apart not to meet, so that a cluster with a decision too close to
//! call can be drawn again alone.

use glam::Vec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rockfall::Scene;

use crate::random::Draw;
use crate::trace::{Only, Plan};

/// Between the middles of neighbouring clusters, in units.
const SPACING: f32 = 9.0;

type Recipe = fn(&mut Draw);

/// Every kind of cluster; those that are rare to overlap stand more than once.
const RECIPES: [Recipe; 29] = [
    |d| d.duel(),
    |d| d.duel(),
    |d| d.capsule_duel(),
    |d| d.floored(),
    |d| d.spheres(6),
    |d| d.grazing(),
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
    |d| d.box_and_splinters(),
    |d| d.polygon(),
    |d| d.polygon(),
    |d| d.chain(),
    |d| d.frame(),
    |d| d.attached(),
    |d| d.groups(),
    |d| d.crowd(),
    |d| d.giant(),
    |d| d.corner(),
    |d| d.struck_network(),
    |d| d.struck_network(),
];

/// The kinds without rods.
const WITHOUT_RODS: [Recipe; 9] = [
    |d| d.duel(),
    |d| d.floored(),
    |d| d.spheres(6),
    |d| d.grazing(),
    |d| d.box_and_spheres(),
    |d| d.attached(),
    |d| d.groups(),
    |d| d.giant(),
    |d| d.corner(),
];

/// Those whose collisions most often share no body.
const LONE: [Recipe; 9] = [
    |d| d.duel(),
    |d| d.floored(),
    |d| d.corner(),
    |d| d.grazing(),
    |d| d.attached(),
    |d| d.capsule_duel(),
    |d| d.struck_rod(),
    |d| d.sphere_on_rod(true),
    |d| d.box_and_splinters(),
];
/// Of these the first so many are without rods.
const LONE_WITHOUT_RODS: usize = 5;

/// Those without networks and without large spheres.
const FEW: [Recipe; 8] = [
    |d| d.spheres(5),
    |d| d.floored(),
    |d| d.box_and_spheres(),
    |d| d.duel(),
    |d| d.capsules(2),
    |d| d.capsules(3),
    |d| d.struck_rod(),
    |d| d.polygon(),
];
/// Of these the first so many are without rods.
const FEW_WITHOUT_RODS: usize = 4;

/// A scene of clusters, and which cluster each object belongs to.
pub(crate) struct Clusters {
    pub(crate) scene: Scene,
    /// By object id.
    pub(crate) cluster_of: Vec<usize>,
}

/// The scene of a plan in which cluster k was drawn `attempts[k]` times.
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
        let mut draw = Draw { scene: &mut scene, rng: Pcg64Mcg::seed_from_u64(draw_seed), middle, giants: &mut giants };
        // So that nothing lies where it is by design.
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
    Clusters { scene, cluster_of: owners.concat() }
}
