//! Which geoms meet, and their friction.

use rockfall::{Material, MaterialId, Pair, Result, Scene};

use crate::model::{Friction, Geom, Mask, Model};
use crate::notes::Notes;

/// Greatest number of materials. Geoms with further coefficients have the last one.
const MOST_MATERIALS: usize = 30;

/// Greatest number of masks that groups can stand for ([`Scene::set_group_meets`]).
const MOST_MASKS: usize = 30;

/// The groups and materials of geoms.
pub(super) struct Contacts {
    /// Masks that meet any other, or themselves. Each has a group, its place in the list.
    masks: Vec<Mask>,
    is_exact: bool,
    frictions: Vec<Friction>,
    materials: Vec<MaterialId>,
    /// The number of the body of every link.
    pub(super) numbers: Vec<usize>,
}

impl Contacts {
    pub(super) fn of(model: &Model, notes: &mut Notes) -> Self {
        let all = || model.links.iter().flat_map(|link| &link.geoms);
        let masks = meeting(all().map(|geom| geom.mask).collect());
        let is_exact = masks.len() <= MOST_MASKS;
        if !is_exact {
            let count = masks.len();
            let text =
                format!("{count} pairs of contype and conaffinity, of which groups take {MOST_MASKS}: all geoms collide");
            notes.push(format!("{}: {text}", model.links[0].element.file.display()));
        }
        let mut frictions: Vec<Friction> = Vec::new();
        for friction in all().filter_map(|geom| geom.friction) {
            if !frictions.contains(&friction) && frictions.len() < MOST_MATERIALS {
                frictions.push(friction);
            }
        }
        Self { masks, is_exact, frictions, materials: Vec::new(), numbers: Vec::new() }
    }

    /// Whether exactly those geoms meet that meet in the file.
    pub(super) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// The group of a geom; `None` if it meets none.
    pub(super) fn group(&self, geom: &Geom) -> Option<u16> {
        let place = self.masks.binary_search(&geom.mask).ok()?;
        Some(if self.is_exact { place as u16 } else { 0 })
    }

    /// Says which groups meet. A group without a list meets itself.
    pub(super) fn add_groups(&self, scene: &mut Scene) -> Result<()> {
        if !self.is_exact {
            return Ok(());
        }
        for (place, mask) in self.masks.iter().enumerate() {
            let met = (0..self.masks.len()).filter(|other| mask.meets(self.masks[*other]));
            let met: Vec<u16> = met.map(|other| other as u16).collect();
            if met != [place as u16] {
                scene.set_group_meets(place as u16, met)?;
            }
        }
        Ok(())
    }

    /// A group that no other body has.
    pub(super) fn own_group(number: usize) -> u16 {
        u16::MAX - u16::try_from(number).unwrap_or(0)
    }

    pub(super) fn material(&self, geom: &Geom) -> Option<MaterialId> {
        let wanted = geom.friction?;
        let place = self.frictions.iter().position(|friction| *friction == wanted);
        self.materials.get(place.unwrap_or(self.frictions.len().saturating_sub(1))).copied()
    }

    /// Adds a material for every coefficient of friction. A contact has the greater coefficient of both.
    pub(super) fn add_materials(&mut self, scene: &mut Scene) -> Result<()> {
        for number in 0..self.frictions.len() {
            self.materials.push(scene.add_material(Material::new(format!("friction{number}")))?);
        }
        for (a, one) in self.frictions.iter().enumerate() {
            for (b, other) in self.frictions.iter().enumerate().take(a + 1) {
                let is_smooth = one.is_smooth && other.is_smooth;
                let coefficient = if is_smooth { 0.0 } else { one.coefficient.max(other.coefficient) };
                let pair = Pair::default().friction(coefficient as f32).restitution(0.0);
                scene.set_pair(self.materials[a], self.materials[b], pair)?;
            }
        }
        Ok(())
    }
}

/// The masks that meet any of them, each once and in ascending order.
fn meeting(mut masks: Vec<Mask>) -> Vec<Mask> {
    masks.sort_unstable();
    masks.dedup();
    let all = masks.clone();
    masks.retain(|mask| all.iter().any(|other| mask.meets(*other)));
    masks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touching(masks: &[(u32, u32)]) -> Vec<(u16, u16)> {
        let masks = meeting(masks.iter().map(|&(kind, affinity)| Mask { kind, affinity }).collect());
        let contacts = Contacts { masks, is_exact: true, frictions: Vec::new(), materials: Vec::new(), numbers: Vec::new() };
        let mut scene = Scene::new();
        contacts.add_groups(&mut scene).expect("groups");
        let count = contacts.masks.len() as u16;
        let pairs = (0..count).flat_map(|a| (0..=a).map(move |b| (b, a)));
        pairs.filter(|(a, b)| scene.groups_touch(*a, *b)).collect()
    }

    #[test]
    fn groups_of_masks() {
        assert_eq!(touching(&[(1, 1)]), [(0, 0)]);
        assert_eq!(touching(&[(0, 1)]), [], "nothing meets");
        assert_eq!(touching(&[(1, 1), (2, 2)]), [(0, 0), (1, 1)], "two worlds");
        assert_eq!(touching(&[(1, 0), (1, 1)]), [(0, 1), (1, 1)], "the parts of an ant meet the ground, not each other");
        assert_eq!(touching(&[(0, 0), (1, 1)]), [(0, 0)], "visuals meet nothing");
        assert_eq!(touching(&[(1, 0), (0, 1)]), [(0, 1)]);
    }
}
