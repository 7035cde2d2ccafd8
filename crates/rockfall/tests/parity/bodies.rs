//! The objects of a world in f64, read from its buffers by their documented layout, without the library's functions.

use glam::{DVec3, Vec4};
use rockfall::model::layout::{
    BOX_WORDS, FLAG_COLLISIONS, FORCE_WORDS, KIND_FORCE, KIND_SHIFT, KIND_SPRING, KIND_TETHER, MUSCLE_WORDS, POLYGON_WORDS,
    ROD_WORDS, SPRING_WORDS, SURFACE_BALL, SURFACE_CONE, SURFACE_TRIANGLE, TETHER_WORDS,
};
use rockfall::model::world::World;

#[derive(Clone)]
pub(crate) struct Ball {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    /// Angular momentum.
    pub(crate) l: DVec3,
    pub(crate) radius: f64,
    /// 1/m; 0 for a fixed sphere.
    pub(crate) w: f64,
    /// 1/I; 0 for a fixed sphere.
    pub(crate) i: f64,
    /// Acceleration by gravity, springs, tethers and external forces; 0 for a fixed sphere.
    pub(crate) acceleration: DVec3,
}

/// A body: spheres that an impulse moves together (docs/physics section 1.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Body {
    /// A single sphere.
    Ball(usize),
    /// A rigid capsule, by the index of its rod.
    Capsule(usize),
    /// A network, by the smallest index of its spheres.
    Network(usize),
}

#[derive(Clone)]
pub(crate) struct Bar {
    pub(crate) ends: [usize; 2],
    pub(crate) radius: f64,
    pub(crate) length: f64,
}

#[derive(Clone)]
pub(crate) struct Block {
    pub(crate) corner: DVec3,
    pub(crate) edges: [DVec3; 3],
}

#[derive(Clone)]
pub(crate) struct Face {
    pub(crate) corner: DVec3,
    pub(crate) left: DVec3,
    pub(crate) right: DVec3,
    /// One of the `SURFACE_*` constants.
    pub(crate) surface: u32,
}

/// A cone or a ball, with the unit vectors and lengths of docs/physics section 2.17.
pub(crate) struct Round {
    /// 1 if it is touched from outside, -1 from inside.
    pub(crate) side: f64,
    /// Vector along the axis; `None` for a ball.
    pub(crate) axis: Option<DVec3>,
    /// Radii at the start and at the end of the axis, or of the ball.
    pub(crate) radii: [f64; 2],
}

impl Face {
    pub(crate) fn is_triangle(&self) -> bool {
        self.surface == SURFACE_TRIANGLE
    }

    pub(crate) fn round(&self) -> Option<Round> {
        let is_inside = [SURFACE_CONE + 1, SURFACE_BALL + 1].contains(&self.surface);
        let side = if is_inside { -1.0 } else { 1.0 };
        match self.surface {
            SURFACE_BALL.. => Some(Round { side, axis: None, radii: [self.left.length(); 2] }),
            SURFACE_CONE.. => {
                let slope = self.left.dot(self.right) / self.right.length();
                let axis = self.left - self.right * (slope / self.right.length());
                Some(Round { side, axis: Some(axis), radii: [self.right.length(), self.right.length() + slope] })
            }
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Ball(usize),
    Bar(usize),
    Block(usize),
    Face(usize),
}

#[derive(Clone)]
pub(crate) struct Bodies {
    pub(crate) balls: Vec<Ball>,
    pub(crate) bars: Vec<Bar>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) faces: Vec<Face>,
    /// Group of every object, by id.
    pub(crate) groups: Vec<u32>,
    /// Rods that end in each sphere.
    pub(crate) bars_of: Vec<Vec<usize>>,
    /// Body of each sphere; `None` for a fixed sphere.
    pub(crate) body_of: Vec<Option<Body>>,
    /// Springs and tethers: end spheres, vector between the ends, stiffness and length. The second end of a tether is `None`.
    pub(crate) springs: Vec<([Option<usize>; 2], DVec3, f64, f64)>,
    pub(crate) dt: f64,
    pub(crate) threshold: f64,
    /// Magnitude of gravity.
    pub(crate) gravity: f64,
    pub(crate) restitution: f64,
    /// Coefficient of Coulomb friction.
    pub(crate) coulomb: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) collisions: bool,
}

fn vector(row: Vec4) -> DVec3 {
    row.truncate().as_dvec3()
}

