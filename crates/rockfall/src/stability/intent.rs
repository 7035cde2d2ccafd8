//! Finds what a scene says but its author hardly means: contacts without friction, bodies behind polygons, fixed bodies with a velocity.

use std::collections::BTreeSet;

use crate::model::view::PolygonRecord;
use crate::physics::geometry::point_over_polygon;
use crate::scene::{Polygon, Scene, Sphere, Surface};

/// Largest number of spheres times polygons that are compared.
const COMPARISONS: usize = 50_000_000;

impl Scene {
    /// Warnings about what is likely not meant, one for each kind, for the first such object:
    ///
    /// - with a contact law with history, a pair of materials without friction, which slides as on ice;
    /// - a moving sphere whose centre is behind a polygon and nearer than its radius: polygons act on one side only;
    /// - a fixed sphere with a velocity, which moves its surface and not its place;
    /// - a negative gravity, which pulls upwards.
    pub fn intent(&self) -> Vec<String> {
        let mut found = Vec::new();
        found.extend(self.slippery_pair());
        found.extend(self.behind_polygon());
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
        if !self.settings.contact_law.has_history() || self.settings.coulomb_friction > 0.0 {
            return None;
        }
        let number = |material| self.material_number(material).ok().filter(|number| *number > 0);
        let movers = self.spheres().iter().filter(|sphere| !sphere.fixed);
        let own: BTreeSet<u16> = movers.filter_map(|sphere| number(sphere.material)).collect();
        let walls = self.boxes().iter().map(|cuboid| cuboid.material).chain(self.polygons().iter().map(|face| face.material));
        let all: BTreeSet<u16> = own.iter().copied().chain(walls.filter_map(number)).collect();
        let of_spheres = || self.spheres().iter().filter_map(|sphere| number(sphere.material));
        let several = |material: u16| of_spheres().filter(|other| *other == material).nth(1).is_some();
        let pairs = own.iter().flat_map(|one| all.iter().map(move |other| (*one, *other)));
        let (one, other) = pairs
            .filter(|(one, other)| one != other || several(*one))
            .find(|(one, other)| self.pair_of_numbers(*one, *other).friction.is_none())?;
        let name = |number: u16| self.materials()[usize::from(number) - 1].name.as_str();
        Some(format!(
            "the pair of materials {} {} has no friction, so that contacts slide without resistance: set friction in its @pair line, 0 if \
             that is meant",
            name(one),
            name(other),
        ))
    }

    fn behind_polygon(&self) -> Option<String> {
        if self.spheres().len().saturating_mul(self.polygons().len()) > COMPARISONS {
            return None;
        }
        let movers = || self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
        let of_face = |(number, face): (usize, &Polygon)| {
            if face.surface != Surface::Parallelogram {
                return None;
            }
            let record = PolygonRecord::of(face);
            let is_behind = |sphere: &Sphere| {
                let (_, height, inside) = point_over_polygon(&record, sphere.position);
                inside && height < 0.0 && height > -sphere.radius && sphere.group == face.group
            };
            let (index, _) = movers().find(|(_, sphere)| is_behind(sphere))?;
            Some(format!(
                "{} is behind polygon number {number} and overlaps it: a polygon acts only on the side that its normal L x R points to, so \
                 the body is not held; turn the polygon round by exchanging L and R",
                self.name_of_sphere(index),
            ))
        };
        self.polygons().iter().enumerate().find_map(of_face)
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
