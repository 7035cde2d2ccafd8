//! Finds constants that a scene sets without effect.

use crate::scene::{Scene, Surface};
use crate::settings::{ContactLaw, Settings};

impl Scene {
    /// The constants that differ from their defaults and have no effect in this scene, with the reason for each.
    pub fn idle_settings(&self) -> Vec<(&'static str, String)> {
        let Settings { contact_law: law, collisions, coulomb_friction, gravity, .. } = self.chosen_settings();
        let of_law = (law != ContactLaw::Thesis).then(|| format!("contact law {law} does not use it"));
        let of_rigid = of_law.clone().filter(|_| law == ContactLaw::Rigid);
        let of_impulses = (!collisions).then(|| match law {
            ContactLaw::Thesis => "collisions are off".to_owned(),
            _ => format!("collisions are off, because contact law {law} computes the whole impact"),
        });
        let of_gravity = (gravity == 0.0).then(|| "gravity is 0".to_owned());
        // A pair may have a Coulomb friction of 0 of its own, and then the friction of the thesis.
        let of_friction = coulomb_friction > 0.0 && self.pairs.is_empty();
        let of_friction = of_friction.then(|| "coulomb_friction takes its place".to_owned());
        let of_meshes = self.polygons().iter().all(|polygon| polygon.surface != Surface::Triangle);
        let reasons = [
            ("collisions", of_rigid.clone()),
            ("linear_damping", of_rigid.clone()),
            ("angular_damping", of_rigid.clone()),
            ("activation_threshold", of_rigid.clone().or(of_impulses.clone())),
            // A law with history takes it for pairs that have none.
            ("restitution", of_impulses.clone().filter(|_| law == ContactLaw::Thesis)),
            ("collision_friction", of_rigid.clone().or(of_impulses.clone())),
            ("continuous_collisions", of_rigid.or(of_impulses)),
            ("contact_damping", of_law.clone()),
            ("contact_force", of_law.clone()),
            ("contact_pull", of_law.clone()),
            ("friction", of_law.clone().or(of_friction)),
            ("resting_overlap", of_law.or(of_gravity.clone())),
            ("gravity_direction", of_gravity),
            ("mesh_angle", of_meshes.then(|| "the scene has no triangles".to_owned())),
        ];
        let (settings, defaults) = (self.settings, Settings::default());
        let is_changed = |name: &str| settings.get(name) != defaults.get(name);
        let idle = reasons.into_iter().filter_map(|(name, reason)| Some((name, reason?)));
        idle.filter(|(name, _)| is_changed(name)).collect()
    }
}
