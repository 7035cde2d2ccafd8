//! Networks of fixed-length rods: impulses on their spheres without what the rods do not let through (docs/physics.md section 3.4).
//!
//! dv = W (p - J' lambda) with (J W J') lambda = J W p, J the directions of the rods. By conjugate gradients, in f64: where rods are more
//! than the lengths that are independent, the matrix is singular, and f32 would wander off along what it leaves open.

use glam::{DVec3, Vec3};

use crate::model::view::{TINY, View};

/// The squared residual is small enough at this times the first one.
const TOLERANCE: f64 = 1e-12;
/// A tree of n rods takes at most n iterations.
const MAX_ITERATIONS: u32 = 64;

/// A rod between spheres by their place in the network; an end that is fixed is none.
#[derive(Clone, Copy, Debug)]
struct Line {
    ends: [Option<usize>; 2],
    direction: DVec3,
}

/// A network at present.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    pub(crate) spheres: Vec<u32>,
    /// The places of the spheres, by sphere.
    places: Vec<(u32, usize)>,
    inverse_masses: Vec<f64>,
    lines: Vec<Line>,
}

impl Network {
    pub(crate) fn of(view: &View, network: u32) -> Self {
        let (spheres, rods) = view.network(network);
        let spheres: Vec<u32> = spheres.collect();
        let mut places: Vec<_> = spheres.iter().copied().zip(0..).collect();
        places.sort_unstable();
        let inverse_masses = spheres.iter().map(|sphere| f64::from(view.inverse_mass(*sphere))).collect();
        let mut network = Self { spheres, places, inverse_masses, lines: Vec::new() };
        network.lines = rods
            .iter()
            .map(|rod| {
                let ends = view.rod(*rod).ends;
                let d = view.position(ends[1]) - view.position(ends[0]);
                let direction = if d.length_squared() <= TINY { Vec3::ZERO } else { d };
                Line { ends: ends.map(|end| network.place(end)), direction: direction.as_dvec3().normalize_or_zero() }
            })
            .collect();
        network
    }

    /// The place of a sphere in the network.
    pub(crate) fn place(&self, sphere: u32) -> Option<usize> {
        let at = self.places.binary_search_by_key(&sphere, |(sphere, _)| *sphere).ok()?;
        Some(self.places[at].1)
    }

    /// J W of impulses, or of anything that the inverse masses turn into velocities: how fast each rod's ends part.
    fn parting(&self, impulses: &[DVec3]) -> Vec<f64> {
        let velocity = |end: Option<usize>| end.map_or(DVec3::ZERO, |end| self.inverse_masses[end] * impulses[end]);
        self.lines.iter().map(|line| line.direction.dot(velocity(line.ends[1]) - velocity(line.ends[0]))).collect()
    }

    /// J' of tensions.
    fn pull(&self, tensions: &[f64]) -> Vec<DVec3> {
        let mut impulses = vec![DVec3::ZERO; self.spheres.len()];
        for (line, tension) in self.lines.iter().zip(tensions) {
            for (end, sign) in line.ends.into_iter().zip([-1.0, 1.0]) {
                if let Some(end) = end {
                    impulses[end] += sign * tension * line.direction;
                }
            }
        }
        impulses
    }

    /// The changes of velocity that impulses make where every length stays.
    pub(crate) fn project(&self, impulses: &[DVec3]) -> Vec<DVec3> {
        let tensions = self.tensions(impulses);
        let pulled = self.pull(&tensions);
        let changes = impulses.iter().zip(pulled).zip(&self.inverse_masses);
        changes.map(|((impulse, pull), inverse_mass)| *inverse_mass * (*impulse - pull)).collect()
    }

    fn tensions(&self, impulses: &[DVec3]) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut residual = self.parting(impulses);
        let mut tensions = vec![0.0; residual.len()];
        let mut direction = residual.clone();
        let first = dot(&residual, &residual);
        let mut size = first;
        for _ in 0..MAX_ITERATIONS {
            if size.is_nan() || size <= TOLERANCE * first {
                break;
            }
            let image = self.parting(&self.pull(&direction));
            let curvature = dot(&direction, &image);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let step = size / curvature;
            tensions.iter_mut().zip(&direction).for_each(|(tension, direction)| *tension += step * direction);
            residual.iter_mut().zip(&image).for_each(|(residual, image)| *residual -= step * image);
            let next = dot(&residual, &residual);
            direction
                .iter_mut()
                .zip(&residual)
                .for_each(|(direction, residual)| *direction = residual + next / size * *direction);
            size = next;
        }
        tensions
    }
}
