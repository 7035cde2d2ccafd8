use super::*;
use crate::Error;
use crate::scene::{Colour, Spring};

fn close(found: DVec3, expected: DVec3) {
    assert!(found.distance(expected) <= 1e-6 * (1.0 + expected.length()), "{found}, expected {expected}");
}

/// A scene with a dumbbell of two unlike balls.
fn dumbbell() -> (Scene, ShapeId) {
    let mut scene = Scene::new();
    let shape = Shape::new().sphere([0.0; 3], 1.0).sphere([4.0, 0.0, 0.0], 0.5).rod(0, 1, 0.25).mass(9.0);
    let shape = scene.add_shape(shape).unwrap();
    (scene, shape)
}

fn quarter() -> Quat {
    Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)
}

#[test]
fn members_follow_the_pose_and_the_motion() {
    let (mut scene, shape) = dumbbell();
    let (spin, velocity) = (Vec3::new(0.0, 0.5, 2.0), Vec3::new(1.0, 0.0, -1.0));
    let placement = Placement::new(shape).at([10.0, 0.0, 3.0]).turned(quarter()).velocity(velocity).spin(spin);
    let id = scene.add_body(placement).unwrap();
    let body = scene.body(id).unwrap().clone();
    let centre = scene.shape_mass(shape).unwrap().centre.x;
    close(DVec3::from_array(body.centre()), DVec3::new(10.0, centre, 3.0));
    close(scene.body_spin(id).unwrap().as_dvec3(), spin.as_dvec3());
    let [a, b] = [0, 1].map(|member| *scene.sphere(body.spheres()[member]).unwrap());
    close(a.position.as_dvec3(), DVec3::new(10.0, 0.0, 3.0));
    close(b.position.as_dvec3(), DVec3::new(10.0, 4.0, 3.0));
    for sphere in [a, b] {
        let arm = sphere.position.as_dvec3() - DVec3::from_array(body.centre());
        close(sphere.velocity.as_dvec3(), velocity.as_dvec3() + spin.as_dvec3().cross(arm));
        close(sphere.spin().as_dvec3(), spin.as_dvec3());
        assert_eq!(sphere.orientation, quarter());
    }
    assert_eq!((a.mass, b.mass), (8.0, 1.0), "the mass is shared by volume");
    let rod = scene.rod(body.rods()[0]).unwrap();
    assert_eq!((rod.end1, rod.end2, rod.length), (body.spheres()[0], body.spheres()[1], None));
    assert_eq!((scene.counts().bodies, scene.counts().spheres, scene.counts().rods), (1, 2, 1));
}

#[test]
fn the_angular_momentum_belongs_to_the_tensor_of_the_turned_body() {
    let (mut scene, shape) = dumbbell();
    let kinetics = *scene.shape_mass(shape).unwrap();
    assert_eq!(kinetics.axes, DQuat::IDENTITY);
    let spin = Vec3::new(0.25, 2.0, -1.0);
    let id = scene.add_body(Placement::new(shape).turned(quarter()).spin(spin)).unwrap();
    // The long axis of the turned body is y.
    let DVec3 { x: along, y: across, .. } = kinetics.moments;
    let expected = DVec3::new(0.25 * across, 2.0 * along, -across);
    close(scene.body(id).unwrap().angular_momentum.as_dvec3(), expected);
    let same = scene.add_body(Placement::new(shape).turned(quarter()).angular_momentum(expected.as_vec3())).unwrap();
    close(scene.body_spin(same).unwrap().as_dvec3(), spin.as_dvec3());
}

