//! What two backends made of one stage, or of a group of stages, field by field.
//!
//! Words must be equal. A float may differ by what rounding can do to it: both sides evaluate the same formula from the
//! same input, in another order of operations, which is as if the input had been off by a few units in its last place.
//! So the stage is also run, on the CPU, from inputs shaken by that much; a float may differ by [`FACTOR`] times the most
//! that it moved by, and by [`FLOOR`] of the largest value of its field. The normal of two rods that all but cross, for
//! one, has few good digits, and the comparison knows. Worlds that are shaken must still decide alike.

use glam::{Vec3, Vec4};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::buffer::Buffer;
use rockfall::model::status::{COUNTER_BLOCKS, Counters, Status};
use rockfall::model::world::World;
use rockfall::step::schedule::Run;

use crate::decisions::entries;
use crate::order::canonical;

const FACTOR: f32 = 8.0;
/// Relative to the largest component of a vector: about two units in the last place.
const SHAKE: f32 = 2.5e-7;

/// How much two backends may differ.
#[derive(Clone, Copy)]
pub(crate) struct Tolerance {
    /// Relative to the largest value of a field.
    pub(crate) floor: f32,
    /// How many shaken worlds tell what rounding can do.
    pub(crate) shaken: u64,
}

/// Where no decision is near its switch: about ten units in the last place, and what shaking does.
pub(crate) const MEASURED: Tolerance = Tolerance { floor: 1e-6, shaken: 6 };
/// Where decisions are made by rule: they cannot be shaken, for a rule holds for exact values only.
pub(crate) const BY_RULE: Tolerance = Tolerance { floor: 3e-5, shaken: 0 };

/// These only move words about, some of which are no floats.
const MOVES: [&str; 5] = ["key_spheres", "count_digits", "scatter_digits", "permute_spheres", "settle_spheres"];

struct Floats {
    buffer: Buffer,
    what: &'static str,
    values: Vec<f32>,
}

fn flat(vectors: &[Vec4]) -> Vec<f32> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

fn floats(world: &World) -> Vec<Floats> {
    let mut all = Vec::new();
    let mut field = |buffer, what, values| all.push(Floats { buffer, what, values });
    let n = world.step.spheres as usize;
    let states = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4];
    for (buffer, state) in states.into_iter().zip(&world.states) {
        for (what, region) in ["position", "velocity", "angular momentum"].into_iter().zip(state.chunks(n)) {
            field(buffer, what, flat(region));
        }
    }
    let hulls = world.aabbs.iter().flat_map(|aabb| [aabb.min, aabb.max].concat()).collect();
    field(Buffer::Aabbs, "bounds", hulls);
    field(Buffer::Extents, "extents", flat(&world.extents));
    for (place, what) in ["force 1", "couple 1", "force 2", "couple 2"].into_iter().enumerate() {
        let own: Vec<Vec4> = world.wrenches.iter().skip(place).step_by(4).copied().collect();
        field(Buffer::Wrenches, what, flat(&own));
    }
    field(Buffer::Orientations, "quaternion", flat(&world.orientations));
    let status = &world.status;
    let measured = [status.escape_ratio, status.total_counters().max_overlap, status.last_max_overlap];
    field(Buffer::Status, "overlaps and escapes", measured.map(f32::from_bits).to_vec());
    all
}

fn words(world: &World) -> Vec<(Buffer, &'static str, Vec<u32>)> {
    let tags = world.aabbs.iter().flat_map(|aabb| [aabb.id, aabb.tag]).collect();
    let head = world.lists[..world.step.entries_at as usize].to_vec();
    let lists = entries(world).into_iter().map(|entry| entry.word).collect();
    // Which workgroup counted what may differ between devices.
    let mut counters = [Counters::default(); COUNTER_BLOCKS as usize];
    counters[0] = Counters { max_overlap: 0, ..world.status.total_counters() };
    let counters = Status { counters, escape_ratio: 0, last_max_overlap: 0, ..world.status };
    vec![
        (Buffer::Aabbs, "ids and tags", tags),
        (Buffer::Topology, "words", world.topology.clone()),
        (Buffer::DispatchSizes, "sizes", world.dispatch_sizes.clone()),
        (Buffer::Cells, "cells", world.cells.clone()),
        (Buffer::Lists, "counts and offsets", head),
        (Buffer::Lists, "entries", lists),
        (Buffer::Status, "counters", bytemuck::cast_slice(bytemuck::bytes_of(&counters)).to_vec()),
    ]
}

