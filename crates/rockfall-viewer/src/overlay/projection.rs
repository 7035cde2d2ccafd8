//! Where points are in a picture.

use rockfall::glam::{Mat4, Vec3};

use crate::camera::{Axes, Camera};

/// The projection of points to a picture.
pub(super) struct Projection {
    matrix: Mat4,
    size: [f32; 2],
    eye: Vec3,
    forward: Vec3,
    near: f32,
    distance: f32,
    pixels_per_unit: f32,
}

impl Projection {
    pub(super) fn new(camera: &Camera, size: [f32; 2]) -> Self {
        let Axes { forward, .. } = camera.axes();
        let distance = camera.eye.distance(camera.target);
        Self {
            matrix: camera.view_projection(size[0] / size[1]),
            size,
            eye: camera.eye,
            forward,
            near: camera.near(),
            distance,
            pixels_per_unit: 0.5 * size[1] / ((0.5 * camera.field_of_view).tan() * distance),
        }
    }

    /// Length of a unit at the distance of the middle of the picture, in pixels.
    pub(super) fn pixels_per_unit(&self) -> f32 {
        self.pixels_per_unit
    }

    /// Length of a unit at the distance of a point in front of the camera, in pixels.
    pub(super) fn pixels_per_unit_at(&self, point: Vec3) -> f32 {
        self.pixels_per_unit * self.distance / (point - self.eye).dot(self.forward)
    }

    /// The place of a point on the picture; `None` if it is not in front of the camera, or far outside.
    pub(super) fn place(&self, point: Vec3) -> Option<[f32; 2]> {
        if !point.is_finite() || (point - self.eye).dot(self.forward) <= self.near {
            return None;
        }
        let ndc = self.matrix.project_point3(point);
        let is_near = ndc.x.abs() < 4.0 && ndc.y.abs() < 4.0;
        is_near.then(|| [0.5 * (ndc.x + 1.0) * self.size[0], 0.5 * (1.0 - ndc.y) * self.size[1]])
    }
}
