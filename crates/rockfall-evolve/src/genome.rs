//! The genotype: body and controller of a creature.

use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64;
use rockfall::glam::Vec3;
use rockfall::{Muscle, Result, Scene, Sphere, SphereId, Spring, Worlds};
use serde::{Deserialize, Serialize};

use crate::ground::Ground;

/// Distance between neighbouring nodes of a lattice, in units.
pub(crate) const SPACING: f32 = 0.5;
/// Radius of every sphere, in units.
pub(crate) const RADIUS: f32 = 0.12;
/// Mass of every sphere.
const MASS: f32 = 1.0;
/// Damping of every spring, in 1/s per unit of mass.
const DAMPING: f32 = 8.0;
/// Nodes up to this distance are joined by springs: the diagonal of a cube of the lattice and a little more.
pub(crate) const REACH: f32 = 1.75 * SPACING;
/// Smallest distance between two nodes, in units.
pub(crate) const LEAST_DISTANCE: f32 = 2.2 * RADIUS;
/// Greatest offset of a sphere along an axis in a disturbed start, in units. It is less than a tenth of the depth to which a sphere at
/// rest sinks into level ground.
pub(crate) const DISTURBANCE: f32 = 1e-4;
/// Least and greatest number of nodes. With the greatest number of springs, they fit into a workgroup of a GPU, on a ground of up to
/// 44 boxes.
pub(crate) const NODES: std::ops::RangeInclusive<usize> = 4..=Worlds::BODY_SPHERES;
/// Greatest number of springs.
pub(crate) const BONDS: usize = Worlds::BODY_MUSCLES;
/// Greatest amplitude of a muscle.
pub(crate) const MOST_AMPLITUDE: f32 = 0.25;
/// Least and greatest frequency of the muscles, in 1/s.
pub(crate) const FREQUENCIES: std::ops::RangeInclusive<f32> = 0.4..=3.0;
/// Least and greatest stiffness of the springs.
pub(crate) const STIFFNESSES: std::ops::RangeInclusive<f32> = 600.0..=3000.0;

/// Where the nodes of a body may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Body {
    /// On the points of a cubic lattice.
    Lattice,
    /// Anywhere.
    Free,
}

impl std::str::FromStr for Body {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        match name {
            "lattice" => Ok(Self::Lattice),
            "free" => Ok(Self::Free),
            _ => Err("expected lattice or free".to_owned()),
        }
    }
}

impl std::fmt::Display for Body {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if *self == Self::Lattice { "lattice" } else { "free" })
    }
}

/// A mass, and its share in the controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Node {
    /// Position in the body, in units.
    pub position: [f32; 3],
    /// Amplitude that it gives to the muscles at it, from 0 to 0.25.
    pub amplitude: f32,
    /// Phase that it gives to the muscles at it, in turns from 0 to 1.
    pub phase: f32,
}

impl Node {
    pub(crate) fn place(&self) -> Vec3 {
        Vec3::from_array(self.position)
    }
}

/// Body and controller of a creature. Nodes that are near each other are joined by springs, and each spring is a muscle whose
/// amplitude and phase are the means of its two nodes. So a change of one node changes a part of body and gait together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Genome {
    /// Where nodes may be.
    pub body: Body,
    /// The masses, 4 to 20.
    pub nodes: Vec<Node>,
    /// Frequency of all muscles, in 1/s.
    pub frequency: f32,
    /// Stiffness of all springs, in mass/s².
    pub stiffness: f32,
}

/// A spring of a creature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bond {
    pub(crate) ends: [usize; 2],
    pub(crate) length: f32,
    pub(crate) muscle: Option<Muscle>,
}

impl Genome {
    /// The springs: one per pair of near nodes, in ascending order.
    pub(crate) fn bonds(&self) -> Vec<Bond> {
        let mut bonds = Vec::new();
        for (b, end) in self.nodes.iter().enumerate() {
            for (a, other) in self.nodes[..b].iter().enumerate() {
                let length = end.place().distance(other.place());
                if length <= REACH {
                    let amplitude = 0.5 * (end.amplitude + other.amplitude);
                    let muscle = Muscle::new(amplitude, self.frequency, middle(end.phase, other.phase));
                    bonds.push(Bond { ends: [a, b], length, muscle: (amplitude > 0.0).then_some(muscle) });
                }
            }
        }
        bonds
    }

    /// Extent of the body along its longer horizontal side, in units, with the spheres: the length of the creature.
    pub fn length(&self) -> f32 {
        let [least, greatest] = self.bounds();
        let extent = greatest - least;
        extent.x.max(extent.z) + 2.0 * RADIUS
    }

    fn bounds(&self) -> [Vec3; 2] {
        let places = || self.nodes.iter().map(Node::place);
        [places().fold(Vec3::INFINITY, Vec3::min), places().fold(Vec3::NEG_INFINITY, Vec3::max)]
    }

    /// A scene with the creature on a ground, at rest, its lowest spheres touching height 0.
    ///
    /// # Errors
    /// Those of the scene, for a ground that is too large. Every genome that variation gives is a valid creature.
    pub fn scene(&self, ground: &Ground) -> Result<Scene> {
        self.scene_with(ground, || Vec3::ZERO)
    }

    /// The same scene with a disturbed start: each sphere is up to [`DISTURBANCE`] away from its place along each axis, and not
    /// lower. The springs keep their rest lengths. The seed determines the offsets.
    pub(crate) fn disturbed_scene(&self, ground: &Ground, seed: u64) -> Result<Scene> {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut draw = |least: f32| random.random_range(least..=DISTURBANCE);
        self.scene_with(ground, || Vec3::new(draw(-DISTURBANCE), draw(0.0), draw(-DISTURBANCE)))
    }

