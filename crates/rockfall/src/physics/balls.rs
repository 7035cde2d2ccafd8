//! Contacts of a sphere without rods with other spheres, four at a time. In most scenes, nearly all contacts are of this kind.
//! They need no case distinctions.

use glam::{BVec4A, Vec4};

use crate::model::lanes::{LANES, Vec3x4};
use crate::model::lists::Entry;
use crate::model::view::{Object, TINY, View};
use crate::physics::chain::is_covered;
use crate::physics::contact::{Approach, Sides, Touches, collision_velocity};
use crate::physics::first_contact::time_of_beginning;
use crate::physics::pairs::Surfaces;
use crate::physics::side::side;
use crate::physics::touch::{ROUNDING, Touch};

/// A sphere without rods.
pub(crate) struct Ball<'a, 'b> {
    pub(crate) view: &'b View<'a>,
    sphere: u32,
    place: Vec4,
    sides: Sides,
}

/// The contacts of a sphere with up to four others.
pub(crate) struct Meeting {
    /// The sphere itself, repeated four times.
    pub(crate) a: Sides,
    /// The other spheres.
    pub(crate) b: Sides,
    /// Normals from the sphere to the others. Overlaps may be 0 or negative.
    pub(crate) touches: Touches,
}

impl<'a, 'b> Ball<'a, 'b> {
    /// Returns `None` for a sphere with rods, because it must ignore the spheres at the other ends of its rods, where positions
    /// have a low part, which this code leaves out, and in scenes with rigid bodies, whose masses depend on the normal.
    #[inline]
    pub(crate) fn new(view: &'b View<'a>, mover: u32) -> Option<Self> {
        (view.is_ball(mover) && !view.step.is_double() && view.step.layout.rigid_bodies == 0).then(|| Self {
            view,
            sphere: mover,
            place: view.place(mover),
            sides: Sides::splat(&side(view, Object::Sphere(mover), 0.0)),
        })
    }

    /// Which of the contacts with up to four other spheres did not begin within the step.
    pub(crate) fn have_lasted(&self, others: &[Entry]) -> BVec4A {
        let mut lasted = [0.0; LANES];
        for (lane, other) in lasted.iter_mut().zip(others) {
            let [a, b] = [self.sphere, other.id()].map(|sphere| side(self.view, Object::Sphere(sphere), 0.0));
            let began = time_of_beginning(self.view, self.sphere, other.id(), collision_velocity(self.view.step, &a, &b));
            *lane = if began.is_some() { 0.0 } else { 1.0 };
        }
        Vec4::from_array(lasted).cmpgt(Vec4::ZERO)
    }

    /// Calls `take` with the spheres of a list that are near enough to overlap, up to four at a time. Most spheres are not. The
    /// test has some slack, so the exact test decides about spheres at the limit. `count` is the length of the list. Returns
    /// the number of spheres in the list, which are its first entries.
    #[inline]
    pub(crate) fn for_each_near(&self, mut count: u32, entry: impl Fn(u32) -> Entry, mut take: impl FnMut(&[Entry])) -> u32 {
        while count > 0 && entry(count - 1).id() >= self.view.step.layout.spheres {
            count -= 1;
        }
        let (own, radius) = (Vec3x4::splat(self.place.truncate()), Vec4::splat(self.place.w));
        let mut near = [Entry::default(); 2 * LANES];
        let mut found = 0;
        for place in (0..count).step_by(LANES) {
            let four: [Entry; LANES] = std::array::from_fn(|lane| entry((place + lane as u32).min(count - 1)));
            let (others, radii) = Vec3x4::from_rows(four.map(|entry| self.view.place(entry.id())));
            let (d, reach) = (others - own, radii + radius);
            let bits = d.dot(d).cmple(1.00001 * (reach * reach)).bitmask();
            // There are no branches here, because processors would often mispredict them.
            for (lane, entry) in (0..).zip(four) {
                near[found % (2 * LANES)] = entry;
                found += usize::from((bits >> lane & 1 == 1) & (place + lane < count));
            }
            if found >= LANES {
                take(&near[..LANES]);
                near.copy_within(LANES.., 0);
                found -= LANES;
            }
        }
        if found > 0 {
            take(&near[..found]);
        }
        count
    }

