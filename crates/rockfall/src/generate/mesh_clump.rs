//! A rigid body of spheres in the shape of a closed triangle mesh, by the Euclidean method of CLUMP: V. Angelidakis, S. Nadimi,
//! M. Otsubo and S. Utili, "CLUMP: A Code Library to generate Universal Multi-sphere Particles", SoftwareX 15, 100735 (2021).
//!
//! The inside of the mesh is divided into cubic cells, each with its distance from the surface. Again and again, the cell with
//! the greatest distance becomes the centre of the next sphere, which touches the surface. The cells near its centre are then
//! taken away, and the distances of the others are also those from what was taken away.

use std::fmt;

use glam::DVec3;

use super::Random;
use super::clumps::turn;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::scene::{Cuboid, MassProperties, Placement, Scene, Shape};

mod grid;
mod nearest;
mod solid;

use grid::Grid;
use nearest::Nearest;

/// Greatest number of spheres of a shape.
const MOST_SPHERES: u32 = 1_000;
const CELLS: [u32; 2] = [1_000, 100_000_000];
/// Sizes of the first steps by which a centre moves away from the surface, in edges of cells; each further step is half as
/// large.
const FIRST_STEP: f64 = 0.5;
const STEPS: usize = 4;
/// Number of centres in turn whose sphere is too small, after which no other is looked for.
const MOST_REFUSED: usize = 50;
/// Gravity of scenes, and the length of a frame in s.
const GRAVITY: f32 = 10.0;
const FRAME: f32 = super::boxes::FRAME;

/// How a mesh becomes a clump of spheres.
///
/// ```
/// # fn main() -> rockfall::Result<()> {
/// use rockfall::Mesh;
/// use rockfall::generate::MeshClump;
///
/// let ball = Mesh::sphere(0.5, 3)?;
/// let mut options = MeshClump::new(5);
/// options.cells = 20_000;
/// let clump = options.fit(&ball)?;
/// assert!(clump.volume_error.abs() < 0.1);
/// let scene = clump.scene(1)?;
/// assert_eq!(scene.bodies().len(), 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshClump {
    /// Greatest number of spheres, from 1 to 1,000. There are fewer if the next one would be too small.
    pub spheres: u32,
    /// Radius of the smallest sphere, in units. Never less than the edge of a cell of the grid.
    pub min_radius: f32,
    /// How far spheres may overlap, from 0 to less than 1: the centre of a sphere is outside of the others made smaller by this
    /// share of their radius, and it does not reach into them. So spheres with 0 do not overlap.
    pub overlap: f32,
    /// Density, in mass/units³.
    pub density: f32,
    /// Approximate number of cells of the grid, from 1,000 to 100,000,000.
    pub cells: u32,
}

/// A clump of spheres in the shape of a mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshClumpFit {
    /// The spheres, the largest first, in coordinates of the mesh, with the mass, centre and inertia of the mesh.
    pub shape: Shape,
    /// Mass, centre and inertia of the mesh.
    pub solid: MassProperties,
    /// Volume of the spheres together, where those that overlap count once, divided by that of the mesh, minus 1. It
    /// is sampled in the cells of the grid.
    pub volume_error: f64,
    /// Principal moments of inertia of the same matter inside of the spheres alone, divided by those of the mesh, minus 1: the
    /// smallest first. Sampled in the cells of the grid.
    pub inertia_errors: [f64; 3],
    /// Edge of a cell of the grid, in units.
    pub cell: f64,
}

impl MeshClump {
    /// Up to this number of spheres that overlap by 0.6 of their radius, with density 1 and a grid of about 2 million cells.
    pub fn new(spheres: u32) -> Self {
        Self { spheres, min_radius: 0.0, overlap: 0.6, density: 1.0, cells: 2_000_000 }
    }

    /// Fills a closed mesh with spheres. The same mesh gives the same clump. All spheres are inside of it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a mesh that is not closed, encloses no volume or is too thin for the grid, and for fields of this
    /// structure that are not allowed.
    pub fn fit(&self, mesh: &Mesh) -> Result<MeshClumpFit> {
        self.check()?;
        let moments = solid::of_mesh(mesh)?;
        let mut grid = Grid::new(mesh, self.cells as usize);
        if grid.is_empty() {
            let value = format!("a mesh without a cell of the grid inside, whose edge is {:.3e}", grid.cell);
            return Err(invalid("mesh", value, "a mesh that is not too thin for the grid, or more cells"));
        }
        grid.measure();
        let balls = self.balls(mesh, &mut grid);
        if balls.is_empty() {
            let value = self.min_radius.to_string();
            return Err(invalid("min_radius", value, "less than the radius of the largest sphere inside of the mesh"));
        }
        let covered = grid.covered(&balls);
        let part = grid.moments(|cell| covered[cell]);
        let solid = moments.properties(self.density.into());
        let [sampled, all] = [part, moments].map(|moments| moments.properties(1.0));
        let [own, expected] = [sampled, all].map(ascending);
        let inertia_errors = [0, 1, 2].map(|axis| own[axis] / expected[axis] - 1.0);
        let volume_error = sampled.mass / all.mass - 1.0;
        let inertia = solid.inertia.map(|element| element as f32);
        let centre = DVec3::from_array(solid.centre).as_vec3();
        let mut shape = Shape::new().name("clump").mass_properties(solid.mass as f32, centre, inertia);
        for (place, radius) in &balls {
            shape = shape.sphere(place.as_vec3(), *radius as f32);
        }
        shape.mass_properties_of()?;
        Ok(MeshClumpFit { shape, solid, volume_error, inertia_errors, cell: grid.cell })
    }

