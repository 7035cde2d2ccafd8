//! Shapes and rigid bodies.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::Vec3;
use rockfall::{Cuboid, ObjectId, Placement, RigidBody, Shape};

use crate::arguments::{Numbers, Rows, check, quaternion, vector};
use crate::doors::{with, with_states};
use crate::errors::Raise;
use crate::ids::handle;
use crate::materials::materials_of;
use crate::motions::find;
use crate::names::{Texts, tag_of};

/// Centre, radius, group and material of a sphere.
type ShapeSphere = ([f32; 3], f32, u16, i64);
/// Spheres at the ends, radius, group and material of a rod.
type ShapeRod = (usize, usize, f32, u16, i64);
/// Corner, edges, group and material of a box.
type ShapeBox = ([f32; 3], [[f32; 3]; 3], u16, i64);
/// Points, group and material of a hull.
type ShapeHull = (Vec<[f32; 3]>, u16, i64);
/// Mass, density, and centre with inertia.
type Mass = (Option<f32>, Option<f32>, Option<([f32; 3], [f32; 6])>);

/// Adds a shape and returns its number. `rounding` is that of all boxes.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn add_shape(
    target: &Bound<'_, PyAny>,
    name: Option<String>,
    mass: Mass,
    spheres: Vec<ShapeSphere>,
    rods: Vec<ShapeRod>,
    boxes: Vec<ShapeBox>,
    hulls: Vec<ShapeHull>,
    rounding: f32,
) -> PyResult<usize> {
    with(target, |doors, ids| {
        let mut shape = Shape::new().rounding(rounding);
        for (centre, radius, group, material) in spheres {
            shape = shape.sphere(centre, radius);
            if let Some(part) = shape.spheres.last_mut() {
                (part.group, part.material) = (group, materials_of(ids, &[material])?.pop().flatten());
            }
        }
        for (end1, end2, radius, group, material) in rods {
            shape = shape.rod(end1, end2, radius);
            if let Some(part) = shape.rods.last_mut() {
                (part.group, part.material) = (group, materials_of(ids, &[material])?.pop().flatten());
            }
        }
        for (corner, [i, j, k], group, material) in boxes {
            shape = shape.cuboid(Cuboid::new(corner, i, j, k));
            if let Some(part) = shape.boxes.last_mut() {
                let material = materials_of(ids, &[material])?.pop().flatten();
                (part.cuboid.group, part.cuboid.material) = (group, material);
            }
        }
        for (points, group, material) in hulls {
            let part = Shape::new().group(group);
            let part = match materials_of(ids, &[material])?.pop().flatten() {
                Some(material) => part.material(material),
                None => part,
            };
            shape.hulls.extend(part.add_hull(points).or_raise()?.hulls);
        }
        shape = match mass {
            (mass, _, Some((centre, inertia))) => shape.mass_properties(mass.unwrap_or(1.0), centre, inertia),
            (_, Some(density), None) => shape.density(density),
            (mass, None, None) => shape.mass(mass.unwrap_or(1.0)),
        };
        shape.name = name;
        ids.shapes.push(doors.add_shape(shape).or_raise()?);
        Ok(ids.shapes.len() - 1)
    })
}

/// Mass, centre and inertia of a shape.
#[pyfunction]
pub(crate) fn shape_mass(target: &Bound<'_, PyAny>, shape: i64) -> PyResult<(f64, [f64; 3], [f64; 6])> {
    with(target, |doors, ids| {
        let properties =
            doors.objects().shape(handle(&ids.shapes, "shape", shape)?).and_then(|shape| shape.mass_properties_of());
        let properties = properties.or_raise()?;
        Ok((properties.mass, properties.centre, properties.inertia))
    })
}

