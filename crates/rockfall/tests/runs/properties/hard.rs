//! Random scenes of hard contacts (docs/physics section 11) keep what the law promises.

use std::path::Path;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use rockfall::{Backend, Checkpoint, Options, RigidBody, Scene, Simulation};

use super::things::{Outcome, check, direction, vector};

const FRAME: f32 = 1.0 / 60.0;
/// Half the edge of the room inside the walls.
const ROOM: f32 = 5.0;
/// Thickness of the walls.
const THICK: f32 = 20.0;
/// Frames of a run.
const FRAMES: u64 = 40;

/// A body. All of it is within `radius` of the origin of its shape.
#[derive(Clone, Debug)]
struct Solid {
    kind: u8,
    radius: f32,
    /// Proportions of a box.
    edges: [f32; 3],
    /// Vertices of a hull, as parts of the radius.
    points: Vec<Vec3>,
    mass: f32,
    /// From -1 to 1 along each axis.
    at: Vec3,
    axis: Vec3,
    turn: f32,
    /// In units of two radii in a frame.
    velocity: Vec3,
    /// In rad/s.
    spin: Vec3,
    material: u8,
}

#[derive(Clone, Debug)]
struct Heap {
    solids: Vec<Solid>,
    gravity: f32,
    /// Restitution and friction of two materials with themselves; between them those of the scene hold.
    pairs: [[f32; 2]; 3],
    substeps: Option<u32>,
    walls: bool,
}

/// A number whose logarithm is even between those of two numbers.
fn decades(from: f32, to: f32) -> impl Strategy<Value = f32> {
    (from.log10()..to.log10()).prop_map(|exponent| 10_f32.powf(exponent))
}

fn solid() -> impl Strategy<Value = Solid> {
    let form = (0..5_u8, decades(0.02, 2.0), [0.2_f32..1.0, 0.2_f32..1.0, 0.2_f32..1.0]);
    let points = prop::collection::vec(direction(), 6..10);
    let place = (vector(1.0), direction(), 0.0_f32..360.0);
    let motion = (direction(), 0.0_f32..1.0, vector(20.0), decades(1.0, 1000.0), 0..2_u8);
    (form, points, place, motion).prop_map(|((kind, radius, edges), points, (at, axis, turn), motion)| {
        let (way, speed, spin, mass, material) = motion;
        // Most bodies are slow.
        Solid { kind, radius, edges, points, mass, at, axis, turn, velocity: speed.powi(4) * way, spin, material }
    })
}

fn heap(walls: bool, gravity: f32) -> impl Strategy<Value = Heap> {
    let pair = || prop_oneof![[0.0_f32..1.0, 0.0_f32..1.0], Just([0.0, 0.0]), Just([1.0, 0.0]), Just([0.0, 1.0])];
    let substeps = prop_oneof![Just(None), (1..9_u32).prop_map(Some)];
    (prop::collection::vec(solid(), 2..10), 0.0..=gravity, [pair(), pair(), pair()], substeps)
        .prop_map(move |(solids, gravity, pairs, substeps)| Heap { solids, gravity, pairs, substeps, walls })
}

fn words(vector: Vec3) -> String {
    let [x, y, z] = vector.to_array();
    format!("{x},{y},{z}")
}

impl Solid {
    /// Where it starts, in the room.
    fn place(&self) -> Vec3 {
        self.at * (ROOM - self.radius)
    }

    /// The lines of a body with a name, and of its place.
    fn text(&self, number: usize) -> String {
        let Self { kind, radius, mass, spin, turn, .. } = *self;
        let (at, velocity) = (self.place(), 2.0 * radius / FRAME * self.velocity);
        let edges = 2.0 * radius * Vec3::from_array(self.edges).normalize();
        let corner = |edges: Vec3| -0.5 * edges;
        let cuboid = |edges: Vec3| {
            let Vec3 { x, y, z } = corner(edges);
            format!("B {x} {y} {z} {} 0 0 0 {} 0 0 0 {}\n", edges.x, edges.y, edges.z)
        };
        let part = match kind {
            0 => {
                let l = 0.4 * mass * radius * radius * spin;
                let [x, v] = [at, velocity].map(|vector| words(vector).replace(',', " "));
                return format!("@use m{}\nS {number} {x} {v} {} {} {} {mass} {radius}\n", self.material, l.x, l.y, l.z);
            }
            1 => format!("C {} 0 0 {} 0 0 0 0 0 - {}\n", -0.6 * radius, 0.6 * radius, 0.4 * radius),
            2 => cuboid(edges),
            3 => {
                // A tetrahedron, so that no hull is flat, and points around it.
                let corners = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)].map(Vec3::from);
                let all = self.points.iter().copied().chain(corners.map(|corner| 0.57 * corner));
                let points = all.map(|point| words(point * radius));
                format!("@hull {}\n", points.collect::<Vec<_>>().join(" "))
            }
            _ => format!("{}S 1 0 {} 0 0 0 0 0 0 0 - {}\n", cuboid(0.7 * edges), 0.6 * radius, 0.4 * radius),
        };
        format!(
            "@body b{number} mass={mass}\n@use m{}\n{part}@end\n@place b{number} at={} axis={} turn={turn} velocity={} spin={}\n",
            self.material,
            words(at),
            words(self.axis),
            words(velocity),
            words(spin)
        )
    }
}

