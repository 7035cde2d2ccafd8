//! The grid finds exactly the pairs that brute force finds, in any scene, except spheres whose AABBs overlap only at
//! their corners.

use glam::{DVec3, Quat, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::exec::cpu;
#[cfg(feature = "gpu")]
use rockfall::exec::gpu::{Gpu, GpuWorld, block_on};
#[cfg(feature = "gpu")]
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::{LIST_COUNT_MASK, SLICE};
use rockfall::model::world::World;
use rockfall::step::schedule::Phase;
use rockfall::{BroadPhase, Capsule, Cuboid, Integrator, Placement, Polygon, Rod, Scene, Shape, Sphere};

fn random() -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(7)
}

fn place(random: &mut Pcg64Mcg, size: [f32; 3]) -> [f32; 3] {
    size.map(|size| random.random_range(-0.5..0.5) * size)
}

/// Adds `count` spheres spread over a box, with radii from a range and random velocities.
fn spheres(scene: &mut Scene, count: usize, size: [f32; 3], radii: [f32; 2]) {
    let random = &mut random();
    for _ in 0..count {
        let radius = radii[0] * (radii[1] / radii[0]).powf(random.random_range(0.0..1.0));
        let sphere = Sphere::new(place(random, size), radius).velocity(place(random, [2.0; 3]));
        let group = u16::from(random.random_range(0..10) == 0);
        scene.add_sphere(sphere.group(group)).unwrap();
    }
}

fn equal_spheres(_part: usize) -> Scene {
    let mut scene = Scene::new();
    spheres(&mut scene, 1_500, [5.0; 3], [0.2, 0.2]);
    scene
}

fn radii_1_to_50(part: usize) -> Scene {
    let mut scene = Scene::new();
    spheres(&mut scene, 1_600 / part, [6.0; 3], [0.05, 2.5]);
    scene
}

fn long_rods_among_small_spheres(part: usize) -> Scene {
    let mut scene = Scene::new();
    spheres(&mut scene, 700, [6.0; 3], [0.08, 0.1]);
    let random = &mut random();
    for _ in 0..120 {
        let one = place(random, [6.0; 3]);
        let along = place(random, [8.0 / part as f32; 3]);
        let two = [one[0] + along[0], one[1] + along[1], one[2] + along[2]];
        let ends = [one, two].map(|end| scene.add_sphere(Sphere::new(end, 0.05)).unwrap());
        scene.add_rod(Rod::new(ends[0], ends[1], 0.04)).unwrap();
        let one = place(random, [6.0; 3]);
        scene.add_capsule(Capsule::new(one, [one[0] + 1.0, one[1], one[2]], 0.1)).unwrap();
    }
    scene
}

fn hundreds_of_large_boxes_and_polygons(part: usize) -> Scene {
    let mut scene = long_rods_among_small_spheres(part);
    let random = &mut random();
    for _ in 0..240 / part {
        let corner = place(random, [10.0; 3]);
        let size = [0.1f32, 1.0, 4.0, 10.0][random.random_range(0..4)];
        scene.add_box(Cuboid::between(corner, corner.map(|x| x + size))).unwrap();
        scene.add_polygon(Polygon::new(corner, [size, 0.0, 0.3], [0.0, 0.5 * size, 0.0])).unwrap();
    }
    scene
}

fn flat_layer(_part: usize) -> Scene {
    let mut scene = Scene::new();
    spheres(&mut scene, 1_500, [40.0, 0.0, 40.0], [0.4, 0.5]);
    scene
}

fn tall_column(_part: usize) -> Scene {
    let mut scene = Scene::new();
    spheres(&mut scene, 1_000, [0.5, 400.0, 0.5], [0.2, 0.3]);
    scene
}

fn two_clusters_far_apart(_part: usize) -> Scene {
    let mut scene = Scene::new();
    for centre in [-1e5f32, 1e5] {
        let random = &mut random();
        for _ in 0..400 {
            let [x, y, z] = place(random, [3.0; 3]);
            scene.add_sphere(Sphere::new([x + centre, y, z - centre], 0.2)).unwrap();
        }
    }
    scene
}

fn one_flies_off(_part: usize) -> Scene {
    let mut scene = equal_spheres(1);
    scene.add_sphere(Sphere::new([1e7, -1e7, 3.0], 0.2).velocity([1e6, 0.0, 0.0])).unwrap();
    scene.add_sphere(Sphere::new([1e30, 0.0, 0.0], 0.2)).unwrap();
    scene.add_sphere(Sphere::new([0.0, 1e38, 0.0], 1e3).velocity([3e38, 0.0, 0.0])).unwrap();
    scene
}

