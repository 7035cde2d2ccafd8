//! The witness's world of a scene (docs/physics sections 11.1 and 11.13).

use std::collections::HashMap;

use rockfall::glam::{DMat3, DQuat, DVec3, Vec3};
use rockfall::{Anchor, Cuboid, Joint, Polygon, RigidBody, Scene, Shape as Form, Simulation, Sphere, Surface};

use super::joints::{Impulses, Link, Load};
use super::shapes::{Core, Shape};
use super::solver::{Body, Collider, Solver, State};

/// State of a body for comparisons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    pub(crate) l: DVec3,
    pub(crate) q: DQuat,
}

fn sphere_state(sphere: &Sphere) -> Seen {
    Seen {
        x: DVec3::from_array(sphere.centre()),
        v: sphere.velocity.as_dvec3(),
        l: sphere.angular_momentum.as_dvec3(),
        q: sphere.orientation.as_dquat().normalize(),
    }
}

fn body_state(body: &RigidBody) -> Seen {
    Seen {
        x: DVec3::from_array(body.centre()),
        v: body.velocity.as_dvec3(),
        l: body.angular_momentum.as_dvec3(),
        q: body.orientation.as_dquat().normalize(),
    }
}

/// What moves in a scene, in the order of the numbers of bodies: rigid bodies, then loose balls.
enum Mover<'a> {
    Ball(&'a Sphere, Anchor),
    Clump(&'a RigidBody, Anchor),
}

fn movers(scene: &Scene) -> Vec<Mover<'_>> {
    let mut found = Vec::new();
    let bodies: HashMap<_, _> =
        scene.body_ids().zip(scene.bodies()).map(|(id, body)| (body.spheres()[0], (id, body))).collect();
    for (id, sphere) in scene.sphere_ids().zip(scene.spheres()) {
        match (bodies.get(&id), scene.body_of_sphere(id)) {
            (Some(&(body, state)), _) => found.push(Mover::Clump(state, Anchor::Body(body))),
            (None, None) if !sphere.fixed => found.push(Mover::Ball(sphere, Anchor::Sphere(id))),
            _ => {}
        }
    }
    found.sort_by_key(|mover| !matches!(mover, Mover::Ball(..)));
    found
}

/// The states of all bodies of a simulation, in the order of the witness.
pub(crate) fn states(simulation: &mut Simulation) -> Vec<Seen> {
    let scene = simulation.sync().expect("states");
    let of = |mover: Mover<'_>| match mover {
        Mover::Ball(sphere, _) => sphere_state(sphere),
        Mover::Clump(body, _) => body_state(body),
    };
    movers(scene).into_iter().map(of).collect()
}

/// A box: its middle, the turn of its edges, and its core.
fn cuboid(cuboid: &Cuboid) -> (DVec3, DQuat, Core) {
    let [i, j, k] = cuboid.edges.map(|edge| edge.as_dvec3());
    let (x, y) = (i.normalize(), j.normalize());
    let turn = DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y))).normalize();
    let half = 0.5 * DVec3::new(i.length(), j.length(), k.length());
    (cuboid.corner.as_dvec3() + 0.5 * (i + j + k), turn, Core::Cuboid(half))
}

/// A polygon: the origin of its coordinates, their turn, and its core.
fn polygon(polygon: &Polygon) -> (DVec3, DQuat, Core) {
    let [p, l, r] = [polygon.corner, polygon.left, polygon.right].map(|edge| edge.as_dvec3());
    let (x, z) = (l.normalize(), l.cross(r).normalize());
    let flat = DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize();
    let local = |at: DVec3| flat.inverse() * at;
    match polygon.surface {
        Surface::Parallelogram => {
            (p + 0.5 * (l + r), flat, Core::Face { u: local(0.5 * l), v: local(0.5 * r), triangle: false })
        }
        Surface::Triangle => {
            let middle = p + (l + r) / 3.0;
            (middle, flat, Core::Face { u: local(p - middle), v: local(p + l - middle), triangle: true })
        }
        // The half-space of y of at most 0.
        _ => (p, DQuat::from_mat3(&DMat3::from_cols(z.cross(x), z, x)).normalize() * DQuat::IDENTITY, Core::HalfSpace),
    }
}

fn dynamic(seen: Seen, mass: f64, moments: DVec3, axes: DQuat) -> Body {
    let state = State { x: seen.x, q: seen.q, v: seen.v, w: DVec3::ZERO };
    let mut body = Body { has_mass: true, mass, moments, axes, state, l: seen.l, rho: 0.0, ..Body::world() };
    body.state.w = body.inverse(seen.q) * seen.l;
    body
}

