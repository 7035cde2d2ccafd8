//! Numbers for cases. With most of them bodies touch. A few are extreme values that may break the arithmetic.

use arbitrary::{Arbitrary, Result, Unstructured};
use rockfall::glam::Vec3;

/// Any f32.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Number(pub(crate) f32);

/// Mostly a multiple of 1/8 from -4 to 4, so that bodies meet; sometimes any f32.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near(pub(crate) f32);

/// A length, a mass or a setting: mostly positive and of the order of 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size(pub(crate) f32);

const ODD: [f32; 24] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    1e-45,
    -1e-40,
    1e-30,
    -1e-15,
    1e-10,
    1e10,
    -1e15,
    1e18,
    3e18,
    -1e19,
    1e30,
    -1e30,
    16_777_216.0,
    1e-5,
];

impl<'a> Arbitrary<'a> for Number {
    fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
        Ok(Self(match u8::arbitrary(source)? {
            // Multiples of 1/4, so that bodies touch, coincide and line up.
            small @ 0..200 => f32::from(i16::from(small) - 100) * 0.25,
            200..208 => f32::from(i16::arbitrary(source)?) / 4096.0,
            208..216 => f32::from_bits(u32::arbitrary(source)?),
            odd => ODD[usize::from(odd - 216) % ODD.len()],
        }))
    }
}

impl<'a> Arbitrary<'a> for Near {
    fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
        Ok(Self(match u8::arbitrary(source)? {
            near @ 0..248 => f32::from(i16::from(near % 65) - 32) * 0.125,
            _ => Number::arbitrary(source)?.0,
        }))
    }
}

impl<'a> Arbitrary<'a> for Size {
    fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
        Ok(Self(match u8::arbitrary(source)? {
            // 0.125 to 4.
            small @ 0..160 => f32::from(small % 32 + 1) * 0.125,
            // Powers of ten from 1e-3 to 1e4.
            decade @ 160..208 => 10_f32.powi(i32::from(decade % 8) - 3),
            _ => Number::arbitrary(source)?.0,
        }))
    }
}

pub(crate) type Vector = [Number; 3];

pub(crate) fn vector(numbers: Vector) -> [f32; 3] {
    numbers.map(|number| number.0)
}

/// A place or a motion near the origin.
pub(crate) fn near(numbers: [Near; 3]) -> Vec3 {
    Vec3::from_array(numbers.map(|number| number.0))
}
