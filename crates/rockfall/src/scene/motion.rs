//! Motions of walls, as closed formulas of time (docs/physics section 2.12).

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::error::{Error, Result};
use crate::scene::checks::finite;
use crate::scene::pose::Pose;
use crate::scene::registry::Handle;
use crate::scene::servo::Servo;
use crate::scene::{Cuboid, ObjectId, Polygon, Scene};

/// Handle of a [`Motion`].
pub type MotionId = Handle<Motion>;

/// A prescribed motion, or one that seeks a force. The boxes and polygons that follow it are one rigid body, which nothing stops.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Motion {
    /// Name, which no other motion of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: String,
    /// The terms. A later one is inside the earlier ones: its axis and its directions move with them.
    pub terms: Vec<MotionTerm>,
    /// What moves the walls instead of terms until they exert a force or a torque.
    pub servo: Option<Servo>,
}

/// One term of a [`Motion`]: a translation, an oscillation and a turn, each of which may be absent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionTerm {
    /// Constant velocity, in units/s.
    pub velocity: DVec3,
    /// Amplitude of the oscillation, in units.
    pub amplitude: DVec3,
    /// Frequency of the oscillation, in 1/s, not negative.
    pub frequency: f64,
    /// Phase of the oscillation at its beginning, in turns. The displacement is 0 there in any case.
    pub phase: f64,
    /// Angular velocity about the axis, in rad/s.
    pub spin: f64,
    /// Direction of the axis. Its length does not matter, but it is not 0.
    pub axis: DVec3,
    /// A point of the axis, in units.
    pub through: DVec3,
    /// Time in s at which the term begins. Before it, the term is at rest.
    pub from: f64,
    /// Time in s at which the term ends, infinite if it does not. The walls then stay where they are.
    pub to: f64,
}

impl Default for MotionTerm {
    fn default() -> Self {
        Self {
            velocity: DVec3::ZERO,
            amplitude: DVec3::ZERO,
            frequency: 0.0,
            phase: 0.0,
            spin: 0.0,
            axis: DVec3::Z,
            through: DVec3::ZERO,
            from: 0.0,
            to: f64::INFINITY,
        }
    }
}

impl MotionTerm {
    /// A translation, with its velocity in units/s.
    pub fn translation(velocity: impl Into<DVec3>) -> Self {
        Self { velocity: velocity.into(), ..Self::default() }
    }

    /// An oscillation by an amplitude in units, with its frequency in 1/s.
    pub fn oscillation(amplitude: impl Into<DVec3>, frequency: f64) -> Self {
        Self { amplitude: amplitude.into(), frequency, ..Self::default() }
    }

    /// A turn by `spin` rad/s about an axis through a point.
    pub fn turn(spin: f64, axis: impl Into<DVec3>, through: impl Into<DVec3>) -> Self {
        Self { spin, axis: axis.into(), through: through.into(), ..Self::default() }
    }

    /// Sets the phase, in turns.
    pub fn phase(mut self, phase: f64) -> Self {
        self.phase = phase;
        self
    }

    /// Sets when the term begins and ends, in s.
    pub fn during(mut self, from: f64, to: f64) -> Self {
        (self.from, self.to) = (from, to);
        self
    }

    fn validate(&self) -> Result<()> {
        let wrong = |field, value: String, expected| Err(Error::Invalid { field, value, expected });
        let vectors = [
            ("motion.velocity", self.velocity),
            ("motion.amplitude", self.amplitude),
            ("motion.axis", self.axis),
            ("motion.through", self.through),
        ];
        for (field, vector) in vectors {
            if !vector.is_finite() {
                return wrong(field, format!("{:?}", vector.to_array()), "three finite numbers");
            }
        }
        let numbers = [
            ("motion.frequency", self.frequency),
            ("motion.phase", self.phase),
            ("motion.spin", self.spin),
            ("motion.from", self.from),
        ];
        for (field, number) in numbers {
            if !number.is_finite() {
                return wrong(field, number.to_string(), "a finite number");
            }
        }
        if self.frequency < 0.0 {
            return wrong("motion.frequency", self.frequency.to_string(), "a finite number, not negative");
        }
        if self.axis.try_normalize().is_none() {
            return wrong("motion.axis", format!("{:?}", self.axis.to_array()), "a direction, not 0");
        }
        if self.to.is_nan() || self.to < self.from {
            return wrong("motion.to", self.to.to_string(), "a time that is not before `from`");
        }
        Ok(())
    }

    /// The pose at a time.
    fn pose(&self, time: f64) -> Pose {
        let s = time.clamp(self.from, self.to) - self.from;
        let on = if time >= self.from && time < self.to { 1.0 } else { 0.0 };
        let axis = self.axis.normalize_or(DVec3::Z);
        let turn = Pose::about(axis, [self.spin * s, on * self.spin], self.through);
        let (rate, angle) = (TAU * self.frequency, TAU * (self.frequency * s + self.phase));
        let (sin, cos) = libm::sincos(angle);
        let shift = self.velocity * s + self.amplitude * (sin - libm::sin(TAU * self.phase));
        let velocity = on * (self.velocity + self.amplitude * rate * cos);
        let acceleration = on * (-rate * rate * sin * self.amplitude);
        let [place, moving, bending] = turn.shift;
        Pose { shift: [place + shift, velocity + moving, acceleration + bending], ..turn }
    }
}

