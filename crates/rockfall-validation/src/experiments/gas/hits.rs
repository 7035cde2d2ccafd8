//! Energy changes of an elastic gas, by their cause.

use std::collections::HashMap;

use rockfall::{Body, Integrator, SphereId, SphereState};

use super::{STEP, gas};
use crate::Result;
use crate::measure::on_cpu;

/// Energy gained by an elastic gas, over its initial energy, by cause. Losses are negative.
#[derive(Default)]
pub(super) struct Losses {
    /// By collisions of two bodies that touch nothing else.
    pub(super) alone: f64,
    /// By collisions in sets of bodies with more than one overlap.
    pub(super) crowded: f64,
    /// By contact forces, in the rest of the step.
    pub(super) forces: f64,
    /// Number of isolated pairs and of larger sets.
    pub(super) counts: [usize; 2],
}

fn energy(sphere: &SphereState) -> f64 {
    0.5 * sphere.velocity.as_dvec3().length_squared()
}

/// Sets of spheres that are connected by overlaps: the set of each sphere, and the number of overlaps of each set.
fn clusters(spheres: usize, overlaps: &[[Option<usize>; 2]]) -> (Vec<usize>, Vec<usize>) {
    let mut set: Vec<usize> = (0..spheres).collect();
    for overlap in overlaps {
        if let [Some(a), Some(b)] = *overlap {
            let (old, new) = (set[a].max(set[b]), set[a].min(set[b]));
            set.iter_mut().filter(|set| **set == old).for_each(|set| *set = new);
        }
    }
    let mut sizes = vec![0; spheres];
    for [a, b] in overlaps {
        if let Some(sphere) = a.or(*b) {
            sizes[set[sphere]] += 1;
        }
    }
    (set, sizes)
}

/// Runs the phases one by one and compares the energy of every sphere between them.
pub(super) fn losses(per_side: u32, side: f64, steps: u32) -> Result<Losses> {
    let mut simulation = on_cpu(gas(per_side, side)?, Integrator::SymplecticEuler)?;
    let index: HashMap<SphereId, usize> = simulation.scene().sphere_ids().zip(0..).collect();
    let whole: f64 = simulation.spheres()?.iter().map(energy).sum();
    let mut losses = Losses::default();
    for _ in 0..steps {
        simulation.update_aabbs()?;
        simulation.broad_phase()?;
        let before = simulation.spheres()?;
        let place = |body: &Body| if let Body::Sphere(id) = body { index.get(id).copied() } else { None };
        // Phase 3 treats overlaps of up to 1e-5 of the radius as rounding.
        let overlaps = simulation.contacts()?.into_iter().filter(|contact| contact.overlap > 5e-6);
        let overlaps: Vec<_> = overlaps.map(|contact| [place(&contact.a), place(&contact.b)]).collect();
        let (set, sizes) = clusters(before.len(), &overlaps);
        simulation.handle_collisions()?;
        let after = simulation.spheres()?;
        simulation.update_positions(STEP)?;
        losses.forces +=
            simulation.spheres()?.iter().zip(&after).map(|(now, then)| energy(now) - energy(then)).sum::<f64>() / whole;
        for (sphere, (now, then)) in after.iter().zip(&before).enumerate() {
            let part = if sizes[set[sphere]] == 1 { &mut losses.alone } else { &mut losses.crowded };
            *part += (energy(now) - energy(then)) / whole;
        }
        losses.counts[0] += sizes.iter().filter(|size| **size == 1).count();
        losses.counts[1] += sizes.iter().filter(|size| **size > 1).count();
    }
    Ok(losses)
}
