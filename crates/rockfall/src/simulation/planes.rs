//! The flow through the planes of gauges.
//!
//! Each passage along the normal counts once, and each passage against it is subtracted. So the sum over all steps is the difference
//! between what is in front of the plane now and what was at the start, and no step in between has to be looked at. Spheres that
//! edits add, remove or move change what was at the start.

use glam::DVec3;

use crate::model::world::World;
use crate::scene::{Front, Gauge, Scene};

/// What is in front of the planes of all gauges.
#[derive(Debug, Default)]
pub(super) struct Planes {
    /// For every gauge, what was in front at the start, changed by edits since.
    bases: Vec<Front>,
    /// The mass of every sphere in order of addition, 0 for fixed ones, as they were when the world was packed. Empty without
    /// planes.
    masses: Vec<f32>,
}

impl Planes {
    /// The flow at the start: nothing has passed.
    pub(super) fn start(scene: &Scene) -> Self {
        Self { bases: fronts(scene), masses: masses(scene) }
    }

    /// The flow at a checkpoint. Gauges that were added to its scene begin there.
    pub(super) fn resumed(scene: &Scene, bases: &[Front]) -> Self {
        let mut flow = Self::start(scene);
        flow.bases.iter_mut().zip(bases).for_each(|(base, kept)| *base = *kept);
        flow
    }

    /// For every gauge, what was in front at the start, changed by edits since.
    pub(super) fn bases(&self) -> &[Front] {
        &self.bases
    }

    /// What has passed the plane of every gauge, in the state of a scene.
    pub(super) fn passed(&self, scene: &Scene) -> Vec<Front> {
        fronts(scene).into_iter().zip(&self.bases).map(|(now, base)| now.less(*base)).collect()
    }

    /// Begins to count for a gauge that was added to the scene.
    pub(super) fn begin(&mut self, scene: &Scene) {
        let added = fronts(scene).into_iter().skip(self.bases.len());
        self.bases.extend(added);
        self.masses = masses(scene);
    }

    /// What is in front of every plane in the arrays of the simulation, whose spheres may have been removed from the scene. Empty
    /// without planes.
    pub(super) fn in_front_of(&self, world: &World, scene: &Scene) -> Vec<Front> {
        let spheres = self.masses.len();
        if spheres == 0 {
            return Vec::new();
        }
        let mut slots = vec![0; spheres];
        (0..spheres).for_each(|slot| slots[world.insertion_index(slot)] = slot);
        let state = &world.states[0];
        let centre = |slot: usize| {
            let [high, low] = [state[slot], state[3 * spheres + slot]].map(|row| row.truncate().as_dvec3());
            high + low
        };
        let spheres: Vec<(f32, DVec3)> = self.masses.iter().zip(&slots).map(|(mass, slot)| (*mass, centre(*slot))).collect();
        scene.gauges().iter().map(|gauge| front(scene, gauge, spheres.iter().copied())).collect()
    }

    /// Takes into account that edits have changed the spheres; `before` was in front before them.
    pub(super) fn edited(&mut self, before: Vec<Front>, scene: &Scene) {
        if !scene.gauges().iter().any(|gauge| gauge.of.is_plane()) {
            return;
        }
        let before = before.into_iter().chain(std::iter::repeat(Front::default()));
        for ((base, now), before) in self.bases.iter_mut().zip(fronts(scene)).zip(before) {
            *base = now.less(before.less(*base));
        }
        self.masses = masses(scene);
    }
}

/// What is in front of the plane of a gauge, of spheres with their masses and centres.
fn front(scene: &Scene, gauge: &Gauge, spheres: impl Iterator<Item = (f32, DVec3)>) -> Front {
    let mut front = Front::default();
    if gauge.of.is_plane() {
        let (bounds, movable) = (scene.periodic(), spheres.filter(|(mass, _)| *mass != 0.0));
        movable.for_each(|(mass, centre)| front.add(mass, gauge.of.times_in_front(centre, &bounds)));
    }
    front
}

fn fronts(scene: &Scene) -> Vec<Front> {
    let spheres = || scene.spheres().iter().map(|sphere| (mass(sphere), DVec3::from_array(sphere.centre())));
    scene.gauges().iter().map(|gauge| front(scene, gauge, spheres())).collect()
}

fn mass(sphere: &crate::scene::Sphere) -> f32 {
    if sphere.fixed { 0.0 } else { sphere.mass }
}

fn masses(scene: &Scene) -> Vec<f32> {
    let has_planes = scene.gauges().iter().any(|gauge| gauge.of.is_plane());
    if has_planes { scene.spheres().iter().map(mass).collect() } else { Vec::new() }
}
