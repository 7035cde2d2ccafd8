//! The style of a picture: what its colours mean, shadows, ground and background.

use rockfall::SphereDiagnostics;
use rockfall::glam::Vec3;

use crate::legend::CONTACTS;
use crate::palette::{KINDS, Rgb, SCALE, TENSIONS};

/// The quantity that the colour of a body shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ColourBy {
    /// Kind of object.
    #[default]
    Kind = 0,
    /// Speed, in units/s.
    Speed = 1,
    /// Number of contacts.
    Contacts = 2,
    /// Deepest overlap, in units.
    Overlap = 3,
    /// Net force, in mass units/s².
    Force = 4,
    /// A colour for every body.
    Body = 5,
    /// Normal force of every contact, as a line between the two bodies, in mass units/s².
    ContactForce = 6,
    /// Tension of springs, muscles and tethers, in mass units/s²; negative where they push. Other bodies are pale.
    Tension = 7,
}

impl ColourBy {
    /// Whether it has to be evaluated because it is not part of the state.
    pub(crate) fn is_evaluated(self) -> bool {
        matches!(self, Self::Contacts | Self::Overlap | Self::Force)
    }

    /// Name of the quantity with its unit; `None` for [`ColourBy::Kind`] and [`ColourBy::Body`], which have no scale.
    pub fn title(self) -> Option<&'static str> {
        match self {
            Self::Kind | Self::Body => None,
            Self::Speed => Some("speed, units/s"),
            Self::Contacts => Some(CONTACTS),
            Self::Overlap => Some("deepest overlap, units"),
            Self::Force => Some("net force, mass units/s²"),
            Self::ContactForce => Some("contact force, mass units/s²"),
            Self::Tension => Some("tension (< 0: push), mass units/s²"),
        }
    }

    /// All values.
    pub const ALL: [Self; 8] =
        [Self::Kind, Self::Speed, Self::Contacts, Self::Overlap, Self::Force, Self::Body, Self::ContactForce, Self::Tension];

    /// The range of an automatic scale that ends at a value: from 0, or for a quantity with a sign from minus that value.
    pub fn range_to(self, end: f32) -> [f32; 2] {
        [if self == Self::Tension { -end } else { 0.0 }, end]
    }

    /// Evenly spaced colours from one end of the scale to the other.
    pub fn scale(self) -> [Rgb; 9] {
        if self == Self::Tension { TENSIONS } else { SCALE }
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kind => "kind",
            Self::Speed => "speed",
            Self::Contacts => "contacts",
            Self::Overlap => "overlap",
            Self::Force => "force",
            Self::Body => "body",
            Self::ContactForce => "contact-force",
            Self::Tension => "tension",
        }
    }

    pub(crate) fn value_of(self, values: &SphereDiagnostics) -> f32 {
        match self {
            Self::Kind | Self::Speed | Self::Body | Self::ContactForce | Self::Tension => 0.0,
            Self::Contacts => values.contacts as f32,
            Self::Overlap => values.deepest_overlap,
            Self::Force => values.net_force.length(),
        }
    }
}

/// The range of the colour scale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Range {
    /// From 0 to the next round number above the 99th percentile of the values of the last frames. Values of 0 and bodies far
    /// from all others do not count. That of a tension begins at minus its end, so that 0 is in the middle.
    #[default]
    Auto,
    /// From the first value to the second.
    Given([f32; 2]),
}

/// Colours of the background.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Background {
    /// Colour at the horizon and below.
    pub horizon: Rgb,
    /// Colour straight up.
    pub zenith: Rgb,
}

impl Background {
    /// Whether dark lines could hardly be seen on it.
    pub fn is_dark(&self) -> bool {
        let brightness = |[red, green, blue]: Rgb| 0.3 * f32::from(red) + 0.6 * f32::from(green) + 0.1 * f32::from(blue);
        brightness(self.horizon) < 90.0
    }
}

impl Default for Background {
    fn default() -> Self {
        Self { horizon: [0xee, 0xf0, 0xf2], zenith: [0xc6, 0xd3, 0xe0] }
    }
}

/// The style of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// Quantity that the colours show.
    pub colour_by: ColourBy,
    /// Range of the colour scale.
    pub range: Range,
    /// Whether bodies cast shadows.
    pub shadows: bool,
    /// Whether corners and gaps are darker (ambient occlusion).
    pub occlusion: bool,
    /// Whether a ground with a grid is drawn below the scene.
    pub ground: bool,
    /// Colours of the background.
    pub background: Background,
    /// Direction towards the sun; its length does not matter. `None`: obliquely from above, (-0.45, 0.8, 0.4) with y up.
    pub light: Option<Vec3>,
    /// Colours of the kinds of objects, in the order of [`KINDS`].
    pub kinds: [Rgb; 8],
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
            light: None,
            kinds: KINDS.map(|kind| kind.colour),
        }
    }
}
