//! Packs a scene into the arrays of a [`World`].

use glam::{Vec2, Vec4};

use crate::error::Result;
use crate::fine::Fine;
use crate::model::layout::{CELL_BLOCK, CELLS_AT, FEW_MOVERS, LEVEL_BIAS, LINE, SLICE, SUM_WORDS, SWEEPS_LISTED};
use crate::model::step::{ListSettings, Step};
use crate::model::world::World;
use crate::model::world::order::{size_class, spatial_order};
use crate::scene::{Rod, Scene, Sphere, SphereId};
use crate::settings::BroadPhase;
use crate::user_laws::set::UserLaws;
use crate::user_laws::{ContactForceLaw, ForceLaw};

/// Initial room for list entries per mover. Lists that need more grow.
const FIRST_ENTRIES: u32 = 16;
/// Initial room for list entries per mover when there are at most [`FEW_MOVERS`] movers.
const FIRST_ENTRIES_OF_FEW: u32 = 24;
/// Cell size per median radius. Cells are a little larger than the AABB of a sphere at rest, because moving spheres have larger
/// AABBs.
const CELL_PER_RADIUS: f32 = 2.4;
/// Cell size per radius that 98 % of the spheres do not exceed, used when radii differ little (see [`typical_cell`]).
const CELL_OF_ALL: f32 = 2.75;
/// Movers per collision record that is allocated at the start, in scenes that list collisions from the start.
const MOVERS_PER_COLLISION: u32 = 4;
/// Minimum number of collision records that are allocated at the start, in these scenes.
const MIN_COLLISION_ROOM: u32 = 128;
/// At most one in this number of spheres counts as large.
const SPHERES_PER_LARGE: u32 = 8;

impl World {
    /// Returns the world of a scene before its first step, with spheres in order of addition.
    ///
    /// # Errors
    /// [`Error::TooManyObjects`](crate::Error::TooManyObjects) for more objects than list entries can number.
    pub fn build(scene: &Scene) -> Result<Self> {
        Self::build_with(scene, UserLaws::default())
    }

    /// [`World::build`] with the laws that the program gave.
    pub(crate) fn build_with(scene: &Scene, laws: UserLaws) -> Result<Self> {
        Ok(Self::pack(scene, Vec::new(), laws)?.with_scratch())
    }

    /// Gives the world laws of a program, and packs their parameters.
    ///
    /// # Errors
    /// [`Error::Law`](crate::Error::Law) for a law that is not valid or that names a material that the scene does not have.
    pub fn set_laws(&mut self, scene: &Scene, forces: &[ForceLaw], contact: Option<&ContactForceLaw>) -> Result<()> {
        self.user_laws = UserLaws::new(forces, contact)?;
        self.set_topology(scene)
    }

    /// Like [`World::build`], but with spheres in spatial order. The grid broad phase allows this, because its lists are sorted
    /// by insertion index in any order of memory.
    ///
    /// # Errors
    /// As for [`World::build`].
    pub fn build_in_space(scene: &Scene) -> Result<Self> {
        Ok(Self::pack(scene, order_in_space(scene), UserLaws::default())?.with_scratch())
    }

    /// Like [`World::build`], but with spheres sorted by x, the order in which the sort-and-skip broad phase starts.
    ///
    /// # Errors
    /// As for [`World::build`].
    pub fn build_along_x(scene: &Scene) -> Result<Self> {
        Ok(Self::pack(scene, order_along_x(scene), UserLaws::default())?.with_scratch())
    }

    /// Returns the world in the order of memory that suits a broad phase, which is not `Auto`, without scratch arrays. Brute force
    /// needs insertion order.
    pub(crate) fn for_method(scene: &Scene, broad_phase: BroadPhase, laws: UserLaws) -> Result<Self> {
        let order = match broad_phase {
            BroadPhase::Grid => order_in_space(scene),
            BroadPhase::SortAndSkip => order_along_x(scene),
            _ => Vec::new(),
        };
        Self::pack(scene, order, laws)
    }

