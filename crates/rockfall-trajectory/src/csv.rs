//! Comma-separated values. Numbers have the fewest digits from which they are read back bitwise identical.
//!
//! A state has one line per sphere in insertion order, with the columns `sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz,reference`.
//! `q` is the unit quaternion of the orientation, `l` the angular momentum, `reference` the number of the sphere in the scene
//! file, empty for a sphere of a capsule line and for one that a program has added. A trajectory has the columns `step,time` before these.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};

use rockfall::Scene;

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

/// First line of a file of rigid bodies.
pub const BODIES: &str = "body,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz";

/// Writes a line for each rigid body of a scene, in order of addition, with the columns of [`BODIES`]: index, name, centre of mass, its
/// velocity, orientation, and angular momentum about the centre. `prefix` begins each line, for example with the step and the time. The
/// state is that of the last read ([`Simulation::sync`](rockfall::Simulation::sync)).
///
/// # Errors
/// Returns the error of the writer.
pub fn bodies(out: &mut impl Write, prefix: &str, scene: &Scene) -> io::Result<()> {
    for (index, (id, body)) in scene.body_ids().zip(scene.bodies()).enumerate() {
        let tag = scene.tag(id).map_err(io::Error::other)?;
        let q = body.orientation;
        write!(out, "{prefix}{index},{}", tag.and_then(|tag| tag.name.as_deref()).unwrap_or_default())?;
        numbers(out, &body.position.to_array())?;
        numbers(out, &body.velocity.to_array())?;
        numbers(out, &[q.w, q.x, q.y, q.z])?;
        numbers(out, &body.angular_momentum.to_array())?;
        writeln!(out)?;
    }
    Ok(())
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
