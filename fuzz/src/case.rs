//! Decodes the bytes of a fuzzer into a case: the options of a simulation, and a list of actions on it.

use arbitrary::{Arbitrary, Result, Unstructured};
use rockfall::Integrator;

use super::number::{Number, Size, Vector};

/// Implements [`Arbitrary`] for structs and enums field by field, like `#[derive(Arbitrary)]`. The derive macro is not used,
/// because it would build the syntax library that all macros of wgpu share a second time, with more features.
macro_rules! decoded {
    ($($(#[$doc:meta])* struct $name:ident { $($(#[$note:meta])* $field:ident: $type:ty,)* })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name { $($(#[$note])* pub(crate) $field: $type,)* }

        impl<'a> Arbitrary<'a> for $name {
            fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
                Ok(Self { $($field: Arbitrary::arbitrary(source)?,)* })
            }
        }
    )*};
    ($($(#[$doc:meta])* enum $name:ident {
        $($(#[$note:meta])* $variant:ident $(($($of:ty),*))? $({ $($field:ident: $type:ty),* })?,)*
    })*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum $name { $($(#[$note])* $variant $(($($of),*))? $({ $($field: $type),* })?,)* }

        impl<'a> Arbitrary<'a> for $name {
            fn arbitrary(source: &mut Unstructured<'a>) -> Result<Self> {
                let variants = [$(stringify!($variant)),*];
                let chosen = (u64::from(u32::arbitrary(source)?) * variants.len() as u64) >> 32;
                match variants[chosen as usize] {
                    $(stringify!($variant) => {
                        Ok(Self::$variant $(($(<$of>::arbitrary(source)?),*))? $({ $($field: <$type>::arbitrary(source)?),* })?)
                    })*
                    _ => Err(arbitrary::Error::IncorrectFormat),
                }
            }
        }
    )*};
}

/// The options of a simulation, and actions that build and change its scene, in order.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) integrator: Integrator,
    pub(crate) keep_going: bool,
    /// Initial size of the pair lists, in units of 32 words.
    pub(crate) capacity: Option<u8>,
    pub(crate) actions: Vec<Action>,
}

impl Case {
    /// Decodes as many actions as the bytes hold.
    pub(crate) fn decode(bytes: &[u8]) -> Result<Self> {
        let mut source = Unstructured::new(bytes);
        Ok(Self {
            integrator: match u8::arbitrary(&mut source)? & 3 {
                1 => Integrator::SymplecticEuler,
                3 => Integrator::VelocityVerlet,
                _ => Integrator::Rk4,
            },
            keep_going: bool::arbitrary(&mut source)?,
            capacity: Option::arbitrary(&mut source)?,
            actions: Vec::arbitrary_take_rest(source)?,
        })
    }
}

decoded! {
    enum Action {
        Add(Add),
        /// A kind, and the number of the object to remove, modulo the number of objects of the kind.
        Remove(Kind, u8),
        Change(u8, Change),
        Attachment(Kind, u8, [Size; 3]),
        Setting(u8, Number),
        Run { steps: u8, dt: Size },
        Phase(u8),
        TimeStep(Size),
        Observe,
    }

    enum Add {
        Sphere(Ball),
        /// A block of equal balls: their number modulo 32, and their distance.
        Block(Ball, u8, Size),
        Rod { ends: [u8; 2], radius: Size, length: Option<Size>, group: bool },
        Capsule { ends: [Vector; 2], velocity: Vector, mass: Size, radius: Size, group: bool },
        Spring { ends: [u8; 2], numbers: [Size; 3] },
        Tether { sphere: u8, point: Vector, numbers: [Size; 3] },
        /// Between two corners.
        Box { corners: [Vector; 2], group: bool },
        Cuboid { corner: Vector, edges: [Vector; 3], group: bool },
        Polygon { corner: Vector, edges: [Vector; 2], group: bool },
    }

    enum Kind {
        Sphere,
        Rod,
        Capsule,
        Spring,
        Tether,
        Box,
        Polygon,
    }

    /// A change of a sphere.
    enum Change {
        Position(Vector),
        Velocity(Vector),
        AngularMomentum(Vector),
        Orientation([Number; 4]),
        Impulse(Vector),
        Force(Vector),
    }
}

decoded! {
    struct Ball {
        position: Vector,
        velocity: Vector,
        radius: Size,
        /// Mass, angular momentum and force. Most cases use the defaults.
        more: Option<(Size, Vector, Vector)>,
        fixed: Flag,
        group: bool,
    }

    /// A flag that 1 of 8 byte values sets.
    struct Flag {
        number: u8,
    }
}

impl Flag {
    pub(crate) fn is_set(self) -> bool {
        self.number >= 224
    }
}
