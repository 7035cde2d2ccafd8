//! The tension of chains of rods of fixed length, which bounds the time step.

use std::collections::VecDeque;

use crate::scene::Scene;
use crate::stability::bounds::Steps;

/// Largest time step times the angular frequency of a chain at which the chain gains no energy. Chains of 2 to 40 equal links with
/// a last mass of 1 to 1000, let go level, gain less than 0.1 % at 0.4, 2 % at 0.5, and up to 1,900 times their
/// energy at 0.7 and more.
const CHAIN: f64 = 0.4;
/// Tension at the lowest point of a pendulum that is let go level, in units of its weight.
const LET_GO_LEVEL: f64 = 3.0;

/// The bounds of a chain with the greatest stiffness per mass `stiffness`.
pub(super) fn chain_steps(stiffness: f64) -> Steps {
    Steps { rest: CHAIN / stiffness.sqrt(), bounded: f64::INFINITY }
}

impl Scene {
    /// The sphere of a chain that its two rods of fixed length hold most stiffly, and this stiffness per mass in 1/s²
    /// (docs/physics section 6.2). `None` if no fixed sphere holds a chain against gravity.
    pub(super) fn stiffest_link(&self) -> Option<(usize, f64)> {
        let gravity = f64::from(self.settings.gravity.abs());
        let links: Vec<([usize; 2], f64)> = self.fixed_lengths().collect();
        if gravity == 0.0 || links.is_empty() {
            return None;
        }
        let mut at = vec![Vec::new(); self.spheres().len()];
        for (link, ([a, b], _)) in links.iter().enumerate() {
            at[*a].push(link);
            at[*b].push(link);
        }
        let masses = masses_beyond(self, &links, &at);
        let movers = self.spheres().iter().enumerate().filter(|(index, sphere)| !sphere.fixed && at[*index].len() == 2);
        let stiffness = movers.map(|(index, sphere)| {
            let pull: f64 = at[index].iter().map(|link| LET_GO_LEVEL * gravity * masses[*link] / links[*link].1).sum();
            (index, 2.0 * pull / f64::from(sphere.mass))
        });
        stiffness.max_by(|one, other| one.1.total_cmp(&other.1)).filter(|(_, stiffness)| *stiffness > 0.0)
    }

    /// The indices of the ends of the rods of fixed length, and the lengths.
    fn fixed_lengths(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        self.rods().iter().filter_map(|rod| {
            let ends = [self.spheres.index(rod.end1).ok()?, self.spheres.index(rod.end2).ok()?];
            Some((ends, rod.length?.into()))
        })
    }
}

/// The mass that each link carries: that of the spheres which are farther from a fixed sphere, in links. Where several links lead
/// nearer to one, each of them carries an equal share. `at` are the links of each sphere.
fn masses_beyond(scene: &Scene, links: &[([usize; 2], f64)], at: &[Vec<usize>]) -> Vec<f64> {
    let spheres = scene.spheres();
    let other = |link: usize, sphere: usize| links[link].0.iter().sum::<usize>() - sphere;
    let mut distance = vec![usize::MAX; spheres.len()];
    let mut queue: VecDeque<usize> =
        (0..spheres.len()).filter(|index| spheres[*index].fixed && !at[*index].is_empty()).collect();
    queue.iter().for_each(|index| distance[*index] = 0);
    let mut order = Vec::new();
    while let Some(sphere) = queue.pop_front() {
        order.push(sphere);
        for link in &at[sphere] {
            let next = other(*link, sphere);
            if distance[next] == usize::MAX {
                distance[next] = distance[sphere] + 1;
                queue.push_back(next);
            }
        }
    }
    let mut load: Vec<f64> = spheres.iter().map(|sphere| sphere.mass.into()).collect();
    let mut carried = vec![0.0; links.len()];
    for sphere in order.into_iter().rev().filter(|sphere| distance[*sphere] > 0) {
        let is_nearer = |link: &&usize| distance[other(**link, sphere)] < distance[sphere];
        let count = at[sphere].iter().filter(is_nearer).count() as f64;
        for link in at[sphere].iter().filter(is_nearer) {
            carried[*link] = load[sphere] / count;
            load[other(*link, sphere)] += carried[*link];
        }
    }
    carried
}
