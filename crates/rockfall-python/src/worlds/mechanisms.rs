//! Joints and rigid bodies of worlds, as arrays with room for the world that has most of them.

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;
use rockfall::glam::Vec3;
use rockfall::{JointReading, Result};

use crate::arguments::{Numbers, check, vector};
use crate::bodies::put;
use crate::joints::{numbers, set};
use crate::worlds::{Worlds, places};

/// Numbers of a joint in the table of joints, and of a body in that of bodies.
const READINGS: usize = 9;
const STATES: usize = 22;

/// Numbers of all joints, which of them are broken, and how many there are in each world.
type Joints<'py> = (Bound<'py, PyArray3<f32>>, Bound<'py, PyArray2<bool>>, Bound<'py, PyArray1<i64>>);
/// Numbers of all bodies, and how many there are in each world.
type Bodies<'py> = (Bound<'py, PyArray3<f32>>, Bound<'py, PyArray1<i64>>);
/// Fields of joints by name: a row per world, and a number per joint.
type JointFields<'py> = Vec<(String, PyReadonlyArray2<'py, f32>)>;
/// Fields of bodies by name: a row per world, and a vector or quaternion per body.
type BodyFields<'py> = Vec<(String, PyReadonlyArray3<'py, f32>)>;

/// How many rows each world has, and the largest of these numbers.
fn counts<'py, T>(py: Python<'py>, rows: &[Vec<T>], width: usize) -> (Bound<'py, PyArray1<i64>>, usize) {
    let counts: Vec<i64> = rows.iter().map(|row| (row.len() / width) as i64).collect();
    let room = counts.iter().copied().max().unwrap_or_default() as usize;
    (PyArray1::from_vec(py, counts), room)
}

/// An array of shape (worlds, room, width). Missing rows are 0.
fn table<'py>(py: Python<'py>, rows: Vec<Vec<f32>>, room: usize, width: usize) -> PyResult<Bound<'py, PyArray3<f32>>> {
    let worlds = rows.len();
    let mut all = Vec::with_capacity(worlds * room * width);
    for row in rows {
        let end = all.len() + room * width;
        all.extend(row);
        all.resize(end, 0.0);
    }
    PyArray1::from_vec(py, all).reshape([worlds, room, width])
}

/// What all joints of all worlds do: nine numbers for each, whether it is broken, and the number of joints of each world.
#[pyfunction]
pub(crate) fn world_joints<'py>(worlds: &Bound<'py, Worlds>) -> PyResult<Joints<'py>> {
    let py = worlds.py();
    let found = worlds.get().locked(py, rockfall::Worlds::all_joints)?;
    let (counts, room) = counts(py, &found, 1);
    let mut broken = Vec::with_capacity(found.len() * room);
    for joints in &found {
        let end = broken.len() + room;
        broken.extend(joints.iter().map(|joint| joint.broken));
        broken.resize(end, false);
    }
    let broken = PyArray1::from_vec(py, broken).reshape([found.len(), room])?;
    let rows = found.iter().map(|joints: &Vec<JointReading>| joints.iter().flat_map(numbers).collect()).collect();
    Ok((table(py, rows, room, READINGS)?, broken, counts))
}

/// Names of the joints of each world, in order of addition.
#[pyfunction]
pub(crate) fn world_joint_names(worlds: &Bound<'_, Worlds>) -> PyResult<Vec<Vec<Option<String>>>> {
    worlds.get().locked(worlds.py(), |worlds| {
        let names = |world| Ok(worlds.scene(world)?.joints().iter().map(|joint| joint.name.clone()).collect());
        (0..worlds.len()).map(names).collect()
    })
}

