//! Periodic boundaries under the law `rigid`: what has no mass stands in all images that matter (docs/physics section 11.1).

use glam::{DVec3, Vec3};

use super::build::Builder;
use crate::rigid::periods::Periods;
use crate::scene::{Scene, Surface};

/// A plane that leans by more than this, in rad, is not the same in all images.
const UPRIGHT: f64 = 1e-6;

impl Builder<'_> {
    /// The box of a periodic scene in coordinates of the world.
    pub(super) fn periods(&self) -> Periods {
        let bounds = self.scene.periodic().map(|bounds| bounds.unwrap_or([0.0; 2]).map(f64::from));
        let [from, to] = [0, 1].map(|end| DVec3::from_array(bounds.map(|bounds| bounds[end])));
        Periods { lengths: (to - from).as_vec3(), least: self.local(from) }
    }

    /// Adds the images of the walls: each collider without mass once more for every image whose AABB is near enough to the box.
    pub(super) fn repeat_walls(&mut self) {
        let periods = self.world.periods;
        if !periods.any() {
            return;
        }
        let walls: Vec<_> = self.world.colliders.drain(..).zip(self.parts.drain(..)).collect();
        for (collider, part) in walls {
            let origin = collider.body.checked_sub(1).map(|motion| self.local(self.origins[motion as usize]));
            // A motion may take it half a period farther.
            let room = if origin.is_some() { periods.lengths } else { 0.5 * periods.lengths };
            let bounds = self.world.shapes[collider.shape as usize].aabb(&collider.place).moved(origin.unwrap_or_default());
            // An infinite wall is the same in all images.
            let is_endless = |way: Vec3| {
                let along = way.cmpne(Vec3::ZERO);
                (along & !(bounds.min.is_finite_mask() & bounds.max.is_finite_mask())).any()
            };
            let images: Vec<Vec3> = std::iter::once(Vec3::ZERO)
                .chain(periods.images().filter(|way| !is_endless(*way) && bounds.moved(*way).reaches(&periods, room)))
                .collect();
            for way in images {
                let mut image = collider.clone();
                image.place.position += way;
                self.world.colliders.push(image);
                self.parts.push(part);
            }
        }
    }
}

/// Whether some plane is not the same in all images.
pub(super) fn leans(scene: &Scene) -> bool {
    let planes = scene.polygons().iter().filter(|polygon| polygon.surface == Surface::Plane);
    let leans = |axis: usize, normal: DVec3| scene.periodic()[axis].is_some() && normal[axis].abs() > UPRIGHT;
    let mut normals = planes.map(|plane| plane.left.as_dvec3().cross(plane.right.as_dvec3()).normalize_or_zero());
    normals.any(|normal| (0..3).any(|axis| leans(axis, normal)))
}

/// Whether some motion turns about another axis than a periodic one.
pub(super) fn turns_across(scene: &Scene) -> bool {
    let is_other = |periodic: usize, turned: DVec3| {
        scene.periodic()[periodic].is_some() && turned.normalize_or_zero()[periodic].abs() < 1.0 - UPRIGHT
    };
    let terms = scene.motions().iter().flat_map(|motion| &motion.terms).filter(|term| term.spin != 0.0);
    terms.map(|term| term.axis).any(|turned| (0..3).any(|axis| is_other(axis, turned)))
}
