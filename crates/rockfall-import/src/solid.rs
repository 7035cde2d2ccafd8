//! Solids of geoms: their mass properties, and the convex hulls that stand for them.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rockfall::glam::{DMat3, DVec3};
use rockfall::{Mesh, Shape};

use crate::mass::{Mass, Pose};

/// Sides of the prism in place of a cylinder.
const SIDES: usize = 16;
/// Part of the size by which a reduced hull may miss a vertex of its mesh.
const CLOSE: f64 = 2e-3;

/// A solid in coordinates of its own. Axes are that of z.
#[derive(Clone, Debug)]
pub(crate) enum Solid {
    Sphere {
        radius: f64,
    },
    Capsule {
        radius: f64,
        half: f64,
    },
    Cylinder {
        radius: f64,
        half: f64,
    },
    Box {
        half: DVec3,
    },
    Ellipsoid {
        radii: DVec3,
    },
    Mesh(Arc<Points>),
    /// Touched on the side of z.
    Plane,
}

/// The vertices of a mesh.
#[derive(Debug)]
pub(crate) struct Points {
    /// Those of a hull that the engine takes.
    pub(crate) hull: Vec<DVec3>,
    /// Whether vertices of the mesh lie outside of that hull.
    pub(crate) is_reduced: bool,
    /// That of the density 1.
    pub(crate) mass: Mass,
}

impl Solid {
    /// The mass properties with a density.
    pub(crate) fn mass(&self, density: f64) -> Mass {
        match *self {
            Self::Sphere { radius } => {
                let mass = density * 4.0 / 3.0 * PI * radius.powi(3);
                Mass::diagonal(mass, DVec3::splat(0.4 * mass * radius * radius))
            }
            Self::Capsule { radius, half } => capsule(density, radius, half),
            Self::Cylinder { radius, half } => {
                let mass = density * PI * radius * radius * 2.0 * half;
                let across = mass * (radius * radius / 4.0 + half * half / 3.0);
                Mass::diagonal(mass, DVec3::new(across, across, mass * radius * radius / 2.0))
            }
            Self::Box { half } => {
                let mass = density * 8.0 * half.element_product();
                Mass::diagonal(mass, others(half * half) * mass / 3.0)
            }
            Self::Ellipsoid { radii } => {
                let mass = density * 4.0 / 3.0 * PI * radii.element_product();
                Mass::diagonal(mass, others(radii * radii) * mass / 5.0)
            }
            Self::Mesh(ref points) => points.mass.scaled(density),
            Self::Plane => Mass::NONE,
        }
    }

    /// The points of the hull that stands for a solid that the engine does not have.
    pub(crate) fn hull(&self) -> Option<Vec<DVec3>> {
        match self {
            Self::Cylinder { radius, half } => Some(prism(*radius, *half)),
            Self::Ellipsoid { radii } => Some(ball().into_iter().map(|point| *radii * point).collect()),
            Self::Mesh(points) => Some(points.hull.clone()),
            _ => None,
        }
    }
}

/// The sums of the other two components.
fn others(squares: DVec3) -> DVec3 {
    DVec3::new(squares.y + squares.z, squares.z + squares.x, squares.x + squares.y)
}

fn capsule(density: f64, radius: f64, half: f64) -> Mass {
    let (length, square) = (2.0 * half, radius * radius);
    let (tube, ball) = (density * PI * square * length, density * 4.0 / 3.0 * PI * square * radius);
    let along = tube * square / 2.0 + ball * 0.4 * square;
    // Each half of the ball has its centre 3/8 of the radius beyond the end of the tube.
    let of_ball = 0.4 * square + half * half + 0.75 * half * radius;
    let across = tube * (square / 4.0 + length * length / 12.0) + ball * of_ball;
    Mass::diagonal(tube + ball, DVec3::new(across, across, along))
}

/// A prism with the volume of the cylinder.
fn prism(radius: f64, half: f64) -> Vec<DVec3> {
    let angle = TAU / SIDES as f64;
    let outer = radius * (angle / angle.sin()).sqrt();
    let corner = |k: usize, z: f64| {
        let (sin, cos) = (angle * (k as f64 + 0.5)).sin_cos();
        DVec3::new(outer * cos, outer * sin, z)
    };
    (0..SIDES).flat_map(|k| [corner(k, -half), corner(k, half)]).collect()
}

