//! Names, colours, looks and labels of objects.

use std::sync::Arc;

use super::{BoxId, CapsuleId, Colour, Handle, Look, PolygonId, Registry, RigidBodyId, RodId, Scene, SphereId, SpringId};
use crate::error::{Error, Result, nearest, quoted};

/// What an object is called and how it is drawn. No result depends on it. An object that is removed takes it along.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Tag {
    /// Name. Several objects may have the same. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: Option<String>,
    /// Colour in pictures; `None` for that of the kind of object.
    pub colour: Option<Colour>,
    /// How its surface is drawn; `None` for the usual look of the kind of object.
    pub look: Option<Look>,
    /// Text beside the object in pictures with labels. It is one line without ` #`, and not `-`. An empty text is no label. A scene in
    /// which an object has a label, also an empty one, shows no numbers instead.
    pub label: Option<String>,
}

impl Tag {
    /// Creates a tag without name, colour, look and label.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the name.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Sets the colour.
    pub fn colour(mut self, colour: Colour) -> Self {
        self.colour = Some(colour);
        self
    }

    /// Sets the look.
    pub fn look(mut self, look: Look) -> Self {
        self.look = Some(look);
        self
    }

    /// Sets the label.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }

    /// This tag, with what it leaves open from another one.
    pub fn or(&self, other: &Self) -> Self {
        let (one, other) = (self.clone(), other.clone());
        Self {
            name: one.name.or(other.name),
            colour: one.colour.or(other.colour),
            look: one.look.or(other.look),
            label: one.label.or(other.label),
        }
    }

    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks that a scene text can express the tag.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name or a label with characters that it may not have.
    pub fn validate(&self) -> Result<()> {
        if let Some(name) = &self.name {
            check_name("tag.name", name)?;
        }
        self.label.as_deref().map_or(Ok(()), check_label)
    }
}

pub(super) fn check_name(field: &'static str, name: &str) -> Result<()> {
    let is_allowed = |letter: char| !letter.is_whitespace() && !letter.is_control() && !"=,#".contains(letter);
    if name.starts_with(|first: char| first.is_alphabetic() || first == '_') && name.chars().all(is_allowed) {
        return Ok(());
    }
    let expected = "one word that begins with a letter or _ and has no = , or #";
    Err(Error::Invalid { field, value: quoted(name), expected })
}

fn check_label(label: &str) -> Result<()> {
    let begins_comment =
        label.match_indices('#').any(|(at, _)| label[..at].chars().next_back().is_none_or(char::is_whitespace));
    if label != "-" && label.trim() == label && !begins_comment && !label.contains(char::is_control) {
        return Ok(());
    }
    let expected =
        "a line of text other than -, without white space at its ends and without # at its beginning or after white space";
    Err(Error::Invalid { field: "tag.label", value: quoted(label), expected })
}

/// The handle of an object that can have a [`Tag`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ObjectId {
    /// A sphere.
    Sphere(SphereId),
    /// A rod.
    Rod(RodId),
    /// A capsule.
    Capsule(CapsuleId),
    /// A spring.
    Spring(SpringId),
    /// A static box.
    Box(BoxId),
    /// A static polygon.
    Polygon(PolygonId),
    /// A rigid body.
    Body(RigidBodyId),
}

macro_rules! kinds {
    ($($kind:ident, $all:ident, $handle:ty;)*) => {
        $(impl From<$handle> for ObjectId {
            fn from(id: $handle) -> Self {
                Self::$kind(id)
            }
        })*

        impl Scene {
            fn tag_of(&self, id: ObjectId) -> Result<Option<&Arc<Tag>>> {
                Ok(match id {
                    $(ObjectId::$kind(id) => self.$all.tag_at(self.$all.index(id)?),)*
                })
            }

            /// Gives an object a tag that was checked. The parts of a capsule keep theirs.
            pub(crate) fn put_tag(&mut self, id: ObjectId, tag: Option<Arc<Tag>>) -> Result<()> {
                self.tag_changes += 1;
                match id {
                    $(ObjectId::$kind(id) => self.$all.set_tag(id, tag),)*
                }
            }

            /// All objects with a tag: kind by kind, each in order of addition.
            pub(crate) fn tagged(&self) -> impl Iterator<Item = (ObjectId, &Arc<Tag>)> {
                std::iter::empty()$(.chain(tagged(&self.$all)))*
            }
        }
    };
}

