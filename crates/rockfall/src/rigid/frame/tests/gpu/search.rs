//! The device finds the manifolds that the twin finds.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use bytemuck::{Pod, cast_slice};
use glam::{Quat, Vec3};
use wgpu::BufferUsages;

use super::super::pile::heap;
use super::super::scene::{DT, Random, Scene};
use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Contacts, Found};
use crate::rigid::frame::{Frame, detect};
use crate::rigid::gpu::RigidGpu;
use crate::rigid::gpu::rows::{BELT, BodyRow, ROUND};
use crate::rigid::gpu::search::{COUNT_WORDS, FoundPoint, FoundRow, Inputs, Search};
use crate::rigid::groups::GroupWords;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Hull, Shape};
use crate::rigid::world::RigidWorld;

/// A device.
struct Device {
    device: wgpu::Device,
    queue: wgpu::Queue,
    gpu: RigidGpu,
}

/// A search on a device.
struct Bench<'a> {
    on: &'a Device,
    bodies: wgpu::Buffer,
    search: Search,
    count: usize,
}

/// What a search has found.
struct Outcome {
    counts: Vec<u32>,
    /// Pairs of colliders, ascending.
    candidates: Vec<[u32; 2]>,
    /// By colliders.
    found: BTreeMap<[u32; 2], FoundRow>,
    owned: Vec<u32>,
    bodies: Vec<BodyRow>,
}

impl Device {
    fn open() -> Self {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter =
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).expect("an adapter");
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
        let gpu = RigidGpu::new(device.clone(), queue.clone());
        Self { device, queue, gpu }
    }
}

impl<'a> Bench<'a> {
    fn new(on: &'a Device, world: &RigidWorld) -> Self {
        let Device { device, queue, gpu } = on;
        let mut rows = Frame::open(world, DT, 4).rows(4);
        // The search must set these.
        for row in &mut rows.bodies {
            (row.clock, row.path, row.share, row.margin, row.stopped, row.unused) = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
            (row.kicked_velocity, row.kicked_spin) = ([7.0; 3], [8.0; 3]);
        }
        let filled = |bytes: &[u8], usage| {
            let usage = usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
            let size = bytes.len().max(16) as u64;
            let buffer = device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let inputs = Inputs {
            frame: filled(bytemuck::bytes_of(&rows.frame), BufferUsages::UNIFORM),
            bodies: filled(cast_slice(&rows.bodies), BufferUsages::STORAGE),
            constants: filled(cast_slice(&rows.constants), BufferUsages::STORAGE),
            colliders: filled(cast_slice(&rows.colliders), BufferUsages::STORAGE),
            hulls: filled(cast_slice(&rows.hulls), BufferUsages::STORAGE),
            apart: filled(&[0; 4], BufferUsages::STORAGE),
        };
        let bodies = inputs.bodies.clone();
        let search = Search::new(gpu, world, DT, inputs);
        Self { on, bodies, search, count: world.bodies.len() }
    }

    fn read<T: Pod>(&self, buffer: &wgpu::Buffer, count: usize) -> Vec<T> {
        let size = (count * size_of::<T>()) as u64;
        if size == 0 {
            return Vec::new();
        }
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let back =
            self.on.device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        let mut encoder = self.on.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &back, 0, size);
        self.on.queue.submit([encoder.finish()]);
        back.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        self.on.device.poll(wgpu::PollType::wait_indefinitely()).expect("it runs");
        let bytes = back.get_mapped_range(..).expect("a range");
        bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
    }

