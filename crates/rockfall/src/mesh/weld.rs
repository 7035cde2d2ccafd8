//! Welds equal vertices, and leaves out degenerate triangles.

use std::collections::HashMap;

use super::{Mesh, position};

/// The greatest area of a degenerate triangle, over the square of its longest edge.
const FLAT: f64 = 1e-12;

/// A vertex that has no number yet.
const UNUSED: u32 = u32::MAX;

/// The mesh of valid vertices and triangles. A vertex gets its number when a triangle first uses it, so the order does not depend on
/// that of a map.
pub(super) fn welded(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::with_capacity(triangles.len()), left_out: 0 };
    let mut numbers = vec![UNUSED; vertices.len()];
    let mut known = HashMap::new();
    for triangle in triangles {
        if is_degenerate(triangle.map(|at| vertices[at as usize])) {
            mesh.left_out += 1;
            continue;
        }
        mesh.triangles.push(triangle.map(|at| {
            let number = &mut numbers[at as usize];
            if *number == UNUSED {
                // The sum turns -0 into 0.
                let vertex = vertices[at as usize].map(|x| x + 0.0);
                *number = *known.entry(vertex.map(f32::to_bits)).or_insert_with(|| {
                    mesh.vertices.push(vertex);
                    mesh.vertices.len() as u32 - 1
                });
            }
            *number
        }));
    }
    mesh
}

/// Whether the area of a triangle is at most [`FLAT`] times the square of its longest edge.
fn is_degenerate(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(position);
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    0.5 * (b - a).cross(c - a).length() <= FLAT * longest
}
