//! Cubic cells inside of a mesh, with their distances from its surface.

use glam::DVec3;
use rayon::prelude::*;

use super::solid::{Moments, middle};
use crate::mesh::Mesh;

/// Greatest number of cells, divided by the number that was asked for. Thin meshes have more, because of the cells around them.
const ROOM: usize = 8;

pub(super) struct Grid {
    /// Edge of a cell.
    pub(super) cell: f64,
    /// Corner of the first cell.
    corner: DVec3,
    /// Number of cells along each axis. The first and the last are outside of the mesh.
    sides: [usize; 3],
    /// Middle of the mesh, about which moments are computed.
    middle: DVec3,
    /// Whether the middle of each cell is inside of the mesh.
    inside: Vec<bool>,
    /// Distance of the middle of each cell from the surface and from what was taken; at most 0 for one that is no centre of a
    /// sphere.
    room: Vec<f32>,
    /// The first cell with the greatest distance of each layer across z.
    best: Vec<(f32, usize)>,
}

impl Grid {
    pub(super) fn new(mesh: &Mesh, cells: usize) -> Self {
        let [least, greatest] = mesh.bounds().map(|corner| DVec3::from_array(corner.map(f64::from)));
        let size = greatest - least;
        let mut cell = (size.x * size.y * size.z / cells as f64).cbrt();
        let sides_of = |cell: f64| (size / cell).to_array().map(|side| side.ceil() as usize + 2);
        while sides_of(cell).iter().map(|side| *side as f64).product::<f64>() > (ROOM * cells) as f64 {
            cell *= 1.1;
        }
        let sides = sides_of(cell);
        let middle = middle(mesh);
        let corner = middle - 0.5 * cell * DVec3::from_array(sides.map(|side| side as f64));
        let mut grid = Self { cell, corner, sides, middle, inside: Vec::new(), room: Vec::new(), best: Vec::new() };
        grid.inside = grid.fill(mesh);
        grid
    }

    /// The middle of a cell.
    pub(super) fn centre(&self, cell: usize) -> DVec3 {
        let [x, y, _] = self.sides;
        self.point([cell % x, cell / x % y, cell / (x * y)])
    }

    fn point(&self, place: [usize; 3]) -> DVec3 {
        self.corner + self.cell * DVec3::from_array(place.map(|number| number as f64 + 0.5))
    }

    /// The numbers along an axis of the cells whose middle is between two coordinates.
    fn range(&self, axis: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let number = |at: f64| ((at - self.corner[axis]) / self.cell - 0.5).clamp(0.0, self.sides[axis] as f64);
        number(low).ceil() as usize..(number(high).floor() as usize + 1).min(self.sides[axis])
    }

    /// Whether each cell is inside: where its line along x crosses the surface an odd number of times before it. Every edge is
    /// crossed for both of its triangles or for neither, so that the number of crossings of a line is even.
    fn fill(&self, mesh: &Mesh) -> Vec<bool> {
        let [nx, ny, nz] = self.sides;
        let mut lines: Vec<Vec<f64>> = vec![Vec::new(); ny * nz];
        let room = 0.01 * self.cell;
        for corners in mesh.corners() {
            let bound =
                |axis: usize, pick: fn(f64, f64) -> f64| pick(pick(corners[0][axis], corners[1][axis]), corners[2][axis]);
            // With room for rounding, because every line has to meet both triangles of an edge or neither.
            let near = |axis: usize| self.range(axis, bound(axis, f64::min) - room, bound(axis, f64::max) + room);
            for k in near(2) {
                for j in near(1) {
                    let point = self.point([0, j, k]);
                    if let Some(x) = crossing(corners, point.y, point.z) {
                        lines[k * ny + j].push(x);
                    }
                }
            }
        }
        let mut inside = vec![false; nx * ny * nz];
        for (line, crossings) in lines.iter_mut().enumerate() {
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                for i in self.range(0, pair[0], pair[1]) {
                    inside[line * nx + i] = true;
                }
            }
        }
        inside
    }

    /// Whether no cell is inside.
    pub(super) fn is_empty(&self) -> bool {
        !self.inside.contains(&true)
    }

    /// Computes the distances from the surface.
    pub(super) fn measure(&mut self) {
        let [nx, ny, nz] = self.sides;
        // Squares of the distances from the nearest cell outside, in edges of cells.
        let far = (nx + ny + nz) as f32;
        let mut squares: Vec<f32> = self.inside.iter().map(|inside| if *inside { far * far } else { 0.0 }).collect();
        squares.par_chunks_mut(nx).for_each(lowered);
        squares.par_chunks_mut(nx * ny).for_each(|layer| {
            let mut line = vec![0.0; ny];
            for i in 0..nx {
                (0..ny).for_each(|j| line[j] = layer[j * nx + i]);
                lowered(&mut line);
                (0..ny).for_each(|j| layer[j * nx + i] = line[j]);
            }
        });
        let mut line = vec![0.0; nz];
        for column in 0..nx * ny {
            (0..nz).for_each(|k| line[k] = squares[k * nx * ny + column]);
            lowered(&mut line);
            (0..nz).for_each(|k| squares[k * nx * ny + column] = line[k]);
        }
        // The surface is about half a cell before the next cell outside.
        let cell = self.cell as f32;
        self.room = squares.into_iter().map(|square| cell * (square.sqrt() - 0.5)).collect();
        self.best = (0..nz).map(|layer| self.best_of(layer)).collect();
    }

    fn best_of(&self, layer: usize) -> (f32, usize) {
        let size = self.sides[0] * self.sides[1];
        let cells = layer * size..(layer + 1) * size;
        cells.fold((f32::NEG_INFINITY, 0), |best, cell| if self.room[cell] > best.0 { (self.room[cell], cell) } else { best })
    }

    /// The cell with the greatest distance, and this distance. `None` if no cell is left.
    pub(super) fn farthest(&self) -> Option<(usize, f64)> {
        let best = self.best.iter().fold((0.0, 0), |best, found| if found.0 > best.0 { *found } else { best });
        (best.0 > 0.0).then_some((best.1, f64::from(best.0)))
    }

    /// Takes a ball away, and also a cell.
    pub(super) fn take(&mut self, cell: usize, place: DVec3, radius: f64) {
        // No cell is farther than the greatest distance from what remains.
        let reach = radius + self.best.iter().fold(0.0, |most, found| found.0.max(most)) as f64 + self.cell;
        let [x, y, z] = [0, 1, 2].map(|axis| self.range(axis, place[axis] - reach, place[axis] + reach));
        for k in z.clone() {
            for j in y.clone() {
                for i in x.clone() {
                    let distance = (self.point([i, j, k]).distance(place) - radius) as f32;
                    let room = &mut self.room[(k * self.sides[1] + j) * self.sides[0] + i];
                    *room = room.min(distance);
                }
            }
        }
        self.room[cell] = 0.0;
        let own = cell / (self.sides[0] * self.sides[1]);
        for layer in z.chain([own]) {
            self.best[layer] = self.best_of(layer);
        }
    }

    /// Whether each cell is inside of a ball.
    pub(super) fn covered(&self, balls: &[(DVec3, f64)]) -> Vec<bool> {
        let mut covered = vec![false; self.inside.len()];
        for (place, radius) in balls {
            let [x, y, z] = [0, 1, 2].map(|axis| self.range(axis, place[axis] - radius, place[axis] + radius));
            for k in z {
                for j in y.clone() {
                    for i in x.clone().filter(|i| self.point([*i, j, k]).distance_squared(*place) <= radius * radius) {
                        covered[(k * self.sides[1] + j) * self.sides[0] + i] = true;
                    }
                }
            }
        }
        covered
    }

    /// The moments of the cells inside for which a condition holds.
    pub(super) fn moments(&self, holds: impl Fn(usize) -> bool) -> Moments {
        let mut moments = Moments::new(self.middle);
        let cells = (0..self.inside.len()).filter(|cell| self.inside[*cell] && holds(*cell));
        cells.for_each(|cell| moments.add(self.centre(cell), self.cell.powi(3)));
        moments
    }
}

