//! Periodic boundaries of hard contacts (docs/physics section 11.1).

use glam::{DVec3, IVec3, Vec3};

/// The box of a periodic scene in coordinates of the world. All zero without periodic boundaries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Periods {
    /// The period along each axis, in units; 0 along an axis that is not periodic.
    pub(crate) lengths: Vec3,
    /// The lower corner of the box.
    pub(crate) least: Vec3,
}

impl Periods {
    /// Whether any axis is periodic.
    pub(crate) fn any(&self) -> bool {
        self.lengths != Vec3::ZERO
    }

    /// 1 over the periods; 0 along an axis that is not periodic.
    pub(crate) fn inverse(&self) -> Vec3 {
        Vec3::select(self.lengths.cmpgt(Vec3::ZERO), self.lengths.recip(), Vec3::ZERO)
    }

    /// How many periods a point is away from the box.
    pub(crate) fn outside(&self, point: Vec3) -> IVec3 {
        ((point - self.least) * self.inverse()).floor().as_ivec3()
    }

    /// What moves the end of a way to its image nearest to the start.
    pub(crate) fn nearest(&self, way: Vec3) -> Vec3 {
        -self.lengths * (way * self.inverse() + 0.5).floor()
    }

    /// The same in double precision.
    pub(crate) fn nearest_finely(&self, way: DVec3) -> DVec3 {
        -self.lengths.as_dvec3() * (way * self.inverse().as_dvec3() + 0.5).floor()
    }

    /// So many periods, in units.
    pub(crate) fn ways(&self, count: IVec3) -> DVec3 {
        self.lengths.as_dvec3() * count.as_dvec3()
    }

    /// The displacements of the images next to the box.
    pub(crate) fn images(&self) -> impl Iterator<Item = Vec3> + '_ {
        let steps = |axis: usize| if self.lengths[axis] > 0.0 { -1..=1 } else { 0..=0 };
        let all = steps(0).flat_map(move |x| steps(1).flat_map(move |y| steps(2).map(move |z| IVec3::new(x, y, z))));
        all.filter(|step| *step != IVec3::ZERO).map(|step| self.ways(step).as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_end_at_the_nearest_image() {
        let periods = Periods { lengths: Vec3::new(10.0, 0.0, 4.0), least: Vec3::new(-5.0, 0.0, 2.0) };
        assert_eq!(periods.nearest(Vec3::new(9.0, 99.0, -3.0)), Vec3::new(-10.0, 0.0, 4.0));
        assert_eq!(periods.nearest(Vec3::new(4.9, -7.0, 1.9)), Vec3::ZERO);
        assert_eq!(periods.outside(Vec3::new(5.0, -3.0, 1.9)), IVec3::new(1, 0, -1));
        assert_eq!(periods.images().count(), 8);
        assert!(periods.any() && !Periods::default().any());
    }
}
