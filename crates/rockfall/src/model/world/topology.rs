//! Packs the topology buffer: rods, springs, tethers, external forces, muscles, parameters of laws, boxes, polygons, their motions, tags,
//! pairs of materials, the order of memory, batches and networks of fixed-length rods, and what is attached to each sphere.

use glam::Vec3;

use crate::error::{Error, Result};
use crate::model::layout::{
    FLAG_COHESION, FLAG_GROUPS, FLAG_PAIR_FRICTION, FLAG_PERIODIC, FLAG_RESISTANCE, FLAG_SHEARED, FLAG_SMOOTH, FLAG_TRIANGLES,
    GROUP_MASK, KIND_FORCE, KIND_ROD, KIND_SHIFT, KIND_SPRING, KIND_TETHER, LINE, MATERIAL_SHIFT, MUSCLE_WORDS, NO_NETWORK,
    NO_ROD, ROD_WORDS, SOME_RODS, WALL_BODY, WALL_SURFACE, WALL_WORDS, max_objects,
};
#[cfg(not(target_family = "wasm"))]
use crate::model::layout::{LENGTH_WORD, SPRING_WORDS};
use crate::model::step::Layout;
use crate::model::world::World;
use crate::model::world::build::in_order;
use crate::model::world::frames::{batches, networks};
use crate::model::world::order::inverse;
use crate::model::world::rigid::pack_bodies;
use crate::scene::{Dampings, Pair, Scene, SphereId, Surface};

impl World {
    /// Packs everything but the state of the spheres: the topology buffer, and the counts and offsets of the uniform block.
    ///
    /// # Errors
    /// [`Error::TooManyObjects`] for more objects than list entries can number.
    pub fn set_topology(&mut self, scene: &Scene) -> Result<()> {
        let counts = scene.counts();
        let objects = counts.spheres + counts.rods + counts.boxes + counts.polygons;
        let attached = counts.springs + counts.tethers;
        let limit = max_objects(counts.rods > 0) as usize;
        if objects > limit || attached > limit {
            return Err(Error::TooManyObjects { count: objects.max(attached), limit });
        }
        let slots = inverse(&self.order);
        let index = |id: SphereId| slot_of(scene, &slots, id);
        let mut adjacency = Adjacency::default();
        let mut topology = Vec::new();
        let layout = &mut self.step.layout;
        layout.law = scene.contact_law().number();
        layout.spheres = counts.spheres as u32;
        layout.rods = counts.rods as u32;
        layout.boxes = counts.boxes as u32;
        layout.polygons = counts.polygons as u32;

        layout.rods_at = topology.len() as u32;
        let mut fixed_rods = Vec::new();
        for ((id, rod), number) in scene.rod_ids().zip(scene.rods()).zip(0..) {
            let ends = [index(rod.end1)?, index(rod.end2)?];
            // Implied bodies keep the lengths of their rods.
            let length = rod.length.filter(|_| scene.implied_of_rod(id).is_none());
            topology.extend([ends[0], ends[1], rod.radius.to_bits(), length.unwrap_or(0.0).to_bits()]);
            adjacency.attach(KIND_ROD, number, &ends);
            if length.is_some() {
                fixed_rods.push((number, ends));
            }
        }
        pack_attachments(scene, &slots, layout, &mut topology, &mut adjacency)?;
        pack_forces(scene, &slots, self.has_force_on_each, layout, &mut topology, &mut adjacency);
        pack_muscles(scene, layout, &mut topology);
        let has_forces = topology.len() as u32 > layout.springs_at || !self.user_laws.forces.is_empty();
        layout.free_at = if has_forces { topology.len() as u32 } else { 0 };
        topology.resize(topology.len() + if has_forces { counts.spheres } else { 0 }, 0);
        layout.laws_at = topology.len() as u32;
        topology.extend(self.user_laws.values(&scene.material_names())?.iter().map(|value| value.to_bits()));
        let groups = pack_static(scene, &self.order, layout, &mut topology)?;
        let pairs = pack_pairs(scene, layout, &mut topology);
        pack_order(&self.order, &slots, layout, &mut topology);

        let fixed: Vec<bool> = in_order(scene, &self.order).map(|sphere| sphere.fixed).collect();
        let batches = batches(&fixed, &fixed_rods);
        layout.batches = batches.len() as u32;
        layout.batches_at = topology.len() as u32;
        push_batches(&mut topology, &batches);
        layout.ends_at = push_ends(layout, &mut topology);
        push_networks(layout, &fixed, &fixed_rods, &mut topology);
        layout.adjacency_at = adjacency.push(&mut topology, layout.spheres);
        self.topology = topology;
        self.pack_own();
        let servos = self.set_servos(scene);
        self.set_flags_of_scene(groups | pairs | servos);
        self.set_sweeps(self.step.constants.sweeps);
        let clock = self.muscles_for.take().unwrap_or_default();
        self.set_muscles(scene, &clock);
        Ok(())
    }
}