impl Motion {
    /// Creates a motion of one term.
    pub fn new(name: impl Into<String>, term: MotionTerm) -> Self {
        Self { name: name.into(), terms: vec![term], servo: None }
    }

    /// Creates a motion that seeks a force or a torque.
    pub fn servo(name: impl Into<String>, servo: Servo) -> Self {
        Self { name: name.into(), terms: Vec::new(), servo: Some(servo) }
    }

    /// Adds a term inside the others.
    pub fn and(mut self, term: MotionTerm) -> Self {
        self.terms.push(term);
        self
    }

    /// A translation along straight lines, each at constant speed: at each of the times, in s, the walls are displaced from where they
    /// are written by that displacement minus the first one, in units. They rest before the first time and after the last one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are fewer than two times, not as many displacements as times, times that do not increase, or numbers
    /// that are not finite.
    pub fn table(name: impl Into<String>, times: &[f64], displacements: &[DVec3]) -> Result<Self> {
        let wrong = |value: String, expected| Err(Error::Invalid { field: "motion.times", value, expected });
        if times.len() < 2 || times.len() != displacements.len() {
            let value = format!("{} times and {} displacements", times.len(), displacements.len());
            return wrong(value, "at least two times and as many displacements");
        }
        if let Some(pair) = times.windows(2).find(|pair| !(pair[0] < pair[1] && pair[1].is_finite() && pair[0].is_finite())) {
            return wrong(format!("{pair:?}"), "finite times that increase");
        }
        let legs = times.windows(2).zip(displacements.windows(2)).map(|(times, places)| {
            let velocity = (places[1] - places[0]) / (times[1] - times[0]);
            MotionTerm::translation(velocity).during(times[0], times[1])
        });
        let motion = Self { name: name.into(), terms: legs.collect(), servo: None };
        motion.validate()?;
        Ok(motion)
    }

    /// Replaces what the motion does from a time on, in s, without a jump: terms that are under way end, terms that have not begun are
    /// removed, and the walls go on from where they are with `term`, whose directions and axis are those of the world. A term without
    /// velocity, amplitude and spin stops them. A servo ends.
    pub fn go_on(&mut self, time: f64, term: MotionTerm) {
        if let Some(servo) = self.servo.take() {
            self.terms = vec![held(&servo, time)];
        }
        self.terms.retain(|known| known.from < time);
        for known in &mut self.terms {
            known.to = known.to.min(time);
        }
        let to = if term.to > time { term.to } else { f64::INFINITY };
        self.terms.insert(0, MotionTerm { from: time, to, ..term });
    }

    pub(crate) fn validate(&self) -> Result<()> {
        super::tag::check_name("motion.name", &self.name)?;
        if let Some(servo) = &self.servo {
            if !self.terms.is_empty() {
                let (value, expected) = (format!("{} and a servo", self.terms.len()), "either terms or a servo");
                return Err(Error::Invalid { field: "motion.terms", value, expected });
            }
            return servo.validate();
        }
        if self.terms.is_empty() {
            return Err(Error::Invalid { field: "motion.terms", value: "none".to_owned(), expected: "at least one term" });
        }
        self.terms.iter().try_for_each(MotionTerm::validate)
    }

    /// The pose at a time in s. A servo is where it is now.
    pub(crate) fn pose(&self, time: f64) -> Pose {
        if let Some(servo) = &self.servo {
            return servo.pose();
        }
        self.terms.iter().fold(Pose::REST, |outer, term| outer.of_inner(&term.pose(time)))
    }

    /// A bound for the speed of a point of the body, given where it is at rest, in units/s.
    pub(crate) fn speed_bound(&self, point: DVec3) -> f64 {
        if let Some(servo) = &self.servo {
            let lever = (point - servo.through()).reject_from(servo.direction()).length();
            return servo.speed * if servo.turns() { lever } else { 1.0 };
        }
        let of_term = |term: &MotionTerm| {
            let lever = point - term.through;
            let from_axis = lever.reject_from(term.axis.normalize_or(DVec3::Z)).length();
            term.velocity.length() + TAU * term.frequency * term.amplitude.length() + term.spin.abs() * from_axis
        };
        self.terms.iter().map(of_term).sum()
    }

    /// The point to which the displacements of the body refer: one of the first axis.
    pub(crate) fn reference(&self) -> DVec3 {
        let of_terms = || self.terms.iter().find(|term| term.spin != 0.0).map_or(DVec3::ZERO, |term| term.through);
        self.servo.map_or_else(of_terms, |servo| servo.through())
    }

    /// The motion that begins where this one is after `time` seconds.
    pub(crate) fn after(&self, time: f64) -> Self {
        let terms = self.terms.iter().map(|term| MotionTerm { from: term.from - time, to: term.to - time, ..*term });
        Self { terms: terms.collect(), ..self.clone() }
    }
}

