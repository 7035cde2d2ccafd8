//! Scenes for benchmarks. Generation takes O(N) time and no memory beyond the scene's own. Bodies keep meeting as the scene
//! runs.

use std::fmt;
use std::str::FromStr;

use glam::{IVec3, Vec3};
use rand::SeedableRng as _;
use rand_pcg::Pcg64Mcg;

use super::boxes;
use super::{Kind, Random, ball_within, check_count, walled_box};
use crate::error::{Error, Result, quoted};
use crate::scene::{Capsule, Cuboid, Rod, Scene, Sphere, Spring};

/// A benchmark scene. The numbers of bodies are exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Benchmark {
    /// Section 2.9 of the thesis: only spheres, placed randomly close to each other. They drift together slowly, without
    /// gravity, so that they keep meeting.
    Thesis,
    /// Equal spheres on a cubic lattice whose spacing is 0.97 of their diameter, in a closed box and without gravity. Every
    /// sphere has six contacts, whose forces cancel. If the topmost layer is not full, its spheres drift.
    Lattice,
    /// Spheres of several sizes that fall into a walled box, at most [`LAYERS`] deep.
    Pile,
    /// Nearly equal spheres in close-packed layers, as if already settled, at most [`LAYERS`] deep.
    Settled,
    /// The spheres of [`Benchmark::Pile`], added in random order.
    Shuffled,
    /// A quarter capsules, a quarter rods with a spring, half spheres, falling into a walled box. The number of bodies counts
    /// capsules and rods as one each, although they have two spheres.
    Mixed,
    /// Spheres that fall into a walled box, whose radii differ by a factor of up to 50: few large ones among many small ones.
    Radii,
    /// Boxes that fall into a walled box, as `rockfall generate boxes` places them.
    Boxes,
}

/// Maximum depth of piles, in spheres. With the default contact force, the lowest spheres of such a pile overlap by a tenth of
/// their size.
pub const LAYERS: u32 = 32;

impl Benchmark {
    /// All benchmark scenes.
    pub const ALL: [Self; 8] =
        [Self::Thesis, Self::Lattice, Self::Pile, Self::Settled, Self::Shuffled, Self::Mixed, Self::Radii, Self::Boxes];

    /// Name of the scene on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Thesis => "thesis",
            Self::Lattice => "lattice",
            Self::Pile => "pile",
            Self::Settled => "settled",
            Self::Shuffled => "shuffled",
            Self::Mixed => "mixed",
            Self::Radii => "radii",
            Self::Boxes => "boxes",
        }
    }

    /// Generates a scene with exactly `bodies` bodies. The same seed gives the same scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] for 0 bodies, [`Error::TooManyObjects`] for more than the engine can number.
    pub fn generate(self, bodies: u32, seed: u64) -> Result<Scene> {
        check_count(bodies)?;
        match self {
            Self::Thesis => thesis(bodies, seed),
            Self::Lattice => lattice(bodies),
            Self::Pile => pile(bodies, seed, 0..bodies),
            Self::Settled => settled(bodies, seed),
            Self::Shuffled => pile(bodies, seed, shuffled(bodies, seed).into_iter()),
            Self::Mixed => mixed(bodies, seed),
            Self::Radii => radii(bodies, seed),
            Self::Boxes => boxes::hard(Kind::Boxes, bodies, &mut Random::new(seed)),
        }
    }
}

impl fmt::Display for Benchmark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Benchmark {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let known = Self::ALL.into_iter().find(|scene| scene.name() == text);
        known.ok_or_else(|| Error::Invalid {
            field: "scene",
            value: quoted(text),
            expected: "thesis, lattice, pile, settled, shuffled, mixed, radii or boxes",
        })
    }
}