    /// The search, without more room.
    fn run(&mut self) -> Outcome {
        let mut encoder = self.on.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.search.encode(&mut encoder);
        self.on.queue.submit([encoder.finish()]);
        let counts: Vec<u32> = self.read(&self.search.counts, COUNT_WORDS as usize);
        let [candidates, found] = [0, 1].map(|k| counts[k].min(self.search.rooms()[k]) as usize);
        let mut candidates: Vec<[u32; 2]> = self.read(&self.search.candidates, candidates);
        candidates.iter_mut().for_each(|pair| pair[0] &= u32::MAX >> 1);
        candidates.sort_unstable();
        assert!(candidates.windows(2).all(|pairs| pairs[0] != pairs[1]), "each candidate once");
        let mut rows: Vec<FoundRow> = self.read(&self.search.found, found);
        // Other points are not written.
        rows.iter_mut().for_each(|row| row.points[(row.info & 255) as usize..].fill(FoundPoint::default()));
        // The place among those of the owner depends on who comes first.
        rows.iter_mut().for_each(|row| row.points.iter_mut().for_each(|point| point.unused = 0));
        let found: BTreeMap<_, _> = rows.iter().map(|row| (row.colliders, *row)).collect();
        assert!(found.len() == rows.len(), "each pair once");
        let (owned, bodies) = (self.read(&self.search.owned, self.count), self.read(&self.bodies, self.count));
        Outcome { counts, candidates, found, owned, bodies }
    }

    /// The search, with as much room as it needs.
    fn run_with_room(&mut self) -> Outcome {
        loop {
            let outcome = self.run();
            if outcome.counts[..2].iter().zip(self.search.rooms()).all(|(count, room)| *count <= room) {
                return outcome;
            }
            assert!(self.search.grow(outcome.counts[0], outcome.counts[1]));
        }
    }
}

/// A pair with a ball, which the twin finds in other ways.
const BALL: u32 = 1 << 19;

/// How a row differs from the pair of the twin, which has its points in the contacts of a block of its own.
fn difference(world: &RigidWorld, bodies: &Bodies, twin: &Found, row: &FoundRow) -> Option<String> {
    let mut contacts = Contacts::default();
    let pair = detect::pair(world, twin, 0);
    detect::add_points(world, bodies, &mut contacts, twin, pair.room);
    let moves = twin.colliders.iter().any(|k| world.colliders[*k as usize].surface_velocity != Vec3::ZERO);
    let flags = if pair.round { ROUND } else { 0 } | if moves { BELT } else { 0 };
    if row.info & !BALL != u32::from(pair.count) | u32::from(pair.room) << 8 | flags || row.bodies != twin.bodies {
        return Some(format!("info {:x}, {} points", row.info, pair.count));
    }
    let normal = Vec3::from_array(row.normal).distance(pair.inner_normal.into());
    if normal > 2e-4 {
        return Some(format!("normal off by {normal}"));
    }
    let size = contacts.points[0].on_a.length().min(contacts.points[0].on_b.length()).max(1.0);
    for (point, twin) in row.points.iter().zip(&contacts.points[..pair.count as usize]) {
        let on_a = Vec3::from_array(point.on_a).distance(twin.on_a.into());
        let on_b = Vec3::from_array(point.on_b).distance(twin.on_b.into());
        if point.id != twin.id || on_a.max(on_b) > 1e-4 * size {
            return Some(format!("ids {:x} {:x}, points off by {on_a} {on_b}", point.id, twin.id));
        }
    }
    None
}

