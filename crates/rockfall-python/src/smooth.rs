//! Smooth walls: planes, cones, cylinders and balls.

use pyo3::prelude::*;
use rockfall::Polygon;
use rockfall::glam::Vec3;

use crate::doors::with;
use crate::errors::Raise;
use crate::materials::materials_of;

/// Adds a plane (`direction` is its normal), a cone (`direction` is its axis) or a ball, and returns its number. A ball has its radius twice.
#[pyfunction]
pub(crate) fn add_smooth(
    target: &Bound<'_, PyAny>,
    kind: &str,
    at: [f32; 3],
    direction: [f32; 3],
    size: ([f32; 2], f32, bool),
    group: u16,
    material: i64,
) -> PyResult<usize> {
    let (radii, length, inside) = size;
    let wall = match kind {
        "plane" => Polygon::plane(at, direction),
        "ball" => Polygon::ball(at, radii[0]),
        _ => Polygon::cone(at, Vec3::from(direction), radii, length),
    };
    with(target, |doors, ids| {
        let mut wall = wall.inside(inside).group(group);
        wall.material = materials_of(ids, &[material])?[0];
        ids.polygons.push(doors.add_polygon(wall).or_raise()?);
        Ok(ids.polygons.len() - 1)
    })
}
