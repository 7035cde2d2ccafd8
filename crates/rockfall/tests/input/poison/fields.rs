//! Every field of every object, and the numbers that it accepts.

use rockfall::glam::{Quat, Vec3};
use rockfall::{Capsule, Cuboid, Error, Muscle, Polygon, Result, Rod, Scene, Sphere, Spring, Tether};

/// Special numbers that every field is tested with.
pub(crate) const POISONS: [f32; 18] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    1e30,
    -1e30,
    1e18,
    1e10,
    1e-10,
    1e-30,
    -1e-30,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-40,
    0.0,
    -0.0,
    -1.0,
];

/// A field of an object that the API sets to a number.
pub(crate) struct Field {
    pub(crate) name: &'static str,
    /// Whether the field accepts a number. All others must be rejected.
    pub(crate) accepts: fn(f32) -> bool,
    /// Whether a large number makes the object touch everything. (The position of a rod of length 1e18 is only accurate
    /// to 1e11 in f32.)
    pub(crate) reaches: bool,
    /// Adds the object near a place, in a group.
    pub(crate) add: fn(&mut Scene, Vec3, u16, f32) -> Result<()>,
}

pub(crate) fn finite(number: f32) -> bool {
    number.is_finite()
}

pub(crate) fn positive(number: f32) -> bool {
    number.is_finite() && number > 0.0
}

pub(crate) fn not_negative(number: f32) -> bool {
    number.is_finite() && number >= 0.0
}

/// A positive number whose inverse is positive too, neither of them denormal.
fn usable(number: f32) -> bool {
    number > 0.0 && number.is_normal() && (1.0 / number).is_normal()
}

/// Mass of a ball of radius 0.5: the mass and the inertia must be usable.
fn mass(number: f32) -> bool {
    positive(number) && (1.0 / number).is_normal() && usable(0.1 * number)
}

/// Mass of a capsule with ends of radius 0.5, which have half of it each.
fn capsule_mass(number: f32) -> bool {
    mass(0.5 * number)
}

/// Radius of a ball of mass 1.
fn radius(number: f32) -> bool {
    positive(number) && usable(0.4 * number * number)
}

/// Radius of a capsule, whose ends have mass 1/2.
fn capsule_radius(number: f32) -> bool {
    positive(number) && usable(0.2 * number * number)
}

/// Edges with lengths from 1e-15 to 1e15.
fn edge(number: f32) -> bool {
    number.is_finite() && (1e-30..1e30).contains(&(number * number))
}

/// Whether f32 can represent this as a length.
fn length(number: f32) -> bool {
    (number * number).sqrt().is_normal()
}

/// End 1 of a capsule. The other end is at 2.1.
fn end1(number: f32) -> bool {
    length(number - 2.1)
}

/// End 2 of a capsule. The other end is at 0.
fn end2(number: f32) -> bool {
    length(number)
}

fn sphere(at: Vec3, group: u16) -> Sphere {
    Sphere::new(at, 0.5).group(group).velocity([0.0, -2.0, 0.0])
}

/// Adds a sphere that touches another one.
fn add_sphere(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Sphere)) -> Result<()> {
    scene.add_sphere(sphere(at - 0.9 * Vec3::Y, group).velocity([0.0; 3]))?;
    let mut poisoned = sphere(at, group);
    poison(&mut poisoned);
    scene.add_sphere(poisoned).map(drop)
}

/// Adds two spheres and an object that connects them.
fn add_pair<T>(
    scene: &mut Scene,
    at: Vec3,
    group: u16,
    add: impl FnOnce(&mut Scene, rockfall::SphereId, rockfall::SphereId) -> Result<T>,
) -> Result<()> {
    let a = scene.add_sphere(sphere(at, group))?;
    let b = scene.add_sphere(sphere(at + 1.5 * Vec3::X, group))?;
    // A sphere for the rod to touch.
    scene.add_sphere(sphere(at + Vec3::new(0.7, 0.7, 0.0), group))?;
    add(scene, a, b).map(drop)
}

fn add_capsule(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Capsule)) -> Result<()> {
    scene.add_sphere(sphere(at + Vec3::Y, group))?;
    let mut capsule = Capsule::new(at, at + 2.1 * Vec3::X, 0.5).group(group);
    poison(&mut capsule);
    scene.add_capsule(capsule).map(drop)
}

fn add_box(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Cuboid)) -> Result<()> {
    add_pair(scene, at + Vec3::Y, group, |scene, a, b| scene.add_rod(Rod::new(a, b, 0.2).group(group)))?;
    let mut cuboid = Cuboid::new(at, 2.0 * Vec3::X, Vec3::Y, Vec3::Z).group(group);
    poison(&mut cuboid);
    scene.add_box(cuboid).map(drop)
}

fn add_polygon(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Polygon)) -> Result<()> {
    add_pair(scene, at + 0.4 * Vec3::Y, group, |scene, a, b| scene.add_rod(Rod::new(a, b, 0.2).group(group)))?;
    let mut polygon = Polygon::new(at, Vec3::Z, 2.0 * Vec3::X).group(group);
    poison(&mut polygon);
    scene.add_polygon(polygon).map(drop)
}