impl Heap {
    fn text(&self) -> String {
        let [[e, mu], ..] = self.pairs;
        let mut text = format!(
            "set contact_law rigid\nset gravity {}\nset restitution {e}\nset coulomb_friction {mu}\n@material m0\n@material m1\n",
            self.gravity
        );
        for (material, [e, mu]) in self.pairs[1..].iter().enumerate() {
            text += &format!("@pair m{material} m{material} restitution={e} friction={mu}\n");
        }
        if let Some(substeps) = self.substeps {
            text += &format!("@run substeps={substeps}\n");
        }
        text += "@use m0\n";
        if self.walls {
            let (long, edge) = (ROOM + THICK, 2.0 * (ROOM + THICK));
            for axis in 0..3 {
                for from in [-long, ROOM] {
                    let (mut corner, mut edges) = ([-long; 3], [edge; 3]);
                    (corner[axis], edges[axis]) = (from, THICK);
                    let ([x, y, z], [i, j, k]) = (corner, edges);
                    text += &format!("B {x} {y} {z} {i} 0 0 0 {j} 0 0 0 {k}\n");
                }
            }
        }
        self.solids.iter().enumerate().fold(text, |text, (number, solid)| text + &solid.text(number))
    }

    /// The bodies that are clear of those before them.
    fn apart(mut self) -> Self {
        let mut kept: Vec<Solid> = Vec::new();
        for solid in self.solids {
            let clear = |other: &Solid| other.place().distance(solid.place()) > 1.02 * (other.radius + solid.radius);
            if kept.iter().all(clear) {
                kept.push(solid);
            }
        }
        self.solids = kept;
        self
    }

    fn open(&self) -> Simulation {
        let text = self.text();
        let scene = Scene::parse(&text, Path::new("heap")).unwrap_or_else(|error| panic!("{error}\n{text}")).scene;
        Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

/// What a body is at a moment: mass, centre, velocity, angular momentum about its centre.
struct Moving {
    mass: f64,
    centre: DVec3,
    velocity: DVec3,
    momentum: DVec3,
}

/// All bodies: loose spheres, then the others.
fn moving(simulation: &mut Simulation) -> Vec<Moving> {
    let scene = simulation.sync().expect("states");
    let loose =
        scene.sphere_ids().zip(scene.spheres()).filter(|(id, sphere)| !sphere.fixed && scene.body_of_sphere(*id).is_none());
    let spheres = loose.map(|(_, sphere)| Moving {
        mass: f64::from(sphere.mass),
        centre: sphere.position.as_dvec3(),
        velocity: sphere.velocity.as_dvec3(),
        momentum: sphere.angular_momentum.as_dvec3(),
    });
    let body = |body: &RigidBody| Moving {
        mass: body.spheres().iter().map(|id| f64::from(scene.sphere(*id).expect("a part").mass)).sum(),
        centre: body.position.as_dvec3(),
        velocity: body.velocity.as_dvec3(),
        momentum: body.angular_momentum.as_dvec3(),
    };
    spheres.chain(scene.bodies().iter().map(body)).collect()
}

/// The state of everything, which text equals only if bits do.
fn bits(simulation: &mut Simulation) -> String {
    let spheres = simulation.spheres().expect("states");
    let contacts = simulation.contacts().expect("contacts");
    format!("{spheres:?} {:?} {contacts:?}", simulation.sync().expect("states").bodies())
}

fn run(simulation: &mut Simulation, frames: u64) {
    simulation.run(frames, FRAME).expect("states stay finite");
}

/// A run in one part, in two, and through the bytes of a checkpoint have the same bits.
fn assert_split(heap: &Heap, whole: &str, at: u64) -> Outcome {
    let mut split = heap.open();
    run(&mut split, at);
    split.sort_memory().expect("an order");
    let bytes = split.checkpoint().expect("a checkpoint").to_bytes();
    run(&mut split, FRAMES - at);
    prop_assert_eq!(&bits(&mut split), whole, "in two parts: {}", heap.text());
    let checkpoint = Checkpoint::from_bytes(&bytes, "heap").expect("it reads");
    let mut resumed = Simulation::resume(checkpoint).expect("it goes on");
    run(&mut resumed, FRAMES - at);
    prop_assert_eq!(&bits(&mut resumed), whole, "from a checkpoint: {}", heap.text());
    Ok(())
}

/// The centres of all bodies stay within `most` units from the room. Then runs in parts have the same bits.
fn assert_closed(heap: &Heap, most: f64, at: u64) -> Outcome {
    let mut simulation = heap.open();
    for _ in 0..FRAMES {
        run(&mut simulation, 1);
        for body in moving(&mut simulation) {
            let outside = body.centre.abs().max_element() - f64::from(ROOM);
            prop_assert!(outside < most, "{} by {outside}\n{}", body.centre, heap.text());
        }
    }
    assert_split(heap, &bits(&mut simulation), at)
}

/// Bodies of all kinds, sizes of 1 to 100, masses of 1 to 1000, with overlaps at the start, in a closed room. A grain that a body of
/// a thousand times its mass hits at 100 units/s may be driven into a wall, but not through it.
#[test]
fn no_body_passes_the_walls_of_a_closed_room() {
    check(250, (heap(true, 20.0), 1..FRAMES), |(heap, at)| assert_closed(&heap, f64::from(THICK) / 2.0, at));
}

/// With masses of 1 to 10 that start apart, and cross a tenth of themselves in a frame, no centre gets into a wall.
#[test]
fn no_centre_of_a_body_leaves_a_closed_room() {
    check(100, (heap(true, 20.0), 1..FRAMES), |(mut heap, at)| -> Outcome {
        for solid in &mut heap.solids {
            (solid.mass, solid.velocity) = (solid.mass.cbrt(), 0.1 * solid.velocity);
        }
        assert_closed(&heap.apart(), 0.0, at)
    });
}

/// So many pairs that they are shared out among threads.
#[test]
fn a_crowd_of_hard_contacts_has_the_same_bits_with_one_and_two_threads() {
    let mut text =
        "set contact_law rigid\nset gravity 9.81\nset restitution 0.3\nB -20 -1 -20 40 0 0 0 1 0 0 0 40\n".to_owned();
    text += "@body b mass=2\nB -0.4 -0.4 -0.4 0.8 0 0 0 0.8 0 0 0 0.8\n@end\n@body c mass=1\nC -0.2 0 0 0.2 0 0 0 0 0 - 0.3\n@end\n";
    for k in 0..600_u32 {
        let (x, y, z) = (0.8 * (k % 10) as f32, 0.4 + 0.78 * (k / 100) as f32, 0.79 * (k / 10 % 10) as f32);
        text += &match k % 3 {
            0 => format!("S {k} {x} {y} {z} 0 0 0 0 0 0 1 0.4\n"),
            1 => format!("@place b at={x},{y},{z}\n"),
            _ => format!("@place c at={x},{y},{z} axis=0,1,0 turn={k}\n"),
        };
    }
    let end = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let scene = Scene::parse(&text, Path::new("crowd")).expect("a scene").scene;
            let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
            run(&mut simulation, 10);
            let contacts = simulation.contacts().expect("contacts").len();
            assert!(contacts > 500, "{contacts}");
            bits(&mut simulation)
        })
    };
    assert!(end(1) == end(2), "the states differ");
}

