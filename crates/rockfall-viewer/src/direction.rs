//! Directions from which a camera looks at a scene.

use rockfall::glam::Vec3;

/// The direction from which a camera looks at a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// From above and in front, a little from the right.
    #[default]
    Oblique,
    /// From +z: x points to the right, y to the top of the picture.
    Front,
    /// From +x: z points to the left, y to the top of the picture.
    Side,
    /// From +y: x points to the right, z to the bottom of the picture.
    Top,
    /// From (1, 1, 1): the three axes look equally long.
    Iso,
}

impl Direction {
    /// The directions with a name on the command line.
    pub const NAMED: [Self; 4] = [Self::Front, Self::Side, Self::Top, Self::Iso];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Oblique => "oblique",
            Self::Front => "front",
            Self::Side => "side",
            Self::Top => "top",
            Self::Iso => "iso",
        }
    }

    /// Returns the direction with this name.
    ///
    /// # Errors
    /// A text with the names, if this is none of them.
    pub fn named(name: &str) -> Result<Self, String> {
        let found = Self::NAMED.into_iter().find(|direction| direction.name() == name);
        found.ok_or_else(|| format!("expected one of: {}", Self::NAMED.map(Self::name).join(", ")))
    }

    /// The unit vector from the target to the camera.
    pub fn to_camera(self) -> Vec3 {
        match self {
            Self::Oblique => Vec3::new(0.45, 0.50, 1.0).normalize(),
            Self::Front => Vec3::Z,
            Self::Side => Vec3::X,
            Self::Top => Vec3::Y,
            Self::Iso => Vec3::ONE.normalize(),
        }
    }
}