/// Adds bodies of a shape. Returns the numbers of the first body, the first sphere and the first rod, and how many spheres and rods
/// each body has.
#[pyfunction]
pub(crate) fn add_bodies(
    target: &Bound<'_, PyAny>,
    shape: i64,
    position: Rows<'_>,
    orientation: Rows<'_>,
    velocity: Rows<'_>,
    spin: Rows<'_>,
) -> PyResult<([usize; 3], [usize; 2])> {
    let (position, orientation) = (position.as_slice()?, orientation.as_slice()?);
    let (velocity, spin) = (velocity.as_slice()?, spin.as_slice()?);
    let count = position.len() / 3;
    check(count, &[count, orientation.len() / 4, velocity.len() / 3, spin.len() / 3])?;
    with_states(target, |doors, ids| {
        let id = handle(&ids.shapes, "shape", shape)?;
        let parts = doors.objects().shape(id).or_raise()?;
        let parts = [parts.sphere_count(), parts.rods.len()];
        let mut added = Vec::with_capacity(count);
        for k in 0..count {
            let place = Placement::new(id).at(vector(position, k)).turned(quaternion(orientation, k));
            match doors.add_body(place.velocity(vector(velocity, k)).spin(vector(spin, k))) {
                Ok(body) => added.push(body),
                Err(error) => {
                    // Nothing is added when a row is wrong.
                    doors.remove_bodies(&added).or_raise()?;
                    return Err(PyValueError::new_err(format!("row {k}: {error}")));
                }
            }
        }
        let first = [ids.bodies.len(), ids.spheres.len(), ids.rods.len()];
        for body in &added {
            let body = doors.objects().body(*body).or_raise()?;
            ids.spheres.extend(body.spheres());
            ids.rods.extend(body.rods());
        }
        ids.bodies.extend(added);
        Ok((first, parts))
    })
}

/// Adds the parts of a shape as fixed objects, or as walls that follow a motion. Returns the numbers of the first sphere, rod, box and
/// polygon, and how many there are of each.
#[pyfunction]
pub(crate) fn add_static_body(
    target: &Bound<'_, PyAny>,
    shape: i64,
    position: Rows<'_>,
    orientation: Rows<'_>,
    motion: Option<&str>,
    tag: Texts,
) -> PyResult<([usize; 4], [usize; 4])> {
    let (position, orientation) = (position.as_slice()?, orientation.as_slice()?);
    check(1, &[position.len() / 3, orientation.len() / 4])?;
    let tag = tag_of(tag).or_raise()?;
    with(target, |doors, ids| {
        let motion = motion.map(|name| find(doors.objects(), name)).transpose()?;
        let id = handle(&ids.shapes, "shape", shape)?;
        let place = Placement::new(id).at(vector(position, 0)).turned(quaternion(orientation, 0));
        let first = [ids.spheres.len(), ids.rods.len(), ids.boxes.len(), ids.polygons.len()];
        for part in doors.add_static_body(place, motion).or_raise()? {
            let own = doors.objects().tag(part).or_raise()?.cloned().unwrap_or_default();
            doors.set_tag(part, own.or(&tag)).or_raise()?;
            match part {
                ObjectId::Sphere(id) => ids.spheres.push(id),
                ObjectId::Rod(id) => ids.rods.push(id),
                ObjectId::Box(id) => ids.boxes.push(id),
                ObjectId::Polygon(id) => ids.polygons.push(id),
                // A static body has no other parts.
                _ => {}
            }
        }
        let after = [ids.spheres.len(), ids.rods.len(), ids.boxes.len(), ids.polygons.len()];
        Ok((first, std::array::from_fn(|kind| after[kind] - first[kind])))
    })
}

/// Sets a field of the state of a body from a row. Names of other fields are ignored.
pub(crate) fn put(body: &mut RigidBody, field: &str, rows: &[f32], row: usize) {
    match field {
        "position" => body.set_centre(vector(rows, row).as_dvec3()),
        "orientation" => body.orientation = quaternion(rows, row),
        "velocity" => body.velocity = vector(rows, row),
        "angular_momentum" => body.angular_momentum = vector(rows, row),
        "force" => body.force = vector(rows, row),
        "torque" => body.torque = vector(rows, row),
        _ => {}
    }
}

