//! Evaluates a law on the CPU: a list of operations on registers.

use std::cell::RefCell;

/// Four lanes of 32 bits: a scalar uses the first one. The operations know whether a lane is a float, an integer or a flag.
pub(super) type Register = [u32; 4];

/// Number of a register.
pub(super) type Slot = usize;

/// One operation. It writes its first register.
#[derive(Clone, Debug)]
pub(super) enum Op {
    /// Applies a function to each of the lanes.
    Lanes1(Slot, fn(u32) -> u32, [Slot; 1], usize),
    Lanes2(Slot, fn(u32, u32) -> u32, [Slot; 2], usize),
    Lanes3(Slot, fn(u32, u32, u32) -> u32, [Slot; 3], usize),
    /// Applies a function to whole vectors. Lanes that they do not have are ignored.
    Vectors(Slot, fn([Register; 2], usize) -> Register, [Slot; 2], usize),
    /// Gathers lanes of registers.
    Gather(Slot, Vec<(Slot, usize)>),
    /// Copies the first lane to a lane of a variable.
    StoreLane(Slot, usize, Slot),
    /// Continues at an operation.
    Jump(usize),
    /// Continues at an operation if a flag is not set.
    JumpUnless(Slot, usize),
}

/// A compiled law.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    pub(super) ops: Vec<Op>,
    /// Line of the text that each operation belongs to, and whether it results in floats.
    pub(super) lines: Vec<(usize, bool)>,
    /// The registers at the start: constants and zeros.
    pub(super) start: Vec<Register>,
    /// The registers of the inputs and then of the parameters.
    pub(super) arguments: Vec<Slot>,
    /// The registers of the results.
    pub(super) results: Vec<Slot>,
}

thread_local! {
    static REGISTERS: RefCell<Vec<Register>> = const { RefCell::new(Vec::new()) };
}

impl Program {
    /// Computes the results for the values of the inputs and parameters.
    pub(super) fn run<const N: usize>(&self, arguments: impl Iterator<Item = [f32; 4]>) -> [[f32; 3]; N] {
        REGISTERS.with_borrow_mut(|registers| {
            self.execute(registers, arguments, |_, _| true);
            std::array::from_fn(|place| {
                let [x, y, z, _] = registers[self.results[place]].map(f32::from_bits);
                [x, y, z]
            })
        })
    }

    /// Returns the line that first results in a number that is not finite.
    pub(super) fn first_not_finite(&self, arguments: impl Iterator<Item = [f32; 4]>) -> Option<usize> {
        let mut found = None;
        REGISTERS.with_borrow_mut(|registers| {
            self.execute(registers, arguments, |op, registers| {
                let (line, is_float) = self.lines[op];
                let slot = match &self.ops[op] {
                    Op::Lanes1(to, ..) | Op::Lanes2(to, ..) | Op::Lanes3(to, ..) | Op::Vectors(to, ..) => *to,
                    _ => return true,
                };
                let is_finite = !is_float || registers[slot].iter().all(|lane| f32::from_bits(*lane).is_finite());
                if !is_finite {
                    found = Some(line);
                }
                is_finite
            });
        });
        found
    }

    /// Runs the operations until the end, or until `goes_on` is false after one of them.
    fn execute(
        &self,
        registers: &mut Vec<Register>,
        arguments: impl Iterator<Item = [f32; 4]>,
        mut goes_on: impl FnMut(usize, &[Register]) -> bool,
    ) {
        registers.clear();
        registers.extend_from_slice(&self.start);
        for (slot, argument) in self.arguments.iter().zip(arguments) {
            registers[*slot] = argument.map(f32::to_bits);
        }
        let mut at = 0;
        while let Some(op) = self.ops.get(at) {
            let this = at;
            at += 1;
            match op {
                Op::Lanes1(to, apply, [a], lanes) => {
                    (0..*lanes).for_each(|k| registers[*to][k] = apply(registers[*a][k]));
                }
                Op::Lanes2(to, apply, [a, b], lanes) => {
                    (0..*lanes).for_each(|k| registers[*to][k] = apply(registers[*a][k], registers[*b][k]));
                }
                Op::Lanes3(to, apply, [a, b, c], lanes) => {
                    (0..*lanes).for_each(|k| registers[*to][k] = apply(registers[*a][k], registers[*b][k], registers[*c][k]));
                }
                Op::Vectors(to, apply, [a, b], lanes) => registers[*to] = apply([registers[*a], registers[*b]], *lanes),
                Op::Gather(to, from) => {
                    let mut lanes = [0; 4];
                    lanes.iter_mut().zip(from).for_each(|(lane, (slot, k))| *lane = registers[*slot][*k]);
                    registers[*to] = lanes;
                }
                Op::StoreLane(to, lane, from) => registers[*to][*lane] = registers[*from][0],
                Op::Jump(target) => at = *target,
                Op::JumpUnless(flag, target) => {
                    if registers[*flag][0] == 0 {
                        at = *target;
                    }
                }
            }
            if !goes_on(this, registers) {
                return;
            }
        }
    }
}
