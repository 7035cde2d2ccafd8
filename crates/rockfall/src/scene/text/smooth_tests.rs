use std::path::Path;

use glam::Vec3;

use crate::{Gauge, MotionId, ObjectId, Polygon, Scene, Surface};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("scene.txt")).map(|loaded| loaded.scene)
}

#[test]
fn smooth_walls_are_read_with_what_holds_for_other_walls() {
    let text = "@material wood density=1\n@motion drum spin=1 axis=0,0,1\n@use wood\n@move drum\n@group 2\n\
                @surface velocity=1,0,0\n@cylinder at=0,0,-1 axis=0,0,3 radius=0.5 length=2 inside=yes name=shell\n@move -\n\
                @repeat 2 0 1 0\n@ball at=1,2,3 radius=0.25\n@end\n@gauge name=load wall=shell\n\
                @cone at=0,0,0 axis=0,1,0 radius=0..0.5 length=1\n@plane at=0,-1,0 normal=0,2,0\n";
    let scene = parse(text).unwrap();
    let [shell, ball, second, cone, plane] = scene.polygons()[..] else { panic!("five walls") };
    assert!(shell.group == 2 && shell.material.is_some() && shell.motion.is_some() && shell.surface_velocity == Vec3::X);
    assert_eq!(shell.surface, Surface::Cone { inside: true });
    let axis = shell.cone_axis().unwrap();
    assert!(axis.radii == [0.5; 2] && axis.along.as_vec3() == 2.0 * Vec3::Z);
    assert_eq!((ball.surface, ball.corner, second.corner.y), (Surface::Ball { inside: false }, Vec3::new(1.0, 2.0, 3.0), 3.0));
    // The wider end comes first.
    let axis = cone.cone_axis().unwrap();
    assert!(cone.corner == Vec3::Y && axis.radii == [0.5, 0.0] && axis.along.as_vec3() == Vec3::NEG_Y, "{axis:?}");
    assert_eq!((plane.surface, plane.left.cross(plane.right)), (Surface::Plane, Vec3::Y));
    assert_eq!(scene.named("shell").unwrap().len(), 1);
    assert_eq!(scene.gauges(), [Gauge::wall("load", "shell")]);
    let written = scene.to_text();
    assert_eq!(parse(&written).unwrap().to_text(), written);
}

/// Walls of all kinds, along axes and oblique, also with edges that no line of words gives.
#[test]
fn smooth_walls_are_written_with_the_same_bits() {
    let direction = Vec3::new(0.3, -0.8, 0.55);
    let turned = Polygon { surface: Surface::Cone { inside: true }, ..Polygon::new([0.1; 3], direction, [0.4, 0.1, -0.7]) };
    let mut scene = Scene::new();
    let walls = [
        Polygon::plane([0.1, 0.2, 0.3], [0.0, 1.0, 0.0]),
        Polygon::plane([0.1, 0.2, 0.3], direction),
        Polygon::cylinder([0.1, 0.2, 0.3], [1.0, 0.0, 0.0], 0.7, 1.3),
        Polygon::cylinder([0.1, 0.2, 0.3], direction, 0.7, 1.3).inside(true),
        Polygon::cone([0.1, 0.2, 0.3], direction, [0.2, 0.9], 1.3),
        Polygon::cone([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], [0.5, 0.0], 1.0).inside(true),
        Polygon::ball([0.1, 0.2, 0.3], 0.7).inside(true),
        turned,
    ];
    for wall in walls {
        scene.add_polygon(wall).unwrap();
    }
    let text = scene.to_text();
    assert_eq!(parse(&text).unwrap().polygons(), scene.polygons(), "{text}");
    assert!(text.contains("@cylinder at=0.1,0.2,0.3 ") && text.contains("edge=") && text.contains("radius=0.5..0 "), "{text}");
}

#[test]
fn wrong_lines_name_the_field() {
    for (line, field, part) in [
        ("@plane at=0,0,0 normal=0,0,0", "normal", "a direction"),
        ("@plane at=0,0 normal=0,1,0", "at", "three numbers"),
        ("@plane normal=0,1,0", "at", "missing"),
        ("@cylinder at=0,0,0 axis=0,0,1 radius=0 length=1", "radius", "greater than 0"),
        ("@cylinder at=0,0,0 axis=0,0,1 radius=1", "length", "missing"),
        ("@cylinder at=0,0,0 axis=0,0,1 radius=1 length=1 inside=maybe", "inside", "yes or no"),
        ("@cone at=0,0,0 axis=0,0,1 radius=1 length=1", "radius", "two radii"),
        ("@cone at=0,0,0 axis=0,0,1 radius=0..0 length=1", "radius", "at most one is 0"),
        ("@ball at=0,0,0 radius=-1", "radius", "greater than 0"),
        ("@ball at=0,0,0 radius=1 size=2", "size", "an unknown key"),
        ("@cone at=0,0,0 edge=1,0,0 out=1,0,0", "right", "not parallel"),
        ("@cone at=0,0,0 edge=-3,1,0 out=1,0,0", "left", "does not pass the axis"),
        ("@ball at=0,0,0 edge=1,0,0 out=0,2,0", "right", "as long as the first"),
        ("@ball at=0,0,0 edge=1,0,0", "out", "missing"),
    ] {
        let error = parse(&format!("# walls\n{line}\n")).unwrap_err().to_string();
        assert!(error.contains("scene.txt:2") && error.contains(field) && error.contains(part), "{line}: {error}");
    }
}

#[test]
fn smooth_walls_have_bounds_and_follow_motions() {
    let cone = Polygon::cone([0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.5], 2.0);
    let (min, max) = cone.bounds().unwrap();
    assert!(min == Vec3::new(-1.0, 0.0, -1.0) && max == Vec3::new(1.0, 2.0, 1.0), "{min} {max}");
    assert_eq!(Polygon::ball([1.0, 0.0, 0.0], 2.0).bounds().unwrap().0, Vec3::new(-1.0, -2.0, -2.0));
    assert_eq!(Polygon::plane([0.0; 3], [0.0, 1.0, 0.0]).bounds(), None);
    let mut scene = Scene::new();
    let id = scene.add_polygon(cone).unwrap();
    scene.set_motion(ObjectId::from(id), None::<MotionId>).unwrap();
}
