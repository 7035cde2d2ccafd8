//! Networks of fixed-length rods: the changes of velocity by impulses on their spheres, with all rod lengths kept
//! (docs/physics section 3.4).
//!
//! dv = W (p - J' lambda) with (J W J') lambda = J W p. Here p are the impulses, dv the changes of velocity, W the inverse
//! masses, and lambda the tensions of the rods. J holds the directions of the rods, and J' is its transpose.
//!
//! The system is solved by conjugate gradients, in f64. If a network has more rods than independent lengths, the matrix is
//! singular. In f32, rounding errors would grow along the directions that the matrix leaves undetermined.

use glam::{DVec3, Vec3};

use crate::model::view::{TINY, View};

/// The iteration ends when the squared residual is at most this fraction of the squared velocities of the rods' ends.
const TOLERANCE: f64 = 1e-12;
/// A squared residual above this fraction, after the last iteration, means that the system is not solved.
const UNSOLVED: f64 = 1e-6;
/// The largest number of iterations, per rod. Without rounding errors one per rod is enough.
const ITERATIONS_PER_ROD: usize = 16;

/// A rod. Its ends are given by the places of the spheres in the network, `None` for a fixed end.
#[derive(Clone, Copy, Debug)]
struct Line {
    ends: [Option<usize>; 2],
    /// The direction divided by the square root of the inverse masses of both ends. So all diagonal elements of J W J' are 1.
    direction: DVec3,
}

/// A network in the present state.
#[derive(Clone, Debug)]
pub(crate) struct Network {
    pub(crate) spheres: Vec<u32>,
    /// Each sphere with its place, sorted by sphere.
    places: Vec<(u32, usize)>,
    inverse_masses: Vec<f64>,
    lines: Vec<Line>,
    /// Whether an iteration did not reach its tolerance.
    pub(crate) is_unsolved: bool,
}

impl Network {
    pub(crate) fn of(view: &View, network: u32) -> Self {
        let (spheres, rods) = view.network(network);
        let spheres: Vec<u32> = spheres.collect();
        let mut places: Vec<_> = spheres.iter().copied().zip(0..).collect();
        places.sort_unstable();
        let inverse_masses = spheres.iter().map(|sphere| f64::from(view.inverse_mass(*sphere))).collect();
        let mut network = Self { spheres, places, inverse_masses, lines: Vec::new(), is_unsolved: false };
        network.lines = rods
            .iter()
            .map(|rod| {
                let ends = view.rod(*rod).ends;
                let d = view.between(ends[0], ends[1]);
                let direction = if d.length_squared() <= TINY { Vec3::ZERO } else { d };
                let inverse_mass: f64 = ends.iter().map(|end| f64::from(view.inverse_mass(*end))).sum();
                let direction = direction.as_dvec3().normalize_or_zero() / inverse_mass.sqrt();
                Line { ends: ends.map(|end| network.place(end)), direction }
            })
            .collect();
        network
    }

    /// The place of a sphere in the network.
    pub(crate) fn place(&self, sphere: u32) -> Option<usize> {
        let at = self.places.binary_search_by_key(&sphere, |(sphere, _)| *sphere).ok()?;
        Some(self.places[at].1)
    }

    /// J W applied to impulses: the rates at which the rods lengthen, each divided like the direction of its rod.
    fn lengthening(&self, impulses: &[DVec3]) -> Vec<f64> {
        let velocity = |end: Option<usize>| end.map_or(DVec3::ZERO, |end| self.inverse_masses[end] * impulses[end]);
        self.lines.iter().map(|line| line.direction.dot(velocity(line.ends[1]) - velocity(line.ends[0]))).collect()
    }

    /// The squared velocities of the rods' ends under these impulses, divided like the squared rates of lengthening.
    fn squared_velocities(&self, impulses: &[DVec3]) -> f64 {
        let squared = |end: Option<usize>| end.map_or(0.0, |end| (self.inverse_masses[end] * impulses[end]).length_squared());
        self.lines.iter().map(|line| line.direction.length_squared() * (squared(line.ends[0]) + squared(line.ends[1]))).sum()
    }

    /// J' applied to tensions: one vector per sphere, which is subtracted from the impulse on it.
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

    /// The changes of velocity by impulses, such that no rod changes its length.
    pub(crate) fn project(&mut self, impulses: &[DVec3]) -> Vec<DVec3> {
        let tensions = self.tensions(impulses);
        let pulled = self.pull(&tensions);
        let changes = impulses.iter().zip(pulled).zip(&self.inverse_masses);
        changes.map(|((impulse, pull), inverse_mass)| *inverse_mass * (*impulse - pull)).collect()
    }

    fn tensions(&mut self, impulses: &[DVec3]) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut residual = self.lengthening(impulses);
        let mut tensions = vec![0.0; residual.len()];
        let mut direction = residual.clone();
        let mut size = dot(&residual, &residual);
        let whole = self.squared_velocities(impulses);
        for _ in 0..ITERATIONS_PER_ROD * self.lines.len() {
            if size.is_nan() || size <= TOLERANCE * whole {
                break;
            }
            let image = self.lengthening(&self.pull(&direction));
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
        self.is_unsolved |= size > UNSOLVED * whole;
        tensions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A nearly flat net of balls whose meshes are braced in both diagonals. The masses range over `decades` powers of ten.
    fn net(side: usize, decades: f64) -> Network {
        let random = |k: usize| (k as f64 * 0.618_033_988_749_895).fract() - 0.5;
        let place = |row: usize, column: usize| DVec3::new(row as f64, 0.02 * random(7 * (row * side + column)), column as f64);
        let all = || (0..side).flat_map(|row| (0..side).map(move |column| (row, column)));
        let inverse_masses: Vec<f64> = (0..side * side).map(|k| 10_f64.powf(decades * random(k))).collect();
        let line = |(one, other): ((usize, usize), (usize, usize))| {
            let ends = [one, other].map(|(row, column)| row * side + column);
            let w = inverse_masses[ends[0]] + inverse_masses[ends[1]];
            let direction = (place(other.0, other.1) - place(one.0, one.1)).normalize() / w.sqrt();
            Line { ends: ends.map(Some), direction }
        };
        let around = |(r, c): (usize, usize)| {
            [((r, c), (r, c + 1)), ((r, c), (r + 1, c)), ((r, c), (r + 1, c + 1)), ((r, c + 1), (r + 1, c))]
        };
        let inside = |((r1, c1), (r2, c2)): &((usize, usize), (usize, usize))| [r1, c1, r2, c2].into_iter().all(|k| *k < side);
        let lines = all().flat_map(around).filter(inside).map(line).collect();
        Network { spheres: (0..(side * side) as u32).collect(), places: Vec::new(), inverse_masses, lines, is_unsolved: false }
    }

    #[test]
    fn a_network_that_cannot_be_solved_is_reported() {
        for (side, decades, is_unsolved) in [(2, 0.0, false), (6, 2.0, false), (15, 10.0, true)] {
            let mut net = net(side, decades);
            let mut impulses = vec![DVec3::ZERO; net.spheres.len()];
            impulses[0] = DVec3::X;
            let changes = net.project(&impulses);
            let lengthening = |line: &Line| line.direction.dot(changes[line.ends[1].unwrap()] - changes[line.ends[0].unwrap()]);
            let squared: f64 = net.lines.iter().map(|line| lengthening(line).powi(2)).sum();
            assert_eq!(net.is_unsolved, is_unsolved, "side {side}");
            assert_eq!(squared > UNSOLVED * net.squared_velocities(&impulses), is_unsolved, "side {side}: {squared}");
        }
    }
}