fn add_spring(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Spring)) -> Result<()> {
    add_pair(scene, at, group, |scene, a, b| {
        let mut spring = Spring::new(a, b, 10.0, 1.0).damping(1.0);
        poison(&mut spring);
        scene.add_spring(spring)
    })
}

fn add_tether(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Tether)) -> Result<()> {
    add_pair(scene, at, group, |scene, a, _| {
        let mut tether = Tether::new(a, at + Vec3::Y, 10.0).damping(1.0);
        poison(&mut tether);
        scene.add_tether(tether)
    })
}

fn add_rod(scene: &mut Scene, at: Vec3, group: u16, poison: impl FnOnce(&mut Rod)) -> Result<()> {
    add_pair(scene, at, group, |scene, a, b| {
        let mut rod = Rod::new(a, b, 0.2).group(group);
        poison(&mut rod);
        scene.add_rod(rod)
    })
}

macro_rules! fields {
    ($($add:ident $name:literal $accepts:ident $reaches:literal |$object:ident, $number:ident| $poison:expr;)*) => {
        pub(crate) const FIELDS: &[Field] = &[$(
            Field {
                name: $name,
                accepts: $accepts,
                reaches: $reaches,
                add: |scene, at, group, $number| $add(scene, at, group, |$object| $poison),
            },
        )*];
    };
}

fields! {
    add_sphere "sphere.position" finite false |sphere, p| sphere.position.x = p;
    add_sphere "sphere.velocity" finite false |sphere, p| sphere.velocity.x = p;
    add_sphere "sphere.angular_momentum" finite false |sphere, p| sphere.angular_momentum.x = p;
    add_sphere "sphere.orientation" never false |sphere, p| sphere.orientation = Quat::from_xyzw(p, 0.0, 0.6, 0.6);
    add_sphere "sphere.mass" mass false |sphere, p| sphere.mass = p;
    add_sphere "sphere.radius" radius true |sphere, p| sphere.radius = p;
    add_sphere "sphere.force" finite false |sphere, p| sphere.force.x = p;
    add_rod "rod.radius" positive true |rod, p| rod.radius = p;
    add_rod "rod.length" positive true |rod, p| rod.length = Some(p);
    add_capsule "capsule.end1" end1 false |capsule, p| capsule.end1.x = p;
    add_capsule "capsule.end2" end2 false |capsule, p| capsule.end2.x = p;
    add_capsule "capsule.velocity" finite false |capsule, p| capsule.velocity.x = p;
    add_capsule "capsule.mass" capsule_mass false |capsule, p| capsule.mass = p;
    add_capsule "capsule.radius" capsule_radius true |capsule, p| capsule.radius = p;
    add_spring "spring.stiffness" not_negative false |spring, p| spring.stiffness = p;
    add_spring "spring.length" not_negative false |spring, p| spring.length = p;
    add_spring "spring.damping" not_negative false |spring, p| spring.damping = p;
    add_spring "muscle.amplitude" amplitude false |spring, p| spring.muscle = Some(Muscle::new(p, 1.0, 0.0));
    add_spring "muscle.frequency" not_negative false |spring, p| spring.muscle = Some(Muscle::new(0.1, p, 0.0));
    add_spring "muscle.phase" finite false |spring, p| spring.muscle = Some(Muscle::new(0.1, 1.0, p));
    add_tether "tether.point" finite false |tether, p| tether.point.x = p;
    add_tether "tether.stiffness" not_negative false |tether, p| tether.stiffness = p;
    add_tether "tether.length" not_negative false |tether, p| tether.length = p;
    add_tether "tether.damping" not_negative false |tether, p| tether.damping = p;
    add_box "box.corner" finite false |cuboid, p| cuboid.corner.x = p;
    add_box "box.edge" edge false |cuboid, p| cuboid.edges[0].x = p;
    add_polygon "polygon.corner" finite false |polygon, p| polygon.corner.x = p;
    add_polygon "polygon.left" edge false |polygon, p| polygon.left.z = p;
    add_polygon "polygon.right" edge false |polygon, p| polygon.right.x = p;
}

/// Accepts the amplitude of a muscle.
fn amplitude(p: f32) -> bool {
    p.abs() <= 1.0
}

/// Accepts no number: none makes a unit quaternion with the other components.
fn never(_: f32) -> bool {
    false
}

/// Checks the answer to a number and returns whether it was accepted. A rejection must be an error that names the
/// field.
#[track_caller]
pub(crate) fn check_accepted<T>(name: &str, number: f32, accepts: bool, answer: &Result<T>) -> bool {
    match answer {
        Ok(_) => assert!(accepts, "{name} = {number:e} must be rejected"),
        Err(Error::Invalid { field, .. }) => {
            assert!(!accepts, "{name} = {number:e} must be accepted: {:?}", answer.as_ref().err());
            assert!(field.contains(name), "{name} = {number:e} is reported as {field}");
        }
        Err(error) => panic!("{name} = {number:e}: {error}"),
    }
    accepts
}
