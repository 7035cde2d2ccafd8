//! Names, colours, looks and labels in a checkpoint: the length of what follows in bytes, 0 if no object has one; the different tags, each
//! as name, colour, look and label; and the objects that have them, each as kind, index of the object and index of the tag.

use std::collections::HashMap;
use std::sync::Arc;

use super::words::{Damage, Head, Words};
use crate::scene::{Colour, Handle, Look, ObjectId, Registry, Scene, Tag};

pub(super) fn bytes(scene: &Scene) -> Vec<u8> {
    let mut numbers: HashMap<&Tag, u32> = HashMap::new();
    let (mut tags, mut objects) = (Head::default(), Head::default());
    let mut count = 0_u64;
    for (id, tag) in scene.tagged() {
        let next = numbers.len() as u32;
        let number = *numbers.entry(tag).or_insert_with(|| {
            put_tag(&mut tags, tag);
            next
        });
        let (kind, index) = place(scene, id);
        [kind, index, number].into_iter().for_each(|word| objects.u32(word));
        count += 1;
    }
    let mut head = Head::default();
    if count > 0 {
        head.u32(numbers.len() as u32);
        head.bytes.extend(tags.bytes);
        head.u64(count);
        head.bytes.extend(objects.bytes);
    }
    head.block()
}

pub(super) fn put_tag(head: &mut Head, Tag { name, colour, look, label }: &Tag) {
    head.text(name.as_deref().unwrap_or_default());
    head.u32(colour.map_or(0, |Colour([red, green, blue])| 1 + u32::from_be_bytes([0, red, green, blue])));
    head.u32(look.map_or(0, |look| 1 + look as u32));
    head.text(label.as_deref().unwrap_or_default());
}

pub(super) fn put(given: &[u8], scene: &mut Scene) -> Result<(), Damage> {
    if given.is_empty() {
        return Ok(());
    }
    let mut words = Words::new(given);
    let mut tags = Vec::new();
    for _ in 0..words.u32()? {
        let tag = read(&mut words)?;
        tag.validate()?;
        tags.push(Some(Arc::new(tag)));
    }
    for _ in 0..words.u64()? {
        let id = object(scene, words.u32()?, words.u32()? as usize)?;
        let tag = tags.get(words.u32()? as usize).ok_or_else(|| Damage::new("an object has a name that is not stored"))?;
        scene.put_tag(id, tag.clone())?;
    }
    words.end()?;
    // There is one form for the same tags.
    let written = bytes(scene);
    if written[size_of::<u64>()..] == *given { Ok(()) } else { Err(Damage::new("its names are not in order")) }
}

pub(super) fn read(words: &mut Words) -> Result<Tag, Damage> {
    let some = |text: String| Some(text).filter(|text| !text.is_empty());
    let mut tag = Tag::new();
    tag.name = some(words.text()?);
    let colour = words.u32()?;
    if let Some(bits) = colour.checked_sub(1) {
        let [0, red, green, blue] = bits.to_be_bytes() else {
            return Err(Damage::new(format!("it has the colour {colour}, expected at most 16777216")));
        };
        tag.colour = Some(Colour([red, green, blue]));
    }
    let look = words.u32()?;
    if let Some(number) = look.checked_sub(1) {
        let found = Look::ALL.get(number as usize);
        let expected = Look::ALL.len();
        tag.look = Some(*found.ok_or_else(|| Damage::new(format!("it has the look {look}, expected at most {expected}")))?);
    }
    tag.label = some(words.text()?);
    Ok(tag)
}

/// The number of the kind of an object, and its insertion index.
fn place(scene: &Scene, id: ObjectId) -> (u32, u32) {
    let (kind, index) = match id {
        ObjectId::Sphere(id) => (0, scene.spheres.index(id)),
        ObjectId::Rod(id) => (1, scene.rods.index(id)),
        ObjectId::Capsule(id) => (2, scene.capsules.index(id)),
        ObjectId::Spring(id) => (3, scene.springs.index(id)),
        ObjectId::Box(id) => (4, scene.boxes.index(id)),
        ObjectId::Polygon(id) => (5, scene.polygons.index(id)),
        ObjectId::Body(id) => (6, scene.bodies.index(id)),
    };
    (kind, index.map_or(u32::MAX, |index| index as u32))
}

fn object(scene: &Scene, kind: u32, index: usize) -> Result<ObjectId, Damage> {
    fn of<T>(objects: &Registry<T>, index: usize) -> Option<ObjectId>
    where
        ObjectId: From<Handle<T>>,
    {
        (index < objects.len()).then(|| objects.handle_at(index).into())
    }
    let found = match kind {
        0 => of(&scene.spheres, index),
        1 => of(&scene.rods, index),
        2 => of(&scene.capsules, index),
        3 => of(&scene.springs, index),
        4 => of(&scene.boxes, index),
        5 => of(&scene.polygons, index),
        6 => of(&scene.bodies, index),
        _ => None,
    };
    found.ok_or_else(|| Damage::new(format!("it has a name for object {index} of kind {kind}, which is not in it")))
}
