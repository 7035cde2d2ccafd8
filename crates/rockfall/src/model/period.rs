//! Periodic boundaries: the nearest image of a position (docs/physics.md section 2.14).

use glam::{DVec3, Vec3};

use crate::fine::Fine;
use crate::model::layout::FLAG_PERIODIC;
use crate::model::step::{Aabb, Step};

/// The periods of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Periods {
    /// Period along each axis, 0 where the scene is not periodic.
    length: DVec3,
    /// Whole periods are counted from here for positions in the box.
    from: DVec3,
}

impl Periods {
    /// `None` in scenes without periodic boundaries.
    pub(crate) fn of(step: &Step) -> Option<Self> {
        let bounds = || {
            let layout = &step.layout;
            let length = Vec3::new(layout.period_x, layout.period_y, layout.period_z).as_dvec3();
            Self { length, from: Vec3::new(layout.from_x, layout.from_y, layout.from_z).as_dvec3() }
        };
        (step.constants.flags & FLAG_PERIODIC != 0).then(bounds)
    }

    /// The whole periods in a vector: those that its nearest image lacks.
    fn whole(&self, d: DVec3) -> DVec3 {
        let turns = |axis: usize| {
            let length = self.length[axis];
            if length > 0.0 { length * (d[axis] / length).round_ties_even() } else { 0.0 }
        };
        DVec3::from_array(std::array::from_fn(turns))
    }

    /// The nearest image of a vector.
    pub(crate) fn nearest(&self, d: DVec3) -> DVec3 {
        d - self.whole(d)
    }

    /// The image of a position that is nearest to a place.
    pub(crate) fn near(&self, place: DVec3, position: Fine) -> Fine {
        let whole = self.whole(position.wide() - place);
        Fine::at((position.wide() - whole).to_array())
    }

    /// The image of an AABB whose centre is in the box.
    pub(crate) fn brought_back(&self, aabb: Aabb) -> Aabb {
        let centre = 0.5 * (Vec3::from_array(aabb.min).as_dvec3() + Vec3::from_array(aabb.max).as_dvec3());
        let turns = |axis: usize| {
            let length = self.length[axis];
            if length > 0.0 { length * ((centre[axis] - self.from[axis]) / length).floor() } else { 0.0 }
        };
        aabb.moved(-DVec3::from_array(std::array::from_fn(turns)).as_vec3())
    }

    /// The image of an AABB that is nearest to another one.
    pub(crate) fn near_aabb(&self, place: &Aabb, aabb: &Aabb) -> Aabb {
        aabb.moved(-self.whole((aabb.centre() - place.centre()).as_dvec3()).as_vec3())
    }

    /// Whether an AABB, grown by a length, reaches the box.
    pub(crate) fn reaches(&self, aabb: &Aabb, length: f32) -> bool {
        let [from, period] = [self.from, self.length].map(DVec3::as_vec3);
        let is_beyond = |axis: usize| {
            period[axis] > 0.0 && (aabb.max[axis] + length < from[axis] || aabb.min[axis] - length > from[axis] + period[axis])
        };
        !(0..3).any(is_beyond)
    }

    /// The displacements of the images of an object in the box that may reach into the box: those by one period, or by none, along each
    /// axis.
    pub(crate) fn images(&self) -> impl Iterator<Item = Vec3> + use<> {
        let length = self.length.as_vec3();
        let turns = move |axis: usize| if length[axis] > 0.0 { -1_i8..=1 } else { 0..=0 };
        let all = turns(0).flat_map(move |x| turns(1).flat_map(move |y| turns(2).map(move |z| [x, y, z])));
        all.map(move |turns| Vec3::from_array(turns.map(f32::from)) * length)
    }
}
