//! Which geoms meet, and their friction.

use rockfall::{Material, MaterialId, Pair, Result, Scene};

use crate::model::{Friction, Geom, Mask, Model};
use crate::notes::Notes;

use super::merge::Merged;

/// Greatest number of materials. Geoms with further coefficients have the last one.
const MOST_MATERIALS: usize = 30;

/// Greatest number of masks.
const MOST_MASKS: usize = 300;

/// The groups and materials of geoms.
pub(super) struct Contacts {
    masks: Vec<Mask>,
    /// The group of every mask; `None` for geoms that meet none.
    groups: Vec<Option<u16>>,
    is_exact: bool,
    frictions: Vec<Friction>,
    materials: Vec<MaterialId>,
    /// The number of the body of every link.
    pub(super) numbers: Vec<usize>,
}

/// The bodies of the geoms of a mask.
struct Users {
    first: usize,
    several: bool,
}

impl Contacts {
    pub(super) fn of(model: &Model, merged: &Merged, notes: &mut Notes) -> crate::Result<Self> {
        let all =
            || model.links.iter().enumerate().flat_map(|(link, of)| of.geoms.iter().map(move |geom| (merged.tops[link], geom)));
        let mut masks: Vec<Mask> = all().map(|(_, geom)| geom.mask).collect();
        masks.sort_unstable();
        masks.dedup();
        if masks.len() > MOST_MASKS {
            let message = format!("geoms have more than {MOST_MASKS} combinations of contype and conaffinity");
            return Err(model.links[0].element.wrong(message));
        }
        let mut users: Vec<Option<Users>> = masks.iter().map(|_| None).collect();
        let mut frictions: Vec<Friction> = Vec::new();
        for (top, geom) in all() {
            let place = masks.binary_search(&geom.mask).unwrap_or(0);
            match &mut users[place] {
                Some(known) => known.several |= known.first != top,
                free => *free = Some(Users { first: top, several: false }),
            }
            if let Some(friction) = geom.friction
                && !frictions.contains(&friction)
                && frictions.len() < MOST_MATERIALS
            {
                frictions.push(friction);
            }
        }
        let users: Vec<Users> = users.into_iter().flatten().collect();
        let (groups, wrong) = groups(&masks, &users);
        for [a, b] in &wrong {
            let [a, b] = [a, b].map(|place| format!("contype={} conaffinity={}", masks[*place].kind, masks[*place].affinity));
            let text = "collide in the scene, because groups cannot say that they do not, unless they overlap at the start";
            notes.push(format!("{}: geoms with {a} and those with {b} {text}", model.links[0].element.file.display()));
        }
        Ok(Self { masks, groups, is_exact: wrong.is_empty(), frictions, materials: Vec::new(), numbers: Vec::new() })
    }

    /// Whether exactly those geoms meet that meet in the file.
    pub(super) fn is_exact(&self) -> bool {
        self.is_exact
    }

    /// The group of a geom; `None` if it meets none.
    pub(super) fn group(&self, geom: &Geom) -> Option<u16> {
        self.masks.binary_search(&geom.mask).ok().and_then(|place| self.groups[place])
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

/// The groups of masks, and the pairs that meet in the scene but not in the file.
fn groups(masks: &[Mask], users: &[Users]) -> (Vec<Option<u16>>, Vec<[usize; 2]>) {
    let count = masks.len();
    // The first mask that each one is connected with.
    let mut roots: Vec<usize> = (0..count).collect();
    let mut is_alone = vec![true; count];
    for a in 0..count {
        for b in 0..=a {
            let together = a != b || users[a].several;
            if together && masks[a].meets(masks[b]) {
                (is_alone[a], is_alone[b]) = (false, false);
                let [from, to] = [roots[a].max(roots[b]), roots[a].min(roots[b])];
                roots.iter_mut().filter(|root| **root == from).for_each(|root| *root = to);
            }
        }
    }
    let mut wrong = Vec::new();
    for a in 0..count {
        for b in 0..=a {
            let is_one_body = !users[a].several && !users[b].several && users[a].first == users[b].first;
            if roots[a] == roots[b] && !is_alone[a] && !is_one_body && !masks[a].meets(masks[b]) && (a != b || users[a].several)
            {
                wrong.push([b, a]);
            }
        }
    }
    let mut order: Vec<usize> = Vec::new();
    let groups = (0..count).map(|mask| {
        if is_alone[mask] {
            return None;
        }
        let place = order.iter().position(|root| *root == roots[mask]).unwrap_or_else(|| {
            order.push(roots[mask]);
            order.len() - 1
        });
        u16::try_from(place).ok()
    });
    (groups.collect(), wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(masks: &[(u32, u32)], several: bool) -> (Vec<Option<u16>>, Vec<[usize; 2]>) {
        let masks: Vec<Mask> = masks.iter().map(|&(kind, affinity)| Mask { kind, affinity }).collect();
        let users: Vec<Users> = (0..masks.len()).map(|first| Users { first, several }).collect();
        groups(&masks, &users)
    }

    #[test]
    fn groups_of_masks() {
        assert_eq!(of(&[(1, 1)], true), (vec![Some(0)], vec![]));
        assert_eq!(of(&[(0, 1)], true), (vec![None], vec![]), "nothing meets");
        assert_eq!(of(&[(1, 1), (2, 2)], true), (vec![Some(0), Some(1)], vec![]), "two worlds");
        assert_eq!(
            of(&[(1, 0), (1, 1)], true),
            (vec![Some(0), Some(0)], vec![[0, 0]]),
            "the parts of an ant do not meet each other"
        );
        assert_eq!(of(&[(0, 0), (1, 1)], true), (vec![None, Some(0)], vec![]), "visuals");
        assert_eq!(of(&[(1, 0), (0, 1)], false), (vec![Some(0), Some(0)], vec![]), "one body each");
    }
}
