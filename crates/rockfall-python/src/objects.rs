//! Adds, removes and changes objects in bulk. The Python layer has checked shapes, types and ranges and repeats scalars, so all
//! arrays are contiguous and have one row per object. Nothing is added when a row is wrong.

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::{Capsule, Cuboid, Polygon, Rod, Sphere, SphereId, Spring, Tether};

use crate::arguments::{Floats, Groups, Numbers, Rows, Switches, check, quaternion, vector};
use crate::doors::with;
use crate::errors::{Raise, raise};
use crate::ids::{Ids, handle};

fn at_row(row: usize, error: rockfall::Error) -> PyErr {
    PyValueError::new_err(format!("row {row}: {error}"))
}

fn ends<'a>(spheres: &'a [SphereId], ids: &'a [i64]) -> impl Iterator<Item = PyResult<SphereId>> + 'a {
    ids.iter().map(|id| handle(spheres, "sphere", *id))
}

/// Adds spheres and returns the number of the first.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn add_spheres(
    target: &Bound<'_, PyAny>,
    position: Rows<'_>,
    radius: Floats<'_>,
    mass: Floats<'_>,
    velocity: Rows<'_>,
    angular_momentum: Rows<'_>,
    orientation: Rows<'_>,
    force: Rows<'_>,
    fixed: Switches<'_>,
    group: Groups<'_>,
) -> PyResult<usize> {
    let count = radius.len();
    let vectors = [&position, &velocity, &angular_momentum, &force];
    check(count, &vectors.map(|rows| rows.len() / 3))?;
    check(count, &[mass.len(), orientation.len() / 4, fixed.len(), group.len()])?;
    let [position, velocity, angular_momentum, force] =
        [position.as_slice()?, velocity.as_slice()?, angular_momentum.as_slice()?, force.as_slice()?];
    let (radius, mass, orientation) = (radius.as_slice()?, mass.as_slice()?, orientation.as_slice()?);
    let (fixed, group) = (fixed.as_slice()?, group.as_slice()?);
    with(target, |doors, ids| {
        let sphere = |k: usize| {
            let mut sphere = Sphere::new(vector(position, k), radius[k]).mass(mass[k]).group(group[k]);
            sphere.velocity = vector(velocity, k);
            sphere.angular_momentum = vector(angular_momentum, k);
            sphere.orientation = quaternion(orientation, k);
            sphere.force = vector(force, k);
            sphere.fixed = fixed[k];
            sphere
        };
        let mut scratch = rockfall::Scene::new();
        for k in 0..count {
            scratch.add_sphere(sphere(k)).map_err(|error| at_row(k, error))?;
        }
        let first = ids.spheres.len();
        ids.spheres.reserve(count);
        for sphere in scratch.spheres() {
            ids.spheres.push(doors.add_sphere(*sphere).or_raise()?);
        }
        Ok(first)
    })
}

/// Adds rods and returns the number of the first. A length of 0 is free.
#[pyfunction]
pub(crate) fn add_rods(
    target: &Bound<'_, PyAny>,
    end1: Numbers<'_>,
    end2: Numbers<'_>,
    radius: Floats<'_>,
    length: Floats<'_>,
    group: Groups<'_>,
) -> PyResult<usize> {
    let count = end1.len();
    check(count, &[end2.len(), radius.len(), length.len(), group.len()])?;
    let (end1, end2, radius, length) = (end1.as_slice()?, end2.as_slice()?, radius.as_slice()?, length.as_slice()?);
    let group = group.as_slice()?;
    with(target, |doors, ids| {
        let pairs = pairs(doors.objects(), ids, end1, end2)?;
        let first = ids.rods.len();
        ids.rods.reserve(count);
        for (k, (one, two)) in pairs.into_iter().enumerate() {
            let mut rod = Rod::new(one, two, radius[k]).group(group[k]);
            rod.length = (length[k] > 0.0).then_some(length[k]);
            ids.rods.push(doors.add_rod(rod).map_err(|error| at_row(k, error))?);
        }
        Ok(first)
    })
}

/// The spheres of each row, which must be in the scene and different.
fn pairs(scene: &rockfall::Scene, ids: &Ids, one: &[i64], two: &[i64]) -> PyResult<Vec<(SphereId, SphereId)>> {
    let found: Vec<_> =
        ends(&ids.spheres, one).zip(ends(&ids.spheres, two)).map(|(a, b)| Ok((a?, b?))).collect::<PyResult<_>>()?;
    for (row, (a, b)) in found.iter().enumerate() {
        scene.sphere(*a).and(scene.sphere(*b)).or_raise()?;
        if a == b {
            let text = format!("row {row}: both ends are sphere {}, expected two different spheres", one[row]);
            return Err(PyValueError::new_err(text));
        }
    }
    Ok(found)
}

