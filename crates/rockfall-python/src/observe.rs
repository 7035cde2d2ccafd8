//! Contacts, diagnostics, energies, ray casts and tables of objects.

use std::collections::HashMap;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::Vec3;
use rockfall::{Body, Contact, ContactAction, Link, Result, Scene, SphereId, Spring, Tension};

use crate::arguments::{Rows, vector};
use crate::doors::look;
use crate::errors::Raise;
use crate::materials::number_of;
use crate::simulation::Simulation;
use crate::tables::Energy;

type Column<'py, T> = Bound<'py, PyArray1<T>>;
pub(crate) type Matrix<'py, T> = Bound<'py, PyArray2<T>>;
/// Whole numbers and others, a row for each contact, spring or tether.
pub(crate) type ContactArrays<'py> = (Matrix<'py, i64>, Matrix<'py, f32>);

/// An array with `columns` numbers per row.
pub(crate) fn matrix<T: numpy::Element>(py: Python<'_>, numbers: Vec<T>, columns: usize) -> PyResult<Matrix<'_, T>> {
    let rows = numbers.len() / columns;
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// Number of a kind of body in tables: its position in the list of kinds of the Python layer.
fn kind(body: Body) -> i64 {
    match body {
        Body::Sphere(_) => 0,
        Body::Rod(_) => 1,
        Body::Box(_) => 2,
        _ => 3,
    }
}

/// The tables of contacts: see [`contacts`].
pub(crate) fn contact_rows(found: Vec<Contact>, scene: &Scene) -> Result<(Vec<i64>, Vec<f32>)> {
    let (mut whole, mut real) = (Vec::with_capacity(6 * found.len()), Vec::with_capacity(20 * found.len()));
    for contact in found {
        let (is_impulse, action) = match contact.action {
            ContactAction::Impulse(impulse) => (1, impulse),
            ContactAction::Force(force) => (0, force),
            _ => (0, Vec3::ZERO),
        };
        for body in [contact.a, contact.b] {
            whole.extend([kind(body), body.index(scene)? as i64]);
        }
        whole.push(is_impulse);
        [contact.point, contact.normal, action].iter().for_each(|vector| real.extend(vector.to_array()));
        real.extend([contact.overlap, contact.normal_force()]);
        real.extend(contact.tangential_force().to_array());
        let springs = contact.springs.map_or([Vec3::ZERO; 2], |springs| [springs.displacement, springs.moment]);
        springs.iter().for_each(|vector| real.extend(vector.to_array()));
        whole.push(contact.springs.map_or(-1, |springs| i64::from(springs.slips)));
    }
    Ok((whole, real))
}

/// The arrays of these tables.
pub(crate) fn contact_arrays(py: Python<'_>, whole: Vec<i64>, real: Vec<f32>) -> PyResult<ContactArrays<'_>> {
    Ok((matrix(py, whole, 6)?, matrix(py, real, 20)?))
}

/// All contacts. Whole numbers: kind and index of A, kind and index of B, whether the action is an impulse, and whether the contact
/// slips (-1 without springs). Others: point, normal, action, overlap, normal force, tangential force, displacement and moment.
#[pyfunction]
pub(crate) fn contacts<'py>(simulation: &Bound<'py, Simulation>) -> PyResult<ContactArrays<'py>> {
    let (whole, real) = simulation.get().read(simulation.py(), |running| {
        let found = running.simulation.contacts().or_raise()?;
        contact_rows(found, running.simulation.scene()).or_raise()
    })?;
    contact_arrays(simulation.py(), whole, real)
}

/// The tables of springs, muscles and tethers: see [`tensions`].
fn tension_rows(found: &[Tension], scene: &Scene) -> Result<(Vec<i64>, Vec<f32>)> {
    let springs = scene.springs().len();
    let number = |id: SphereId| Body::Sphere(id).index(scene).map(|index| index as i64);
    let (mut whole, mut real) = (Vec::with_capacity(4 * found.len()), Vec::with_capacity(2 * found.len()));
    for (place, tension) in found.iter().enumerate() {
        let (kind, index) = match tension.link {
            Link::Spring(id) => (i64::from(scene.spring(id)?.muscle.is_some()), place),
            _ => (2, place - springs),
        };
        whole.extend([kind, index as i64, number(tension.a)?, tension.b.map(number).transpose()?.unwrap_or(-1)]);
        real.extend([tension.length, tension.force]);
    }
    Ok((whole, real))
}

/// All springs and then all tethers. Whole numbers: kind (0 spring, 1 muscle, 2 tether), row among springs or tethers, and rows of
/// the spheres A and B (-1 for a tether). Others: length and tension.
#[pyfunction]
pub(crate) fn tensions<'py>(simulation: &Bound<'py, Simulation>) -> PyResult<ContactArrays<'py>> {
    let py = simulation.py();
    let (whole, real) = simulation.get().read(py, |running| {
        let found = running.simulation.tensions().or_raise()?;
        tension_rows(&found, running.simulation.scene()).or_raise()
    })?;
    Ok((matrix(py, whole, 4)?, matrix(py, real, 2)?))
}

