//! Finds what a scene says but its author hardly means: contacts without friction, bodies behind polygons, fixed bodies with a velocity.

use std::collections::{BTreeMap, BTreeSet};

use crate::scene::{Scene, Sphere};

impl Scene {
    /// Warnings about what is likely not meant, one for each kind, for the first such object:
    ///
    /// - with a contact law with history, a pair of materials without friction, which slides as on ice;
    /// - a moving sphere behind a polygon, which overlaps it or falls through it: polygons act on one side only;
    /// - a fixed sphere with a velocity, which moves its surface and not its place;
    /// - a negative gravity, which pulls upwards.
    pub fn intent(&self) -> Vec<String> {
        let mut found = Vec::new();
        found.extend(self.slippery_pair());
        found.extend(self.behind_polygon().or_else(|| self.falls_through_polygon()));
        found.extend(self.moving_surface());
        found.extend(self.gravity_upwards());
        found
    }

    fn gravity_upwards(&self) -> Option<String> {
        let gravity = self.settings.gravity;
        (gravity < 0.0).then(|| {
            format!(
                "gravity {gravity} pulls against gravity_direction, because gravity is a magnitude: set gravity {}, or turn gravity_direction \
                 round if bodies are meant to rise",
                -gravity
            )
        })
    }

    fn slippery_pair(&self) -> Option<String> {
        if !self.contact_law().has_history() || self.settings.coulomb_friction > 0.0 {
            return None;
        }
        let number = |material| self.material_number(material).ok().filter(|number| *number > 0);
        let movers = self.spheres().iter().filter(|sphere| !sphere.fixed);
        let own: BTreeSet<u16> = movers.filter_map(|sphere| number(sphere.material)).collect();
        let walls = self.boxes().iter().map(|cuboid| cuboid.material).chain(self.polygons().iter().map(|face| face.material));
        let surfaces = self.spheres().iter().map(|sphere| sphere.material).chain(walls).filter_map(number);
        let mut counts: BTreeMap<u16, usize> = BTreeMap::new();
        surfaces.for_each(|material| *counts.entry(material).or_default() += 1);
        let pairs = own.iter().flat_map(|one| counts.iter().map(move |(other, count)| (*one, *other, *count)));
        let (one, other, _) = pairs
            .filter(|(one, other, count)| one != other || *count > 1)
            .find(|(one, other, _)| self.pair_of_numbers(*one, *other).friction.is_none())?;
        let name = |number: u16| self.materials()[usize::from(number) - 1].name.as_str();
        Some(format!(
            "the pair of materials {} {} has no friction, so that contacts slide without resistance: set friction in its @pair line, 0 if \
             that is meant",
            name(one),
            name(other),
        ))
    }

    fn moving_surface(&self) -> Option<String> {
        let moves = |sphere: &Sphere| sphere.fixed && sphere.velocity.length_squared() > 0.0;
        let index = self.spheres().iter().position(moves)?;
        Some(format!(
            "{} is fixed and has a velocity: this moves its surface, as on a conveyor belt, and not its place",
            self.name_of_sphere(index),
        ))
    }
}