/// States of all bodies of all worlds: of each the centre, the orientation w, x, y, z, the velocity, the angular momentum and
/// the angular velocity, the external force and torque. Then the number of bodies of each world.
#[pyfunction]
pub(crate) fn world_bodies<'py>(worlds: &Bound<'py, Worlds>) -> PyResult<Bodies<'py>> {
    let py = worlds.py();
    let found = worlds.get().locked(py, |worlds| {
        worlds.sync()?;
        let row = |world| -> Result<Vec<f32>> {
            let scene = worlds.scene(world)?;
            let mut row = Vec::with_capacity(STATES * scene.bodies().len());
            for (id, body) in scene.body_ids().zip(scene.bodies()) {
                let q = body.orientation;
                row.extend(body.position.to_array());
                row.extend([q.w, q.x, q.y, q.z]);
                let motion = [body.velocity, body.angular_momentum, scene.body_spin(id)?, body.force, body.torque];
                motion.iter().for_each(|vector| row.extend(vector.to_array()));
            }
            Ok(row)
        };
        (0..worlds.len()).map(row).collect::<Result<Vec<_>>>()
    })?;
    let (counts, room) = counts(py, &found, STATES);
    Ok((table(py, found, room, STATES)?, counts))
}

/// Sets numbers of some joints of some worlds: of each field a row per world.
#[pyfunction]
pub(crate) fn set_world_joints(
    worlds: &Bound<'_, Worlds>,
    numbers: Numbers<'_>,
    joints: Numbers<'_>,
    fields: JointFields<'_>,
) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    let joints: Vec<usize> = places(joints.as_slice()?).collect();
    let fields = fields.iter().map(|(name, rows)| Ok((name.as_str(), rows.as_slice()?))).collect::<PyResult<Vec<_>>>()?;
    for (_, rows) in &fields {
        check(numbers.len() * joints.len(), &[rows.len()])?;
    }
    let mut unknown = Ok(());
    worlds.get().locked(worlds.py(), |worlds| {
        places(numbers).enumerate().try_for_each(|(row, world)| {
            worlds.update_joints(world, &joints, |place, joint| {
                for (name, rows) in &fields {
                    let done = set(joint, name, rows[row * joints.len() + place]);
                    unknown = std::mem::replace(&mut unknown, Ok(())).and(done);
                }
            })
        })
    })?;
    unknown
}

/// Moves the bodies of some worlds so that their joints have these positions and speeds, from rows with room for the joints
/// of the world that has most.
#[pyfunction]
pub(crate) fn place_world_joints(
    worlds: &Bound<'_, Worlds>,
    numbers: Numbers<'_>,
    positions: PyReadonlyArray2<'_, f32>,
    speeds: PyReadonlyArray2<'_, f32>,
) -> PyResult<()> {
    let (numbers, positions, speeds) = (numbers.as_slice()?, positions.as_slice()?, speeds.as_slice()?);
    let room = positions.len() / numbers.len().max(1);
    check(numbers.len() * room, &[positions.len(), speeds.len()])?;
    worlds.get().locked(worlds.py(), |worlds| {
        places(numbers).enumerate().try_for_each(|(row, world)| {
            let count = worlds.scene(world)?.joints().len().min(room);
            let own = row * room..row * room + count;
            worlds.place_joints(world, &positions[own.clone()], &speeds[own])
        })
    })
}

/// Sets fields of the states of some bodies of some worlds: of each field a row per world.
#[pyfunction]
pub(crate) fn set_world_bodies(
    worlds: &Bound<'_, Worlds>,
    numbers: Numbers<'_>,
    bodies: Numbers<'_>,
    fields: BodyFields<'_>,
) -> PyResult<()> {
    let numbers = numbers.as_slice()?;
    let bodies: Vec<usize> = places(bodies.as_slice()?).collect();
    let fields = fields.iter().map(|(name, rows)| Ok((name.as_str(), rows.as_slice()?))).collect::<PyResult<Vec<_>>>()?;
    let all = numbers.len() * bodies.len();
    for (name, rows) in &fields {
        check(all, &[rows.len() / if *name == "orientation" { 4 } else { 3 }])?;
    }
    let spins = fields.iter().find(|(name, _)| *name == "spin").map(|(_, rows)| *rows);
    let spins = spins.map(|rows| (0..all).map(|place| vector(rows, place)).collect::<Vec<Vec3>>());
    worlds.get().locked(worlds.py(), |worlds| {
        places(numbers).enumerate().try_for_each(|(row, world)| {
            let first = row * bodies.len();
            let spins = spins.as_ref().map(|spins| &spins[first..first + bodies.len()]);
            worlds.update_bodies(world, &bodies, spins, |place, body| {
                fields.iter().for_each(|(name, rows)| put(body, name, rows, first + place));
            })
        })
    })
}
