//! Generates scenes of any size, with an exact number of spheres. The same seed gives the same scene. Generation takes O(N)
//! time.
//!
//! Nothing overlaps at first: every body starts inside a cell of its own. All constants have their default values, with which
//! these scenes are stable at the default time step of 20 ms (see [`Scene::stability`]). Scenes of grains have materials, SI units
//! and a time step of their own ([`Kind::time_step`]).

use std::fmt;
use std::str::FromStr;

use glam::{IVec3, Vec3};
use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

use crate::error::{Error, Result, quoted};
use crate::model::layout::max_objects;
use crate::scene::{BoxId, Colour, Cuboid, Look, RunDefaults, Scene, Sphere, Tag};
use crate::settings::Integrator;

mod benchmark;
mod bodies;
mod boxes;
mod clumps;
mod colours;
mod creature;
mod grains;
mod hopper;
mod machines;
mod masonry;
mod mesh_clump;

pub use benchmark::{Benchmark, LAYERS};
pub use creature::{creature, creature_without_pairs};
pub use grains::Drum;
pub use mesh_clump::{MeshClump, MeshClumpFit};

/// Angular velocity of a generated drum, in rad/s: 12 revolutions per minute.
const DRUM_SPIN: f64 = 0.4 * std::f64::consts::PI;