    fn pack(scene: &Scene, order: Vec<u32>, user_laws: UserLaws) -> Result<Self> {
        scene.check_periods()?;
        scene.check_bodies()?;
        let step = Step { lists: ListSettings::FIRST, ..Step::default() };
        let mut world = Self { step, order, user_laws, ..Self::default() };
        world.set_settings(&scene.settings);
        world.set_topology(scene)?;
        world.set_spheres(scene);
        world.set_grid(scene);
        // Spheres of rigid bodies have a thread each.
        world.step.layout.large = if world.step.layout.rigid_bodies == 0 { world.large_spheres(scene) } else { 0 };
        world.set_history_pool(0);
        world.set_collision_room();
        let entries = if world.movers() <= FEW_MOVERS { FIRST_ENTRIES_OF_FEW } else { FIRST_ENTRIES };
        world.set_pair_room((entries * world.movers().div_ceil(SLICE)).max(1));
        Ok(world)
    }

    /// Packs the state of the spheres and rigid bodies.
    pub fn set_spheres(&mut self, scene: &Scene) {
        let spheres = || in_order(scene, &self.order);
        let inverse = |mass: f32, fixed: bool| if fixed { 0.0 } else { 1.0 / mass };
        let centres: Vec<Fine> = spheres().map(|sphere| Fine::sum(sphere.position, sphere.position_low)).collect();
        let positions = spheres().zip(&centres).map(|(sphere, centre)| centre.high.extend(sphere.radius));
        let velocities = spheres().map(|sphere| sphere.velocity.extend(inverse(sphere.mass, sphere.fixed)));
        let spins = spheres().map(|sphere| sphere.angular_momentum.extend(1.0 / sphere.inertia()));
        let lows = centres.iter().map(|centre| centre.low.extend(0.0));
        self.states[0] = positions.chain(velocities).chain(spins).chain(lows).collect();
        let rows = self.rows_of_state(0);
        self.states[0].resize(rows, Vec4::ZERO);
        self.orientations = spheres().map(|sphere| sphere.orientation.into()).collect();
        self.set_bodies(scene);
    }

    /// Chooses the size and number of the grid's cells. Cells are a little larger than most spheres. The table has at least
    /// twice as many cells as objects, so that rows of cells seldom share places in the table.
    fn set_grid(&mut self, scene: &Scene) {
        (self.step.layout.cell_size, self.step.layout.least_level) = typical_cell(scene);
        self.step.layout.least_radius = least_radius(scene);
        self.place_cells(2 * self.objects(), has_long_movers(scene, self.step.layout.cell_size));
    }

    /// Gives room for collisions from the start when bodies may have long lists. Solves them by sweeps when there are networks.
    fn set_collision_room(&mut self) {
        if self.step.traits().has_long_lists() {
            self.set_collision_records((self.movers() / MOVERS_PER_COLLISION).max(MIN_COLLISION_ROOM));
        }
        self.set_sweeps(SWEEPS_LISTED);
    }

    /// Sets the number of collisions that there is room for. The device allocates it.
    pub(crate) fn set_collision_records(&mut self, records: u32) {
        self.step.layout.collision_room = records;
    }

    /// Gives large spheres no workgroups of their own.
    pub(crate) fn leave_out_large_spheres(&mut self) {
        self.step.layout.large = 0;
    }

    /// Number of large spheres at the end of memory. It is limited, because each of them gets a workgroup.
    fn large_spheres(&self, scene: &Scene) -> u32 {
        let from_last = (0..self.step.layout.spheres as usize).rev().map(|place| &scene.spheres()[self.insertion_index(place)]);
        let is_large = |sphere: &&Sphere| size_class(sphere.radius, self.step.layout.cell_size) > 0;
        from_last.take((self.step.layout.spheres / SPHERES_PER_LARGE) as usize).take_while(is_large).count() as u32
    }

    /// Allocates a grid table of at least `cells` cells. The contents of the table are lost.
    pub fn set_cells(&mut self, cells: u32) {
        self.place_cells(cells, self.step.layout.long_at != 0);
        self.resize_cells();
    }

    /// Gives up the room for long movers, so that one thread builds each list.
    pub(crate) fn leave_out_long_movers(&mut self) {
        self.place_cells(self.step.layout.cells, false);
    }

    fn resize_cells(&mut self) {
        self.cells.resize(self.cell_words() as usize, 0);
    }

