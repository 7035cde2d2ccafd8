//! Reading a world: spheres at one stage state, and what is attached to them.

use glam::{Vec3, Vec4};

use crate::model::layout::{
    BOX_WORDS, FORCE_WORDS, KIND_ROD, KIND_SHIFT, NO_NETWORK, POLYGON_WORDS, ROD_WORDS, SPRING_WORDS, TETHER_WORDS,
};
use crate::model::step::Step;

/// A squared distance up to this counts as zero.
pub(crate) const TINY: f32 = 1e-30;

/// The kind of an object id, with its index within the kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Object {
    Sphere(u32),
    Rod(u32),
    Cuboid(u32),
    Polygon(u32),
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct RodWords {
    pub(crate) ends: [u32; 2],
    pub(crate) radius: f32,
    /// `<= 0`: free.
    pub(crate) length: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct SpringWords {
    pub(crate) ends: [u32; 2],
    pub(crate) stiffness: f32,
    pub(crate) length: f32,
    pub(crate) damping: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct TetherWords {
    pub(crate) point: Vec3,
    pub(crate) stiffness: f32,
    pub(crate) length: f32,
    pub(crate) damping: f32,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxWords {
    pub(crate) corner: Vec3,
    pub(crate) edges: [Vec3; 3],
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PolygonWords {
    pub(crate) corner: Vec3,
    pub(crate) left: Vec3,
    pub(crate) right: Vec3,
}

/// What hangs on a sphere: one adjacency word.
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
    /// Index in order of addition of the sphere in each memory slot; empty: they are the same.
    users: &'a [u32],
    /// Position and radius, velocity and inverse mass, angular momentum and inverse inertia of every sphere.
    rows: [&'a [Vec4]; 3],
}

impl<'a> View<'a> {
    pub(crate) fn new(step: &'a Step, topology: &'a [u32], state: &'a [Vec4]) -> Self {
        let spheres = step.spheres as usize;
        let users =
            if step.insertion_indices_at == 0 { &[] } else { &topology[step.insertion_indices_at as usize..][..spheres] };
        let (positions, rest) = state.split_at(spheres);
        let (velocities, spins) = rest.split_at(spheres);
        Self { step, topology, users, rows: [positions, velocities, spins] }
    }

    fn row(&self, region: usize, sphere: u32) -> Vec4 {
        self.rows[region][sphere as usize]
    }

    /// Index of an object in order of addition. Whatever must not depend on the order of memory goes by it.
    pub(crate) fn user(&self, id: u32) -> u32 {
        self.users.get(id as usize).copied().unwrap_or(id)
    }

    /// Two objects, the one that was added first before the other.
    pub(crate) fn ordered(&self, a: u32, b: u32) -> (u32, u32) {
        if self.user(a) < self.user(b) { (a, b) } else { (b, a) }
    }

    /// Position and radius.
    pub(crate) fn place(&self, sphere: u32) -> Vec4 {
        self.row(0, sphere)
    }

    /// Velocity and inverse mass.
    pub(crate) fn motion(&self, sphere: u32) -> Vec4 {
        self.row(1, sphere)
    }

    /// Angular momentum and inverse inertia.
    pub(crate) fn rotation(&self, sphere: u32) -> Vec4 {
        self.row(2, sphere)
    }

    pub(crate) fn position(&self, sphere: u32) -> Vec3 {
        self.row(0, sphere).truncate()
    }

    pub(crate) fn radius(&self, sphere: u32) -> f32 {
        self.row(0, sphere).w
    }

    pub(crate) fn velocity(&self, sphere: u32) -> Vec3 {
        self.row(1, sphere).truncate()
    }

    /// 0 for a fixed sphere.
    pub(crate) fn inverse_mass(&self, sphere: u32) -> f32 {
        self.row(1, sphere).w
    }

    pub(crate) fn is_fixed(&self, sphere: u32) -> bool {
        self.inverse_mass(sphere) == 0.0
    }

    pub(crate) fn angular_momentum(&self, sphere: u32) -> Vec3 {
        self.row(2, sphere).truncate()
    }

    /// 1 / I, of a fixed sphere too.
    pub(crate) fn inverse_inertia(&self, sphere: u32) -> f32 {
        self.row(2, sphere).w
    }

    /// Angular velocity L / I, of a fixed sphere too.
    pub(crate) fn spin(&self, sphere: u32) -> Vec3 {
        let row = self.row(2, sphere);
        row.truncate() * row.w
    }

    /// 1 / I, 0 for a fixed sphere.
    pub(crate) fn mobility(&self, sphere: u32) -> f32 {
        if self.is_fixed(sphere) { 0.0 } else { self.inverse_inertia(sphere) }
    }

    /// The velocity of the sphere's middle. What is given of a fixed sphere is the velocity of its surface; it is at rest itself.
    pub(crate) fn own_velocity(&self, sphere: u32) -> Vec3 {
        if self.is_fixed(sphere) { Vec3::ZERO } else { self.velocity(sphere) }
    }

    /// The same for the angular velocity.
    pub(crate) fn own_spin(&self, sphere: u32) -> Vec3 {
        if self.is_fixed(sphere) { Vec3::ZERO } else { self.spin(sphere) }
    }

    pub(crate) fn object(&self, id: u32) -> Object {
        let Step { spheres, rods, boxes, .. } = *self.step;
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

    pub(crate) fn rod(&self, rod: u32) -> RodWords {
        let [end1, end2, radius, length] = self.record(self.step.rods_at, rod, ROD_WORDS);
        RodWords { ends: [end1, end2], radius: f32::from_bits(radius), length: f32::from_bits(length) }
    }

    pub(crate) fn spring(&self, spring: u32) -> SpringWords {
        let [a, b, k, l, c] = self.record(self.step.springs_at, spring, SPRING_WORDS);
        SpringWords { ends: [a, b], stiffness: f32::from_bits(k), length: f32::from_bits(l), damping: f32::from_bits(c) }
    }

    pub(crate) fn tether(&self, tether: u32) -> TetherWords {
        let [_, x, y, z, stiffness, length, damping] = self.floats(self.step.tethers_at, tether, TETHER_WORDS);
        TetherWords { point: Vec3::new(x, y, z), stiffness, length, damping }
    }

    pub(crate) fn external_force(&self, force: u32) -> Vec3 {
        Vec3::from_array(self.floats(self.step.forces_at, force, FORCE_WORDS))
    }

    pub(crate) fn cuboid(&self, cuboid: u32) -> BoxWords {
        let [px, py, pz, ix, iy, iz, jx, jy, jz, kx, ky, kz] = self.floats(self.step.boxes_at, cuboid, BOX_WORDS);
        BoxWords { corner: Vec3::new(px, py, pz), edges: [Vec3::new(ix, iy, iz), Vec3::new(jx, jy, jz), Vec3::new(kx, ky, kz)] }
    }

    pub(crate) fn polygon(&self, polygon: u32) -> PolygonWords {
        let [px, py, pz, lx, ly, lz, rx, ry, rz] = self.floats(self.step.polygons_at, polygon, POLYGON_WORDS);
        PolygonWords { corner: Vec3::new(px, py, pz), left: Vec3::new(lx, ly, lz), right: Vec3::new(rx, ry, rz) }
    }

    /// Group (low 16 bits) and material (high 16 bits) of an object.
    pub(crate) fn tag(&self, id: u32) -> u32 {
        self.topology[(self.step.tags_at + id) as usize]
    }

    /// Everything attached to a sphere, its rods first.
    pub(crate) fn attachments(&self, sphere: u32) -> impl Iterator<Item = Attachment> + Clone + use<'a> {
        let at = self.step.adjacency_at;
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

    /// Whether an object is a sphere that no rod ends in.
    pub(crate) fn is_ball(&self, id: u32) -> bool {
        id < self.step.spheres && self.rods_of(id).next().is_none()
    }

    /// The rod of the rigid capsule that a sphere is an end of: two moving spheres apart from each other, each with this one rod, of
    /// fixed length.
    pub(crate) fn capsule_of(&self, sphere: u32) -> Option<u32> {
        let mut rods = self.rods_of(sphere);
        let rod = rods.next()?;
        (rods.next().is_none() && self.is_capsule(rod)).then_some(rod)
    }

    /// Whether a rod is that of a rigid capsule.
    pub(crate) fn is_capsule(&self, rod: u32) -> bool {
        let RodWords { ends: [one, two], length, .. } = self.rod(rod);
        let is_end = |sphere: u32| self.rods_of(sphere).nth(1).is_none() && !self.is_fixed(sphere);
        length > 0.0 && is_end(one) && is_end(two) && self.position(one).distance_squared(self.position(two)) > TINY
    }

    /// The network that a rod belongs to.
    pub(crate) fn network_of(&self, rod: u32) -> Option<u32> {
        let network = self.topology[(self.step.networks_at - self.step.rods + rod) as usize];
        (network != NO_NETWORK).then_some(network)
    }

    /// The moving spheres of a network, and its rods.
    pub(crate) fn network(&self, network: u32) -> (impl ExactSizeIterator<Item = u32> + Clone + use<'a>, &'a [u32]) {
        let topology = self.topology;
        let first = topology[(self.step.networks_at + network) as usize] as usize;
        let (spheres, rods) = (topology[first] as usize, topology[first + 1] as usize);
        let (spheres, rest) = topology[first + 2..].split_at(spheres);
        let view = *self;
        (spheres.iter().map(move |place| view.rod(place / 2).ends[(place % 2) as usize]), &rest[..rods])
    }
}
