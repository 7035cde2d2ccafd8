//! Joints between bodies (docs/physics section 11.14).

use std::collections::HashSet;

use glam::{Quat, Vec3};

/// Which motions a joint takes away, and which one is left to its drive. Axes are those of the joint frame of A: the first one is the
/// axis of the joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Kind {
    /// Axes along which both anchors stay together: a bit for each.
    pub(crate) linear: u8,
    /// Axes about which the bodies do not turn against each other.
    pub(crate) angular: u8,
    pub(crate) free: Free,
}

/// What the position of a joint measures, and its drive, limits and friction act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Free {
    None,
    /// The angle about the axis, in rad.
    Turn,
    /// The way along the axis, in units.
    Slide,
    /// The distance of both anchors, in units.
    Line,
}

impl Kind {
    pub(crate) const BALL: Self = Self { linear: 0b111, angular: 0, free: Free::Turn };
    pub(crate) const HINGE: Self = Self { linear: 0b111, angular: 0b110, free: Free::Turn };
    pub(crate) const SLIDER: Self = Self { linear: 0b110, angular: 0b111, free: Free::Slide };
    pub(crate) const FIXED: Self = Self { linear: 0b111, angular: 0b111, free: Free::None };
    pub(crate) const DISTANCE: Self = Self { linear: 0, angular: 0, free: Free::Line };

    /// Whether its friction and its damping resist all rotations.
    pub(crate) fn is_ball(self) -> bool {
        self.angular == 0 && self.free == Free::Turn
    }
}

/// An end of a joint in coordinates of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct End {
    pub(crate) body: u32,
    /// The anchor, from the centre of mass.
    pub(crate) place: Vec3,
    /// Turns coordinates of the joint frame into those of the body.
    pub(crate) turn: Quat,
}

/// What acts on the free axis. Forces and speeds of an axis of rotation are torques and rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    /// Least and greatest position. Infinite without limits.
    pub(crate) limits: [f32; 2],
    /// The greatest angle between both axes, in rad. Infinite without a cone.
    pub(crate) cone: f32,
    /// The position is held at `target`. For joints of the kind distance.
    pub(crate) locked: bool,
    /// Where the spring pulls to.
    pub(crate) target: f32,
    /// In force per unit of the position.
    pub(crate) stiffness: f32,
    /// In force per unit of the speed.
    pub(crate) damping: f32,
    /// A force along the axis.
    pub(crate) effort: f32,
    /// The greatest force of the spring and the effort.
    pub(crate) spring_limit: f32,
    /// In force per unit of the speed, without a bound.
    pub(crate) drag: f32,
    /// Inertia of a rotor that moves with the position.
    pub(crate) armature: f32,
    /// Speed of the motor.
    pub(crate) speed: f32,
    /// The greatest force of the motor. 0 without a motor.
    pub(crate) motor_limit: f32,
    /// The greatest force of friction.
    pub(crate) friction: f32,
}

impl Drive {
    /// Whether something depends on the rate of the axis at the end of a substep, or is an effort.
    pub(crate) fn acts(&self) -> bool {
        self.effort != 0.0 || [self.stiffness, self.damping, self.drag, self.armature].iter().any(|number| *number > 0.0)
    }

    /// Speed and greatest force of the motor at a position: in a substep of `h` it goes no farther than to its limit, and at the limit it
    /// does not push on.
    pub(crate) fn motor_at(&self, position: f32, h: f32) -> [f32; 2] {
        let [low, high] = self.limits.map(|limit| (limit - position) / h);
        match self.speed {
            speed if speed < 0.0 && low >= 0.0 || speed > 0.0 && high <= 0.0 => [0.0, 0.0],
            speed if speed < 0.0 => [speed.max(low), self.motor_limit],
            speed if speed > 0.0 => [speed.min(high), self.motor_limit],
            speed => [speed, self.motor_limit],
        }
    }
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            limits: [f32::NEG_INFINITY, f32::INFINITY],
            cone: f32::INFINITY,
            locked: false,
            target: 0.0,
            stiffness: 0.0,
            damping: 0.0,
            effort: 0.0,
            spring_limit: f32::INFINITY,
            drag: 0.0,
            armature: 0.0,
            speed: 0.0,
            motor_limit: 0.0,
            friction: 0.0,
        }
    }
}

/// A joint. Its bodies differ, and at least one has mass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joint {
    pub(crate) kind: Kind,
    /// A and B.
    pub(crate) ends: [End; 2],
    pub(crate) drive: Drive,
    /// It breaks at a greater mean force or torque of a frame.
    pub(crate) strength: [f32; 2],
    /// Its bodies collide.
    pub(crate) collides: bool,
}

