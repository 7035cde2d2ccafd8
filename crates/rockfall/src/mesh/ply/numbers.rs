//! The numbers after the header of a PLY file.

use super::super::source::{Read, Words, Wrong, coordinate, wrong_byte};
use super::header::Scalar;
use crate::error::{MeshPlace, quoted};

/// Reads numbers one by one.
pub(super) enum Numbers<'a> {
    /// From the words of a text.
    Text(Words<'a>),
    /// From the bytes of a binary file.
    Binary {
        /// The whole file.
        file: &'a [u8],
        /// Offset of the last number.
        at: usize,
        /// Offset of the next number.
        next: usize,
        /// Whether the highest byte of a number comes first.
        is_big: bool,
    },
}

impl Numbers<'_> {
    /// A finite coordinate, rounded to `f32` once.
    pub(super) fn coordinate(&mut self, scalar: Scalar, axis: &str) -> Read<f32> {
        if let Self::Text(words) = self {
            let word = words.expect("a coordinate")?;
            return coordinate(word, axis, words.line);
        }
        let number = self.binary(scalar, "a coordinate")?;
        let rounded = number as f32;
        if !rounded.is_finite() {
            let message = format!("{axis} of a vertex: {number} is not finite (in f32), expected a finite number");
            return Err(self.wrong(message));
        }
        Ok(rounded)
    }

    /// A whole number.
    pub(super) fn whole(&mut self, scalar: Scalar, what: &str) -> Read<i64> {
        if let Self::Text(words) = self {
            let word = words.expect(what)?;
            return word.parse().map_err(|_| words.wrong(format!("found {}, expected {what}", quoted(word))));
        }
        // All numbers of these types are exact in f64.
        Ok(self.binary(scalar, what)? as i64)
    }

    /// Leaves out so many numbers.
    pub(super) fn skip(&mut self, scalar: Scalar, count: u64) -> Read<()> {
        match self {
            Self::Text(words) => (0..count).try_for_each(|_| words.expect("a number").map(drop)),
            Self::Binary { .. } => {
                let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(scalar.size()));
                self.take(bytes.unwrap_or(usize::MAX), "a number").map(drop)
            }
        }
    }

    /// The place of the last number.
    pub(super) fn place(&self) -> MeshPlace {
        match self {
            Self::Text(words) => MeshPlace::Line(words.line),
            Self::Binary { at, .. } => MeshPlace::Byte(*at),
        }
    }

    /// An error about the last number.
    pub(super) fn wrong(&self, message: impl Into<String>) -> Wrong {
        Wrong { place: self.place(), message: message.into() }
    }

    /// Checks that the file ends here.
    pub(super) fn end(&mut self) -> Read<()> {
        let message = "the file continues, expected its end after the elements of the header";
        match self {
            Self::Text(words) => words.next().map_or(Ok(()), |_| Err(words.wrong(message))),
            Self::Binary { file, next, .. } if *next < file.len() => Err(wrong_byte(*next, message)),
            Self::Binary { .. } => Ok(()),
        }
    }

    /// The next bytes of a binary file.
    fn take(&mut self, count: usize, what: &str) -> Read<&[u8]> {
        match self {
            // A text has no bytes.
            Self::Text(_) => Ok(&[]),
            Self::Binary { file, at, next, .. } => {
                let end = next.checked_add(count).filter(|end| *end <= file.len());
                let end = end.ok_or_else(|| wrong_byte(*next, format!("the file ends early, expected {what}")))?;
                let bytes = &file[*next..end];
                (*at, *next) = (*next, end);
                Ok(bytes)
            }
        }
    }

    /// A number of a binary file.
    fn binary(&mut self, scalar: Scalar, what: &str) -> Read<f64> {
        let is_big = matches!(self, Self::Binary { is_big: true, .. });
        let bytes = self.take(scalar.size(), what)?;
        let mut low_first = [0; 8];
        low_first[..bytes.len()].copy_from_slice(bytes);
        if is_big {
            low_first[..bytes.len()].reverse();
        }
        let all = u64::from_le_bytes(low_first);
        Ok(match scalar {
            Scalar::I8 => f64::from(all as i8),
            Scalar::U8 => f64::from(all as u8),
            Scalar::I16 => f64::from(all as i16),
            Scalar::U16 => f64::from(all as u16),
            Scalar::I32 => f64::from(all as i32),
            Scalar::U32 => f64::from(all as u32),
            Scalar::F32 => f64::from(f32::from_bits(all as u32)),
            Scalar::F64 => f64::from_bits(all),
        })
    }
}
