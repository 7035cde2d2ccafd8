//! Lines that are repeated: `@repeat` ... `@end`.
//!
//! A block is kept as text until its `@end`, and then read once for each copy. Copy k is moved on by k times the distance of the
//! block. References that the block defines count on: copy k has them k strides higher, and a stride is the range from the least to
//! the greatest of them. A block inside another one is expanded first.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use glam::{DVec3, Vec3};

use super::Reader;
use super::comment::without_comment;
use super::joint::Named;
use super::line::{Line, REPEAT, Wrong};
use crate::error::quoted;

/// Limit on the lines that all blocks of a text stand for, so that a short text cannot ask for billions of objects.
const MAX_LINES: u64 = 1_000_000;
/// Limit on the depth of blocks inside each other.
const MAX_DEPTH: usize = 8;
/// Words of lines that hold for the whole scene.
const REFUSED: [&str; 7] = ["set", "@material", "@pair", "@run", "@motion", "@servo", "@gauge"];

/// Lines between `@repeat` and `@end`.
pub(super) struct Block<'a> {
    /// Number of the line `@repeat`.
    pub(super) number: usize,
    copies: u32,
    /// Distance from one copy to the next.
    distance: DVec3,
    parts: Vec<Part<'a>>,
    /// Number of lines that the parts stand for.
    lines: u64,
    /// References that the parts define.
    defined: Rc<HashSet<u32>>,
}

