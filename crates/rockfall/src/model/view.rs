//! Read access to a world: its objects, with the spheres in one stage state, and what is attached to the spheres.

use glam::{Vec3, Vec4};

use crate::fine::Fine;
use crate::model::layout::{
    BOX_WORDS, FORCE_WORDS, KIND_ROD, KIND_SHIFT, MATERIAL_SHIFT, MUSCLE_WORDS, NO_NETWORK, PAIR_WORDS, POLYGON_WORDS,
    ROD_WORDS, SPRING_WORDS, TETHER_WORDS,
};
use crate::model::muscles::{half_steps, muscle_length};
use crate::model::period::Periods;
use crate::model::status::Status;
use crate::model::step::{Layout, Step};
use crate::scene::Surface;
use crate::user_laws::forces::ForceLaws;
use crate::user_laws::set::UserLaws;
use crate::user_laws::{ContactForceLaw, ForceInput, MOST_PARAMETERS};

mod rigid;
mod walls;

pub(crate) use rigid::RigidRecord;
pub(crate) use walls::Wall;

/// A squared distance up to this counts as zero (docs/physics section 2.3).
pub(crate) const TINY: f32 = 1e-30;

/// The kind of an object, with its index within that kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    Sphere(u32),
    Rod(u32),
    Cuboid(u32),
    Polygon(u32),
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct RodRecord {
    pub(crate) ends: [u32; 2],
    pub(crate) radius: f32,
    /// Fixed length; `<= 0` when the length is free.
    pub(crate) length: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SpringRecord {
    pub(crate) ends: [u32; 2],
    pub(crate) stiffness: f32,
    pub(crate) length: f32,
    pub(crate) damping: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct TetherRecord {
    pub(crate) point: Vec3,
    pub(crate) stiffness: f32,
    pub(crate) length: f32,
    pub(crate) damping: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxRecord {
    pub(crate) corner: Vec3,
    pub(crate) edges: [Vec3; 3],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonRecord {
    pub(crate) corner: Vec3,
    pub(crate) left: Vec3,
    pub(crate) right: Vec3,
    pub(crate) surface: Surface,
}

/// Something attached to a sphere: a rod, spring, tether or external force. Decoded from one adjacency word.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attachment {
    pub(crate) kind: u32,
    pub(crate) index: u32,
}

/// The objects, with the spheres in one stage state.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) step: &'a Step,
    topology: &'a [u32],
    /// Insertion index of the sphere in each memory slot; empty when slots and insertion indices are the same.
    insertion_indices: &'a [u32],
    /// Position and radius, velocity and inverse mass, angular momentum and inverse inertia of every sphere.
    rows: [&'a [Vec4]; 3],
    /// Low parts of the positions; empty in a state without them.
    lows: &'a [Vec4],
    /// Velocities and inverse masses as the integrators have them.
    velocities: &'a [Vec4],
    /// Velocities at the time of the positions; empty in a state without them.
    synchronised: &'a [Vec4],
    /// The regions from [`RESIDUE_REGION`] on; empty in a state without them.
    residues: &'a [Vec4],
    /// Half steps since the base of the muscles' clock.
    half_steps: u32,
    /// The laws that the program gave.
    user_laws: Option<&'a UserLaws>,
    /// Index of the force evaluation.
    evaluation: u32,
}

impl<'a> View<'a> {
    pub(crate) fn new(step: &'a Step, topology: &'a [u32], state: &'a [Vec4]) -> Self {
        let spheres = step.layout.spheres as usize;
        let insertion_indices = if step.layout.insertion_indices_at == 0 {
            &[]
        } else {
            &topology[step.layout.insertion_indices_at as usize..][..spheres]
        };
        let (positions, rest) = state.split_at(spheres);
        let (velocities, rest) = rest.split_at(spheres);
        let (spins, rest) = rest.split_at(spheres);
        let (lows, rest) = rest.split_at(rest.len().min(spheres));
        let (fifth, residues) = rest.split_at(rest.len().min(spheres));
        let synchronised = if step.is_half_step() { fifth } else { &[] };
        let rows = [positions, velocities, spins];
        Self {
            step,
            topology,
            insertion_indices,
            rows,
            lows,
            velocities,
            synchronised,
            residues,
            half_steps: 0,
            evaluation: 0,
            user_laws: None,
        }
    }

    /// The view of the phase of collisions, with velocities at the time of the positions (docs/physics section 5.2).
    pub(crate) fn in_collisions(self) -> Self {
        let [positions, velocities, spins] = self.rows;
        let velocities = if self.synchronised.is_empty() { velocities } else { self.synchronised };
        Self { rows: [positions, velocities, spins], ..self }
    }

    /// Size of the acceleration of an object by everything but contacts, in units/s², as `synchronise` found it. For a rod, the greater
    /// one of its ends. 0 for boxes and polygons, unless nothing but gravity acts in the scene.
    pub(crate) fn free_acceleration(&self, object: Object) -> f32 {
        if self.step.layout.free_at == 0 {
            return self.step.constants.gravity_size;
        }
        let of = |sphere: u32| f32::from_bits(self.topology[(self.step.layout.free_at + sphere) as usize]);
        match object {
            Object::Sphere(sphere) => of(sphere),
            Object::Rod(rod) => self.rod(rod).ends.map(of).into_iter().fold(0.0, f32::max),
            Object::Cuboid(_) | Object::Polygon(_) => 0.0,
        }
    }

    /// The view at the time of a force evaluation of the step, which the rest lengths of muscles depend on.
    pub(crate) fn at_evaluation(self, status: &Status, evaluation: u32) -> Self {
        Self { half_steps: half_steps(self.step, status, evaluation), evaluation, ..self }
    }

    /// The time by which the evaluation advances the springs of contacts, in s. It is 0 for the evaluation at the start of a step of
    /// velocity Verlet, because the one at the end of the step before has advanced them.
    pub(crate) fn spring_time(&self) -> f32 {
        if self.evaluation == self.step.counted_pass() { self.step.constants.dt } else { 0.0 }
    }

    /// The view with the laws that the program gave.
    pub(crate) fn with_laws(self, laws: &'a UserLaws) -> Self {
        Self { user_laws: (!laws.is_empty()).then_some(laws), ..self }
    }

    /// The force laws that the program gave, if there are any.
    pub(crate) fn force_laws(&self) -> Option<&'a ForceLaws> {
        self.user_laws.map(|laws| &laws.forces)
    }

    /// The contact law that the program gave, and the values of its parameters for two objects.
    pub(crate) fn contact_law(&self, a: u32, b: u32) -> Option<(&'a ContactForceLaw, [f32; MOST_PARAMETERS])> {
        let laws = self.user_laws?;
        let law = laws.contact.as_ref()?;
        let [one, other] = [a, b].map(|id| self.tag(id) >> MATERIAL_SHIFT);
        let at = self.step.layout.laws_at + laws.contact_values_at(one * self.step.layout.materials + other);
        let mut values = [0.0; MOST_PARAMETERS];
        let words = &self.topology[at as usize..][..law.parameters().len()];
        values.iter_mut().zip(words).for_each(|(value, word)| *value = f32::from_bits(*word));
        Some((law, values))
    }

    /// What a law reads of a moving sphere.
    pub(crate) fn force_input(&self, sphere: u32) -> ForceInput<'static> {
        ForceInput {
            position: self.position(sphere),
            velocity: self.velocity(sphere),
            angular_velocity: self.spin(sphere),
            mass: 1.0 / self.inverse_mass(sphere),
            radius: self.radius(sphere),
            time: (0.5 * self.step.constants.dt).mul_add(self.half_steps as f32, self.step.constants.time_base),
            parameters: &[],
        }
    }

    fn row(&self, region: usize, sphere: u32) -> Vec4 {
        self.rows[region][sphere as usize]
    }

    /// Returns the insertion index of an object. Results that must not depend on the order of memory use it.
    pub(crate) fn insertion_index(&self, id: u32) -> u32 {
        self.insertion_indices.get(id as usize).copied().unwrap_or(id)
    }

    /// Whether a sphere belongs to this process, where several share a scene.
    pub(crate) fn is_own(&self, sphere: u32) -> bool {
        let at = self.step.layout.own_at;
        let index = self.insertion_index(sphere);
        at == 0 || self.topology[(at + index / u32::BITS) as usize] >> (index % u32::BITS) & 1 != 0
    }

    /// Returns two objects in insertion order.
    pub(crate) fn ordered(&self, a: u32, b: u32) -> (u32, u32) {
        if self.insertion_index(a) < self.insertion_index(b) { (a, b) } else { (b, a) }
    }

    /// Position and radius of a sphere.
    pub(crate) fn place(&self, sphere: u32) -> Vec4 {
        self.row(0, sphere)
    }

    /// Velocity and inverse mass of a sphere.
    pub(crate) fn motion(&self, sphere: u32) -> Vec4 {
        self.row(1, sphere)
    }

    /// Angular momentum and inverse inertia of a sphere.
    pub(crate) fn rotation(&self, sphere: u32) -> Vec4 {
        self.row(2, sphere)
    }

    pub(crate) fn position(&self, sphere: u32) -> Vec3 {
        self.row(0, sphere).truncate()
    }

    /// The low part of a position, 0 in a state without them.
    pub(crate) fn position_low(&self, sphere: u32) -> Vec3 {
        self.lows.get(sphere as usize).map_or(Vec3::ZERO, |low| low.truncate())
    }

    /// The residues of a sphere, if velocities have residues.
    pub(crate) fn residues(&self, sphere: u32) -> Option<Vec4> {
        self.step.has_residues().then(|| self.residues.get(sphere as usize).copied().unwrap_or_default())
    }

    /// In a stage state of RK4, the increments of the velocity and the angular momentum of a sphere up to this state.
    pub(crate) fn increments(&self, sphere: u32) -> [Vec3; 2] {
        let spheres = self.step.layout.spheres;
        [sphere, spheres + sphere].map(|place| self.residues[place as usize].truncate())
    }

    /// The position with its low part.
    pub(crate) fn fine(&self, sphere: u32) -> Fine {
        Fine { high: self.position(sphere), low: self.position_low(sphere) }
    }

    /// The position as geometry uses it: with its low part only with double precision.
    pub(crate) fn precise(&self, sphere: u32) -> Fine {
        if self.step.is_double() { self.fine(sphere) } else { Fine { high: self.position(sphere), low: Vec3::ZERO } }
    }

    /// The vector from a point to the centre of a sphere.
    pub(crate) fn point_to_centre(&self, point: Vec3, sphere: u32) -> Vec3 {
        if self.step.is_double() {
            self.fine(sphere).minus(Fine { high: point, low: Vec3::ZERO })
        } else {
            self.position(sphere) - point
        }
    }

    /// The vector from the centre of one sphere to that of another.
    pub(crate) fn apart(&self, from: u32, to: u32) -> Vec3 {
        if self.step.is_double() { self.fine(to).minus(self.fine(from)) } else { self.position(to) - self.position(from) }
    }

    /// The vector from the centre of one sphere to the nearest image of that of another (docs/physics section 2.14).
    pub(crate) fn between(&self, from: u32, to: u32) -> Vec3 {
        match Periods::of(self.step) {
            None => self.apart(from, to),
            Some(periods) => periods.nearest(self.fine(to).wide() - self.fine(from).wide()).as_vec3(),
        }
    }

    pub(crate) fn radius(&self, sphere: u32) -> f32 {
        self.row(0, sphere).w
    }

    pub(crate) fn velocity(&self, sphere: u32) -> Vec3 {
        self.row(1, sphere).truncate()
    }

    /// 1 / m, 0 for a fixed sphere.
    pub(crate) fn inverse_mass(&self, sphere: u32) -> f32 {
        self.row(1, sphere).w
    }

    pub(crate) fn is_fixed(&self, sphere: u32) -> bool {
        self.inverse_mass(sphere) == 0.0
    }

    pub(crate) fn angular_momentum(&self, sphere: u32) -> Vec3 {
        self.row(2, sphere).truncate()
    }

    /// 1 / I, positive also for a fixed sphere, whose surface may move.
    pub(crate) fn inverse_inertia(&self, sphere: u32) -> f32 {
        self.row(2, sphere).w
    }

    /// Angular velocity L / I. For a fixed sphere, it is the spin of its surface.
    pub(crate) fn spin(&self, sphere: u32) -> Vec3 {
        let row = self.row(2, sphere);
        row.truncate() * row.w
    }

    /// 1 / I, 0 for a fixed sphere.
    pub(crate) fn mobility(&self, sphere: u32) -> f32 {
        if self.is_fixed(sphere) { 0.0 } else { self.inverse_inertia(sphere) }
    }

    /// Velocity of the sphere's centre: 0 for a fixed sphere, whose `velocity` is that of its surface.
    pub(crate) fn own_velocity(&self, sphere: u32) -> Vec3 {
        if self.is_fixed(sphere) { Vec3::ZERO } else { self.velocity(sphere) }
    }

    /// The velocity that integrators have after the phase of collisions has changed that at the time of the positions.
    pub(crate) fn own_velocity_after(&self, sphere: u32, after: Vec3) -> Vec3 {
        if self.synchronised.is_empty() {
            return after;
        }
        self.velocities[sphere as usize].truncate() + (after - self.velocity(sphere))
    }

    /// Angular velocity of the sphere itself: 0 for a fixed sphere, whose `spin` is that of its surface.
    pub(crate) fn own_spin(&self, sphere: u32) -> Vec3 {
        if self.is_fixed(sphere) { Vec3::ZERO } else { self.spin(sphere) }
    }

    pub(crate) fn object(&self, id: u32) -> Object {
        let Layout { spheres, rods, boxes, .. } = self.step.layout;
        match id {
            _ if id < spheres => Object::Sphere(id),
            _ if id < spheres + rods => Object::Rod(id - spheres),
            _ if id < spheres + rods + boxes => Object::Cuboid(id - spheres - rods),
            _ => Object::Polygon(id - spheres - rods - boxes),
        }
    }

    fn record<const N: usize>(&self, at: u32, index: u32, words: u32) -> [u32; N] {
        let first = (at + index * words) as usize;
        std::array::from_fn(|k| self.topology[first + k])
    }

    fn floats<const N: usize>(&self, at: u32, index: u32, words: u32) -> [f32; N] {
        self.record::<N>(at, index, words).map(f32::from_bits)
    }

    pub(crate) fn rod(&self, rod: u32) -> RodRecord {
        let [end1, end2, radius, length] = self.record(self.step.layout.rods_at, rod, ROD_WORDS);
        RodRecord { ends: [end1, end2], radius: f32::from_bits(radius), length: f32::from_bits(length) }
    }

    /// The record of a spring's muscle, in scenes with muscles.
    pub(crate) fn muscle(&self, spring: u32) -> [u32; MUSCLE_WORDS as usize] {
        self.record(self.step.layout.muscles_at, spring, MUSCLE_WORDS)
    }

    /// Half steps since the base of the muscles' clock.
    pub(crate) fn half_steps(&self) -> u32 {
        self.half_steps
    }

    /// A spring without its muscle.
    pub(crate) fn plain_spring(&self, spring: u32) -> SpringRecord {
        let [a, b, k, l, c] = self.record(self.step.layout.springs_at, spring, SPRING_WORDS);
        SpringRecord { ends: [a, b], stiffness: f32::from_bits(k), length: f32::from_bits(l), damping: f32::from_bits(c) }
    }

    /// A spring. The length is that at the time of the view.
    pub(crate) fn spring(&self, spring: u32) -> SpringRecord {
        let mut record = self.plain_spring(spring);
        if self.step.layout.muscles_at != 0 {
            record.length = muscle_length(self.muscle(spring), record.length, self.half_steps);
        }
        record
    }

    pub(crate) fn tether(&self, tether: u32) -> TetherRecord {
        let [_, x, y, z, stiffness, length, damping] = self.floats(self.step.layout.tethers_at, tether, TETHER_WORDS);
        TetherRecord { point: Vec3::new(x, y, z), stiffness, length, damping }
    }

    pub(crate) fn external_force(&self, force: u32) -> Vec3 {
        Vec3::from_array(self.floats(self.step.layout.forces_at, force, FORCE_WORDS))
    }

    pub(crate) fn cuboid(&self, cuboid: u32) -> BoxRecord {
        let [px, py, pz, ix, iy, iz, jx, jy, jz, kx, ky, kz] = self.floats(self.step.layout.boxes_at, cuboid, BOX_WORDS);
        BoxRecord {
            corner: Vec3::new(px, py, pz),
            edges: [Vec3::new(ix, iy, iz), Vec3::new(jx, jy, jz), Vec3::new(kx, ky, kz)],
        }
    }

    pub(crate) fn polygon(&self, polygon: u32) -> PolygonRecord {
        let [px, py, pz, lx, ly, lz, rx, ry, rz, kind] = self.floats(self.step.layout.polygons_at, polygon, POLYGON_WORDS);
        let (corner, left, right) = (Vec3::new(px, py, pz), Vec3::new(lx, ly, lz), Vec3::new(rx, ry, rz));
        PolygonRecord { corner, left, right, surface: Surface::of_number(kind.to_bits()).unwrap_or_default() }
    }

    /// Group (low 16 bits) and material (high 16 bits) of an object.
    pub(crate) fn tag(&self, id: u32) -> u32 {
        self.topology[(self.step.layout.tags_at + id) as usize]
    }

    /// The row of the materials of two objects in the table of pairs; `None` without a table.
    pub(crate) fn pair(&self, a: u32, b: u32) -> Option<[f32; PAIR_WORDS as usize]> {
        let Layout { materials, pairs_at, .. } = self.step.layout;
        let [one, other] = [a, b].map(|id| self.tag(id) >> MATERIAL_SHIFT);
        (materials > 0).then(|| self.floats(pairs_at, one * materials + other, PAIR_WORDS))
    }

    /// Everything that is attached to a sphere, rods first.
    pub(crate) fn attachments(&self, sphere: u32) -> impl Iterator<Item = Attachment> + Clone + use<'a> {
        let at = self.step.layout.adjacency_at;
        let range = if at == 0 {
            0..0
        } else {
            let offset = (at + 2 * sphere) as usize;
            self.topology[offset] as usize..self.topology[offset + 1] as usize
        };
        self.topology[range].iter().map(|word| Attachment { kind: word >> KIND_SHIFT, index: word & ((1 << KIND_SHIFT) - 1) })
    }

    /// The rods that end in a sphere.
    pub(crate) fn rods_of(&self, sphere: u32) -> impl Iterator<Item = u32> + Clone + use<'a> {
        self.attachments(sphere).take_while(|attachment| attachment.kind == KIND_ROD).map(|attachment| attachment.index)
    }

    /// Whether an object is a sphere in which no rod ends.
    pub(crate) fn is_ball(&self, id: u32) -> bool {
        id < self.step.layout.spheres && self.rods_of(id).next().is_none()
    }

    /// The rod of the rigid capsule that has this sphere as an end, if there is one (docs/physics section 1.4).
    pub(crate) fn capsule_of(&self, sphere: u32) -> Option<u32> {
        let mut rods = self.rods_of(sphere);
        let rod = rods.next()?;
        (rods.next().is_none() && self.is_capsule(rod)).then_some(rod)
    }

    /// Whether a rod is the rod of a rigid capsule: it has a fixed length, both its ends move and have no other rod, and their
    /// centres do not coincide.
    pub(crate) fn is_capsule(&self, rod: u32) -> bool {
        let RodRecord { ends: [one, two], length, .. } = self.rod(rod);
        let is_end = |sphere: u32| self.rods_of(sphere).nth(1).is_none() && !self.is_fixed(sphere);
        length > 0.0 && is_end(one) && is_end(two) && self.position(one).distance_squared(self.position(two)) > TINY
    }

    /// The network that a rod belongs to, if any.
    pub(crate) fn network_of(&self, rod: u32) -> Option<u32> {
        let network = self.topology[(self.step.layout.networks_at - self.step.layout.rods + rod) as usize];
        (network != NO_NETWORK).then_some(network)
    }

    /// The moving spheres and the rods of a network.
    pub(crate) fn network(&self, network: u32) -> (impl ExactSizeIterator<Item = u32> + Clone + use<'a>, &'a [u32]) {
        let topology = self.topology;
        let first = topology[(self.step.layout.networks_at + network) as usize] as usize;
        let (spheres, rods) = (topology[first] as usize, topology[first + 1] as usize);
        let (spheres, rest) = topology[first + 2..].split_at(spheres);
        let view = *self;
        (spheres.iter().map(move |place| view.rod(place / 2).ends[(place % 2) as usize]), &rest[..rods])
    }
}