/// Impulses of a substep, which the next one begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointImpulses {
    /// On B along the axes of the joint frame of A.
    pub(crate) linear: Vec3,
    /// Angular, about the axes of that frame.
    pub(crate) angular: Vec3,
    /// Of the row of a locked axis, along it.
    pub(crate) locked: f32,
    pub(crate) motor: f32,
    pub(crate) friction: f32,
    /// Of both limits and of the cone; not negative.
    pub(crate) lower: f32,
    pub(crate) upper: f32,
    pub(crate) cone: f32,
    /// Of the drive of a ball, about the axes of the joint frame of A.
    pub(crate) resistance: Vec3,
    /// Of the drive along the free axis.
    pub(crate) drive: f32,
}

impl JointImpulses {
    pub(crate) const COUNT: usize = 16;

    /// The impulses of another substep, in proportion to its length `h`. Rows that are no more have none.
    pub(crate) fn begun(self, kind: Kind, drive: &Drive, ratio: f32, h: f32) -> Self {
        let mut own = Self::from_array(self.to_array().map(|impulse| ratio * impulse));
        if own.to_array().iter().any(|impulse| !impulse.is_finite()) {
            return Self::default();
        }
        let unless = |is_gone: bool, impulse: f32| if is_gone { 0.0 } else { impulse };
        own.locked = unless(!drive.locked, own.locked);
        own.motor = within(own.motor, drive.motor_limit, h);
        own.friction = within(own.friction, drive.friction, h);
        if kind.is_ball() {
            own.angular = own.angular.clamp_length_max(h * drive.friction);
        }
        own.lower = unless(drive.limits[0] == f32::NEG_INFINITY, own.lower);
        own.upper = unless(drive.limits[1] == f32::INFINITY, own.upper);
        own.cone = unless(drive.cone == f32::INFINITY, own.cone);
        own.drive = unless(!drive.acts(), own.drive);
        if drive.damping + drive.drag + drive.armature == 0.0 {
            own.resistance = Vec3::ZERO;
        }
        own
    }

    pub(crate) fn to_array(self) -> [f32; Self::COUNT] {
        let [[a, b, c], [d, e, f], [g, h, i]] = [self.linear, self.angular, self.resistance].map(|vector| vector.to_array());
        let Self { locked, motor, friction, lower, upper, cone, drive, .. } = self;
        [a, b, c, locked, d, e, f, motor, friction, lower, upper, cone, g, h, i, drive]
    }

    pub(crate) fn from_array(all: [f32; Self::COUNT]) -> Self {
        let [a, b, c, locked, d, e, f, motor, friction, lower, upper, cone, g, h, i, drive] = all;
        let [linear, angular, resistance] = [[a, b, c], [d, e, f], [g, h, i]].map(Vec3::from_array);
        Self { linear, angular, locked, motor, friction, lower, upper, cone, resistance, drive }
    }
}

/// An impulse within those of a force in `h` seconds. The force may be infinite.
pub(crate) fn within(impulse: f32, force: f32, h: f32) -> f32 {
    if force == f32::INFINITY { impulse } else { impulse.clamp(-h * force, h * force) }
}

/// What changes of a joint in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointState {
    pub(crate) impulses: JointImpulses,
    /// The mean force and torque of the last frame that the joint exerts on B at its anchor, along the axes of the world.
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
    /// It exerts nothing any more.
    pub(crate) broken: bool,
    /// How far the spring is off in this substep.
    pub(crate) off: f32,
    /// Rate of the rotor within a frame; of a ball about the axes of the joint frame of A, otherwise the first number.
    pub(crate) rotor: Vec3,
}

impl JointState {
    const WORDS: usize = JointImpulses::COUNT + 7;

    /// Nothing of a state that is not finite.
    fn to_words(self) -> [u32; Self::WORDS] {
        let mut words = [0; Self::WORDS];
        let loads = [self.force, self.torque];
        if self.impulses.to_array().iter().any(|impulse| !impulse.is_finite()) || loads.iter().any(|load| !load.is_finite()) {
            words[Self::WORDS - 1] = u32::from(self.broken);
            return words;
        }
        let loads = [self.force, self.torque].map(|load| load.to_array());
        let numbers = self.impulses.to_array().into_iter().chain(loads.into_iter().flatten()).map(f32::to_bits);
        words.iter_mut().zip(numbers.chain([u32::from(self.broken)])).for_each(|(word, bits)| *word = bits);
        words
    }

    fn from_words(words: &[u32]) -> Option<Self> {
        let (broken, numbers) = words.split_last()?;
        let mut all = [0.0; Self::WORDS - 1];
        all.iter_mut().zip(numbers).for_each(|(number, bits)| *number = f32::from_bits(*bits));
        let (impulses, loads) = all.split_first_chunk()?;
        let [force, torque] = [0, 3].map(|first| Vec3::from_slice(&loads[first..first + 3]));
        let impulses = JointImpulses::from_array(*impulses);
        let is_limit = [impulses.lower, impulses.upper, impulses.cone].iter().all(|impulse| *impulse >= 0.0);
        let fits = all.iter().all(|number| number.is_finite()) && is_limit && *broken < 2;
        fits.then_some(Self { impulses, force, torque, broken: *broken == 1, ..Self::default() })
    }
}

