//! Decodes the bytes of a fuzzer into a case: the options of a simulation, and a list of actions on it.

use arbitrary::{Arbitrary, Result, Unstructured};
use rockfall::Integrator;

use super::hard::{HardAction, Setup};
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
        #[allow(clippy::large_enum_variant, reason = "a case has few of them")]
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

pub(crate) use decoded;

/// The options of a simulation, and actions that build and change its scene, in order.
#[derive(Debug)]
pub(crate) struct Case {
    pub(crate) integrator: Integrator,
    pub(crate) keep_going: bool,
    /// Initial size of the pair lists, in units of 32 words.
    pub(crate) capacity: Option<u8>,
    /// Materials and laws. Cases without them have no later actions than [`Later::First`].
    pub(crate) laws: Option<Laws>,
    /// What the law `rigid` has beside materials. Cases without it have no other actions than [`HardAction::Later`].
    pub(crate) hard: Option<Setup>,
    pub(crate) actions: Vec<HardAction>,
}

impl Case {
    /// Decodes as many actions as the bytes hold.
    pub(crate) fn decode(bytes: &[u8]) -> Result<Self> {
        let mut source = Unstructured::new(bytes);
        let first = u8::arbitrary(&mut source)?;
        let integrator = match first & 3 {
            1 => Integrator::SymplecticEuler,
            3 => Integrator::VelocityVerlet,
            _ => Integrator::Rk4,
        };
        let (keep_going, capacity) = (bool::arbitrary(&mut source)?, Option::arbitrary(&mut source)?);
        let laws = if first & 12 != 0 { Some(Laws::arbitrary(&mut source)?) } else { None };
        let hard = if first & 8 != 0 { Some(Setup::arbitrary(&mut source)?) } else { None };
        let actions: Vec<HardAction> = match (&laws, &hard) {
            (_, Some(_)) => {
                let mut actions = Vec::new();
                while !source.is_empty() {
                    actions.push(HardAction::arbitrary(&mut source)?);
                }
                actions
            }
            (Some(_), None) => Vec::<Later>::arbitrary_take_rest(source)?.into_iter().map(HardAction::Later).collect(),
            (None, None) => {
                let actions = Vec::<Action>::arbitrary_take_rest(source)?;
                actions.into_iter().map(|action| HardAction::Later(Later::First(action))).collect()
            }
        };
        Ok(Self { integrator, keep_going, capacity, laws, hard, actions })
    }
}

decoded! {
    /// An action in a scene with materials and laws.
    enum Later {
        First(Action),
        /// Chooses the material of the objects that are added.
        Use(u8),
        Material(u8, Solid),
        Pair([u8; 2], Properties),
        /// Adds or removes a force law.
        Force(u8),
        /// Changes the parameter of the laws.
        Parameter(Number),
        /// Continues from a checkpoint, and runs the one from a file for some steps.
        Resume { steps: u8, dt: Size },
        Save,
        Restore,
    }

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
    /// Materials, the contact law of the scene, and the laws of the program.
    struct Laws {
        contact: u8,
        collisions: Flag,
        double: Flag,
        solids: [Solid; 2],
        /// Of the first material, of both, and of the second.
        pairs: [Properties; 3],
        force: u8,
        response: u8,
    }

    struct Solid {
        density: Option<Size>,
        young: Size,
        /// In units of 1/510.
        poisson: u8,
    }

    /// Properties of a pair of materials. Bytes are in units of 1/255.
    struct Properties {
        restitution: Option<u8>,
        friction: Option<u8>,
        stiffness: Option<Size>,
        speed: Option<Size>,
        /// Friction, whether the torque is constant, and damping.
        rolling: Option<(u8, bool, Size)>,
        twisting: Option<u8>,
        /// Surface energy, and whether there are necks.
        cohesion: Option<(Size, bool)>,
    }

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
