//! The sequence of spheres of an inlet: their radii, masses and places follow from the seed, the number of the inlet and the serial
//! number of the sphere alone (docs/physics section 2.15).

use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec3};

use super::{GrainMass, Inlet, Radii, Rate, SizedBy};
use crate::scene::{Placement, Scene, ShapeId, Sphere};

/// Standard deviations beyond which radii of a log-normal distribution are left out.
const TAIL: f64 = 4.0;
/// Share of a rate by which a sum may exceed it, for the rounding of times.
const SLACK: f64 = 1e-12;

/// Uses of random numbers.
#[derive(Clone, Copy)]
enum Draw {
    Radius,
    Place,
    Orientation,
}

/// A sphere that has not appeared yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grain {
    pub(crate) radius: f32,
    pub(crate) mass: f32,
}

/// Mixes the bits of a number (SplitMix64).
fn mixed(number: u64) -> u64 {
    let x = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A number from 0 to 1, without 0 and 1, which is a function of the key alone.
fn random(key: [u64; 5]) -> f64 {
    let bits = key.into_iter().fold(0, |bits, word| mixed(bits ^ mixed(word)));
    ((bits >> 12) as f64 + 0.5) * 2.0_f64.powi(-52)
}

impl Radii {
    /// The smallest and the largest radius.
    pub(crate) fn bounds(&self, by: SizedBy) -> (f64, f64) {
        match *self {
            Self::Equal(radius) => (radius, radius),
            Self::Uniform(from, to) => (from, to),
            Self::LogNormal { median, sigma } => {
                let median = median_by_number(median, sigma, by);
                (median * (-TAIL * sigma).exp(), median * (TAIL * sigma).exp())
            }
        }
    }

    /// The radius of a sphere. `random` has independent numbers from 0 to 1, by index.
    fn radius(&self, by: SizedBy, random: impl Fn(u64) -> f64) -> f64 {
        match (*self, by) {
            (Self::Equal(radius), _) => radius,
            (Self::Uniform(from, to), SizedBy::Number) => from + (to - from) * random(0),
            (Self::Uniform(from, to), SizedBy::Mass) => {
                // The number of spheres of a radius r is in proportion to r^-3.
                let [small, large] = [from, to].map(|radius| radius.powi(-2));
                (small - (small - large) * random(0)).powf(-0.5).clamp(from, to)
            }
            (Self::LogNormal { median, sigma }, _) => {
                let normal = |index| (-2.0 * random(index).ln()).sqrt() * (TAU * random(index + 1)).cos();
                // One of 16,000 numbers is beyond the tails.
                let within = (0..).map(|pair| normal(2 * pair)).find(|number| number.abs() <= TAIL);
                median_by_number(median, sigma, by) * (sigma * within.unwrap_or(0.0)).exp()
            }
        }
    }
}

fn median_by_number(median: f64, sigma: f64, by: SizedBy) -> f64 {
    if by == SizedBy::Mass { median * (-3.0 * sigma * sigma).exp() } else { median }
}

fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

impl Inlet {
    /// The sphere with a serial number. `number` is that of the inlet in its scene, and `density` that of its material.
    pub(crate) fn grain(&self, number: usize, serial: u64, density: Option<f32>) -> Grain {
        let key = |index| [self.seed, number as u64, serial, Draw::Radius as u64, index];
        let radius = self.radii.radius(self.by, |index| random(key(index))) as f32;
        let of_density = |density: f64| density * volume(f64::from(radius));
        let mass = match (self.mass, density) {
            (GrainMass::Mass(mass), _) => mass,
            (GrainMass::Density(density), _) => of_density(density),
            (GrainMass::OfMaterial, Some(density)) => of_density(density.into()),
            (GrainMass::OfMaterial, None) => 1.0,
        };
        Grain { radius, mass: mass as f32 }
    }

    /// The place of a sphere at one of its tries, wholly inside the box.
    pub(crate) fn place(&self, number: usize, serial: u64, radius: f32, attempt: u64) -> DVec3 {
        let [low, high] = self.corners;
        let radius = f64::from(radius);
        let at = |axis: usize| {
            let random = random([self.seed, number as u64, serial, Draw::Place as u64, 3 * attempt + axis as u64]);
            low[axis] + radius + (high[axis] - low[axis] - 2.0 * radius).max(0.0) * random
        };
        DVec3::new(at(0), at(1), at(2))
    }

    /// The orientation of a rigid body: all are as likely as each other (Shoemake, Graphics Gems III, 1992).
    fn orientation(&self, number: usize, serial: u64) -> DQuat {
        let [u, v, w] = [0, 1, 2].map(|index| random([self.seed, number as u64, serial, Draw::Orientation as u64, index]));
        let ((sin_v, cos_v), (sin_w, cos_w)) = ((TAU * v).sin_cos(), (TAU * w).sin_cos());
        let (less, more) = ((1.0 - u).sqrt(), u.sqrt());
        DQuat::from_xyzw(less * sin_v, less * cos_v, more * sin_w, more * cos_w)
    }

    /// Where a rigid body appears.
    pub(crate) fn placement(&self, shape: ShapeId, number: usize, serial: u64, centre: DVec3) -> Placement {
        let turn = self.orientation(number, serial).as_quat().normalize();
        Placement::new(shape).centred_at(centre).turned(turn).velocity(self.velocity)
    }

    /// A sphere of the inlet.
    pub(crate) fn sphere_of(&self, centre: DVec3, radius: f32, mass: f32) -> Sphere {
        let sphere = Sphere::new(centre.as_vec3(), radius).mass(mass).velocity(self.velocity).group(self.group);
        Sphere { material: self.material, ..sphere }
    }

    fn middle(&self) -> DVec3 {
        (self.corners[0] + self.corners[1]) / 2.0
    }

    /// What a sphere adds to the sum that the rate compares: 1, its mass or its volume.
    pub(crate) fn share(&self, grain: &Grain) -> f64 {
        match self.rate {
            Rate::Number(_) => 1.0,
            Rate::Mass(_) => grain.mass.into(),
            Rate::Volume(_) => volume(grain.radius.into()),
        }
    }

    /// The sum of the shares that are due at a time in s.
    pub(crate) fn due(&self, time: f64) -> f64 {
        let (Rate::Number(rate) | Rate::Mass(rate) | Rate::Volume(rate)) = self.rate;
        let seconds = time.min(self.to) - self.from;
        if seconds > 0.0 { rate * seconds * (1.0 + SLACK) } else { 0.0 }
    }
}

impl Scene {
    /// The density of the material of an inlet.
    pub(crate) fn inlet_density(&self, inlet: &Inlet) -> Option<f32> {
        inlet.material.and_then(|id| self.material(id).ok()).and_then(|material| material.density)
    }

    /// The smallest and the largest sphere of an inlet, in the middle of its box.
    pub(crate) fn samples(&self, inlet: &Inlet) -> [Sphere; 2] {
        let (small, large) = inlet.radii.bounds(inlet.by);
        [small, large].map(|radius| {
            let one = Inlet { radii: Radii::Equal(radius), ..inlet.clone() };
            let Grain { radius, mass } = one.grain(0, 0, self.inlet_density(inlet));
            one.sphere_of(one.middle(), radius, mass)
        })
    }

    /// The scene with the smallest and the largest sphere of every inlet, or one of its rigid bodies, and without the inlets, for checks of what the scene will
    /// contain.
    pub fn with_grains(&self) -> Cow<'_, Self> {
        if self.inlets.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        for inlet in std::mem::take(&mut scene.inlets) {
            match inlet.shape {
                Some(shape) => {
                    // The inlet would not be in the scene if its bodies could not be.
                    let _ = scene.add_body(inlet.placement(shape, 0, 0, inlet.middle()));
                }
                None => scene.samples(&inlet).into_iter().for_each(|sphere| {
                    scene.spheres.add(sphere);
                }),
            }
        }
        Cow::Owned(scene)
    }
}
