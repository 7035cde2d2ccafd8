//! State of a scene in f64, and the bodies that its spheres form (docs/physics sections 1 and 3).

use rockfall::glam::{DQuat, DVec3, Vec3};
use rockfall::{Integrator, Scene, Settings, SphereState};

pub(crate) use crate::mistakes::Mistake;
use crate::walls::{Path, at_rest};

/// A sphere.
#[derive(Clone, Debug)]
pub(crate) struct Ball {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    /// Angular momentum.
    pub(crate) l: DVec3,
    pub(crate) q: DQuat,
    pub(crate) mass: f64,
    pub(crate) radius: f64,
    pub(crate) fixed: bool,
    pub(crate) force: DVec3,
    pub(crate) group: u16,
}

impl Ball {
    pub(crate) fn inertia(&self) -> f64 {
        0.4 * self.mass * self.radius * self.radius
    }

    /// Inverse mass, or 0 for a fixed sphere.
    pub(crate) fn w(&self) -> f64 {
        if self.fixed { 0.0 } else { 1.0 / self.mass }
    }

    /// Inverse moment of inertia, or 0 for a fixed sphere.
    pub(crate) fn i(&self) -> f64 {
        if self.fixed { 0.0 } else { 1.0 / self.inertia() }
    }

    /// Spin. For a fixed sphere it is that of its surface.
    pub(crate) fn spin(&self) -> DVec3 {
        self.l / self.inertia()
    }

    pub(crate) fn set(&mut self, state: &SphereState) {
        self.x = state.position.as_dvec3();
        self.v = state.velocity.as_dvec3();
        self.l = state.angular_momentum.as_dvec3();
        self.q = state.orientation.as_dquat().normalize();
    }
}

/// A rod.
#[derive(Clone, Debug)]
pub(crate) struct Bar {
    pub(crate) ends: [usize; 2],
    pub(crate) radius: f64,
    pub(crate) length: Option<f64>,
    pub(crate) group: u16,
}

/// The far end of a spring or tether.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Ball(usize),
    Point(DVec3),
}

/// A spring or a tether.
#[derive(Clone, Debug)]
pub(crate) struct Pull {
    pub(crate) ball: usize,
    pub(crate) anchor: Anchor,
    pub(crate) stiffness: f64,
    pub(crate) length: f64,
    pub(crate) damping: f64,
}

/// A box of a wall.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) corner: DVec3,
    pub(crate) edges: [DVec3; 3],
    pub(crate) group: u16,
    /// Number of the motion that it follows.
    pub(crate) motion: Option<usize>,
    /// Surface velocity.
    pub(crate) belt: DVec3,
}

/// A polygon of a wall.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    pub(crate) corner: DVec3,
    pub(crate) left: DVec3,
    pub(crate) right: DVec3,
    pub(crate) is_triangle: bool,
    pub(crate) group: u16,
    pub(crate) motion: Option<usize>,
    pub(crate) belt: DVec3,
}

/// The body that a moving sphere belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Body {
    /// A sphere that is a body on its own.
    Single(usize),
    /// A rigid capsule, by the index of its rod.
    Capsule(usize),
    /// A network, by its index.
    Network(usize),
}

/// The constants of docs/physics section 6.
#[derive(Clone, Debug)]
pub(crate) struct Constants {
    pub(crate) threshold: f64,
    pub(crate) restitution: f64,
    pub(crate) damping: f64,
    pub(crate) stiffness: f64,
    pub(crate) friction: f64,
    pub(crate) coulomb: f64,
    pub(crate) collision_friction: f64,
    pub(crate) gravity: DVec3,
    pub(crate) linear_damping: f64,
    pub(crate) angular_damping: f64,
    pub(crate) collisions: bool,
    pub(crate) pull: bool,
    pub(crate) integrator: Integrator,
}

