//! The room that a small world takes in workgroup memory.

use crate::model::layout::{BOX_WORDS, GROUP_MASK, LAW_THESIS, MUSCLE_WORDS, SPRING_WORDS};
use crate::model::world::World;
use crate::settings::Integrator;

/// Room for a world in the kernel `run_worlds`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct WorldSizes {
    /// Spheres: at most one per thread.
    pub(crate) spheres: u32,
    /// Springs.
    pub(crate) springs: u32,
    /// Words of topology.
    pub(crate) topology: u32,
    /// Whether two spheres of a world may touch. Without such worlds the kernel has no code for pairs of spheres.
    pub(crate) pairs: bool,
}

impl WorldSizes {
    /// The largest room, with which the kernel takes less than 5 KiB of workgroup memory. The topology is in device memory.
    pub const MOST: Self = Self { spheres: 32, springs: 128, topology: 2304, pairs: true };

    /// Room for bodies of the greatest size.
    pub const BODIES: Self = Self { spheres: Self::BODY_SPHERES as u32, springs: Self::BODY_MUSCLES as u32, ..Self::MOST };

    /// Most objects of a world: the kernel has a bit for each.
    const OBJECTS: u32 = 64;

    /// Spheres of a body for which there is room, together with [`WorldSizes::BODY_MUSCLES`] and [`WorldSizes::BODY_BOXES`].
    pub(crate) const BODY_SPHERES: usize = 20;

    /// Static boxes beside a body: as many as there are bits for.
    pub(crate) const BODY_BOXES: usize = Self::OBJECTS as usize - Self::BODY_SPHERES;

    /// Springs with muscles of such a body.
    pub(crate) const BODY_MUSCLES: usize = 64;

    /// The room that a world needs, rounded up so that worlds of similar size share a kernel; `None` if the kernel cannot run it.
    pub(crate) fn of(world: &World) -> Option<Self> {
        let (step, traits) = (&world.step, world.step.traits());
        let needed = Self {
            spheres: step.layout.spheres.next_multiple_of(4),
            springs: step.spring_count().next_multiple_of(4),
            topology: (world.topology.len() as u32).next_multiple_of(32),
            pairs: has_pairs(world),
        };
        let room = needed.min(Self::MOST);
        let fits = world.objects() <= Self::OBJECTS && room.holds(&needed);
        let has_impulses = traits.collisions || traits.friction_impulses;
        let is_plain = traits.law == LAW_THESIS
            && traits.integrator != Integrator::VelocityVerlet
            && !(traits.double
                || traits.residues
                || traits.rods
                || traits.large
                || traits.materials
                || traits.walls
                || traits.periodic
                || traits.rigid
                || traits.triangles
                || traits.smooth)
            && traits.in_insertion_order;
        (fits && traits.spheres > 0 && is_plain && !has_impulses).then_some(room)
    }

    /// The same room for worlds in which no two spheres may touch.
    pub(crate) fn without_pairs(self) -> Self {
        Self { pairs: false, ..self }
    }

    /// Whether there is room for a world that needs this much. Pairs of spheres take no room.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.spheres >= other.spheres && self.springs >= other.springs && self.topology >= other.topology
    }

    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            spheres: self.spheres.max(other.spheres),
            springs: self.springs.max(other.springs),
            topology: self.topology.max(other.topology),
            pairs: self.pairs || other.pairs,
        }
    }

    fn min(self, other: Self) -> Self {
        Self {
            spheres: self.spheres.min(other.spheres),
            springs: self.springs.min(other.springs),
            topology: self.topology.min(other.topology),
            pairs: self.pairs && other.pairs,
        }
    }

    /// The WGSL of the kernel with this room.
    pub(crate) fn apply(&self, text: &str) -> String {
        let Self { spheres, springs, topology, .. } = Self::MOST;
        let with = |text: String, name: &str, most: u32, room: u32| {
            text.replace(&format!("const {name}: u32 = {most}u;"), &format!("const {name}: u32 = {room}u;"))
        };
        let text = with(text.to_owned(), "WORLD_SPHERES", spheres, self.spheres);
        // WGSL has no empty arrays.
        let text = with(text, "WORLD_SPRINGS", springs, self.springs.max(1));
        let text = with(text, "WORLD_TOPOLOGY", topology, self.topology);
        text.replace("const SPHERE_PAIRS: bool = true;", &format!("const SPHERE_PAIRS: bool = {};", self.pairs))
    }
}

/// A body of the greatest size fits.
const _: () = {
    // The tag of an object, the range of a sphere in the adjacency, and the two ends of a spring there.
    let (tag, range, ends) = (1, 2, 2);
    let of_spheres = (tag + range) * WorldSizes::BODY_SPHERES;
    let of_boxes = (tag + BOX_WORDS as usize) * WorldSizes::BODY_BOXES;
    let of_springs = (SPRING_WORDS + MUSCLE_WORDS + ends) as usize * WorldSizes::BODY_MUSCLES;
    assert!(of_spheres + of_boxes + of_springs <= WorldSizes::MOST.topology as usize);
    assert!(WorldSizes::BODY_MUSCLES <= WorldSizes::MOST.springs as usize);
};

/// Whether two spheres of a world are in the same group.
fn has_pairs(world: &World) -> bool {
    let tags = &world.topology[world.step.layout.tags_at as usize..][..world.step.layout.spheres as usize];
    let mut groups: Vec<u32> = tags.iter().map(|tag| tag & GROUP_MASK).collect();
    groups.sort_unstable();
    groups.windows(2).any(|pair| pair[0] == pair[1])
}

#[cfg(feature = "gpu")]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{creature, creature_without_pairs};
    use crate::options::{Backend, Options};
    use crate::simulation::Simulation;

    #[test]
    fn only_worlds_with_pairs_need_code_for_pairs() {
        let sizes = [creature, creature_without_pairs].map(|generate| {
            let scene = generate(20, 1).expect("a creature");
            let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
            WorldSizes::of(simulation.packed(0.005).expect("arrays")).expect("there is room")
        });
        assert_eq!(sizes.map(|sizes| sizes.pairs), [true, false]);
        let text = include_str!("../step/fused/world_contacts.wgsl");
        let constant = |sizes: WorldSizes| sizes.apply(text).contains("const SPHERE_PAIRS: bool = true;");
        assert_eq!(sizes.map(constant), [true, false]);
        assert!(sizes[0].max(sizes[1]).pairs && !sizes[0].without_pairs().pairs && sizes[1].holds(&sizes[1].without_pairs()));
    }
}
