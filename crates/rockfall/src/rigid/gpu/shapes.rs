//! Rows of colliders and lists of hulls. `rigid/frame/colliders.wgsl` and `rigid/collide/solid.wgsl` have the same for the device.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::rigid::shape::{Core, Hull, Shape};
use crate::rigid::world::RigidWorld;

/// A shape.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ShapeRow {
    pub(crate) size: [f32; 4],
    pub(crate) radius: f32,
    pub(crate) core: u32,
    pub(crate) more: u32,
    pub(crate) spare: u32,
}

/// A collider with its shape.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct ColliderRow {
    pub(crate) position: [f32; 3],
    pub(crate) body: u32,
    pub(crate) turn: [f32; 4],
    pub(crate) group: u32,
    pub(crate) material: u32,
    /// 1 if its surface has a velocity of its own.
    pub(crate) belt: u32,
    pub(crate) meets: u32,
    pub(crate) shape: ShapeRow,
}

const _: () = assert!(size_of::<ColliderRow>() == 5 * 16);

/// The colliders of a world, and the lists of its hulls.
pub(crate) fn collider_rows(world: &RigidWorld) -> (Vec<ColliderRow>, Vec<[u32; 4]>) {
    let mut hulls = Vec::new();
    let shapes: Vec<ShapeRow> = world.shapes.iter().map(|shape| shape_row(shape, &mut hulls)).collect();
    let row = |collider: &crate::rigid::world::Collider| ColliderRow {
        position: collider.place.position.to_array(),
        body: collider.body,
        turn: collider.place.turn.to_array(),
        group: collider.group.own,
        material: collider.material.into(),
        belt: u32::from(collider.surface_velocity != Vec3::ZERO),
        meets: collider.group.meets,
        shape: shapes[collider.shape as usize],
    };
    (world.colliders.iter().map(row).collect(), hulls)
}

/// The row of a shape. The lists of a hull go to `hulls`.
pub(crate) fn shape_row(shape: &Shape, hulls: &mut Vec<[u32; 4]>) -> ShapeRow {
    let (size, core, more) = match &shape.core {
        Core::HalfSpace => ([0.0; 4], 0, 0),
        Core::Cone { half, radii: [low, high], inside } => ([*half, *low, *high, 0.0], 0, 1 + u32::from(*inside)),
        Core::Bowl { radius } => ([*radius, 0.0, 0.0, 0.0], 0, 3),
        Core::Face { u, v, is_triangle, one_sided, is_facet } => {
            let more = u32::from(*one_sided) | u32::from(*is_triangle) << 1 | u32::from(*is_facet) << 2;
            ([u.x, u.y, v.x, v.y], 1, more)
        }
        Core::Box { half } => ([half.x, half.y, half.z, 0.0], 2, 0),
        Core::Hull(hull) => ([0.0; 4], 3, put_hull(hull, shape.width(), hulls)),
        Core::Segment { half } => ([*half, 0.0, 0.0, 0.0], 4, 0),
        Core::Point => ([0.0; 4], 5, 0),
    };
    ShapeRow { size, radius: shape.radius, core, more, spare: 0 }
}

fn put_hull(hull: &Hull, width: f32, words: &mut Vec<[u32; 4]>) -> u32 {
    let at = words.len() as u32;
    let [x, y, z] = [hull.vertices.len(), hull.faces.len(), hull.edges.len()].map(|count| count as u32);
    words.push([x, y, z, width.to_bits()]);
    let bits = |vector: Vec3, last: u32| [vector.x.to_bits(), vector.y.to_bits(), vector.z.to_bits(), last];
    words.extend(hull.vertices.iter().map(|vertex| bits(*vertex, 0)));
    let mut first = 0;
    for (normal, corners) in &hull.faces {
        words.push(bits(*normal, first | (corners.len() as u32) << 16));
        first += corners.len() as u32;
    }
    let mut bytes: Vec<u8> = hull.edges.iter().flatten().copied().collect();
    bytes.resize(bytes.len().next_multiple_of(16), 0);
    bytes.extend(hull.faces.iter().flat_map(|(_, corners)| corners.iter().copied()));
    bytes.resize(bytes.len().next_multiple_of(16), 0);
    let word = |bytes: &[u8]| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    words.extend(bytes.chunks(16).map(|row| [0, 4, 8, 12].map(|place| word(&row[place..]))));
    at
}
