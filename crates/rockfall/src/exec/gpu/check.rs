//! Checks the values that kernels use as indices before they are uploaded, because the kernels run without bounds checks.

use crate::error::{Error, Result};
use crate::model::buffer::Buffer;
use crate::model::layout::{
    BOX_WORDS, FORCE_WORDS, HISTORY_WORDS, HULL_PART, KIND_FORCE, KIND_ROD, KIND_SHIFT, KIND_SPRING, KIND_TETHER, LINE,
    LINK_KEY, LIST_COUNT_MASK, MATERIAL_SHIFT, MAX_HISTORY_BLOCKS, MUSCLE_WORDS, NO_KEY, NO_NETWORK, NO_RIGID, NO_ROD,
    PAIR_WORDS, POLYGON_WORDS, POSE_FLOATS, RIGID_ROWS, RIGID_WORDS, ROD_WORDS, SHAPE_BOX_WORDS, SHAPE_WORDS, SLICE, SOME_RODS,
    SPRING_WORDS, TETHER_WORDS, WALL_BODY, WALL_WORDS, words_of_rows,
};
use crate::model::status::REJECTED_PAIRS;
use crate::model::step::Layout;
use crate::model::world::World;

/// Checks the contents of one buffer of a world.
///
/// # Errors
/// [`Error::Device`], which names the first value that is out of range.
pub(crate) fn check_buffer(world: &World, buffer: Buffer) -> Result<()> {
    match buffer {
        Buffer::Topology => check_topology(world),
        Buffer::Lists => check_lists(world),
        Buffer::Histories => check_histories(world),
        Buffer::Poses => check_poses(world),
        _ => Ok(()),
    }
}

fn wrong(what: &str) -> Error {
    Error::Device(format!("the world holds invalid data: {what}"))
}

fn ensure(right: bool, what: &str) -> Result<()> {
    if right { Ok(()) } else { Err(wrong(what)) }
}

/// A range of the topology buffer.
fn slice<'a>(world: &'a World, at: u32, count: u64, what: &str) -> Result<&'a [u32]> {
    let from = u64::from(at);
    let range = usize::try_from(from).ok().zip(usize::try_from(from + count).ok());
    range.and_then(|(from, to)| world.topology.get(from..to)).ok_or_else(|| wrong(what))
}

fn check_topology(world: &World) -> Result<()> {
    let step = &world.step;
    ensure(step.layout.large <= step.layout.spheres, "the number of large spheres")?;
    let rods = slice(world, step.layout.rods_at, u64::from(step.layout.rods) * u64::from(ROD_WORDS), "rods")?;
    for rod in rods.chunks_exact(ROD_WORDS as usize) {
        ensure(rod[0] < step.layout.spheres && rod[1] < step.layout.spheres, "the end of a rod")?;
    }
    slice(world, step.layout.boxes_at, u64::from(step.layout.boxes) * u64::from(BOX_WORDS), "boxes")?;
    slice(world, step.layout.polygons_at, u64::from(step.layout.polygons) * u64::from(POLYGON_WORDS), "polygons")?;
    check_walls(world)?;
    check_bodies(world)?;
    let tags = slice(world, step.layout.tags_at, u64::from(world.objects()), "tags")?;
    if step.layout.materials > 0 {
        let pairs = u64::from(step.layout.materials) * u64::from(step.layout.materials);
        slice(world, step.layout.pairs_at, pairs * u64::from(PAIR_WORDS), "pairs of materials")?;
        ensure(tags.iter().all(|tag| tag >> MATERIAL_SHIFT < step.layout.materials), "the material of an object")?;
    }
    let contact_laws = world.user_laws.contact_values_at(step.layout.materials * step.layout.materials);
    slice(world, step.layout.laws_at, contact_laws.into(), "the parameters of laws")?;
    if step.layout.free_at != 0 {
        slice(world, step.layout.free_at, u64::from(step.layout.spheres), "free accelerations")?;
    }
    if step.layout.adjacency_at != 0 {
        check_adjacency(world)?;
    }
    if step.layout.rods > 0 {
        ensure(step.layout.adjacency_at != 0 && step.layout.ends_at != 0, "the offsets of ends and adjacency")?;
        for end in slice(world, step.layout.ends_at, u64::from(step.layout.spheres), "ends")? {
            ensure(*end < step.layout.rods || [NO_ROD, SOME_RODS].contains(end), "an end")?;
        }
        check_networks(world)?;
    }
    ensure(step.layout.rods > 0 || step.layout.networks == 0, "the number of networks")?;
    check_batches(world)
}

