//! Compares the results of both backends after a stage, or after a group of stages, field by field.
//!
//! Words must be equal. A float may differ by the effect of rounding. Both backends evaluate the same formula from the same
//! input but in a different order of operations, which has the same effect as an error of a few units in the last place of the
//! input. Therefore the CPU also runs the stage from inputs that are perturbed by this amount. A float may differ by [`FACTOR`]
//! times its largest change under these perturbations, plus [`Tolerance::floor`] times the largest value of its field. This
//! allows for badly conditioned values, such as the normal of two rods whose axes almost intersect.
//!
//! Every perturbed world must give the same words, which shows that rounding changes no decision.

use std::ops::Range;

use glam::{Vec3, Vec4};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::model::buffer::Buffer;
use rockfall::model::layout::{HISTORY_BLOCK, HISTORY_WORDS, LINK_KEY, NO_KEY, RIGID_ROWS, RIGID_WORDS, UNBOUNDED, WALL_WORDS};
use rockfall::model::status::{COUNTER_BLOCKS, Counters, Status};
use rockfall::model::step::Layout;
use rockfall::model::world::World;
use rockfall::step::schedule::Run;

use crate::decisions::entries;
use crate::order::canonical;
use crate::verdicts::Key;

/// Allowed difference of a float, in units of its largest change under perturbations.
const FACTOR: f32 = 8.0;
/// Largest perturbation, relative to the largest component of a vector: about two units in the last place.
const PERTURBATION: f32 = 2.5e-7;

/// Allowed difference between the backends.
#[derive(Clone, Copy)]
pub(crate) struct Tolerance {
    /// Difference that is always allowed, relative to the largest value of a field.
    pub(crate) floor: f32,
    /// Number of perturbed worlds that estimate the effect of rounding.
    pub(crate) perturbations: u64,
}

/// For worlds without ambiguous decisions: about ten units in the last place, and the measured effect of perturbations.
pub(crate) const MEASURED: Tolerance = Tolerance { floor: 1e-6, perturbations: 6 };
/// For worlds in which rules for exact values decide, such as two spheres in one point. A perturbation would break the rule.
pub(crate) const BY_RULE: Tolerance = Tolerance { floor: 3e-5, perturbations: 0 };

/// Stages that only move words. Some of these words are not floats, so they must be bitwise identical.
const MOVES: [&str; 5] = ["key_spheres", "count_digits", "scatter_digits", "permute_spheres", "settle_spheres"];

/// The vectors of a rigid body.
const BODY_ROWS: [&str; RIGID_ROWS as usize] = [
    "position",
    "low part",
    "velocity",
    "angular momentum",
    "orientation",
    "residues: low part",
    "residues after the drift",
    "velocity of the stage state",
    "angular momentum of the stage state",
    "orientation of the stage state",
    "position of the stage state",
    "its low part",
];

struct Floats {
    buffer: Buffer,
    what: &'static str,
    values: Vec<f32>,
}

fn flat(vectors: &[Vec4]) -> Vec<f32> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

/// Keys and springs of all movers before and after the step. The keys of a mover end with [`NO_KEY`].
pub(crate) fn springs(world: &World) -> Vec<(u32, [f32; HISTORY_WORDS as usize - 1])> {
    let (words, blocks) = (HISTORY_WORDS as usize, world.step.history_table_blocks() as usize);
    let mut all = Vec::new();
    for table in world.histories.chunks_exact((blocks * HISTORY_BLOCK as usize * words).max(1)) {
        let records: Vec<&[u32]> = table.chunks_exact(words).collect();
        for mover in 0..world.movers() {
            let mut rest = records[(mover * HISTORY_BLOCK) as usize..].iter().take(HISTORY_BLOCK as usize);
            while let Some(record) = rest.next().filter(|record| record[words - 1] != NO_KEY) {
                let key = record[words - 1];
                if key & LINK_KEY == 0 {
                    all.push((key, std::array::from_fn(|k| f32::from_bits(record[k]))));
                } else {
                    // The block may be another one on the other backend.
                    let next = (key & !LINK_KEY) * HISTORY_BLOCK;
                    rest = records[next as usize..].iter().take(HISTORY_BLOCK as usize);
                }
            }
            all.push((NO_KEY, [0.0; 7]));
        }
    }
    all
}

