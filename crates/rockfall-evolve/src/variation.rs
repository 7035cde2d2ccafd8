//! New genomes: at random, by mutation and by crossover. Every result is viable.

use rand::RngExt as _;
use rand_pcg::Pcg64;
use rockfall::glam::Vec3;

use crate::genome::{
    BONDS, Body, FREQUENCIES, Genome, LEAST_DISTANCE, MOST_AMPLITUDE, NODES, Node, REACH, SPACING, STIFFNESSES,
};

/// Attempts to find a viable change before a genome is copied as it is.
const ATTEMPTS: usize = 20;
/// Lattices have this many points along x, y and z at most.
const LATTICE: [i32; 3] = [5, 3, 3];
/// Edges of the box that free nodes are in, in units.
const ROOM: [f32; 3] = [2.2, 1.2, 1.2];

fn between(random: &mut Pcg64, range: &std::ops::RangeInclusive<f32>) -> f32 {
    random.random_range(range.clone())
}

/// A number about 0 with a standard deviation of about 1: the sum of four uniform numbers.
fn about_zero(random: &mut Pcg64) -> f32 {
    (0..4).map(|_| random.random_range(-0.87_f32..0.87)).sum()
}

fn random_node(random: &mut Pcg64, position: Vec3) -> Node {
    let amplitude = if random.random_bool(0.3) { 0.0 } else { random.random_range(0.0..=MOST_AMPLITUDE) };
    Node { position: position.to_array(), amplitude, phase: random.random_range(0.0..1.0) }
}

/// A place for another node near one of the nodes.
fn place_near(random: &mut Pcg64, body: Body, nodes: &[Node]) -> Vec3 {
    let from = nodes.get(random.random_range(0..nodes.len().max(1))).map_or(Vec3::ZERO, Node::place);
    match body {
        Body::Lattice => {
            let mut step = [0.0; 3];
            step[random.random_range(0..3)] = if random.random_bool(0.5) { SPACING } else { -SPACING };
            let last = LATTICE.map(|points| (points - 1) as f32 * SPACING);
            (from + Vec3::from_array(step)).clamp(Vec3::ZERO, Vec3::from_array(last))
        }
        Body::Free => {
            let step = Vec3::from_array([(); 3].map(|()| random.random_range(-0.9..0.9) * REACH));
            (from + step).clamp(Vec3::ZERO, Vec3::from_array(ROOM))
        }
    }
}

fn is_free(nodes: &[Node], place: Vec3) -> bool {
    nodes.iter().all(|node| node.place().distance(place) >= LEAST_DISTANCE)
}

impl Genome {
    /// A creature at random.
    pub fn random(random: &mut Pcg64, body: Body) -> Self {
        let count = random.random_range(6..=14);
        let mut nodes = vec![random_node(random, Vec3::ZERO)];
        let mut bonds = 0;
        while nodes.len() < count {
            let place = place_near(random, body, &nodes);
            let near = nodes.iter().filter(|node| node.place().distance(place) <= REACH).count();
            if is_free(&nodes, place) && near > 0 && bonds + near <= BONDS {
                nodes.push(random_node(random, place));
                bonds += near;
            }
        }
        let genome = Self { body, nodes, frequency: between(random, &FREQUENCIES), stiffness: between(random, &STIFFNESSES) };
        debug_assert!(genome.is_viable());
        genome
    }

    /// A changed copy.
    pub fn mutated(&self, random: &mut Pcg64) -> Self {
        let mut child = self.clone();
        child.vary_controller(random);
        if random.random_bool(0.4) {
            for _ in 0..ATTEMPTS {
                let mut changed = child.clone();
                changed.vary_body(random);
                if changed.is_viable() {
                    child = changed;
                    break;
                }
            }
        }
        child
    }

