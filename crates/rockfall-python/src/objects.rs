//! Adds, removes and changes objects in bulk. The Python layer has checked shapes, types and ranges and repeats scalars, so all
//! arrays are contiguous and have one row per object. Nothing is added when a row is wrong.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::Vec3;
use rockfall::{Capsule, Cuboid, MaterialId, Muscle, Polygon, Rod, Scene, Sphere, SphereId, Spring, Tether};

use crate::arguments::{Floats, Groups, Numbers, Rows, Switches, check, quaternion, vector};
use crate::doors::{Doors, with, with_states};
use crate::errors::{Raise, raise};
use crate::ids::{Ids, handle};
use crate::materials::materials_of;

/// An error of a row. Only errors of values name the row.
fn at_row(row: usize, error: rockfall::Error) -> PyErr {
    match error {
        rockfall::Error::Invalid { .. } => PyValueError::new_err(format!("row {row}: {error}")),
        other => raise(other),
    }
}

/// Makes slices of arrays, checks that all have the same number of rows, and defines that number.
macro_rules! rows {
    ($count:ident: $($array:ident / $columns:literal),+) => {
        $(let $array = $array.as_slice()?;)+
        let lengths = [$($array.len() / $columns),+];
        let $count = lengths[0];
        check($count, &lengths)?;
    };
}

/// An object with a material.
macro_rules! with_material {
    ($object:expr, $material:expr) => {{
        let mut object = $object;
        object.material = $material;
        object
    }};
}

/// Adds objects, and their handles to those of the kind. Returns the number of the first.
fn add_all<D: Doors + ?Sized, T, Id>(
    doors: &mut D,
    ids: &mut Vec<Id>,
    objects: impl ExactSizeIterator<Item = T>,
    add: fn(&mut D, T) -> rockfall::Result<Id>,
) -> PyResult<usize> {
    let first = ids.len();
    ids.reserve(objects.len());
    for (row, object) in objects.enumerate() {
        ids.push(add(doors, object).map_err(|error| at_row(row, error))?);
    }
    Ok(first)
}

/// Adds objects to an empty scene, so that a wrong row is found before the first object is added.
fn try_all<T, Id>(objects: impl ExactSizeIterator<Item = T>, add: fn(&mut Scene, T) -> rockfall::Result<Id>) -> PyResult<()> {
    add_all(&mut Scene::new(), &mut Vec::new(), objects, add).map(drop)
}

/// The density of the material of each row in which a mass of 0 stands for the volume times that density; otherwise 0.
fn densities(scene: &Scene, materials: &[Option<MaterialId>], mass: &[f32]) -> PyResult<Vec<f32>> {
    let density = |(row, (material, mass)): (usize, (&Option<MaterialId>, &f32))| {
        if *mass != 0.0 {
            return Ok(0.0);
        }
        let known = material.map(|id| scene.material(id)).transpose().or_raise()?.and_then(|material| material.density);
        let text = || format!("row {row}: mass: expected a number, or a material with a density");
        known.ok_or_else(|| PyValueError::new_err(text()))
    };
    materials.iter().zip(mass).enumerate().map(density).collect()
}

/// The spheres of each row.
fn ends(spheres: &[SphereId], numbers: &[i64]) -> PyResult<Vec<SphereId>> {
    numbers.iter().map(|number| handle(spheres, "sphere", *number)).collect()
}

/// The spheres of each row, which must be in the scene and different.
fn pairs(scene: &Scene, ids: &Ids, one: &[i64], two: &[i64]) -> PyResult<Vec<(SphereId, SphereId)>> {
    let found: Vec<_> = ends(&ids.spheres, one)?.into_iter().zip(ends(&ids.spheres, two)?).collect();
    for (row, (a, b)) in found.iter().enumerate() {
        scene.sphere(*a).and(scene.sphere(*b)).or_raise()?;
        if a == b {
            let text = format!("row {row}: both ends are sphere {}, expected two different spheres", one[row]);
            return Err(PyValueError::new_err(text));
        }
    }
    Ok(found)
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
    material: Numbers<'_>,
) -> PyResult<usize> {
    rows!(count: position / 3, radius / 1, mass / 1, velocity / 3, angular_momentum / 3, orientation / 4, force / 3, fixed / 1,
          group / 1, material / 1);
    let sphere = |k: usize, density: f32| {
        let sphere = Sphere::new(vector(position, k), radius[k]).group(group[k]);
        let mut sphere = if density > 0.0 { sphere.density(density) } else { sphere.mass(mass[k]) };
        sphere.velocity = vector(velocity, k);
        sphere.angular_momentum = vector(angular_momentum, k);
        sphere.orientation = quaternion(orientation, k);
        sphere.force = vector(force, k);
        sphere.fixed = fixed[k];
        sphere
    };
    with(target, |doors, ids| {
        let materials = materials_of(ids, material)?;
        let densities = densities(doors.objects(), &materials, mass)?;
        try_all((0..count).map(|k| sphere(k, densities[k])), Doors::add_sphere)?;
        let sphere = |k: usize| with_material!(sphere(k, densities[k]), materials[k]);
        add_all(doors, &mut ids.spheres, (0..count).map(sphere), Doors::add_sphere)
    })
}

