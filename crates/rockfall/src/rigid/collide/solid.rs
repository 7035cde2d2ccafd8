//! Vertices, faces and edges of a core.

use glam::Vec3;

use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, MOST_FACES};

/// Greatest number of vertices of a polyhedron with [`MOST_FACES`] faces, rounded up.
pub(super) const MOST_VERTICES: usize = 64;

/// A core as a polyhedron, in coordinates of the caller. A segment has two vertices and no faces, a point one.
///
/// A face is a slab without thickness: face 0 lies at +z and face 1 at -z, and those from 2 on are its sides, which have only
/// two vertices. So each edge of the polygon counts twice: between +z and a side, and between a side and -z.
pub(super) struct Solid<'a> {
    vertices: [Vec3; MOST_VERTICES],
    vertex_count: usize,
    normals: [Vec3; MOST_FACES],
    loops: Loops<'a>,
    /// Two vertices, and the two faces beside the edge.
    pub(super) edges: &'a [[u8; 4]],
    /// The inside.
    pub(super) centre: Vec3,
}

/// Vertices of the faces.
enum Loops<'a> {
    Fixed(&'static [&'static [u8]]),
    Hull(&'a [(Vec3, Vec<u8>)]),
}

/// Vertex k of a box has coordinate i positive if bit i of k is set. Faces are +x, -x, +y, -y, +z, -z.
const BOX_LOOPS: [&[u8]; 6] = [&[1, 3, 7, 5], &[0, 4, 6, 2], &[2, 6, 7, 3], &[0, 1, 5, 4], &[4, 5, 7, 6], &[0, 2, 3, 1]];
const BOX_EDGES: [[u8; 4]; 12] = [
    [0, 1, 3, 5],
    [2, 3, 2, 5],
    [4, 5, 3, 4],
    [6, 7, 2, 4],
    [0, 2, 1, 5],
    [1, 3, 0, 5],
    [4, 6, 1, 4],
    [5, 7, 0, 4],
    [0, 4, 1, 3],
    [1, 5, 0, 3],
    [2, 6, 1, 2],
    [3, 7, 0, 2],
];
const FACE_LOOPS: [&[u8]; 6] = [&[0, 1, 2, 3], &[3, 2, 1, 0], &[0, 1], &[1, 2], &[2, 3], &[3, 0]];
const FACE_EDGES: [[u8; 4]; 8] =
    [[0, 1, 0, 2], [1, 2, 0, 3], [2, 3, 0, 4], [3, 0, 0, 5], [0, 1, 1, 2], [1, 2, 1, 3], [2, 3, 1, 4], [3, 0, 1, 5]];
const TRIANGLE_LOOPS: [&[u8]; 5] = [&[0, 1, 2], &[2, 1, 0], &[0, 1], &[1, 2], &[2, 0]];
const TRIANGLE_EDGES: [[u8; 4]; 6] = [[0, 1, 0, 2], [1, 2, 0, 3], [2, 0, 0, 4], [0, 1, 1, 2], [1, 2, 1, 3], [2, 0, 1, 4]];

impl<'a> Solid<'a> {
    /// The polyhedron of a core in a pose. Smooth walls have no vertices.
    pub(super) fn new(core: &'a Core, pose: &Pose) -> Self {
        let mut solid = Solid {
            vertices: [Vec3::ZERO; MOST_VERTICES],
            vertex_count: 0,
            normals: [Vec3::ZERO; MOST_FACES],
            loops: Loops::Fixed(&[]),
            edges: &[],
            centre: pose.position,
        };
        match core {
            Core::HalfSpace | Core::Cone { .. } | Core::Bowl { .. } => {}
            Core::Point => solid.set_vertices([Vec3::ZERO]),
            Core::Segment { half } => solid.set_vertices([Vec3::new(0.0, -half, 0.0), Vec3::new(0.0, *half, 0.0)]),
            Core::Face { u, v, is_triangle, .. } => {
                let (corners, count) = face_corners(*u, *v, *is_triangle);
                solid.set_face(&corners[..count]);
            }
            Core::Box { half } => {
                solid.set_vertices((0..8).map(|k| box_vertex(*half, k)));
                (solid.loops, solid.edges) = (Loops::Fixed(&BOX_LOOPS), &BOX_EDGES);
                for axis in 0..3 {
                    solid.normals[2 * axis] = Vec3::AXES[axis];
                    solid.normals[2 * axis + 1] = -Vec3::AXES[axis];
                }
            }
            Core::Hull(hull) => {
                solid.set_vertices(hull.vertices.iter().copied());
                (solid.loops, solid.edges) = (Loops::Hull(&hull.faces), &hull.edges);
                for (normal, (of_face, _)) in solid.normals.iter_mut().zip(&hull.faces) {
                    *normal = *of_face;
                }
            }
        }
        if *pose != Pose::IDENTITY {
            let faces = solid.face_count();
            solid.vertices[..solid.vertex_count].iter_mut().for_each(|vertex| *vertex = pose.point(*vertex));
            solid.normals[..faces].iter_mut().for_each(|normal| *normal = pose.turn * *normal);
        }
        solid
    }