fn floats(world: &World) -> Vec<Floats> {
    let mut all = Vec::new();
    let mut field = |buffer, what, values| all.push(Floats { buffer, what, values });
    let n = world.step.layout.spheres as usize;
    let states = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4];
    for (buffer, state) in states.into_iter().zip(&world.states) {
        // Low parts are compared in double.rs.
        for (what, region) in ["position", "velocity", "angular momentum"].into_iter().zip(state.chunks(n)) {
            field(buffer, what, flat(region));
        }
    }
    let synchronised = flat(world.states[0].get(4 * n..).unwrap_or_default());
    field(Buffer::Start, "velocity at the time of the positions", synchronised);
    let bounds = world.aabbs.iter().flat_map(|aabb| [aabb.min, aabb.max].concat()).collect();
    field(Buffer::Aabbs, "bounds", bounds);
    field(Buffer::Extents, "extents", flat(&world.extents));
    for (place, what) in ["force 1", "torque 1", "force 2", "torque 2"].into_iter().enumerate() {
        let own: Vec<Vec4> = world.wrenches.iter().skip(place).step_by(4).copied().collect();
        field(Buffer::Wrenches, what, flat(&own));
    }
    field(Buffer::Histories, "springs", springs(world).into_iter().flat_map(|(_, spring)| spring).collect());
    field(Buffer::Rates, "rates", world.rates.clone());
    // Low parts are compared in double.rs.
    for (place, what) in BODY_ROWS.into_iter().enumerate().filter(|(_, what)| !what.ends_with("low part")) {
        let own: Vec<Vec4> = world.rigid_bodies.iter().skip(place).step_by(RIGID_ROWS as usize).copied().collect();
        field(Buffer::RigidBodies, what, flat(&own));
    }
    for (place, what) in ["displacement", "axis and target"].into_iter().enumerate() {
        let own: Vec<Vec4> = world.servos.iter().skip(place).step_by(4).copied().collect();
        // Low parts are below the error of the displacement.
        field(
            Buffer::Servos,
            what,
            flat(&own).into_iter().enumerate().filter(|(k, _)| k % 4 != 1 || place > 0).map(|(_, x)| x).collect(),
        );
    }
    field(Buffer::ServoLoads, "forces", world.servo_loads.iter().map(|load| load.x).collect());
    field(Buffer::ServoLoads, "stiffnesses", world.servo_loads.iter().map(|load| load.y).collect());
    if !world.servos.is_empty() {
        field(Buffer::Poses, "poses", world.poses.clone());
    }
    field(Buffer::Topology, "floats", floats_of_topology(world));
    field(Buffer::Orientations, "quaternion", flat(&world.orientations));
    let status = &world.status;
    let measured = [status.escape_ratio, status.repeat_escape, status.total_counters().max_overlap, status.last_max_overlap];
    field(Buffer::Status, "overlaps and escapes", measured.map(f32::from_bits).to_vec());
    all
}

/// The words of the topology buffer that stages write as floats: the sizes of free accelerations, the centres, tensors and orientations of rigid bodies, and
/// where walls move, the geometry of boxes and polygons and their motions. The numbers of bodies among them are denormal floats.
fn float_words(world: &World) -> Vec<Range<usize>> {
    let Layout { free_at, spheres, boxes_at, walls_at, boxes, polygons, rigid_bodies, rigid_at, .. } = world.step.layout;
    let free = free_at..free_at + if free_at == 0 { 0 } else { spheres };
    let walls = boxes_at..if walls_at == 0 { boxes_at } else { walls_at + (boxes + polygons) * WALL_WORDS };
    let bodies = (0..rigid_bodies).map(|body| rigid_at + body * RIGID_WORDS).flat_map(|at| [at..at + 10, at + 14..at + 18]);
    [free, walls].into_iter().chain(bodies).map(|range| range.start as usize..range.end as usize).collect()
}

