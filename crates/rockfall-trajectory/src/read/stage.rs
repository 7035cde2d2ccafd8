//! Shows frames with different spheres in one simulation.

use std::collections::HashSet;
use std::io;

use rockfall::{Error, GrainKind, Placement, Radii, Result, Scene, ShapeId, Simulation, Sphere, SphereId};

use super::npz::{Cast, Gone};
use super::{States, unusable};

/// All spheres of a trajectory, and those that a simulation has.
#[derive(Debug)]
pub(super) struct Stage {
    /// A scene with all spheres.
    everyone: Scene,
    /// The spheres by id.
    spheres: Vec<SphereId>,
    /// The spheres of the frame that was shown last, in the order of the scene.
    present: Vec<SphereId>,
}

impl Stage {
    /// `scene` has the objects of the last state.
    pub(super) fn new(mut scene: Scene, cast: &Cast) -> io::Result<Self> {
        let (found, expected) = (cast.scene.len(), scene.counts().spheres);
        if found != expected {
            return Err(unusable(&format!("array scene_id has {found} spheres, but its scene has {expected}")));
        }
        let mut spheres: Vec<(u32, SphereId)> = cast.scene.iter().copied().zip(scene.sphere_ids()).collect();
        let kinds = if scene.shapes().is_empty() { Vec::new() } else { kinds(scene.clone()) };
        let mut rest = &cast.gone[..];
        while let Some((id, first)) = rest.first() {
            let failed = |error| unusable(&format!("the sphere with id {id}: {error}"));
            let added = match kinds.iter().find(|kind| kind.begins(rest)) {
                Some(kind) => add_body(&mut scene, kind.shape).map_err(failed)?,
                None => vec![add(&mut scene, first).map_err(failed)?],
            };
            let (these, others) = rest.split_at(added.len());
            spheres.extend(these.iter().map(|(id, _)| *id).zip(added));
            rest = others;
        }
        spheres.sort_unstable_by_key(|(id, _)| *id);
        let present = scene.sphere_ids().collect();
        Ok(Self { everyone: scene, spheres: spheres.into_iter().map(|(_, sphere)| sphere).collect(), present })
    }

    pub(super) fn everyone(&self) -> &Scene {
        &self.everyone
    }

    pub(super) fn spheres(&self) -> &[SphereId] {
        &self.spheres
    }

    pub(super) fn show(&mut self, states: &States, simulation: &mut Simulation) -> Result<()> {
        let scene = simulation.scene();
        if scene.sphere_ids().eq(self.everyone.sphere_ids()) {
            // Names and colours may have been changed.
            self.everyone = scene.clone();
        } else if !scene.sphere_ids().eq(self.present.iter().copied()) {
            let value = format!("{} spheres", scene.counts().spheres);
            return Err(Error::Invalid { field: "frame", value, expected: "the spheres of a frame of the trajectory" });
        }
        let wanted: Vec<SphereId> = states.ids.iter().map(|id| self.spheres[*id as usize]).collect();
        self.call(&wanted.iter().copied().collect(), simulation)?;
        states.put(wanted, simulation)
    }

    /// Gives a simulation these spheres of the scene, and no others.
    fn call(&mut self, wanted: &HashSet<SphereId>, simulation: &mut Simulation) -> Result<()> {
        let scene = simulation.scene();
        if scene.counts().spheres == wanted.len() && scene.sphere_ids().all(|id| wanted.contains(&id)) {
            self.present = scene.sphere_ids().collect();
            return Ok(());
        }
        for id in scene.sphere_ids() {
            let tag = scene.tag(id)?.cloned().unwrap_or_default();
            self.everyone.set_tag(id, tag)?;
        }
        let mut checkpoint = simulation.checkpoint()?;
        checkpoint.scene = self.everyone.clone();
        remove_others(&mut checkpoint.scene, wanted)?;
        self.present = checkpoint.scene.sphere_ids().collect();
        simulation.restore(&checkpoint)
    }
}