    fn set_vertices(&mut self, vertices: impl IntoIterator<Item = Vec3>) {
        for vertex in vertices.into_iter().take(MOST_VERTICES) {
            self.vertices[self.vertex_count] = vertex;
            self.vertex_count += 1;
        }
    }

    fn set_face(&mut self, corners: &[Vec3]) {
        self.set_vertices(corners.iter().copied());
        (self.loops, self.edges) = if corners.len() == 3 {
            (Loops::Fixed(&TRIANGLE_LOOPS), &TRIANGLE_EDGES[..])
        } else {
            (Loops::Fixed(&FACE_LOOPS), &FACE_EDGES[..])
        };
        (self.normals[0], self.normals[1]) = (Vec3::Z, -Vec3::Z);
        for (k, corner) in corners.iter().enumerate() {
            let side = (corners[(k + 1) % corners.len()] - *corner).cross(Vec3::Z);
            self.normals[2 + k] = side.normalize_or(Vec3::X);
        }
    }

    pub(super) fn vertices(&self) -> &[Vec3] {
        &self.vertices[..self.vertex_count]
    }

    pub(super) fn face_count(&self) -> usize {
        match self.loops {
            Loops::Fixed(loops) => loops.len(),
            Loops::Hull(faces) => faces.len().min(MOST_FACES),
        }
    }

    /// Vertices of a face, counterclockwise from outside.
    pub(super) fn loop_of(&self, face: usize) -> &[u8] {
        match self.loops {
            Loops::Fixed(loops) => loops[face],
            Loops::Hull(faces) => &faces[face].1,
        }
    }

    pub(super) fn vertex(&self, number: u8) -> Vec3 {
        self.vertices[number as usize]
    }

    /// Outward unit normals of the faces.
    pub(super) fn normals(&self) -> &[Vec3] {
        &self.normals[..self.face_count()]
    }

    /// A point in the plane of a face.
    pub(super) fn anchor(&self, face: usize) -> Vec3 {
        self.vertex(self.loop_of(face)[0])
    }

    /// The least coordinate of the vertices along an axis.
    pub(super) fn least(&self, axis: Vec3) -> f32 {
        self.vertices().iter().map(|vertex| vertex.dot(axis)).fold(f32::INFINITY, f32::min)
    }

    /// The face at the lowest vertex along an axis whose normal is most against the axis; the first of equal ones. A face
    /// elsewhere may be more against it, but does not have the lowest point.
    pub(super) fn face_against(&self, axis: Vec3) -> usize {
        let mut low = (f32::INFINITY, 0);
        for (number, vertex) in self.vertices().iter().enumerate() {
            let height = vertex.dot(axis);
            if height < low.0 {
                low = (height, number as u8);
            }
        }
        let mut best = (f32::INFINITY, 0);
        for (face, normal) in self.normals().iter().enumerate() {
            let product = normal.dot(axis);
            // The margin keeps the choice when rounding alone would change it.
            if product < best.0 - 1e-4 && self.loop_of(face).contains(&low.1) {
                best = (product, face);
            }
        }
        best.1
    }

    /// Greatest coordinate of a vertex about the centre: the scale of rounding errors.
    pub(super) fn scale(&self) -> f32 {
        self.vertices().iter().map(|vertex| (*vertex - self.centre).abs().max_element()).fold(0.0, f32::max)
    }
}

/// The corners of a face, counterclockwise from +z, and how many there are: three or four.
pub(super) fn face_corners(u: Vec3, v: Vec3, is_triangle: bool) -> ([Vec3; 4], usize) {
    if is_triangle {
        return ([u, v, -u - v, u], 3);
    }
    let v = if u.cross(v).z < 0.0 { -v } else { v };
    ([-u - v, u - v, u + v, v - u], 4)
}

/// Vertex k of a box.
pub(super) fn box_vertex(half: Vec3, k: usize) -> Vec3 {
    let sign = |bit: usize| if k & bit != 0 { 1.0 } else { -1.0 };
    half * Vec3::new(sign(1), sign(2), sign(4))
}