/// Points of the unit ball: poles and rings of 5, turned against each other, and 4 on the equator. A hull of 16 vertices
/// has at most 28 faces.
fn ball() -> Vec<DVec3> {
    let ring = |height: f64, shift: f64| {
        let radius = (1.0 - height * height).sqrt();
        (0..5).map(move |k| {
            let (sin, cos) = (TAU * (f64::from(k) + shift) / 5.0).sin_cos();
            DVec3::new(radius * cos, radius * sin, height)
        })
    };
    let height = 1.0 / 5.0_f64.sqrt();
    let equator = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];
    [DVec3::Z, DVec3::NEG_Z].into_iter().chain(equator).chain(ring(height, 0.25).chain(ring(-height, 0.75))).collect()
}

impl Points {
    /// The hull and the mass of a mesh. `None` if its vertices lie in one plane.
    pub(crate) fn of(mesh: &Mesh) -> Option<Self> {
        let vertices: Vec<DVec3> = mesh.vertices.iter().map(|vertex| DVec3::from_array(vertex.map(f64::from))).collect();
        let (hull, is_reduced) = reduced(&vertices)?;
        let mass = enclosed(&vertices, &mesh.triangles).or_else(|| {
            let (points, triangles) = surface(&hull)?;
            enclosed(&points, &triangles)
        })?;
        Some(Self { hull, is_reduced, mass })
    }
}

/// The vertices of the hull, or those of a part of it that the engine takes: the farthest vertex outside is added again and again.
fn reduced(vertices: &[DVec3]) -> Option<(Vec<DVec3>, bool)> {
    let size = vertices.iter().map(|vertex| vertex.abs().max_element()).fold(0.0, f64::max);
    let least = vertices.iter().copied().reduce(DVec3::min)?;
    let greatest = vertices.iter().copied().reduce(DVec3::max)?;
    let extent = (greatest - least).max_element();
    let mut chosen = first_four(vertices)?;
    let mut hull = None;
    // A hull has at most 60 vertices with 32 faces.
    for _ in 0..60 {
        let Some((points, triangles)) = surface(&chosen) else { break };
        let planes: Vec<(DVec3, f64)> = triangles.iter().map(|triangle| plane(&points, triangle)).collect();
        hull = Some(chosen.clone());
        let height = |vertex: DVec3| planes.iter().map(|(normal, offset)| normal.dot(vertex) - offset).fold(f64::MIN, f64::max);
        let heights = vertices.iter().map(|vertex| (height(*vertex), *vertex));
        let (farthest, vertex) = heights.max_by(|one, other| one.0.total_cmp(&other.0))?;
        if farthest <= (CLOSE * extent).max(1e-6 * size) {
            return Some((chosen, farthest > 1e-5 * extent));
        }
        chosen.push(vertex);
    }
    Some((hull?, true))
}

/// Four points that span a volume.
fn first_four(vertices: &[DVec3]) -> Option<Vec<DVec3>> {
    let farthest = |from: &dyn Fn(DVec3) -> f64| vertices.iter().copied().max_by(|a, b| from(*a).total_cmp(&from(*b)));
    let a = farthest(&|p| -p.x)?;
    let b = farthest(&|p| p.distance_squared(a))?;
    let along = (b - a).try_normalize()?;
    let c = farthest(&|p| (p - a).reject_from_normalized(along).length_squared())?;
    let normal = along.cross(c - a).try_normalize()?;
    let d = farthest(&|p| (p - a).dot(normal).abs())?;
    Some(vec![a, b, c, d])
}

type Surface = (Vec<DVec3>, Vec<[u32; 3]>);