fn slot_of(scene: &Scene, slots: &[u32], id: SphereId) -> Result<u32> {
    let index = scene.spheres.index(id)?;
    Ok(slots.get(index).copied().unwrap_or(index as u32))
}

/// Appends the insertion index of every slot and the slot of every insertion index, unless spheres are in insertion order.
fn pack_order(order: &[u32], slots: &[u32], layout: &mut Layout, topology: &mut Vec<u32>) {
    (layout.insertion_indices_at, layout.slots_at) = (0, 0);
    let mut append = |table: &[u32]| {
        topology.resize(topology.len().next_multiple_of(LINE as usize), 0);
        topology.extend(table);
        (topology.len() - table.len()) as u32
    };
    if !order.is_empty() {
        (layout.insertion_indices_at, layout.slots_at) = (append(order), append(slots));
    }
}

impl World {
    /// Says which spheres belong to this process, by insertion index, none for all of them, and which ones are computed early.
    pub(crate) fn set_own(&mut self, own: Vec<bool>, sent: Vec<u32>) {
        (self.own, self.sent) = (own, sent);
        self.pack_own();
    }

    /// Appends a bit per sphere for [`World::set_own`], and the spheres that are computed early.
    fn pack_own(&mut self) {
        self.step.layout.own_at = if self.own.is_empty() { 0 } else { self.topology.len() as u32 };
        let word = |own: &[bool]| (0..).zip(own).fold(0, |word, (bit, is_own)| word | u32::from(*is_own) << bit);
        self.topology.extend(self.own.chunks(u32::BITS as usize).map(word));
        (self.step.layout.sent, self.step.layout.sent_at) = (self.sent.len() as u32, self.topology.len() as u32);
        self.topology.extend(&self.sent);
    }
}

impl World {
    /// Writes the rest lengths of all springs, in order of addition, to the topology buffer.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn set_rest_lengths(&mut self, lengths: &[f32]) {
        let springs = self.topology[self.step.layout.springs_at as usize..].chunks_exact_mut(SPRING_WORDS as usize);
        springs.zip(lengths).for_each(|(spring, length)| spring[LENGTH_WORD] = length.to_bits());
    }
}

/// Appends springs and tethers.
fn pack_attachments(
    scene: &Scene,
    slots: &[u32],
    layout: &mut Layout,
    topology: &mut Vec<u32>,
    adjacency: &mut Adjacency,
) -> Result<()> {
    layout.springs_at = topology.len() as u32;
    for (spring, number) in scene.springs().iter().zip(0..) {
        let ends = [slot_of(scene, slots, spring.a)?, slot_of(scene, slots, spring.b)?];
        topology.extend(ends);
        topology.extend([spring.stiffness, spring.length, spring.damping].map(f32::to_bits));
        adjacency.attach(KIND_SPRING, number, &ends);
    }
    layout.tethers_at = topology.len() as u32;
    for (tether, number) in scene.tethers().iter().zip(0..) {
        let sphere = slot_of(scene, slots, tether.sphere)?;
        topology.push(sphere);
        push_vectors(topology, &[tether.point]);
        topology.extend([tether.stiffness, tether.length, tether.damping].map(f32::to_bits));
        adjacency.attach(KIND_TETHER, number, &[sphere]);
    }
    Ok(())
}

