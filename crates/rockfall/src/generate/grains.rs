//! Scenes of grains with the contact law `hertz-mindlin`, in SI units: a drum, and a column that collapses.

use std::f32::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::clumps::turn;
use super::{Random, check_count};
use crate::error::{Error, Result};
use crate::scene::{Cuboid, Material, MaterialId, Motion, MotionTerm, Pair, Placement, Polygon, Scene, Shape, Sphere};
use crate::settings::ContactLaw;

/// Share of the volume that grains take in a bed at rest.
const BED: f32 = 0.6;
/// Edge of the cell in which a grain starts, in diameters. A cell is a little larger than its grain, so that grains of a
/// lattice lose their order when they fall into place.
pub(super) const CELL: f32 = 1.06;
/// Gravity, in m/s².
pub(super) const GRAVITY: f32 = 9.81;

/// Description of a drum with grains in it, in SI units. Its axis is the z axis, and its middle is the origin.
///
/// The walls turn with [`Drum::spin`], or the drum stands still and rotates in its own frame of reference, where the direction of gravity
/// turns: [`Drum::down`]. In that frame, the centrifugal and the Coriolis force are left out. The former is smaller than gravity by the
/// Froude number w² R / g, which is 0.03 at 12 revolutions per minute and a radius of 0.2 m.
///
/// Grains and walls are those of the benchmark of PhasicFlow 1.0 (Norouzi, *Comput. Phys. Commun.* 291, 108821 (2023)):
/// 2500 kg/m³, an effective modulus of 1 MPa, restitution 0.97 (0.85 at the walls), friction 0.65 and rolling friction 0.1
/// with model C.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Drum {
    /// Number of grains.
    pub grains: u32,
    /// Radius of the grains, in m.
    pub radius: f32,
    /// Number of polygons around the axis, from 6 to 10,000.
    pub facets: u32,
    /// Length of the drum over its radius, from 0.01 to 100.
    pub length: f32,
    /// Share of the drum that the bed fills at rest, from 0.01 to 0.6.
    pub filling: f32,
    /// Friction of grains with each other and with the polygons.
    pub friction: f32,
    /// Whether the end walls have friction. Smooth ones are those of a slice of a long drum.
    pub rough_ends: bool,
    /// Angular velocity of the walls about the z axis, in rad/s. 0: they stand still.
    pub spin: f64,
    /// Whether the wall consists of triangles, about as long as wide, instead of polygons as long as the drum.
    pub triangles: bool,
    /// Whether a grain is a rigid body of three spheres, which just fit into a sphere of its radius.
    pub clumps: bool,
}

impl Drum {
    /// The time step of the benchmark, in s.
    pub const STEP: f32 = 1e-5;

    /// Describes a drum as in the benchmark: its length is 4 times its radius, which is 0.2 m for 1,000,000 grains of radius
    /// 2 mm.
    pub fn new(grains: u32) -> Self {
        let filling = 5.0 / 9.0;
        Self {
            grains,
            radius: 0.002,
            facets: 48,
            length: 4.0,
            filling,
            friction: 0.65,
            rough_ends: true,
            spin: 0.0,
            triangles: false,
            clumps: false,
        }
    }

    /// Lets the walls turn by `spin` rad/s about the z axis, by a motion with the name `drum`.
    pub fn spin(mut self, spin: f64) -> Self {
        self.spin = spin;
        self
    }

    /// Makes the wall of triangles.
    pub fn triangles(mut self) -> Self {
        self.triangles = true;
        self
    }

    /// Makes grains of three spheres each.
    pub fn clumps(mut self) -> Self {
        self.clumps = true;
        self
    }

    /// Direction of gravity in the frame of a drum that has turned by an angle, in rad, about the z axis.
    pub fn down(turned: f64) -> Vec3 {
        Vec3::new(-turned.sin() as f32, -turned.cos() as f32, 0.0)
    }

    /// Radius of the drum, in m: the distance of the polygons from the axis.
    ///
    /// # Errors
    /// As for [`Drum::scene`].
    pub fn drum_radius(&self) -> Result<f32> {
        Ok(self.places()?.0)
    }