/// The triangles of a hull. `None` if the engine does not take it.
pub(crate) fn surface(points: &[DVec3]) -> Option<Surface> {
    let shape = Shape::new().add_hull(points.iter().map(|point| point.as_vec3())).ok()?;
    let corners: Vec<DVec3> = shape.hulls.first()?.triangles().flatten().map(|corner| corner.as_dvec3()).collect();
    let triangles = (0..corners.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Some((corners, triangles))
}

fn plane(points: &[DVec3], triangle: &[u32; 3]) -> (DVec3, f64) {
    let [a, b, c] = triangle.map(|at| points[at as usize]);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    (normal, normal.dot(a))
}

/// The mass properties of what a closed surface encloses, with the density 1. `None` if it encloses nothing.
fn enclosed(points: &[DVec3], triangles: &[[u32; 3]]) -> Option<Mass> {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|at| points[at as usize] - middle);
        let part = a.dot(b.cross(c)) / 6.0;
        let sum = a + b + c;
        volume += part;
        first += part * sum / 4.0;
        let outer = |p: DVec3| DMat3::from_cols(p * p.x, p * p.y, p * p.z);
        second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (part / 20.0);
    }
    if volume < 0.0 {
        (volume, first, second) = (-volume, -first, second * -1.0);
    }
    let size = points.iter().map(|point| (*point - middle).abs().max_element()).fold(0.0, f64::max);
    if volume <= 1e-9 * size.powi(3) {
        return None;
    }
    let centre = first / volume;
    let outer = DMat3::from_cols(centre * centre.x, centre * centre.y, centre * centre.z) * volume;
    let second = second - outer;
    let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
    let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - second;
    let mass = Mass { mass: volume, centre, inertia };
    Some(mass.moved(&Pose { at: middle, ..Pose::NONE }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fine prism and a fine ball have almost the moments of the solids.
    #[test]
    fn masses_of_solids() {
        let half = DVec3::new(0.1, 0.2, 0.3);
        let corners: Vec<DVec3> = (0..8).map(|k| half * DVec3::new(sign(k, 1), sign(k, 2), sign(k, 4))).collect();
        let (points, triangles) = surface(&corners).unwrap();
        let (mesh, exact) = (enclosed(&points, &triangles).unwrap(), Solid::Box { half }.mass(1.0));
        assert!((mesh.mass - exact.mass).abs() < 1e-7);
        assert!((mesh.inertia - exact.inertia).abs_diff_eq(DMat3::ZERO, 1e-8));
        let capsule = Solid::Capsule { radius: 0.2, half: 0.3 }.mass(1000.0);
        let sphere = Solid::Sphere { radius: 0.2 }.mass(1000.0);
        let tube = Solid::Cylinder { radius: 0.2, half: 0.3 }.mass(1000.0);
        assert!((capsule.mass - sphere.mass - tube.mass).abs() < 1e-9);
        assert!((capsule.inertia.z_axis.z - sphere.inertia.z_axis.z - tube.inertia.z_axis.z).abs() < 1e-9);
        let shape = Shape::new().capsule([0.0, 0.0, -0.3], [0.0, 0.0, 0.3], 0.2).density(1000.0).mass_properties_of().unwrap();
        assert!((shape.inertia[0] / capsule.inertia.x_axis.x - 1.0).abs() < 1e-3, "{shape:?} {capsule:?}");
    }

    fn sign(k: u32, bit: u32) -> f64 {
        if k & bit == 0 { -1.0 } else { 1.0 }
    }

    /// The engine takes the hulls of all sizes, and they are nearly as large as the solids.
    #[test]
    fn hulls_are_taken() {
        for scale in [1e-3, 0.05, 1.0, 40.0] {
            for solid in [
                Solid::Cylinder { radius: scale, half: 0.3 * scale },
                Solid::Cylinder { radius: 0.1 * scale, half: 3.0 * scale },
                Solid::Ellipsoid { radii: scale * DVec3::new(1.0, 0.5, 2.0) },
            ] {
                let (points, triangles) = surface(&solid.hull().unwrap()).unwrap();
                let share = enclosed(&points, &triangles).unwrap().mass / solid.mass(1.0).mass;
                assert!((0.6..1.01).contains(&share), "{solid:?}: {share}");
            }
        }
    }

    #[test]
    fn meshes_of_many_vertices_are_reduced() {
        let mut vertices = Vec::new();
        for k in 0..2000 {
            let height = 1.0 - (2.0 * f64::from(k) + 1.0) / 2000.0;
            let (sin, cos) = (f64::from(k) * 2.4).sin_cos();
            let radius = (1.0 - height * height).sqrt();
            vertices.push(DVec3::new(radius * cos, radius * sin, height));
        }
        let (hull, is_reduced) = reduced(&vertices).unwrap();
        assert!(is_reduced && hull.len() >= 12, "{}", hull.len());
        assert!(surface(&hull).is_some());
        assert_eq!(reduced(&vertices[..4]).map(|(hull, _)| hull.len()), Some(4));
        assert!(reduced(&[DVec3::X, DVec3::Y, DVec3::Z]).is_none());
    }
}