/// Compares a search with the twin, and gives the number of manifolds. A few may differ: the last bit decides ties.
fn compare(on: &Device, name: &str, world: &RigidWorld, ties: usize) -> usize {
    let mut bench = Bench::new(on, world);
    let outcome = bench.run_with_room();
    let bodies = Bodies::load(world, DT);
    let body = |collider: u32| world.colliders[collider as usize].body;
    let candidates = detect::candidates(world, &bodies).into_iter();
    let candidates: BTreeSet<_> = candidates.map(|(i, j)| if body(i) < body(j) { [i, j] } else { [j, i] }).collect();
    let unlike = candidates.symmetric_difference(&outcome.candidates.iter().copied().collect()).count();
    // Boxes that touch up to rounding.
    assert!(unlike <= 2, "{name}: {unlike} of {} candidates", candidates.len());
    let twins = detect::manifolds(world, &bodies, None);
    let wanted: BTreeMap<_, _> = twins.iter().map(|twin| (twin.colliders, twin)).collect();
    for (i, row) in outcome.bodies.iter().enumerate() {
        let margin = bodies.constants[i].margin;
        assert!((row.margin - margin).abs() <= 1e-5 * margin, "{name}: margin of {i}: {} {margin}", row.margin);
        assert!([row.clock, row.path, row.share, row.stopped, row.unused] == [0.0; 5], "{name}: {i} begins anew");
        assert!(row.kicked_velocity == row.velocity && row.kicked_spin == row.spin, "{name}: {i}");
    }
    let missing: Vec<_> = wanted.keys().filter(|pair| !outcome.found.contains_key(*pair)).collect();
    let more: Vec<_> = outcome.found.keys().filter(|pair| !wanted.contains_key(*pair)).collect();
    let both = wanted.iter().filter_map(|(pair, twin)| Some((pair, twin, outcome.found.get(pair)?)));
    let others: Vec<_> = both.filter_map(|(pair, twin, row)| Some((pair, difference(world, &bodies, twin, row)?))).collect();
    eprintln!(
        "{name}: {} candidates, {} manifolds, levels {:x}, {} large; {} missing, {} more, {} others; {} dispatches",
        outcome.counts[0],
        outcome.counts[1],
        outcome.counts[2],
        outcome.counts[3],
        missing.len(),
        more.len(),
        others.len(),
        bench.search.dispatches
    );
    let differ = missing.len() + more.len() + others.len();
    let first = |pairs: &[&[u32; 2]]| format!("{:?}", &pairs[..pairs.len().min(5)]);
    let some = &others[..others.len().min(5)];
    assert!(differ <= ties, "{name}: missing {}, more {}, others {some:?}", first(&missing), first(&more));
    assert!(outcome.counts[1] as usize == outcome.found.len() && outcome.counts[0] >= outcome.counts[1], "{name}");
    let mut owned = vec![0; world.bodies.len()];
    for [a, b] in outcome.found.values().map(|row| row.bodies) {
        assert!(a < b, "{name}: {a} {b}");
        owned[if bodies.masses[b as usize].inverse_mass > 0.0 { b } else { a } as usize] += 1;
    }
    assert!(owned == outcome.owned, "{name}: owners");
    outcome.found.len()
}

/// A pose at which something lies at random.
fn pose(random: &mut Random, half: Vec3) -> Pose {
    Pose::new(half * random.vector(), Quat::from_scaled_axis(3.0 * random.vector()))
}

fn face(one_sided: bool) -> Shape {
    let (u, v) = (Vec3::new(1.5, 0.1, 0.0), Vec3::new(-0.2, 1.2, 0.0));
    Shape { core: Core::Face { u, v, is_triangle: false, one_sided, is_facet: false }, radius: 0.0 }
}

fn hull(random: &mut Random) -> Shape {
    let points: Vec<Vec3> = (0..9).map(|_| 0.6 * random.vector()).collect();
    Shape { core: Core::Hull(Arc::new(Hull::new(&points).expect("a hull").0)), radius: 0.0 }
}

/// Balls, capsules and boxes on a half-space and on faces.
fn mixture() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    scene.plane(Vec3::new(-5.0, 0.0, 0.0), Vec3::new(1.0, 0.2, 0.1));
    let mut random = Random(3);
    for k in 0..40 {
        let mut place = pose(&mut random, Vec3::new(5.0, 1.5, 5.0));
        place.position.y += 1.5;
        scene.attach(0, face(k % 2 == 0), place);
    }
    for k in 0..400 {
        let mut place = pose(&mut random, Vec3::new(5.0, 1.8, 5.0));
        place.position.y += 1.8;
        let number = 0.3 + 0.15 * random.number();
        let shape = match k % 3 {
            0 => Shape::ball(number),
            1 => Shape::capsule(number, 0.5 * number),
            _ => Shape::cuboid(Vec3::new(number, 0.3, 0.4)),
        };
        let body = scene.body(shape, place, 1.0);
        scene.throw(body, random.vector(), 2.0 * random.vector());
    }
    scene
}