/// Number of contacts, net force and deepest overlap of every sphere.
#[pyfunction]
pub(crate) fn diagnostics<'py>(
    simulation: &Bound<'py, Simulation>,
) -> PyResult<(Column<'py, u32>, Matrix<'py, f32>, Column<'py, f32>)> {
    let py = simulation.py();
    let found = simulation.get().read(py, |running| running.simulation.diagnostics().or_raise())?;
    let contacts = found.iter().map(|sphere| sphere.contacts).collect();
    let forces = found.iter().flat_map(|sphere| sphere.net_force.to_array()).collect();
    let overlaps = found.iter().map(|sphere| sphere.deepest_overlap).collect();
    Ok((PyArray1::from_vec(py, contacts), matrix(py, forces, 3)?, PyArray1::from_vec(py, overlaps)))
}

/// Energies and momenta.
#[pyfunction]
pub(crate) fn energy(simulation: &Bound<'_, Simulation>) -> PyResult<Energy> {
    simulation.get().read(simulation.py(), |running| running.simulation.energy().map(Energy::from).or_raise())
}

/// A kind of body and its index.
type Named = (&'static str, usize);

/// The deepest overlap in units, that in radii, and the two bodies of the latter.
#[pyfunction]
pub(crate) fn max_overlap(simulation: &Bound<'_, Simulation>, resting: bool) -> PyResult<(f32, f32, Option<[Named; 2]>)> {
    simulation.get().read(simulation.py(), |running| {
        let own = &mut running.simulation;
        let found = if resting { own.resting_overlap() } else { own.max_overlap() }.or_raise()?;
        let name = |body: Body| PyResult::Ok((body.kind(), body.index(own.scene()).or_raise()?));
        let bodies = found.bodies.map(|[a, b]| PyResult::Ok([name(a)?, name(b)?])).transpose()?;
        Ok((found.units, found.radii, bodies))
    })
}

/// The first body that each ray enters: kind and index (-1 without one), and distance, point and normal.
#[pyfunction]
pub(crate) fn cast_rays<'py>(
    simulation: &Bound<'py, Simulation>,
    origins: Rows<'_>,
    directions: Rows<'_>,
) -> PyResult<(Matrix<'py, i64>, Matrix<'py, f32>)> {
    let (origins, directions) = (origins.as_slice()?, directions.as_slice()?);
    if origins.len() != directions.len() {
        return Err(PyValueError::new_err("expected as many directions as origins"));
    }
    let (whole, real) = simulation.get().read(simulation.py(), |running| {
        let (mut whole, mut real) = (Vec::new(), Vec::new());
        for row in 0..origins.len() / 3 {
            let [origin, direction] = [origins, directions].map(|rows| vector(rows, row));
            match running.simulation.cast_ray(origin, direction).or_raise()? {
                Some(hit) => {
                    whole.extend([kind(hit.body), hit.body.index(running.simulation.scene()).or_raise()? as i64]);
                    real.push(hit.distance);
                    [hit.point, hit.normal].iter().for_each(|vector| real.extend(vector.to_array()));
                }
                None => {
                    whole.extend([-1, -1]);
                    real.push(f32::INFINITY);
                    real.extend([f32::NAN; 6]);
                }
            }
        }
        Ok((whole, real))
    })?;
    Ok((matrix(simulation.py(), whole, 2)?, matrix(simulation.py(), real, 7)?))
}

/// Amplitude, frequency and phase of the muscle of a spring; zeros without one.
fn muscle(spring: &Spring) -> [f32; 3] {
    spring.muscle.map_or([0.0; 3], |muscle| [muscle.amplitude, muscle.frequency, muscle.phase])
}

