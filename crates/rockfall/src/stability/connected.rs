//! Sets of bodies that rods, springs, tethers and joints connect or hold, and where they are along gravity and across it.

use glam::{DVec3, Vec3};

use crate::scene::{BondedSets, Scene, SphereId};

/// Bounds along gravity and across it: `[down, east, north]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

pub(super) const NOTHING: Bounds = Bounds { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

impl Bounds {
    pub(super) fn add(&mut self, point: DVec3, radius: f64) {
        self.min = self.min.min(point - radius);
        self.max = self.max.max(point + radius);
    }

    pub(super) fn join(self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether something that falls through `self` may meet `other`.
    pub(super) fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && self.max.cmpge(other.min).all()
    }
}

/// Spheres that are connected by rods, springs, tethers, rigid bodies and joints.
#[derive(Clone, Debug)]
pub(super) struct Set {
    /// Where its bodies are.
    pub(super) own: Bounds,
    /// Where it comes by, if nothing stops it.
    pub(super) path: Bounds,
    /// A fixed sphere or a tether holds it, or an external force moves it.
    pub(super) held: bool,
    pub(super) first: SphereId,
    /// Number of its spheres.
    bodies: u32,
}

/// Directions `[down, east, north]` of a scene; `None` without gravity.
pub(super) fn directions(scene: &Scene) -> Option<[DVec3; 3]> {
    let gravity = f64::from(scene.settings.gravity);
    let down = scene.settings.gravity_direction.as_dvec3().normalize() * gravity.signum();
    let (east, north) = down.any_orthonormal_pair();
    (gravity != 0.0 && down.is_finite()).then_some([down, east, north])
}

impl Scene {
    /// The sets of bodies that rods and springs connect. Fixed spheres, tethers and external forces hold their sets.
    pub(super) fn sets_at_rest(&self) -> BondedSets {
        self.moved_by_forces(self.bonded_sets(|_| true))
    }

    fn moved_by_forces(&self, mut sets: BondedSets) -> BondedSets {
        for (index, sphere) in self.spheres().iter().enumerate() {
            if sphere.force != Vec3::ZERO {
                sets.hold(index);
            }
        }
        sets
    }
}

/// The sets of connected bodies, fixed ones included.
pub(super) fn sets(scene: &Scene, directions: [DVec3; 3]) -> Vec<Set> {
    let (spheres, gravity) = (scene.spheres(), f64::from(scene.settings.gravity.abs()));
    let turn = |point: DVec3| turned(directions, point);
    let bonded = scene.moved_by_forces(scene.joined_sets());
    let mut place = vec![u32::MAX; spheres.len()];
    let mut sets: Vec<Set> = Vec::new();
    for (index, (sphere, id)) in spheres.iter().zip(scene.sphere_ids()).enumerate() {
        let first = bonded.first(index);
        if first == index {
            place[index] = sets.len() as u32;
            sets.push(Set { own: NOTHING, path: NOTHING, held: bonded.is_held(index), first: id, bodies: 0 });
        }
        let set = &mut sets[place[first] as usize];
        set.bodies += 1;
        set.own.add(turn(sphere.position.as_dvec3()), sphere.radius.into());
    }
    for (index, sphere) in spheres.iter().enumerate() {
        let set = &mut sets[place[bonded.first(index)] as usize];
        // Several spheres may turn about their centre, so they may reach as far as they are apart.
        let reach = if set.bodies > 1 { (set.own.max - set.own.min).length() } else { 0.0 };
        let v = turn(sphere.velocity.as_dvec3());
        let rise = v.x.min(0.0).powi(2) / (2.0 * gravity);
        let side = |v: f64, bound: f64| {
            if v == 0.0 {
                0.0
            } else if (v > 0.0) == (bound > 0.0) {
                f64::INFINITY
            } else {
                0.0
            }
        };
        let low = DVec3::new(rise, side(v.y, -1.0), side(v.z, -1.0)) + reach;
        let high = DVec3::new(f64::INFINITY, side(v.y, 1.0), side(v.z, 1.0)) + reach;
        set.path = set.path.join(&Bounds { min: set.own.min - low, max: set.own.max + high });
    }
    sets
}

/// A point as its components along the directions.
pub(super) fn turned(directions: [DVec3; 3], point: DVec3) -> DVec3 {
    DVec3::from_array(directions.map(|direction| direction.dot(point)))
}
