//! Frames: groups of fixed-length rods that moving spheres connect. Determines which rods are solved together, and in which
//! order.

use crate::disjoint::DisjointSets;
use crate::model::layout::WORKGROUP;

/// Returns batches of rods. A batch is a list of colours. A colour is a list of rods that share no moving sphere.
///
/// Rods that are connected by moving spheres form one batch. Rods that are connected to no other are collected in batches of a
/// single colour, at most [`WORKGROUP`] in each. `rods` are (index, ends). `fixed` marks the fixed spheres. A fixed sphere does
/// not connect its rods, because no correction moves it.
pub(crate) fn batches(fixed: &[bool], rods: &[(u32, [u32; 2])]) -> Vec<Vec<Vec<u32>>> {
    let frames = connected(fixed, rods);
    let (single, joined): (Vec<_>, Vec<_>) = frames.into_iter().partition(|frame| frame.len() == 1);
    let single: Vec<u32> = single.into_iter().flatten().map(|(number, _)| number).collect();
    let mut batches: Vec<_> = single.chunks(WORKGROUP as usize).map(|chunk| vec![chunk.to_vec()]).collect();
    batches.extend(joined.iter().map(|frame| colour(frame, fixed)));
    batches
}

/// Returns the networks: connected sets of fixed-length rods (docs/physics section 1.4). Rods of rigid capsules and rods
/// between two fixed spheres belong to none. `rods` are (index, ends). `is_capsule` tests for the rods of rigid capsules.
pub(crate) fn networks(fixed: &[bool], rods: &[(u32, [u32; 2])], is_capsule: impl Fn(u32) -> bool) -> Vec<Vec<u32>> {
    let rods: Vec<_> = rods.iter().copied().filter(|(number, _)| !is_capsule(*number)).collect();
    connected(fixed, &rods).into_iter().map(|network| network.into_iter().map(|(number, _)| number).collect()).collect()
}

/// Groups rods that are connected by moving spheres, in the order of their first rods. Rods between two fixed spheres are left
/// out, because they need no correction.
fn connected(fixed: &[bool], rods: &[(u32, [u32; 2])]) -> Vec<Vec<(u32, [u32; 2])>> {
    if rods.is_empty() {
        return Vec::new();
    }
    let moving = |ends: [u32; 2]| ends.into_iter().map(|end| end as usize).filter(|end| !fixed[*end]);
    let mut spheres = DisjointSets::new(fixed.len());
    rods.iter().for_each(|(_, ends)| spheres.join(moving(*ends)));
    spheres.group(rods.iter().filter_map(|rod| Some((moving(rod.1).next()?, *rod))))
}

/// Colours the rods greedily. With at most d rods on a sphere, 2 d - 1 colours are enough. A chain needs two.
fn colour(frame: &[(u32, [u32; 2])], fixed: &[bool]) -> Vec<Vec<u32>> {
    let mut colours: Vec<Vec<u32>> = Vec::new();
    let mut used: std::collections::HashMap<u32, Vec<bool>> = std::collections::HashMap::new();
    for (number, ends) in frame {
        let moving: Vec<u32> = ends.iter().copied().filter(|end| !fixed[*end as usize]).collect();
        let taken = |colour: usize| {
            moving.iter().any(|end| used.get(end).is_some_and(|used| used.get(colour).copied().unwrap_or(false)))
        };
        let free = (0..).find(|colour| !taken(*colour)).unwrap_or(colours.len());
        if free == colours.len() {
            colours.push(Vec::new());
        }
        colours[free].push(*number);
        for end in moving {
            let used = used.entry(end).or_default();
            used.resize(used.len().max(free + 1), false);
            used[free] = true;
        }
    }
    colours
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shares_no_sphere(colour: &[u32], rods: &[(u32, [u32; 2])], fixed: &[bool]) -> bool {
        let mut seen = std::collections::HashSet::new();
        let ends = colour.iter().flat_map(|number| rods[*number as usize].1);
        ends.filter(|end| !fixed[*end as usize]).all(|end| seen.insert(end))
    }

    #[test]
    fn chain_has_two_colours_and_single_rods_share_a_batch() {
        let chain = [(0, [0, 1]), (1, [1, 2]), (2, [2, 3]), (3, [4, 5]), (4, [6, 7])];
        let fixed = [true, false, false, false, false, false, false, false];
        let batches = batches(&fixed, &chain);
        assert_eq!(batches, vec![vec![vec![3, 4]], vec![vec![0, 2], vec![1]]]);
    }

    #[test]
    fn fixed_sphere_does_not_connect_its_rods() {
        // Five rods from one fixed sphere.
        let rods: Vec<_> = (0..5).map(|number| (number, [0, number + 1])).collect();
        let mut fixed = [false; 6];
        fixed[0] = true;
        assert_eq!(batches(&fixed, &rods), vec![vec![vec![0, 1, 2, 3, 4]]]);
    }

    #[test]
    fn dense_frame_is_one_batch_and_rods_of_one_colour_share_no_sphere() {
        let mut rods = Vec::new();
        for one in 0..9 {
            for two in 0..one {
                rods.push((rods.len() as u32, [one, two]));
            }
        }
        let fixed = [false; 9];
        let batches = batches(&fixed, &rods);
        assert_eq!(batches.len(), 1);
        let mut all: Vec<u32> = batches[0].iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..36).collect::<Vec<_>>());
        assert!(batches[0].iter().all(|colour| shares_no_sphere(colour, &rods, &fixed)));
    }
}