/// A term that ends at a time and leaves walls where a servo has moved them.
fn held(servo: &Servo, time: f64) -> MotionTerm {
    let (way, direction) = (servo.displacement, servo.direction());
    let term = match servo.turns() {
        true => MotionTerm::turn(way, direction, servo.through()),
        false => MotionTerm::translation(way * direction),
    };
    term.during(time - 1.0, time)
}

fn not_a_wall(field: &'static str, id: ObjectId) -> Error {
    Error::Invalid { field, value: format!("{id:?}"), expected: "a box or a polygon" }
}

/// Where the motions of a scene are at a time.
pub(crate) struct Poses<'a> {
    scene: &'a Scene,
    poses: Vec<Pose>,
}

impl Poses<'_> {
    /// A box where its motion puts it.
    pub(crate) fn of_box(&self, cuboid: &Cuboid) -> Cuboid {
        let Some(pose) = self.of(cuboid.motion) else { return *cuboid };
        Cuboid { corner: pose.corner(cuboid.corner), edges: cuboid.edges.map(|edge| pose.edge(edge)), ..*cuboid }
    }

    /// A polygon where its motion puts it.
    pub(crate) fn of_polygon(&self, polygon: &Polygon) -> Polygon {
        let Some(pose) = self.of(polygon.motion) else { return *polygon };
        let [left, right] = [polygon.left, polygon.right].map(|edge| pose.edge(edge));
        Polygon { corner: pose.corner(polygon.corner), left, right, ..*polygon }
    }

    fn of(&self, motion: Option<MotionId>) -> Option<&Pose> {
        let number = self.scene.body_number(motion).ok()? as usize;
        self.poses.get(number.checked_sub(1)?)
    }
}

impl Scene {
    /// Adds a motion, for the field `motion` of boxes and polygons.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that another motion has or that is not one word, numbers that are not finite, an axis without a
    /// direction, a negative frequency, or an end before the beginning.
    pub fn add_motion(&mut self, motion: Motion) -> Result<MotionId> {
        motion.validate()?;
        if self.find_motion(&motion.name).is_some() {
            return Err(Error::Invalid {
                field: "motion.name",
                value: motion.name,
                expected: "a name that no other motion has",
            });
        }
        Ok(self.motions.add(motion))
    }

    /// The motion of a name.
    pub fn find_motion(&self, name: &str) -> Option<MotionId> {
        let index = self.motions.objects().iter().position(|motion| motion.name == name)?;
        Some(self.motions.handle_at(index))
    }

    /// Changes the terms of a motion.
    ///
    /// # Errors
    /// As for [`Scene::add_motion`]. Nothing is changed then.
    pub fn update_motion(&mut self, id: MotionId, change: impl FnOnce(&mut Motion)) -> Result<()> {
        let mut motion = self.motions.get(id)?.clone();
        let name = motion.name.clone();
        change(&mut motion);
        motion.name = name;
        motion.validate()?;
        *self.motions.get_mut(id)? = motion;
        Ok(())
    }

    /// Lets a box or polygon follow a motion, or none. Its corner and edges stay those at rest.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] for an object or a motion that is not in the scene, [`Error::Invalid`] for another kind of object.
    pub fn set_motion(&mut self, id: impl Into<ObjectId>, motion: Option<MotionId>) -> Result<()> {
        self.body_number(motion)?;
        match id.into() {
            ObjectId::Box(id) => self.boxes.get_mut(id)?.motion = motion,
            ObjectId::Polygon(id) => self.polygons.get_mut(id)?.motion = motion,
            other => return Err(not_a_wall("motion", other)),
        }
        Ok(())
    }

    /// Sets the surface velocity of a box or polygon, in units/s.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] for an object that is not in the scene, [`Error::Invalid`] for another kind of object and for numbers that
    /// are not finite.
    pub fn set_surface_velocity(&mut self, id: impl Into<ObjectId>, velocity: impl Into<Vec3>) -> Result<()> {
        let velocity = velocity.into();
        finite("surface_velocity", velocity)?;
        match id.into() {
            ObjectId::Box(id) => self.boxes.get_mut(id)?.surface_velocity = velocity,
            ObjectId::Polygon(id) => self.polygons.get_mut(id)?.surface_velocity = velocity,
            other => return Err(not_a_wall("surface_velocity", other)),
        }
        Ok(())
    }

    /// Where all motions are at a time, in s.
    pub(crate) fn poses(&self, time: f64) -> Poses<'_> {
        Poses { scene: self, poses: self.motions().iter().map(|motion| motion.pose(time)).collect() }
    }

    /// The number of the body that follows a motion, from 1; 0 for the world, which never moves.
    pub(crate) fn body_number(&self, motion: Option<MotionId>) -> Result<u32> {
        motion.map_or(Ok(0), |id| Ok(self.motions.index(id)? as u32 + 1))
    }

    /// Makes the motions begin where they are after `time` seconds.
    pub(crate) fn advance_motions(&mut self, time: f64) {
        for motion in self.motions.objects_mut() {
            *motion = motion.after(time);
        }
    }
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
