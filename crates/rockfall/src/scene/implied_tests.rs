use crate::{Capsule, ContactLaw, Placement, Rod, Scene, Settings, Shape, Sphere, SphereId};

/// A scene with a law with history.
fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "linear").unwrap();
    assert!(!scene.settings.collisions && scene.settings.contact_law == ContactLaw::Linear);
    scene
}

/// A scene with the law `rigid`, under which frames of rods are bodies.
fn rigid_scene() -> Scene {
    let mut scene = Scene::new();
    scene.settings.set("contact_law", "rigid").unwrap();
    scene
}

/// Adds balls of mass 1 and radius 0.1, and rods of the present length.
fn add_frame(scene: &mut Scene, points: &[[f32; 3]], rods: &[[usize; 2]]) -> Vec<SphereId> {
    let balls: Vec<SphereId> = points.iter().map(|point| scene.add_sphere(Sphere::new(*point, 0.1)).unwrap()).collect();
    for [a, b] in rods {
        add_rod(scene, balls[*a], balls[*b]);
    }
    balls
}

fn add_rod(scene: &mut Scene, a: SphereId, b: SphereId) {
    let length = scene.sphere(a).unwrap().position.distance(scene.sphere(b).unwrap().position);
    scene.add_rod(Rod::new(a, b, 0.05).length(length)).unwrap();
}

fn pairs(count: usize) -> Vec<[usize; 2]> {
    (0..count).flat_map(|b| (0..b).map(move |a| [a, b])).collect()
}

/// Number of implied bodies of a frame alone.
fn bodies(points: &[[f32; 3]], rods: &[[usize; 2]]) -> usize {
    let mut scene = rigid_scene();
    add_frame(&mut scene, points, rods);
    scene.imply_bodies();
    scene.implied.len()
}

const TETRAHEDRON: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const SQUARE: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn frames_that_cannot_change_their_shape_are_bodies() {
    assert_eq!(bodies(&TETRAHEDRON, &pairs(4)), 1);
    assert_eq!(bodies(&TETRAHEDRON[..3], &pairs(3)), 1, "a triangle");
    assert_eq!(bodies(&TETRAHEDRON[..2], &pairs(2)), 1, "a rod");
    // Every corner of an octahedron has a rod to all others but the opposite one.
    let octahedron = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let edges: Vec<[usize; 2]> = pairs(6).into_iter().filter(|[a, b]| a / 2 != b / 2).collect();
    assert_eq!(edges.len(), 12);
    assert_eq!(bodies(&octahedron, &edges), 1);
}

#[test]
fn networks_that_can_change_their_shape_are_none() {
    assert_eq!(bodies(&SQUARE, &[[0, 1], [1, 2], [2, 3], [3, 0]]), 0);
    assert_eq!(
        bodies(&SQUARE, &pairs(4)),
        0,
        "a flat square with both diagonals can be bent out of its plane by a small angle"
    );
    assert_eq!(bodies(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &pairs(3)), 0, "spheres on one line");
    let two = [TETRAHEDRON.as_slice(), &[[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 2.0, 2.0]]].concat();
    let rods: Vec<[usize; 2]> = [pairs(4), pairs(4).iter().map(|rod| rod.map(|end| end + 3)).collect()].concat();
    assert_eq!(bodies(&two, &rods), 0, "two tetrahedra that share a ball");
    assert_eq!(bodies(&two, &[rods.as_slice(), &[[0, 4], [1, 4], [0, 5]]].concat()), 1, "braced");
}

#[test]
fn a_frame_that_is_held_or_has_another_law_stays_a_network() {
    let mut held = rigid_scene();
    let balls = add_frame(&mut held, &TETRAHEDRON, &pairs(4));
    let mut wall = Sphere::new([3.0, 0.0, 0.0], 0.1);
    wall.fixed = true;
    let wall = held.add_sphere(wall).unwrap();
    add_rod(&mut held, balls[0], wall);
    held.imply_bodies();
    assert_eq!(held.implied.len(), 0);
    let mut scene = rigid_scene();
    add_frame(&mut scene, &TETRAHEDRON, &pairs(4));
    add_frame(&mut scene, &[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]], &[[0, 1]]);
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 2);
    scene.settings.set("contact_law", "linear").unwrap();
    scene.imply_bodies();
    assert_eq!(scene.implied.objects().iter().map(|body| body.spheres.len()).collect::<Vec<_>>(), [2], "the capsule alone");
    scene.settings = Settings::default();
    assert!(scene.settings.collisions);
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 0);
}

