//! The description of a stage: its kernel, bindings, threads and CPU twin.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{AFTER_DRIFT, EARLY};
use crate::model::part::Part;
use crate::model::world::World;
use crate::step::moves::Moves;
use crate::step::wgsl::Wgsl;

/// The buffer that a binding of a stage refers to, which may depend on the pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The same buffer in every pass.
    Fixed(Buffer),
    /// The stage state that pass p of RK4 evaluates: `Start`, `Y2`, `Y3`, `Y4` for p = 0, 1, 2, 3. Velocity Verlet evaluates `Y4`,
    /// in pass 3. `Start` for p = 4.
    State,
    /// The stage state that pass p of RK4 writes: `Y2`, `Y3`, `Y4` for p = 0, 1, 2.
    Next,
    /// The state that a step ends with: `Start`, `Y3` in a pass with [`EARLY`].
    Ended,
    /// The rates that a step ends with: `Rates`, `Y2` in a pass with [`EARLY`].
    EndedRates,
    /// The state in which a pass of `move_bodies` puts the spheres of rigid bodies: `Y4` for
    /// [`AFTER_DRIFT`](crate::model::layout::AFTER_DRIFT), else `Start`.
    Placed,
    /// The input of pass p of a sort: `Y2` for even p, `Y3` for odd p.
    Unsorted,
    /// The output of pass p of a sort: `Y3` for even p, `Y2` for odd p.
    Sorted,
}

impl Slot {
    /// Returns the buffer in pass `pass`.
    pub fn buffer(self, pass: u32) -> Buffer {
        const STATES: [Buffer; 5] = [Buffer::Start, Buffer::Y2, Buffer::Y3, Buffer::Y4, Buffer::Start];
        match self {
            Self::Fixed(buffer) => buffer,
            Self::State => STATES[(pass % EARLY) as usize],
            Self::Ended if pass < EARLY => Buffer::Start,
            Self::Ended => Buffer::Y3,
            Self::EndedRates if pass < EARLY => Buffer::Rates,
            Self::EndedRates => Buffer::Y2,
            Self::Next => STATES[pass as usize + 1],
            Self::Placed if pass == AFTER_DRIFT => Buffer::Y4,
            Self::Placed => Buffer::Start,
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

/// A storage buffer of a stage. Its binding number is 2 plus its index in the stage's list. Binding 0 is the uniform block
/// `step`, binding 1 the uniform block `pass_`.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// The name in the WGSL.
    pub name: &'static str,
    /// The buffer.
    pub slot: Slot,
    /// Read only, or read and written.
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
    /// The work items of the stage, which determine the number of threads.
    pub threads: Threads,
    /// The CPU twin. The second argument is the pass.
    pub cpu: fn(&mut World, u32),
    /// Returns the least amount of data that the stage must move in a pass.
    pub moves: fn(u32) -> Moves,
}

impl Stage {
    /// Returns whether both are the same stage.
    pub fn is(&self, other: &Self) -> bool {
        self.name == other.name
    }

    /// Returns the files of the kernel: all files that it requires, directly or indirectly, each once, and then its own file.
    pub fn parts(&self) -> Vec<Part> {
        self.wgsl.parts()
    }
}