fn check_walls(world: &World) -> Result<()> {
    let Layout { walls_at, bodies, boxes, polygons, .. } = world.step.layout;
    if walls_at == 0 {
        return Ok(());
    }
    let count = u64::from(boxes) + u64::from(polygons);
    let written = u64::from(boxes) * u64::from(BOX_WORDS) + u64::from(polygons) * u64::from(POLYGON_WORDS);
    let records = slice(world, walls_at, count * u64::from(WALL_WORDS) + written, "moving walls")?;
    for record in records.chunks_exact(WALL_WORDS as usize).take(count as usize) {
        ensure(record[WALL_BODY] <= bodies, "the body of a wall")?;
    }
    Ok(())
}

fn check_bodies(world: &World) -> Result<()> {
    let Layout { rigid_bodies, rigid_at, rigid_of_at, rigid_parts_at, spheres, .. } = world.step.layout;
    if rigid_bodies == 0 {
        return Ok(());
    }
    ensure(world.rigid_bodies.len() == (rigid_bodies * RIGID_ROWS) as usize, "the rigid bodies")?;
    for body in slice(world, rigid_of_at, spheres.into(), "the bodies of spheres")? {
        ensure(*body < rigid_bodies || *body == NO_RIGID, "the body of a sphere")?;
    }
    if rigid_parts_at > 0 {
        for part in slice(world, rigid_parts_at, spheres.into(), "boxes and hulls of bodies")? {
            check_part(world, *part)?;
        }
    }
    for record in
        slice(world, rigid_at, u64::from(rigid_bodies * RIGID_WORDS), "rigid bodies")?.chunks_exact(RIGID_WORDS as usize)
    {
        let [shape, members, count] = [record[11], record[12], record[13]];
        slice(world, shape, u64::from(SHAPE_WORDS) + 3 * u64::from(count), "the shape of a body")?;
        let members = slice(world, members, 2 * u64::from(count), "the spheres of a body")?;
        ensure(count > 0 && members[..count as usize].iter().all(|sphere| *sphere < spheres), "a sphere of a body")?;
    }
    Ok(())
}

/// Checks the word of a sphere that may stand for a box or a hull.
fn check_part(world: &World, part: u32) -> Result<()> {
    if part & HULL_PART != 0 {
        let at = part & !HULL_PART;
        let triangles = slice(world, at, 1, "a hull of a body")?[0];
        slice(world, at, 1 + 9 * u64::from(triangles), "the triangles of a hull")?;
    } else if part != 0 {
        slice(world, part, SHAPE_BOX_WORDS.into(), "a box of a body")?;
    }
    Ok(())
}

/// The poses of every row and body.
fn check_poses(world: &World) -> Result<()> {
    let floats = u64::from(world.step.constants.pose_rows) * u64::from(world.step.layout.bodies) * u64::from(POSE_FLOATS);
    ensure(floats <= world.poses.len() as u64, "the poses of moving walls")
}

fn check_networks(world: &World) -> Result<()> {
    let step = &world.step;
    let table = step.layout.networks_at.checked_sub(step.layout.rods).ok_or_else(|| wrong("networks"))?;
    for network in slice(world, table, u64::from(step.layout.rods), "networks of rods")? {
        ensure(*network < step.layout.networks || *network == NO_NETWORK, "the network of a rod")?;
    }
    for at in slice(world, step.layout.networks_at, u64::from(step.layout.networks), "networks")? {
        let counts = slice(world, *at, 2, "a network")?;
        // `slice` has checked that there are two counts.
        let names = slice(world, at + 2, u64::from(counts[0]) + u64::from(counts[1]), "members of a network")?;
        let (spheres, rods) = names.split_at(counts[0] as usize);
        ensure(spheres.iter().all(|end| end / 2 < step.layout.rods), "a sphere of a network")?;
        ensure(rods.iter().all(|rod| *rod < step.layout.rods), "a rod of a network")?;
    }
    Ok(())
}

fn check_adjacency(world: &World) -> Result<()> {
    let step = &world.step;
    let ranges = slice(world, step.layout.adjacency_at, 2 * u64::from(step.layout.spheres), "adjacency ranges")?;
    for pair in ranges.chunks_exact(2) {
        ensure(pair[0] <= pair[1], "adjacency ranges")?;
        for word in slice(world, pair[0], u64::from(pair[1] - pair[0]), "adjacency")? {
            check_attached(world, *word)?;
        }
    }
    Ok(())
}

fn check_attached(world: &World, word: u32) -> Result<()> {
    let step = &world.step;
    let index = word & ((1 << KIND_SHIFT) - 1);
    let record = |at: u32, words: u32, what: &str| {
        let from = u64::from(at) + u64::from(index) * u64::from(words);
        let from = u32::try_from(from).map_err(|_| wrong(what))?;
        slice(world, from, u64::from(words), what)
    };
    match word >> KIND_SHIFT {
        KIND_ROD => ensure(index < step.layout.rods, "a rod in the adjacency"),
        KIND_SPRING => {
            let spring = record(step.layout.springs_at, SPRING_WORDS, "a spring in the adjacency")?;
            ensure(spring[0] < step.layout.spheres && spring[1] < step.layout.spheres, "the end of a spring")?;
            ensure(
                step.layout.muscles_at == 0 || record(step.layout.muscles_at, MUSCLE_WORDS, "a muscle").is_ok(),
                "the muscle of a spring",
            )
        }
        KIND_TETHER => record(step.layout.tethers_at, TETHER_WORDS, "a tether in the adjacency").map(|_| ()),
        KIND_FORCE => record(step.layout.forces_at, FORCE_WORDS, "a force in the adjacency").map(|_| ()),
        _ => Err(wrong("the kind of an adjacency word")),
    }
}

