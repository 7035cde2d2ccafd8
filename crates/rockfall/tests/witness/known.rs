//! Scenes that several tests use. Most of them showed faults of an older model.

use std::path::Path;

use rockfall::Scene;

use crate::common::mixed::mixed;

/// Settings for smooth elastic collisions without gravity.
pub(crate) const SMOOTH: &str = "set gravity 0
set restitution 1
set friction 0
set contact_damping 0
";

/// The lower end of a capsule falls on a face. Its axis is above the edge of the face.
pub(crate) const CAPSULE: &str = "C -0.25 0.52 0 0.25 0.9 0 0 -1 0 2 0.5
P -0.5 0 -1 0 0 2 0.375 0 0";

/// A tetrahedron of rods of fixed length lands on a vertex. Its coordinates have six digits.
pub(crate) const TETRAHEDRON: &str = "S 1 0 0.115 0 0 -1 0 0 0 0 1 0.1
S 2 0.577350 0.931497 0 0 -1 0 0 0 0 1 0.1
S 3 -0.288675 0.931497 0.5 0 -1 0 0 0 0 1 0.1
S 4 -0.288675 0.931497 -0.5 0 -1 0 0 0 0 1 0.1
R 1 2 0.02 1
R 1 3 0.02 1
R 2 3 0.02 1
R 1 4 0.02 1
R 2 4 0.02 1
R 3 4 0.02 1
P -50 0 -50 0 0 100 100 0 0";

/// A ball falls into a groove of two boxes with slopes of 15 degrees.
pub(crate) const GROOVE: &str = "S 1 0 1.02 0  0 -5 0  0 0 0 1 0.5
B 0 0 -5 -9.6592583 2.5881905 0 -0.7764571 -2.8977775 0 0 0 10
B 0 0 -5 9.6592583 2.5881905 0 0.7764571 -2.8977775 0 0 0 10";

/// Two balls collide obliquely.
pub(crate) const OBLIQUE: &str = "S 1 -1.28 0.35 0 5 0 0 0 0 0 1 0.5
S 2 1.28 -0.35 0 -5 0 0 0 0 0 1 0.5";

/// An elastic ball on a floor.
pub(crate) const BALL: &str = "S 1 0 1.5 0 0 0 0 0 0 0 1 0.5
P -50 0 -50 0 0 100 100 0 0
set gravity 10
set restitution 1";

/// Three balls on springs collide repeatedly.
pub(crate) const SPRINGS: &str = "S 1 -0.6 0 0 0 -1 0 0 0 0 1 0.5
S 2 0.6 0 0 0 1 0 0 0 0 1 0.5
S 3 0 1.2 0 2 0 0 0 0 0 1 0.5
K 1 2 5 0.5 0
K 1 3 5 0.5 0
K 2 3 5 0.5 0";

/// A ball on a polygon and an identical one on a box, with contact forces alone.
pub(crate) const POLYGON: &str = "S 1 -5 0.6 0 0 -5 0 0 0 0 1 0.5
S 2 5 0.6 0 0 -5 0 0 0 0 1 0.5
P -10 0 -5 0 0 10 9 0 0
B 1 -2 -5 9 0 0 0 2 0 0 0 10
set collisions off
set gravity 0";

/// A double pendulum. Its objects are in different groups, so they have no contacts.
pub(crate) const DOUBLE_PENDULUM: &str = "@group 1
S 1 0 0 0 0 0 0 0 0 0 1 0.05 1
@group 2
S 2 1 0 0 0 0 0 0 0 0 1 0.05
@group 3
S 3 2 0 0 0 0 0 0 0 0 1 0.05
@group 4
R 1 2 0.01 1
@group 5
R 2 3 0.01 1
set gravity 10";

/// A ball on a rod to a roller, and a second ball that rests against the first.
pub(crate) const ROLLER: &str = "S 1 0 0 0 0 5 0 0 0 0 1 0.1 1
S 2 0 1 0 0 0 0 0 0 0 1 0.1
R 1 2 0.05 1
S 3 0 1.19 0 0 0 0 0 0 0 1 0.1
set gravity 0";

/// A ball that slides slowly without spin.
pub(crate) const SLIDER: &str = "S 1 0 0.49 0 0.01 0 0 0 0 0 1 0.5
P -50 0 -50 0 0 100 100 0 0
set gravity 10
set coulomb_friction 0.5";

/// A tetrahedron that slides on three of its corners.
pub(crate) const FRAME: &str = "S 1 0 0.099 0.57735 1 0 0 0 0 0 1 0.1
S 2 0.5 0.099 -0.288675 1 0 0 0 0 0 1 0.1
S 3 -0.5 0.099 -0.288675 1 0 0 0 0 0 1 0.1
S 4 0 0.9155 0 1 0 0 0 0 0 1 0.1
R 1 2 0.02 1
R 1 3 0.02 1
R 2 3 0.02 1
R 1 4 0.02 1
R 2 4 0.02 1
R 3 4 0.02 1
P -5 0 -5 0 0 10 10 0 0
set gravity 1
set coulomb_friction 0.5";

/// Two triangles with a common side that slide on all of their corners.
pub(crate) const HINGE: &str = "S 1 0.866025 0.099 0 1 0 0 0 0 0 1 0.1
S 2 0 0.099 0.5 1 0 0 0 0 0 1 0.1
S 3 0 0.099 -0.5 1 0 0 0 0 0 1 0.1
S 4 -0.866025 0.099 0 1 0 0 0 0 0 1 0.1
R 1 2 0.02 1
R 1 3 0.02 1
R 2 3 0.02 1
R 2 4 0.02 1
R 3 4 0.02 1
P -5 0 -5 0 0 10 10 0 0
set gravity 1
set coulomb_friction 0.5";

/// Two overlapping balls with spin on a floor with strong friction. One of them is fast.
pub(crate) const RUNAWAY: &str = "S 1 0.0712115 0.201047 -0.244593 0 0 0 0.00809541 1.35278 2.60024 1 0.274467
S 2 0.490189 0.190404 -0.118877 -16.951 -8.38368 2.69628 0.344511 4.80783 5.80697 1 0.351178
P -5 0 -5 0 0 10 10 0 0
set friction 5000
set collisions off";

pub(crate) fn parse(text: &str) -> Scene {
    Scene::parse(text, Path::new("a test")).expect("a valid scene").scene
}

/// All known scenes with their names, and a scene with every kind of object.
pub(crate) fn scenes() -> Vec<(&'static str, Scene)> {
    let elastic = [
        ("capsule", CAPSULE),
        ("tetrahedron", TETRAHEDRON),
        ("groove", GROOVE),
        ("oblique pair", OBLIQUE),
        ("springs", SPRINGS),
    ];
    let other = [
        ("ball", BALL),
        ("polygon", POLYGON),
        ("double pendulum", DOUBLE_PENDULUM),
        ("roller", ROLLER),
        ("slider", SLIDER),
        ("frame", FRAME),
        ("hinge", HINGE),
        ("runaway", RUNAWAY),
    ];
    let elastic = elastic.into_iter().map(|(name, text)| (name, parse(&format!("{text}\n{SMOOTH}"))));
    let other = other.into_iter().map(|(name, text)| (name, parse(text)));
    elastic.chain(other).chain([("every kind of object", mixed(16))]).collect()
}
