//! The room that a small world takes in workgroup memory.

use crate::model::layout::{BOX_WORDS, FLAG_COLLISIONS, LAW_THESIS, MUSCLE_WORDS, SPRING_WORDS};
use crate::model::world::World;

/// Room for a world in the kernel `run_worlds`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct WorldSizes {
    /// Spheres: at most one per thread.
    pub(crate) spheres: u32,
    /// Entries of a list.
    pub(crate) entries: u32,
    /// Words of topology.
    pub(crate) topology: u32,
}

impl WorldSizes {
    /// The largest room, with which the kernel takes less than 16 KiB of workgroup memory.
    pub const MOST: Self = Self { spheres: 32, entries: 36, topology: 896 };

    /// Spheres of a body for which there is room, together with [`WorldSizes::BODY_MUSCLES`] and [`WorldSizes::BODY_BOXES`].
    pub(crate) const BODY_SPHERES: usize = 20;

    /// Static boxes beside a body.
    pub(crate) const BODY_BOXES: usize = 5;

    /// Springs with muscles of such a body: as many as there is room for.
    pub(crate) const BODY_MUSCLES: usize = {
        // The tag of an object, the range of a sphere in the adjacency, and the two ends of a spring there.
        let (tag, range, ends) = (1, 2, 2);
        let of_spheres = (tag + range) * Self::BODY_SPHERES;
        let of_boxes = (tag + BOX_WORDS as usize) * Self::BODY_BOXES;
        (Self::MOST.topology as usize - of_spheres - of_boxes) / (SPRING_WORDS + MUSCLE_WORDS + ends) as usize
    };

    /// The room that a world needs, rounded up so that worlds of similar size share a kernel; `None` if the kernel cannot run it.
    pub(crate) fn of(world: &World) -> Option<Self> {
        let step = &world.step;
        let needed = Self {
            spheres: step.spheres.next_multiple_of(4),
            entries: world.objects().next_multiple_of(4),
            topology: (world.topology.len() as u32).next_multiple_of(32),
        };
        let room = needed.min(Self::MOST);
        // A sphere is not in its own list.
        let fits = world.objects() <= room.entries + 1 && room.holds(&Self { entries: 0, ..needed });
        let has_impulses = step.flags & FLAG_COLLISIONS != 0 || step.has_friction_impulses();
        let is_plain = step.rods == 0
            && step.large == 0
            && step.materials == 0
            && step.law == LAW_THESIS
            && step.insertion_indices_at == 0;
        (fits && step.spheres > 0 && is_plain && !has_impulses).then_some(room)
    }

    /// Whether there is room for a world that needs this much.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        self.spheres >= other.spheres && self.entries >= other.entries && self.topology >= other.topology
    }

    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            spheres: self.spheres.max(other.spheres),
            entries: self.entries.max(other.entries),
            topology: self.topology.max(other.topology),
        }
    }

    fn min(self, other: Self) -> Self {
        Self {
            spheres: self.spheres.min(other.spheres),
            entries: self.entries.min(other.entries),
            topology: self.topology.min(other.topology),
        }
    }

    /// The WGSL of the kernel with this room.
    pub(crate) fn apply(&self, text: &str) -> String {
        let Self { spheres, entries, topology } = Self::MOST;
        let with = |text: String, name: &str, most: u32, room: u32| {
            text.replace(&format!("const {name}: u32 = {most}u;"), &format!("const {name}: u32 = {room}u;"))
        };
        let text = with(text.to_owned(), "WORLD_SPHERES", spheres, self.spheres);
        let text = with(text, "WORLD_ENTRIES", entries, self.entries);
        with(text, "WORLD_TOPOLOGY", topology, self.topology)
    }
}
