//! Scenes of the contact law `rigid`: shapes of boxes, balls, capsules and hulls, bodies of them, planes, and changes of bodies.

use arbitrary::{Arbitrary, Result, Unstructured};
use rockfall::glam::{Quat, Vec3};
use rockfall::{Capsule, ContactLaw, Cuboid, MaterialId, Placement, Polygon, RigidBodyId, Scene, Shape, Simulation, Sphere};

use super::case::{Add, Flag, Later, decoded};
use super::motion::{self, OBJECTS};
use super::number::{Near, Number, Size, near};
use super::twins::Twins;

/// Most points of a hull.
const POINTS: usize = 12;
/// Most parts of a shape.
const PARTS: usize = 4;

decoded! {
    /// Settings of the law.
    struct Setup {
        /// Number modulo 12, or as many as the bodies need.
        substeps: Option<u8>,
        gravity: Number,
        restitution: u8,
        friction: Size,
    }

    /// A part of a shape.
    struct Part {
        form: Form,
        at: [Near; 3],
        group: bool,
    }

    struct Mass {
        density: bool,
        amount: Size,
    }

    /// A rigid body. Its axis and its angle are any numbers.
    struct Place {
        shape: u8,
        at: [Near; 3],
        axis: [Near; 3],
        angle: Near,
        velocity: [Near; 3],
        spin: [Near; 3],
        fixed: Flag,
    }
}

decoded! {
    /// An action in a scene of the law `rigid`.
    enum HardAction {
        Later(Later),
        /// Frames of 1/60 s, or of any length.
        Run { frames: u8, dt: Option<Size> },
        Add(Add),
        /// A ball whose mass follows from its material or is 1.
        Ball { at: [Near; 3], velocity: [Near; 3], spin: [Near; 3], radius: Size, fixed: Flag },
        Capsule { ends: [[Near; 3]; 2], velocity: [Near; 3], radius: Size },
        /// A shape of 1 to 4 parts.
        Shape { parts: Parts, mass: Mass },
        Place(Place),
        /// The same body at several heights: their number modulo 8, and their distance.
        Stack(Place, u8, Size),
        Plane { at: [Near; 3], normal: [Near; 3], group: bool },
        /// A wall with a surface that moves.
        Belt { corners: [[Near; 3]; 2], velocity: [Near; 3] },
        Change(u8, Turn),
        Remove(u8),
    }

    enum Form {
        Ball(Size),
        Capsule([Near; 3], Size),
        Box([Size; 3]),
        Skewed([[Near; 3]; 3]),
        Hull(Cloud),
    }

    /// A change of a body.
    enum Turn {
        Position([Near; 3]),
        Velocity([Near; 3]),
        Momentum([Near; 3]),
        Orientation([Near; 4]),
    }
}

/// The parts of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts([Option<Part>; PARTS]);

/// The points of a hull. The first `count` of them count.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cloud {
    count: u8,
    points: [Vec3; POINTS],
}

impl<'a> Arbitrary<'a> for Parts {
    fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
        let count = usize::from(u8::arbitrary(source)?);
        let mut parts = [None; PARTS];
        // Most shapes have one part.
        let more = if count < 160 { 0 } else { count % PARTS };
        for part in parts.iter_mut().take(1 + more) {
            *part = Some(Part::arbitrary(source)?);
        }
        Ok(Self(parts))
    }
}

impl<'a> Arbitrary<'a> for Cloud {
    fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
        let count = 3 + u8::arbitrary(source)? % (POINTS as u8 - 2);
        let mut points = [Vec3::ZERO; POINTS];
        for point in points.iter_mut().take(usize::from(count)) {
            *point = 0.25 * near(Arbitrary::arbitrary(source)?);
        }
        Ok(Self { count, points })
    }
}

/// Sets what the law needs.
pub(crate) fn prepare(scene: &mut Scene, setup: &Setup) {
    let settings = &mut scene.settings;
    settings.contact_law = ContactLaw::Rigid;
    let numbers = [("gravity", setup.gravity.0), ("coulomb_friction", setup.friction.0)];
    for (name, value) in numbers.into_iter().chain([("restitution", f32::from(setup.restitution) / 255.0)]) {
        // A number out of range leaves the setting as it is.
        let _ = settings.set(name, &value.to_string());
    }
    scene.run.substeps = setup.substeps.map(|substeps| 1 + u32::from(substeps) % 12);
}

