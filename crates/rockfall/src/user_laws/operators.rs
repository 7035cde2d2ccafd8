//! The operators and built-in functions of WGSL on the bits of numbers.

use naga::{BinaryOperator, MathFunction};

use crate::user_laws::program::Register;

/// The kind of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Int,
    Uint,
    Bool,
}

type One = fn(u32) -> u32;
type Two = fn(u32, u32) -> u32;
type Three = fn(u32, u32, u32) -> u32;
type Vectors = fn([Register; 2], usize) -> Register;

macro_rules! float {
    (|$a:ident| $value:expr) => {
        |$a: u32| {
            let $a = f32::from_bits($a);
            f32::to_bits($value)
        }
    };
    (|$a:ident, $b:ident| $value:expr) => {
        |$a: u32, $b: u32| {
            let [$a, $b] = [$a, $b].map(f32::from_bits);
            f32::to_bits($value)
        }
    };
    (|$a:ident, $b:ident, $c:ident| $value:expr) => {
        |$a: u32, $b: u32, $c: u32| {
            let [$a, $b, $c] = [$a, $b, $c].map(f32::from_bits);
            f32::to_bits($value)
        }
    };
}

/// A comparison of two numbers of one type.
macro_rules! compare {
    ($kind:expr, $operator:tt) => {
        match $kind {
            Kind::Float => |a, b| u32::from(f32::from_bits(a) $operator f32::from_bits(b)),
            Kind::Int => |a, b| u32::from(a.cast_signed() $operator b.cast_signed()),
            Kind::Uint | Kind::Bool => |a, b| u32::from(a $operator b),
        }
    };
}

pub(super) fn binary(op: BinaryOperator, kind: Kind) -> Option<Two> {
    use BinaryOperator as B;
    Some(match (op, kind) {
        (B::Equal, _) => compare!(kind, ==),
        (B::NotEqual, _) => compare!(kind, !=),
        (B::Less, _) => compare!(kind, <),
        (B::LessEqual, _) => compare!(kind, <=),
        (B::Greater, _) => compare!(kind, >),
        (B::GreaterEqual, _) => compare!(kind, >=),
        (B::Add, Kind::Float) => float!(|a, b| a + b),
        (B::Subtract, Kind::Float) => float!(|a, b| a - b),
        (B::Multiply, Kind::Float) => float!(|a, b| a * b),
        (B::Divide, Kind::Float) => float!(|a, b| a / b),
        (B::Modulo, Kind::Float) => float!(|a, b| a % b),
        (B::And | B::LogicalAnd, Kind::Bool) | (B::And, _) => |a, b| a & b,
        (B::InclusiveOr | B::LogicalOr, Kind::Bool) | (B::InclusiveOr, _) => |a, b| a | b,
        (B::ExclusiveOr, Kind::Int | Kind::Uint) => |a, b| a ^ b,
        (B::Add, Kind::Int | Kind::Uint) => u32::wrapping_add,
        (B::Subtract, Kind::Int | Kind::Uint) => u32::wrapping_sub,
        (B::Multiply, Kind::Int | Kind::Uint) => u32::wrapping_mul,
        (B::Divide, Kind::Int) => |a, b| a.cast_signed().checked_div(b.cast_signed()).map_or(a, i32::cast_unsigned),
        (B::Modulo, Kind::Int) => |a, b| a.cast_signed().checked_rem(b.cast_signed()).map_or(0, i32::cast_unsigned),
        (B::Divide, Kind::Uint) => |a, b| a.checked_div(b).unwrap_or(a),
        (B::Modulo, Kind::Uint) => |a, b| a.checked_rem(b).unwrap_or(0),
        (B::ShiftLeft, Kind::Int | Kind::Uint) => u32::wrapping_shl,
        (B::ShiftRight, Kind::Int) => |a, b| a.cast_signed().wrapping_shr(b).cast_unsigned(),
        (B::ShiftRight, Kind::Uint) => u32::wrapping_shr,
        _ => return None,
    })
}

pub(super) fn math1(fun: MathFunction, kind: Kind) -> Option<One> {
    use MathFunction as M;
    if kind == Kind::Int {
        return match fun {
            M::Abs => Some(|a| a.cast_signed().wrapping_abs().cast_unsigned()),
            M::Sign => Some(|a| a.cast_signed().signum().cast_unsigned()),
            _ => None,
        };
    }
    if kind != Kind::Float {
        return None;
    }
    Some(match fun {
        M::Abs => float!(|a| a.abs()),
        M::Saturate => float!(|a| a.clamp(0.0, 1.0)),
        M::Cos => float!(|a| libm::cosf(a)),
        M::Cosh => float!(|a| libm::coshf(a)),
        M::Sin => float!(|a| libm::sinf(a)),
        M::Sinh => float!(|a| libm::sinhf(a)),
        M::Tan => float!(|a| libm::tanf(a)),
        M::Tanh => float!(|a| libm::tanhf(a)),
        M::Acos => float!(|a| libm::acosf(a)),
        M::Asin => float!(|a| libm::asinf(a)),
        M::Atan => float!(|a| libm::atanf(a)),
        M::Asinh => float!(|a| libm::asinhf(a)),
        M::Acosh => float!(|a| libm::acoshf(a)),
        M::Atanh => float!(|a| libm::atanhf(a)),
        M::Radians => float!(|a| a.to_radians()),
        M::Degrees => float!(|a| a.to_degrees()),
        M::Ceil => float!(|a| a.ceil()),
        M::Floor => float!(|a| a.floor()),
        M::Round => float!(|a| a.round_ties_even()),
        M::Fract => float!(|a| a - a.floor()),
        M::Trunc => float!(|a| a.trunc()),
        M::Exp => float!(|a| libm::expf(a)),
        M::Exp2 => float!(|a| libm::exp2f(a)),
        M::Log => float!(|a| libm::logf(a)),
        M::Log2 => float!(|a| libm::log2f(a)),
        M::Sign => float!(|a| if a == 0.0 { 0.0 } else { a.signum() }),
        M::Sqrt => float!(|a| a.sqrt()),
        M::InverseSqrt => float!(|a| 1.0 / a.sqrt()),
        _ => return None,
    })
}

