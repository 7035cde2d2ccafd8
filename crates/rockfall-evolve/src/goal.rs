//! What counts, and what a creature did.

use serde::{Deserialize, Serialize};

/// What creatures are selected for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// Distance from start to end along the ground, in units.
    Distance,
    /// Mean speed along the ground in the second half of the time, in units/s.
    Speed,
    /// Mean height of the centre above the ground below it, in units.
    Height,
    /// Greatest height of the lowest sphere above the ground below it and above the place of the last contact, in units.
    Jump,
    /// Height that the ground below the creature has gained at the end, in units.
    Climb,
}

impl Goal {
    /// All goals with their names.
    pub const ALL: [(Self, &str); 5] = [
        (Self::Distance, "distance"),
        (Self::Speed, "speed"),
        (Self::Height, "height"),
        (Self::Jump, "jump"),
        (Self::Climb, "climb"),
    ];

    /// Unit of the fitness.
    pub fn unit(self) -> &'static str {
        if self == Self::Speed { "units/s" } else { "units" }
    }

    pub(crate) fn walks(self) -> bool {
        matches!(self, Self::Distance | Self::Speed)
    }

    /// Whether heights above the ground count, which take time to find.
    pub(crate) fn needs_ground(self) -> bool {
        !self.walks()
    }
}

impl std::str::FromStr for Goal {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|(_, known)| *known == name);
        found.map(|(goal, _)| goal).ok_or_else(|| "expected distance, speed, height, jump or climb".to_owned())
    }
}

impl std::fmt::Display for Goal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(Self::ALL.into_iter().find(|(goal, _)| goal == self).map_or("", |(_, name)| name))
    }
}

/// Whether the deeds of a creature count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// They count.
    Valid,
    /// A state stopped being finite.
    NotFinite,
    /// A sphere was faster, or a spring shorter or longer, than muscles can make it.
    Exploded,
    /// It fell or leapt once and did not walk on.
    Unsteady,
    /// It went downhill by more than its own length.
    Downhill,
}

/// What a creature did in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Whether it counts.
    pub verdict: Verdict,
    /// Fitness in the unit of the goal; 0 unless the outcome is valid.
    pub fitness: f64,
    /// Horizontal distance of the centre from where it was when the creature had settled, at the end, in units.
    pub distance: f64,
    /// Standard deviation of the height of the centre, as a share of its mean.
    pub bounce: f64,
}