/// Factor of a spring's rest length at the start of the step (docs/physics section 4.9).
fn muscle(world: &World, spring: u32) -> f64 {
    if world.step.layout.muscles_at == 0 {
        return 1.0;
    }
    let record = &world.topology[(world.step.layout.muscles_at + spring * MUSCLE_WORDS) as usize..];
    let turns = |low: usize| (f64::from(record[low]) / 4_294_967_296.0 + f64::from(record[low + 1])) / 4_294_967_296.0;
    let half_steps = 2.0 * (f64::from(world.step.constants.muscle_step) + f64::from(world.status.steps));
    1.0 + f64::from(f32::from_bits(record[0])) * (std::f64::consts::TAU * (turns(1) + half_steps * turns(3))).sin()
}

impl Bodies {
    /// Reads a world with its spheres in stage state `state`.
    pub(crate) fn new(world: &World, state: usize) -> Self {
        let step = &world.step;
        let rows = &world.states[state];
        let n = step.layout.spheres as usize;
        let word = |at: u32, index: u32, words: u32, place: u32| world.topology[(at + index * words + place) as usize];
        let float = |at, index, words, place| f64::from(f32::from_bits(word(at, index, words, place)));
        let triple = |at, index, words, place| DVec3::from_array([0, 1, 2].map(|k: u32| float(at, index, words, place + k)));
        let bars: Vec<Bar> = (0..step.layout.rods)
            .map(|rod| Bar {
                ends: [0, 1].map(|k| word(step.layout.rods_at, rod, ROD_WORDS, k) as usize),
                radius: float(step.layout.rods_at, rod, ROD_WORDS, 2),
                length: float(step.layout.rods_at, rod, ROD_WORDS, 3),
            })
            .collect();
        let mut bars_of = vec![Vec::new(); n];
        for (bar, number) in bars.iter().zip(0..) {
            for end in bar.ends {
                bars_of[end].push(number);
            }
        }
        let objects = step.layout.spheres + step.layout.rods + step.layout.boxes + step.layout.polygons;
        let balls: Vec<Ball> = (0..n)
            .map(|k| Ball {
                x: vector(rows[k]),
                v: vector(rows[n + k]),
                l: vector(rows[2 * n + k]),
                radius: f64::from(rows[k].w),
                w: f64::from(rows[n + k].w),
                i: if rows[n + k].w > 0.0 { f64::from(rows[2 * n + k].w) } else { 0.0 },
                acceleration: DVec3::ZERO,
            })
            .collect();
        let mut bodies = Self {
            blocks: (0..step.layout.boxes)
                .map(|k| Block {
                    corner: triple(step.layout.boxes_at, k, BOX_WORDS, 0),
                    edges: [3, 6, 9].map(|place| triple(step.layout.boxes_at, k, BOX_WORDS, place)),
                })
                .collect(),
            faces: (0..step.layout.polygons)
                .map(|k| Face {
                    corner: triple(step.layout.polygons_at, k, POLYGON_WORDS, 0),
                    left: triple(step.layout.polygons_at, k, POLYGON_WORDS, 3),
                    right: triple(step.layout.polygons_at, k, POLYGON_WORDS, 6),
                    surface: world.topology[(step.layout.polygons_at + k * POLYGON_WORDS + 9) as usize],
                })
                .collect(),
            groups: (0..objects).map(|id| world.topology[(step.layout.tags_at + id) as usize] & 0xffff).collect(),
            body_of: Vec::new(),
            springs: Vec::new(),
            balls,
            bars,
            bars_of,
            dt: f64::from(step.constants.dt),
            threshold: f64::from(step.constants.activation_threshold),
            gravity: f64::from(step.constants.gravity_size),
            restitution: f64::from(step.constants.restitution),
            coulomb: f64::from(step.constants.coulomb_friction),
            stiffness: f64::from(step.constants.contact_force),
            damping: f64::from(step.constants.contact_damping),
            collisions: step.constants.flags & FLAG_COLLISIONS != 0,
        };
        bodies.set_accelerations(world);
        bodies.find_bodies();
        bodies
    }

