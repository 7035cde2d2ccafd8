//! Comma-separated values, in the fewest digits that read back bit for bit.
//!
//! A trajectory has the columns `step,time` before those of a state: `sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz`, one line a
//! sphere in order of addition; `q` is the unit quaternion of the orientation, `l` the angular momentum.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};
use std::path::Path;

use rockfall::SphereState;
use rockfall::output::{AtomicFile, Mark};

use crate::Frame;

const STATE_HEADER: &str = "sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz";

/// Writes one state with its header.
///
/// # Errors
/// What the writer says.
pub fn state(out: &mut impl Write, spheres: &[SphereState]) -> io::Result<()> {
    writeln!(out, "{STATE_HEADER}")?;
    lines(out, "", spheres)
}

fn lines(out: &mut impl Write, before: &str, spheres: &[SphereState]) -> io::Result<()> {
    for (index, sphere) in spheres.iter().enumerate() {
        let q = sphere.orientation;
        write!(out, "{before}{index}")?;
        numbers(out, &sphere.position.to_array())?;
        numbers(out, &sphere.velocity.to_array())?;
        numbers(out, &[q.w, q.x, q.y, q.z])?;
        numbers(out, &sphere.angular_momentum.to_array())?;
        writeln!(out)?;
    }
    Ok(())
}

/// Writes numbers, a comma before each, so that they read back bit for bit, in as few digits as that takes.
///
/// # Errors
/// What the writer says.
pub fn numbers<N: Copy + Display + LowerExp + Into<f64>>(out: &mut impl Write, numbers: &[N]) -> io::Result<()> {
    numbers.iter().try_for_each(|number| {
        let size = Into::<f64>::into(*number).abs();
        // Without an exponent, 1e-300 would be three hundred zeros.
        if size == 0.0 || (1e-6..1e16).contains(&size) { write!(out, ",{number}") } else { write!(out, ",{number:e}") }
    })
}

#[derive(Debug)]
pub(crate) struct Series {
    file: AtomicFile,
}

impl Series {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let mut file = AtomicFile::create(path)?;
        writeln!(file, "step,time,{STATE_HEADER}")?;
        Ok(Self { file })
    }

    pub(crate) fn resume(path: &Path, mark: Mark) -> io::Result<Self> {
        Ok(Self { file: AtomicFile::resume(path, mark)? })
    }

    pub(crate) fn frame(&mut self, frame: &Frame) -> io::Result<()> {
        let mut before = frame.step.to_string().into_bytes();
        numbers(&mut before, &[frame.time])?;
        before.push(b',');
        lines(&mut self.file, &String::from_utf8_lossy(&before), &frame.spheres)
    }

    pub(crate) fn mark(&mut self) -> io::Result<Option<Mark>> {
        self.file.mark()
    }

    pub(crate) fn finish(self) -> io::Result<()> {
        self.file.commit()
    }
}
