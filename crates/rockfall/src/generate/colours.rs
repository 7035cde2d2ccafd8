//! Colours of the bodies of generated scenes, in bands, so that a picture shows how they move and mix.

use std::sync::Arc;

use glam::Vec3;

use super::{Kind, bodies};
use crate::error::Result;
use crate::scene::{Colour, ObjectId, Scene, Tag};

const PALETTE: [Colour; 5] = [
    Colour([0x2f, 0x6c, 0xa3]),
    Colour([0x45, 0xa0, 0x9a]),
    Colour([0xe6, 0xc7, 0x6b]),
    Colour([0xe2, 0x8a, 0x44]),
    Colour([0xc2, 0x4d, 0x3b]),
];

/// Colours all spheres, capsules and rigid bodies.
pub(super) fn colour(kind: Kind, scene: &mut Scene) -> Result<()> {
    let spheres = scene.sphere_ids().zip(scene.spheres()).filter(|(id, _)| scene.body_of_sphere(*id).is_none());
    let mut objects: Vec<(ObjectId, Vec3)> = spheres.map(|(id, sphere)| (id.into(), sphere.position)).collect();
    for (id, capsule) in scene.capsule_ids().zip(scene.capsules()) {
        objects.push((id.into(), scene.sphere(capsule.end1)?.position));
    }
    objects.extend(scene.body_ids().zip(scene.bodies()).map(|(id, body)| (id.into(), body.position)));
    let values: Vec<f32> = objects.iter().enumerate().map(|(number, (_, place))| value(kind, number, *place)).collect();
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    let range = values.iter().copied().fold(f32::NEG_INFINITY, f32::max) - least;
    let tags = PALETTE.map(|colour| Some(Arc::new(Tag::new().colour(colour))));
    for ((id, _), value) in objects.into_iter().zip(values) {
        let part = if range > 0.0 { (value - least) / range } else { 0.0 };
        let band = (part * tags.len() as f32) as usize;
        scene.share_tag(id, &tags[band.min(tags.len() - 1)])?;
    }
    Ok(())
}

/// The quantity that decides about the band of an object.
fn value(kind: Kind, number: usize, place: Vec3) -> f32 {
    match kind {
        Kind::Drum | Kind::Mixer | Kind::ShearCell | Kind::Screw => place.x,
        Kind::Chain => (number / bodies::CHAIN as usize % PALETTE.len()) as f32,
        Kind::Dominoes | Kind::Hulls => number as f32,
        Kind::Arch => place.x,
        Kind::Soft => (number / bodies::BLOB as usize % PALETTE.len()) as f32,
        _ => place.y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The colours of bodies are written with the scene, and parts of a body have one colour.
    #[test]
    fn bodies_have_all_colours() {
        for kind in Kind::ALL {
            let scene = kind.generate(1000, 1).unwrap();
            let text = scene.to_text();
            for colour in PALETTE {
                assert!(text.contains(&format!("@colour {colour}\n")), "{kind}: {colour}");
            }
            assert!(text.contains(&format!("@run dt={}", kind.time_step())), "{kind}");
            let colours = |id: ObjectId| scene.tag(id).unwrap().and_then(|tag| tag.colour);
            assert!(scene.sphere_ids().all(|id| colours(id.into()).is_some()), "{kind}");
            assert!(scene.body_ids().all(|id| colours(id.into()).is_some()), "{kind}");
        }
    }

    #[test]
    fn layers_of_a_pile_differ_in_colour() {
        let scene = Kind::Pile.generate(1000, 1).unwrap();
        let colour = |pick: fn(f32, f32) -> bool| {
            let ends = scene
                .sphere_ids()
                .zip(scene.spheres())
                .reduce(|one, other| if pick(other.1.position.y, one.1.position.y) { other } else { one });
            scene.tag(ends.unwrap().0).unwrap().unwrap().colour
        };
        assert_eq!([colour(|a, b| a < b), colour(|a, b| a > b)], [Some(PALETTE[0]), Some(PALETTE[4])]);
    }
}
