//! The vertical of pictures: the axis that points to their top.

use rockfall::Scene;
use rockfall::glam::{Mat3, Vec3};

use crate::extent::Extent;

/// The axis that points to the top of a picture.
///
/// Named directions, frames of cameras and the ground are defined in *level coordinates*: x to the right and y up as seen from
/// the front. They differ from those of the scene by a rotation of quarter turns, which changes only the order and signs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// +x; the front is +z.
    X,
    /// +y; the front is +z.
    #[default]
    Y,
    /// +z; the front is -y.
    Z,
    /// -x; the front is +z.
    NegX,
    /// -y; the front is +z.
    NegY,
    /// -z; the front is +y.
    NegZ,
}

impl Up {
    const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::NegX, Self::NegY, Self::NegZ];

    /// The axis opposite to the gravity of a scene. +y if gravity is not along an axis.
    pub fn of(scene: &Scene) -> Self {
        let up = -scene.settings.gravity_direction;
        let is_up = |axis: &Self| {
            let along = up.dot(axis.vector());
            along > 0.0 && up == along * axis.vector()
        };
        Self::ALL.into_iter().find(is_up).unwrap_or_default()
    }

    /// The unit vector upwards, in coordinates of the scene.
    pub fn vector(self) -> Vec3 {
        self.axes().y_axis
    }

    /// The axes of the level coordinates, in coordinates of the scene.
    fn axes(self) -> Mat3 {
        let [right, up] = match self {
            Self::X => [Vec3::NEG_Y, Vec3::X],
            Self::Y => [Vec3::X, Vec3::Y],
            Self::Z => [Vec3::X, Vec3::Z],
            Self::NegX => [Vec3::Y, Vec3::NEG_X],
            Self::NegY => [Vec3::NEG_X, Vec3::NEG_Y],
            Self::NegZ => [Vec3::X, Vec3::NEG_Z],
        };
        Mat3::from_cols(right, up, right.cross(up))
    }

    /// A vector of level coordinates in coordinates of the scene.
    pub fn to_scene(self, level: Vec3) -> Vec3 {
        // Nothing changes, not even the sign of a zero.
        if self == Self::Y { level } else { self.axes() * level }
    }

    /// A vector of the scene in level coordinates.
    pub fn to_level(self, vector: Vec3) -> Vec3 {
        if self == Self::Y { vector } else { self.axes().transpose() * vector }
    }

    /// The height of a point.
    pub fn height(self, point: Vec3) -> f32 {
        let axis = self.vector();
        if axis.max_element() > 0.0 { point[axis.max_position()] } else { -point[axis.min_position()] }
    }

    /// The height of the lowest point of an extent.
    pub(crate) fn bottom(self, extent: Extent) -> f32 {
        self.height(extent.min).min(self.height(extent.max))
    }

    /// An extent of the scene in level coordinates.
    pub(crate) fn level_extent(self, extent: Extent) -> Extent {
        let [one, other] = [extent.min, extent.max].map(|corner| self.to_level(corner));
        Extent { min: one.min(other), max: one.max(other) }
    }

    /// An extent of level coordinates in coordinates of the scene.
    pub(crate) fn scene_extent(self, extent: Extent) -> Extent {
        let [one, other] = [extent.min, extent.max].map(|corner| self.to_scene(corner));
        Extent { min: one.min(other), max: one.max(other) }
    }
}

/// How the vertical of a picture is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Vertical {
    /// As [`Up::of`] finds it for the scene.
    #[default]
    Auto,
    /// This one in every scene.
    Given(Up),
}

impl Vertical {
    /// Returns the choice with this name: y, z or auto.
    ///
    /// # Errors
    /// A text with the names, if this is none of them.
    pub fn named(name: &str) -> Result<Self, String> {
        match name {
            "y" => Ok(Self::Given(Up::Y)),
            "z" => Ok(Self::Given(Up::Z)),
            "auto" => Ok(Self::Auto),
            _ => Err("expected one of: y, z, auto".to_owned()),
        }
    }

    /// The vertical of pictures of a scene.
    pub fn of(self, scene: &Scene) -> Up {
        match self {
            Self::Auto => Up::of(scene),
            Self::Given(up) => up,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_opposite_to_gravity_along_an_axis() {
        let of = |down: [f32; 3]| {
            let mut scene = Scene::new();
            scene.settings.gravity_direction = down.into();
            Up::of(&scene)
        };
        assert_eq!(Up::of(&Scene::new()), Up::Y);
        assert_eq!([of([0.0, 0.0, -2.0]), of([0.0, 0.0, 1.0]), of([-1.0, 0.0, 0.0])], [Up::Z, Up::NegZ, Up::X]);
        assert_eq!([of([0.0, 1.0, 0.0]), of([0.1, 0.0, -1.0]), of([0.0; 3])], [Up::NegY, Up::Y, Up::Y]);
        for up in Up::ALL {
            assert_eq!(of((-up.vector()).into()), up);
        }
    }

    #[test]
    fn level_coordinates_are_a_rotation_whose_y_is_up() {
        let point = Vec3::new(1.0, 2.0, 3.0);
        for up in Up::ALL {
            assert_eq!(up.axes().determinant(), 1.0, "{up:?}");
            assert_eq!(up.to_scene(up.to_level(point)), point);
            assert_eq!(up.to_level(up.vector()), Vec3::Y);
            assert_eq!(up.height(point), up.to_level(point).y);
            let extent = Extent { min: Vec3::ZERO, max: point };
            assert_eq!(up.scene_extent(up.level_extent(extent)), extent);
            assert_eq!(up.bottom(extent), up.level_extent(extent).min.y);
        }
        assert_eq!(Up::Z.to_scene(Vec3::Z), Vec3::NEG_Y);
    }

    #[test]
    fn verticals_have_names() {
        assert_eq!(Vertical::named("z"), Ok(Vertical::Given(Up::Z)));
        assert_eq!(Vertical::named("auto").unwrap().of(&Scene::new()), Up::Y);
        assert_eq!(Vertical::named("x").unwrap_err(), "expected one of: y, z, auto");
    }
}
