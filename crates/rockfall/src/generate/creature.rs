//! Creatures: spheres, springs with muscles, and a ground.

use glam::Vec3;
use rand::SeedableRng as _;
use rand_pcg::Pcg64Mcg;

use super::{Random, check_count};
use crate::error::{Error, Result};
use crate::scene::{Cuboid, Muscle, Scene, Sphere, Spring};

/// Distance of neighbouring spheres, in units.
const SPACING: f32 = 0.4;
const RADIUS: f32 = 0.1;
/// A spring joins spheres whose indices differ by at most this: those of a slice of the lattice and the two slices beside it.
const NEAR: u32 = 11;
/// Springs per sphere.
const SPRINGS: usize = 3;
/// Stiffness in mass/s² and damping in mass/s of the springs.
const STIFFNESS: f32 = 300.0;
const DAMPING: f32 = 2.0;

/// Number of groups that a scene can have.
const MOST_GROUPS: u32 = 1 << 16;

/// Generates a creature: `spheres` spheres of mass 1 in a lattice two wide and two high, three springs per sphere with muscles of
/// random amplitude, frequency and phase, and a ground with friction. It has fewer springs if there are fewer pairs of spheres.
///
/// Contacts are forces: [`collisions`](crate::Settings::collisions) is off, because feet that walk do not rebound.
///
/// # Errors
/// As for [`Kind::generate`](super::Kind::generate).
pub fn creature(spheres: u32, seed: u64) -> Result<Scene> {
    generate(spheres, seed, |_| 0)
}

/// Generates the creature of [`creature`] with spheres that touch only the ground: each sphere has a group of its own, in which it
/// has a ground of its own. All grounds are equal.
///
/// # Errors
/// As for [`creature`]. [`Error::Invalid`](crate::Error::Invalid) for more than 65,536 spheres, because there are no more groups.
pub fn creature_without_pairs(spheres: u32, seed: u64) -> Result<Scene> {
    if spheres > MOST_GROUPS {
        let expected = "at most 65536 spheres, because each has a group of its own";
        return Err(Error::Invalid { field: "spheres", value: spheres.to_string(), expected });
    }
    generate(spheres, seed, |sphere| sphere as u16)
}

fn generate(spheres: u32, seed: u64, group: impl Fn(u32) -> u16) -> Result<Scene> {
    check_count(spheres)?;
    let mut random = Random(Pcg64Mcg::seed_from_u64(seed));
    let mut scene = Scene::new();
    scene.settings.gravity = 9.81;
    scene.settings.collisions = false;
    // So stiff that feet at rest sink by 5 % of their radius.
    scene.settings.contact_force = 2000.0;
    scene.settings.contact_damping = 20.0;
    let length = spheres.div_ceil(4) as f32 * SPACING;
    for group in 0..=group(spheres - 1) {
        scene.add_box(Cuboid::between([-1000.0, -1.0, -1000.0], [1000.0, 0.0, 1000.0]).group(group))?;
    }
    let place = |sphere: u32| {
        let cell = Vec3::new((sphere / 4) as f32, (sphere / 2 % 2) as f32, (sphere % 2) as f32);
        SPACING * cell + Vec3::new(-0.5 * length, RADIUS, -0.5 * SPACING)
    };
    let ball = |sphere: u32| Sphere::new(place(sphere), RADIUS).group(group(sphere));
    let ids = (0..spheres).map(|sphere| scene.add_sphere(ball(sphere))).collect::<Result<Vec<_>>>()?;
    let mut pairs: Vec<(u32, u32)> = (0..spheres).flat_map(|b| (b.saturating_sub(NEAR)..b).map(move |a| (a, b))).collect();
    // The shortest springs, in insertion order.
    pairs.sort_by(|one, other| {
        let length = |pair: &(u32, u32)| (1000.0 * place(pair.0).distance(place(pair.1))).round() as u32;
        (length(one), one).cmp(&(length(other), other))
    });
    pairs.truncate(SPRINGS * spheres as usize);
    pairs.sort_unstable();
    for (a, b) in pairs {
        let muscle = Muscle::new(random.between(0.1, 0.3), random.between(1.0, 2.0), random.between(0.0, 1.0));
        let spring = Spring::new(ids[a as usize], ids[b as usize], STIFFNESS, place(a).distance(place(b)));
        scene.add_spring(spring.damping(DAMPING).muscle(muscle))?;
    }
    Ok(scene)
}