    fn validate(&self) -> Result<()> {
        check_count(self.grains)?;
        let check = |field: &'static str, value: f32, range: std::ops::RangeInclusive<f32>, expected: &'static str| {
            if range.contains(&value) { Ok(()) } else { Err(Error::Invalid { field, value: value.to_string(), expected }) }
        };
        check("drum.radius", self.radius, 1e-6..=1e3, "from 1e-6 to 1000")?;
        check("drum.facets", self.facets as f32, 6.0..=1e4, "from 6 to 10000")?;
        check("drum.length", self.length, 0.01..=100.0, "from 0.01 to 100")?;
        check("drum.filling", self.filling, 0.01..=0.6, "from 0.01 to 0.6")?;
        check("drum.friction", self.friction, 0.0..=100.0, "from 0 to 100")
    }

    /// Radius of the drum, and where the grains start: layers of a cubic lattice, from the bottom upwards.
    fn places(&self) -> Result<(f32, Vec<Vec3>)> {
        self.validate()?;
        let cell = 2.0 * CELL * self.radius;
        let volume = self.grains as f32 * 4.0 / 3.0 * PI * self.radius.powi(3) / BED / self.filling;
        let mut drum = (volume / (PI * self.length)).cbrt();
        loop {
            let places = lattice(drum, 0.5 * self.length * drum, cell, self.grains);
            if places.len() == self.grains as usize {
                return Ok((drum, places));
            }
            // A drum of few grains has much room at its walls where no cell fits.
            drum *= 1.02;
        }
    }

    /// Generates the scene, with gravity towards -y.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a number out of its range, [`Error::TooManyObjects`] for more grains than the engine can number.
    pub fn scene(&self, seed: u64) -> Result<Scene> {
        let (drum, places) = self.places()?;
        let (mut scene, [grain, wall, end]) = self.materials()?;
        let mut random = Random::new(seed);
        let room = (CELL - 1.0) * self.radius;
        let clump = if self.clumps { Some(scene.add_shape(clump(self.radius, grain).density(DENSITY))?) } else { None };
        for place in places {
            let place = place + random.offset(0.9 * room);
            match clump {
                Some(shape) => drop(scene.add_body(Placement::new(shape).at(place.as_dvec3()).turned(turn(&mut random)))?),
                None => drop(scene.add_sphere(Sphere::new(place, self.radius).density(DENSITY).material(grain))?),
            }
        }
        let turn = MotionTerm::turn(self.spin, DVec3::Z, DVec3::ZERO);
        let motion = (self.spin != 0.0).then(|| scene.add_motion(Motion::new("drum", turn))).transpose()?;
        let half = 0.5 * self.length * drum;
        // The polygons extend into the end walls, and the end walls beyond the polygons.
        let reach = half + self.radius;
        let half_width = drum * (PI / self.facets as f32).tan();
        for facet in 0..self.facets {
            let (sin, cos) = (TAU * facet as f32 / self.facets as f32).sin_cos();
            let (outwards, along) = (Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0));
            let corner = drum * outwards - half_width * along - reach * Vec3::Z;
            let across = 2.0 * half_width * along;
            if self.triangles {
                let pieces = (reach / half_width).round().max(1.0);
                let up = 2.0 * reach / pieces * Vec3::Z;
                for piece in 0..pieces as u32 {
                    let corner = corner + piece as f32 * up;
                    let far = corner + up + across;
                    let halves = [(corner, corner + up, corner + across), (far, corner + across, corner + up)];
                    for triangle in halves.map(|(a, b, c)| Polygon::triangle(a, b, c)) {
                        scene.add_polygon(Polygon { motion, ..triangle.material(wall) })?;
                    }
                }
                continue;
            }
            // Solid from the inside: the side that z x along points to.
            let facet = Polygon::new(corner, 2.0 * reach * Vec3::Z, across).material(wall);
            scene.add_polygon(Polygon { motion, ..facet })?;
        }
        let wide = 1.3 * drum;
        let thick = 0.2 * drum;
        for [from, to] in [[-half - thick, -half], [half, half + thick]] {
            let wall = Cuboid::between([-wide, -wide, from], [wide, wide, to]).material(end);
            scene.add_box(Cuboid { motion, ..wall })?;
        }
        Ok(scene)
    }

    /// An empty scene with the materials of the grains, the polygons and the end walls.
    fn materials(&self) -> Result<(Scene, [MaterialId; 3])> {
        // An effective modulus E / (2 (1 - nu²)) of 1 MPa.
        const YOUNG: f32 = 1.875e6;
        let (mut scene, grain) = grains(YOUNG)?;
        let of = |name: &str| Material::new(name).young(YOUNG).poisson(POISSON).density(DENSITY);
        let wall = scene.add_material(of("drum"))?;
        let end = scene.add_material(of("end"))?;
        let pair = Pair::default().restitution(0.97).friction(self.friction).rolling_friction(0.1);
        scene.set_pair(grain, grain, pair)?;
        scene.set_pair(grain, wall, pair.restitution(0.85))?;
        let ends = if self.rough_ends { pair } else { pair.friction(0.0).rolling_friction(0.0) };
        scene.set_pair(grain, end, ends.restitution(0.85))?;
        Ok((scene, [grain, wall, end]))
    }
}

