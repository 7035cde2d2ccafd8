//! List of the experiments, in the order of the page.

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
    grains: "Contact laws for grains",
    precision: "Double precision of positions",
    standing: "A heap that stands",
    runout: "Run-out of a column of grains",
    janssen: "A tube of grains with static friction",
    brazil: "A large grain that rises",
    drum: "A rotating drum",
    incline: "Flow down an incline, and a fast drum",
    surfaces: "Several shapes that form one surface",
    walls: "Walls that move, belts and meshes",
    smooth: "Smooth walls",
    press: "Walls that seek a force",
    boxes: "Periodic boxes, and grains that come and go",
    shear: "A sheared box",
    bodies: "Rigid bodies",
    hard: "Hard contacts",
    joints: "Joints",
    rest: "Rest",
    silent: "Slow motion, stiff chains, and symplectic Euler",
    #[cfg(feature = "gpu")]
    pile: "A pile on the CPU and on the GPU",
}

/// An experiment whose outcome is known from theory.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Name on the command line.
    pub name: &'static str,
    /// Heading on the page.
    pub title: &'static str,
    /// Text on the page. The names of facts in double braces are replaced by their values.
    pub text: &'static str,
    /// Runs the experiment.
    pub run: fn(Effort) -> Result<Outcome>,
}