    /// Whether the sphere was added before another object.
    pub(crate) fn is_first(&self, other: u32) -> bool {
        self.view.insertion_index(self.sphere) < self.view.insertion_index(other)
    }

    /// The friction of the contacts with one to four other spheres, in the lanes of [`Ball::meet`].
    #[inline]
    pub(crate) fn surfaces(&self, others: &[Entry]) -> Surfaces {
        Surfaces::of(self.view, self.sphere, std::array::from_fn(|lane| others.get(lane).unwrap_or(&others[0]).id()))
    }

    /// Evaluates the contacts with one to four other spheres. Unused lanes repeat the first sphere.
    #[inline]
    pub(crate) fn meet(&self, others: &[Entry]) -> Meeting {
        let view = self.view;
        let others = std::array::from_fn(|lane| others.get(lane).unwrap_or(&others[0]).id());
        let (position, radius) = Vec3x4::from_rows(others.map(|other: u32| view.place(other)));
        let (velocity, inverse_mass) = Vec3x4::from_rows(others.map(|other| view.motion(other)));
        let (momentum, inverse_inertia) = Vec3x4::from_rows(others.map(|other| view.rotation(other)));
        let d = position - Vec3x4::splat(self.place.truncate());
        let dd = d.dot(d);
        let coincide = dd.cmple(Vec4::splat(TINY));
        let distance = Vec4::select(coincide, Vec4::ZERO, dd.sqrt());
        let mut normal = d / distance;
        if coincide.any() {
            // Where the centres coincide, the normal is +y from the sphere that was added first to the other.
            let up = others.map(|other| if self.is_first(other) { 1.0 } else { -1.0 });
            normal = Vec3x4 {
                x: Vec4::select(coincide, Vec4::ZERO, normal.x),
                y: Vec4::select(coincide, Vec4::from_array(up), normal.y),
                z: Vec4::select(coincide, Vec4::ZERO, normal.z),
            };
        }
        let touches = Touches { normal, overlap: Vec4::splat(self.place.w) + radius - distance };
        Meeting {
            a: self.sides,
            b: Sides {
                inverse_mass,
                inverse_inertia: Vec4::select(inverse_mass.cmpgt(Vec4::ZERO), inverse_inertia, Vec4::ZERO),
                velocity,
                spin: momentum * inverse_inertia,
                radius: Some(radius),
                free_acceleration: Vec4::from_array(others.map(|other| view.free_acceleration(Object::Sphere(other)))),
            },
            touches: if view.step.layout.rods > 0 { self.uncovered(others, touches) } else { touches },
        }
    }

    /// Contacts with four spheres, where an overlap is set to 0 if the chain of the other sphere covers the contact.
    #[inline(never)]
    fn uncovered(&self, others: [u32; LANES], mut touches: Touches) -> Touches {
        let mut overlaps = touches.overlap.to_array();
        for ((other, normal), overlap) in others.into_iter().zip(touches.normal.to_rows()).zip(&mut overlaps) {
            let touch = Touch { normal, overlap: *overlap, a: 0.0, b: 0.0 };
            let [own, other] = [self.sphere, other].map(Object::Sphere);
            if *overlap > 0.0 && is_covered(self.view, own, other, &touch) {
                *overlap = 0.0;
            }
        }
        touches.overlap = Vec4::from_array(overlaps);
        touches
    }
}

impl Meeting {
    /// The smaller radius of each pair, which the thresholds refer to.
    fn smaller_radius(&self) -> Vec4 {
        let [a, b] = [&self.a, &self.b].map(|sides| sides.radius.unwrap_or(Vec4::ZERO));
        a.min(b)
    }

    /// Which contacts are pressed (docs/physics section 3.1).
    #[inline]
    pub(crate) fn are_pressed(&self) -> BVec4A {
        let can_move = (self.a.inverse_mass + self.b.inverse_mass).cmpgt(Vec4::ZERO);
        self.touches.overlap.cmpgt(ROUNDING * self.smaller_radius()) & can_move
    }

    /// Which contacts have an approach velocity above the threshold.
    #[inline]
    pub(crate) fn collide(&self, view: &View) -> BVec4A {
        let approach = Approach::of(view.step, &self.a, &self.b, self.touches.normal);
        approach.velocity.cmpgt(approach.threshold)
    }
}
