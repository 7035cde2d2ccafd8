//! What a stage is: its kernel, bindings, threads and CPU twin.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::wgsl::{Part, Wgsl};

/// What a binding of a stage refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Always the same buffer.
    Fixed(Buffer),
    /// The stage state that pass p evaluates: `Start`, `Y2`, `Y3`, `Y4` for p = 0, 1, 2, 3.
    State,
    /// The stage state that pass p makes: `Y2`, `Y3`, `Y4` for p = 0, 1, 2.
    Next,
    /// What pass p of a sort begins with: `Y2` and `Y3` in turn.
    Unsorted,
    /// What it makes: the other one.
    Sorted,
}

impl Slot {
    /// The buffer in pass `pass`.
    pub fn buffer(self, pass: u32) -> Buffer {
        const STATES: [Buffer; 4] = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4];
        match self {
            Self::Fixed(buffer) => buffer,
            Self::State => STATES[pass as usize],
            Self::Next => STATES[pass as usize + 1],
            Self::Unsorted => STATES[1 + pass as usize % 2],
            Self::Sorted => STATES[2 - pass as usize % 2],
        }
    }
}

/// How a kernel uses a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    Write,
}

/// A storage buffer of a stage. Its number is 2 + its place in the stage's list (0 is `step`, 1 is `pass_`).
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// Its name in the WGSL.
    pub name: &'static str,
    /// Which buffer it is.
    pub slot: Slot,
    /// Read only or read and written.
    pub access: Access,
}

pub(crate) const fn read(name: &'static str, buffer: Buffer) -> Binding {
    Binding { name, slot: Slot::Fixed(buffer), access: Access::Read }
}

pub(crate) const fn write(name: &'static str, buffer: Buffer) -> Binding {
    Binding { name, slot: Slot::Fixed(buffer), access: Access::Write }
}

/// One stage of the step.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Name of the pair of files and of the kernel's entry point.
    pub name: &'static str,
    /// The kernel.
    pub wgsl: Wgsl,
    /// The storage buffers, at most 8.
    pub bindings: &'static [Binding],
    /// How many threads it has.
    pub threads: Threads,
    /// The CPU twin; the second argument is the pass.
    pub cpu: fn(&mut World, u32),
}

impl Stage {
    /// The files of the kernel: those that it requires, directly or not, each once, and its own file last.
    pub fn parts(&self) -> Vec<Part> {
        self.wgsl.parts()
    }
}