/// The kind of scene to generate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Spheres of several sizes that fall into a walled box.
    Pile,
    /// Spheres, rods, capsules and springs that fall into a walled box.
    Mixed,
    /// Rigid bodies of two, three and five spheres, which overlap or are joined by rods, that fall into a walled box.
    Clumps,
    /// Rigid bodies of one box that fall into a walled box: a box counts as a sphere.
    Boxes,
    /// Dominoes along a spiral, and a ball that is thrown at the first one: a domino counts as a sphere.
    Dominoes,
    /// A wall of bricks and a heavy ball that flies at it, with hard contacts.
    Bricks,
    /// An arch of stones and a ball that falls on it, with hard contacts.
    Arch,
    /// Convex hulls that fall into a walled box, with hard contacts.
    Hulls,
    /// Soft blobs, lattices of spheres, springs and rods, that fall onto boxes.
    Soft,
    /// Chains of spheres and fixed-length rods that hang from a beam and start pulled aside.
    Chain,
    /// Spheres that run through a funnel into a box.
    Hopper,
    /// Grains in a drum that turns: see [`Drum`].
    Drum,
    /// A column of grains that collapses into a heap.
    Column,
    /// Grains in a box that is shaken up and down.
    Vibrated,
    /// Grains between two plates that slide past each other, in a periodic box.
    ShearCell,
    /// Grains in an upright drum with blades that turn.
    Mixer,
    /// Grains in a tube with a screw that turns.
    Screw,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 17] = [
        Self::Pile,
        Self::Mixed,
        Self::Clumps,
        Self::Boxes,
        Self::Dominoes,
        Self::Bricks,
        Self::Arch,
        Self::Hulls,
        Self::Soft,
        Self::Chain,
        Self::Hopper,
        Self::Drum,
        Self::Column,
        Self::Vibrated,
        Self::ShearCell,
        Self::Mixer,
        Self::Screw,
    ];

    /// Name of the kind on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pile => "pile",
            Self::Mixed => "mixed",
            Self::Clumps => "clumps",
            Self::Boxes => "boxes",
            Self::Dominoes => "dominoes",
            Self::Bricks => "bricks",
            Self::Arch => "arch",
            Self::Hulls => "hulls",
            Self::Soft => "soft",
            Self::Chain => "chain",
            Self::Hopper => "hopper",
            Self::Drum => "drum",
            Self::Column => "column",
            Self::Vibrated => "vibrated",
            Self::ShearCell => "shear-cell",
            Self::Mixer => "mixer",
            Self::Screw => "screw",
        }
    }

    /// Generates a scene with exactly `spheres` spheres, including those of rods, capsules and rigid bodies, of which
    /// a box and a hull have one. The scene has its time step and its numbers of steps, scenes of grains have their integrator
    /// ([`Scene::run`]), and bodies have colours in bands.
    ///
    /// # Errors
    /// [`Error::Invalid`] for 0 spheres, [`Error::TooManyObjects`] for more than the engine can number.
    pub fn generate(self, spheres: u32, seed: u64) -> Result<Scene> {
        check_count(spheres)?;
        let mut random = Random::new(seed);
        let mut scene = match self {
            Self::Pile => pile(spheres, &mut random),
            Self::Mixed => bodies::mixed(spheres, &mut random),
            Self::Clumps => clumps::clumps(spheres, &mut random),
            Self::Boxes | Self::Dominoes => boxes::hard(self, spheres, &mut random),
            Self::Bricks => masonry::bricks(spheres, &mut random),
            Self::Arch => masonry::arch(spheres, &mut random),
            Self::Hulls => masonry::hulls(spheres, &mut random),
            Self::Soft => bodies::soft(spheres, &mut random),
            Self::Chain => bodies::chain(spheres, &mut random),
            Self::Hopper => hopper::hopper(spheres, &mut random),
            Self::Drum => drum(spheres, seed),
            Self::Column => grains::column(spheres, &mut random),
            Self::Vibrated => machines::vibrated(spheres, &mut random),
            Self::ShearCell => machines::shear_cell(spheres, &mut random),
            Self::Mixer => machines::mixer(spheres, &mut random),
            Self::Screw => machines::screw(spheres, &mut random),
        }?;
        self.set_length(&mut scene.run);
        if self.has_grains() {
            scene.run.integrator = Some(Integrator::VelocityVerlet.into());
        }
        colours::colour(self, &mut scene)?;
        Ok(scene)
    }

    /// Whether scenes of this kind have grains with the contact law `hertz-mindlin`, in SI units. They need the integrator
    /// `velocity-verlet` or `symplectic-euler`.
    pub fn has_grains(self) -> bool {
        matches!(self, Self::Drum | Self::Column | Self::Vibrated | Self::ShearCell | Self::Mixer | Self::Screw)
    }

    /// The time step for which scenes of this kind are made, in s.
    pub fn time_step(self) -> f32 {
        match self {
            Self::Drum => Drum::STEP,
            Self::Column => grains::COLUMN_STEP,
            Self::Vibrated | Self::ShearCell | Self::Mixer | Self::Screw => machines::MACHINE_STEP,
            Self::Boxes | Self::Dominoes | Self::Bricks | Self::Arch | Self::Hulls => boxes::FRAME,
            _ => 0.02,
        }
    }

    /// Sets the time step, the number of steps that show what happens in scenes of this kind, and for what is fast or slow the speed of a film.
    fn set_length(self, run: &mut RunDefaults) {
        /// Least and greatest length of a film, in s.
        const FILM: [f64; 2] = [4.0, 8.0];
        let seconds = match self {
            Self::Drum | Self::Vibrated | Self::ShearCell => 0.5,
            Self::Column | Self::Mixer | Self::Screw => 1.0,
            Self::Boxes | Self::Bricks | Self::Arch | Self::Hulls => 5.0,
            Self::Chain => 10.0,
            // Bodies come to rest.
            _ => 20.0,
        };
        let steps = 100 * (0.01 * seconds / f64::from(self.time_step())).round() as u64;
        (run.dt, run.steps) = (Some(self.time_step()), Some(steps));
        let film = seconds.clamp(FILM[0], FILM[1]);
        run.speed = (film != seconds).then_some(seconds / film);
    }

    /// What the author of a scene of this kind should know to run or change it, as lines of text: for a hopper, where its opening
    /// is, and the line of a box that closes it; for grains, the units. Empty for the other kinds.
    pub fn note(self, spheres: u32) -> String {
        match self {
            Self::Hopper => hopper::note(spheres),
            Self::Column => grains::note(),
            Self::Drum => machines::note("drum"),
            Self::Vibrated => machines::note("shaker"),
            Self::ShearCell => machines::note("lid"),
            Self::Mixer => machines::note("blades"),
            Self::Screw => machines::note("screw"),
            _ => String::new(),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kind {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| Error::Invalid {
            field: "kind",
            value: quoted(text),
            expected: "pile, mixed, clumps, boxes, dominoes, bricks, arch, hulls, soft, chain, hopper, drum, column, vibrated, shear-cell, mixer or screw",
        })
    }
}

