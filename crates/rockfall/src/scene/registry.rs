//! Objects in insertion order, referred to by handles that stay valid when other objects are removed.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::error::{Error, Result};
use crate::scene::Tag;

/// A handle to an object of kind `T`. It stays valid until that object is removed, regardless of what else is added or removed.
/// A handle to a removed object, or to an object of another scene, causes [`Error::StaleHandle`].
pub struct Handle<T> {
    scene: u32,
    slot: u32,
    generation: u32,
    kind: PhantomData<fn() -> T>,
}

impl<T> Clone for Handle<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Handle<T> {}

impl<T> Handle<T> {
    /// Place of the object in tables that are indexed by slot. Another object may take it when the object was removed.
    pub(super) fn slot(self) -> usize {
        self.slot as usize
    }

    fn key(self) -> (u32, u32, u32) {
        (self.scene, self.slot, self.generation)
    }
}

impl<T> PartialEq for Handle<T> {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl<T> Eq for Handle<T> {}

impl<T> Hash for Handle<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl<T> fmt::Debug for Handle<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}.{}", self.slot, self.generation)
    }
}

/// Number of the next scene. The number lets a scene refuse the handles of other scenes.
static NEXT_SCENE: AtomicU32 = AtomicU32::new(1);

/// Returns a number that no other scene of this process has.
pub(crate) fn new_scene_number() -> u32 {
    NEXT_SCENE.fetch_add(1, Ordering::Relaxed)
}

#[derive(Clone, Debug)]
struct Slot {
    generation: u32,
    /// Index in `objects`, or `None` if the slot is free.
    index: Option<u32>,
}

/// Objects of one kind, stored densely in insertion order.
#[derive(Clone, Debug)]
pub(crate) struct Registry<T> {
    scene: u32,
    kind: &'static str,
    objects: Vec<T>,
    /// Slot of each object.
    owners: Vec<u32>,
    slots: Vec<Slot>,
    free: Vec<u32>,
    /// Tags by insertion index. Objects beyond its end have none.
    tags: Vec<Option<Arc<Tag>>>,
}

impl<T> Registry<T> {
    pub(crate) fn new(scene: u32, kind: &'static str) -> Self {
        Self { scene, kind, objects: Vec::new(), owners: Vec::new(), slots: Vec::new(), free: Vec::new(), tags: Vec::new() }
    }

    pub(crate) fn add(&mut self, object: T) -> Handle<T> {
        let index = Some(self.objects.len() as u32);
        let slot = match self.free.pop() {
            Some(slot) => {
                self.slots[slot as usize].index = index;
                slot
            }
            None => {
                self.slots.push(Slot { generation: 0, index });
                self.slots.len() as u32 - 1
            }
        };
        self.objects.push(object);
        self.owners.push(slot);
        self.handle(slot)
    }

    fn handle(&self, slot: u32) -> Handle<T> {
        Handle { scene: self.scene, slot, generation: self.slots[slot as usize].generation, kind: PhantomData }
    }

    /// The insertion index of an object.
    pub(crate) fn index(&self, handle: Handle<T>) -> Result<usize> {
        let slot = self.slots.get(handle.slot as usize);
        match slot {
            Some(Slot { generation, index: Some(index) }) if *generation == handle.generation && handle.scene == self.scene => {
                Ok(*index as usize)
            }
            _ => Err(Error::StaleHandle { kind: self.kind }),
        }
    }

    pub(crate) fn get(&self, handle: Handle<T>) -> Result<&T> {
        Ok(&self.objects[self.index(handle)?])
    }

    pub(crate) fn get_mut(&mut self, handle: Handle<T>) -> Result<&mut T> {
        let index = self.index(handle)?;
        Ok(&mut self.objects[index])
    }

    /// Removes the objects for which `is_removed` is true. The others keep their order.
    pub(crate) fn remove_where(&mut self, mut is_removed: impl FnMut(&T) -> bool) {
        let flags: Vec<bool> = self.objects.iter().map(&mut is_removed).collect();
        self.remove_flagged(&flags);
    }

    /// Removes objects in one pass. If one of them does not exist, nothing is removed.
    pub(crate) fn remove(&mut self, handles: &[Handle<T>]) -> Result<()> {
        let mut flags = vec![false; self.objects.len()];
        for handle in handles {
            flags[self.index(*handle)?] = true;
        }
        self.remove_flagged(&flags);
        Ok(())
    }

