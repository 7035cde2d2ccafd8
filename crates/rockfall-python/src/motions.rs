//! Motions, which boxes and polygons follow.

use pyo3::exceptions::{PyLookupError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{Motion, MotionId, MotionTerm, Servo, Sought};

use crate::doors::{look, with, with_states};
use crate::errors::Raise;
use crate::names::object;
use crate::simulation::Simulation;

/// The numbers of a term: velocity, amplitude, axis and a point of the axis with three numbers each, then spin, frequency, phase, start
/// and end.
type Numbers = [f64; 17];

fn term(numbers: Numbers) -> MotionTerm {
    let vector = |place: usize| DVec3::from_slice(&numbers[place..]);
    let [spin, frequency, phase, from, to] = [12, 13, 14, 15, 16].map(|place| numbers[place]);
    let mut term = MotionTerm::translation(vector(0)).phase(phase).during(from, to);
    (term.amplitude, term.axis, term.through) = (vector(3), vector(6), vector(9));
    (term.spin, term.frequency) = (spin, frequency);
    term
}

pub(crate) fn find(scene: &rockfall::Scene, name: &str) -> PyResult<MotionId> {
    let known = || scene.motions().iter().map(|motion| motion.name.as_str()).collect::<Vec<_>>().join(", ");
    let expected =
        || if scene.motions().is_empty() { "this scene has none".to_owned() } else { format!("expected one of {}", known()) };
    scene.find_motion(name).ok_or_else(|| PyLookupError::new_err(format!("motion: {name:?} is unknown, {}", expected())))
}

/// Adds a term to the motion of a name, which is new or known.
#[pyfunction]
pub(crate) fn add_motion(target: &Bound<'_, PyAny>, name: &str, numbers: Numbers) -> PyResult<()> {
    with(target, |doors, _| match doors.objects().find_motion(name) {
        Some(known) => doors.update_motion(known, &|motion| motion.terms.push(term(numbers))).or_raise(),
        None => doors.add_motion(Motion::new(name, term(numbers))).map(drop).or_raise(),
    })
}

/// Names and terms of all motions.
#[pyfunction]
pub(crate) fn motions(target: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Vec<Numbers>)>> {
    let numbers = |term: &MotionTerm| {
        let vectors = [term.velocity, term.amplitude, term.axis, term.through].into_iter().flat_map(|vector| vector.to_array());
        let all: Vec<f64> = vectors.chain([term.spin, term.frequency, term.phase, term.from, term.to]).collect();
        std::array::from_fn(|place| all[place])
    };
    look(target, |scene, _| {
        let row = |motion: &Motion| (motion.name.clone(), motion.terms.iter().map(numbers).collect());
        Ok(scene.motions().iter().map(row).collect())
    })
}

/// A torque, the direction of its axis, and a point of the axis.
type Torque = (f64, [f64; 3], [f64; 3]);

fn sought(force: Option<[f64; 3]>, torque: Option<Torque>) -> PyResult<Sought> {
    match (force, torque) {
        (Some(force), None) => Ok(Servo::force(force, 1.0).seeks),
        (None, Some((torque, axis, through))) => Ok(Servo::torque(torque, axis, through, 1.0).seeks),
        _ => Err(PyTypeError::new_err("force, torque: expected one of them")),
    }
}

/// Adds a motion that seeks a force or a torque.
#[pyfunction]
pub(crate) fn add_servo(
    target: &Bound<'_, PyAny>,
    name: &str,
    force: Option<[f64; 3]>,
    torque: Option<Torque>,
    speed: f64,
) -> PyResult<()> {
    let mut servo = Servo::force(DVec3::Z, speed);
    servo.seeks = sought(force, torque)?;
    with(target, |doors, _| doors.add_motion(Motion::servo(name, servo)).map(drop).or_raise())
}

/// Changes what a servo seeks, or its greatest speed.
#[pyfunction]
pub(crate) fn set_servo(target: &Bound<'_, PyAny>, name: &str, target_value: Option<f64>, speed: Option<f64>) -> PyResult<()> {
    with_states(target, |doors, _| {
        let id = find(doors.objects(), name)?;
        let known = doors.objects().motion(id).or_raise()?.servo;
        let Some(mut servo) = known else {
            return Err(PyLookupError::new_err(format!("servo: the motion {name:?} has no servo")));
        };
        if let Some(value) = target_value {
            servo.seeks = match servo.seeks {
                Sought::Torque { axis, through, .. } => Sought::Torque { torque: value, axis, through },
                _ if value > 0.0 => Sought::Force(value * servo.direction()),
                _ => return Err(PyValueError::new_err(format!("target: {value} is not allowed, expected a force above 0"))),
            };
        }
        servo.speed = speed.unwrap_or(servo.speed);
        servo.velocity = servo.velocity.clamp(-servo.speed.abs(), servo.speed.abs());
        doors.update_motion(id, &|motion| motion.servo = Some(servo)).or_raise()
    })
}

/// The name of a servo, then its target, greatest speed, displacement and velocity, its direction, and whether it turns.
type ServoRow = (String, [f64; 4], [f64; 3], bool);

/// All servos.
#[pyfunction]
pub(crate) fn servos(target: &Bound<'_, PyAny>) -> PyResult<Vec<ServoRow>> {
    with_states(target, |doors, _| {
        let row = |motion: &Motion| {
            let servo = motion.servo?;
            let numbers = [servo.target(), servo.speed, servo.displacement, servo.velocity];
            let turns = matches!(servo.seeks, Sought::Torque { .. });
            Some((motion.name.clone(), numbers, servo.direction().to_array(), turns))
        };
        Ok(doors.objects().motions().iter().filter_map(row).collect())
    })
}

/// Lets objects follow a motion, or none.
#[pyfunction]
pub(crate) fn follow(target: &Bound<'_, PyAny>, kind: &str, numbers: Vec<i64>, motion: Option<&str>) -> PyResult<()> {
    with(target, |doors, ids| {
        let motion = motion.map(|name| find(doors.objects(), name)).transpose()?;
        let objects = numbers.iter().map(|number| object(ids, kind, *number)).collect::<PyResult<Vec<_>>>()?;
        objects.into_iter().try_for_each(|id| doors.set_motion(id, motion).or_raise())
    })
}

/// Sets the velocity of the surfaces of objects.
#[pyfunction]
pub(crate) fn set_surface_velocity(
    target: &Bound<'_, PyAny>,
    kind: &str,
    numbers: Vec<i64>,
    velocity: [f32; 3],
) -> PyResult<()> {
    with(target, |doors, ids| {
        let objects = numbers.iter().map(|number| object(ids, kind, *number)).collect::<PyResult<Vec<_>>>()?;
        objects.into_iter().try_for_each(|id| doors.set_surface_velocity(id, Vec3::from_array(velocity)).or_raise())
    })
}

/// Force, torque and number of contacts of a wall.
#[pyfunction]
pub(crate) fn wall_load(target: &Bound<'_, PyAny>, name: &str) -> PyResult<([f64; 3], [f64; 3], u64)> {
    let simulation = target.cast::<Simulation>().map_err(|_| PyTypeError::new_err("target: expected a Simulation"))?;
    simulation.get().read(target.py(), |running| {
        let load = running.simulation.wall_load(name).or_raise()?;
        Ok((load.force.to_array(), load.torque.to_array(), load.contacts))
    })
}

/// Replaces a motion of a simulation from now on, without a jump.
#[pyfunction]
pub(crate) fn go_on(target: &Bound<'_, PyAny>, name: &str, numbers: Numbers) -> PyResult<()> {
    let simulation = target.cast::<Simulation>().map_err(|_| PyTypeError::new_err("target: expected a Simulation"))?;
    simulation.get().edit(target.py(), |running| {
        let motion = find(running.simulation.scene(), name)?;
        running.simulation.go_on(motion, term(numbers)).or_raise()
    })
}