    fn check(&self) -> Result<()> {
        let Self { spheres, min_radius, overlap, density, cells } = *self;
        if !(1..=MOST_SPHERES).contains(&spheres) {
            return Err(invalid("spheres", spheres.to_string(), "a whole number from 1 to 1000 for a clump"));
        }
        if !(min_radius.is_finite() && min_radius >= 0.0) {
            return Err(invalid("min_radius", min_radius.to_string(), "a finite number of at least 0"));
        }
        if !(0.0..1.0).contains(&overlap) {
            return Err(invalid("overlap", overlap.to_string(), "a number from 0 to less than 1"));
        }
        if !(density.is_finite() && density > 0.0) {
            return Err(invalid("density", density.to_string(), "a finite number greater than 0"));
        }
        if !(CELLS[0]..=CELLS[1]).contains(&cells) {
            return Err(invalid("cells", cells.to_string(), "a whole number from 1000 to 100000000"));
        }
        Ok(())
    }

    /// The centres and radii of the spheres.
    fn balls(&self, mesh: &Mesh, grid: &mut Grid) -> Vec<(DVec3, f64)> {
        let least = f64::from(self.min_radius).max(grid.cell);
        let kept = 1.0 - f64::from(self.overlap);
        let nearest = Nearest::new(mesh);
        let mut balls: Vec<(DVec3, f64)> = Vec::new();
        let mut refused = 0;
        while balls.len() < self.spheres as usize && refused < MOST_REFUSED {
            let Some((cell, about)) = grid.farthest().filter(|(_, about)| *about >= least) else { break };
            let start = grid.centre(cell);
            let taken: Vec<(DVec3, f64)> = balls.iter().map(|(place, radius)| (*place, kept * radius)).collect();
            let near = nearest.around(start, about + 6.0 * grid.cell);
            let room =
                |place: DVec3| taken.iter().map(|(ball, own)| place.distance(*ball) - own).fold(near.distance(place), f64::min);
            let (place, radius) = climbed(start, grid.cell, room);
            grid.take(cell, place, kept * radius);
            // A cell may seem to have a little more room than it has.
            refused = if radius < least { refused + 1 } else { 0 };
            if refused == 0 {
                balls.push((place, radius));
            }
        }
        balls
    }
}

/// Moves a place a little to where it has more room. Returns the room too.
fn climbed(start: DVec3, cell: f64, room: impl Fn(DVec3) -> f64) -> (DVec3, f64) {
    let mut best = (start, room(start));
    let mut step = FIRST_STEP * cell;
    for _ in 0..STEPS {
        let middle = best.0;
        // In a corner, only a step along the diagonal has more room.
        for way in 0..27 {
            let way = DVec3::from_array([way % 3, way / 3 % 3, way / 9].map(|part| f64::from(part) - 1.0));
            let place = middle + step * way;
            let found = room(place);
            if found > best.1 {
                best = (place, found);
            }
        }
        step *= 0.5;
    }
    best
}

/// The principal moments of inertia, the smallest first.
fn ascending(properties: MassProperties) -> [f64; 3] {
    let mut moments = properties.principal().0.to_array();
    moments.sort_by(f64::total_cmp);
    moments
}

fn invalid(field: &'static str, value: String, expected: &'static str) -> Error {
    Error::Invalid { field, value, expected }
}

impl MeshClumpFit {
    /// A scene in which the clump falls onto a floor, turned at random. Contacts are hard.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a clump that is too large or too small for a scene.
    pub fn scene(&self, seed: u64) -> Result<Scene> {
        let centre = DVec3::from_array(self.solid.centre).as_vec3();
        let reach = self.shape.spheres.iter().map(|sphere| sphere.centre.distance(centre) + sphere.radius).fold(0.0, f32::max);
        let mut scene = Scene::new();
        let shape = scene.add_shape(self.shape.clone())?;
        let turn = turn(&mut Random::new(seed));
        let height = 1.5 * reach;
        scene.add_body(Placement::new(shape).centred_at(DVec3::new(0.0, height.into(), 0.0)).turned(turn))?;
        scene.add_box(Cuboid::between([-6.0 * reach, -reach, -6.0 * reach], [6.0 * reach, 0.0, 6.0 * reach]))?;
        scene.settings.set("contact_law", "rigid")?;
        (scene.settings.gravity, scene.settings.coulomb_friction) = (GRAVITY, 0.4);
        // It falls, rolls and comes to rest.
        let seconds = 10.0 * (2.0 * height / GRAVITY).sqrt() + 1.0;
        (scene.run.dt, scene.run.steps) = (Some(FRAME), Some((seconds / FRAME).clamp(60.0, 6e4) as u64));
        Ok(scene)
    }
}

/// What was reached, as lines of text.
impl fmt::Display for MeshClumpFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |error: f64| format!("{:+.2} %", 100.0 * error);
        let radii = [self.shape.spheres.first(), self.shape.spheres.iter().min_by(|a, b| a.radius.total_cmp(&b.radius))];
        let [largest, smallest] = radii.map(|sphere| sphere.map_or(0.0, |sphere| sphere.radius));
        writeln!(f, "{} spheres with radii from {smallest:.4e} to {largest:.4e}", self.shape.spheres.len())?;
        writeln!(f, "volume of the spheres: {} from that of the mesh", percent(self.volume_error))?;
        let inertia = self.inertia_errors.map(percent).join(", ");
        writeln!(f, "principal moments of inertia of the spheres: {inertia}; the body has the mass and inertia of the mesh")?;
        write!(f, "grid: cells with an edge of {:.4e}", self.cell)
    }
}

#[cfg(test)]
mod tests;