/// Sums of momenta, and the sizes of what was added, which measure rounding.
fn sums(bodies: &[Moving]) -> [DVec3; 2] {
    let momentum = bodies.iter().map(|body| body.mass * body.velocity).sum();
    let angular = bodies.iter().map(|body| body.centre.cross(body.mass * body.velocity) + body.momentum).sum();
    [momentum, angular]
}

fn sizes(bodies: &[Moving]) -> [f64; 2] {
    let momentum = bodies.iter().map(|body| body.mass * body.velocity.length()).sum();
    let angular = bodies.iter().map(|body| body.mass * body.centre.length() * body.velocity.length() + body.momentum.length());
    [momentum, angular.sum()]
}

/// The impulses of contacts are internal, with overlaps, friction and left-over blocks.
#[test]
fn hard_contacts_keep_momentum_and_angular_momentum() {
    check(300, heap(false, 0.0), |heap| -> Outcome {
        let mut simulation = heap.open();
        let first = moving(&mut simulation);
        let (was, mut most) = (sums(&first), sizes(&first));
        for _ in 0..FRAMES {
            run(&mut simulation, 1);
            let now = moving(&mut simulation);
            most = [0, 1].map(|k| most[k].max(sizes(&now)[k]));
            let is = sums(&now);
            for k in 0..2 {
                let off = is[k].distance(was[k]) / most[k];
                prop_assert!(off < 1e-4, "{k}: {off:e}\n{}", heap.text());
            }
        }
        Ok(())
    });
}

/// Without overlaps at the start and without a field, contacts take energy and give none.
#[test]
fn hard_contacts_give_no_energy() {
    check(300, (heap(true, 0.0), any::<bool>()), |(heap, walls)| -> Outcome {
        let heap = Heap { walls, ..heap.apart() };
        let mut simulation = heap.open();
        let mut before = simulation.energy().expect("the energy").kinetic;
        for frame in 0..FRAMES {
            run(&mut simulation, 1);
            let energy = simulation.energy().expect("the energy").kinetic;
            // What a wait in a chain of impacts overlaps is pushed out: at most 0.5 % in these scenes (section 11.12).
            prop_assert!(energy <= before * (1.0 + 1e-2), "frame {frame}: {before} to {energy}\n{}", heap.text());
            before = energy;
        }
        Ok(())
    });
}
