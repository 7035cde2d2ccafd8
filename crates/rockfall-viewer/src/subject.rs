//! What a camera moves with.

use rockfall::glam::Vec3;
use rockfall::{Body, Result, Scene, SphereId};

use crate::plot::up;
use crate::whole::{motion, whole};

/// What a camera moves with.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Subject {
    /// A body: a rigid body is known by its first sphere, a capsule by its rod.
    Body(Body),
    /// The creatures of a scene: the spheres that muscles move.
    Creatures(Vec<SphereId>),
}

impl Subject {
    /// The body that a sphere is part of: a rigid body, a capsule, or the sphere alone.
    pub fn of(scene: &Scene, sphere: SphereId) -> Self {
        Self::Body(whole(scene, Body::Sphere(sphere)))
    }

    /// The creatures of a scene: the ends of all muscles. `None` for a scene without muscles.
    pub fn creatures(scene: &Scene) -> Option<Self> {
        let muscles = scene.springs().iter().filter(|spring| spring.muscle.is_some());
        let mut ends: Vec<SphereId> = muscles.flat_map(|spring| [spring.a, spring.b]).collect();
        let mut seen = std::collections::HashSet::new();
        ends.retain(|end| seen.insert(*end));
        (!ends.is_empty()).then_some(Self::Creatures(ends))
    }

    /// The centre of mass of the body, or the middle of the creatures.
    ///
    /// # Errors
    /// [`rockfall::Error::StaleHandle`] when it is not in the scene any more.
    pub fn place(&self, scene: &Scene) -> Result<Vec3> {
        match self {
            Self::Body(Body::Sphere(id)) => _ = scene.sphere(*id)?,
            Self::Body(Body::Rod(id)) => _ = scene.rod(*id)?,
            Self::Body(_) => {}
            Self::Creatures(ends) => ends.iter().try_for_each(|end| scene.sphere(*end).map(drop))?,
        }
        Ok(self.motion(scene).map_or(Vec3::ZERO, |(place, _)| place))
    }

    /// Position and velocity of the middle.
    pub(crate) fn motion(&self, scene: &Scene) -> Option<(Vec3, Vec3)> {
        let ends = match self {
            Self::Body(body) => return motion(scene, *body),
            Self::Creatures(ends) => ends,
        };
        let mut sum = (Vec3::ZERO, Vec3::ZERO);
        for end in ends {
            let sphere = scene.sphere(*end).ok()?;
            sum = (sum.0 + sphere.position, sum.1 + sphere.velocity);
        }
        let count = ends.len() as f32;
        Some((sum.0 / count, sum.1 / count))
    }

    /// The direction along which the camera does not follow: creatures are followed along the ground only.
    pub(crate) fn ignored(&self, scene: &Scene) -> Vec3 {
        if matches!(self, Self::Creatures(_)) && scene.settings.gravity != 0.0 { up(scene) } else { Vec3::ZERO }
    }
}