/// Appends an empty table of muscles, which [`World::set_muscles`] fills. It stands apart from the springs and tethers, because the
/// kernel that sorts memory takes what is between their offsets for records of one kind.
fn pack_muscles(scene: &Scene, layout: &mut Layout, topology: &mut Vec<u32>) {
    layout.muscles_at = 0;
    if scene.springs().iter().any(|spring| spring.muscle.is_some()) {
        layout.muscles_at = topology.len() as u32;
        topology.resize(topology.len() + scene.springs().len() * MUSCLE_WORDS as usize, 0);
    }
}

/// Appends external forces: of each sphere, or of those with a force.
fn pack_forces(
    scene: &Scene,
    slots: &[u32],
    on_each: bool,
    layout: &mut Layout,
    topology: &mut Vec<u32>,
    adjacency: &mut Adjacency,
) {
    layout.forces_at = topology.len() as u32;
    let pushed = scene.spheres().iter().zip(0..).filter(|(sphere, _)| on_each || sphere.force != Vec3::ZERO);
    for ((sphere, number), force) in pushed.zip(0..) {
        push_vectors(topology, &[sphere.force]);
        adjacency.attach(KIND_FORCE, force, &[slots.get(number as usize).copied().unwrap_or(number)]);
    }
}

/// Appends boxes, polygons, and the tags of all objects. Returns the flags of groups, triangles and periods.
fn pack_static(scene: &Scene, order: &[u32], layout: &mut Layout, topology: &mut Vec<u32>) -> Result<u32> {
    layout.boxes_at = topology.len() as u32;
    for cuboid in scene.boxes() {
        let [i, j, k] = cuboid.edges;
        push_vectors(topology, &[cuboid.corner, i, j, k]);
    }
    layout.polygons_at = topology.len() as u32;
    for polygon in scene.polygons() {
        push_vectors(topology, &[polygon.corner, polygon.left, polygon.right]);
        topology.push(polygon.surface.number());
    }
    pack_walls(scene, layout, topology)?;
    pack_bodies(scene, layout, topology)?;
    layout.tags_at = topology.len() as u32;
    let tags_at = topology.len();
    let spheres = in_order(scene, order).map(|sphere| (sphere.group, sphere.material));
    let rods = scene.rods().iter().map(|rod| (rod.group, rod.material));
    let boxes = scene.boxes().iter().map(|cuboid| (cuboid.group, cuboid.material));
    let polygons = scene.polygons().iter().map(|polygon| (polygon.group, polygon.material));
    for (group, material) in spheres.chain(rods).chain(boxes).chain(polygons) {
        topology.push(u32::from(group) | u32::from(scene.material_number(material)?) << MATERIAL_SHIFT);
    }
    let differ = topology[tags_at..].windows(2).any(|tags| (tags[0] ^ tags[1]) & GROUP_MASK != 0);
    let some = |is: fn(&Surface) -> bool| scene.polygons().iter().any(|polygon| is(&polygon.surface));
    let has_triangles = some(|surface| *surface == Surface::Triangle);
    let has_smooth = some(|surface| surface.is_smooth());
    let flag = |holds: bool, flag: u32| if holds { flag } else { 0 };
    Ok(flag(differ, FLAG_GROUPS)
        | flag(has_triangles, FLAG_TRIANGLES)
        | flag(has_smooth, FLAG_SMOOTH)
        | flag(pack_periods(scene, layout), FLAG_PERIODIC)
        | flag(scene.shear().is_some(), FLAG_SHEARED))
}

/// Writes the periods of the scene, and returns whether there are some.
fn pack_periods(scene: &Scene, layout: &mut Layout) -> bool {
    let boxes = scene.periodic().map(|bounds| bounds.map_or((0.0, 0.0), |[from, to]| (to - from, from)));
    [(layout.period_x, layout.from_x), (layout.period_y, layout.from_y), (layout.period_z, layout.from_z)] = boxes;
    layout.shear_speed = scene.shear_speed() as f32;
    layout.shear_axes = scene.shear().map_or(0, |shear| (shear.gradient + 4 * shear.flow) as u32);
    scene.is_periodic()
}

