//! Sets of spheres that rods and springs connect.

use crate::disjoint::DisjointSets;
use crate::scene::{Anchor, Rod, Scene, SphereId};

/// Sets of connected spheres. A sphere without bonds is a set of its own.
#[doc(hidden)]
#[derive(Clone, Debug)]
pub struct BondedSets {
    /// For every sphere, in order of addition: the index of the first sphere of its set.
    first: Vec<u32>,
    /// For every sphere that is the first of its set: whether something holds the set.
    held: Vec<bool>,
}

impl BondedSets {
    /// The index of the first sphere of the set that a sphere is in.
    pub fn first(&self, sphere: usize) -> usize {
        self.first[sphere] as usize
    }

    /// Whether something holds the set that a sphere is in.
    pub fn is_held(&self, sphere: usize) -> bool {
        self.held[self.first(sphere)]
    }

    /// Marks the set that a sphere is in as held.
    pub(crate) fn hold(&mut self, sphere: usize) {
        let first = self.first(sphere);
        self.held[first] = true;
    }
}

impl Scene {
    /// The sets of spheres that springs and the chosen rods connect. Fixed spheres and tethers hold their sets.
    #[doc(hidden)]
    pub fn bonded_sets(&self, is_bond: impl Fn(&Rod) -> bool) -> BondedSets {
        self.sets_with(is_bond, &[])
    }

    /// The sets of spheres that rods, springs, rigid bodies and joints connect. Fixed spheres, tethers and joints of the world hold their
    /// sets.
    pub(crate) fn joined_sets(&self) -> BondedSets {
        let of_end = |anchor: Anchor| match anchor {
            Anchor::World => None,
            Anchor::Body(id) => self.body(id).ok().and_then(|body| body.spheres().first().copied()),
            Anchor::Sphere(id) => Some(id),
        };
        let ends: Vec<[Option<SphereId>; 2]> = self.joints().iter().map(|joint| joint.anchors().map(of_end)).collect();
        let joints = ends.iter().map(|ends| ends.iter().flatten().copied().collect());
        let bodies = self.bodies().iter().map(|body| body.spheres().to_vec());
        let mut sets = self.sets_with(|_| true, &bodies.chain(joints).collect::<Vec<_>>());
        for sphere in ends.into_iter().filter(|ends| ends.contains(&None)).flatten().flatten() {
            if let Ok(index) = self.spheres.index(sphere) {
                sets.hold(index);
            }
        }
        sets
    }

    fn sets_with(&self, is_bond: impl Fn(&Rod) -> bool, others: &[Vec<SphereId>]) -> BondedSets {
        let count = self.spheres().len();
        let mut sets = DisjointSets::new(count);
        let rods = self.rods().iter().filter(|rod| is_bond(rod)).map(|rod| [rod.end1, rod.end2]);
        for ends in rods.chain(self.springs().iter().map(|spring| [spring.a, spring.b])) {
            // Every end is in the scene, because removing a sphere also removes its rods and springs.
            sets.join(ends.into_iter().filter_map(|id| self.spheres.index(id).ok()));
        }
        for spheres in others {
            sets.join(spheres.iter().filter_map(|id| self.spheres.index(*id).ok()));
        }
        let first = (0..count).map(|sphere| sets.root(sphere) as u32).collect();
        let mut sets = BondedSets { first, held: vec![false; count] };
        let fixed = self.spheres().iter().enumerate().filter(|(_, sphere)| sphere.fixed).map(|(sphere, _)| sphere);
        let tethered = self.tethers().iter().filter_map(|tether| self.spheres.index(tether.sphere).ok());
        fixed.chain(tethered).for_each(|sphere| sets.hold(sphere));
        sets
    }
}
