//! Corrections of rods of fixed length: sweeps over the coloured rods of a batch (docs/physics section 5.4).

use glam::{Vec3, Vec4};

use crate::fine::Fine;
use crate::model::layout::ROD_WORDS;
use crate::model::step::Step;
use crate::model::view::{RodRecord, TINY};

/// Largest relative error at which the sweeps end. With 1e-3 a double pendulum loses 4 % of its energy in 100 s.
const TOLERANCE: f32 = 1e-5;
/// Maximum number of sweeps. Errors that remain are corrected in the following steps.
const MAX_SWEEPS: u32 = 400;
/// A difference of two numbers counts as a rounding error when it is at most this times the sum of their sizes.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// A correction of the two ends of a rod, before the multiplication by their inverse masses: end 1 changes by `w1` times the
/// vectors, end 2 by `-w2` times the vectors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Correction {
    pub(crate) position: Vec3,
    pub(crate) velocity: Vec3,
    /// Relative error before the correction.
    pub(crate) error: f32,
}

/// The present state of the two ends of a rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    /// From end 1 to end 2.
    pub(crate) d: Vec3,
    /// Velocity of end 2 minus velocity of end 1.
    pub(crate) velocity: Vec3,
    /// Sum of the inverse masses, positive.
    pub(crate) inverse_mass: f32,
    pub(crate) length: f32,
    /// Sum of the largest absolute coordinates of both ends, which determines the rounding error of the distance.
    pub(crate) place_size: f32,
    /// Sum of the largest absolute velocity components of both ends.
    pub(crate) velocity_size: f32,
}

/// Returns the relative error of a rod, and 0 when it is only a rounding error, which no sweep can remove. `size` is the size
/// of the numbers that `error` is a difference of.
fn unrounded(error: f32, size: f32, length: f32) -> f32 {
    if error.abs() <= ROUNDING * size { 0.0 } else { error.abs() / length }
}

/// Returns the velocity of a sphere's centre. The velocity of a fixed sphere is that of its surface, and its centre is at rest.
fn own_velocity(row: Vec4) -> Vec3 {
    if row.w == 0.0 { Vec3::ZERO } else { row.truncate() }
}

fn unit(d: Vec3) -> (Vec3, f32) {
    let dd = d.length_squared();
    if dd <= TINY { (Vec3::Y, 0.0) } else { (d / dd.sqrt(), dd.sqrt()) }
}

/// Removes the length error along the present direction of the rod, in positions only.
pub(crate) fn along_axis(ends: &Ends) -> Correction {
    let (n, distance) = unit(ends.d);
    let excess = distance - ends.length;
    let error = unrounded(excess, ends.place_size, ends.length);
    Correction { position: n * (excess / ends.inverse_mass), velocity: Vec3::ZERO, error }
}

/// SHAKE: removes the length error along the direction at the start of the step, in positions and velocities.
/// |d - g w d_old| = l is a quadratic equation for g. The root near 0 is used.
pub(crate) fn shake(ends: &Ends, d_old: Vec3, dt: f32) -> Correction {
    let w = ends.inverse_mass;
    let a = w * w * d_old.length_squared();
    let b = w * ends.d.dot(d_old);
    let c = ends.d.length_squared() - ends.length * ends.length;
    let discriminant = b * b - a * c;
    if !(discriminant >= 0.0 && b > 0.0) {
        // The rod has turned too far within the step for a correction along the old direction.
        return along_axis(ends);
    }
    let g = c / (b + discriminant.sqrt());
    let error = unrounded(ends.d.length() - ends.length, ends.place_size, ends.length);
    Correction { position: g * d_old, velocity: (g / dt) * d_old, error }
}

/// RATTLE: removes the relative velocity along the axis.
pub(crate) fn rattle(ends: &Ends, dt: f32) -> Correction {
    let (n, _) = unit(ends.d);
    let opening = ends.velocity.dot(n);
    let error = unrounded(opening, ends.velocity_size, ends.length) * dt;
    Correction { position: Vec3::ZERO, velocity: n * (opening / ends.inverse_mass), error }
}