/// A buffer, and what in it differs.
pub(crate) struct Difference {
    pub(crate) buffer: Buffer,
    pub(crate) text: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} {}", self.buffer, self.text)
    }
}

/// The first dozen, a line each.
pub(crate) fn listed(differences: &[Difference]) -> String {
    let lines: Vec<String> = differences.iter().take(12).map(ToString::to_string).collect();
    format!("{} differences:\n{}", differences.len(), lines.join("\n"))
}

/// States and orientations to the last bit, for stages that move words about.
fn bits(world: &World) -> Vec<(Buffer, &'static str, Vec<u32>)> {
    let raw = |vectors: &[Vec4]| bytemuck::cast_slice(vectors).to_vec();
    let states = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4].into_iter().zip(&world.states);
    let states = states.map(|(buffer, state)| (buffer, "bits", raw(state)));
    states.chain([(Buffer::Orientations, "bits", raw(&world.orientations))]).collect()
}

fn different_words(one: &World, other: &World) -> Vec<Difference> {
    different(words(one), words(other))
}

/// The first difference of each field.
fn different(one: Vec<(Buffer, &'static str, Vec<u32>)>, other: Vec<(Buffer, &'static str, Vec<u32>)>) -> Vec<Difference> {
    let mut all = Vec::new();
    for ((buffer, what, one), (.., other)) in one.into_iter().zip(other) {
        if one.len() != other.len() {
            let text = format!("{what}: {} or {} of them", one.len(), other.len());
            all.push(Difference { buffer, text });
        } else if let Some(at) = (0..one.len()).find(|at| one[*at] != other[*at]) {
            let text = format!("{what}[{at}]: {:x} or {:x}", one[at], other[at]);
            all.push(Difference { buffer, text });
        }
    }
    all
}

/// The world with everything that a stage may read moved by about a rounding error.
fn shaken(world: &World, seed: u64) -> World {
    let mut world = world.clone();
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut shake = |vector: &mut Vec4| {
        let size = SHAKE * vector.truncate().abs().max_element();
        let offset = [0; 3].map(|_| rng.random_range(-1.0_f32..1.0));
        *vector += (size * Vec3::from_array(offset)).extend(0.0);
    };
    world.states.iter_mut().flatten().for_each(&mut shake);
    world.wrenches.iter_mut().for_each(&mut shake);
    world.orientations.iter_mut().for_each(&mut shake);
    world
}

/// Everything in which `gpu` differs from what the CPU twins make of the world that the stages began with.
///
/// # Panics
/// When a stage decides otherwise where its input is off by no more than rounding.
pub(crate) fn differences(runs: &[Run], before: &World, gpu: &World, tolerance: Tolerance) -> Vec<Difference> {
    let name = runs[0].stage.name;
    let after = |mut world: World| {
        runs.iter().for_each(|run| run.on_cpu(&mut world));
        canonical(&world, name)
    };
    let gpu = &canonical(gpu, name);
    let cpu = after(before.clone());
    let mut all = different_words(gpu, &cpu);
    if MOVES.contains(&name) {
        all.extend(different(bits(gpu), bits(&cpu)));
        return all;
    }
    let shaken: Vec<Vec<Floats>> = (0..tolerance.shaken)
        .map(|seed| {
            let world = after(shaken(before, seed));
            let wavering = different_words(&world, &cpu);
            assert!(wavering.is_empty(), "{name}: rounding decides: {}", listed(&wavering));
            floats(&world)
        })
        .collect();
    let unchanged = floats(before);
    for (place, (gpu, cpu)) in floats(gpu).iter().zip(floats(&cpu)).enumerate() {
        let finite = cpu.values.iter().filter(|value| value.is_finite());
        let floor = tolerance.floor * finite.fold(0.0_f32, |most, value| most.max(value.abs()));
        for (at, (g, c)) in gpu.values.iter().zip(&cpu.values).enumerate() {
            let moved = shaken.iter().map(|shaken| (shaken[place].values[at] - c).abs());
            let allowed = floor + FACTOR * moved.fold(0.0, f32::max);
            // So written that what is not a number differs; but keys that are sorted stand here too, and one may look like that.
            let near = (g - c).abs() <= allowed;
            let is_left = [g, c].map(|x| x.to_bits()) == [unchanged[place].values[at].to_bits(); 2];
            if !(near || is_left) {
                let text = format!("{}[{at}]: GPU {g}, CPU {c}, tolerance {allowed}", cpu.what);
                all.push(Difference { buffer: cpu.buffer, text });
            }
        }
    }
    all
}
