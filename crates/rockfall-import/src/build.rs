//! Makes a scene of a tree of links.

use std::path::Path;

use rockfall::{Anchor, Placement, RigidBodyId, Scene, Tag};

use crate::Imported;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::notes::Notes;

mod bodies;
mod colliders;
mod contacts;
mod joints;
mod merge;
mod names;

use bodies::Body;
use contacts::Contacts;
use names::Names;

/// Greatest number of links.
pub(crate) const MOST_LINKS: usize = 10_000;
/// Rounds in which pairs are found that overlap at the start. Pairs that joints keep apart are not found again.
const ROUNDS: usize = 3;

/// What the parts of this module share.
struct Builder<'a> {
    path: &'a Path,
    scene: Scene,
    notes: Notes,
    bodies: Names,
    joints: Names,
    contacts: Contacts,
}

pub(crate) fn scene(path: &Path, model: Model, notes: Notes) -> Result<Imported> {
    if model.links.len() > MOST_LINKS {
        return Err(model.links[MOST_LINKS].element.wrong(format!("more than {MOST_LINKS} links")));
    }
    let mut scene = Scene::new();
    let failed = |source| Error::Scene { file: path.to_owned(), source };
    scene.settings.set("contact_law", "rigid").map_err(failed)?;
    let gravity = model.gravity;
    scene.settings.gravity = gravity.length() as f32;
    if let Some(direction) = gravity.try_normalize() {
        scene.settings.gravity_direction = direction.as_vec3();
    }
    let mut notes = notes;
    let merged = merge::merged(&model, &mut notes)?;
    let contacts = Contacts::of(&model, &mut notes);
    let mut builder = Builder { path, scene, notes, bodies: Names::new(&["world"]), joints: Names::new(&[]), contacts };
    builder.contacts.add_groups(&mut builder.scene).map_err(failed)?;
    builder.contacts.add_materials(&mut builder.scene).map_err(failed)?;
    let bodies = bodies::of(&model, &merged, &mut builder)?;
    builder.add_world(&bodies)?;
    let ids = builder.add_bodies(&bodies)?;
    builder.add_joints(&model, &bodies, &ids, &merged.poses)?;
    if !(model.has_masks && builder.contacts.is_exact()) {
        builder.part_overlaps()?;
    }
    Ok(Imported { scene: builder.scene, notes: builder.notes.into_vec() })
}

impl Builder<'_> {
    fn failed(&self, source: rockfall::Error) -> Error {
        Error::Scene { file: self.path.to_owned(), source }
    }

    /// Adds the bodies, each with a shape of its name. The first one, the world, has no handle.
    fn add_bodies(&mut self, bodies: &[Body]) -> Result<Vec<Option<RigidBodyId>>> {
        let mut ids = vec![None];
        for (number, body) in bodies.iter().enumerate().skip(1) {
            let shape = self.shape(body, number)?;
            let wrong = |error: rockfall::Error| body.element.wrong(error.to_string());
            let shape = self.scene.add_shape(shape).map_err(wrong)?;
            let place = Placement::new(shape).at(body.pose.at).turned(body.pose.turn.as_quat().normalize());
            let id = self.scene.add_body(place).map_err(wrong)?;
            self.scene.set_tag(id, Tag::new().name(&body.name)).map_err(wrong)?;
            ids.push(Some(id));
        }
        Ok(ids)
    }

    /// Keeps bodies apart that overlap at the start.
    fn part_overlaps(&mut self) -> Result<()> {
        for _ in 0..ROUNDS {
            let found = self.scene.placement().map_err(|error| self.failed(error))?;
            let owner = |body: rockfall::Body| match body {
                rockfall::Body::Sphere(id) => self.scene.body_of_sphere(id),
                rockfall::Body::Rod(id) => self.scene.body_of_rod(id),
                _ => None,
            };
            let mut pairs: Vec<[RigidBodyId; 2]> = Vec::new();
            for overlap in found.overlaps {
                if let [Some(a), Some(b)] = overlap.bodies.map(owner)
                    && a != b
                    && !pairs.contains(&[a, b])
                    && !pairs.contains(&[b, a])
                {
                    pairs.push([a, b]);
                }
            }
            if pairs.is_empty() {
                break;
            }
            for [a, b] in pairs {
                let names = [a, b].map(|id| self.name_of(id));
                self.part(a, b)?;
                let [one, other] = names;
                self.notes
                    .push(format!("{}: {one} and {other} overlap at the start, so they never touch", self.path.display()));
            }
        }
        Ok(())
    }

    fn name_of(&self, id: RigidBodyId) -> String {
        let tag = self.scene.tag(id).ok().flatten();
        tag.and_then(|tag| tag.name.clone()).unwrap_or_default()
    }
}

/// The end of a joint at a body.
fn anchor(ids: &[Option<RigidBodyId>], number: usize) -> Anchor {
    ids[number].map_or(Anchor::World, Anchor::Body)
}