kinds! {
    Sphere, spheres, SphereId;
    Rod, rods, RodId;
    Capsule, capsules, CapsuleId;
    Spring, springs, SpringId;
    Box, boxes, BoxId;
    Polygon, polygons, PolygonId;
    Body, bodies, RigidBodyId;
}

fn tagged<T>(objects: &Registry<T>) -> impl Iterator<Item = (ObjectId, &Arc<Tag>)>
where
    ObjectId: From<Handle<T>>,
{
    objects.tags().map(|(index, tag)| (objects.handle_at(index).into(), tag))
}

impl Scene {
    /// The name, colour, look and label of an object; `None` if it has none of them.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when the object is not in the scene.
    pub fn tag(&self, id: impl Into<ObjectId>) -> Result<Option<&Tag>> {
        Ok(self.tag_of(id.into())?.map(Arc::as_ref))
    }

    /// Replaces the name, colour, look and label of an object. The spheres and the rod of a capsule get those of the capsule too, and
    /// those of a rigid body get what their shape does not say.
    ///
    /// # Errors
    /// [`Error::Invalid`] as for [`Tag::validate`], [`Error::StaleHandle`] when the object is not in the scene.
    pub fn set_tag(&mut self, id: impl Into<ObjectId>, tag: Tag) -> Result<()> {
        tag.validate()?;
        self.share_tag(id.into(), &shared(tag))
    }

    /// Gives an object a tag that was checked, and the parts of a capsule or rigid body too.
    pub(crate) fn share_tag(&mut self, id: ObjectId, tag: &Option<Arc<Tag>>) -> Result<()> {
        self.put_tag(id, tag.clone())?;
        if let ObjectId::Capsule(id) = id {
            let parts = *self.capsules.get(id)?;
            for part in [ObjectId::from(parts.end1), parts.end2.into(), parts.rod.into()] {
                self.put_tag(part, tag.clone())?;
            }
        }
        if let ObjectId::Body(id) = id {
            for (part, tag) in self.tags_of_members(id, tag)? {
                self.put_tag(part, tag)?;
            }
        }
        Ok(())
    }

    /// The objects with a name: spheres, rods, capsules, springs, boxes, polygons and rigid bodies, each kind in order of addition.
    /// The spheres and rods of capsules and rigid bodies are among them.
    ///
    /// # Errors
    /// [`Error::UnknownName`] when no object has it.
    pub fn named(&self, name: &str) -> Result<Vec<ObjectId>> {
        let found: Vec<ObjectId> =
            self.tagged().filter(|(_, tag)| tag.name.as_deref() == Some(name)).map(|(id, _)| id).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let names = self.names();
        let hint = match nearest(name, &names) {
            Some(near) => format!("did you mean {}?", quoted(near)),
            None if names.is_empty() => "the scene has no names (a line `@name NAME` gives one)".to_owned(),
            None => format!("expected one of {}", first_names(&names)),
        };
        Err(Error::UnknownName { name: name.to_owned(), hint })
    }

    /// The names of objects, each once, in alphabetical order.
    pub fn names(&self) -> Vec<&str> {
        let names: std::collections::BTreeSet<&str> = self.tagged().filter_map(|(_, tag)| tag.name.as_deref()).collect();
        names.into_iter().collect()
    }

    /// A number that grows when a tag is set, so that a program can detect a new colour or label.
    pub fn tag_changes(&self) -> u64 {
        self.tag_changes
    }

    /// The name of an object in quotation marks, in parentheses and after a space, for a message; empty if it has none.
    pub(crate) fn called(&self, id: impl Into<ObjectId>) -> String {
        let name = self.tag(id).ok().flatten().and_then(|tag| tag.name.as_deref());
        name.map_or(String::new(), |name| format!(" ({})", quoted(name)))
    }
}

/// A tag to share between objects; `None` for an empty one.
pub(crate) fn shared(tag: Tag) -> Option<Arc<Tag>> {
    (!tag.is_empty()).then(|| Arc::new(tag))
}

/// The first names of a list, for a message.
fn first_names(names: &[&str]) -> String {
    const MOST: usize = 8;
    let shown: Vec<String> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    shown.join(", ") + if names.len() > MOST { ", ..." } else { "" }
}

#[cfg(test)]
#[path = "tag_tests.rs"]
mod tests;