/// Three spheres around the origin that just fit into a sphere of this radius.
fn clump(radius: f32, material: MaterialId) -> Shape {
    let place = |angle: f32| 0.4 * radius * Vec3::new(angle.cos(), angle.sin(), 0.0);
    let places = [0.0, TAU / 3.0, 2.0 * TAU / 3.0].map(place);
    places.into_iter().fold(Shape::new().material(material), |shape, place| shape.sphere(place, 0.6 * radius))
}

/// Density of the grains, in kg/m³, and Poisson's ratio.
pub(super) const DENSITY: f32 = 2500.0;
const POISSON: f32 = 0.25;

/// An empty scene with the law `hertz-mindlin`, and the material of its grains.
pub(super) fn grains(young: f32) -> Result<(Scene, MaterialId)> {
    let mut scene = Scene::new();
    scene.settings.contact_law = ContactLaw::HertzMindlin;
    scene.settings.collisions = false;
    scene.settings.gravity = GRAVITY;
    let grain = scene.add_material(Material::new("grain").young(young).poisson(POISSON).density(DENSITY))?;
    Ok((scene, grain))
}

/// The first `count` places of a cubic lattice of cells inside a horizontal cylinder, layer by layer from below; fewer if there
/// are not as many.
pub(super) fn lattice(radius: f32, half_length: f32, cell: f32, count: u32) -> Vec<Vec3> {
    let mut places = Vec::new();
    // A cell may touch the wall with its inscribed sphere.
    let inside = radius - 0.5 * cell;
    let along = (2.0 * half_length / cell) as u32;
    let layers = (2.0 * radius / cell) as u32;
    for layer in 0..layers {
        let y = (layer as f32 + 0.5) * cell - radius;
        if y.abs() > inside {
            continue;
        }
        let half_chord = (inside * inside - y * y).sqrt();
        let across = (2.0 * half_chord / cell) as u32 + 1;
        for index in 0..u64::from(across) * u64::from(along) {
            if places.len() == count as usize {
                return places;
            }
            let (row, place) = ((index / u64::from(along)) as u32, (index % u64::from(along)) as u32);
            let x = (row as f32 - 0.5 * (across - 1) as f32) * cell;
            let z = (place as f32 - 0.5 * (along - 1) as f32) * cell;
            places.push(Vec3::new(x, y, z));
        }
    }
    places
}

/// Time step of [`column`]: a tenth of the Rayleigh time of a grain, in s.
pub(super) const COLUMN_STEP: f32 = 4e-5;

/// What the author of a scene of grains should know.
pub(super) fn note() -> String {
    "SI units.\n".to_owned()
}