/// One is far outside of all others, one starts among them.
fn two_fly_off_fast(_part: usize) -> Scene {
    let mut scene = equal_spheres(1);
    scene.add_sphere(Sphere::new([3.0, 1e5, 1.0], 0.2).velocity([0.0, 1e5, 0.0])).unwrap();
    scene.add_sphere(Sphere::new([-1.0, 0.5, 1.0], 0.2).velocity([0.0, -1e5, 0.0])).unwrap();
    scene
}

/// Parts of one body never meet.
fn rigid_bodies(part: usize) -> Scene {
    let mut scene = long_rods_among_small_spheres(part);
    let random = &mut random();
    for reach in [0.25_f32, 0.9] {
        let shape =
            Shape::new().capsule([-reach, 0.0, 0.0], [reach, 0.0, 0.0], 0.4 * reach).sphere([0.0, reach, 0.0], 0.5 * reach);
        let shape = scene.add_shape(shape.mass(1.0)).unwrap();
        for _ in 0..80 / part {
            let axis = Vec3::from_array(place(random, [1.0; 3]));
            let turn = Quat::from_axis_angle(axis.try_normalize().unwrap_or(Vec3::X), 2.0);
            scene
                .add_body(Placement::new(shape).at(DVec3::from_array(place(random, [6.0; 3]).map(f64::from))).turned(turn))
                .unwrap();
        }
    }
    scene
}

fn all_in_one_place(_part: usize) -> Scene {
    let mut scene = Scene::new();
    for _ in 0..150 {
        scene.add_sphere(Sphere::new([0.3, 0.3, 0.3], 0.2)).unwrap();
    }
    scene
}

/// Software Vulkan (llvmpipe) ends a shader after 65,535 iterations of all its loops. So scenes with long lists, which
/// are sorted, are reduced to a part there.
#[cfg(feature = "gpu")]
const PART_ON_GPU: usize = 6;

/// Builds a scene, or the n-th part of it.
type Make = fn(usize) -> Scene;

const SCENES: [(&str, Make); 11] = [
    ("equal spheres", equal_spheres),
    ("radii 1:50", radii_1_to_50),
    ("long rods among small spheres", long_rods_among_small_spheres),
    ("rigid bodies", rigid_bodies),
    ("hundreds of large boxes and polygons", hundreds_of_large_boxes_and_polygons),
    ("flat layer", flat_layer),
    ("tall column", tall_column),
    ("two clusters far apart", two_clusters_far_apart),
    ("one flies off", one_flies_off),
    ("two fly off fast", two_fly_off_fast),
    ("all in one place", all_in_one_place),
];

fn world(scene: &Scene) -> World {
    let mut world = World::build(scene).unwrap();
    world.step.constants.dt = 0.02;
    world
}

/// Runs the first two phases, and repeats them with more capacity when the lists do not fit.
fn detect(world: &mut World, method: BroadPhase, mut run: impl FnMut(&mut World, &[rockfall::step::schedule::Run])) {
    let phases = [Phase::UpdateAabbs, Phase::BroadPhase];
    let stages: Vec<_> = phases.iter().flat_map(|phase| phase.stages(Integrator::Rk4, method)).copied().collect();
    loop {
        world.status.rejected = 0;
        world.status.rebuild = rockfall::model::status::REBUILD_REQUESTED;
        run(world, &stages);
        if world.status.rejected == 0 {
            return;
        }
        assert_eq!(world.status.rejected, rockfall::model::status::REJECTED_PAIRS);
        let needed = world.status.pair_rows_needed;
        assert!(needed > world.step.layout.pair_rows);
        world.set_pair_rows(needed);
    }
}

/// The list of every mover.
fn lists(world: &World) -> Vec<Vec<u32>> {
    let step = &world.step;
    let row = |mover: u32| {
        let offset = world.lists[(step.layout.slices_at + mover / SLICE) as usize];
        let word = |place: u32| world.lists[(step.layout.entries_at + (offset + place) * SLICE + mover % SLICE) as usize];
        (0..world.lists[mover as usize] & LIST_COUNT_MASK).map(word).collect()
    };
    (0..world.movers()).map(row).collect()
}