/// Boxes and balls of sizes from 0.01 to 100, the small ones in clusters so that they touch.
fn sizes() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let mut random = Random(9);
    for k in 0..1500 {
        let size = 10.0_f32.powf(2.0 * random.number());
        let mut place = pose(&mut random, Vec3::splat(if k % 2 == 0 { 60.0 } else { 3.0 * size }));
        place.position.y += 10.0;
        let shape = if k % 3 == 0 { Shape::ball(0.5 * size) } else { Shape::cuboid(size * Vec3::new(0.5, 0.4, 0.3)) };
        scene.body(shape, place, size * size * size);
    }
    scene
}

/// Bodies of several colliders, groups, belts, a kinematic box that turns, and scales of margins.
fn parts() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let mut random = Random(17);
    for k in 0..150 {
        let place = pose(&mut random, Vec3::new(4.0, 3.0, 4.0));
        let body = scene.body(Shape::cuboid(Vec3::new(0.4, 0.2, 0.3)), place, 1.0);
        scene.attach(body, Shape::cuboid(Vec3::splat(0.25)), pose(&mut random, Vec3::splat(0.5)));
        scene.attach(body, Shape::ball(0.3), pose(&mut random, Vec3::splat(0.5)));
        scene.world.bodies[body].radius = 1.5;
        scene.world.bodies[body].margin_scale = 1.0 + 0.02 * k as f32;
        scene.throw(body, random.vector(), random.vector());
    }
    for _ in 0..20 {
        let shape = Shape::cuboid(Vec3::new(1.0, 0.1, 0.5));
        let at = pose(&mut random, Vec3::splat(4.0)).position;
        let body = scene.kinematic(shape, at, random.vector());
        scene.world.bodies[body].spin = random.vector();
    }
    // Group 1 meets 0 and 2, these meet themselves too, and 3 meets itself alone.
    let groups = [(0, 0b011), (1 | 1 << 16, 0b101), (2 | 2 << 16, 0b110)].map(|(own, meets)| (own, meets | 1 << 30));
    let groups = [groups[0], groups[1], groups[2], (3 | 31 << 16, 0)];
    for (k, collider) in scene.world.colliders.iter_mut().enumerate() {
        let (own, meets) = groups[k % 4];
        collider.group = GroupWords { own, meets };
    }
    for (k, collider) in scene.world.colliders.iter_mut().enumerate().skip(1) {
        collider.surface_velocity = if k % 7 == 0 { Vec3::X } else { Vec3::ZERO };
    }
    scene
}

fn hulls() -> Scene {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let mut random = Random(23);
    for k in 0..150 {
        let shape = match k % 5 {
            0 => Shape::cuboid(Vec3::splat(0.4)),
            1 => Shape::capsule(0.3, 0.2),
            2 => Shape::ball(0.4),
            _ => hull(&mut random),
        };
        let place = pose(&mut random, Vec3::splat(2.2));
        // The mass of a hull does not matter here.
        scene.body(Shape::ball(0.7), place, 1.0);
        let number = scene.world.shapes.len() as u32;
        scene.world.shapes.push(shape);
        scene.world.colliders.last_mut().unwrap().shape = number;
    }
    scene
}

#[test]
fn manifolds_are_those_of_the_twin() {
    let on = Device::open();
    let mut pile = heap(150, 0.0);
    pile.run(1.5);
    assert!(compare(&on, "pile", &pile.world, 2) > 200);
    assert!(compare(&on, "mixture", &mixture().world, 12) > 400);
    assert!(compare(&on, "sizes", &sizes().world, 12) > 300);
    assert!(compare(&on, "parts", &parts().world, 12) > 300);
    assert!(compare(&on, "hulls", &hulls().world, 12) > 200);
}