/// Appends the motions of boxes and polygons, and a copy of their geometry as it is written, if some of them or their surfaces move.
fn pack_walls(scene: &Scene, layout: &mut Layout, topology: &mut Vec<u32>) -> Result<()> {
    let boxes = scene.boxes().iter().map(|cuboid| (cuboid.motion, cuboid.surface_velocity));
    let walls = boxes.chain(scene.polygons().iter().map(|polygon| (polygon.motion, polygon.surface_velocity)));
    let walls =
        walls.map(|(motion, surface)| Ok((scene.body_number(motion)?, surface))).collect::<Result<Vec<(u32, Vec3)>>>()?;
    (layout.walls_at, layout.bodies) = (0, 0);
    if walls.iter().all(|wall| *wall == (0, Vec3::ZERO)) {
        return Ok(());
    }
    (layout.walls_at, layout.bodies) = (topology.len() as u32, scene.motions().len() as u32);
    let written = topology[layout.boxes_at as usize..].to_vec();
    for (body, surface) in walls {
        let mut record = [0; WALL_WORDS as usize];
        record[WALL_BODY] = body;
        record[WALL_SURFACE..WALL_SURFACE + 3].copy_from_slice(&surface.to_array().map(f32::to_bits));
        topology.extend(record);
    }
    topology.extend(written);
    Ok(())
}

/// Appends the table of pairs, unless no properties of pairs are given. Returns the flags of pairs.
fn pack_pairs(scene: &Scene, layout: &mut Layout, topology: &mut Vec<u32>) -> u32 {
    /// Stands for the constant of the scene.
    const OF_SCENE: f32 = -1.0;
    (layout.materials, layout.pairs_at) = (0, 0);
    // Rounded up, so that the AABBs hold every contact.
    layout.neck = (scene.neck() * (1.0 + 1e-5)) as f32;
    let law = scene.contact_law();
    if scene.pairs.is_empty() && !law.has_history() {
        return 0;
    }
    let mut flags = 0;
    let numbers = 0..=scene.materials().len() as u16;
    (layout.materials, layout.pairs_at) = (numbers.len() as u32, topology.len() as u32);
    let mut dampings = Dampings::default();
    for (one, other) in numbers.clone().flat_map(|one| numbers.clone().map(move |other| (one, other))) {
        let Pair { restitution, friction, .. } = scene.pair_of_numbers(one, other);
        // Coulomb friction replaces the friction force of the square-root law. It is part of the laws with history.
        let root = friction.map_or(OF_SCENE, |_| 0.0);
        let in_collisions = friction.unwrap_or(OF_SCENE);
        let in_contacts = if law.has_history() { 0.0 } else { in_collisions };
        topology.extend([restitution.unwrap_or(OF_SCENE), root, in_contacts, in_collisions].map(f32::to_bits));
        let constants = scene.law_constants(one, other, &mut dampings);
        topology.extend(constants.map(f32::to_bits));
        if constants[4] > 0.0 || constants[6] > 0.0 {
            flags |= FLAG_RESISTANCE;
        }
        if constants[7] != 0.0 {
            flags |= FLAG_COHESION;
        }
        if in_contacts > 0.0 || in_collisions > 0.0 && scene.settings.collisions {
            flags |= FLAG_PAIR_FRICTION;
        }
    }
    flags
}

fn push_vectors(topology: &mut Vec<u32>, vectors: &[Vec3]) {
    topology.extend(vectors.iter().flat_map(|vector| vector.to_array().map(f32::to_bits)));
}

fn push_batches(topology: &mut Vec<u32>, batches: &[Vec<Vec<u32>>]) {
    let table = topology.len();
    topology.resize(table + batches.len(), 0);
    for (place, colours) in batches.iter().enumerate() {
        topology[table + place] = topology.len() as u32;
        topology.push(colours.len() as u32);
        let mut at = (topology.len() + colours.len() + 1) as u32;
        topology.push(at);
        for colour in colours {
            at += colour.len() as u32;
            topology.push(at);
        }
        topology.extend(colours.iter().flatten());
    }
}