/// Whether the grid must list a pair of brute force. Of two spheres it lists only those whose enclosing balls, which
/// are as large as their AABBs, intersect. `None` if the balls are apart by no more than rounding; such a pair may be
/// listed.
fn balls_meet(world: &World, one: u32, entry: u32) -> Option<bool> {
    let other = entry & world.step.entry_id_mask();
    if one.max(other) >= world.step.layout.spheres {
        return Some(true);
    }
    let [a, b] = [one, other].map(|id| {
        let aabb = &world.aabbs[id as usize];
        let [min, max] = [aabb.min, aabb.max].map(|corner| DVec3::from_array(corner.map(f64::from)));
        (0.5 * (min + max), 0.5 * (max - min).max_element())
    });
    let room = a.1 + b.1 - a.0.distance(b.0);
    let rounding = 3e-6 * (a.1 + b.1 + a.0.abs().max_element() + b.0.abs().max_element());
    // Infinite AABBs intersect everything.
    match room {
        // The square of such a distance exceeds f32, and so may that of the radii.
        _ if room < 0.0 && a.0.distance(b.0) > 1e19 => None,
        _ if room < -rounding => Some(false),
        _ if room < 0.0 => None,
        _ => Some(true),
    }
}

/// Asserts that the grid lists exactly the pairs of brute force that may touch, in the same order.
fn assert_grid_lists(name: &str, world: &World, expected: &[Vec<u32>], found: &[Vec<u32>]) {
    let decided = |rows: &[Vec<u32>], wanted: fn(Option<bool>) -> bool| -> Vec<Vec<u32>> {
        let row =
            |(mover, row): (u32, &Vec<u32>)| row.iter().copied().filter(|e| wanted(balls_meet(world, mover, *e))).collect();
        (0..).zip(rows).map(row).collect()
    };
    assert_same(name, &decided(expected, |meet| meet == Some(true)), &decided(found, |meet| meet == Some(true)));
    let apart = decided(found, |meet| meet == Some(false));
    assert!(apart.iter().all(Vec::is_empty), "{name}: lists hold pairs that cannot touch");
}

fn assert_same(name: &str, expected: &[Vec<u32>], found: &[Vec<u32>]) {
    for (mover, (expected, found)) in expected.iter().zip(found).enumerate() {
        assert_eq!(expected, found, "{name}: the list of mover {mover}");
    }
    assert_eq!(expected.len(), found.len());
    assert!(expected.iter().map(Vec::len).sum::<usize>() > 0, "{name}: there must be pairs");
}

fn on_cpu(scene: &Scene, method: BroadPhase) -> World {
    let mut world = world(scene);
    detect(&mut world, method, cpu::run);
    world
}

#[cfg(feature = "gpu")]
fn on_gpu(gpu: &Gpu, scene: &Scene, method: BroadPhase) -> World {
    let mut world = world(scene);
    let mut device = GpuWorld::new(gpu, &world).unwrap();
    detect(&mut world, method, |world, stages| {
        device.upload(world).unwrap();
        device.run(stages, &world.step, 1).unwrap();
        block_on(gpu.device(), device.download(world, &[Buffer::Status, Buffer::Cells, Buffer::Lists])).unwrap();
    });
    world
}

#[test]
fn the_grid_finds_the_pairs_of_brute_force() {
    for (name, scene) in SCENES {
        let scene = scene(1);
        let world = on_cpu(&scene, BroadPhase::BruteForce);
        let expected = lists(&world);
        let found = lists(&on_cpu(&scene, BroadPhase::Grid));
        assert_grid_lists(name, &world, &expected, &found);
        let id = |entry: u32| entry & world.step.entry_id_mask();
        let sorted = |row: &Vec<u32>| row.windows(2).all(|pair| id(pair[0]) <= id(pair[1]));
        assert!(expected.iter().all(sorted), "{name}: lists must be in ascending order");
    }
}

#[test]
fn sort_and_skip_finds_the_pairs_of_brute_force() {
    for (name, scene) in SCENES {
        let scene = scene(1);
        let expected = lists(&on_cpu(&scene, BroadPhase::BruteForce));
        assert_same(name, &expected, &lists(&on_cpu(&scene, BroadPhase::SortAndSkip)));
    }
}

#[cfg(feature = "gpu")]
#[test]
fn the_grid_on_the_gpu_finds_the_pairs_of_brute_force() {
    let gpu = Gpu::open_blocking(true).expect("these tests need a Vulkan driver such as lavapipe");
    for (name, scene) in SCENES {
        let scene = scene(PART_ON_GPU);
        let brute = on_cpu(&scene, BroadPhase::BruteForce);
        let world = on_gpu(&gpu, &scene, BroadPhase::Grid);
        assert_grid_lists(name, &brute, &lists(&brute), &lists(&world));
    }
}

