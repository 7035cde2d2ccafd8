//! Finds impacts that are deeper than walls hold back: where contact forces stop bodies, a soft contact lets the centre pass
//! the wall.

use std::collections::BTreeMap;

use crate::laws::Reduced;
use crate::scene::{Cuboid, Scene, Sphere};
use crate::settings::ContactLaw;
use crate::stability::{Thin, nearest, rounded_up};

/// A warning that contact forces are too soft to stop a body at a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeepImpact {
    /// The contact law.
    pub law: ContactLaw,
    /// The wall that the body may pass through.
    pub what: Thin,
    /// Index of the sphere that goes deepest, compared with the limit, in order of addition.
    pub sphere: usize,
    /// The speed that bodies may reach, plus that of the fastest moving wall, in units/s.
    pub speed: f64,
    /// The depth of an elastic impact of the sphere at this speed, in units.
    pub depth: f64,
    /// The depth at which the centre passes a polygon, or the middle of a box, in units.
    pub limit: f64,
    /// Number by which Young's modulus (`linear` with a given stiffness: the stiffness; the law of the thesis: `contact_force`)
    /// must be multiplied at least, so that the depth is at most the limit.
    pub factor: f64,
}

impl DeepImpact {
    /// A message that names the sphere, the wall and what would hold it.
    pub fn describe(&self, scene: &Scene) -> String {
        let Self { law, what, sphere, speed, depth, limit, factor } = *self;
        let radii = nearest(depth / f64::from(scene.spheres()[sphere].radius));
        let [speed, depth, limit] = [speed, depth, limit].map(nearest);
        let wall = match what {
            Thin::Box(index) => {
                format!("box number {index}: the limit is half its thickness plus the radius, {limit}")
            }
            _ => format!("polygons: the limit is the radius, {limit}"),
        };
        let remedy = if law.has_history() {
            format!("make the material at least {} times as stiff", nearest(rounded_up(factor)))
        } else {
            let force = f64::from(scene.resolved_settings().contact_force);
            format!("use a contact_force of at least {}", nearest(rounded_up(factor * force)))
        };
        format!(
            "contact law {law}: impacts of {} at {speed} units/s are up to {depth} units deep, {radii} radii, and may pass \
             through {wall}; {remedy}",
            scene.name_of_sphere(sphere)
        )
    }
}

impl Scene {
    /// Returns a warning if the contact forces of the scene may let a body pass through a box or polygon, however short the
    /// time step is. `None` where collisions by impulses stop bodies, and for the law of a program.
    ///
    /// The speed u is that of [`Scene::tunnelling`]. An elastic impact on a wall is u / sqrt(Cc) deep for the law of the
    /// thesis; the other laws have formulas of their own. Damping makes it less.
    pub fn deep_impact(&self) -> Option<DeepImpact> {
        let law = self.contact_law();
        if self.settings.collisions {
            return None;
        }
        let speed = self.greatest_speed() + self.greatest_wall_speed();
        let force = f64::from(self.resolved_settings().contact_force);
        let walls = self.thinnest_walls();
        let impacts = self.moving_surfaces().flat_map(|(index, sphere)| {
            let radius = f64::from(sphere.radius);
            let of_wall = move |(&(material, group), &(half, what)): (&(u16, u16), &(f64, Thin))| {
                let (depth, power) = self.depth_of_impact(sphere, material, speed, force).filter(|_| group == sphere.group)?;
                let limit = radius + half;
                Some(DeepImpact { law, what, sphere: index, speed, depth, limit, factor: (depth / limit).powf(power) })
            };
            walls.iter().filter_map(of_wall)
        });
        let share = |impact: &DeepImpact| impact.depth / impact.limit;
        let deepest = impacts.max_by(|one, other| share(one).total_cmp(&share(other)))?;
        (share(&deepest) > 1.0 + 1e-6).then_some(deepest)
    }

    /// For each material and group, half the thickness of the thinnest wall, and that wall. Polygons have no thickness.
    fn thinnest_walls(&self) -> BTreeMap<(u16, u16), (f64, Thin)> {
        let thickness =
            |cuboid: &Cuboid| cuboid.edges.map(|edge| edge.as_dvec3().length()).into_iter().fold(f64::INFINITY, f64::min);
        let boxes = self.boxes().iter().enumerate();
        let boxes = boxes.map(|(index, cuboid)| (cuboid.material, cuboid.group, 0.5 * thickness(cuboid), Thin::Box(index)));
        let polygons = self.polygons().iter().map(|polygon| (polygon.material, polygon.group, 0.0, Thin::Polygon));
        let mut thinnest = BTreeMap::new();
        for (material, group, half, what) in boxes.chain(polygons) {
            let Ok(number) = self.material_number(material) else { continue };
            let least = thinnest.entry((number, group)).or_insert((half, what));
            if half < least.0 {
                *least = (half, what);
            }
        }
        thinnest
    }

    /// The depth of an elastic impact of a sphere on a wall of a material at a speed, and the power of the depth to which the
    /// stiffness is in inverse proportion.
    fn depth_of_impact(&self, sphere: &Sphere, wall: u16, speed: f64, force: f64) -> Option<(f64, f64)> {
        let own = self.material_number(sphere.material).ok()?;
        let [mass, radius] = [sphere.mass, sphere.radius].map(f64::from);
        let law = self.contact_law();
        let Some(grain) = law.grain() else {
            // Without a contact force nothing is meant to be held.
            return (law == ContactLaw::Thesis && force > 0.0).then(|| (speed / force.sqrt(), 2.0));
        };
        grain.depth_at(&self.given(own, wall), Reduced { radius, mass }, speed)
    }
}
