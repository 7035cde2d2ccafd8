//! Joints between bodies.

use std::collections::HashMap;

use numpy::PyArray1;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rockfall::glam::DVec3;
use rockfall::{Anchor, Joint, JointKind, JointReading};

use crate::doors::{look, with, with_states};
use crate::errors::Raise;
use crate::ids::{Ids, handle};
use crate::simulation::Simulation;

/// The kind of an end, which is `world`, `body` or `sphere`, and its number.
type End = (String, i64);
/// Anchors on both bodies and the axis.
type Place = ([f64; 3], [f64; 3], [f64; 3]);

fn anchor(ids: &Ids, (kind, number): &End) -> PyResult<Anchor> {
    match kind.as_str() {
        "world" => Ok(Anchor::World),
        "body" => Ok(Anchor::Body(handle(&ids.bodies, "body", *number)?)),
        _ => Ok(Anchor::Sphere(handle(&ids.spheres, "sphere", *number)?)),
    }
}

/// Sets a number of a joint by its name in Python.
pub(crate) fn set(joint: &mut Joint, field: &str, value: f32) -> PyResult<()> {
    let limits = |joint: &Joint| joint.limits.unwrap_or([f32::NEG_INFINITY, f32::INFINITY]);
    match field {
        "speed" => joint.speed = Some(value).filter(|speed| !speed.is_nan()),
        "max_force" => joint.max_force = value,
        "target" => joint.target = Some(value).filter(|target| !target.is_nan()),
        "stiffness" => joint.stiffness = value,
        "damping" => joint.damping = value,
        "effort" => joint.effort = value,
        "drag" => joint.drag = value,
        "armature" => joint.armature = value,
        "friction" => joint.friction = value,
        "break_force" => joint.break_force = value,
        "break_torque" => joint.break_torque = value,
        "cone" => joint.cone = Some(value).filter(|cone| !cone.is_nan()),
        "length" => joint.length = Some(value),
        "lower" => joint.limits = Some([value, limits(joint)[1]]),
        "upper" => joint.limits = Some([limits(joint)[0], value]),
        _ => return Err(PyTypeError::new_err(format!("{field}: not a number of a joint"))),
    }
    Ok(())
}

/// Adds a joint and returns its number.
#[pyfunction]
pub(crate) fn add_joint(
    target: &Bound<'_, PyAny>,
    kind: &str,
    ends: (End, End),
    place: Place,
    numbers: Vec<(String, f32)>,
    collide: bool,
    name: Option<String>,
) -> PyResult<usize> {
    let kind: JointKind = kind.parse().or_raise()?;
    let (at, to, axis) = place;
    let [at, to, axis] = [at, to, axis].map(DVec3::from_array);
    with_states(target, |doors, ids| {
        let (a, b) = (anchor(ids, &ends.0)?, anchor(ids, &ends.1)?);
        let mut joint = match kind {
            JointKind::Ball => Joint::ball(a, b, at).axis(axis),
            JointKind::Hinge => Joint::hinge(a, b, at, axis),
            JointKind::Slider => Joint::slider(a, b, at, axis),
            JointKind::Fixed => Joint::fixed(a, b, at),
            JointKind::Distance => Joint::distance(a, b, at, to),
            _ => return Err(PyValueError::new_err(format!("kind: {kind} is not known here"))),
        };
        for (field, value) in &numbers {
            set(&mut joint, field, *value)?;
        }
        (joint.collides, joint.name) = (collide, name);
        ids.joints.push(doors.add_joint(joint).or_raise()?);
        Ok(ids.joints.len() - 1)
    })
}

/// Sets numbers of joints: of each field a number for each joint.
#[pyfunction]
pub(crate) fn set_joints(target: &Bound<'_, PyAny>, joints: Vec<i64>, fields: Vec<(String, Vec<f32>)>) -> PyResult<()> {
    with(target, |doors, ids| {
        for (row, number) in joints.iter().enumerate() {
            let id = handle(&ids.joints, "joint", *number)?;
            let mut joint = doors.objects().joint(id).or_raise()?.clone();
            for (field, values) in &fields {
                set(&mut joint, field, values[row])?;
            }
            doors.update_joint(id, &|own| *own = joint.clone()).or_raise()?;
        }
        Ok(())
    })
}

/// Numbers and names of all joints, in order of addition.
#[pyfunction]
pub(crate) fn joint_names(target: &Bound<'_, PyAny>) -> PyResult<Vec<(usize, Option<String>)>> {
    look(target, |scene, ids| {
        let numbers: HashMap<_, _> = ids.joints.iter().zip(0_usize..).collect();
        let number = |id| numbers.get(&id).copied().unwrap_or_default();
        Ok(scene.joint_ids().zip(scene.joints()).map(|(id, joint)| (number(id), joint.name.clone())).collect())
    })
}

/// Position, speed, error, force and torque of a joint.
pub(crate) fn numbers(reading: &JointReading) -> [f32; 9] {
    let ([a, b, c], [d, e, f]) = (reading.force.to_array(), reading.torque.to_array());
    [reading.position, reading.speed, reading.error, a, b, c, d, e, f]
}

/// What all joints do: nine numbers and whether it is broken, for each.
#[pyfunction]
pub(crate) fn joint_readings<'py>(target: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyArray1<f32>>, Vec<bool>)> {
    let simulation = target.cast::<Simulation>().map_err(|_| PyTypeError::new_err("target: expected a Simulation"))?;
    let readings = simulation.get().read(target.py(), |running| running.simulation.joints().or_raise())?;
    let broken = readings.iter().map(|reading| reading.broken).collect();
    Ok((PyArray1::from_vec(target.py(), readings.iter().flat_map(numbers).collect()), broken))
}
