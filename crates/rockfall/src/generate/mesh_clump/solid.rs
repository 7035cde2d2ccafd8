//! The volume inside of a closed mesh, with its first and second moments.

use std::collections::HashMap;

use glam::{DMat3, DVec3};

use super::invalid;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::rigid::shape::{moments, outer};
use crate::scene::MassProperties;

/// Integrals of 1, x and x xᵀ over a volume, with x from a point of reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    pub(super) origin: DVec3,
    pub(super) volume: f64,
    pub(super) first: DVec3,
    pub(super) second: DMat3,
}

impl Moments {
    pub(super) fn new(origin: DVec3) -> Self {
        Self { origin, volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO }
    }

    /// Adds a point with a volume.
    pub(super) fn add(&mut self, point: DVec3, volume: f64) {
        let x = point - self.origin;
        self.volume += volume;
        self.first += volume * x;
        self.second += volume * outer(x);
    }

    pub(super) fn properties(&self, density: f64) -> MassProperties {
        let middle = self.first / self.volume;
        let about_centre = self.second - self.volume * outer(middle);
        let trace = about_centre.x_axis.x + about_centre.y_axis.y + about_centre.z_axis.z;
        let inertia = density * (DMat3::from_diagonal(DVec3::splat(trace)) - about_centre);
        let [x, y, z] = [inertia.x_axis, inertia.y_axis, inertia.z_axis];
        MassProperties {
            mass: density * self.volume,
            centre: (self.origin + middle).to_array(),
            inertia: [x.x, y.y, z.z, x.y, x.z, y.z],
        }
    }
}

/// The middle of the bounds of a mesh.
pub(super) fn middle(mesh: &Mesh) -> DVec3 {
    let [least, greatest] = mesh.bounds().map(|corner| DVec3::from_array(corner.map(f64::from)));
    0.5 * (least + greatest)
}

/// The moments of a closed mesh about the middle of its bounds: those of the tetrahedra between its triangles and this point.
pub(super) fn of_mesh(mesh: &Mesh) -> Result<Moments> {
    check_closed(mesh)?;
    let origin = middle(mesh);
    let whole = moments(mesh.corners().map(|corners| corners.map(|corner| corner - origin)));
    let mut moments = Moments { origin, volume: whole.volume, first: whole.first, second: whole.second };
    let [least, greatest] = mesh.bounds().map(|corner| DVec3::from_array(corner.map(f64::from)));
    let size = (greatest - least).max_element();
    if moments.volume.abs() <= 1e-9 * size.powi(3) {
        return Err(invalid("mesh", format!("a mesh with a volume of {:e}", moments.volume), "a mesh that encloses a volume"));
    }
    if moments.volume < 0.0 {
        // All triangles are clockwise seen from outside.
        (moments.volume, moments.first, moments.second) = (-moments.volume, -moments.first, -moments.second);
    }
    Ok(moments)
}

/// Checks that every edge has as many triangles on one side as on the other.
fn check_closed(mesh: &Mesh) -> Result<()> {
    let mut edges: HashMap<[u32; 2], (i32, u32)> = HashMap::new();
    for triangle in &mesh.triangles {
        for side in 0..3 {
            let (from, to) = (triangle[side], triangle[(side + 1) % 3]);
            let (balance, count) = edges.entry([from.min(to), from.max(to)]).or_default();
            *balance += if from < to { 1 } else { -1 };
            *count += 1;
        }
    }
    let wrong = |is_wrong: fn(&(i32, u32)) -> bool| {
        let found = edges.iter().filter(|(_, edge)| is_wrong(edge)).map(|(ends, _)| *ends);
        // The least one, because a hash map has no order.
        (found.clone().count(), found.min())
    };
    let at = |vertex: u32| mesh.vertices[vertex as usize];
    let expected = "a closed mesh, whose triangles are all counter-clockwise seen from outside";
    if let (count, Some([a, b])) = wrong(|(_, count)| count % 2 == 1) {
        let left_out = if mesh.left_out > 0 {
            format!(", after {} degenerate triangles were left out", mesh.left_out)
        } else {
            String::new()
        };
        let value =
            format!("a mesh that is not closed, with {count} open edges such as from {:?} to {:?}{left_out}", at(a), at(b));
        return Err(invalid("mesh", value, expected));
    }
    if let (count, Some([a, b])) = wrong(|(balance, _)| *balance != 0) {
        let value =
            format!("a mesh with {count} edges between triangles of opposite sense, such as from {:?} to {:?}", at(a), at(b));
        return Err(invalid("mesh", value, expected));
    }
    Ok(())
}