fn floats_of_topology(world: &World) -> Vec<f32> {
    float_words(world).into_iter().flat_map(|range| &world.topology[range]).copied().map(f32::from_bits).collect()
}

/// The topology buffer with zeros in place of them.
fn words_of_topology(world: &World) -> Vec<u32> {
    let mut words = world.topology.clone();
    float_words(world).into_iter().for_each(|range| words[range].fill(0));
    words
}

fn words(world: &World) -> Vec<(Buffer, &'static str, Vec<u32>)> {
    let tags = world.aabbs.iter().flat_map(|aabb| [aabb.id, aabb.tag]).collect();
    let head = world.lists[..world.step.layout.entries_at as usize].to_vec();
    let lists = entries(world).into_iter().map(|entry| entry.word).collect();
    // The workgroup that counts an event may differ between devices, so only the sums are compared.
    let mut counters = [Counters::default(); COUNTER_BLOCKS as usize];
    counters[0] = Counters { max_overlap: 0, ..world.status.total_counters() };
    let counters = Status { counters, escape_ratio: 0, repeat_escape: 0, last_max_overlap: 0, ..world.status };
    vec![
        (Buffer::Aabbs, "ids and tags", tags),
        (Buffer::Topology, "words", words_of_topology(world)),
        (Buffer::Cells, "cells", world.cells.clone()),
        (Buffer::Lists, "counts and offsets", head),
        (Buffer::Lists, "entries", lists),
        (Buffer::Histories, "keys", springs(world).into_iter().map(|(key, _)| key).collect()),
        (Buffer::Status, "counters", bytemuck::cast_slice(bytemuck::bytes_of(&counters)).to_vec()),
    ]
}

/// A difference between the backends in one buffer.
pub(crate) struct Difference {
    pub(crate) buffer: Buffer,
    pub(crate) text: String,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} {}", self.buffer, self.text)
    }
}

/// Lists the number of differences and the first twelve of them, one per line.
pub(crate) fn listed(differences: &[Difference]) -> String {
    let lines: Vec<String> = differences.iter().take(12).map(ToString::to_string).collect();
    format!("{} differences:\n{}", differences.len(), lines.join("\n"))
}

/// Bits of all states and orientations, for stages that only move words.
fn bits(world: &World) -> Vec<(Buffer, &'static str, Vec<u32>)> {
    let raw = |vectors: &[Vec4]| bytemuck::cast_slice(vectors).to_vec();
    let states = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4].into_iter().zip(&world.states);
    let states = states.map(|(buffer, state)| (buffer, "bits", raw(state)));
    states.chain([(Buffer::Orientations, "bits", raw(&world.orientations))]).collect()
}

fn different_words(one: &World, other: &World) -> Vec<Difference> {
    different(words(one), words(other))
}

/// Returns the first difference of each field.
fn different(one: Vec<(Buffer, &'static str, Vec<u32>)>, other: Vec<(Buffer, &'static str, Vec<u32>)>) -> Vec<Difference> {
    let mut all = Vec::new();
    for ((buffer, what, one), (.., other)) in one.into_iter().zip(other) {
        if one.len() != other.len() {
            let text = format!("{what}: lengths {} and {}", one.len(), other.len());
            all.push(Difference { buffer, text });
        } else if let Some(at) = (0..one.len()).find(|at| one[*at] != other[*at]) {
            let text = format!("{what}[{at}]: {:x} and {:x}", one[at], other[at]);
            all.push(Difference { buffer, text });
        }
    }
    all
}

/// Returns the world with all states, wrenches and orientations changed by about a rounding error.
fn perturbed(world: &World, seed: u64) -> World {
    let mut world = world.clone();
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut perturb = |vector: &mut Vec4| {
        let size = PERTURBATION * vector.truncate().abs().max_element();
        let offset = [0; 3].map(|_| rng.random_range(-1.0_f32..1.0));
        *vector += (size * Vec3::from_array(offset)).extend(0.0);
    };
    world.states.iter_mut().flatten().for_each(&mut perturb);
    world.wrenches.iter_mut().for_each(&mut perturb);
    world.orientations.iter_mut().for_each(&mut perturb);
    for rates in world.rates.chunks_exact_mut(3) {
        let mut vector = Vec3::from_slice(rates).extend(0.0);
        perturb(&mut vector);
        vector.truncate().write_to_slice(rates);
    }
    world
}

