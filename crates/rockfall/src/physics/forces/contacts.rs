//! The contact forces on a sphere and on the ends of a rod, for all contact laws (docs/physics section 4).

use glam::{Vec3, Vec4};

use crate::model::counters::Tally;
use crate::model::lanes::first_lanes;
use crate::model::layout::{FLAG_CONTINUOUS, LAW_THESIS};
use crate::model::lists::{Entry, Lists};
use crate::model::view::View;
use crate::physics::balls::{Ball, Meeting};
use crate::physics::chain::touch;
use crate::physics::contact::{ContactForce, contact_force, contact_forces};
use crate::physics::laws::before::spring_before;
use crate::physics::laws::contact::{LawForce, Spring, law_force};
use crate::physics::laws::history::{Histories, Owned, key, owner, pack};
use crate::physics::laws::neck::contact;
use crate::physics::surface::Hidden;
use crate::physics::touch::Touch;

/// Force and torque on one sphere or rod.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
}

/// What the contacts of a mover follow from.
#[derive(Clone, Copy)]
pub(crate) struct Contacts<'a> {
    pub(crate) view: &'a View<'a>,
    pub(crate) lists: &'a Lists<'a>,
    /// The springs before the step. Not read for the law of the thesis.
    pub(crate) histories: Histories<'a>,
}

impl Contacts<'_> {
    /// Evaluates the contact of objects a and b, of which a was added first. The last part is the spring after the step, for laws with
    /// history. Returns `None` if the objects do not touch.
    pub(crate) fn evaluate(&self, a: u32, b: u32, feature: u32) -> Option<(Touch, ContactForce<Vec3>, Option<Spring>)> {
        let Self { view, lists, histories, .. } = self;
        if view.step.layout.law == LAW_THESIS {
            let touch = touch(view, a, b, feature)?;
            let loads = contact_force(view, lists, [a, b], &touch);
            return Some((touch, loads, None));
        }
        let touch = contact(view, histories, a, b, feature)?;
        let before = spring_before(view, histories, [a, b], feature, &touch);
        let LawForce { loads, spring, .. } = law_force(view, [a, b], &touch, before);
        Some((touch, loads, Some(spring)))
    }

    /// Calls `take` for every contact of a mover, in the order of its list, starting at entry `from`. The arguments are the load on
    /// the mover and, if it is a rod, the parameter of the contact on it. `tally` counts the contacts in which the mover is A. The
    /// springs that the mover owns are added to `owned`.
    fn each(&self, mover: u32, from: u32, owned: &mut Owned, mut tally: Option<&mut Tally>, mut take: impl FnMut(Load, f32)) {
        let (count, list) = self.lists.list(mover);
        let hidden = Hidden::of(self.view, mover, count, &list);
        for entry in (from..count).map(list).filter(|entry| !hidden.has(entry)) {
            let (a, b) = self.view.ordered(mover, entry.id());
            let Some((touch, loads, spring)) = self.evaluate(a, b, entry.feature()) else {
                continue;
            };
            if let Some(spring) = spring.filter(|_| owner(self.view, a, b) == mover) {
                owned.push(pack(key(self.view, entry.id(), entry.feature()), &spring));
            }
            let ContactForce { force, torque_a, torque_b } = loads;
            if mover == a {
                if let Some(tally) = tally.as_deref_mut().filter(|_| self.counts(a, b)) {
                    tally.count_contact(touch.overlap);
                }
                take(Load { force, torque: torque_a }, touch.a);
            } else {
                take(Load { force: -force, torque: torque_b }, touch.b);
            }
        }
    }

    /// Returns the loads on both ends of a rod. Each contact is evaluated once, and its load is shared by 1 - a and a.
    pub(crate) fn rod_loads(&self, rod: u32, owned: &mut Owned, tally: Option<&mut Tally>) -> [Load; 2] {
        let mut ends = [Load::default(); 2];
        self.each(self.view.step.layout.spheres + rod, 0, owned, tally, |load, parameter| {
            for (end, share) in ends.iter_mut().zip([1.0 - parameter, parameter]) {
                end.force += share * load.force;
                end.torque += share * load.torque;
            }
        });
        ends
    }

    /// Returns the load of the contacts of a sphere.
    #[inline]
    pub(crate) fn sphere_load(&self, sphere: u32, owned: &mut Owned, mut tally: Option<&mut Tally>) -> Load {
        let (count, list) = self.lists.list(sphere);
        if count == 0 {
            return Load::default();
        }
        let mut sums = [Vec4::ZERO; 2];
        let is_plain = self.view.step.layout.law == LAW_THESIS;
        let done = Ball::new(self.view, sphere).filter(|_| is_plain).map_or(0, |ball| {
            let mut tally = tally.as_deref_mut().filter(|_| self.view.is_own(sphere));
            ball.for_each_near(count, list, |others| add_ball_loads(&ball, others, tally.as_deref_mut(), &mut sums))
        });
        let [force, torque] = sums.map(Vec4::truncate);
        let mut total = Load { force, torque };
        self.each(sphere, done, owned, tally, |load, _| {
            total.force += load.force;
            total.torque += load.torque;
        });
        total
    }

    /// Whether this process counts the contact of objects a and b, of which a was added first and is a sphere if there are several
    /// processes. The process counts it that owns the first of its moving spheres.
    fn counts(&self, a: u32, b: u32) -> bool {
        let is_moving = |id: u32| id < self.view.step.layout.spheres && !self.view.is_fixed(id);
        self.view.is_own(if !is_moving(a) && is_moving(b) { b } else { a })
    }

    /// Counts the contacts of a fixed sphere, without evaluating their forces.
    pub(crate) fn count(&self, sphere: u32, tally: &mut Tally) {
        let view = self.view;
        for entry in self.lists.row(sphere).filter(|entry| view.insertion_index(entry.id()) > view.insertion_index(sphere)) {
            let touch = touch(view, sphere, entry.id(), entry.feature()).filter(|_| self.counts(sphere, entry.id()));
            if let Some(touch) = touch {
                tally.count_contact(touch.overlap);
            }
        }
    }
}

/// Adds the loads of up to four contacts of a sphere with other spheres, in their order, to `force` and `torque`. Contacts
/// without an overlap add 0. There are no branches, because processors would often mispredict which pairs overlap.
#[inline]
fn add_ball_loads(ball: &Ball, others: &[Entry], tally: Option<&mut Tally>, [force, torque]: &mut [Vec4; 2]) {
    let Meeting { a, b, touches } = ball.meet(others);
    let loads = contact_forces(ball.view.step, &a, &b, &touches, &ball.surfaces(others));
    let mut touch = touches.overlap.cmpgt(Vec4::ZERO) & first_lanes(others.len());
    if ball.view.step.constants.flags & FLAG_CONTINUOUS != 0 {
        touch &= ball.have_lasted(others);
    }
    *force = loads.force.or_zero(touch).add_lanes_to(*force);
    *torque = loads.torque_a.or_zero(touch).add_lanes_to(*torque);
    if let Some(tally) = tally {
        let overlaps = others.iter().zip(touches.overlap.to_array());
        for (_, overlap) in overlaps.filter(|(other, overlap)| *overlap > 0.0 && ball.is_first(other.id())) {
            tally.count_contact(overlap);
        }
    }
}