/// Adds springs and returns the number of the first.
#[pyfunction]
pub(crate) fn add_springs(
    target: &Bound<'_, PyAny>,
    a: Numbers<'_>,
    b: Numbers<'_>,
    stiffness: Floats<'_>,
    length: Floats<'_>,
    damping: Floats<'_>,
) -> PyResult<usize> {
    let count = a.len();
    check(count, &[b.len(), stiffness.len(), length.len(), damping.len()])?;
    let (a, b, stiffness) = (a.as_slice()?, b.as_slice()?, stiffness.as_slice()?);
    let (length, damping) = (length.as_slice()?, damping.as_slice()?);
    with(target, |doors, ids| {
        let pairs = pairs(doors.objects(), ids, a, b)?;
        let first = ids.springs.len();
        ids.springs.reserve(count);
        for (k, (a, b)) in pairs.into_iter().enumerate() {
            // A negative length stands for the distance of the spheres.
            let rest = match length[k] {
                length if length >= 0.0 => length,
                _ => doors.objects().sphere(a).or_raise()?.position.distance(doors.objects().sphere(b).or_raise()?.position),
            };
            let spring = Spring::new(a, b, stiffness[k], rest).damping(damping[k]);
            ids.springs.push(doors.add_spring(spring).map_err(|error| at_row(k, error))?);
        }
        Ok(first)
    })
}

/// Adds tethers and returns the number of the first.
#[pyfunction]
pub(crate) fn add_tethers(
    target: &Bound<'_, PyAny>,
    sphere: Numbers<'_>,
    point: Rows<'_>,
    stiffness: Floats<'_>,
    length: Floats<'_>,
    damping: Floats<'_>,
) -> PyResult<usize> {
    let count = sphere.len();
    check(count, &[point.len() / 3, stiffness.len(), length.len(), damping.len()])?;
    let (sphere, point, stiffness) = (sphere.as_slice()?, point.as_slice()?, stiffness.as_slice()?);
    let (length, damping) = (length.as_slice()?, damping.as_slice()?);
    with(target, |doors, ids| {
        let spheres: Vec<_> = ends(&ids.spheres, sphere).collect::<PyResult<_>>()?;
        spheres.iter().try_for_each(|id| doors.objects().sphere(*id).map(drop)).or_raise()?;
        let first = ids.tethers.len();
        for (k, id) in spheres.into_iter().enumerate() {
            let tether = Tether::new(id, vector(point, k), stiffness[k]).length(length[k]).damping(damping[k]);
            ids.tethers.push(doors.add_tether(tether).map_err(|error| at_row(k, error))?);
        }
        Ok(first)
    })
}

/// Adds capsules. Returns the numbers of the first capsule, the first sphere and the first rod: capsule k of this call consists
/// of spheres 2 k and 2 k + 1 and rod k after those.
#[pyfunction]
pub(crate) fn add_capsules(
    target: &Bound<'_, PyAny>,
    end1: Rows<'_>,
    end2: Rows<'_>,
    radius: Floats<'_>,
    mass: Floats<'_>,
    velocity: Rows<'_>,
    group: Groups<'_>,
) -> PyResult<(usize, usize, usize)> {
    let count = radius.len();
    check(count, &[end1.len() / 3, end2.len() / 3, mass.len(), velocity.len() / 3, group.len()])?;
    let (end1, end2, velocity) = (end1.as_slice()?, end2.as_slice()?, velocity.as_slice()?);
    let (radius, mass, group) = (radius.as_slice()?, mass.as_slice()?, group.as_slice()?);
    with(target, |doors, ids| {
        let capsule = |k: usize| {
            let capsule = Capsule::new(vector(end1, k), vector(end2, k), radius[k]).mass(mass[k]);
            capsule.velocity(vector(velocity, k)).group(group[k])
        };
        let mut scratch = rockfall::Scene::new();
        for k in 0..count {
            scratch.add_capsule(capsule(k)).map_err(|error| at_row(k, error))?;
        }
        let first = (ids.capsules.len(), ids.spheres.len(), ids.rods.len());
        for k in 0..count {
            let id = doors.add_capsule(capsule(k)).or_raise()?;
            let parts = *doors.objects().capsule(id).or_raise()?;
            ids.capsules.push(id);
            ids.spheres.extend([parts.end1, parts.end2]);
            ids.rods.push(parts.rod);
        }
        Ok(first)
    })
}