/// Sets fields of the states of bodies: pairs of a name and an array with one row per body. Nothing changes if a row is wrong.
#[pyfunction]
pub(crate) fn set_bodies(target: &Bound<'_, PyAny>, numbers: Numbers<'_>, fields: Vec<(String, Rows<'_>)>) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    let fields = fields.iter().map(|(name, rows)| Ok((name.as_str(), rows.as_slice()?))).collect::<PyResult<Vec<_>>>()?;
    with_states(target, |doors, ids| {
        let handles: Vec<_> = numbers.iter().map(|id| handle(&ids.bodies, "body", *id)).collect::<PyResult<_>>()?;
        let before = handles.iter().map(|id| doors.objects().body(*id).cloned()).collect::<rockfall::Result<Vec<_>>>();
        let before = before.or_raise()?;
        for (k, id) in handles.iter().enumerate() {
            let changed = doors.update_body(*id, &|body: &mut RigidBody| {
                fields.iter().for_each(|(name, rows)| put(body, name, rows, k));
            });
            if let Err(error) = changed {
                for (id, before) in handles[..k].iter().zip(&before) {
                    doors.update_body(*id, &|body: &mut RigidBody| *body = before.clone()).or_raise()?;
                }
                return Err(PyValueError::new_err(format!("row {k}: {error}")));
            }
        }
        Ok(())
    })
}

/// Applies impulses at points of bodies, or adds forces there. Without points they act at the centres of mass. Nothing changes if a row
/// is wrong.
#[pyfunction]
pub(crate) fn push_bodies(
    target: &Bound<'_, PyAny>,
    what: &str,
    numbers: Numbers<'_>,
    rows: Rows<'_>,
    points: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<()> {
    let (numbers, rows) = (numbers.as_slice()?, rows.as_slice()?);
    let points = points.as_ref().map(|points| points.as_slice()).transpose()?;
    check(numbers.len(), &[rows.len() / 3, points.map_or(numbers.len(), |points| points.len() / 3)])?;
    if let Some(row) = points.and_then(|points| points.iter().position(|number| !number.is_finite())) {
        return Err(PyValueError::new_err(format!("points: expected finite numbers, got another one in row {}", row / 3)));
    }
    let is_impulse = what == "impulse";
    with_states(target, |doors, ids| {
        let handles: Vec<_> = numbers.iter().map(|id| handle(&ids.bodies, "body", *id)).collect::<PyResult<_>>()?;
        let before = handles.iter().map(|id| doors.objects().body(*id).cloned()).collect::<rockfall::Result<Vec<_>>>();
        let before = before.or_raise()?;
        for (k, id) in handles.iter().enumerate() {
            let centre = doors.objects().body(*id).or_raise()?.centre();
            let point = points.map_or(centre, |points| std::array::from_fn(|axis| points[3 * k + axis]));
            let row = vector(rows, k);
            let pushed = if is_impulse {
                doors.apply_body_impulse(*id, row, point.into())
            } else {
                doors.add_body_force(*id, row, point.into())
            };
            if let Err(error) = pushed {
                for (id, before) in handles[..k].iter().zip(&before).rev() {
                    doors.update_body(*id, &|body: &mut RigidBody| *body = before.clone()).or_raise()?;
                }
                return Err(PyValueError::new_err(format!("row {k}: {error}")));
            }
        }
        Ok(())
    })
}

/// A field of the state of all bodies, in order of addition: 4 numbers per body for orientations w, x, y, z, otherwise 3.
#[pyfunction]
pub(crate) fn body_states<'py>(target: &Bound<'py, PyAny>, field: &str) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let numbers = with_states(target, |doors, _| {
        let bodies = doors.objects().bodies();
        let of = |field: fn(&RigidBody) -> Vec3| bodies.iter().flat_map(|body| field(body).to_array()).collect();
        Ok(match field {
            "position" => of(|body| body.position),
            "velocity" => of(|body| body.velocity),
            "angular_momentum" => of(|body| body.angular_momentum),
            "force" => of(|body| body.force),
            "torque" => of(|body| body.torque),
            "orientation" => bodies.iter().map(|body| body.orientation).flat_map(|q| [q.w, q.x, q.y, q.z]).collect(),
            _ => return Err(PyValueError::new_err(format!("field: {field} is not a field of a rigid body"))),
        })
    })?;
    Ok(PyArray1::from_vec(target.py(), numbers))
}