    /// Number of words in the buffer `cells`.
    pub(crate) fn cell_words(&self) -> u64 {
        let long_movers = if self.step.layout.long_at == 0 { 0 } else { self.movers() };
        u64::from(self.step.layout.sorted_at) + u64::from(self.objects()) + u64::from(long_movers)
    }

    /// Sets the sizes and offsets of the grid, but does not allocate the table. `long_movers` adds room for long movers.
    fn place_cells(&mut self, cells: u32, long_movers: bool) {
        let objects = self.objects();
        let layout = &mut self.step.layout;
        layout.cells = cells.max(CELL_BLOCK).next_power_of_two();
        layout.sums_at = CELLS_AT + layout.cells;
        layout.keys_at = (layout.sums_at + SUM_WORDS * (layout.cells / CELL_BLOCK)).next_multiple_of(LINE);
        layout.sorted_at = (layout.keys_at + objects).next_multiple_of(LINE);
        layout.long_at = if long_movers { layout.sorted_at + objects } else { 0 };
    }

    /// Adds the scratch arrays that the CPU backend needs. Their sizes follow from the object counts.
    pub(crate) fn with_scratch(mut self) -> Self {
        self.add_scratch();
        self
    }

    /// Resizes the scratch arrays to the object counts. See [`World::with_scratch`].
    pub(crate) fn add_scratch(&mut self) {
        for number in 1..self.states.len() {
            self.states[number].resize(self.rows_of_state(number), Vec4::ZERO);
        }
        self.aabbs.resize(self.objects() as usize, Default::default());
        self.resize_cells();
        self.extents.resize(self.objects() as usize, Vec4::ZERO);
        self.wrenches.resize(self.wrench_count(), Vec4::ZERO);
        self.servo_loads.resize(self.servo_load_count(), Vec2::ZERO);
        self.set_pair_rows(self.step.layout.pair_rows);
    }

    /// Writes the external forces back to the scene that was packed with a force for each sphere. `packed` are the handles of
    /// the spheres at that time.
    #[cfg(feature = "gpu")]
    pub(crate) fn read_forces(&self, scene: &mut Scene, packed: &[SphereId]) {
        let forces =
            self.topology[self.step.layout.forces_at as usize..].chunks_exact(crate::model::layout::FORCE_WORDS as usize);
        for (id, force) in packed.iter().zip(forces) {
            // Skips spheres that have been removed since.
            if let Ok(sphere) = scene.spheres.get_mut(*id) {
                sphere.force = glam::Vec3::from_array([force[0], force[1], force[2]].map(f32::from_bits));
            }
        }
    }

    /// Writes the state of the spheres back to the scene that it was packed from. `packed` are the handles of the spheres at
    /// that time.
    pub(crate) fn read_spheres(&self, scene: &mut Scene, packed: &[SphereId]) {
        let n = packed.len();
        for place in 0..n {
            let id = &packed[self.insertion_index(place)];
            // Skips spheres that have been removed since. Fixed spheres have only turned.
            let Ok(sphere) = scene.spheres.get_mut(*id) else { continue };
            sphere.orientation = glam::Quat::from_vec4(self.orientations[place]);
            if !sphere.fixed {
                sphere.position = self.states[0][place].truncate();
                sphere.position_low = self.states[0][3 * n + place].truncate();
                sphere.velocity = self.states[0][n + place].truncate();
                sphere.angular_momentum = self.states[0][2 * n + place].truncate();
            }
        }
    }
}

/// Returns the cell size, which is a little more than the AABBs of most spheres at rest, and the lowest level of the grid.
///
/// Every mover searches every level. So when radii differ little, all spheres but the largest 2 % are put on one level.
fn typical_cell(scene: &Scene) -> (f32, u32) {
    let mut radii: Vec<f32> = scene.spheres().iter().map(|sphere| sphere.radius).collect();
    let count = radii.len();
    let mut quantile = |place: usize| match count {
        0 => 1.0,
        _ => *radii.select_nth_unstable_by(place, f32::total_cmp).1,
    };
    let (median, large) = (quantile(count / 2), quantile(count - count.min(1) - count / 50));
    let (size, least_level) =
        if large < 2.0 * median { (CELL_OF_ALL * large, LEVEL_BIAS) } else { (CELL_PER_RADIUS * median, 0) };
    (size.clamp(1e-20, 1e20), least_level)
}

