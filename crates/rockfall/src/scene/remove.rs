//! Removes objects: one, or many in one pass.

use crate::error::Result;
use crate::scene::checks::invalid;
use crate::scene::{BoxId, CapsuleId, JointId, PolygonId, RigidBodyId, RodId, Scene, SphereId, SpringId, TetherId};

macro_rules! single {
    ($($(#[$doc:meta])* $one:ident($handle:ty) as $all:ident;)*) => {
        /// Removing single objects.
        impl Scene {
            $(
                $(#[$doc])*
                ///
                /// # Errors
                /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene.
                pub fn $one(&mut self, id: $handle) -> Result<()> {
                    self.$all(&[id])
                }
            )*
        }
    };
}

single! {
    /// Removes a sphere together with its rods, capsules, springs, tethers and joints.
    remove_sphere(SphereId) as remove_spheres;
    /// Removes a rod. If it is part of a capsule, the two spheres stay.
    remove_rod(RodId) as remove_rods;
    /// Removes a capsule with both its spheres and everything attached to them.
    remove_capsule(CapsuleId) as remove_capsules;
    /// Removes a rigid body with its spheres and rods and everything attached to them.
    remove_body(RigidBodyId) as remove_bodies;
    /// Removes a spring.
    remove_spring(SpringId) as remove_springs;
    /// Removes a tether.
    remove_tether(TetherId) as remove_tethers;
    /// Removes a joint.
    remove_joint(JointId) as remove_joints;
    /// Removes a box.
    remove_box(BoxId) as remove_boxes;
    /// Removes a polygon.
    remove_polygon(PolygonId) as remove_polygons;
}

/// Removing many objects. It takes about as long as the removal of one of them.
impl Scene {
    /// Removes spheres together with their rods, capsules, springs, tethers and joints.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when one is not in the scene. [`Error::Invalid`](crate::Error::Invalid) for
    /// an object that is part of a rigid body: only the whole body can be removed. Nothing is removed then.
    pub fn remove_spheres(&mut self, ids: &[SphereId]) -> Result<()> {
        if let Some(id) = ids.iter().find(|id| self.body_of_sphere(**id).is_some()) {
            return Err(invalid("sphere", id, "a sphere that is not part of a rigid body; remove the body"));
        }
        self.remove_with_attached(ids)
    }

    /// Removes spheres of any kind with what is attached to them.
    fn remove_with_attached(&mut self, ids: &[SphereId]) -> Result<()> {
        // Nothing is released if one is not in the scene.
        ids.iter().try_for_each(|id| self.spheres.index(*id).map(drop))?;
        self.release_spheres(ids);
        self.spheres.remove(ids)?;
        let spheres = &self.spheres;
        let is_gone = |id: SphereId| spheres.index(id).is_err();
        self.rods.remove_where(|rod| is_gone(rod.end1) || is_gone(rod.end2));
        self.capsules.remove_where(|capsule| is_gone(capsule.end1) || is_gone(capsule.end2));
        self.springs.remove_where(|spring| is_gone(spring.a) || is_gone(spring.b));
        self.tethers.remove_where(|tether| is_gone(tether.sphere));
        self.remove_loose_joints();
        Ok(())
    }

    /// Removes rods. Spheres of capsules that they are part of stay.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_rods(&mut self, ids: &[RodId]) -> Result<()> {
        if let Some(id) = ids.iter().find(|id| self.body_of_rod(**id).is_some()) {
            return Err(invalid("rod", id, "a rod that is not part of a rigid body; remove the body"));
        }
        // Nothing is released if one is not in the scene.
        ids.iter().try_for_each(|id| self.rods.index(*id).map(drop))?;
        self.release_rods(ids);
        self.rods.remove(ids)?;
        let rods = &self.rods;
        self.capsules.remove_where(|capsule| rods.index(capsule.rod).is_err());
        Ok(())
    }

    /// Removes capsules with their spheres and everything attached to them.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_capsules(&mut self, ids: &[CapsuleId]) -> Result<()> {
        let ends = ids.iter().map(|id| self.capsules.get(*id).map(|capsule| [capsule.end1, capsule.end2]));
        let ends: Vec<_> = ends.collect::<Result<_>>()?;
        self.remove_spheres(ends.as_flattened())
    }

    /// Removes rigid bodies with their spheres and rods and everything attached to them.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_bodies(&mut self, ids: &[RigidBodyId]) -> Result<()> {
        let members = ids.iter().map(|id| Ok(self.bodies.get(*id)?.spheres.as_slice()));
        let members: Vec<SphereId> = members.collect::<Result<Vec<_>>>()?.concat();
        self.bodies.remove(ids)?;
        self.remove_with_attached(&members)
    }

    /// Removes springs.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_springs(&mut self, ids: &[SpringId]) -> Result<()> {
        self.springs.remove(ids)
    }

    /// Removes tethers.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_tethers(&mut self, ids: &[TetherId]) -> Result<()> {
        self.tethers.remove(ids)
    }

    /// Removes joints.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_joints(&mut self, ids: &[JointId]) -> Result<()> {
        self.joints.remove(ids)
    }

    /// Removes boxes.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_boxes(&mut self, ids: &[BoxId]) -> Result<()> {
        self.boxes.remove(ids)
    }

    /// Removes polygons.
    ///
    /// # Errors
    /// As for [`Scene::remove_spheres`].
    pub fn remove_polygons(&mut self, ids: &[PolygonId]) -> Result<()> {
        self.polygons.remove(ids)
    }
}