impl Constants {
    pub(crate) fn of(settings: &Settings, integrator: Integrator) -> Self {
        Self {
            threshold: settings.activation_threshold.into(),
            restitution: settings.restitution.into(),
            damping: settings.contact_damping.into(),
            stiffness: settings.contact_force.into(),
            friction: settings.friction.into(),
            coulomb: settings.coulomb_friction.into(),
            collision_friction: settings.collision_friction.into(),
            linear_damping: settings.linear_damping.into(),
            angular_damping: settings.angular_damping.into(),
            gravity: f64::from(settings.gravity) * settings.gravity_direction.as_dvec3(),
            collisions: settings.collisions,
            pull: settings.contact_pull,
            integrator,
        }
    }
}

/// How the sweeps over rod lengths run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sweeps {
    /// In the order of the rods, until only rounding errors of f64 are left.
    Exact,
    /// In a random order given by this seed, until the tolerance of the specification. Any implementation may differ by
    /// this much.
    WithinTolerance(u64),
}

/// A scene in f64.
#[derive(Clone, Debug)]
pub(crate) struct World {
    pub(crate) balls: Vec<Ball>,
    pub(crate) bars: Vec<Bar>,
    pub(crate) pulls: Vec<Pull>,
    /// Walls where they are at `time`.
    pub(crate) blocks: Vec<Block>,
    pub(crate) faces: Vec<Face>,
    pub(crate) blocks_at_rest: Vec<Block>,
    pub(crate) faces_at_rest: Vec<Face>,
    pub(crate) paths: Vec<Path>,
    pub(crate) time: f64,
    pub(crate) set: Constants,
    /// Greatest angle between the normals of triangles that count as one, in rad.
    pub(crate) mesh_angle: f64,
    pub(crate) dt: f64,
    /// Body of every sphere; `None` for fixed ones.
    pub(crate) body: Vec<Option<Body>>,
    /// Rods of every network.
    pub(crate) networks: Vec<Vec<usize>>,
    pub(crate) sweeps: Sweeps,
    pub(crate) mistake: Option<Mistake>,
    /// A point outside a box by less than this fraction of its edges counts as inside. It is 0 except to find what
    /// rounding may decide.
    pub(crate) slack: f64,
    /// Whether something occurred that the specification does not define.
    pub(crate) lost: bool,
    /// Sizes of the accelerations of spheres by everything but contacts and damping, at the start of the last phase 3.
    pub(crate) pulled: Option<Vec<f64>>,
}

fn wide(v: Vec3) -> DVec3 {
    v.as_dvec3()
}

impl World {
    pub(crate) fn of(scene: &Scene, integrator: Integrator, dt: f64) -> Self {
        let ids: Vec<_> = scene.sphere_ids().collect();
        let number = |id| ids.iter().position(|&known| known == id).expect("a sphere of the scene");
        let balls = scene.spheres().iter().map(|sphere| {
            let mut ball = Ball {
                x: DVec3::ZERO,
                v: DVec3::ZERO,
                l: DVec3::ZERO,
                q: DQuat::IDENTITY,
                mass: sphere.mass.into(),
                radius: sphere.radius.into(),
                fixed: sphere.fixed,
                force: wide(sphere.force),
                group: sphere.group,
            };
            ball.set(&SphereState::from(sphere));
            ball
        });
        let bars = scene.rods().iter().map(|rod| Bar {
            ends: [number(rod.end1), number(rod.end2)],
            radius: rod.radius.into(),
            length: rod.length.map(f64::from),
            group: rod.group,
        });
        let (blocks, faces) = at_rest(scene);
        let mut world = Self {
            balls: balls.collect(),
            bars: bars.collect(),
            pulls: pulls(scene, number),
            blocks: blocks.clone(),
            faces: faces.clone(),
            blocks_at_rest: blocks,
            faces_at_rest: faces,
            paths: Path::all(scene),
            time: 0.0,
            set: Constants::of(&scene.settings, integrator),
            mesh_angle: f64::from(scene.settings.mesh_angle).to_radians(),
            dt,
            body: Vec::new(),
            networks: Vec::new(),
            sweeps: Sweeps::Exact,
            mistake: None,
            slack: 0.0,
            lost: false,
            pulled: None,
        };
        world.find_bodies();
        world.place_walls(0.0);
        world
    }

