//! Marks over the picture: the outline of the picked body, and the line to the held body.

use egui::{Color32, Painter, Pos2, Rect, Stroke};
use rockfall::glam::Vec3;
use rockfall::{Body, Polygon, Scene, Surface};

use super::viewer::Viewer;
use crate::whole::ball;

/// Colour of the marks.
const MARK: Color32 = Color32::from_rgb(0xd5, 0x5e, 0x00);
const STROKE: Stroke = Stroke { width: 2.0, color: MARK };

/// Draws the marks.
pub(super) fn show(painter: &Painter, area: Rect, viewer: &Viewer) {
    let scene = viewer.session.simulation_ref().scene();
    if let Some(body) = viewer.session.picked() {
        outline(painter, area, viewer, body);
    }
    if let Some(held) = viewer.session.held()
        && let Ok(sphere) = scene.sphere(held.sphere)
        && let (Some((from, _)), Some((to, _))) = (project(viewer, area, sphere.position), project(viewer, area, held.pointer))
    {
        painter.line_segment([from, to], STROKE);
        painter.circle_filled(to, 4.0, MARK);
    }
}

/// Draws a ring around a body that can move, and the edges of a box or a polygon.
fn outline(painter: &Painter, area: Rect, viewer: &Viewer, body: Body) {
    let scene = viewer.session.simulation_ref().scene();
    if let Some((centre, radius)) = ball(scene, body)
        && let Some((at, scale)) = project(viewer, area, centre)
    {
        painter.circle_stroke(at, radius * scale + 3.0, STROKE);
    }
    for [from, to] in edges(scene, body) {
        if let Some(segment) = segment(viewer, area, from, to) {
            painter.line_segment(segment, STROKE);
        }
    }
}

/// Returns the edges of a box or a polygon.
pub(super) fn edges(scene: &Scene, body: Body) -> Vec<[Vec3; 2]> {
    let sides = |corner: Vec3, [one, two]: [Vec3; 2]| {
        let corners = [corner, corner + one, corner + one + two, corner + two];
        (0..4).map(move |at| [corners[at], corners[(at + 1) % 4]])
    };
    match body {
        Body::Box(id) => {
            let Ok(cuboid) = scene.cuboid(id) else { return Vec::new() };
            let (corner, [i, j, k]) = (cuboid.corner, cuboid.edges);
            let pillars = [Vec3::ZERO, i, i + j, j].map(|at| [corner + at, corner + at + k]);
            sides(corner, [i, j]).chain(sides(corner + k, [i, j])).chain(pillars).collect()
        }
        Body::Polygon(id) => scene.polygon(id).map_or_else(
            |_| Vec::new(),
            |polygon| {
                if polygon.surface.is_smooth() {
                    return rings(polygon);
                }
                let next = polygon.vertices().skip(1).chain([polygon.corner]);
                polygon.vertices().zip(next).map(<[Vec3; 2]>::from).collect()
            },
        ),
        _ => Vec::new(),
    }
}

/// Lines that stand for a smooth wall: the rims of a cone, three circles of a ball, and the cross of the edges of a plane.
fn rings(wall: &Polygon) -> Vec<[Vec3; 2]> {
    let ring = |centre: Vec3, one: Vec3, other: Vec3| {
        let point = move |part: u8| {
            let angle = std::f32::consts::TAU * f32::from(part) / 48.0;
            wall.corner + centre + angle.cos() * one + angle.sin() * other
        };
        (0..48).map(move |part| [point(part), point(part + 1)])
    };
    let (left, right) = (wall.left, wall.right);
    match (wall.surface, wall.cone_axis()) {
        (_, Some(axis)) => {
            let (along, out) = (axis.along.as_vec3(), right.normalize());
            let beside = along.normalize().cross(out);
            let [start, end] = axis.radii.map(|radius| radius as f32);
            ring(Vec3::ZERO, start * out, start * beside).chain(ring(along, end * out, end * beside)).collect()
        }
        (Surface::Plane, None) => [left, right].map(|edge| [wall.corner - edge, wall.corner + edge]).to_vec(),
        (_, None) => {
            let third = left.cross(right) / left.length();
            let rings = [[left, right], [right, third], [third, left]].map(|[one, other]| ring(Vec3::ZERO, one, other));
            rings.into_iter().flatten().collect()
        }
    }
}

/// Returns the position of a point of the scene on the screen, and the length of a unit there, in points.
pub(super) fn project(viewer: &Viewer, area: Rect, point: Vec3) -> Option<(Pos2, f32)> {
    let axes = viewer.camera.axes();
    let depth = (point - viewer.camera.eye).dot(axes.forward);
    if depth <= viewer.camera.near() {
        return None;
    }
    let ndc = viewer.camera.view_projection(viewer.aspect()).project_point3(point);
    let half = area.size() * 0.5;
    let place = area.center() + egui::vec2(ndc.x * half.x, -ndc.y * half.y);
    Some((place, half.y / ((0.5 * viewer.camera.field_of_view).tan() * depth)))
}

/// Returns the part of a line that is in front of the camera, on the screen.
fn segment(viewer: &Viewer, area: Rect, mut from: Vec3, mut to: Vec3) -> Option<[Pos2; 2]> {
    let forward = viewer.camera.axes().forward;
    let least = 2.0 * viewer.camera.near();
    let depth = |point: Vec3| (point - viewer.camera.eye).dot(forward);
    let (one, two) = (depth(from), depth(to));
    if one.max(two) <= least {
        return None;
    }
    let cut = from.lerp(to, (least - one) / (two - one));
    if one < least {
        from = cut;
    } else if two < least {
        to = cut;
    }
    Some([project(viewer, area, from)?.0, project(viewer, area, to)?.0])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn the_edges_of_boxes_and_polygons_are_outlined() {
        let text = "B 0 0 0 1 0 0 0 2 0 0 0 3\nP 5 0 0 0 0 1 1 0 0\nS 1 9 9 9 0 0 0 0 0 0 1 0.5\n";
        let scene = Scene::parse(text, Path::new("test")).unwrap().scene;
        let length = |edges: &[[Vec3; 2]]| edges.iter().map(|[from, to]| from.distance(*to)).sum::<f32>();
        let cuboid = edges(&scene, Body::Box(scene.box_ids().next().unwrap()));
        assert_eq!((cuboid.len(), length(&cuboid)), (12, 4.0 * 6.0));
        let polygon = edges(&scene, Body::Polygon(scene.polygon_ids().next().unwrap()));
        assert_eq!((polygon.len(), length(&polygon)), (4, 4.0));
        assert!(edges(&scene, Body::Sphere(scene.sphere_ids().next().unwrap())).is_empty());
    }
}