    /// Computes the accelerations that do not come from contacts (docs/physics sections 4.1 and 4.2).
    fn set_accelerations(&mut self, world: &World) {
        let step = &world.step;
        let triple = |at: usize| DVec3::from_array([0, 1, 2].map(|k| f64::from(f32::from_bits(world.topology[at + k]))));
        let spring = |one: (DVec3, DVec3), other: (DVec3, DVec3), constants: DVec3| {
            let d = other.0 - one.0;
            let n = d.normalize_or_zero();
            (constants.x * (d.length() - constants.y) + constants.z * (other.1 - one.1).dot(n)) * n
        };
        let gravity = DVec3::from_array(step.constants.gravity.map(f64::from));
        let mut springs = Vec::new();
        for k in (0..self.balls.len()).filter(|k| self.balls[*k].w > 0.0).collect::<Vec<_>>() {
            let at = step.layout.adjacency_at as usize + 2 * k;
            let words =
                if step.layout.adjacency_at == 0 { 0..0 } else { world.topology[at] as usize..world.topology[at + 1] as usize };
            let own = (self.balls[k].x, self.balls[k].v);
            let mut force = DVec3::ZERO;
            for word in &world.topology[words] {
                let index = word & ((1 << KIND_SHIFT) - 1);
                match word >> KIND_SHIFT {
                    KIND_SPRING => {
                        let at = (step.layout.springs_at + index * SPRING_WORDS) as usize;
                        let ends = [at, at + 1].map(|end| world.topology[end] as usize);
                        let other = &self.balls[ends[usize::from(ends[0] == k)]];
                        let mut constants = triple(at + 2);
                        constants.y *= muscle(world, index);
                        force += spring(own, (other.x, other.v), constants);
                        let fixed_other = other.w == 0.0;
                        if ends[0] == k || fixed_other {
                            let both = [Some(k), Some(ends[usize::from(ends[0] == k)])];
                            springs.push((both, other.x - own.0, constants.x, constants.y));
                        }
                    }
                    KIND_TETHER => {
                        let at = (step.layout.tethers_at + index * TETHER_WORDS) as usize;
                        let constants = triple(at + 4);
                        force += spring(own, (triple(at + 1), DVec3::ZERO), constants);
                        springs.push(([Some(k), None], triple(at + 1) - own.0, constants.x, constants.y));
                    }
                    KIND_FORCE => force += triple((step.layout.forces_at + index * FORCE_WORDS) as usize),
                    _ => {}
                }
            }
            self.balls[k].acceleration = gravity + self.balls[k].w * force;
        }
        self.springs = springs;
    }

    /// Sets the body of each sphere.
    fn find_bodies(&mut self) {
        let moves = |ball: usize| self.balls[ball].w > 0.0;
        let mut least: Vec<usize> = (0..self.balls.len()).collect();
        let in_network = |bar: usize| self.bars[bar].length > 0.0 && !self.is_capsule(bar);
        let network_bars: Vec<[usize; 2]> =
            (0..self.bars.len()).filter(|bar| in_network(*bar)).map(|bar| self.bars[bar].ends).collect();
        loop {
            let before = least.clone();
            for [one, two] in network_bars.iter().filter(|ends| ends.iter().all(|end| moves(*end))) {
                let both = least[*one].min(least[*two]);
                (least[*one], least[*two]) = (both, both);
            }
            if least == before {
                break;
            }
        }
        let body = |ball: usize| match self.bars_of[ball].iter().find(|bar| self.is_capsule(**bar)) {
            _ if !moves(ball) => None,
            Some(bar) => Some(Body::Capsule(*bar)),
            None if self.bars_of[ball].iter().any(|bar| in_network(*bar)) => Some(Body::Network(least[ball])),
            None => Some(Body::Ball(ball)),
        };
        self.body_of = (0..self.balls.len()).map(body).collect();
    }

    /// Whether a rod and its ends form a rigid capsule.
    pub(crate) fn is_capsule(&self, bar: usize) -> bool {
        let Bar { ends, length, .. } = &self.bars[bar];
        *length > 0.0 && ends.iter().all(|end| self.balls[*end].w > 0.0 && self.bars_of[*end].len() == 1)
    }

    /// Returns the rod of the rigid capsule that contains an object.
    pub(crate) fn capsule_with(&self, id: usize) -> Option<usize> {
        match self.kind(id) {
            Kind::Ball(ball) => match self.body_of[ball] {
                Some(Body::Capsule(bar)) => Some(bar),
                _ => None,
            },
            Kind::Bar(bar) => self.is_capsule(bar).then_some(bar),
            Kind::Block(_) | Kind::Face(_) => None,
        }
    }

    /// Returns the smaller radius of a pair. Boxes and polygons count as infinite.
    pub(crate) fn smaller_radius(&self, a: usize, b: usize) -> f64 {
        let radius = |id| match self.kind(id) {
            Kind::Ball(ball) => self.balls[ball].radius,
            Kind::Bar(bar) => self.bars[bar].radius,
            Kind::Block(_) | Kind::Face(_) => f64::INFINITY,
        };
        radius(a).min(radius(b))
    }

    /// Returns the threshold velocity of a pair (docs/physics section 3.1).
    pub(crate) fn threshold(&self, a: usize, b: usize) -> f64 {
        (self.threshold * self.smaller_radius(a, b)).max(2.0 * self.gravity * self.dt)
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

    /// Returns a sphere itself, or the end spheres of a rod.
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

    /// Returns the positions of both ends of a rod.
    pub(crate) fn segment(&self, bar: usize) -> [DVec3; 2] {
        self.bars[bar].ends.map(|end| self.balls[end].x)
    }

    /// Whether a pair may overlap: both are in one group, at least one of them moves, and neither is part of the other.
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