pub(super) fn math2(fun: MathFunction, kind: Kind) -> Option<Two> {
    use MathFunction as M;
    Some(match (fun, kind) {
        (M::Min, Kind::Float) => float!(|a, b| a.min(b)),
        (M::Max, Kind::Float) => float!(|a, b| a.max(b)),
        (M::Min, Kind::Int) => |a, b| a.cast_signed().min(b.cast_signed()).cast_unsigned(),
        (M::Max, Kind::Int) => |a, b| a.cast_signed().max(b.cast_signed()).cast_unsigned(),
        (M::Min, Kind::Uint) => Ord::min,
        (M::Max, Kind::Uint) => Ord::max,
        (M::Atan2, Kind::Float) => float!(|a, b| libm::atan2f(a, b)),
        (M::Pow, Kind::Float) => float!(|a, b| libm::powf(a, b)),
        _ => return None,
    })
}

pub(super) fn math3(fun: MathFunction, kind: Kind) -> Option<Three> {
    use MathFunction as M;
    Some(match (fun, kind) {
        (M::Clamp, Kind::Float) => float!(|a, low, high| a.max(low).min(high)),
        (M::Clamp, Kind::Int) => |a, low, high| {
            let [a, low, high] = [a, low, high].map(u32::cast_signed);
            a.max(low).min(high).cast_unsigned()
        },
        (M::Clamp, Kind::Uint) => |a, low, high| a.max(low).min(high),
        (M::Fma, Kind::Float) => float!(|a, b, c| a.mul_add(b, c)),
        (M::Mix, Kind::Float) => float!(|a, b, t| a * (1.0 - t) + b * t),
        (M::SmoothStep, Kind::Float) => float!(|low, high, a| {
            let t = ((a - low) / (high - low)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }),
        _ => return None,
    })
}

/// Functions of whole vectors of floats.
pub(super) fn vectors(fun: MathFunction) -> Option<Vectors> {
    Some(match fun {
        MathFunction::Dot => |[a, b], lanes| [dot(a, b, lanes).to_bits(), 0, 0, 0],
        MathFunction::Length => |[a, _], lanes| [dot(a, a, lanes).sqrt().to_bits(), 0, 0, 0],
        MathFunction::Distance => |[a, b], lanes| {
            let difference = std::array::from_fn(|k| (f32::from_bits(a[k]) - f32::from_bits(b[k])).to_bits());
            [dot(difference, difference, lanes).sqrt().to_bits(), 0, 0, 0]
        },
        MathFunction::Normalize => |[a, _], lanes| {
            let length = dot(a, a, lanes).sqrt();
            let divided = a.map(|lane| (f32::from_bits(lane) / length).to_bits());
            std::array::from_fn(|k| if k < lanes { divided[k] } else { 0 })
        },
        MathFunction::Cross => |[a, b], _| {
            let [[ax, ay, az, _], [bx, by, bz, _]] = [a, b].map(|vector| vector.map(f32::from_bits));
            [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx, 0.0].map(f32::to_bits)
        },
        _ => return None,
    })
}

fn dot(a: Register, b: Register, lanes: usize) -> f32 {
    (0..lanes).map(|k| f32::from_bits(a[k]) * f32::from_bits(b[k])).sum()
}

pub(super) fn all([flags, _]: [Register; 2], lanes: usize) -> Register {
    [u32::from(flags[..lanes].iter().all(|flag| *flag != 0)), 0, 0, 0]
}

pub(super) fn any([flags, _]: [Register; 2], lanes: usize) -> Register {
    [u32::from(flags[..lanes].iter().any(|flag| *flag != 0)), 0, 0, 0]
}

/// Conversion of a number of one kind to another.
pub(super) fn conversion(from: Kind, to: Kind) -> One {
    match (from, to) {
        (Kind::Float, Kind::Int) => |a| (f32::from_bits(a) as i32).cast_unsigned(),
        (Kind::Float, Kind::Uint) => |a| f32::from_bits(a) as u32,
        (Kind::Float, Kind::Bool) => |a| u32::from(f32::from_bits(a) != 0.0),
        (Kind::Int, Kind::Float) => |a| (a.cast_signed() as f32).to_bits(),
        (Kind::Uint, Kind::Float) => |a| (a as f32).to_bits(),
        (Kind::Bool, Kind::Float) => |a| (a as f32).to_bits(),
        (Kind::Int | Kind::Uint, Kind::Bool) => |a| u32::from(a != 0),
        _ => |a| a,
    }
}
