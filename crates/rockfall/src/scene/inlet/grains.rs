//! The sequence of spheres of an inlet: their kinds, radii, masses and places follow from the seed, the number of the inlet and the serial
//! number of the sphere alone (docs/physics section 2.15).

use std::borrow::Cow;
use std::f64::consts::{PI, SQRT_2, TAU};

use glam::{DQuat, DVec3};

use super::{GrainKind, GrainMass, Inlet, Radii, Rate, SizedBy};
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
    Kind,
}

/// A sphere that has not appeared yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grain {
    /// Number of its kind.
    pub(crate) kind: usize,
    pub(crate) radius: f32,
    pub(crate) mass: f32,
}

impl Grain {
    /// The volume of the sphere, in units³.
    pub(crate) fn volume(&self) -> f64 {
        volume(self.radius.into())
    }
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

impl Radii {
    /// The mean volume of spheres, in units³.
    fn mean_volume(&self, by: SizedBy) -> f64 {
        let cube = match (*self, by) {
            (Self::Equal(radius), _) => radius.powi(3),
            (Self::Uniform(from, to), _) if to - from <= f64::EPSILON * to => from.powi(3),
            (Self::Uniform(from, to), SizedBy::Number) => (from + to) * (from * from + to * to) / 4.0,
            (Self::Uniform(from, to), SizedBy::Mass) => 2.0 * (to - from) / (from.powi(-2) - to.powi(-2)),
            (Self::LogNormal { median, sigma }, _) => {
                // The part of a normal distribution up to a number, without the tails beyond four standard deviations.
                let below = |number: f64| 0.5 * libm::erfc(-number / SQRT_2);
                let kept = below(TAIL - 3.0 * sigma) - below(-TAIL - 3.0 * sigma);
                median_by_number(median, sigma, by).powi(3) * (4.5 * sigma * sigma).exp() * kept / (below(TAIL) - below(-TAIL))
            }
        };
        4.0 / 3.0 * PI * cube
    }
}

impl GrainKind {
    /// The mass of a sphere with a volume.
    fn mass_of(&self, volume: f64, density: Option<f32>) -> f64 {
        match (self.mass, density) {
            (GrainMass::Mass(mass), _) => mass,
            (GrainMass::Density(density), _) => density * volume,
            (GrainMass::OfMaterial, Some(density)) => f64::from(density) * volume,
            (GrainMass::OfMaterial, None) => 1.0,
        }
    }
}

/// The sequence of an inlet in a scene.
pub(crate) struct Sequence<'a> {
    inlet: &'a Inlet,
    /// The number of the inlet in its scene.
    number: usize,
    /// Of each kind the density of its material, and the part of the grains that are of this kind or one before.
    kinds: Vec<(Option<f32>, f64)>,
}

impl<'a> Sequence<'a> {
    fn new(scene: &Scene, inlet: &'a Inlet, number: usize) -> Self {
        let density = |kind: &GrainKind| {
            let material = kind.material.and_then(|id| scene.material(id).ok());
            material.and_then(|material| material.density)
        };
        let part = |(kind, share): &(GrainKind, f64)| match inlet.shares {
            SizedBy::Number => *share,
            SizedBy::Mass => share / kind.mass_of(kind.radii.mean_volume(kind.by), density(kind)),
        };
        let all: f64 = inlet.kinds.iter().map(part).sum();
        let mut below = 0.0;
        let kinds = inlet.kinds.iter().map(|kind| {
            below += part(kind) / all;
            (density(&kind.0), below)
        });
        Self { inlet, number, kinds: kinds.collect() }
    }

    /// The sphere with a serial number.
    pub(crate) fn grain(&self, serial: u64) -> Grain {
        let Self { inlet, number, kinds } = self;
        let key = |draw: Draw, index| [inlet.seed, *number as u64, serial, draw as u64, index];
        let kind = if kinds.len() == 1 {
            0
        } else {
            let random = random(key(Draw::Kind, 0));
            kinds.iter().position(|(_, below)| random < *below).unwrap_or(kinds.len() - 1)
        };
        let (of, density) = (&inlet.kinds[kind].0, kinds[kind].0);
        let radius = of.radii.radius(of.by, |index| random(key(Draw::Radius, index))) as f32;
        Grain { kind, radius, mass: of.mass_of(volume(radius.into()), density) as f32 }
    }

    /// What the rate counts of the sphere with a serial number.
    pub(crate) fn share(&self, serial: u64) -> f64 {
        self.inlet.share(&self.grain(serial))
    }
}

impl Inlet {
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
    pub(crate) fn sphere_of(&self, kind: &GrainKind, centre: DVec3, radius: f32, mass: f32) -> Sphere {
        let sphere = Sphere::new(centre.as_vec3(), radius).mass(mass).velocity(self.velocity).group(kind.group);
        Sphere { material: kind.material, ..sphere }
    }

    fn middle(&self) -> DVec3 {
        (self.corners[0] + self.corners[1]) / 2.0
    }

    /// What a sphere adds to the sum that the rate compares: 1, its mass or its volume.
    pub(crate) fn share(&self, grain: &Grain) -> f64 {
        match self.rate {
            Rate::Number(_) => 1.0,
            Rate::Mass(_) => grain.mass.into(),
            Rate::Volume(_) => grain.volume(),
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
    /// The sequence of an inlet.
    pub(crate) fn sequence<'a>(&self, inlet: &'a Inlet, number: usize) -> Sequence<'a> {
        Sequence::new(self, inlet, number)
    }

    /// The smallest and the largest sphere of a kind, in the middle of the box of its inlet.
    pub(crate) fn samples(&self, inlet: &Inlet, kind: &GrainKind) -> [Sphere; 2] {
        let (small, large) = kind.radii.bounds(kind.by);
        [small, large].map(|radius| {
            let one = Inlet { kinds: vec![(GrainKind { radii: Radii::Equal(radius), ..kind.clone() }, 1.0)], ..inlet.clone() };
            let Grain { radius, mass, .. } = self.sequence(&one, 0).grain(0);
            one.sphere_of(kind, one.middle(), radius, mass)
        })
    }

    /// The scene with the smallest and the largest sphere of every kind that an inlet lets in, or one of its rigid bodies, and without
    /// the inlets, for checks of what the scene will contain.
    pub fn with_grains(&self) -> Cow<'_, Self> {
        if self.inlets.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        for inlet in std::mem::take(&mut scene.inlets) {
            for (kind, _) in &inlet.kinds {
                match kind.shape {
                    Some(shape) => {
                        // The inlet would not be in the scene if its bodies could not be.
                        let _ = scene.add_body(inlet.placement(shape, 0, 0, inlet.middle()));
                    }
                    None => scene.samples(&inlet, kind).into_iter().for_each(|sphere| {
                        scene.spheres.add(sphere);
                    }),
                }
            }
        }
        Cow::Owned(scene)
    }
}