/// Pairs of bodies that do not collide, in ascending order.
#[derive(Clone, Debug)]
pub(crate) struct Apart(Vec<[u32; 2]>);

impl Apart {
    pub(crate) fn contains(&self, a: u32, b: u32) -> bool {
        self.0.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}

/// All joints of a world, in order of addition.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Joints {
    pub(crate) list: Vec<Joint>,
    pub(crate) states: Vec<JointState>,
    /// Numbers of the joints in the order in which they are solved: colour by colour.
    pub(crate) order: Vec<u32>,
    /// First entry of each colour in `order`, and the end.
    pub(crate) colours: Vec<u32>,
    /// Of each joint the frequency of its rows times the substep.
    pub(crate) frequencies: Vec<f32>,
}

/// Frequency of the rows of a joint times the substep, if none of its bodies has more joints than `FEW`.
const FREQUENCY: f32 = 0.25;
/// Rows at a body with more joints are softer in proportion: stiff ones would gain energy at a light hub of heavy bodies.
const FEW: usize = 3;

impl Joints {
    /// Takes over joints. `has_mass` tells which bodies have mass: joints of one colour share none of these.
    pub(crate) fn new(list: Vec<Joint>, has_mass: &[bool]) -> Self {
        // Of each body the colours of its joints, and the least one that it has not.
        let mut used = vec![(HashSet::new(), 0); has_mass.len()];
        let mut sorted: Vec<Vec<u32>> = Vec::new();
        for (number, joint) in (0..).zip(&list) {
            let bodies = joint.ends.map(|end| end.body as usize);
            let heavy = bodies.into_iter().filter(|body| has_mass[*body]);
            let first = heavy.clone().map(|body| used[body].1).max().unwrap_or_default();
            let is_free = |colour: &usize| heavy.clone().all(|body| !used[body].0.contains(colour));
            let colour = (first..).find(is_free).unwrap_or_default();
            for body in heavy.clone() {
                let (colours, least) = &mut used[body];
                colours.insert(colour);
                while colours.contains(least) {
                    *least += 1;
                }
            }
            if colour == sorted.len() {
                sorted.push(Vec::new());
            }
            sorted[colour].push(number);
        }
        let mut colours = vec![0];
        colours.extend(sorted.iter().scan(0, |end, colour| {
            *end += colour.len() as u32;
            Some(*end)
        }));
        let states = vec![JointState::default(); list.len()];
        let count = |joint: &Joint| joint.ends.iter().map(|end| used[end.body as usize].0.len()).max();
        let frequency = |joint: &Joint| FREQUENCY * FEW as f32 / count(joint).unwrap_or(FEW).max(FEW) as f32;
        let frequencies = list.iter().map(frequency).collect();
        Self { list, states, order: sorted.concat(), colours, frequencies }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// What a checkpoint keeps: the number of joints, and their states.
    pub(crate) fn to_words(&self) -> Vec<u32> {
        let states = self.states.iter().flat_map(|state| state.to_words());
        std::iter::once(self.list.len() as u32).chain(states).collect()
    }

    /// Takes over the states that lead the words, if they are those of such joints. Returns the other words.
    pub(crate) fn put_words<'a>(&mut self, words: &'a [u32]) -> Option<&'a [u32]> {
        let (count, words) = words.split_first().filter(|(count, _)| **count as usize == self.list.len())?;
        let (own, others) = words.split_at_checked(*count as usize * JointState::WORDS)?;
        self.states = own.chunks_exact(JointState::WORDS).map(JointState::from_words).collect::<Option<_>>()?;
        Some(others)
    }

    /// Pairs of bodies other than the world that do not collide, each with the joint that keeps them from it, in ascending order.
    pub(crate) fn apart(&self) -> Vec<([u32; 2], u32)> {
        let apart = (0..).zip(&self.list).filter(|(_, joint)| !joint.collides);
        let bodies =
            apart.map(|(number, joint)| (joint.ends.map(|end| end.body), number)).filter(|([a, b], _)| *a > 0 && *b > 0);
        let mut pairs: Vec<([u32; 2], u32)> = bodies.map(|([a, b], number)| ([a.min(b), a.max(b)], number)).collect();
        pairs.sort_unstable();
        pairs
    }

    /// The pairs of bodies that do not collide at present.
    pub(crate) fn apart_now(&self) -> Apart {
        let present = self.apart().into_iter().filter(|(_, number)| !self.states[*number as usize].broken);
        Apart(present.map(|(pair, _)| pair).collect())
    }

    /// Marks the joints whose load of the last frame was more than they bear. Their number.
    pub(crate) fn break_loaded(&mut self) -> u32 {
        let mut broken = 0;
        for (joint, state) in self.list.iter().zip(&mut self.states) {
            let [force, torque] = joint.strength;
            if !state.broken && (state.force.length() > force || state.torque.length() > torque) {
                (state.broken, state.impulses) = (true, JointImpulses::default());
                broken += 1;
            }
        }
        broken
    }
}