/// What the CPU computes: the world after the stages, and its floats after each perturbation of the input.
struct Expected {
    cpu: World,
    perturbed: Vec<Vec<Floats>>,
}

fn expected(runs: &[Run], before: &World, tolerance: Tolerance) -> Expected {
    let name = runs[0].stage.name;
    let after = |mut world: World| {
        runs.iter().for_each(|run| run.on_cpu(&mut world));
        canonical(&world, name)
    };
    let cpu = after(before.clone());
    let perturbations = if MOVES.contains(&name) { 0 } else { tolerance.perturbations };
    let perturbed = |seed| {
        let world = after(perturbed(before, seed));
        let changed = different_words(&world, &cpu);
        assert!(changed.is_empty(), "{name}: rounding changes a decision: {}", listed(&changed));
        floats(&world)
    };
    let perturbed = (0..perturbations).map(perturbed).collect();
    Expected { cpu, perturbed }
}

/// Adds to a key all that [`differences`] compares the world of the device with.
pub(crate) fn add_expected(key: &mut Key, runs: &[Run], before: &World, tolerance: Tolerance) {
    let Expected { cpu, perturbed } = expected(runs, before, tolerance);
    for (_, _, words) in words(&cpu).into_iter().chain(bits(&cpu)) {
        key.add(bytemuck::cast_slice(&words));
    }
    for field in perturbed.iter().flatten().chain(&floats(&cpu)) {
        key.add(bytemuck::cast_slice(&field.values));
    }
}

/// Runs stages on the CPU and returns all differences between the result and `gpu`. `before` is the world before the stages,
/// and `gpu` the world after the GPU has run them.
///
/// # Panics
/// Panics if a perturbation of the input by about a rounding error changes a word.
pub(crate) fn differences(runs: &[Run], before: &World, gpu: &World, tolerance: Tolerance) -> Vec<Difference> {
    let name = runs[0].stage.name;
    let gpu = &canonical(gpu, name);
    let Expected { cpu, perturbed } = expected(runs, before, tolerance);
    let mut all = different_words(gpu, &cpu);
    if MOVES.contains(&name) {
        all.extend(different(bits(gpu), bits(&cpu)));
        return all;
    }
    let unchanged = floats(before);
    for (place, (gpu, cpu)) in floats(gpu).iter().zip(floats(&cpu)).enumerate() {
        // The bounds of a plane, which has no ends, say nothing about the errors of others.
        let finite = cpu.values.iter().filter(|value| value.abs() < 0.5 * UNBOUNDED);
        let floor = tolerance.floor * finite.fold(0.0_f32, |most, value| most.max(value.abs()));
        for (at, (g, c)) in gpu.values.iter().zip(&cpu.values).enumerate() {
            let changes = perturbed.iter().map(|perturbed| (perturbed[place].values[at] - c).abs());
            let allowed = floor + FACTOR * changes.fold(0.0, f32::max);
            // False for NaN, so NaN counts as a difference. Some words here are sort keys and can have the bits of a NaN, so
            // words that neither backend has changed are accepted.
            let is_near = (g - c).abs() <= allowed;
            // A load that is not finite stops the sphere, whether it is an infinity or NaN.
            let stops = cpu.buffer == Buffer::Wrenches && !g.is_finite() && !c.is_finite();
            // There may be more springs than before.
            let old = unchanged[place].values.get(at).map(|value| value.to_bits());
            let is_unchanged = [g, c].iter().all(|value| Some(value.to_bits()) == old);
            if !(is_near || is_unchanged || stops) {
                let text = format!("{}[{at}]: GPU {g}, CPU {c}, tolerance {allowed}", cpu.what);
                all.push(Difference { buffer: cpu.buffer, text });
            }
        }
    }
    all
}
