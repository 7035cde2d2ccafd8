//! How the worlds of a batch share the workgroups of a device.

use glam::Vec4;

use crate::model::status::{COUNTER_BLOCKS, Counters, Status};
use crate::model::step::Step;
use crate::model::world_sizes::WorldSizes;

/// From this number of worlds on, small ones share workgroups. Measured on a large GPU with worlds of 20 spheres: 2,048 of them gain
/// a little, and fewer are slower.
const MANY_WORLDS: u32 = 2048;
/// Bytes of workgroup memory for worlds that share a workgroup. With less, a device runs more workgroups at a time.
const GROUP_BYTES: u32 = 8448;

/// The worlds for which the kernel `run_worlds` is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct WorldBatch {
    /// Room for the largest world.
    pub sizes: WorldSizes,
    /// Whether small worlds share workgroups. Then nearly every thread has a sphere. Otherwise a world has more threads than spheres,
    /// all of which evaluate its springs.
    pub shared: bool,
}

impl WorldBatch {
    /// A batch of `count` worlds.
    pub(crate) fn new(sizes: WorldSizes, count: u32) -> Self {
        Self { sizes, shared: count >= MANY_WORLDS }
    }

    /// Worlds and threads of a workgroup. A world has 32 threads, or shares 32 or 64 with others and has one per sphere.
    pub(crate) fn group(&self) -> (u32, u32) {
        let WorldSizes { spheres, springs, .. } = self.sizes;
        let of_spheres = 3 * size_of::<Vec4>() as u32 * spheres;
        let of_springs = (size_of::<Vec4>() + size_of::<f32>()) as u32 * springs;
        // The status has one block of counters here.
        let status = size_of::<Status>() - (COUNTER_BLOCKS as usize - 1) * size_of::<Counters>();
        let world = of_spheres + of_springs + (size_of::<Step>() + status) as u32;
        let worlds = |threads: u32| (threads / spheres.max(1)).min(GROUP_BYTES / world);
        let [in_32, in_64] = [32, 64].map(worlds);
        if !self.shared || in_64 <= 1 {
            return (1, 32);
        }
        if in_64 > 2 * in_32 { (in_64, 64) } else { (in_32, 32) }
    }

    /// The WGSL of the kernel for these worlds.
    pub(crate) fn apply(&self, text: &str) -> String {
        let (worlds, threads) = self.group();
        self.sizes
            .apply(text)
            .replace("const GROUP_WORLDS: u32 = 1u;", &format!("const GROUP_WORLDS: u32 = {worlds}u;"))
            .replace("const GROUP_THREADS: u32 = 32u;", &format!("const GROUP_THREADS: u32 = {threads}u;"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worlds and threads of a workgroup for worlds of so many spheres and springs.
    fn group(count: u32, spheres: u32, springs: u32) -> (u32, u32) {
        WorldBatch::new(WorldSizes { spheres, springs, ..WorldSizes::MOST }, count).group()
    }

    #[test]
    fn worlds_share_workgroups_where_more_threads_get_a_sphere() {
        assert_eq!(group(2048, 4, 4), (8, 32));
        assert_eq!(group(2048, 8, 28), (4, 32));
        assert_eq!(group(2048, 12, 36), (2, 32));
        assert_eq!(group(2048, 16, 40), (2, 32));
        assert_eq!(group(2048, 20, 60), (3, 64));
        assert_eq!(WorldBatch::new(WorldSizes::BODIES, 10240).group(), (3, 64));
        // With one thread per sphere, 8 of 32 threads have none, as before.
        assert_eq!(group(2048, 24, 60), (1, 32));
        assert_eq!(group(2048, 32, 128), (1, 32));
        // Little room for springs.
        assert_eq!(group(2048, 4, 128), (2, 32));
    }

    #[test]
    fn few_worlds_have_workgroups_of_their_own() {
        assert_eq!(group(2047, 4, 4), (1, 32));
        assert_eq!(group(1, 20, 60), (1, 32));
    }
}
