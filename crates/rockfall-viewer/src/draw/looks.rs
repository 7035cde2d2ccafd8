//! The looks of objects (`@look`), as the shaders read them.

use rockfall::{Look, ObjectId, Scene};

/// Bits of the look of an object.
const BITS: usize = 4;
const PER_WORD: usize = u32::BITS as usize / BITS;

/// The look that the scene gives to an object.
pub(crate) fn look(scene: &Scene, id: impl Into<ObjectId>) -> Option<Look> {
    scene.tag(id).ok()??.look
}

/// The number of a look in the shaders, as in `wgsl/look.wgsl`; 0 for none.
fn code(look: Option<Look>) -> u32 {
    look.and_then(|look| Look::ALL.iter().position(|other| *other == look)).map_or(0, |place| place as u32 + 1)
}

/// The looks of the objects of a scene.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    /// Four bits for each sphere, rod, box and polygon, in insertion order; no words if no object has a look.
    pub(crate) words: Vec<u32>,
    /// Whether an object is of glass.
    pub(crate) glass: bool,
}

impl Looks {
    pub(crate) fn of(scene: &Scene) -> Self {
        let movers = scene.sphere_ids().map(|id| look(scene, id)).chain(scene.rod_ids().map(|id| look(scene, id)));
        let statics = scene.box_ids().map(|id| look(scene, id)).chain(scene.polygon_ids().map(|id| look(scene, id)));
        let mut found = Self::default();
        for (place, look) in movers.chain(statics).enumerate().filter(|(_, look)| look.is_some()) {
            found.glass |= look == Some(Look::Glass);
            // The words end with that of the last look until they are filled up below.
            found.words.resize(found.words.len().max(place / PER_WORD + 1), 0);
            found.words[place / PER_WORD] |= code(look) << (BITS * (place % PER_WORD));
        }
        if !found.words.is_empty() {
            let counts = scene.counts();
            let all = counts.spheres + counts.rods + counts.boxes + counts.polygons;
            found.words.resize(all.div_ceil(PER_WORD), 0);
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use rockfall::{Cuboid, Polygon, Rod, Sphere, Tag};

    use super::*;

    #[test]
    fn looks_are_four_bits_per_object_and_take_no_memory_without_any() {
        let mut scene = Scene::new();
        let balls = [0.0, 2.0].map(|x| scene.add_sphere(Sphere::new([x, 1.0, 0.0], 0.5)).unwrap());
        let rod = scene.add_rod(Rod::new(balls[0], balls[1], 0.1)).unwrap();
        let boxes = (0..6).map(|_| scene.add_box(Cuboid::between([-1.0; 3], [1.0; 3])).unwrap()).collect::<Vec<_>>();
        let polygon = scene.add_polygon(Polygon::new([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])).unwrap();
        assert!(Looks::of(&scene).words.is_empty());
        scene.set_tag(balls[1], Tag::new().look(Look::Plain)).unwrap();
        assert_eq!((Looks::of(&scene).words, Looks::of(&scene).glass), (vec![0x10, 0], false));
        scene.set_tag(rod, Tag::new().look(Look::Wood)).unwrap();
        scene.set_tag(boxes[5], Tag::new().look(Look::Glass)).unwrap();
        scene.set_tag(polygon, Tag::new().look(Look::Stone)).unwrap();
        assert_eq!((Looks::of(&scene).words, Looks::of(&scene).glass), (vec![0x310, 0x45], true));
    }
}