/// Adds boxes from corners and edges (three rows of the array `edges` per box), and returns the number of the first.
#[pyfunction]
pub(crate) fn add_boxes(target: &Bound<'_, PyAny>, corner: Rows<'_>, edges: Rows<'_>, group: Groups<'_>) -> PyResult<usize> {
    let count = group.len();
    check(count, &[corner.len() / 3, edges.len() / 9])?;
    let (corner, edges, group) = (corner.as_slice()?, edges.as_slice()?, group.as_slice()?);
    with(target, |doors, ids| {
        let cuboid = |k: usize| {
            let [i, j, l] = [3 * k, 3 * k + 1, 3 * k + 2].map(|row| vector(edges, row));
            Cuboid::new(vector(corner, k), i, j, l).group(group[k])
        };
        let mut scratch = rockfall::Scene::new();
        (0..count).try_for_each(|k| scratch.add_box(cuboid(k)).map(drop).map_err(|error| at_row(k, error)))?;
        let first = ids.boxes.len();
        for k in 0..count {
            ids.boxes.push(doors.add_box(cuboid(k)).or_raise()?);
        }
        Ok(first)
    })
}

/// Adds polygons and returns the number of the first.
#[pyfunction]
pub(crate) fn add_polygons(
    target: &Bound<'_, PyAny>,
    corner: Rows<'_>,
    left: Rows<'_>,
    right: Rows<'_>,
    group: Groups<'_>,
) -> PyResult<usize> {
    let count = group.len();
    check(count, &[corner.len() / 3, left.len() / 3, right.len() / 3])?;
    let (corner, left, right, group) = (corner.as_slice()?, left.as_slice()?, right.as_slice()?, group.as_slice()?);
    with(target, |doors, ids| {
        let polygon = |k: usize| Polygon::new(vector(corner, k), vector(left, k), vector(right, k)).group(group[k]);
        let mut scratch = rockfall::Scene::new();
        (0..count).try_for_each(|k| scratch.add_polygon(polygon(k)).map(drop).map_err(|error| at_row(k, error)))?;
        let first = ids.polygons.len();
        for k in 0..count {
            ids.polygons.push(doors.add_polygon(polygon(k)).or_raise()?);
        }
        Ok(first)
    })
}

/// Removes objects of one kind.
#[pyfunction]
pub(crate) fn remove(target: &Bound<'_, PyAny>, kind: &str, numbers: Numbers<'_>) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    with(target, |doors, ids| {
        macro_rules! each {
            ($table:ident, $get:ident, $remove:ident) => {{
                let handles: Vec<_> = numbers.iter().map(|id| handle(&ids.$table, kind, *id)).collect::<PyResult<_>>()?;
                handles.iter().try_for_each(|id| doors.objects().$get(*id).map(drop)).or_raise()?;
                handles.into_iter().try_for_each(|id| doors.$remove(id)).or_raise()
            }};
        }
        match kind {
            "sphere" => each!(spheres, sphere, remove_sphere),
            "rod" => each!(rods, rod, remove_rod),
            "capsule" => each!(capsules, capsule, remove_capsule),
            "spring" => each!(springs, spring, remove_spring),
            "tether" => each!(tethers, tether, remove_tether),
            "box" => each!(boxes, cuboid, remove_box),
            "polygon" => each!(polygons, polygon, remove_polygon),
            _ => Err(PyValueError::new_err(format!("kind: {kind} is not a kind of object"))),
        }
    })
}

/// Changes fields of rods, springs or tethers: pairs of a name and an array with one value per object.
#[pyfunction]
pub(crate) fn update(
    target: &Bound<'_, PyAny>,
    kind: &str,
    numbers: Numbers<'_>,
    fields: Vec<(String, Rows<'_>)>,
) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    let fields: Vec<(&str, &[f32])> =
        fields.iter().map(|(name, rows)| Ok((name.as_str(), rows.as_slice()?))).collect::<PyResult<_>>()?;
    for (name, values) in &fields {
        check(numbers.len() * if *name == "point" { 3 } else { 1 }, &[values.len()])?;
    }
    with(target, |doors, ids| {
        for (k, id) in numbers.iter().enumerate() {
            let changed = match kind {
                "rod" => doors.update_rod(handle(&ids.rods, kind, *id)?, &|rod| {
                    fields.iter().for_each(|(name, values)| match *name {
                        "radius" => rod.radius = values[k],
                        _ => rod.length = (values[k] > 0.0).then_some(values[k]),
                    });
                }),
                "spring" => doors.update_spring(handle(&ids.springs, kind, *id)?, &|spring| {
                    fields.iter().for_each(|(name, values)| match *name {
                        "stiffness" => spring.stiffness = values[k],
                        "length" => spring.length = values[k],
                        _ => spring.damping = values[k],
                    });
                }),
                _ => doors.update_tether(handle(&ids.tethers, kind, *id)?, &|tether| {
                    fields.iter().for_each(|(name, values)| match *name {
                        "point" => tether.point = vector(values, k),
                        "stiffness" => tether.stiffness = values[k],
                        "length" => tether.length = values[k],
                        _ => tether.damping = values[k],
                    });
                }),
            };
            changed.map_err(raise)?;
        }
        Ok(())
    })
}