/// Where the line along x with these coordinates crosses a triangle.
fn crossing(corners: [DVec3; 3], y: f64, z: f64) -> Option<f64> {
    // Whether the point is inside of the triangle seen along x: a ray to greater y crosses an odd number of edges. An edge
    // gives the same answer for both of its triangles.
    let crosses = |a: DVec3, b: DVec3| {
        let (low, high) = if (a.z, a.y, a.x) <= (b.z, b.y, b.x) { (a, b) } else { (b, a) };
        (low.z <= z) != (high.z <= z) && low.y + (z - low.z) / (high.z - low.z) * (high.y - low.y) > y
    };
    let [a, b, c] = corners;
    if !(crosses(a, b) ^ crosses(b, c) ^ crosses(c, a)) {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let x = a.x - (normal.y * (y - a.y) + normal.z * (z - a.z)) / normal.x;
    // A triangle along x, by rounding.
    Some(if x.is_finite() { x.clamp(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)) } else { a.x })
}

/// Replaces each number f(q) of a line by the least f(p) + (q - p)², by the lower envelope of parabolas (P. Felzenszwalb and
/// D. Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8, 415 (2012)).
fn lowered(line: &mut [f32]) {
    let own = line.to_vec();
    let height = |p: usize| f64::from(own[p]) + (p * p) as f64;
    // Where parabola p begins to be below parabola q < p.
    let meeting = |q: usize, p: usize| (height(p) - height(q)) / (2.0 * (p - q) as f64);
    let mut parabolas: Vec<(usize, f64)> = vec![(0, f64::NEG_INFINITY)];
    for p in 1..own.len() {
        while let Some((q, from)) = parabolas.last().copied() {
            let at = meeting(q, p);
            if at > from {
                parabolas.push((p, at));
                break;
            }
            parabolas.pop();
        }
    }
    let mut next = 0;
    for (q, number) in line.iter_mut().enumerate() {
        while next + 1 < parabolas.len() && parabolas[next + 1].1 <= q as f64 {
            next += 1;
        }
        let p = parabolas[next].0;
        *number = own[p] + (q.abs_diff(p) as f32).powi(2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_the_least_of_all_parabolas() {
        let line = [9.0, 0.0, 4.0, 100.0, 100.0, 2.0, 100.0, 0.0_f32];
        let mut found = line;
        lowered(&mut found);
        for (q, number) in found.iter().enumerate() {
            let least = line.iter().enumerate().map(|(p, f)| f + (q.abs_diff(p) as f32).powi(2)).fold(f32::MAX, f32::min);
            assert_eq!(*number, least, "{q}");
        }
    }

    #[test]
    fn the_cells_of_a_ball_have_its_volume_and_distances() {
        let ball = Mesh::sphere(2.0, 4).unwrap();
        let mut grid = Grid::new(&ball, 60_000);
        let volume = grid.moments(|_| true).volume;
        assert!((volume / ball.volume() - 1.0).abs() < 0.01, "{volume}");
        grid.measure();
        for cell in (0..grid.inside.len()).step_by(7) {
            let expected = if grid.inside[cell] { 2.0 - grid.centre(cell).length() } else { -0.5 * grid.cell };
            assert!((f64::from(grid.room[cell]) - expected).abs() < 1.1 * grid.cell, "{cell}: {} {expected}", grid.room[cell]);
        }
    }
}
