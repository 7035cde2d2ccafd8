//! The triangles of a coil: a tube of pieces and sides, whose corners `wgsl/coil.wgsl` puts in their places.

use rockfall::wgpu;
use rockfall::wgpu::util::{BufferInitDescriptor, DeviceExt as _};

/// How finely coils are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fineness {
    /// Pieces along the wire.
    pub(crate) pieces: u32,
    /// Sides of the wire.
    pub(crate) sides: u32,
}

impl Fineness {
    /// The more coils there are, the coarser each.
    pub(crate) fn of(coils: u32) -> Self {
        let (pieces, sides) = match coils {
            0..=500 => (112, 7),
            501..=5_000 => (84, 5),
            _ => (56, 3),
        };
        Self { pieces, sides }
    }

    pub(crate) fn indices(self) -> u32 {
        6 * self.pieces * self.sides
    }
}

/// Corners are numbered round the wire, then along it.
fn triangles(Fineness { pieces, sides }: Fineness) -> Vec<u32> {
    let mut indices = Vec::new();
    for piece in 0..pieces {
        for side in 0..sides {
            let next = (side + 1) % sides;
            let [a, b, c, d] = [(piece, side), (piece, next), (piece + 1, side), (piece + 1, next)].map(|(p, s)| p * sides + s);
            indices.extend([a, b, c, c, b, d]);
        }
    }
    indices
}

/// The triangles in a buffer.
#[derive(Debug)]
pub(crate) struct CoilMesh {
    pub(crate) fineness: Fineness,
    pub(crate) indices: wgpu::Buffer,
}

impl CoilMesh {
    pub(crate) fn new(device: &wgpu::Device, fineness: Fineness) -> Self {
        let contents = bytemuck::cast_slice(&triangles(fineness)).to_vec();
        let usage = wgpu::BufferUsages::INDEX;
        let indices = device.create_buffer_init(&BufferInitDescriptor { label: Some("coil"), contents: &contents, usage });
        Self { fineness, indices }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tubes_are_closed_around_and_open_at_the_ends() {
        let fineness = Fineness { pieces: 3, sides: 4 };
        let indices = triangles(fineness);
        assert_eq!(indices.len() as u32, fineness.indices());
        // Every edge is met once in either direction, but for those of the two rims.
        let mut edges = std::collections::HashMap::new();
        for triangle in indices.chunks(3) {
            for k in 0..3 {
                *edges.entry((triangle[k], triangle[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|count| *count == 1));
        let open: Vec<_> = edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).collect();
        assert_eq!(open.len(), 8);
        assert!(open.iter().all(|(a, b)| (*a < 4 && *b < 4) || (*a >= 12 && *b >= 12)));
    }
}
