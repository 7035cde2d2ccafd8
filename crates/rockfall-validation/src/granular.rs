//! Beds of grains with the law `hertz-mindlin`, which several experiments share. SI units.

use rockfall::{ContactLaw, Integrator, Material, MaterialId, Pair, Scene, Simulation, Sphere, SphereState};

use crate::Result;
use crate::measure::{on_cpu, with};

/// Mean radius of the grains, in m.
pub(crate) const RADIUS: f64 = 0.005;
/// Diameter of the grains, in m.
pub(crate) const DIAMETER: f64 = 2.0 * RADIUS;
pub(crate) const GRAVITY: f64 = 9.81;
/// Density of the grains, in kg/m³.
pub(crate) const DENSITY: f32 = 2500.0;

/// Stiffness of grains, and the time step that belongs to it.
#[derive(Clone, Copy)]
pub(crate) struct Stiffness {
    /// Young's modulus, in Pa.
    pub(crate) young: f32,
    /// Time step, in s.
    pub(crate) step: f32,
}

/// Grains that are soft enough for a long time step, which is an eighth of the Rayleigh time of a grain. The contacts below 30
/// layers overlap by 2 % of the diameter.
pub(crate) const BED: Stiffness = Stiffness { young: 2.5e6, step: 1e-4 };

/// Creates a scene with the law `hertz-mindlin`, a material of the grains with these properties, and one of smooth walls.
pub(crate) fn grains(stiffness: Stiffness, pair: Pair) -> Result<(Scene, MaterialId, MaterialId)> {
    let mut scene = with(|settings| {
        settings.contact_law = ContactLaw::HertzMindlin;
        settings.collisions = false;
        settings.gravity = GRAVITY as f32;
    });
    let solid = |name: &str| Material::new(name).young(stiffness.young).poisson(0.25).density(DENSITY);
    let grain = scene.add_material(solid("grain"))?;
    let smooth = scene.add_material(solid("smooth"))?;
    scene.set_pair(grain, grain, pair)?;
    scene.set_pair(grain, smooth, pair.friction(0.0).rolling_friction(0.0))?;
    Ok((scene, grain, smooth))
}

/// A grain of a radius given in units of [`RADIUS`].
pub(crate) fn grain(material: MaterialId, position: [f64; 3], size: f64) -> Sphere {
    Sphere::new(position.map(|part| part as f32), (size * RADIUS) as f32).density(DENSITY).material(material)
}

pub(crate) fn simulation(scene: Scene) -> Result<Simulation> {
    on_cpu(scene, Integrator::VelocityVerlet)
}

/// The spheres that move.
pub(crate) fn moving(simulation: &mut Simulation) -> Result<Vec<SphereState>> {
    Ok(simulation.spheres()?.into_iter().filter(|sphere| !sphere.fixed).collect())
}