    /// A scene with the creature on a ground. Each sphere is moved by an offset.
    fn scene_with(&self, ground: &Ground, mut offset: impl FnMut() -> Vec3) -> Result<Scene> {
        let mut scene = ground.scene();
        let [least, greatest] = self.bounds();
        let middle = 0.5 * (least + greatest);
        let shift = Vec3::new(-middle.x, RADIUS - least.y, -middle.z);
        let mut ids: Vec<SphereId> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            ids.push(scene.add_sphere(Sphere::new(node.place() + shift + offset(), RADIUS).mass(MASS))?);
        }
        for bond in self.bonds() {
            let [a, b] = bond.ends.map(|end| ids[end]);
            let spring = Spring::new(a, b, self.stiffness, bond.length).damping(DAMPING * MASS);
            scene.add_spring(match bond.muscle {
                Some(muscle) => spring.muscle(muscle),
                None => spring,
            })?;
        }
        Ok(scene)
    }

    /// Whether the genome is a creature: its nodes are apart, springs join all of them, and there are at most 64 springs.
    pub fn is_viable(&self) -> bool {
        let apart = self
            .nodes
            .iter()
            .enumerate()
            .all(|(b, node)| self.nodes[..b].iter().all(|other| node.place().distance(other.place()) >= LEAST_DISTANCE));
        let is_whole = apart && self.connected().len() == self.nodes.len();
        NODES.contains(&self.nodes.len()) && is_whole && self.bonds().len() <= BONDS
    }

    /// The nodes that springs join to the first one, in ascending order.
    pub(crate) fn connected(&self) -> Vec<usize> {
        let mut found = vec![0];
        let mut seen = vec![false; self.nodes.len()];
        seen[0] = true;
        let mut next = 0;
        while let Some(node) = found.get(next).copied() {
            next += 1;
            for (other, (end, is_known)) in self.nodes.iter().zip(&mut seen).enumerate() {
                if !*is_known && self.nodes[node].place().distance(end.place()) <= REACH {
                    *is_known = true;
                    found.push(other);
                }
            }
        }
        found.sort_unstable();
        found
    }
}

/// The phase in the middle of the shorter way from one phase to the other.
fn middle(a: f32, b: f32) -> f32 {
    let apart = (b - a + 0.5).rem_euclid(1.0) - 0.5;
    (a + 0.5 * apart).rem_euclid(1.0)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn cube() -> Genome {
        let node = |k: u8| Node {
            position: [k & 1, k >> 1 & 1, k >> 2].map(|side| f32::from(side) * SPACING),
            amplitude: 0.1,
            phase: 0.125 * f32::from(k),
        };
        Genome { body: Body::Lattice, nodes: (0..8).map(node).collect(), frequency: 1.0, stiffness: 1000.0 }
    }

    /// A cube with muscles of this amplitude.
    pub(crate) fn cube_with(amplitude: f32) -> Genome {
        let mut genome = cube();
        genome.nodes.iter_mut().for_each(|node| node.amplitude = amplitude);
        (genome.frequency, genome.stiffness) = (2.0, 1500.0);
        genome
    }

    #[test]
    fn a_cube_has_edges_and_diagonals() {
        let cube = cube();
        assert!(cube.is_viable());
        assert_eq!(cube.bonds().len(), 28);
        assert_eq!(cube.length(), SPACING + 2.0 * RADIUS);
        let scene = cube.scene(&Ground::level(10.0).unwrap()).unwrap();
        assert_eq!((scene.spheres().len(), scene.springs().len(), scene.boxes().len()), (8, 28, 1));
        assert!(scene.spheres().iter().all(|sphere| sphere.position.y >= RADIUS));
    }

    #[test]
    fn a_disturbed_start_moves_every_sphere_a_little_and_keeps_the_springs() {
        let ground = Ground::level(10.0).unwrap();
        let (plain, disturbed) = (cube().scene(&ground).unwrap(), cube().disturbed_scene(&ground, 1).unwrap());
        for (before, after) in plain.spheres().iter().zip(disturbed.spheres()) {
            let offset = after.position - before.position;
            // Positions are rounded to f32.
            assert!(offset.abs().max_element() <= 1.01 * DISTURBANCE && offset.y >= 0.0, "{offset}");
            assert!(offset.length() > 0.01 * DISTURBANCE, "{offset}");
        }
        let lengths = |scene: &Scene| scene.springs().iter().map(|spring| spring.length).collect::<Vec<_>>();
        assert_eq!(lengths(&plain), lengths(&disturbed));
        assert_eq!(disturbed.to_text(), cube().disturbed_scene(&ground, 1).unwrap().to_text());
        assert_ne!(disturbed.to_text(), cube().disturbed_scene(&ground, 2).unwrap().to_text());
    }

    #[test]
    fn phases_meet_on_the_shorter_way() {
        assert!((middle(0.9, 0.1) - 0.0).abs() < 1e-6 || (middle(0.9, 0.1) - 1.0).abs() < 1e-6);
        assert!((middle(0.2, 0.4) - 0.3).abs() < 1e-6);
        assert!((middle(0.4, 0.2) - 0.3).abs() < 1e-6);
    }

    #[test]
    fn bodies_in_two_parts_are_not_viable() {
        let mut genome = cube();
        genome.nodes[7].position = [3.0, 3.0, 3.0];
        assert!(!genome.is_viable());
        assert_eq!(genome.connected(), [0, 1, 2, 3, 4, 5, 6]);
        genome.nodes[7].position = genome.nodes[0].position;
        assert!(!genome.is_viable());
    }
}