/// Far from the origin, at rest and with a half-space alone, and without anything.
#[test]
fn odd_scenes() {
    let on = Device::open();
    let mut far = heap(150, 0.0);
    far.run(1.0);
    far.world.bodies.iter_mut().skip(1).for_each(|body| body.pose.position += Vec3::new(1024.0, 0.0, -2048.0));
    assert!(compare(&on, "far", &far.world, 6) > 150);
    let mut alone = Scene::new(0.5, 0.0);
    assert!(compare(&on, "nothing", &alone.world, 0) == 0);
    alone.floor();
    assert!(compare(&on, "floor", &alone.world, 0) == 0);
    alone.ball(0.5, Vec3::new(0.0, 0.49, 0.0));
    assert!(compare(&on, "ball", &alone.world, 0) == 1);
}

/// Bodies whose places or speeds are no numbers, or infinite, have no manifolds, and the search of the others ends.
#[test]
fn places_that_are_no_numbers() {
    let on = Device::open();
    let mut scene = heap(100, 0.0);
    scene.world.bodies.iter_mut().for_each(|body| body.pose.position *= 0.6);
    for (k, odd) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e38, -1e30].into_iter().enumerate() {
        scene.world.bodies[10 + k].pose.position[k % 3] = odd;
        scene.world.bodies[20 + k].velocity[k % 3] = odd;
        scene.world.bodies[30 + k].pose.turn.x = odd;
    }
    let outcome = Bench::new(&on, &scene.world).run_with_room();
    let bodies = Bodies::load(&scene.world, DT);
    let is_odd = |body: &u32| (10..35).contains(body);
    let twins = detect::manifolds(&scene.world, &bodies, None).into_iter().map(|found| (found.bodies, found.colliders));
    let wanted: Vec<_> = twins.filter(|(bodies, _)| !bodies.iter().any(is_odd)).map(|(_, colliders)| colliders).collect();
    assert!(wanted.len() > 100 && wanted.iter().all(|pair| outcome.found.contains_key(pair)));
}

#[test]
fn large_heap() {
    let on = Device::open();
    let mut scene = heap(5000, 0.0);
    // Pressed together, so that boxes touch.
    scene.world.bodies.iter_mut().for_each(|body| body.pose.position *= 0.6);
    assert!(compare(&on, "large heap", &scene.world, 60) > 8000);
}

#[test]
fn search_asks_for_room_and_repeats() {
    let on = Device::open();
    let mut scene = heap(300, 0.0);
    scene.world.bodies.iter_mut().for_each(|body| body.pose.position *= 0.6);
    let mut bench = Bench::new(&on, &scene.world);
    let whole = bench.run_with_room();
    let again = bench.run();
    assert!(whole.found == again.found && whole.owned == again.owned, "two runs");
    bench.search.make_room(u64::from(whole.counts[0]), 10);
    let few = bench.run();
    assert!(few.counts[..2] == whole.counts[..2] && few.found.len() == 10);
    bench.search.make_room(10, 10);
    let fewer = bench.run();
    assert!(fewer.counts[0] == whole.counts[0] && fewer.counts[1] <= 10);
    assert!(bench.search.grow(fewer.counts[0], fewer.counts[1]));
    let next = bench.run();
    assert!(bench.search.grow(next.counts[0], next.counts[1]));
    let last = bench.run();
    assert!(last.found == whole.found && last.owned == whole.owned, "with more room");
    // More than a buffer may have by the limits that WebGPU guarantees, which leaves what fits.
    assert!(!bench.search.grow(8_000_000, 4_000_000));
    let [candidates, found] = bench.search.rooms();
    assert!(candidates == 10_000_000 && u64::from(found) * 160 == bench.search.found.size() && found > 800_000);
}
