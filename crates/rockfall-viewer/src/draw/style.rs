//! What a picture shows of a simulation, and how.

use rockfall::SphereDiagnostics;

use crate::palette::Rgb;

/// What the colour of a body tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ColourBy {
    /// What kind of object it is.
    #[default]
    Kind = 0,
    /// Its speed, in units/s.
    Speed = 1,
    /// How many contacts it has.
    Contacts = 2,
    /// Its deepest overlap, in units.
    Overlap = 3,
    /// The net force on it, in mass units/s².
    Force = 4,
}

impl ColourBy {
    /// Whether it takes more than the state.
    pub(crate) fn is_evaluated(self) -> bool {
        matches!(self, Self::Contacts | Self::Overlap | Self::Force)
    }

    /// What is measured, with its unit; `None` for kinds.
    pub fn title(self) -> Option<&'static str> {
        match self {
            Self::Kind => None,
            Self::Speed => Some("speed, units/s"),
            Self::Contacts => Some("contacts"),
            Self::Overlap => Some("deepest overlap, units"),
            Self::Force => Some("net force, mass units/s²"),
        }
    }

    /// All of them.
    pub const ALL: [Self; 5] = [Self::Kind, Self::Speed, Self::Contacts, Self::Overlap, Self::Force];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind => "kind",
            Self::Speed => "speed",
            Self::Contacts => "contacts",
            Self::Overlap => "overlap",
            Self::Force => "force",
        }
    }

    pub(crate) fn of(self, values: &SphereDiagnostics) -> f32 {
        match self {
            Self::Kind | Self::Speed => 0.0,
            Self::Contacts => values.contacts as f32,
            Self::Overlap => values.deepest_overlap,
            Self::Force => values.net_force.length(),
        }
    }
}

/// The values at the two ends of the colour scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// From 0 to the next round number above the greatest there was of late.
    #[default]
    Auto,
    /// From, to.
    Given([f32; 2]),
}

/// What is behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Background {
    /// At the horizon, and below.
    pub horizon: Rgb,
    /// Straight up.
    pub zenith: Rgb,
}

impl Default for Background {
    fn default() -> Self {
        Self { horizon: [0xee, 0xf0, 0xf2], zenith: [0xc6, 0xd3, 0xe0] }
    }
}

/// What is shown, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// What colours tell.
    pub colour_by: ColourBy,
    /// The ends of the colour scale.
    pub range: Range,
    /// Whether bodies cast shadows.
    pub shadows: bool,
    /// Whether light is dimmed in corners and gaps.
    pub occlusion: bool,
    /// Whether there is a ground with a grid on it, under everything.
    pub ground: bool,
    /// What is behind everything.
    pub background: Background,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            colour_by: ColourBy::default(),
            range: Range::default(),
            shadows: true,
            occlusion: true,
            ground: true,
            background: Background::default(),
        }
    }
}