pub(crate) fn act(twins: &mut Twins, action: &HardAction, used: Option<MaterialId>, left: &mut u64) {
    match *action {
        HardAction::Later(_) => {}
        HardAction::Add(ref what) => motion::add(twins, what, used),
        HardAction::Ball { at, velocity, spin, radius, fixed } => {
            let mut ball = Sphere::new(near(at), radius.0).velocity(near(velocity)).angular_momentum(near(spin));
            (ball.fixed, ball.material) = (fixed.is_set(), used);
            twins.both(|simulation| simulation.add_sphere(ball));
        }
        HardAction::Capsule { ends: [one, two], velocity, radius } => {
            let mut capsule = Capsule::new(near(one), near(two), radius.0).velocity(near(velocity));
            capsule.material = used;
            twins.both(|simulation| simulation.add_capsule(capsule));
        }
        HardAction::Run { frames, dt } => {
            let frames = u64::from(frames % 16).min(*left);
            *left -= frames;
            let dt = dt.map_or(1.0 / 60.0, |dt| dt.0 / 64.0);
            twins.advance(frames, |simulation| simulation.run(frames, dt).map(drop));
            twins.both(Simulation::contacts);
        }
        HardAction::Shape { ref parts, mass } => {
            let Some(shape) = shape(parts, mass, used) else { return };
            let name = name(twins.scene().shapes().len());
            twins.both(|simulation| simulation.add_shape(shape.clone().name(&name)));
        }
        HardAction::Place(ref place) => put(twins, place, 0.0),
        HardAction::Stack(ref place, count, apart) => {
            (0..count % 8).for_each(|number| put(twins, place, f32::from(number) * apart.0));
        }
        HardAction::Plane { at, normal, group } => {
            let mut plane = Polygon::plane(near(at), near(normal)).group(group.into());
            plane.material = used;
            twins.both(|simulation| simulation.add_polygon(plane));
        }
        HardAction::Belt { corners: [one, two], velocity } => {
            let mut wall = Cuboid::between(near(one), near(two));
            (wall.material, wall.surface_velocity) = (used, near(velocity));
            twins.both(|simulation| simulation.add_box(wall));
        }
        HardAction::Change(which, how) => {
            let Some(id) = body(twins, which) else { return };
            twins.both(|simulation| turn(simulation, id, how));
        }
        HardAction::Remove(which) => {
            let Some(id) = body(twins, which) else { return };
            twins.both(|simulation| simulation.remove_body(id));
            assert!(twins.both(|simulation| simulation.remove_body(id)).is_none(), "removed twice");
        }
    }
}

/// Name of a shape, by which it is found.
fn name(number: usize) -> String {
    format!("shape{number}")
}

/// A shape, if its hulls are hulls.
fn shape(Parts(parts): &Parts, mass: Mass, used: Option<MaterialId>) -> Option<Shape> {
    let mut shape = if mass.density { Shape::new().density(mass.amount.0) } else { Shape::new().mass(mass.amount.0) };
    shape = used.into_iter().fold(shape, Shape::material);
    for part in parts.iter().flatten() {
        let at = 0.25 * near(part.at);
        shape = shape.group(part.group.into());
        shape = match part.form {
            Form::Ball(radius) => shape.sphere(at, radius.0),
            Form::Capsule(end, radius) => shape.capsule(at, near(end), radius.0),
            Form::Box(edges) => {
                let edges = Vec3::from_array(edges.map(|edge| edge.0));
                shape.cuboid(Cuboid::between(at - 0.5 * edges, at + 0.5 * edges))
            }
            Form::Skewed([i, j, k]) => shape.cuboid(Cuboid::new(at, near(i), near(j), near(k))),
            Form::Hull(cloud) => {
                let points = cloud.points[..usize::from(cloud.count)].iter().map(|point| at + *point);
                shape.add_hull(points).ok()?
            }
        };
    }
    Some(shape)
}

/// Adds a body, which is `height` above its place.
fn put(twins: &mut Twins, place: &Place, height: f32) {
    let scene = twins.scene();
    let counts = scene.counts();
    let number = usize::from(place.shape) % scene.shapes().len().max(1);
    let Some(shape) = scene.find_shape(&name(number)) else { return };
    if counts.spheres + counts.boxes + counts.polygons > 4 * OBJECTS {
        return;
    }
    let axis = near(place.axis).try_normalize().unwrap_or(Vec3::Y);
    let at = near(place.at) + height * Vec3::Y;
    let placement = Placement::new(shape)
        .at(at.as_dvec3())
        .turned(Quat::from_axis_angle(axis, place.angle.0))
        .velocity(near(place.velocity))
        .spin(near(place.spin));
    if place.fixed.is_set() {
        twins.both(|simulation| simulation.add_static_body(placement, None));
    } else {
        twins.both(|simulation| simulation.add_body(placement));
    }
}

fn body(twins: &Twins, which: u8) -> Option<RigidBodyId> {
    let ids: Vec<RigidBodyId> = twins.scene().body_ids().collect();
    (!ids.is_empty()).then(|| ids[usize::from(which) % ids.len()])
}

fn turn(simulation: &mut Simulation, id: RigidBodyId, how: Turn) -> rockfall::Result<()> {
    simulation.update_body(id, |body| match how {
        Turn::Position(to) => body.position = near(to),
        Turn::Velocity(to) => body.velocity = near(to),
        Turn::Momentum(to) => body.angular_momentum = near(to),
        Turn::Orientation(to) => {
            let [x, y, z, w] = to.map(|number| number.0);
            body.orientation = Quat::from_xyzw(x, y, z, w);
        }
    })
}