/// The length of a row. A negative one stands for the distance of the spheres.
fn length_or_distance(scene: &Scene, (a, b): (SphereId, SphereId), length: f32) -> PyResult<f32> {
    if length >= 0.0 {
        return Ok(length);
    }
    let place = |sphere: SphereId| scene.sphere(sphere).map(|sphere| sphere.position).or_raise();
    Ok(place(a)?.distance(place(b)?))
}

/// Adds rods and returns the number of the first. A length of 0 is free, a negative one is the distance of the spheres.
#[pyfunction]
pub(crate) fn add_rods(
    target: &Bound<'_, PyAny>,
    end1: Numbers<'_>,
    end2: Numbers<'_>,
    radius: Floats<'_>,
    length: Floats<'_>,
    group: Groups<'_>,
    material: Numbers<'_>,
) -> PyResult<usize> {
    rows!(count: end1 / 1, end2 / 1, radius / 1, length / 1, group / 1, material / 1);
    with_states(target, |doors, ids| {
        let pairs = pairs(doors.objects(), ids, end1, end2)?;
        let materials = materials_of(ids, material)?;
        let held = |k: usize| {
            let held = length_or_distance(doors.objects(), pairs[k], length[k])?;
            let text =
                || format!("row {k}: length: both spheres are at the same place, expected a length, or 0 for a free rod");
            if held == 0.0 && length[k] < 0.0 { Err(PyValueError::new_err(text())) } else { Ok(held) }
        };
        let lengths: Vec<f32> = (0..count).map(held).collect::<PyResult<_>>()?;
        let rod = |k: usize| {
            let mut rod = Rod::new(pairs[k].0, pairs[k].1, radius[k]).group(group[k]);
            rod.length = (lengths[k] > 0.0).then_some(lengths[k]);
            with_material!(rod, materials[k])
        };
        add_all(doors, &mut ids.rods, (0..count).map(rod), Doors::add_rod)
    })
}

/// The muscle of a row: amplitude, frequency and phase. A row of zeros stands for none.
fn muscle(rows: &[f32], k: usize) -> Option<Muscle> {
    let [amplitude, frequency, phase] = vector(rows, k).to_array();
    (vector(rows, k) != Vec3::ZERO).then(|| Muscle::new(amplitude, frequency, phase))
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
    muscle: Rows<'_>,
) -> PyResult<usize> {
    rows!(count: a / 1, b / 1, stiffness / 1, length / 1, damping / 1, muscle / 3);
    with_states(target, |doors, ids| {
        let scene = doors.objects();
        let pairs = pairs(scene, ids, a, b)?;
        let spring = |k: usize| {
            let (a, b) = pairs[k];
            let rest = length_or_distance(scene, (a, b), length[k])?;
            let mut spring = Spring::new(a, b, stiffness[k], rest).damping(damping[k]);
            spring.muscle = self::muscle(muscle, k);
            Ok(spring)
        };
        let springs: Vec<Spring> = (0..count).map(spring).collect::<PyResult<_>>()?;
        try_springs(&springs)?;
        add_all(doors, &mut ids.springs, springs.into_iter(), Doors::add_spring)
    })
}

/// Adds springs to a scene of two spheres, so that a wrong muscle is found before the first spring is added.
fn try_springs(springs: &[Spring]) -> PyResult<()> {
    let mut scene = Scene::new();
    let [a, b] = [0.0, 1.0].map(|x| scene.add_sphere(Sphere::new([x, 0.0, 0.0], 0.1)));
    let (a, b) = (a.or_raise()?, b.or_raise()?);
    let springs = springs.iter().map(|spring| {
        let mut spring = *spring;
        (spring.a, spring.b) = (a, b);
        spring
    });
    add_all(&mut scene, &mut Vec::new(), springs, Scene::add_spring).map(drop)
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
    rows!(count: sphere / 1, point / 3, stiffness / 1, length / 1, damping / 1);
    with(target, |doors, ids| {
        let spheres = ends(&ids.spheres, sphere)?;
        spheres.iter().try_for_each(|id| doors.objects().sphere(*id).map(drop)).or_raise()?;
        let tether = |k: usize| Tether::new(spheres[k], vector(point, k), stiffness[k]).length(length[k]).damping(damping[k]);
        add_all(doors, &mut ids.tethers, (0..count).map(tether), Doors::add_tether)
    })
}