/// Appends the table of ends, one word per sphere (see [`Layout::ends_at`]). Returns its offset, 0 without rods.
fn push_ends(layout: &Layout, topology: &mut Vec<u32>) -> u32 {
    if layout.rods == 0 {
        return 0;
    }
    let mut ends = vec![NO_ROD; layout.spheres as usize];
    let rods = &topology[layout.rods_at as usize..][..(layout.rods * ROD_WORDS) as usize];
    for (rod, number) in rods.chunks_exact(ROD_WORDS as usize).zip(0..) {
        let is_fixed = f32::from_bits(rod[3]) > 0.0;
        for end in &rod[..2] {
            let known = &mut ends[*end as usize];
            *known = if *known == NO_ROD && is_fixed { number } else { SOME_RODS };
        }
    }
    let at = topology.len() as u32;
    topology.extend(ends);
    at
}

/// Appends the network of each rod and the network table (see [`Layout::networks_at`]). A fixed-length rod belongs to a rigid
/// capsule when both its ends move and have no other rod.
fn push_networks(layout: &mut Layout, fixed: &[bool], fixed_rods: &[(u32, [u32; 2])], topology: &mut Vec<u32>) {
    (layout.networks, layout.networks_at) = (0, 0);
    if layout.rods == 0 {
        return;
    }
    let ends_at = layout.ends_at as usize;
    let is_end = |end: u32, rod: u32| topology[ends_at + end as usize] == rod && !fixed[end as usize];
    let capsules: std::collections::HashSet<u32> =
        fixed_rods.iter().filter(|(rod, ends)| ends.iter().all(|end| is_end(*end, *rod))).map(|(rod, _)| *rod).collect();
    let networks = networks(fixed, fixed_rods, |rod| capsules.contains(&rod));
    let ends_of: std::collections::HashMap<u32, [u32; 2]> = fixed_rods.iter().copied().collect();
    let mut network_of = vec![NO_NETWORK; layout.rods as usize];
    for (number, rods) in networks.iter().enumerate() {
        rods.iter().for_each(|rod| network_of[*rod as usize] = number as u32);
    }
    topology.extend(network_of);
    (layout.networks, layout.networks_at) = (networks.len() as u32, topology.len() as u32);
    let table = topology.len();
    topology.resize(table + networks.len(), 0);
    for (place, rods) in networks.iter().enumerate() {
        topology[table + place] = topology.len() as u32;
        let mut seen = std::collections::HashSet::new();
        let ends = rods.iter().flat_map(|rod| ends_of[rod].into_iter().zip(0..).map(move |(end, side)| (end, 2 * rod + side)));
        let spheres: Vec<u32> =
            ends.filter(|(end, _)| !fixed[*end as usize] && seen.insert(*end)).map(|(_, place)| place).collect();
        topology.extend([spheres.len() as u32, rods.len() as u32]);
        topology.extend(spheres);
        topology.extend(rods);
    }
}

/// Pairs of (sphere, adjacency word).
#[derive(Default)]
struct Adjacency {
    pairs: Vec<(u32, u32)>,
}

impl Adjacency {
    fn attach(&mut self, kind: u32, index: u32, spheres: &[u32]) {
        self.pairs.extend(spheres.iter().map(|sphere| (*sphere, kind << KIND_SHIFT | index)));
    }

    /// Appends the range of every sphere, then the adjacency words. Returns the offset of the ranges, 0 when nothing is
    /// attached to any sphere.
    fn push(mut self, topology: &mut Vec<u32>, spheres: u32) -> u32 {
        if self.pairs.is_empty() {
            return 0;
        }
        self.pairs.sort_unstable();
        let at = topology.len() as u32;
        let first = at + 2 * spheres;
        let mut place = 0;
        for sphere in 0..spheres {
            topology.push(first + place as u32);
            while place < self.pairs.len() && self.pairs[place].0 == sphere {
                place += 1;
            }
            topology.push(first + place as u32);
        }
        topology.extend(self.pairs.iter().map(|(_, word)| *word));
        at
    }
}