#[test]
fn a_body_that_is_moved_takes_its_members_along() {
    let (mut scene, shape) = dumbbell();
    let id = scene.add_body(Placement::new(shape)).unwrap();
    let ids = scene.body(id).unwrap().spheres().to_vec();
    let distance = |scene: &Scene| scene.spheres()[0].position.distance(scene.spheres()[1].position);
    scene
        .update_body(id, |body| {
            body.set_centre([0.0, 1e6, 0.0]);
            body.orientation = quarter();
            body.spheres.clear();
        })
        .unwrap();
    assert_eq!(scene.body(id).unwrap().spheres(), ids);
    assert_eq!(distance(&scene), 4.0);
    scene.spheres.get_mut(ids[1]).unwrap().position = Vec3::ZERO;
    scene.place_all_members();
    assert_eq!(distance(&scene), 4.0);
    let error = scene.update_body(id, |body| body.velocity.x = f32::NAN).unwrap_err().to_string();
    assert!(error.contains("body.velocity"), "{error}");
    assert_eq!(scene.body(id).unwrap().velocity, Vec3::ZERO);
}

#[test]
fn a_body_is_removed_as_a_whole() {
    let (mut scene, shape) = dumbbell();
    let loose = scene.add_sphere(Sphere::new([0.0, 9.0, 0.0], 1.0)).unwrap();
    let bodies = [0.0, 10.0, 20.0].map(|x| scene.add_body(Placement::new(shape).at([x, 0.0, 0.0])).unwrap());
    let member = scene.body(bodies[1]).unwrap().spheres()[1];
    let rod = scene.body(bodies[1]).unwrap().rods()[0];
    scene.add_spring(Spring::new(loose, member, 1.0, 1.0)).unwrap();
    assert_eq!(scene.body_of_sphere(member), Some(bodies[1]));
    assert_eq!(scene.body_of_rod(rod), Some(bodies[1]));
    assert_eq!(scene.body_of_sphere(loose), None);
    for error in [scene.remove_spheres(&[loose, member]), scene.remove_rod(rod)] {
        let error = error.unwrap_err().to_string();
        assert!(error.contains("remove the body"), "{error}");
    }
    scene.remove_body(bodies[1]).unwrap();
    let counts = scene.counts();
    assert_eq!((counts.bodies, counts.spheres, counts.rods, counts.springs), (2, 5, 2, 0));
    assert!(matches!(scene.remove_bodies(&bodies), Err(Error::StaleHandle { kind: "rigid body" })));
    // Its slots are taken by others.
    let other = scene.add_sphere(Sphere::new([0.0, 20.0, 0.0], 1.0)).unwrap();
    assert_eq!((scene.body_of_sphere(member), scene.body_of_sphere(other)), (None, None));
    let new = scene.add_body(Placement::new(shape).at([0.0, 30.0, 0.0])).unwrap();
    for id in [bodies[0], bodies[2], new] {
        let spheres = scene.body(id).unwrap().spheres();
        assert!(spheres.iter().all(|sphere| scene.body_of_sphere(*sphere) == Some(id)));
    }
    scene.remove_sphere(other).unwrap();
}

#[test]
fn parts_have_their_groups_and_tags() {
    let mut scene = Scene::new();
    let red = Tag::new().colour(Colour([255, 0, 0]));
    let shape = Shape::new().sphere([0.0; 3], 1.0).group(3).tag(red).sphere([1.0, 0.0, 0.0], 0.5).rod(0, 1, 0.2);
    let shape = scene.add_shape(shape).unwrap();
    let id = scene.add_body(Placement::new(shape)).unwrap();
    let body = scene.body(id).unwrap().clone();
    let [first, second] = [0, 1].map(|member| body.spheres()[member]);
    assert_eq!((scene.sphere(first).unwrap().group, scene.sphere(second).unwrap().group), (0, 3));
    assert_eq!((scene.rods()[0].group, scene.tag(first).unwrap()), (3, None));
    scene.set_tag(id, Tag::new().name("bone").colour(Colour([0, 0, 255]))).unwrap();
    let colour = |id: ObjectId| scene.tag(id).unwrap().unwrap().colour;
    assert_eq!(colour(first.into()), Some(Colour([0, 0, 255])));
    assert_eq!(colour(second.into()), Some(Colour([255, 0, 0])), "the part has a colour of its own");
    assert_eq!(scene.named("bone").unwrap(), [first.into(), second.into(), body.rods()[0].into(), id.into()]);
}