/// Adds capsules. Returns the numbers of the first capsule, the first sphere and the first rod: capsule k of this call consists
/// of spheres 2 k and 2 k + 1 and rod k after those.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub(crate) fn add_capsules(
    target: &Bound<'_, PyAny>,
    end1: Rows<'_>,
    end2: Rows<'_>,
    radius: Floats<'_>,
    mass: Floats<'_>,
    velocity: Rows<'_>,
    group: Groups<'_>,
    material: Numbers<'_>,
) -> PyResult<(usize, usize, usize)> {
    rows!(count: end1 / 3, end2 / 3, radius / 1, mass / 1, velocity / 3, group / 1, material / 1);
    let capsule = |k: usize, density: f32| {
        let capsule = Capsule::new(vector(end1, k), vector(end2, k), radius[k]);
        let capsule = if density > 0.0 { capsule.density(density) } else { capsule.mass(mass[k]) };
        capsule.velocity(vector(velocity, k)).group(group[k])
    };
    with(target, |doors, ids| {
        let materials = materials_of(ids, material)?;
        let densities = densities(doors.objects(), &materials, mass)?;
        try_all((0..count).map(|k| capsule(k, densities[k])), Doors::add_capsule)?;
        let capsule = |k: usize| with_material!(capsule(k, densities[k]), materials[k]);
        let (spheres, rods) = (ids.spheres.len(), ids.rods.len());
        let first = add_all(doors, &mut ids.capsules, (0..count).map(capsule), Doors::add_capsule)?;
        for id in &ids.capsules[first..] {
            let parts = doors.objects().capsule(*id).or_raise()?;
            ids.spheres.extend([parts.end1, parts.end2]);
            ids.rods.push(parts.rod);
        }
        Ok((first, spheres, rods))
    })
}

/// Adds boxes from corners and edges (three rows of the array `edges` per box), and returns the number of the first.
#[pyfunction]
pub(crate) fn add_boxes(
    target: &Bound<'_, PyAny>,
    corner: Rows<'_>,
    edges: Rows<'_>,
    group: Groups<'_>,
    material: Numbers<'_>,
) -> PyResult<usize> {
    rows!(count: corner / 3, edges / 9, group / 1, material / 1);
    let cuboid = |k: usize| {
        let [i, j, l] = [3 * k, 3 * k + 1, 3 * k + 2].map(|row| vector(edges, row));
        Cuboid::new(vector(corner, k), i, j, l).group(group[k])
    };
    with(target, |doors, ids| {
        let materials = materials_of(ids, material)?;
        try_all((0..count).map(cuboid), Doors::add_box)?;
        let cuboid = |k: usize| with_material!(cuboid(k), materials[k]);
        add_all(doors, &mut ids.boxes, (0..count).map(cuboid), Doors::add_box)
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
    material: Numbers<'_>,
) -> PyResult<usize> {
    rows!(count: corner / 3, left / 3, right / 3, group / 1, material / 1);
    let polygon = |k: usize| Polygon::new(vector(corner, k), vector(left, k), vector(right, k)).group(group[k]);
    with(target, |doors, ids| {
        let materials = materials_of(ids, material)?;
        try_all((0..count).map(polygon), Doors::add_polygon)?;
        let polygon = |k: usize| with_material!(polygon(k), materials[k]);
        add_all(doors, &mut ids.polygons, (0..count).map(polygon), Doors::add_polygon)
    })
}

/// Removes objects of one kind in one pass.
#[pyfunction]
pub(crate) fn remove(target: &Bound<'_, PyAny>, kind: &str, numbers: Numbers<'_>) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    with(target, |doors, ids| {
        macro_rules! all {
            ($table:ident, $remove:ident) => {{
                let handles: Vec<_> = numbers.iter().map(|id| handle(&ids.$table, kind, *id)).collect::<PyResult<_>>()?;
                doors.$remove(&handles).or_raise()
            }};
        }
        match kind {
            "sphere" => all!(spheres, remove_spheres),
            "rod" => all!(rods, remove_rods),
            "capsule" => all!(capsules, remove_capsules),
            "spring" => all!(springs, remove_springs),
            "tether" => all!(tethers, remove_tethers),
            "joint" => all!(joints, remove_joints),
            "box" => all!(boxes, remove_boxes),
            "polygon" => all!(polygons, remove_polygons),
            "body" => all!(bodies, remove_bodies),
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
        check(numbers.len() * if matches!(*name, "point" | "muscle") { 3 } else { 1 }, &[values.len()])?;
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
                        "muscle" => spring.muscle = muscle(values, k),
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
