//! Comma-separated values. Numbers have the fewest digits from which they are read back bitwise identical.
//!
//! A state has one line per sphere in insertion order, with the columns `sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz,reference`.
//! `q` is the unit quaternion of the orientation, `l` the angular momentum, `reference` the number of the sphere in the scene
//! file, empty for a sphere of a capsule line and for one that a program has added. A trajectory has the columns `step,time` before these.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};

use rockfall::Simulation;
use rockfall::glam::{Quat, Vec3};

use crate::Frame;

/// First line of a trajectory.
pub(crate) const HEADER: &str = "step,time,sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz,reference";

/// Writes one state with its header.
///
/// # Errors
/// Returns the error of the writer.
pub fn state(out: &mut impl Write, frame: &Frame) -> io::Result<()> {
    writeln!(out, "{}", HEADER.trim_start_matches("step,time,"))?;
    lines(out, "", frame)
}

fn lines(out: &mut impl Write, prefix: &str, frame: &Frame) -> io::Result<()> {
    for (index, (sphere, reference)) in frame.spheres.iter().zip(&frame.references).enumerate() {
        let q = sphere.orientation;
        write!(out, "{prefix}{index}")?;
        numbers(out, &sphere.position.to_array())?;
        numbers(out, &sphere.velocity.to_array())?;
        numbers(out, &[q.w, q.x, q.y, q.z])?;
        numbers(out, &sphere.angular_momentum.to_array())?;
        writeln!(out, ",{}", reference.map_or(String::new(), |reference| reference.to_string()))?;
    }
    Ok(())
}

/// First line of a file of rigid bodies and moving walls.
pub const BODIES: &str = "body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz";

/// Writes a line for each body of a simulation with the columns of [`BODIES`]. `prefix` begins each line, for example with the step and
/// the time. The state is that of the last read ([`Simulation::sync`]).
///
/// First come the rigid bodies in order of addition: index, name, centre of mass, its velocity, orientation, and angular momentum about
/// the centre. The motions of walls follow, also in order of addition, and indices count on: name, a point of the body, its velocity, the
/// turn since the walls were where they are written, and the angular velocity in place of the angular momentum
/// ([`rockfall::MotionState`]).
///
/// # Errors
/// Returns the error of the writer.
pub fn bodies(out: &mut impl Write, prefix: &str, simulation: &Simulation) -> io::Result<()> {
    let scene = simulation.scene();
    for (index, (id, body)) in scene.body_ids().zip(scene.bodies()).enumerate() {
        let tag = scene.tag(id).map_err(io::Error::other)?;
        write!(out, "{prefix}{index},{}", tag.and_then(|tag| tag.name.as_deref()).unwrap_or_default())?;
        pose(out, [body.position, body.velocity, body.angular_momentum], body.orientation)?;
    }
    let first = scene.counts().bodies;
    for (index, (motion, state)) in scene.motions().iter().zip(simulation.motion_states()).enumerate() {
        write!(out, "{prefix}{},{}", first + index, motion.name)?;
        let vectors = [state.position, state.velocity, state.angular_velocity].map(|vector| vector.as_vec3());
        pose(out, vectors, state.orientation.as_quat())?;
    }
    Ok(())
}

/// Ends a line of a body with its position, velocity, orientation, and angular momentum or velocity.
fn pose(out: &mut impl Write, [position, velocity, angular]: [Vec3; 3], q: Quat) -> io::Result<()> {
    numbers(out, &position.to_array())?;
    numbers(out, &velocity.to_array())?;
    numbers(out, &[q.w, q.x, q.y, q.z])?;
    numbers(out, &angular.to_array())?;
    writeln!(out)
}

/// Writes numbers with a comma before each. They have the fewest digits from which they are read back bitwise identical.
///
/// # Errors
/// Returns the error of the writer.
pub fn numbers<N: Copy + Display + LowerExp + Into<f64>>(out: &mut impl Write, numbers: &[N]) -> io::Result<()> {
    numbers.iter().try_for_each(|number| {
        let size = Into::<f64>::into(*number).abs();
        // Very small and very large numbers have an exponent, because they would be hundreds of digits long without one.
        if size == 0.0 || (1e-6..1e16).contains(&size) { write!(out, ",{number}") } else { write!(out, ",{number:e}") }
    })
}

/// Writes one state of a trajectory.
pub(crate) fn frame(out: &mut impl Write, frame: &Frame) -> io::Result<()> {
    let mut prefix = frame.step.to_string().into_bytes();
    numbers(&mut prefix, &[frame.time])?;
    prefix.push(b',');
    lines(out, &String::from_utf8_lossy(&prefix), frame)
}