/// Removes all spheres that are not wanted, with the bodies that they are part of.
fn remove_others(scene: &mut Scene, wanted: &HashSet<SphereId>) -> Result<()> {
    let others: Vec<SphereId> = scene.sphere_ids().filter(|id| !wanted.contains(id)).collect();
    let bodies: HashSet<_> = others.iter().filter_map(|id| scene.body_of_sphere(*id)).collect();
    let loose: Vec<SphereId> = others.into_iter().filter(|id| scene.body_of_sphere(*id).is_none()).collect();
    scene.remove_bodies(&bodies.into_iter().collect::<Vec<_>>())?;
    scene.remove_spheres(&loose)
}

/// The spheres of a rigid body of a shape.
struct Kind {
    shape: ShapeId,
    /// Radius and mass.
    spheres: Vec<[f32; 2]>,
}

impl Kind {
    /// Whether a list of spheres begins with those of a body of the shape, which follow each other.
    fn begins(&self, gone: &[(u32, Gone)]) -> bool {
        let is_part = |(id, Gone { radius, mass, is_fixed }): &(u32, Gone), first: u32, number: usize| {
            id.checked_sub(first) == Some(number as u32) && !is_fixed && [*radius, *mass] == self.spheres[number]
        };
        gone.len() >= self.spheres.len() && (0..self.spheres.len()).all(|number| is_part(&gone[number], gone[0].0, number))
    }
}

/// What bodies of all shapes of a scene are made of, those of more spheres first. The scene is a copy, in which one of each is laid.
fn kinds(mut scene: Scene) -> Vec<Kind> {
    let shapes: Vec<ShapeId> = scene.shape_ids().collect();
    let kind = |shape: ShapeId| {
        let spheres =
            add_body(&mut scene, shape).ok()?.into_iter().map(|id| scene.sphere(id).map(|sphere| [sphere.radius, sphere.mass]));
        Some(Kind { shape, spheres: spheres.collect::<Result<_>>().ok()? })
    };
    let mut kinds: Vec<Kind> = shapes.into_iter().filter_map(kind).collect();
    kinds.sort_by_key(|kind| std::cmp::Reverse(kind.spheres.len()));
    kinds
}

/// Adds a body that the last state has not. Returns its spheres.
fn add_body(scene: &mut Scene, shape: ShapeId) -> Result<Vec<SphereId>> {
    let id = scene.add_body(Placement::new(shape))?;
    let tag = coming(scene).find(|kind| kind.shape == Some(shape)).map(|kind| kind.tag.clone());
    if let Some(tag) = tag {
        scene.set_tag(id, tag)?;
    }
    Ok(scene.body(id)?.spheres().to_vec())
}

/// Adds a sphere that the last state has not.
fn add(scene: &mut Scene, gone: &Gone) -> Result<SphereId> {
    let Gone { radius, mass, is_fixed } = *gone;
    let mut sphere = Sphere::new([0.0; 3], radius);
    (sphere.mass, sphere.fixed) = (mass, is_fixed);
    let kind = coming(scene).find(|kind| kind.shape.is_none() && has_radius(kind, f64::from(radius))).cloned();
    if let Some(kind) = &kind {
        (sphere.group, sphere.material) = (kind.group, kind.material);
    }
    let id = scene.add_sphere(sphere)?;
    if let Some(kind) = kind {
        scene.set_tag(id, kind.tag)?;
    }
    Ok(id)
}

/// What the inlets of a scene let in.
fn coming(scene: &Scene) -> impl Iterator<Item = &GrainKind> {
    scene.inlets().iter().flat_map(|inlet| &inlet.kinds).map(|(kind, _)| kind)
}

/// Whether spheres of a kind may have a radius.
fn has_radius(kind: &GrainKind, radius: f64) -> bool {
    let is_in = |from: f64, to: f64| (from * (1.0 - 1e-6)..=to * (1.0 + 1e-6)).contains(&radius);
    match kind.radii {
        Radii::Equal(equal) => is_in(equal, equal),
        Radii::Uniform(from, to) => is_in(from, to),
        _ => true,
    }
}