/// Checks that a scene can have this number of spheres.
///
/// # Errors
/// [`Error::Invalid`] for 0, [`Error::TooManyObjects`] for more than the engine can number.
fn check_count(spheres: u32) -> Result<()> {
    if spheres == 0 {
        return Err(Error::Invalid { field: "spheres", value: "0".to_owned(), expected: "at least 1" });
    }
    let limit = max_objects(false);
    if spheres > limit {
        return Err(Error::TooManyObjects { count: spheres as usize, limit: limit as usize });
    }
    Ok(())
}

/// Random numbers without trigonometry, so that they are the same on all machines.
struct Random(Pcg64Mcg);

impl Random {
    fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.random::<f32>()
    }

    fn below(&mut self, count: u32) -> u32 {
        self.0.next_u32() % count
    }

    /// A random point of the cube [-half, half]³.
    fn offset(&mut self, half: f32) -> Vec3 {
        let mut draw = || self.between(-half, half);
        Vec3::new(draw(), draw(), draw())
    }

    /// A random unit vector, uniform over all directions.
    fn direction(&mut self) -> Vec3 {
        loop {
            let point = self.offset(1.0);
            if (0.01..=1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }
}

/// A block of cubic cells, about as wide as it is high, filled layer by layer from below.
struct Cells {
    /// Number of cells in a row, and of rows in a layer.
    across: u32,
    layers: u32,
    size: f32,
    /// Height of the lower side of the lowest layer.
    bottom: f32,
}

impl Cells {
    fn new(count: u32, size: f32, bottom: f32) -> Self {
        Self::flat(count, u32::MAX, size, bottom)
    }

    /// A block of at most `layers` layers.
    fn flat(count: u32, layers: u32, size: f32, bottom: f32) -> Self {
        let mut across = 1;
        while u64::from(across).pow(2) * u64::from(across.min(layers)) < u64::from(count) {
            across += 1;
        }
        Self { across, layers: count.div_ceil(across * across).max(1), size, bottom }
    }

    /// Half the width of the block, which is centred on the y axis.
    fn half_width(&self) -> f32 {
        0.5 * self.size * self.across as f32
    }

    fn top(&self) -> f32 {
        self.bottom + self.size * self.layers as f32
    }

    fn centre(&self, index: u32) -> Vec3 {
        let (row, layer) = (index / self.across, index / (self.across * self.across));
        let cell = IVec3::new((index % self.across) as i32, layer as i32, (row % self.across) as i32);
        let corner = Vec3::new(-self.half_width(), self.bottom, -self.half_width());
        corner + self.size * (cell.as_vec3() + 0.5)
    }
}

/// Thickness of floors, and of walls of which a picture need not show much, in units.
const THICK: f32 = 2.0;

/// Adds a floor at y = 0 and four thick walls around the y axis, with inner half widths `x` and `z`.
fn walled_box(scene: &mut Scene, x: f32, z: f32, height: f32) -> Result<()> {
    box_of(scene, [x, z], height, [THICK; 2]).map(drop)
}

/// Colour of machines.
const STEEL: Colour = Colour([0xa9, 0xb9, 0xc6]);
/// Colour of the floors of tanks.
const FLOOR: Colour = Colour([0xb9, 0x8a, 0x56]);

/// Adds a tank around the y axis with inner half widths `x` and `z`: a floor of wood at y = 0, and walls of glass. The walls are a
/// tenth as thick, so that a picture shows what is between them, and thicker than the distance that the fastest body moves in a step.
fn tank(scene: &mut Scene, [x, z]: [f32; 2], height: f32) -> Result<()> {
    let thick = (0.1 * x.min(z)).clamp(0.1, THICK);
    let boxes = box_of(scene, [x, z], height, [(2.0 * thick).min(THICK), thick])?;
    furnish(scene, boxes)
}

/// Makes the first of five boxes of wood, and the others of glass.
fn furnish(scene: &mut Scene, boxes: [BoxId; 5]) -> Result<()> {
    scene.set_tag(boxes[0], Tag::new().look(Look::Wood).colour(FLOOR))?;
    boxes[1..].iter().try_for_each(|wall| scene.set_tag(*wall, Tag::new().look(Look::Glass)))
}

/// Adds a floor and four walls, with the thickness of the floor and of the walls.
fn box_of(scene: &mut Scene, [x, z]: [f32; 2], height: f32, [floor, thick]: [f32; 2]) -> Result<[BoxId; 5]> {
    let mut add = |min: [f32; 3], max: [f32; 3]| scene.add_box(Cuboid::between(min, max));
    let (x_out, z_out) = (x + thick, z + thick);
    Ok([
        add([-x_out, -floor, -z_out], [x_out, 0.0, z_out])?,
        add([-x_out, 0.0, -z_out], [-x, height, z_out])?,
        add([x, 0.0, -z_out], [x_out, height, z_out])?,
        add([-x, 0.0, -z_out], [x, height, -z])?,
        add([-x, 0.0, z], [x, height, z_out])?,
    ])
}

/// A sphere at a random place in its cell. `radii` are the least and greatest radius.
fn ball(random: &mut Random, cells: &Cells, index: u32, radii: [f32; 2]) -> Sphere {
    ball_within(random, cells.centre(index), cells.size, radii)
}

/// A sphere at a random place in a cell, with a mass proportional to its volume (1 at radius 0.2).
fn ball_within(random: &mut Random, centre: Vec3, cell: f32, radii: [f32; 2]) -> Sphere {
    let radius = random.between(radii[0], radii[1]);
    let room = 0.49 * cell - radius;
    let position = centre + random.offset(room);
    Sphere::new(position, radius).mass((radius / 0.2).powi(3))
}

/// A short drum that turns, of steel, between smooth ends of glass that stand still.
fn drum(spheres: u32, seed: u64) -> Result<Scene> {
    let drum = Drum { length: 1.2, rough_ends: false, ..Drum::new(spheres) };
    let mut scene = drum.spin(DRUM_SPIN).scene(seed)?;
    for id in scene.polygon_ids().collect::<Vec<_>>() {
        scene.set_tag(id, Tag::new().colour(STEEL))?;
    }
    for id in scene.box_ids().collect::<Vec<_>>() {
        scene.set_motion(id, None)?;
        scene.set_tag(id, Tag::new().look(Look::Glass))?;
    }
    Ok(scene)
}

fn pile(spheres: u32, random: &mut Random) -> Result<Scene> {
    let mut scene = Scene::new();
    let cells = Cells::new(spheres, 0.56, 0.2);
    for index in 0..spheres {
        scene.add_sphere(ball(random, &cells, index, [0.15, 0.25]))?;
    }
    let half = cells.half_width();
    tank(&mut scene, [half; 2], 0.8 * cells.top())?;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [u32; 12] = [1, 2, 3, 7, 10, 11, 26, 27, 28, 100, 777, 1000];

    #[test]
    fn sphere_counts_are_exact_and_seeds_decide() {
        for kind in Kind::ALL {
            for spheres in SIZES {
                let scene = kind.generate(spheres, 7).unwrap();
                assert_eq!(scene.counts().spheres, spheres as usize, "{kind}");
            }
            let text = |seed| kind.generate(100, seed).unwrap().to_text();
            assert_eq!(text(1), text(1), "{kind}");
            assert_ne!(text(1), text(2), "{kind}");
            assert!(kind.generate(0, 0).is_err());
            assert!(kind.generate(u32::MAX, 0).is_err());
            assert_eq!(kind.name().parse::<Kind>().unwrap(), kind);
        }
        assert!("heap".parse::<Kind>().is_err());
    }

    #[test]
    fn every_kind_contains_what_its_name_says() {
        let counts = |kind: Kind| kind.generate(500, 3).unwrap().counts();
        let mixed = counts(Kind::Mixed);
        assert!(mixed.capsules > 20 && mixed.springs > 20 && mixed.rods > mixed.capsules + 20);
        let clumps = Kind::Clumps.generate(500, 3).unwrap();
        let count = |spheres| clumps.bodies().iter().filter(|body| body.spheres().len() == spheres).count();
        assert!([2, 3, 5].iter().all(|spheres| count(*spheres) > 20), "{:?}", clumps.counts());
        let soft = counts(Kind::Soft);
        assert!(soft.springs > 1000 && soft.rods > 100 && soft.boxes > 5);
        let chain = Kind::Chain.generate(500, 3).unwrap();
        assert_eq!(chain.counts().rods, 466);
        assert_eq!(chain.spheres().iter().filter(|sphere| sphere.fixed).count(), 34);
        assert_eq!(counts(Kind::Hopper).boxes, 7);
    }

    /// A picture shows what is in a box, and not the tops of its walls.
    #[test]
    fn walls_are_a_small_part_of_their_box() {
        for kind in [Kind::Pile, Kind::Mixed, Kind::Clumps, Kind::Boxes, Kind::Soft, Kind::Vibrated] {
            for spheres in [100, 1000] {
                let scene = kind.generate(spheres, 1).unwrap();
                let wide = |axis: usize| {
                    let widths =
                        scene.boxes().iter().map(move |cuboid| cuboid.edges.iter().map(|edge| edge[axis]).sum::<f32>());
                    widths.fold(0.0, f32::max)
                };
                let walls = scene.boxes()[1..5].iter();
                let thick = walls.map(|cuboid| cuboid.edges.iter().map(|edge| edge.length()).fold(f32::MAX, f32::min));
                let thick = thick.fold(0.0, f32::max);
                assert!(thick < 0.08 * wide(0), "{kind} {spheres}: {thick} of {}", wide(0));
            }
        }
    }

    /// A film of a scene has a length.
    #[test]
    fn every_kind_has_a_number_of_steps() {
        for kind in Kind::ALL {
            let run = kind.generate(10, 1).unwrap().run;
            let seconds = run.steps.unwrap() as f64 * f64::from(run.dt.unwrap());
            assert!((3.9..=8.1).contains(&(seconds / run.speed.unwrap_or(1.0))), "{kind}: {run:?}");
        }
    }

    /// Each chain has one colour, which the next one does not have.
    #[test]
    fn neighbouring_chains_differ_in_colour() {
        let scene = Kind::Chain.generate(60, 1).unwrap();
        let colours: Vec<_> = scene.sphere_ids().map(|id| scene.tag(id).unwrap().unwrap().colour).collect();
        let chains: Vec<_> = colours.chunks(15).collect();
        assert!(chains.iter().all(|chain| chain.iter().all(|colour| *colour == chain[0])), "{colours:?}");
        assert!(chains.windows(2).all(|pair| pair[0][0] != pair[1][0]), "{colours:?}");
    }

    #[test]
    fn the_default_step_is_stable() {
        for kind in Kind::ALL {
            let scene = kind.generate(1000, 5).unwrap();
            for integrator in Integrator::ALL {
                assert_eq!(scene.stability(kind.time_step(), integrator), [], "{kind} {integrator}");
            }
        }
    }

    /// Distance of a point from a box; 0 inside it.
    fn distance(cuboid: &Cuboid, point: Vec3) -> f32 {
        let along = |edge: Vec3| edge * ((point - cuboid.corner).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        let nearest: Vec3 = cuboid.corner + cuboid.edges.into_iter().map(along).sum::<Vec3>();
        point.distance(nearest)
    }

    #[test]
    fn nothing_overlaps_at_first() {
        for kind in Kind::ALL {
            for spheres in SIZES {
                let scene = kind.generate(spheres, 11).unwrap();
                let balls = scene.spheres();
                let owners: Vec<_> = scene.sphere_ids().map(|id| scene.body_of_sphere(id)).collect();
                // The sphere that stands for a box or a hull is larger than that.
                let is_solid = |place: usize| scene.is_solid(crate::scene::Body::Sphere(scene.spheres.handle_at(place)));
                for (index, one) in balls.iter().enumerate().filter(|(index, _)| !is_solid(*index)) {
                    // The spheres of a rigid body may overlap.
                    let is_other =
                        |place: &usize| !is_solid(*place) && (owners[*place].is_none() || owners[*place] != owners[index]);
                    for other in (index + 1..balls.len()).filter(is_other).map(|place| &balls[place]) {
                        let gap = one.position.distance(other.position) - one.radius - other.radius;
                        assert!(gap > 0.0, "{kind} {spheres}: {one:?} {other:?}");
                    }
                    for cuboid in scene.boxes() {
                        let gap = distance(cuboid, one.position) - one.radius;
                        assert!(gap > 0.0, "{kind} {spheres}: {one:?} {cuboid:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn rods_start_at_their_length() {
        for kind in Kind::ALL {
            let scene = kind.generate(1000, 13).unwrap();
            for rod in scene.rods() {
                let ends = [rod.end1, rod.end2].map(|id| scene.sphere(id).unwrap().position);
                if let Some(length) = rod.length {
                    assert!((ends[0].distance(ends[1]) - length).abs() < 1e-4 * length.max(1.0), "{kind}");
                }
            }
        }
    }
}