fn check_batches(world: &World) -> Result<()> {
    let step = &world.step;
    for at in slice(world, step.layout.batches_at, u64::from(step.layout.batches), "batches")? {
        let colours = slice(world, *at, 1, "a batch")?[0];
        let first = at.checked_add(1).ok_or_else(|| wrong("a batch"))?;
        let offsets = slice(world, first, u64::from(colours) + 1, "colours of a batch")?;
        for pair in offsets.windows(2) {
            ensure(pair[0] <= pair[1], "colours of a batch")?;
            for rod in slice(world, pair[0], u64::from(pair[1] - pair[0]), "rods of a batch")? {
                ensure(*rod < step.layout.rods, "a rod of a batch")?;
            }
        }
    }
    Ok(())
}

/// Every link of the springs before the step leads to a block of the pool, and no two lead to the same one, so chains end.
/// Kernels do not read the other table before they have written it.
fn check_histories(world: &World) -> Result<()> {
    let (movers, blocks) = (world.movers() as usize, world.step.history_table_blocks() as usize);
    let table = world.history_words();
    ensure(world.histories.len() == 2 * table && world.status.history_table < 2, "the size of the springs of contacts")?;
    if table == 0 {
        return Ok(());
    }
    ensure(blocks <= MAX_HISTORY_BLOCKS as usize, "the number of blocks of springs of contacts")?;
    let words = table / blocks;
    let first = world.status.history_table as usize * table;
    let next = |block: usize| {
        let records = world.histories[first + block * words..][..words].chunks_exact(HISTORY_WORDS as usize);
        let mut keys = records.map(|record| record[record.len() - 1]);
        keys.find(|key| key & LINK_KEY != 0).filter(|key| *key != NO_KEY).map(|key| (key & !LINK_KEY) as usize)
    };
    let mut is_taken = vec![false; blocks - movers];
    for mover in 0..movers {
        let mut block = mover;
        while let Some(linked) = next(block) {
            let place = linked.checked_sub(movers).and_then(|place| is_taken.get_mut(place));
            ensure(place.is_some_and(|taken| !std::mem::replace(taken, true)), "a link of the springs of contacts")?;
            block = linked;
        }
    }
    Ok(())
}

fn check_lists(world: &World) -> Result<()> {
    let step = &world.step;
    let movers = world.movers();
    let slices = movers.div_ceil(SLICE);
    ensure(
        step.layout.slices_at == slices * SLICE
            && step.layout.entries_at == (step.layout.slices_at + slices + 1).next_multiple_of(LINE),
        "offsets of the pair lists",
    )?;
    if world.lists.is_empty() {
        // The lists exist on the device only.
        return Ok(());
    }
    ensure(world.lists.len() as u64 == world.list_words(), "length of the pair lists")?;
    if world.status.rejected & REJECTED_PAIRS != 0 {
        // The pairs did not fit. No stage reads the lists until they are rebuilt.
        return Ok(());
    }
    let (head, entries) = world.lists.split_at(step.layout.entries_at as usize);
    for (mover, count) in head[..movers as usize].iter().enumerate() {
        let slice = words_of_rows(head[step.layout.slices_at as usize + mover / SLICE as usize]);
        for entry in 0..u64::from(*count & LIST_COUNT_MASK) {
            let slot = slice + entry * u64::from(SLICE) + mover as u64 % u64::from(SLICE);
            let word = usize::try_from(slot).ok().and_then(|slot| entries.get(slot));
            let known = word.is_some_and(|word| word & step.entry_id_mask() < world.objects());
            ensure(known, "an entry of the pair lists")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, Sphere};

    /// A world of one sphere that claims to have so many. It has no springs of contacts.
    #[test]
    fn hundreds_of_millions_of_spheres_need_no_springs_of_contacts() {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0; 3], 1.0)).expect("a sphere");
        let mut world = World::build(&scene).expect("arrays");
        world.step.layout.spheres = MAX_HISTORY_BLOCKS + 1;
        check_buffer(&world, Buffer::Histories).expect("no springs are needed");
        world.step.layout.law = crate::ContactLaw::Linear.number();
        assert!(check_buffer(&world, Buffer::Histories).is_err());
    }
}
