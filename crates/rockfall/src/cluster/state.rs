//! The state of all spheres from the words of all processes.

use glam::Vec3;

use crate::checkpoint::{Checkpoint, KeptSpring};
use crate::cluster::domain::Domain;
use crate::scene::Scene;
use crate::simulation::share::{ROW_WORDS, Row, put_in_scene};

/// Words before the rows of a process: contacts, deepest overlap, number of rows.
const HEAD: usize = 3;
/// Words of a spring: the numbers of its objects, the feature, displacement, overlap, moment.
const SPRING_WORDS: usize = 10;

/// Adds the words of a spring if process `rank` owns it: that which owns the first of its moving spheres.
pub(super) fn add_spring(spring: &KeptSpring, whole: &Scene, domain: &Domain, rank: u32, words: &mut Vec<u32>) {
    let (Some(a), Some(b)) = (whole.number_of(spring.a), whole.number_of(spring.b)) else { return };
    let is_moving = |number: u32| whole.spheres().get(number as usize).is_some_and(|sphere| !sphere.fixed);
    let first = if !is_moving(a) && is_moving(b) { b } else { a };
    if domain.owners[first as usize] != rank {
        return;
    }
    let KeptSpring { feature, shift, overlap, moment, .. } = *spring;
    words.extend([a, b, feature]);
    words.extend([shift.x, shift.y, shift.z, overlap, moment.x, moment.y, moment.z].map(f32::to_bits));
}

/// Puts the words of all processes into the state of the whole scene, which is divided as `domain` says.
pub(super) fn put(all: &[Vec<u32>], domain: &Domain, whole: &mut Checkpoint) {
    put_rows(all, domain, whole);
    put_springs(all, whole);
    whole.report.contacts = all.iter().map(|words| words[0]).sum();
    whole.report.max_overlap = all.iter().map(|words| f32::from_bits(words[1])).fold(0.0, f32::max);
}

fn put_rows(all: &[Vec<u32>], domain: &Domain, whole: &mut Checkpoint) {
    let mut next = vec![HEAD; all.len()];
    let mut residues = Vec::new();
    for (index, sphere) in whole.scene.spheres.objects_mut().iter_mut().enumerate() {
        let owner = domain.owners[index] as usize;
        let at = next[owner];
        next[owner] += ROW_WORDS;
        let row: Row = std::array::from_fn(|word| all[owner][at + word]);
        let (rates, residue) = put_in_scene(&row, sphere);
        residues.push(residue);
        if let Some(kept) = whole.rates.get_mut(index) {
            *kept = rates;
        }
    }
    // Steps that are not short leave none.
    whole.residues = if residues.iter().all(|row| *row == [0; 4]) { Vec::new() } else { residues };
}

fn put_springs(all: &[Vec<u32>], whole: &mut Checkpoint) {
    let mut springs: Vec<&[u32]> =
        all.iter().flat_map(|words| words[HEAD + words[2] as usize * ROW_WORDS..].chunks_exact(SPRING_WORDS)).collect();
    // The records of a body are in the order of its list.
    springs.sort_unstable_by_key(|words| [words[0], words[1], words[2]]);
    let ids = if springs.is_empty() { Vec::new() } else { whole.scene.any_ids() };
    let spring = |words: &[u32]| {
        let numbers: [f32; 7] = std::array::from_fn(|at| f32::from_bits(words[3 + at]));
        KeptSpring {
            a: ids[words[0] as usize],
            b: ids[words[1] as usize],
            feature: words[2],
            shift: Vec3::from_slice(&numbers),
            overlap: numbers[3],
            moment: Vec3::from_slice(&numbers[4..]),
        }
    };
    whole.springs = springs.into_iter().map(spring).collect();
}
