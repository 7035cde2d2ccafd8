//! Contact laws for grains: the tests of Chung and Ooi, stacked balls, rolling and twisting resistance, and cohesion.

mod impacts;
mod necks;
mod resting;

use rockfall::{ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Scene, Simulation, Sphere};

use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

/// Young's modulus in Pa, Poisson's ratio, density in kg/m³.
#[derive(Clone, Copy)]
struct Solid(f64, f64, f64);

impl Solid {
    /// E* of two bodies of this solid, in Pa.
    fn reduced_modulus(self) -> f64 {
        self.0 / (2.0 * (1.0 - self.1 * self.1))
    }

    fn mass(self, radius: f64) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * self.2
    }
}

/// A scene with the law `hertz-mindlin` and one material.
struct Grains {
    scene: Scene,
    solid: Solid,
    material: MaterialId,
}

impl Grains {
    fn new(solid: Solid, pair: Pair) -> Result<Self> {
        let mut scene = with(|settings| {
            settings.contact_law = ContactLaw::HertzMindlin;
            settings.collisions = false;
            settings.gravity = 0.0;
        });
        let Solid(young, poisson, density) = solid;
        let material = Material::new("solid").young(young as f32).poisson(poisson as f32).density(density as f32);
        let material = scene.add_material(material)?;
        scene.set_pair(material, material, pair)?;
        Ok(Self { scene, solid, material })
    }

    /// Adds the plane y = 0.
    fn plane(&mut self, half: f32) -> Result<()> {
        let plane = Cuboid::between([-half, -half, -half], [half, 0.0, half]);
        self.scene.add_box(plane.material(self.material))?;
        Ok(())
    }

    fn ball(&self, position: [f64; 3], radius: f64) -> Sphere {
        let position = position.map(|coordinate| coordinate as f32);
        Sphere::new(position, radius as f32).density(self.solid.2 as f32).material(self.material)
    }

    fn simulation(self) -> Result<Simulation> {
        on_cpu(self.scene, Integrator::SymplecticEuler)
    }
}

/// Overlap at which Hertz's force is `force`.
fn hertz_overlap(solid: Solid, radius: f64, force: f64) -> f64 {
    (3.0 * force / (4.0 * solid.reduced_modulus() * radius.sqrt())).powf(2.0 / 3.0)
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        impacts::run(&mut outcome)?;
        resting::run(&mut outcome)?;
        necks::run(&mut outcome)?;
        Ok(outcome)
    })
}