fn walls(scene: &Scene) -> Vec<Collider> {
    let boxes = scene.boxes().iter().map(|one| (cuboid(one), one.surface_velocity));
    let faces = scene.polygons().iter().map(|one| (polygon(one), one.surface_velocity));
    let of = |((place, turn, core), belt): ((DVec3, DQuat, Core), Vec3)| Collider {
        body: 0,
        shape: Shape { core, radius: 0.0 },
        place,
        turn,
        belt: belt.as_dvec3(),
    };
    let fixed = scene.spheres().iter().filter(|sphere| sphere.fixed).map(|sphere| Collider {
        body: 0,
        shape: Shape { core: Core::Point, radius: sphere.radius.into() },
        place: DVec3::from_array(sphere.centre()),
        turn: DQuat::IDENTITY,
        belt: DVec3::ZERO,
    });
    boxes.chain(faces).map(of).chain(fixed).collect()
}

fn parts(form: &Form, body: usize, centre: DVec3) -> Vec<Collider> {
    let collider = |place: DVec3, turn, core, radius| {
        let shape = Shape { core, radius };
        Collider { body, shape, place: place - centre, turn, belt: DVec3::ZERO }
    };
    let balls = form.spheres.iter().map(|one| collider(one.centre.as_dvec3(), DQuat::IDENTITY, Core::Point, one.radius.into()));
    let boxes = form.boxes.iter().map(|one| {
        let (place, turn, core) = cuboid(&one.cuboid);
        collider(place, turn, core, 0.0)
    });
    balls.chain(boxes).collect()
}

impl Link {
    fn new(joint: &Joint, bodies: [usize; 2]) -> Self {
        let ends = joint.ends().expect("a joint of a scene").map(|end| (end.place.as_dvec3(), end.turn.as_dquat().normalize()));
        Self {
            kind: joint.kind,
            bodies,
            ends,
            errors: [(DVec3::ZERO, DQuat::IDENTITY); 2],
            limits: joint.limits.map(|limits| limits.map(f64::from)),
            cone: joint.cone.map(f64::from),
            speed: joint.speed.map(f64::from),
            most: joint.max_force.into(),
            rest: joint.rest().into(),
            stiffness: joint.stiffness.into(),
            damping: joint.damping.into(),
            effort: joint.effort.into(),
            drag: joint.drag.into(),
            armature: joint.armature.into(),
            off: 0.0,
            rotor: DVec3::ZERO,
            friction: joint.friction.into(),
            locked: joint.is_locked(),
            collides: joint.collides,
            colour: 0,
            angle: 0.0,
            impulses: Impulses::default(),
            load: Load::default(),
        }
    }
}

/// The world of a scene at its start.
pub(crate) fn solver(scene: &Scene) -> Solver {
    let (mut bodies, mut colliders) = (vec![Body::world()], walls(scene));
    let mut numbers = HashMap::new();
    for mover in movers(scene) {
        let number = bodies.len();
        match mover {
            Mover::Ball(sphere, anchor) => {
                let (mass, radius) = (f64::from(sphere.mass), f64::from(sphere.radius));
                bodies.push(dynamic(sphere_state(sphere), mass, DVec3::splat(0.4 * mass * radius * radius), DQuat::IDENTITY));
                bodies[number].force = sphere.force.as_dvec3();
                let shape = Shape { core: Core::Point, radius };
                colliders.push(Collider { body: number, shape, place: DVec3::ZERO, turn: DQuat::IDENTITY, belt: DVec3::ZERO });
                numbers.insert(anchor, number);
            }
            Mover::Clump(body, anchor) => {
                let form = scene.shape(body.shape).expect("a shape");
                let properties = form.mass_properties_of().expect("a valid shape");
                let (moments, axes) = properties.principal();
                bodies.push(dynamic(body_state(body), properties.mass, moments, axes));
                colliders.extend(parts(form, number, DVec3::from_array(properties.centre)));
                numbers.insert(anchor, number);
            }
        }
    }
    for collider in colliders.iter().filter(|collider| collider.body > 0) {
        let body = &mut bodies[collider.body];
        body.rho = body.rho.max(collider.shape.reach(collider.place, collider.turn));
        body.width = body.width.min(collider.shape.width());
    }
    let links =
        scene.joints().iter().map(|joint| Link::new(joint, joint.anchors().map(|end| numbers.get(&end).copied().unwrap_or(0))));
    let settings = scene.settings;
    let mut solver = Solver {
        bodies,
        colliders,
        links: links.collect(),
        g: f64::from(settings.gravity) * settings.gravity_direction.as_dvec3().normalize(),
        mu: settings.coulomb_friction.into(),
        e: settings.restitution.into(),
        substeps: scene.run.substeps.expect("substeps"),
        h: 0.0,
        frame: 0,
        blocks: Vec::new(),
        colours: HashMap::new(),
        noise: None,
        mistake: None,
        impacts: 0,
        rejections: 0,
    };
    solver.prepare_links();
    solver
}

impl Solver {
    /// The states of all moving bodies.
    pub(crate) fn seen(&self) -> Vec<Seen> {
        let moving = self.bodies.iter().filter(|body| body.has_mass);
        moving.map(|body| Seen { x: body.state.x, v: body.state.v, l: body.l, q: body.state.q }).collect()
    }
}