/// A column of grains on a floor, twice as high as its radius. Nothing holds it, so it collapses.
pub(super) fn column(spheres: u32, random: &mut Random) -> Result<Scene> {
    /// Young's modulus, in Pa.
    const YOUNG: f32 = 1e7;
    const RADIUS: f32 = 0.005;
    const ASPECT: f32 = 2.0;
    let (mut scene, grain) = grains(YOUNG)?;
    scene.set_pair(grain, grain, Pair::default().restitution(0.5).friction(0.5).rolling_friction(0.1))?;
    let cell = 2.0 * CELL * RADIUS;
    let mut column = cell * (spheres as f32 / (PI * ASPECT)).cbrt();
    column = column.max(0.5 * cell);
    let disc: Vec<Vec3> = loop {
        let upright: Vec<Vec3> = lattice(column, 0.5 * cell, cell, u32::MAX);
        if !upright.is_empty() {
            break upright;
        }
        column *= 1.02;
    };
    for index in 0..spheres as usize {
        let place = disc[index % disc.len()];
        let height = (index / disc.len()) as f32 + 0.5;
        let radius = random.between(0.85, 1.0) * RADIUS;
        let offset = random.offset(0.9 * (CELL - 1.0) * RADIUS);
        let position = Vec3::new(place.x, height * cell, place.y) + offset;
        scene.add_sphere(Sphere::new(position, radius).density(DENSITY).material(grain))?;
    }
    let reach = 12.0 * column + 20.0 * RADIUS;
    scene.add_box(Cuboid::between([-reach, -0.2 * reach, -reach], [reach, 0.0, reach]).material(grain))?;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::super::Kind;
    use super::*;

    /// The triangles are those of the polygons: the same area, and no grain touches them at the start.
    #[test]
    fn a_drum_may_be_made_of_triangles() {
        let drum = Drum::new(300);
        let area =
            |scene: &Scene, share: f32| scene.polygons().iter().map(|face| share * face.left.cross(face.right).length()).sum();
        let (plain, fine) = (drum.scene(0).unwrap(), drum.spin(1.0).triangles().scene(0).unwrap());
        let [one, other]: [f32; 2] = [area(&plain, 1.0), area(&fine, 0.5)];
        assert!((other / one - 1.0).abs() < 1e-4, "{one} {other}");
        assert!(
            fine.counts().polygons > 1_000 && fine.polygons().iter().all(|face| face.is_triangle() && face.motion.is_some())
        );
        assert!(fine.placement().unwrap().deepest < 1e-3);
    }

    #[test]
    fn the_drum_of_the_benchmark_has_a_radius_of_a_fifth_of_a_metre() {
        let radius = Drum::new(1_000_000).drum_radius().unwrap();
        assert!((radius - 0.2).abs() < 1e-4, "{radius}");
        let half = Drum { radius: 0.001, ..Drum::new(1_000_000) };
        assert!((half.drum_radius().unwrap() - 0.1).abs() < 1e-4);
    }

    #[test]
    fn grains_start_inside_the_polygons_and_the_end_walls() {
        for (grains, facets, length) in [(1, 6, 4.0), (40, 12, 0.3), (3_000, 48, 4.0)] {
            let drum = Drum { facets, length, ..Drum::new(grains) };
            let scene = drum.scene(5).unwrap();
            let end = 0.5 * length * drum.drum_radius().unwrap();
            assert_eq!(scene.polygons().len(), facets as usize);
            for sphere in scene.spheres() {
                assert!(sphere.position.z.abs() + sphere.radius <= end, "{sphere:?}");
                for polygon in scene.polygons() {
                    let inwards = polygon.left.cross(polygon.right).normalize();
                    let distance = (sphere.position - polygon.corner).dot(inwards);
                    assert!(distance >= sphere.radius, "{grains} {facets} {length}: {sphere:?} {polygon:?} {distance}");
                }
            }
        }
    }

    #[test]
    fn polygons_close_the_drum() {
        let scene = Drum { facets: 7, ..Drum::new(10) }.scene(0).unwrap();
        let polygons = scene.polygons();
        for (one, next) in polygons.iter().zip(polygons.iter().cycle().skip(1)) {
            assert!((one.corner + one.right - next.corner).length() < 1e-6, "{one:?} {next:?}");
        }
    }

    #[test]
    fn gravity_turns_against_the_drum() {
        assert_eq!(Drum::down(0.0), Vec3::NEG_Y);
        assert!((Drum::down(0.5 * std::f64::consts::PI) - Vec3::NEG_X).length() < 1e-6);
    }

    #[test]
    fn numbers_out_of_their_range_are_errors() {
        let drum = Drum::new(100);
        for (wrong, field) in [
            (Drum::new(0), "spheres"),
            (Drum { radius: 0.0, ..drum }, "drum.radius"),
            (Drum { facets: 5, ..drum }, "drum.facets"),
            (Drum { length: f32::NAN, ..drum }, "drum.length"),
            (Drum { filling: 0.7, ..drum }, "drum.filling"),
            (Drum { friction: -1.0, ..drum }, "drum.friction"),
        ] {
            let error = wrong.scene(0).unwrap_err().to_string();
            assert!(error.contains(field), "{error}");
        }
    }

    #[test]
    fn a_column_is_twice_as_high_as_its_radius() {
        for spheres in [1, 10, 500, 5_000] {
            let scene = Kind::Column.generate(spheres, 1).unwrap();
            let of = |part: fn(&Sphere) -> f32| scene.spheres().iter().map(part).fold(0.0, f32::max);
            let (height, radius) = (of(|s| s.position.y + s.radius), of(|s| s.position.x.hypot(s.position.z) + s.radius));
            assert!(spheres < 500 || (1.4..2.8).contains(&(height / radius)), "{spheres}: {height} and {radius}");
        }
    }
}
