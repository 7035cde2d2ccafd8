//! Which groups of objects touch each other.

use std::collections::{BTreeMap, BTreeSet};

use super::Scene;
use crate::error::{Error, Result};
use crate::rigid::groups::GroupWords;
use crate::settings::ContactLaw;

/// The greatest number of groups that [`Scene::set_group_meets`] names.
pub(crate) const MOST_NAMED: usize = 30;

/// For groups that have a list of their own: the groups that they meet. All others meet themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Groups {
    meets: BTreeMap<u16, BTreeSet<u16>>,
}

impl Groups {
    /// The lists, in the order of the groups.
    pub(crate) fn lists(&self) -> impl Iterator<Item = (u16, &BTreeSet<u16>)> {
        self.meets.iter().map(|(group, met)| (*group, met))
    }

    /// The groups that lists name, in ascending order.
    fn named(&self) -> BTreeSet<u16> {
        self.meets.iter().flat_map(|(group, met)| met.iter().copied().chain([*group])).collect()
    }

    /// The words of a group.
    pub(crate) fn words(&self, group: u16) -> GroupWords {
        let named = self.named();
        let Some(place) = named.iter().position(|known| *known == group) else {
            return GroupWords { own: u32::from(group) | 31 << 16, meets: 0 };
        };
        let touched = named.iter().map(|other| u32::from(self.touch(group, *other)));
        let meets = touched.enumerate().fold(1 << 30, |bits, (at, touched)| bits | touched << at);
        GroupWords { own: u32::from(group) | (place as u32) << 16, meets }
    }

    /// Whether objects of two groups touch.
    pub(crate) fn touch(&self, one: u16, other: u16) -> bool {
        let meets = |from: u16, to: u16| self.meets.get(&from).map_or(from == to, |met| met.contains(&to));
        meets(one, other) || meets(other, one)
    }
}

impl Scene {
    /// Sets the groups whose objects those of a group touch. Without a list, a group touches itself alone. With one, it
    /// touches the groups of its
    /// list, and itself only if the list has it; and those whose lists have it. Needs the contact law [`Rigid`](crate::ContactLaw::Rigid).
    ///
    /// # Errors
    /// [`Error::Invalid`] for more than 30 groups that have a list or are in one.
    pub fn set_group_meets(&mut self, group: u16, groups: impl IntoIterator<Item = u16>) -> Result<()> {
        let mut changed = self.groups.clone();
        changed.meets.insert(group, groups.into_iter().collect());
        let count = changed.named().len();
        if count > MOST_NAMED {
            let expected = "at most 30 groups that have a list or are in one";
            return Err(Error::Invalid { field: "group.meets", value: format!("{count} groups"), expected });
        }
        self.groups = changed;
        Ok(())
    }

    /// The groups that a group has in its list ([`Scene::set_group_meets`]), in ascending order. `None` without a list.
    pub fn group_meets(&self, group: u16) -> Option<Vec<u16>> {
        self.groups.meets.get(&group).map(|met| met.iter().copied().collect())
    }

    /// Whether objects of two groups touch.
    pub fn groups_touch(&self, one: u16, other: u16) -> bool {
        self.groups.touch(one, other)
    }

    /// Checks that the contact law knows lists of groups, if the scene has any.
    pub(crate) fn check_groups(&self) -> Result<()> {
        let law = self.contact_law();
        match self.groups.lists().next() {
            Some((group, _)) if law != ContactLaw::Rigid => {
                let expected = "rigid: `meets` of groups needs `set contact_law rigid`";
                Err(Error::Invalid { field: "contact_law", value: format!("{law} with `meets` of group {group}"), expected })
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
#[path = "groups_tests.rs"]
mod tests;
