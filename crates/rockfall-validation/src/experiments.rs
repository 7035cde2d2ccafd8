//! The experiments, in the order of the page.

use crate::outcome::Outcome;
use crate::{Effort, Result};

macro_rules! experiments {
    ($($(#[$attribute:meta])* $name:ident: $title:literal),* $(,)?) => {
        $($(#[$attribute])* mod $name;)*

        /// All experiments.
        pub const ALL: &[Experiment] = &[
            $($(#[$attribute])* Experiment {
                name: stringify!($name),
                title: $title,
                text: include_str!(concat!("experiments/", stringify!($name), ".md")),
                run: $name::run,
            },)*
        ];
    };
}

experiments! {
    order: "Order of accuracy",
    drift: "Energy over many steps",
    contact: "The contact law",
    bounce: "Restitution",
    gas: "A cooling gas",
    friction: "Friction: the square-root law and Coulomb's",
    pendulum: "Pendulums",
    chain: "A hanging chain",
    string: "A plucked string",
    top: "A thrown capsule",
    heap: "Heaps",
    hopper: "Discharge of a silo",
    column: "Pressure below a column of grains",
    mixing: "Sizes shaken together",
    rebound: "Rebound with friction",
    cradle: "Newton's cradle",
    spinning: "A top, and a frame that flips",
    moving: "Belt, turntable, loop",
    zigzag: "A zigzag stack",
    collapse: "Collapse of a column",
    rest: "Rest",
    #[cfg(feature = "gpu")]
    pile: "A pile on the CPU and on the GPU",
}

/// Something of which theory knows the outcome.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What the page says of it; facts stand in double braces.
    pub text: &'static str,
    /// Does it.
    pub run: fn(Effort) -> Result<Outcome>,
}
