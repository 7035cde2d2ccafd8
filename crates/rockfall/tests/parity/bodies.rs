//! The objects of a world in f64, read from its buffers by their documented layout alone.

use glam::{DVec3, Vec4};
use rockfall::layout::{BOX_WORDS, FLAG_COLLISIONS, POLYGON_WORDS, ROD_WORDS};
use rockfall::world::World;

pub(crate) struct Ball {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    pub(crate) radius: f64,
    /// 1/m, 0 of a fixed sphere.
    pub(crate) w: f64,
}

pub(crate) struct Bar {
    pub(crate) ends: [usize; 2],
    pub(crate) radius: f64,
    pub(crate) length: f64,
}

pub(crate) struct Block {
    pub(crate) corner: DVec3,
    pub(crate) edges: [DVec3; 3],
}

pub(crate) struct Face {
    pub(crate) corner: DVec3,
    pub(crate) left: DVec3,
    pub(crate) right: DVec3,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Ball(usize),
    Bar(usize),
    Block(usize),
    Face(usize),
}

pub(crate) struct Bodies {
    pub(crate) balls: Vec<Ball>,
    pub(crate) bars: Vec<Bar>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) faces: Vec<Face>,
    /// Group of every object, by id.
    pub(crate) groups: Vec<u32>,
    /// The rods that end in a sphere.
    pub(crate) bars_of: Vec<Vec<usize>>,
    pub(crate) dt: f64,
    pub(crate) threshold: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) collisions: bool,
}

fn vector(row: Vec4) -> DVec3 {
    row.truncate().as_dvec3()
}

impl Bodies {
    /// The world with its spheres in stage state `state`.
    pub(crate) fn new(world: &World, state: usize) -> Self {
        let step = &world.step;
        let rows = &world.states[state];
        let n = step.spheres as usize;
        let word = |at: u32, index: u32, words: u32, place: u32| world.words[(at + index * words + place) as usize];
        let float = |at, index, words, place| f64::from(f32::from_bits(word(at, index, words, place)));
        let triple = |at, index, words, place| DVec3::from_array([0, 1, 2].map(|k: u32| float(at, index, words, place + k)));
        let bars: Vec<Bar> = (0..step.rods)
            .map(|rod| Bar {
                ends: [0, 1].map(|k| word(step.rods_at, rod, ROD_WORDS, k) as usize),
                radius: float(step.rods_at, rod, ROD_WORDS, 2),
                length: float(step.rods_at, rod, ROD_WORDS, 3),
            })
            .collect();
        let mut bars_of = vec![Vec::new(); n];
        for (bar, number) in bars.iter().zip(0..) {
            for end in bar.ends {
                bars_of[end].push(number);
            }
        }
        let objects = step.spheres + step.rods + step.boxes + step.polygons;
        Self {
            balls: (0..n)
                .map(|k| Ball {
                    x: vector(rows[k]),
                    v: vector(rows[n + k]),
                    radius: f64::from(rows[k].w),
                    w: f64::from(rows[n + k].w),
                })
                .collect(),
            blocks: (0..step.boxes)
                .map(|k| Block {
                    corner: triple(step.boxes_at, k, BOX_WORDS, 0),
                    edges: [3, 6, 9].map(|place| triple(step.boxes_at, k, BOX_WORDS, place)),
                })
                .collect(),
            faces: (0..step.polygons)
                .map(|k| Face {
                    corner: triple(step.polygons_at, k, POLYGON_WORDS, 0),
                    left: triple(step.polygons_at, k, POLYGON_WORDS, 3),
                    right: triple(step.polygons_at, k, POLYGON_WORDS, 6),
                })
                .collect(),
            groups: (0..objects).map(|id| world.words[(step.tags_at + id) as usize] & 0xffff).collect(),
            bars,
            bars_of,
            dt: f64::from(step.dt),
            threshold: f64::from(step.activation_threshold),
            stiffness: f64::from(step.contact_force),
            damping: f64::from(step.contact_damping),
            collisions: step.flags & FLAG_COLLISIONS != 0,
        }
    }

    pub(crate) fn kind(&self, id: usize) -> Kind {
        let (balls, bars, blocks) = (self.balls.len(), self.bars.len(), self.blocks.len());
        match id {
            _ if id < balls => Kind::Ball(id),
            _ if id < balls + bars => Kind::Bar(id - balls),
            _ if id < balls + bars + blocks => Kind::Block(id - balls - bars),
            _ => Kind::Face(id - balls - bars - blocks),
        }
    }

    pub(crate) fn movers(&self) -> usize {
        self.balls.len() + self.bars.len()
    }

    /// The spheres that an object stands on.
    pub(crate) fn spheres_of(&self, id: usize) -> Vec<usize> {
        match self.kind(id) {
            Kind::Ball(ball) => vec![ball],
            Kind::Bar(bar) => self.bars[bar].ends.to_vec(),
            Kind::Block(_) | Kind::Face(_) => Vec::new(),
        }
    }

    pub(crate) fn immovable(&self, id: usize) -> bool {
        self.spheres_of(id).iter().all(|ball| self.balls[*ball].w == 0.0)
    }

    /// Both ends of a rod.
    pub(crate) fn segment(&self, bar: usize) -> [DVec3; 2] {
        self.bars[bar].ends.map(|end| self.balls[end].x)
    }

    /// The other end, if the sphere has exactly one rod and that one is of fixed length.
    pub(crate) fn capsule_partner(&self, ball: usize) -> Option<usize> {
        let [bar] = self.bars_of[ball][..] else { return None };
        let Bar { ends, length, .. } = &self.bars[bar];
        (*length > 0.0).then(|| ends[usize::from(ends[0] == ball)])
    }

    /// Pairs that never overlap: of one group, one of them moves, and neither is part of the other.
    pub(crate) fn may_touch(&self, a: usize, b: usize) -> bool {
        if self.groups[a] != self.groups[b] || (self.immovable(a) && self.immovable(b)) {
            return false;
        }
        match (self.kind(a), self.kind(b)) {
            (Kind::Ball(a), Kind::Ball(b)) => !self.bars.iter().any(|bar| {
                let joined = bar.ends == [a, b] || bar.ends == [b, a];
                joined && bar.length > 0.0
            }),
            (Kind::Bar(_), Kind::Face(_)) => false,
            _ => self.spheres_of(a).iter().all(|end| !self.spheres_of(b).contains(end)),
        }
    }
}