    fn remove_flagged(&mut self, flags: &[bool]) {
        if !flags.contains(&true) {
            return;
        }
        for (owner, _) in self.owners.iter().zip(flags).filter(|(_, flag)| **flag) {
            let slot = &mut self.slots[*owner as usize];
            slot.index = None;
            slot.generation = slot.generation.wrapping_add(1);
            self.free.push(*owner);
        }
        let mut keep = flags.iter().map(|flag| !flag);
        self.objects.retain(|_| keep.next().unwrap_or(true));
        let mut keep = flags.iter().map(|flag| !flag);
        self.owners.retain(|_| keep.next().unwrap_or(true));
        let mut keep = flags.iter().map(|flag| !flag);
        self.tags.retain(|_| keep.next().unwrap_or(true));
        for (index, owner) in self.owners.iter().enumerate() {
            self.slots[*owner as usize].index = Some(index as u32);
        }
    }

    pub(crate) fn objects(&self) -> &[T] {
        &self.objects
    }

    pub(crate) fn objects_mut(&mut self) -> &mut [T] {
        &mut self.objects
    }

    pub(crate) fn len(&self) -> usize {
        self.objects.len()
    }

    /// The tag of the object with an insertion index.
    pub(crate) fn tag_at(&self, index: usize) -> Option<&Arc<Tag>> {
        self.tags.get(index)?.as_ref()
    }

    pub(crate) fn set_tag(&mut self, handle: Handle<T>, tag: Option<Arc<Tag>>) -> Result<()> {
        let index = self.index(handle)?;
        if self.tags.len() <= index && tag.is_some() {
            self.tags.resize(self.objects.len(), None);
        }
        if let Some(place) = self.tags.get_mut(index) {
            *place = tag;
        }
        Ok(())
    }

    /// The tags, with the insertion indices of their objects.
    pub(crate) fn tags(&self) -> impl Iterator<Item = (usize, &Arc<Tag>)> {
        self.tags.iter().enumerate().filter_map(|(index, tag)| Some((index, tag.as_ref()?)))
    }

    /// The handle of the object with an insertion index.
    pub(crate) fn handle_at(&self, index: usize) -> Handle<T> {
        self.handle(self.owners[index])
    }

    pub(crate) fn handles(&self) -> impl Iterator<Item = Handle<T>> + Clone + '_ {
        self.owners.iter().map(|slot| self.handle(*slot))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_handle_becomes_stale_only_when_its_own_object_is_removed() {
        let mut registry = Registry::new(new_scene_number(), "number");
        let handles: Vec<_> = (0..4).map(|number| registry.add(number)).collect();
        registry.remove(&[handles[1]]).unwrap();
        assert_eq!(registry.objects(), [0, 2, 3]);
        assert_eq!(registry.get(handles[3]).unwrap(), &3);
        assert!(registry.get(handles[1]).is_err());
        let reused = registry.add(9);
        assert!(registry.get(handles[1]).is_err(), "the slot is reused, but the old handle must stay stale");
        assert_eq!(registry.get(reused).unwrap(), &9);
        assert_eq!(registry.objects(), [0, 2, 3, 9]);
    }

    #[test]
    fn several_objects_are_removed_at_once_or_not_at_all() {
        let mut registry = Registry::new(new_scene_number(), "number");
        let handles: Vec<_> = (0..6).map(|number| registry.add(number)).collect();
        registry.remove(&[handles[4], handles[1], handles[4]]).unwrap();
        assert_eq!(registry.objects(), [0, 2, 3, 5]);
        assert!(registry.remove(&[handles[0], handles[1]]).is_err());
        assert_eq!(registry.objects(), [0, 2, 3, 5]);
        assert_eq!(registry.get(handles[5]).unwrap(), &5);
    }

    #[test]
    fn a_handle_of_another_scene_is_stale() {
        let mut one = Registry::new(new_scene_number(), "number");
        let mut other = Registry::new(new_scene_number(), "number");
        let handle = one.add(1);
        other.add(2);
        assert!(other.get(handle).is_err());
    }
}