    pub(crate) fn made(&self, mistake: Mistake) -> bool {
        self.mistake == Some(mistake)
    }

    /// Rod of the rigid capsule that a moving sphere belongs to, and which end the sphere is (0 or 1).
    pub(crate) fn capsule_end(&self, ball: usize) -> Option<(usize, usize)> {
        match self.body[ball] {
            Some(Body::Capsule(bar)) => Some((bar, usize::from(self.bars[bar].ends[1] == ball))),
            _ => None,
        }
    }

    pub(crate) fn is_capsule(&self, bar: usize) -> bool {
        self.body[self.bars[bar].ends[0]] == Some(Body::Capsule(bar))
    }

    /// Finds capsules and networks (docs/physics section 1.4).
    fn find_bodies(&mut self) {
        let mut rods_at = vec![0; self.balls.len()];
        for end in self.bars.iter().flat_map(|bar| bar.ends) {
            rods_at[end] += 1;
        }
        self.body = (0..self.balls.len()).map(|ball| (!self.balls[ball].fixed).then_some(Body::Single(ball))).collect();
        let mut chain = Vec::new();
        for (number, bar) in self.bars.iter().enumerate() {
            let [one, two] = bar.ends;
            let moving = bar.ends.map(|end| !self.balls[end].fixed);
            let apart = self.balls[one].x.distance_squared(self.balls[two].x) > 1e-30;
            if bar.length.is_none() || moving == [false; 2] {
                continue;
            }
            if moving == [true; 2] && bar.ends.map(|end| rods_at[end]) == [1; 2] && apart {
                self.body[one] = Some(Body::Capsule(number));
                self.body[two] = Some(Body::Capsule(number));
            } else {
                chain.push(number);
            }
        }
        self.join(&chain);
    }

    /// Groups rods that are connected through moving spheres into networks.
    fn join(&mut self, rods: &[usize]) {
        let mut network_of: Vec<Option<usize>> = vec![None; self.balls.len()];
        let mut networks: Vec<Vec<usize>> = Vec::new();
        for &rod in rods {
            let moving: Vec<usize> = self.bars[rod].ends.into_iter().filter(|&end| !self.balls[end].fixed).collect();
            let number = networks.len();
            networks.push(vec![rod]);
            for end in moving {
                if let Some(old) = network_of[end].filter(|&old| old != number) {
                    let merged = std::mem::take(&mut networks[old]);
                    networks[number].extend(merged);
                    for of in &mut network_of {
                        if *of == Some(old) {
                            *of = Some(number);
                        }
                    }
                }
                network_of[end] = Some(number);
            }
        }
        for (ball, number) in network_of.iter().enumerate() {
            if let Some(number) = number {
                self.body[ball] = Some(Body::Network(*number));
            }
        }
        self.networks = networks;
    }
}

fn pulls(scene: &Scene, number: impl Fn(rockfall::SphereId) -> usize) -> Vec<Pull> {
    let springs = scene.springs().iter().map(|spring| Pull {
        ball: number(spring.a),
        anchor: Anchor::Ball(number(spring.b)),
        stiffness: spring.stiffness.into(),
        length: spring.length.into(),
        damping: spring.damping.into(),
    });
    let tethers = scene.tethers().iter().map(|tether| Pull {
        ball: number(tether.sphere),
        anchor: Anchor::Point(wide(tether.point)),
        stiffness: tether.stiffness.into(),
        length: tether.length.into(),
        damping: tether.damping.into(),
    });
    springs.chain(tethers).collect()
}