/// Lists of 8 to 5,000 entries that workgroups build, in workgroup memory or directly in the list buffer.
#[cfg(feature = "gpu")]
#[test]
fn long_lists_on_the_gpu_equal_those_of_brute_force() {
    let gpu = Gpu::open_blocking(true).expect("these tests need a Vulkan driver such as lavapipe");
    let mut scene = Scene::new();
    spheres(&mut scene, 6_000, [6.0; 3], [0.04, 0.05]);
    let random = &mut random();
    for radius in [4.0, 2.9, 2.0, 1.0, 0.6, 0.5, 0.4, 0.4, 0.3, 0.3] {
        scene.add_sphere(Sphere::new(place(random, [4.0; 3]), radius)).unwrap();
    }
    let brute = on_cpu(&scene, BroadPhase::BruteForce);
    let expected = lists(&brute);
    let mut lengths: Vec<usize> = expected[6_000..].iter().map(Vec::len).collect();
    lengths.sort_unstable();
    assert!(lengths[0] < 24 && (1_000..2_048).contains(&lengths[7]) && lengths[8] > 4_096, "{lengths:?}");
    for world in [on_cpu(&scene, BroadPhase::Grid), on_gpu(&gpu, &scene, BroadPhase::Grid)] {
        assert_eq!(world.cells[3], 10, "long movers");
        assert_grid_lists("large spheres among thousands", &brute, &expected, &lists(&world));
    }
}

#[cfg(feature = "gpu")]
#[test]
fn lists_of_rods_with_many_neighbours_equal_those_of_brute_force() {
    let gpu = Gpu::open_blocking(true).expect("these tests need a Vulkan driver such as lavapipe");
    let random = &mut random();
    let mut lengths = Vec::new();
    // Crowds in which rods have more neighbours than a thread sorts at once, and finally more than it remembers. Where
    // rows of cells share slots of the hash table, rods find some of their neighbours twice.
    for crowd in 40..130 {
        let mut scene = Scene::new();
        let centre = place(random, [100.0; 3]);
        for turn in 0..crowd {
            let at = place(random, [1.2; 3]);
            let at = [at[0] + centre[0], at[1] + centre[1], at[2] + centre[2]];
            if turn % 4 == 0 {
                scene.add_capsule(Capsule::new(at, [at[0], at[1] + 0.3, at[2]], 0.2)).unwrap();
            } else {
                scene.add_sphere(Sphere::new(at, 0.2)).unwrap();
            }
        }
        let brute = on_cpu(&scene, BroadPhase::BruteForce);
        let expected = lists(&brute);
        assert_eq!(brute.step.layout.long_at, 0, "every list must be built by one thread");
        lengths.extend(expected[brute.step.layout.spheres as usize..].iter().map(Vec::len));
        for world in [on_cpu(&scene, BroadPhase::Grid), on_gpu(&gpu, &scene, BroadPhase::Grid)] {
            assert_grid_lists(&format!("a crowd of {crowd}"), &brute, &expected, &lists(&world));
        }
    }
    let many = |range: std::ops::Range<usize>| lengths.iter().filter(|length| range.contains(length)).count();
    assert!(many(0..33) > 20 && many(33..65) > 100 && many(65..200) > 20, "{lengths:?}");
}

#[cfg(feature = "gpu")]
#[test]
fn sort_and_skip_on_the_gpu_finds_the_pairs_of_brute_force() {
    let gpu = Gpu::open_blocking(true).expect("these tests need a Vulkan driver such as lavapipe");
    for (name, scene) in SCENES {
        let scene = scene(PART_ON_GPU);
        let brute = on_cpu(&scene, BroadPhase::BruteForce);
        let world = on_gpu(&gpu, &scene, BroadPhase::SortAndSkip);
        assert_same(name, &lists(&brute), &lists(&world));
    }
}

/// The search of a large object among many small ones must not visit every cell that it covers, and that of a far
/// object must not visit empty space.
#[test]
fn a_body_of_any_size_or_place_is_found_in_bounded_time() {
    let mut scene = Scene::new();
    spheres(&mut scene, 20_000, [60.0; 3], [0.1, 0.1]);
    scene.add_sphere(Sphere::new([0.0; 3], 1e6)).unwrap();
    scene.add_sphere(Sphere::new([1e12, 0.0, 0.0], 0.1)).unwrap();
    let start = std::time::Instant::now();
    let world = on_cpu(&scene, BroadPhase::Grid);
    assert!(world.lists[20_000] & LIST_COUNT_MASK > 17_000, "the large sphere overlaps all spheres of its group");
    assert!(start.elapsed().as_secs() < 20);
}
