//! Colours: blocks of one colour share no body with mass (docs/physics section 11.6).

use crate::rigid::frame::bodies::Bodies;
use crate::rigid::frame::contacts::{Block, COLOURS, Contacts, LEFT_OVER, Pair};
use crate::rigid::frame::matching::rank;
use crate::rigid::history::History;

/// A body with more near blocks than this is a hub: its blocks are left over.
const HUB: u32 = 64;
/// Blocks keep colours below this one. Others look for a smaller colour in each frame.
const KEPT: u8 = 8;

/// What the coloured blocks of a body leave free.
#[derive(Clone, Copy, Default)]
struct Use {
    colours: u16,
    /// Latest round of its blocks.
    round: u8,
    near: u32,
    all: u32,
}

/// Gives all blocks their colours, and sorts them by colour.
pub(super) fn colour(contacts: &mut Contacts, bodies: &Bodies, history: &History) {
    let mut uses = vec![Use::default(); bodies.count()];
    for block in &contacts.blocks {
        for body in heavy(block, bodies) {
            uses[body].near += u32::from(!block.far);
            uses[body].all += 1;
        }
    }
    let waiting = keep(contacts, bodies, history, &mut uses);
    for k in waiting {
        take(&mut contacts.blocks[k], bodies, &mut uses);
    }
    share(contacts, bodies);
    sort(contacts, bodies.count());
}

/// The bodies of a block that have mass.
fn heavy<'a>(block: &Block, bodies: &'a Bodies) -> impl Iterator<Item = usize> + use<'a> {
    block.sides().into_iter().filter(|body| bodies.masses[*body].inverse_mass > 0.0)
}

/// Blocks keep the colours of the last frame. Those without one, in the order in which they take colours.
fn keep(contacts: &mut Contacts, bodies: &Bodies, history: &History, uses: &mut [Use]) -> Vec<usize> {
    let mut waiting = Vec::new();
    for (k, block) in contacts.blocks.iter_mut().enumerate() {
        block.colour = LEFT_OVER;
        let crowded = |body: usize| uses[body].near > HUB || (block.far && uses[body].all > HUB);
        if heavy(block, bodies).any(crowded) {
            continue;
        }
        // A body that has got mass may have several blocks of one colour: the first keeps it.
        let free = |colour: &u8| heavy(block, bodies).all(|body| uses[body].colours & (1 << *colour) == 0);
        match history.colour(block.bodies).filter(|colour| *colour < KEPT).filter(free) {
            Some(colour) => {
                block.colour = colour;
                heavy(block, bodies).for_each(|body| uses[body].colours |= 1 << colour);
            }
            None => waiting.push(k),
        }
    }
    waiting.sort_unstable_by_key(|k| rank(&contacts.blocks[*k]));
    waiting
}

/// A block takes the smallest free colour, in the round after its earlier neighbours.
fn take(block: &mut Block, bodies: &Bodies, uses: &mut [Use]) {
    let (used, round) =
        heavy(block, bodies).fold((0, 0), |(used, round), body| (used | uses[body].colours, uses[body].round.max(round)));
    // Blocks of more rounds than a byte can tell are left over.
    let next = round.checked_add(1);
    block.round = next.unwrap_or(u8::MAX);
    let colour = used.trailing_ones() as u8;
    if colour < COLOURS as u8 && next.is_some() {
        block.colour = colour;
    }
    for body in heavy(block, bodies) {
        uses[body].round = block.round;
        if block.colour != LEFT_OVER {
            uses[body].colours |= 1 << block.colour;
        }
    }
}

/// Leaves over the blocks of all colours but the first `most`.
#[cfg(test)]
pub(super) fn cap(contacts: &mut Contacts, bodies: &Bodies, most: u8) {
    contacts.blocks.sort_unstable_by_key(|block| block.bodies);
    contacts.blocks.iter_mut().filter(|block| block.colour >= most).for_each(|block| block.colour = LEFT_OVER);
    share(contacts, bodies);
    sort(contacts, bodies.count());
}

/// The number of left-over blocks of the bodies of each left-over block.
fn share(contacts: &mut Contacts, bodies: &Bodies) {
    let mut counts = vec![0_u32; bodies.count()];
    for block in contacts.blocks.iter().filter(|block| block.colour == LEFT_OVER) {
        heavy(block, bodies).for_each(|body| counts[body] += 1);
    }
    for block in contacts.blocks.iter_mut().filter(|block| block.colour == LEFT_OVER) {
        block.shares = block.sides().map(|body| counts[body].max(1) as f32);
    }
}

/// Brings blocks that are in the order (a, b), with their pairs and points, into the order (colour, a, b). Lists them by body.
fn sort(contacts: &mut Contacts, bodies: usize) {
    let mut sorted = Contacts::default();
    for block in &contacts.blocks {
        sorted.colours[usize::from(block.colour) + 1] += 1;
    }
    for colour in 0..=COLOURS {
        sorted.colours[colour + 1] += sorted.colours[colour];
    }
    let mut next = sorted.colours;
    let mut order = vec![0; contacts.blocks.len()];
    // The new place of each block.
    let places: Vec<u32> = contacts
        .blocks
        .iter()
        .enumerate()
        .map(|(k, block)| {
            let place = &mut next[usize::from(block.colour)];
            order[*place as usize] = k;
            *place += 1;
            *place - 1
        })
        .collect();
    for k in order {
        let block = contacts.blocks[k];
        let (first_pair, first_point) = (sorted.pairs.len() as u32, sorted.points.len() as u32);
        let moved = first_point.wrapping_sub(block.first_point);
        let pairs = contacts.pairs[block.pair_range()].iter();
        sorted.pairs.extend(pairs.map(|pair| Pair { first: pair.first.wrapping_add(moved), ..*pair }));
        let range = block.first_point as usize..(block.first_point + block.points) as usize;
        sorted.points.extend_from_slice(&contacts.points[range.clone()]);
        sorted.impulses.extend_from_slice(&contacts.impulses[range]);
        sorted.blocks.push(Block { first_pair, first_point, ..block });
    }
    (sorted.rows, sorted.levers) = (std::mem::take(&mut contacts.rows), std::mem::take(&mut contacts.levers));
    sorted.list_by_body(bodies, &places);
    *contacts = sorted;
}