/// The random numbers of one body. They do not depend on the order in which bodies are added.
fn random_of(seed: u64, index: u32) -> Random {
    // The index is mixed, because neighbouring seeds would give similar first numbers.
    let mixed = (u64::from(index) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    Random(Pcg64Mcg::seed_from_u64(seed ^ mixed))
}

/// The numbers from 0 to `count` - 1 in random order (Fisher and Yates).
fn shuffled(count: u32, seed: u64) -> Vec<u32> {
    let mut random = Random::new(seed);
    let mut order: Vec<u32> = (0..count).collect();
    for last in (1..count).rev() {
        order.swap(last as usize, random.below(last + 1) as usize);
    }
    order
}

/// The least number whose power `power` is not below `count`.
fn root(count: u32, power: u32) -> u32 {
    let mut side = (f64::from(count).powf(1.0 / f64::from(power)) as u32).max(1);
    while u64::from(side).pow(power) < u64::from(count) {
        side += 1;
    }
    side
}

/// A block of cells, `across` cells wide in both directions, centred on the y axis.
struct Block {
    across: u32,
    cell: f32,
}

impl Block {
    /// As wide as it is high, or wider if it would be deeper than `layers`.
    fn new(cells: u32, cell: f32, layers: u32) -> Self {
        let across = root(cells, 3).max(root(cells.div_ceil(layers), 2));
        Self { across, cell }
    }

    fn centre(&self, index: u32) -> Vec3 {
        let (row, layer) = (index / self.across, index / (self.across * self.across));
        let cell = IVec3::new((index % self.across) as i32, layer as i32, (row % self.across) as i32);
        self.cell * (cell.as_vec3() + 0.5) - Vec3::new(self.half(), 0.0, self.half())
    }

    fn half(&self) -> f32 {
        0.5 * self.cell * self.across as f32
    }

    fn height(&self, cells: u32) -> f32 {
        self.cell * cells.div_ceil(self.across * self.across) as f32
    }

    /// Adds walls and a floor around the block, with room above.
    fn enclose(&self, scene: &mut Scene, cells: u32) -> Result<()> {
        walled_box(scene, self.half(), self.half(), self.height(cells) + 2.0)
    }
}

fn thesis(bodies: u32, seed: u64) -> Result<Scene> {
    const RADIUS: f32 = 0.2;
    const CELL: f32 = 0.45;
    /// Rate at which the spheres approach the middle, in 1/s. Within 1,000 steps of 20 ms they meet and separate again.
    const TOGETHER: f32 = 0.1;
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    let block = Block::new(bodies, CELL, u32::MAX);
    let middle = Vec3::Y * (0.5 * block.height(bodies));
    for index in 0..bodies {
        let mut random = random_of(seed, index);
        let position = block.centre(index) - middle + random.offset(0.5 * CELL - RADIUS);
        let velocity = random.offset(0.2) - TOGETHER * position;
        scene.add_sphere(Sphere::new(position, RADIUS).velocity(velocity))?;
    }
    Ok(scene)
}

fn lattice(bodies: u32) -> Result<Scene> {
    const RADIUS: f32 = 0.2;
    let mut scene = Scene::new();
    scene.settings.gravity = 0.0;
    let block = Block::new(bodies, 0.97 * 2.0 * RADIUS, u32::MAX);
    for index in 0..bodies {
        scene.add_sphere(Sphere::new(block.centre(index), RADIUS))?;
    }
    // Overlaps with walls are half of those between spheres, and the reduced masses are twice as large, so the forces are
    // equal.
    let (half, height) = (block.half(), block.height(bodies));
    walled_box(&mut scene, half, half, height)?;
    scene.add_box(Cuboid::between([-half, height, -half], [half, height + 2.0, half]))?;
    Ok(scene)
}

fn pile(bodies: u32, seed: u64, order: impl Iterator<Item = u32>) -> Result<Scene> {
    const CELL: f32 = 0.56;
    let mut scene = Scene::new();
    let block = Block::new(bodies, CELL, LAYERS);
    for index in order {
        let mut random = random_of(seed, index);
        scene.add_sphere(ball_within(&mut random, block.centre(index), CELL, [0.15, 0.25]))?;
    }
    block.enclose(&mut scene, bodies)?;
    Ok(scene)
}

fn settled(bodies: u32, seed: u64) -> Result<Scene> {
    const RADIUS: f32 = 0.2;
    // Square layers; each sphere of the next layer lies in the dip between four. This is the densest packing of spheres.
    const APART: f32 = 2.0 * RADIUS;
    const RISE: f32 = APART * std::f32::consts::FRAC_1_SQRT_2;
    let mut scene = Scene::new();
    let block = Block::new(bodies, APART, LAYERS);
    for index in 0..bodies {
        let mut random = random_of(seed, index);
        let layer = index / (block.across * block.across);
        let mut position = block.centre(index);
        position.y = RADIUS + RISE * layer as f32;
        if layer % 2 == 1 {
            position += Vec3::new(0.5 * APART, 0.0, 0.5 * APART);
        }
        let radius = RADIUS * random.between(0.98, 1.0);
        scene.add_sphere(Sphere::new(position, radius).mass((radius / RADIUS).powi(3)))?;
    }
    // Every other layer is shifted by half a sphere.
    let half = block.half() + 0.25 * APART;
    for sphere in scene.spheres.objects_mut() {
        sphere.position -= Vec3::new(0.25 * APART, 0.0, 0.25 * APART);
    }
    walled_box(&mut scene, half, half, block.height(bodies) + 2.0)?;
    Ok(scene)
}

fn mixed(bodies: u32, seed: u64) -> Result<Scene> {
    const CELL: f32 = 1.0;
    /// Half the distance of two ends, and the greatest radius. With the random offset they stay inside the cell.
    const HALF: f32 = 0.25;
    const RADIUS: f32 = 0.18;
    let mut scene = Scene::new();
    let block = Block::new(bodies, CELL, LAYERS / 2);
    for index in 0..bodies {
        let mut random = random_of(seed, index);
        if index % 2 == 0 {
            scene.add_sphere(ball_within(&mut random, block.centre(index), CELL, [0.15, 0.25]))?;
            continue;
        }
        let centre = block.centre(index) + random.offset(0.49 * CELL - HALF - RADIUS);
        let arm = HALF * random.direction();
        if index % 4 == 1 {
            scene.add_capsule(Capsule::new(centre - arm, centre + arm, RADIUS).mass(2.0))?;
        } else {
            let a = scene.add_sphere(Sphere::new(centre - arm, RADIUS))?;
            let b = scene.add_sphere(Sphere::new(centre + arm, RADIUS))?;
            scene.add_rod(Rod::new(a, b, 0.1))?;
            scene.add_spring(Spring::new(a, b, 200.0, 2.0 * HALF).damping(1.0))?;
        }
    }
    block.enclose(&mut scene, bodies)?;
    Ok(scene)
}

/// Alternates two kinds of cells. One holds a sphere of radius 50 (times [`UNIT`]). The other is divided into 7³ cells: every
/// second one holds a sphere of radius 7, and the others are divided into 7³ cells with a sphere of radius 1 to 1.2 each.
fn radii(bodies: u32, seed: u64) -> Result<Scene> {
    const UNIT: f32 = 0.05;
    const SIDE: u32 = 7;
    /// Edges of the cells of the largest, the middle and the smallest spheres.
    const CELLS: [f32; 3] = [120.0 * UNIT, 120.0 * UNIT / 7.0, 120.0 * UNIT / 49.0];
    const SMALL: u32 = SIDE * SIDE * SIDE;
    /// Number of spheres in two cells.
    const PERIOD: u32 = 1 + SMALL.div_ceil(2) + SMALL / 2 * SMALL;
    let mut scene = Scene::new();
    let periods = bodies.div_ceil(PERIOD);
    let block = Block::new(2 * periods, CELLS[0], 4);
    let inside = |index: u32, cell: f32| {
        let place = IVec3::new((index % SIDE) as i32, (index / (SIDE * SIDE)) as i32, (index / SIDE % SIDE) as i32);
        cell * (place - SIDE as i32 / 2).as_vec3()
    };
    for index in 0..bodies {
        let mut random = random_of(seed, index);
        let (period, place) = (index / PERIOD, index % PERIOD);
        // The rest of the period is in the second cell: alternately 1 middle sphere and 343 smallest ones.
        let (middle, small) = (place.saturating_sub(1) / (SMALL + 1) * 2, place.saturating_sub(1) % (SMALL + 1));
        let (centre, radius, cell) = if place == 0 {
            (block.centre(2 * period), 50.0, CELLS[0])
        } else if small == 0 {
            let offset = inside(middle, CELLS[1]);
            (block.centre(2 * period + 1) + offset, 7.0, CELLS[1])
        } else {
            let offset = inside(middle + 1, CELLS[1]) + inside(small - 1, CELLS[2]);
            (block.centre(2 * period + 1) + offset, random.between(1.0, 1.2), CELLS[2])
        };
        let position = centre + random.offset(0.49 * cell - radius * UNIT);
        // Masses are proportional to the radius, not to the volume. Contact forces are proportional to the mass of the lighter
        // body, so small spheres could never support one that is 125,000 times as heavy.
        scene.add_sphere(Sphere::new(position, radius * UNIT).mass(radius))?;
    }
    block.enclose(&mut scene, 2 * periods)?;
    Ok(scene)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [u32; 8] = [1, 2, 5, 64, 345, 346, 1000, 4000];

    #[test]
    fn counts_are_exact_and_seeds_decide() {
        for benchmark in Benchmark::ALL {
            for bodies in SIZES {
                let counts = benchmark.generate(bodies, 7).unwrap().counts();
                let (spheres, rods) = match benchmark {
                    Benchmark::Mixed => (bodies + bodies / 2, bodies / 2),
                    _ => (bodies, 0),
                };
                assert_eq!((counts.spheres as u32, counts.rods as u32), (spheres, rods), "{benchmark}");
            }
            let spheres = |seed| benchmark.generate(100, seed).unwrap().spheres().to_vec();
            assert_eq!(spheres(1), spheres(1), "{benchmark}");
            assert_eq!(spheres(1) == spheres(2), benchmark == Benchmark::Lattice, "{benchmark}");
            assert!(benchmark.generate(0, 0).is_err());
            assert_eq!(benchmark.name().parse::<Benchmark>().unwrap(), benchmark);
        }
        assert!("heap".parse::<Benchmark>().is_err());
    }

    #[test]
    fn shuffled_is_the_pile_in_another_order() {
        let sorted = |benchmark: Benchmark| {
            let mut positions: Vec<_> = benchmark.generate(500, 3).unwrap().spheres().to_vec();
            positions.sort_by(|a, b| a.position.x.total_cmp(&b.position.x));
            positions
        };
        assert_eq!(sorted(Benchmark::Pile), sorted(Benchmark::Shuffled));
        let first = |benchmark: Benchmark| benchmark.generate(500, 3).unwrap().spheres()[..20].to_vec();
        assert_ne!(first(Benchmark::Pile), first(Benchmark::Shuffled));
    }

    /// The deepest overlap of two spheres, as a fraction of the smaller radius.
    fn overlap(scene: &Scene) -> f32 {
        let balls = scene.spheres();
        let gap = |a: &Sphere, b: &Sphere| a.position.distance(b.position) - a.radius - b.radius;
        let pairs = balls.iter().enumerate().flat_map(|(at, a)| balls[at + 1..].iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| -gap(a, b) / a.radius.min(b.radius)).fold(0.0, f32::max)
    }

    #[test]
    fn only_resting_spheres_touch_at_first() {
        // The spheres that stand for boxes are larger than these.
        for benchmark in Benchmark::ALL.into_iter().filter(|benchmark| *benchmark != Benchmark::Boxes) {
            for bodies in SIZES {
                let deepest = overlap(&benchmark.generate(bodies, 11).unwrap());
                let least = match benchmark {
                    Benchmark::Lattice if bodies > 1 => 0.05..0.07,
                    _ => 0.0..1e-4,
                };
                assert!(least.contains(&deepest), "{benchmark} {bodies}: {deepest}");
            }
        }
    }

    #[test]
    fn radii_differ_by_a_factor_of_fifty() {
        let scene = Benchmark::Radii.generate(100_000, 1).unwrap();
        let radii = || scene.spheres().iter().map(|sphere| sphere.radius);
        let (least, greatest) = (radii().fold(f32::MAX, f32::min), radii().fold(0.0, f32::max));
        assert!((49.0..=50.0).contains(&(greatest / least)), "{least} to {greatest}");
        let many = |radius: f32| radii().filter(|r| *r > 0.9 * radius).count();
        assert_eq!(many(2.5), 2);
        assert!(many(0.35) > 200);
    }
}