/// The smallest radius of a sphere.
fn least_radius(scene: &Scene) -> f32 {
    scene.spheres().iter().map(|sphere| sphere.radius).fold(f32::INFINITY, f32::min)
}

/// Whether some sphere or rod at rest is so large that it belongs to [`LONG_LEVEL`](crate::model::layout::LONG_LEVEL) or above.
fn has_long_movers(scene: &Scene, cell: f32) -> bool {
    let place = |id| scene.sphere(id).map(|sphere| sphere.position);
    let is_long = |rod: &Rod| match (place(rod.end1), place(rod.end2)) {
        (Ok(one), Ok(two)) => size_class(0.5 * one.distance(two) + rod.radius, cell) > 0,
        _ => false,
    };
    scene.spheres().iter().any(|sphere| size_class(sphere.radius, cell) > 0) || scene.rods().iter().any(is_long)
}

fn order_in_space(scene: &Scene) -> Vec<u32> {
    let balls: Vec<Vec4> = scene.spheres().iter().map(|sphere| sphere.position.extend(sphere.radius)).collect();
    spatial_order(&balls, typical_cell(scene).0)
}

fn order_along_x(scene: &Scene) -> Vec<u32> {
    let spheres = scene.spheres();
    let mut order: Vec<u32> = (0..spheres.len() as u32).collect();
    let x = |index: u32| spheres[index as usize].position.x;
    order.sort_by(|a, b| x(*a).total_cmp(&x(*b)));
    order
}

/// Returns the spheres in the order of memory.
pub(crate) fn in_order<'a>(scene: &'a Scene, order: &'a [u32]) -> impl Iterator<Item = &'a Sphere> + 'a {
    let spheres = scene.spheres();
    (0..spheres.len()).map(move |slot| &spheres[order.get(slot).map_or(slot, |index| *index as usize)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::Benchmark;
    use crate::model::buffer::Buffer;

    #[test]
    fn large_spheres_count_only_at_the_end_of_memory() {
        let scene = Benchmark::Radii.generate(2000, 0).unwrap();
        let in_space = World::build_in_space(&scene).unwrap();
        let is_large = |sphere: &&Sphere| sphere.radius > 0.3;
        assert_eq!(in_space.step.layout.large as usize, scene.spheres().iter().filter(is_large).count());
        assert!(in_space.step.layout.large > 3 && in_space.step.traits().has_long_lists());
        // In insertion order the last sphere is a small one.
        assert_eq!(World::build(&scene).unwrap().step.layout.large, 0);
        // The number is limited, because a workgroup for each of many large spheres would be too much.
        let mut mixed = Scene::new();
        for k in 0..100_u8 {
            let radius = if k < 60 { 0.1 } else { 1.0 };
            mixed.add_sphere(Sphere::new([f32::from(k), 0.0, 0.0], radius)).unwrap();
        }
        assert_eq!(World::build(&mixed).unwrap().step.layout.large, 100 / SPHERES_PER_LARGE);
    }

    #[test]
    fn world_for_a_device_has_no_scratch() {
        let scene = Benchmark::Mixed.generate(100, 0).unwrap();
        let mut world = World::for_method(&scene, BroadPhase::Grid, UserLaws::default()).unwrap();
        let held: Vec<Buffer> = Buffer::ALL.into_iter().filter(|buffer| !world.bytes(*buffer).is_empty()).collect();
        assert_eq!(held, [Buffer::Start, Buffer::Topology, Buffer::Orientations, Buffer::Status]);
        world.set_pair_room(2);
        assert!(world.lists.is_empty());
        // Sizes follow from the counts, not from the previous capacity.
        let whole = world.with_scratch();
        assert_eq!(whole.lists.len(), (whole.step.layout.entries_at + 64) as usize);
        assert_eq!(whole.aabbs.len(), whole.objects() as usize);
        assert_eq!(whole.states[2].len(), whole.states[0].len());
    }
}
