//! The mesh of a coil: a strip, which `wgsl/coil.wgsl` bends to the half of a tube that faces the viewer.

use rockfall::wgpu;
use rockfall::wgpu::util::{BufferInitDescriptor, DeviceExt as _};

/// Resolution of the mesh of a coil.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Resolution {
    /// Number of segments along the wire.
    pub(crate) segments: u32,
    /// Number of vertices across the wire, at least two.
    pub(crate) sides: u32,
}

impl Resolution {
    /// Returns the resolution for a number of coils: the more there are, the coarser each is.
    pub(crate) fn of(coils: u32) -> Self {
        let (segments, sides) = match coils {
            0..=40 => (96, 4),
            41..=200 => (72, 3),
            201..=5_000 => (48, 2),
            _ => (36, 2),
        };
        Self { segments, sides }
    }

    pub(crate) fn indices(self) -> u32 {
        6 * self.segments * (self.sides - 1)
    }
}

/// Returns the vertex indices of the triangles. Vertices are numbered across the wire first, then along it.
fn triangles(Resolution { segments, sides }: Resolution) -> Vec<u32> {
    let mut indices = Vec::new();
    for segment in 0..segments {
        for side in 0..sides - 1 {
            let next = side + 1;
            let corners = [(segment, side), (segment, next), (segment + 1, side), (segment + 1, next)];
            let [a, b, c, d] = corners.map(|(p, s)| p * sides + s);
            indices.extend([a, b, c, c, b, d]);
        }
    }
    indices
}

/// The mesh of a coil in an index buffer.
#[derive(Debug)]
pub(crate) struct CoilMesh {
    pub(crate) resolution: Resolution,
    pub(crate) indices: wgpu::Buffer,
}

impl CoilMesh {
    pub(crate) fn new(device: &wgpu::Device, resolution: Resolution) -> Self {
        let contents = bytemuck::cast_slice(&triangles(resolution)).to_vec();
        let usage = wgpu::BufferUsages::INDEX;
        let indices = device.create_buffer_init(&BufferInitDescriptor { label: Some("coil"), contents: &contents, usage });
        Self { resolution, indices }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strip_has_one_rim() {
        let resolution = Resolution { segments: 3, sides: 4 };
        let indices = triangles(resolution);
        assert_eq!(indices.len() as u32, resolution.indices());
        // Every edge occurs once in each direction, except those of the two rims.
        let mut edges = std::collections::HashMap::new();
        for triangle in indices.chunks(3) {
            for k in 0..3 {
                *edges.entry((triangle[k], triangle[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|count| *count == 1));
        let open: Vec<_> = edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).collect();
        // Three edges at each end, and three along each side.
        assert_eq!(open.len(), 12);
        let side = |vertex: u32| vertex.is_multiple_of(4) || vertex % 4 == 3;
        assert!(open.iter().all(|(a, b)| (*a < 4 && *b < 4) || (*a >= 12 && *b >= 12) || side(*a) && side(*b)));
    }
}