/// Adds a change to a row, unless the result is not finite.
fn add(row: &mut Vec4, change: Vec3) {
    let sum = row.truncate() + change;
    if sum.is_finite() {
        *row = sum.extend(row.w);
    }
}

/// Moves a sphere and keeps the low part of its position, unless the result is not finite.
fn displace(state: &mut [Vec4], spheres: usize, sphere: usize, by: Vec3) {
    let Fine { high, low } = place(state, spheres, sphere).moved(by);
    if high.is_finite() {
        state[sphere] = high.extend(state[sphere].w);
        state[3 * spheres + sphere] = low.extend(0.0);
    }
}

/// The position of a sphere, with its low part.
fn place(state: &[Vec4], spheres: usize, sphere: usize) -> Fine {
    Fine { high: state[sphere].truncate(), low: state[3 * spheres + sphere].truncate() }
}

/// One batch of rods, which are corrected colour by colour. Rods of one colour share no moving sphere.
pub(crate) struct Batch<'a> {
    topology: &'a [u32],
    first: usize,
}

impl<'a> Batch<'a> {
    pub(crate) fn new(step: &Step, topology: &'a [u32], batch: u32) -> Self {
        Self { topology, first: topology[(step.layout.batches_at + batch) as usize] as usize }
    }

    fn colours(&self) -> usize {
        self.topology[self.first] as usize
    }

    fn rods(&self) -> impl Iterator<Item = u32> + use<'a> {
        let offset = |place: usize| self.topology[self.first + 1 + place] as usize;
        self.topology[offset(0)..offset(self.colours())].iter().copied()
    }

    /// Corrects all rods, colour after colour, until the largest error that a sweep finds is within the tolerance. A batch of a
    /// single colour is exact after one sweep.
    pub(crate) fn sweep(&self, step: &Step, state: &mut [Vec4], correct: impl Fn(&Ends, [u32; 2]) -> Correction) {
        for _ in 0..MAX_SWEEPS {
            let mut worst: f32 = 0.0;
            for rod in self.rods() {
                worst = worst.max(self.visit(step, state, rod, &correct));
            }
            if self.colours() == 1 || worst <= TOLERANCE {
                return;
            }
        }
    }

    fn visit(&self, step: &Step, state: &mut [Vec4], rod: u32, correct: impl Fn(&Ends, [u32; 2]) -> Correction) -> f32 {
        let rod = self.rod(step, rod);
        let n = step.layout.spheres as usize;
        let [one, two] = rod.ends.map(|end| end as usize);
        let (w1, w2) = (state[n + one].w, state[n + two].w);
        if w1 + w2 == 0.0 {
            return 0.0;
        }
        let (v1, v2) = (own_velocity(state[n + one]), own_velocity(state[n + two]));
        let size = |one: Vec3, two: Vec3| one.abs().max_element() + two.abs().max_element();
        let ends = Ends {
            d: if step.is_double() {
                place(state, n, two).minus(place(state, n, one))
            } else {
                (state[two] - state[one]).truncate()
            },
            velocity: v2 - v1,
            inverse_mass: w1 + w2,
            length: rod.length,
            place_size: size(state[one].truncate(), state[two].truncate()),
            velocity_size: size(v1, v2),
        };
        let Correction { position, velocity, error } = correct(&ends, rod.ends);
        displace(state, n, one, w1 * position);
        displace(state, n, two, -w2 * position);
        add(&mut state[n + one], w1 * velocity);
        add(&mut state[n + two], -w2 * velocity);
        error
    }

    fn rod(&self, step: &Step, rod: u32) -> RodRecord {
        let at = (step.layout.rods_at + rod * ROD_WORDS) as usize;
        let [end1, end2, radius, length] = std::array::from_fn(|word| self.topology[at + word]);
        RodRecord { ends: [end1, end2], radius: f32::from_bits(radius), length: f32::from_bits(length) }
    }
}
