//! Periodic boundaries: the nearest image of a position (docs/physics section 2.14).

use glam::{DVec3, Vec3};

use crate::fine::Fine;
use crate::model::layout::{FLAG_PERIODIC, FLAG_SHEARED};
use crate::model::step::{Aabb, Constants, Step};
use crate::phase::{turns, wide};

/// The periods of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Periods {
    /// Period along each axis, 0 where the scene is not periodic.
    length: DVec3,
    /// Whole periods are counted from here for positions in the box.
    from: DVec3,
    slide: Option<Slide>,
}

/// How the images of a sheared scene slide along the box.
#[derive(Clone, Copy, Debug)]
struct Slide {
    gradient: usize,
    flow: usize,
    /// Displacement of the box above along the flow.
    offset: f64,
    /// Its velocity.
    speed: f64,
}

impl Slide {
    fn of(step: &Step) -> Option<Self> {
        let Constants { flags, shear_low, shear_high, .. } = step.constants;
        if flags & FLAG_SHEARED == 0 {
            return None;
        }
        let layout = &step.layout;
        let (gradient, flow) = (layout.shear_axes as usize % 4, layout.shear_axes as usize / 4);
        let period = [layout.period_x, layout.period_y, layout.period_z][flow];
        let offset = turns(wide([shear_low, shear_high])) * f64::from(period);
        Some(Self { gradient, flow, offset, speed: layout.shear_speed.into() })
    }
}

impl Periods {
    /// `None` in scenes without periodic boundaries.
    pub(crate) fn of(step: &Step) -> Option<Self> {
        let bounds = || {
            let layout = &step.layout;
            let length = Vec3::new(layout.period_x, layout.period_y, layout.period_z).as_dvec3();
            let from = Vec3::new(layout.from_x, layout.from_y, layout.from_z).as_dvec3();
            Self { length, from, slide: Slide::of(step) }
        };
        (step.constants.flags & FLAG_PERIODIC != 0).then(bounds)
    }

    /// Those of a scene that is not sheared.
    pub(crate) fn unsheared(bounds: [Option<[f32; 2]>; 3]) -> Option<Self> {
        let [from, to] =
            [0, 1].map(|end| DVec3::from_array(bounds.map(|bounds| bounds.map_or(0.0, |bounds| bounds[end].into()))));
        (bounds != [None; 3]).then_some(Self { length: to - from, from, slide: None })
    }

    /// The displacement of the image that is nearest to a vector: whole periods, and the slide of as many boxes.
    pub(crate) fn whole(&self, d: DVec3) -> DVec3 {
        self.displacement(|axis, slid| (d[axis] - slid) / self.length[axis], f64::round_ties_even)
    }

    /// The displacement of an image. `turns` gives the periods in a component after it slid by a length, and `round` the whole ones among
    /// them.
    fn displacement(&self, turns: impl Fn(usize, f64) -> f64, round: impl Fn(f64) -> f64) -> DVec3 {
        let whole = |axis: usize, slid: f64| if self.length[axis] > 0.0 { round(turns(axis, slid)) } else { 0.0 };
        let mut slid = DVec3::ZERO;
        if let Some(Slide { gradient, flow, offset, .. }) = self.slide {
            slid[flow] = whole(gradient, 0.0) * offset;
        }
        DVec3::from_array(std::array::from_fn(|axis| slid[axis] + self.length[axis] * whole(axis, slid[axis])))
    }

    /// The velocity of the image that is nearest to a vector, relative to that of the body itself. 0 unless the scene is sheared.
    pub(crate) fn velocity_of_nearest(&self, d: DVec3) -> Vec3 {
        self.velocity_of_boxes(|gradient| (d[gradient] / self.length[gradient]).round_ties_even())
    }

    /// The velocity of the image in the box, relative to that of the body itself.
    pub(crate) fn velocity_in_box(&self, position: Vec3) -> Vec3 {
        self.velocity_of_boxes(|axis| ((f64::from(position[axis]) - self.from[axis]) / self.length[axis]).floor())
    }

    fn velocity_of_boxes(&self, boxes: impl Fn(usize) -> f64) -> Vec3 {
        let mut velocity = Vec3::ZERO;
        if let Some(Slide { gradient, flow, speed, .. }) = self.slide {
            velocity[flow] = -(boxes(gradient) * speed) as f32;
        }
        velocity
    }

    /// How far the images of a sheared scene slide in a time, in s.
    pub(crate) fn slide_in(&self, time: f32) -> f32 {
        self.slide.map_or(0.0, |slide| slide.speed.abs() as f32 * time)
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
        let way = self.displacement(|axis, slid| (centre[axis] - slid - self.from[axis]) / self.length[axis], f64::floor);
        aabb.moved(-way.as_vec3())
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
        let (length, slide) = (self.length.as_vec3(), self.slide);
        let turns = move |axis: usize| if length[axis] > 0.0 { -1_i8..=1 } else { 0..=0 };
        let all = turns(0).flat_map(move |x| turns(1).flat_map(move |y| turns(2).map(move |z| [x, y, z])));
        all.map(move |turns| {
            let mut way = Vec3::from_array(turns.map(f32::from)) * length;
            if let Some(Slide { gradient, flow, offset, .. }) = slide {
                way[flow] += f32::from(turns[gradient]) * offset as f32;
            }
            way
        })
    }
}