/// A rod to a sphere of a rigid body leaves the body as it is. A network that is longer than half a period stays one.
#[test]
fn rigid_bodies_and_long_networks_are_left_alone() {
    let mut scene = scene();
    let shape = scene.add_shape(Shape::new().sphere([0.0; 3], 0.1).sphere([0.2, 0.0, 0.0], 0.1)).unwrap();
    let body = scene.add_body(Placement::new(shape)).unwrap();
    let ball = scene.add_sphere(Sphere::new([0.7, 0.0, 0.0], 0.1)).unwrap();
    let end = scene.body(body).unwrap().spheres()[1];
    add_rod(&mut scene, end, ball);
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 0);
    scene.set_periodic(0, Some([0.0, 2.0])).unwrap();
    add_frame(&mut scene, &[[0.2, 5.0, 0.0], [0.9, 5.0, 0.0]], &[[0, 1]]);
    add_frame(&mut scene, &[[0.2, 7.0, 0.0], [1.1, 7.0, 0.0]], &[[0, 1]]);
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 1);
}

#[test]
fn lengths_are_restored_unless_they_contradict_each_other() {
    let mut scene = scene();
    let balls = add_frame(&mut scene, &TETRAHEDRON[..2], &[]);
    scene.add_rod(Rod::new(balls[0], balls[1], 0.05).length(1.25)).unwrap();
    scene.imply_bodies();
    assert_eq!([0, 1].map(|ball: usize| scene.spheres()[ball].position.x), [-0.125, 1.125]);
    scene.add_rod(Rod::new(balls[0], balls[1], 0.05).length(1.0)).unwrap();
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 0);
}

/// The moments of a solid spherocylinder with r = 1, l = 4 and m = 1: 0.475 and 2.275 (a cylinder of 0.75 and balls of 0.25). Two balls of mass 1/2 have 4.4
/// across the axis.
#[test]
fn a_capsule_has_the_inertia_of_a_solid() {
    let mut scene = scene();
    let id = scene.add_capsule(Capsule::new([0.0, -2.0, 0.0], [0.0, 2.0, 0.0], 1.0)).unwrap();
    let other = scene.add_capsule(Capsule::new([5.0, 0.0, -2.0], [5.0, 0.0, 2.0], 1.0)).unwrap();
    scene.imply_bodies();
    let [one, two] = [0, 1].map(|number: usize| &scene.implied.objects()[number]);
    assert!(std::sync::Arc::ptr_eq(&one.form, &two.form), "equal capsules share a form");
    let moments = one.form.kinetics.moments / one.form.kinetics.mass;
    let across = 0.75 * (16.0 / 12.0 + 0.25) + 0.25 * (0.4 + 1.5 + 4.0);
    assert!((moments - glam::DVec3::new(0.475, across, across)).length() < 1e-6, "{moments}");
    let ends = [id, other].map(|id| scene.capsule(id).unwrap().end2).map(|end| scene.sphere(end).unwrap().position);
    assert!(ends[0].distance(glam::Vec3::new(0.0, 2.0, 0.0)) < 1e-6 && ends[1].distance(glam::Vec3::new(5.0, 0.0, 2.0)) < 1e-6);
}

#[test]
fn bodies_that_are_known_stay_and_released_ones_are_formed_anew() {
    let mut scene = rigid_scene();
    let balls = add_frame(&mut scene, &TETRAHEDRON, &pairs(4));
    add_frame(&mut scene, &[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]], &[[0, 1]]);
    scene.imply_bodies();
    let before: Vec<_> = scene.implied.handles().collect();
    scene.imply_bodies();
    assert_eq!(scene.implied.handles().collect::<Vec<_>>(), before);
    scene.release_spheres(&balls[..2]);
    scene.imply_bodies();
    let after: Vec<_> = scene.implied.handles().collect();
    assert!(after.len() == 2 && after[0] == before[1] && after[1] != before[0]);
    // Without one of its balls a tetrahedron is a triangle, with a rod less it is two triangles that share an edge.
    scene.remove_sphere(balls[3]).unwrap();
    scene.imply_bodies();
    assert_eq!(scene.implied.objects().iter().map(|body| body.spheres.len()).collect::<Vec<_>>(), [2, 3]);
    let rod = scene.rod_ids().next().unwrap();
    scene.remove_rod(rod).unwrap();
    scene.imply_bodies();
    assert_eq!(scene.implied.len(), 1);
}
