//! Mass properties of shapes of density 1.

use glam::{DMat3, DVec3, Vec3};

use crate::rigid::shape::moments::{moments, outer};
use crate::rigid::shape::rounded_hull::rounded;
use crate::rigid::shape::{Core, Hull, Shape};

use std::f64::consts::PI;

impl Shape {
    /// Volume in units³ and the inertia about the centre of mass in units⁵, both for density 1. A face and a half-space have
    /// none. The centre of a hull with a radius is taken to be that of the hull without.
    pub(crate) fn mass(&self) -> (f64, DMat3) {
        let radius = self.radius as f64;
        match &self.core {
            Core::Point => {
                let volume = 4.0 / 3.0 * PI * radius.powi(3);
                (volume, DMat3::from_diagonal(DVec3::splat(0.4 * volume * radius * radius)))
            }
            Core::Segment { half } => capsule(*half as f64, radius),
            Core::Box { half } => rounded_box(half.as_dvec3(), radius),
            Core::Hull(hull) => {
                let sum = if radius > 0.0 { rounded(hull, radius) } else { moments(fan(hull)) };
                let centre = sum.first / sum.volume;
                from_moments(sum.volume, sum.second - outer(centre) * sum.volume)
            }
            Core::Face { .. } | Core::HalfSpace | Core::Cone { .. } | Core::Bowl { .. } => (0.0, DMat3::ZERO),
        }
    }
}

impl Hull {
    /// Its volume, and the integrals of x and of x x^T over it.
    pub(crate) fn moments(&self) -> (f64, DVec3, DMat3) {
        let sum = moments(fan(self));
        (sum.volume, sum.first, sum.second)
    }

    /// Triangles that are its surface, counterclockwise from outside.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        let corner = |number: u8| self.vertices[number as usize];
        self.faces.iter().flat_map(move |(_, corners)| {
            (1..corners.len() - 1).map(move |k| [corner(corners[0]), corner(corners[k]), corner(corners[k + 1])])
        })
    }
}

/// Volume and second moments `sum m x x^T` to volume and inertia.
fn from_moments(volume: f64, moments: DMat3) -> (f64, DMat3) {
    let trace = moments.x_axis.x + moments.y_axis.y + moments.z_axis.z;
    (volume, DMat3::from_diagonal(DVec3::splat(trace)) - moments)
}

fn capsule(half: f64, radius: f64) -> (f64, DMat3) {
    let square = radius * radius;
    let cylinder = 2.0 * PI * square * half;
    let ball = 4.0 / 3.0 * PI * square * radius;
    let axial = cylinder * square / 2.0 + 0.4 * ball * square;
    // Half balls: 3/8 of the radius from their flat sides.
    let caps = ball * (0.4 * square + half * half + 0.75 * half * radius);
    let across = cylinder * (square / 4.0 + half * half / 3.0) + caps;
    (cylinder + ball, DMat3::from_diagonal(DVec3::new(across, axial, across)))
}

/// A box with a radius: the box, six slabs, twelve quarters of a cylinder and eight eighths of a ball.
fn rounded_box(half: DVec3, radius: f64) -> (f64, DMat3) {
    let area = |axis: usize| 4.0 * half[(axis + 1) % 3] * half[(axis + 2) % 3];
    let mut volume = 8.0 * half.x * half.y * half.z + 4.0 / 3.0 * PI * radius.powi(3);
    for axis in 0..3 {
        volume += 2.0 * radius * area(axis) + 2.0 * PI * radius * radius * half[axis];
    }
    let mut moments = DVec3::ZERO;
    for axis in 0..3 {
        moments[axis] = rounded_moment(half[axis], half[(axis + 1) % 3], half[(axis + 2) % 3], radius);
    }
    from_moments(volume, DMat3::from_diagonal(moments))
}

/// The integral of x² over the box with half edges h, a, b and a radius. A section across x is a rectangle with rounded edges:
/// of radius r between the faces, and of radius sqrt(r² - t²) at t beyond them.
fn rounded_moment(h: f64, a: f64, b: f64, r: f64) -> f64 {
    let section = |s: f64| 4.0 * a * b + 4.0 * s * (a + b) + PI * s * s;
    let middle = section(r) * 2.0 * h.powi(3) / 3.0;
    // The integrals over t from 0 to r of (h + t)² times 1, s and s² with s = sqrt(r² - t²).
    let flat = ((h + r).powi(3) - h.powi(3)) / 3.0;
    let round = PI * r * r * h * h / 4.0 + 2.0 * h * r.powi(3) / 3.0 + PI * r.powi(4) / 16.0;
    let square = 2.0 / 3.0 * h * h * r.powi(3) + h * r.powi(4) / 2.0 + 2.0 * r.powi(5) / 15.0;
    middle + 2.0 * (4.0 * a * b * flat + 4.0 * (a + b) * round + PI * square)
}

/// The triangles of a hull in double precision.
fn fan(hull: &Hull) -> impl Iterator<Item = [DVec3; 3]> {
    hull.triangles().map(|triangle| triangle.map(|corner| corner.as_dvec3()))
}