enum Part<'a> {
    /// A line and its number.
    Line(&'a str, usize),
    Block(Block<'a>),
}

/// A copy of a block that is being read.
pub(super) struct Copy {
    /// Number of the copy, from 0.
    index: u32,
    offset: DVec3,
    defined: Rc<HashSet<u32>>,
    /// What is added to these references.
    shift: u32,
    /// Bodies that the copy has placed, by their names in it.
    names: HashMap<String, Named>,
}

impl<'a> Block<'a> {
    fn add(&mut self, line: &'a str, number: usize) {
        let mut words = without_comment(line).split_ascii_whitespace();
        if words.next() == Some("S")
            && let Some(reference) = words.next().and_then(|word| word.parse().ok())
        {
            Rc::make_mut(&mut self.defined).insert(reference);
        }
        self.lines += 1;
        self.parts.push(Part::Line(line, number));
    }

    fn wrong(&self, field: &str, message: String) -> (usize, Wrong) {
        (self.number, REPEAT.wrong(field, message))
    }

    /// Difference of the references of two copies.
    fn stride(&self) -> u64 {
        let ends = self.defined.iter().min().zip(self.defined.iter().max());
        ends.map_or(0, |(least, greatest)| u64::from(greatest - least) + 1)
    }

    /// Adds the references of all copies of a block inside this one.
    fn define(&mut self, inner: &Block) {
        let stride = inner.stride() as u32;
        let defined = Rc::make_mut(&mut self.defined);
        for copy in 0..inner.copies {
            defined.extend(inner.defined.iter().map(|reference| reference + copy * stride));
        }
    }

    /// Checks the numbers of lines and of references of all copies. Returns the former.
    fn check(&self, before: u64) -> Result<u64, (usize, Wrong)> {
        // An empty block takes time, too.
        let lines = self.lines.max(1).saturating_mul(self.copies.into());
        if before.saturating_add(lines) > MAX_LINES {
            let message = format!("the copies are {lines} lines, expected at most {MAX_LINES} in all blocks of a scene");
            return Err(self.wrong("N", message));
        }
        let greatest = self.defined.iter().max().copied().unwrap_or(0);
        let last = u64::from(greatest) + u64::from(self.copies - 1) * self.stride();
        if last > u32::MAX.into() {
            return Err(self.wrong("N", format!("the references count on to {last}, expected at most {}", u32::MAX)));
        }
        Ok(lines)
    }
}

impl<'a> Reader<'a> {
    /// Reads a line of the text, or keeps it for the end of its block.
    pub(super) fn next(&mut self, line: &'a str, number: usize) -> Line<()> {
        self.at = number;
        match without_comment(line).split_ascii_whitespace().next() {
            Some("@repeat") => self.begin(without_comment(line), number),
            Some("@end") if !self.open.is_empty() => self.end(line),
            Some("@body") if !self.open.is_empty() => {
                let message = "not possible between @repeat and @end, expected outside of them".to_owned();
                Err(Wrong { field: "@body".to_owned(), message })
            }
            word if !self.open.is_empty() => {
                let defined = if word == Some("@place") { self.defined_by(line) } else { None };
                if let Some(block) = self.open.last_mut() {
                    block.add(line, number);
                    Rc::make_mut(&mut block.defined).extend(defined.into_iter().flatten());
                }
                Ok(())
            }
            _ => self.line(line, number),
        }
    }

    fn begin(&mut self, line: &str, number: usize) -> Line<()> {
        let ([copies], _) = match REPEAT.read::<1, 3>(line) {
            Ok(found) => found,
            Err(wrong) => return self.not_understood(number, wrong),
        };
        if copies == 0 {
            return Err(REPEAT.wrong("N", "0 is not allowed, expected at least 1 copy"));
        }
        if self.open.len() == MAX_DEPTH {
            return Err(
                REPEAT.wrong("line", format!("more than {MAX_DEPTH} blocks inside each other, expected at most {MAX_DEPTH}"))
            );
        }
        // With the digits that f32 lacks, so that many distances add up.
        let mut numbers = line.split_ascii_whitespace().skip(2).map(|word| word.parse().unwrap_or_default());
        let distance = DVec3::from_array([(); 3].map(|()| numbers.next().unwrap_or_default()));
        self.open.push(Block { number, copies, distance, parts: Vec::new(), lines: 0, defined: Rc::default() });
        Ok(())
    }

    fn end(&mut self, line: &str) -> Line<()> {
        if let Some(more) = without_comment(line).split_ascii_whitespace().nth(1) {
            let message = format!("{} is one word too many, expected `@end`", quoted(more));
            return Err(Wrong { field: "@end".to_owned(), message });
        }
        let Some(block) = self.open.pop() else { return Ok(()) };
        let lines = block.check(self.repeated).map_err(|(number, wrong)| {
            self.at = number;
            wrong
        })?;
        match self.open.last_mut() {
            Some(outer) => {
                outer.lines = outer.lines.saturating_add(lines);
                outer.define(&block);
                outer.parts.push(Part::Block(block));
                Ok(())
            }
            None => {
                self.repeated += lines;
                self.copies(&block)
            }
        }
    }

    /// Reads all copies of a block.
    fn copies(&mut self, block: &Block<'a>) -> Line<()> {
        let stride = block.stride() as u32;
        for index in 0..block.copies {
            let (offset, names) = (f64::from(index) * block.distance, HashMap::new());
            self.copies.push(Copy { index, offset, defined: Rc::clone(&block.defined), shift: index * stride, names });
            block.parts.iter().try_for_each(|part| self.part(part))?;
            self.copies.pop();
        }
        Ok(())
    }

    fn part(&mut self, part: &Part<'a>) -> Line<()> {
        let (line, number) = match part {
            Part::Block(block) => return self.copies(block),
            Part::Line(line, number) => (*line, *number),
        };
        self.at = number;
        let word = without_comment(line).split_ascii_whitespace().next().unwrap_or_default();
        if REFUSED.contains(&word) {
            let message = "not possible between @repeat and @end, expected outside of them".to_owned();
            return Err(Wrong { field: word.to_owned(), message });
        }
        let told = (self.comments, self.warnings.len());
        self.line(line, number)?;
        if self.copies.iter().any(|copy| copy.index > 0) {
            // The first copy has said it.
            self.comments = told.0;
            self.warnings.truncate(told.1);
        }
        Ok(())
    }

    /// The reference that one in the present line stands for.
    pub(super) fn counted_on(&self, reference: u32) -> u32 {
        let on = |reference, copy: &Copy| if copy.defined.contains(&reference) { reference + copy.shift } else { reference };
        self.copies.iter().rev().fold(reference, on)
    }

    /// Numbers of the copies that the present line is part of, the outermost first.
    pub(super) fn numbers_of_copies(&self) -> impl Iterator<Item = u32> + '_ {
        self.copies.iter().map(|copy| copy.index)
    }

    /// Remembers a body that the present copy places.
    pub(super) fn name_in_copy(&mut self, name: &str, body: Named) {
        if let Some(copy) = self.copies.last_mut() {
            copy.names.entry(name.to_owned()).and_modify(|named| *named = Named::Several).or_insert(body);
        }
    }

    /// The body that a name stands for in the present copy, or in those around it.
    pub(super) fn named_in_copy(&self, name: &str) -> Option<Named> {
        self.copies.iter().rev().find_map(|copy| copy.names.get(name).copied())
    }

    /// How far the present line is moved on.
    pub(super) fn offset(&self) -> DVec3 {
        self.copies.iter().map(|copy| copy.offset).sum()
    }

    /// A point of the present line.
    pub(super) fn point(&self, numbers: &[f32]) -> Vec3 {
        let point = Vec3::from_slice(numbers);
        match self.offset() {
            DVec3::ZERO => point,
            offset => (point.as_dvec3() + offset).as_vec3(),
        }
    }

    /// Checks at the end of the text that every block has an end. Returns the wrong line.
    pub(super) fn check_blocks(&self) -> Result<(), (usize, Wrong)> {
        match self.open.first() {
            Some(block) => Err(block.wrong("line", "no `@end` below, expected one after the lines to repeat".to_owned())),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
#[path = "repeat_tests.rs"]
mod tests;