/// A table of objects of one kind, in order of addition: whole numbers (the number of the object, spheres by index, the group),
/// then real numbers.
#[pyfunction]
pub(crate) fn table<'py>(target: &Bound<'py, PyAny>, kind: &str) -> PyResult<(Matrix<'py, i64>, Matrix<'py, f32>)> {
    let (whole, real, widths) = look(target, |scene, ids| {
        let places: HashMap<SphereId, i64> = match kind {
            "sphere" | "box" | "polygon" => HashMap::new(),
            _ => scene.sphere_ids().zip(0..).collect(),
        };
        let place = |id: SphereId| places.get(&id).copied().unwrap_or(-1);
        let (mut whole, mut real): (Vec<i64>, Vec<f32>) = (Vec::new(), Vec::new());
        macro_rules! rows {
            ($objects:ident, $handles:ident, $ids:ident, $object:ident, [$($whole:expr),*], [$($real:expr),*]) => {{
                // Objects are in the order of their numbers, so both lists are walked once.
                let mut numbers = ids.$ids.iter().zip(0_i64..);
                for ($object, handle) in scene.$objects().iter().zip(scene.$handles()) {
                    let number = numbers.find(|(id, _)| **id == handle).map_or(-1, |(_, number)| number);
                    whole.extend([number, $($whole),*]);
                    $(real.extend($real);)*
                }
            }};
        }
        let widths = match kind {
            "sphere" => {
                rows!(
                    spheres,
                    sphere_ids,
                    spheres,
                    o,
                    [i64::from(o.fixed), i64::from(o.group), number_of(ids, o.material)],
                    [[o.radius, o.mass]]
                );
                (4, 2)
            }
            "rod" => {
                rows!(
                    rods,
                    rod_ids,
                    rods,
                    o,
                    [place(o.end1), place(o.end2), i64::from(o.group), number_of(ids, o.material)],
                    [[o.radius, o.length.unwrap_or(0.0)]]
                );
                (5, 2)
            }
            "capsule" => {
                rows!(capsules, capsule_ids, capsules, o, [place(o.end1), place(o.end2)], []);
                (3, 1)
            }
            "spring" => {
                rows!(
                    springs,
                    spring_ids,
                    springs,
                    o,
                    [place(o.a), place(o.b)],
                    [[o.stiffness, o.length, o.damping], muscle(o)]
                );
                (3, 6)
            }
            "tether" => {
                rows!(
                    tethers,
                    tether_ids,
                    tethers,
                    o,
                    [place(o.sphere)],
                    [o.point.to_array(), [o.stiffness, o.length, o.damping]]
                );
                (2, 6)
            }
            "box" => {
                rows!(
                    boxes,
                    box_ids,
                    boxes,
                    o,
                    [i64::from(o.group), number_of(ids, o.material)],
                    [o.corner.to_array(), o.edges[0].to_array(), o.edges[1].to_array(), o.edges[2].to_array()]
                );
                (3, 12)
            }
            "polygon" => {
                rows!(
                    polygons,
                    polygon_ids,
                    polygons,
                    o,
                    [i64::from(o.is_triangle()), i64::from(o.surface.number()), i64::from(o.group), number_of(ids, o.material)],
                    [o.corner.to_array(), o.left.to_array(), o.right.to_array()]
                );
                (5, 9)
            }
            _ => return Err(PyValueError::new_err(format!("kind: {kind} is not a kind of object"))),
        };
        Ok((whole, real, widths))
    })?;
    Ok((matrix(target.py(), whole, widths.0)?, matrix(target.py(), real, widths.1)?))
}

/// Number of objects of each kind, in the order of the kinds of the Python layer.
#[pyfunction]
pub(crate) fn counts(target: &Bound<'_, PyAny>) -> PyResult<[usize; 10]> {
    look(target, |scene: &Scene, _| {
        let counts = scene.counts();
        let movable = [counts.spheres, counts.rods, counts.capsules, counts.springs, counts.tethers];
        let [spheres, rods, capsules, springs, tethers] = movable;
        let others = [counts.boxes, counts.polygons, counts.bodies, counts.hulls, counts.joints];
        let [boxes, polygons, bodies, hulls, joints] = others;
        Ok([spheres, rods, capsules, springs, tethers, boxes, polygons, bodies, hulls, joints])
    })
}