    fn vary_controller(&mut self, random: &mut Pcg64) {
        let share = 2.0 / self.nodes.len() as f64;
        for node in &mut self.nodes {
            if random.random_bool(share.min(1.0)) {
                node.phase = (node.phase + 0.12 * about_zero(random)).rem_euclid(1.0).min(0.999_999);
            }
            if random.random_bool(share.min(1.0)) {
                node.amplitude = (node.amplitude + 0.05 * about_zero(random)).clamp(0.0, MOST_AMPLITUDE);
            }
        }
        if random.random_bool(0.3) {
            let changed = self.frequency * (1.0 + 0.15 * about_zero(random));
            self.frequency = changed.clamp(*FREQUENCIES.start(), *FREQUENCIES.end());
        }
        if random.random_bool(0.2) {
            let changed = self.stiffness * (1.0 + 0.15 * about_zero(random));
            self.stiffness = changed.clamp(*STIFFNESSES.start(), *STIFFNESSES.end());
        }
    }

    /// Adds, removes or moves a node. The result may not be viable.
    fn vary_body(&mut self, random: &mut Pcg64) {
        let at = random.random_range(0..self.nodes.len());
        // More nodes are added than removed, because additions fail more often.
        match random.random_range(0..4) {
            0 | 1 => {
                let place = place_near(random, self.body, &self.nodes);
                self.nodes.push(random_node(random, place));
            }
            2 if self.nodes.len() > *NODES.start() => {
                self.nodes.remove(at);
            }
            _ => {
                let mut others = self.nodes.clone();
                others.remove(at);
                self.nodes[at].position = match self.body {
                    Body::Lattice => place_near(random, self.body, &others),
                    Body::Free => {
                        let step = Vec3::from_array([(); 3].map(|()| 0.1 * about_zero(random)));
                        (self.nodes[at].place() + step).clamp(Vec3::ZERO, Vec3::from_array(ROOM))
                    }
                }
                .to_array();
            }
        }
    }

    /// A child with the nodes of one parent on one side of a plane and those of the other parent on the other side. A copy of the
    /// first parent if none of several planes gives a viable child.
    pub fn crossed(&self, other: &Self, random: &mut Pcg64) -> Self {
        for _ in 0..ATTEMPTS {
            let axis = random.random_range(0..3);
            let cut = random.random_range(0.0..ROOM[axis]);
            let swap = random.random_bool(0.5);
            let side = |node: &&Node| (node.position[axis] < cut) != swap;
            let mut nodes: Vec<Node> = self.nodes.iter().filter(side).copied().collect();
            for node in other.nodes.iter().filter(|node| !side(node)) {
                if is_free(&nodes, node.place()) {
                    nodes.push(*node);
                }
            }
            if nodes.is_empty() {
                continue;
            }
            let [first, second] = if random.random_bool(0.5) { [self, other] } else { [other, self] };
            let mut child = Self { body: self.body, nodes, frequency: first.frequency, stiffness: second.stiffness };
            child.nodes = child.connected().into_iter().map(|node| child.nodes[node]).collect();
            if child.is_viable() {
                return child;
            }
        }
        self.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::Ground;
    use rand::SeedableRng as _;

    /// Any chain of changes gives a creature that a simulation accepts.
    #[test]
    fn every_genome_is_viable() {
        let ground = Ground::level(10.0).unwrap();
        for body in [Body::Lattice, Body::Free] {
            let mut random = Pcg64::seed_from_u64(7);
            let mut most = 0;
            let mut known: Vec<Genome> = (0..20).map(|_| Genome::random(&mut random, body)).collect();
            for round in 0..2_000 {
                let a = known[random.random_range(0..known.len())].clone();
                let b = &known[random.random_range(0..known.len())];
                let child = if round % 3 == 0 { a.crossed(b, &mut random) } else { a.mutated(&mut random) };
                assert!(child.is_viable() && child.bonds().len() <= BONDS, "{child:?}");
                most = most.max(child.bonds().len());
                let muscles = child.bonds().into_iter().filter_map(|bond| bond.muscle);
                assert!(muscles.into_iter().all(|muscle| (0.0..=MOST_AMPLITUDE).contains(&muscle.amplitude)));
                if round % 50 == 0 {
                    child.scene(&ground).unwrap();
                }
                let at = random.random_range(0..known.len());
                known[at] = child;
            }
            assert!(known.iter().any(|genome| genome.nodes.len() > 8) && most > BONDS - 4, "{most}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_genome() {
        let make = || Genome::random(&mut Pcg64::seed_from_u64(3), Body::Free).mutated(&mut Pcg64::seed_from_u64(4));
        assert_eq!(make(), make());
    }
}