#[test]
fn a_body_longer_than_half_of_a_period_is_refused() {
    let (mut scene, shape) = dumbbell();
    scene.add_body(Placement::new(shape)).unwrap();
    let reach = 4.5 - scene.shape_mass(shape).unwrap().centre.x as f32;
    scene.set_periodic(1, Some([0.0, 4.01 * reach])).unwrap();
    scene.check_periods().unwrap();
    scene.set_periodic(1, Some([0.0, 3.99 * reach])).unwrap();
    let error = scene.check_periods().unwrap_err().to_string();
    assert!(error.contains("rigid body 0 is ") && error.contains("at most half of the period"), "{error}");
}

#[test]
fn impossible_bodies_are_refused() {
    let (mut scene, shape) = dumbbell();
    let place = Placement::new(shape);
    for (placement, part) in [
        (place.at([f64::NAN, 0.0, 0.0]), "body.position"),
        (place.turned(Quat::from_xyzw(1.0, 1.0, 0.0, 0.0)), "body.orientation"),
        (place.velocity([f32::INFINITY, 0.0, 0.0]), "body.velocity"),
        (place.spin([f32::MAX, 0.0, 0.0]), "body.angular_momentum"),
    ] {
        let error = scene.add_body(placement).expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
    let (mut other, _) = dumbbell();
    assert!(matches!(other.add_body(place), Err(Error::StaleHandle { kind: "shape" })));
    assert_eq!((scene.counts().spheres, other.counts().spheres), (0, 0));
    let named = || Shape::new().name("ball").sphere([0.0; 3], 1.0);
    let ball = scene.add_shape(named()).unwrap();
    assert_eq!(scene.find_shape("ball"), Some(ball));
    assert!(scene.add_shape(named()).unwrap_err().to_string().contains("a name that no other shape has"));
}

/// What a scene with one shape is refused for under a law. `settings` and `objects` are lines of a scene text.
fn refusal(law: &str, settings: &str, objects: &str) -> Option<String> {
    let text = format!(
        "set contact_law {law}\n{settings}@material a density=1 young=1e6 poisson=0.3\n@use a\n\
         @body bone mass=1\nS 0 0 0 0 0 0 0 0 0 0 - 0.5\nS 1 1 0 0 0 0 0 0 0 0 - 0.5\n@end\n{objects}"
    );
    let scene = Scene::parse(&text, std::path::Path::new("scene.txt")).unwrap().scene;
    scene.check_contact_law(crate::Integrator::VelocityVerlet).err().map(|error| error.to_string())
}

#[test]
fn impulses_on_bodies_are_refused_under_a_law_of_grains() {
    let placed = "@place bone at=0,0,0\n";
    let inlet = "@inlet box=0,0,0,9,9,9 shape=bone rate=1\n";
    for objects in [placed, inlet] {
        assert_eq!(refusal("hertz-mindlin", "", objects), None);
        for (name, value, instead) in
            [("collisions", "on", "off"), ("collision_friction", "0.5", "0"), ("continuous_collisions", "on", "off")]
        {
            let expected = format!(
                "{name}: {value} under hertz-mindlin with a rigid body ('bone') is not allowed, expected {instead} (contact \
                 forces alone), or `set contact_law rigid`: under other laws rigid bodies have no impulses"
            );
            let settings = format!("set {name} {value}\n");
            assert_eq!(refusal("hertz-mindlin", &settings, objects), Some(expected));
            assert_eq!(refusal("rigid", &settings, objects), None);
            assert_eq!(refusal("hertz-mindlin", &settings, "S 2 5 0 0 0 0 0 0 0 0 - 0.5\n"), None, "a shape without a body");
        }
    }
}
