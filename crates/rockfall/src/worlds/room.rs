//! A limit on the number of worlds. A program that asks for too many gets an error before they take memory: without memory, the whole
//! process would end.

use std::hint::black_box;

use super::World;
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Largest number of worlds.
const MOST: usize = 1 << 20;
/// Bytes that an object takes at least, in the scene, in its arrays and in the state that a reset returns to.
const OBJECT_BYTES: usize = 256;

/// Collects scenes, if there is room for a world of each.
pub(super) fn collected(scenes: impl IntoIterator<Item = Scene>) -> Result<Vec<Scene>> {
    let mut scenes = scenes.into_iter().peekable();
    let announced = scenes.size_hint().0;
    check(announced, scenes.peek())?;
    let mut found = Vec::with_capacity(announced);
    for scene in scenes {
        if found.len() == MOST {
            check(MOST + 1, None)?;
        }
        found.push(scene);
    }
    Ok(found)
}

/// Checks that there is room for a number of worlds like the first one.
fn check(count: usize, first: Option<&Scene>) -> Result<()> {
    let refused = |value, expected| Err(Error::Invalid { field: "worlds", value, expected });
    if count > MOST {
        return refused(format!("{count} worlds"), "at most 1048576 worlds");
    }
    let objects =
        first.map_or(0, |scene| scene.spheres().len() + scene.rods().len() + scene.boxes().len() + scene.polygons().len());
    let bytes = (size_of::<World>() + size_of::<Scene>() + objects * OBJECT_BYTES).saturating_mul(count);
    // A system refuses at once what it can never provide.
    let mut room: Vec<u8> = Vec::new();
    let is_refused = room.try_reserve_exact(bytes).is_err();
    black_box(&room);
    match is_refused {
        true => refused(format!("{count} worlds, which take {bytes} bytes or more"), "worlds that fit in memory together"),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Backend, Options, Sphere, Worlds};

    #[test]
    fn too_many_worlds_are_refused_before_they_take_memory() {
        let mut scene = Scene::new();
        scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
        let options = Options::new().backend(Backend::Cpu);
        let mut worlds = Worlds::new([scene.clone()], options.clone()).unwrap();
        for count in [MOST + 1, 100_000_000, usize::MAX] {
            let scenes = || std::iter::repeat_n(scene.clone(), count);
            let errors = [Worlds::new(scenes(), options.clone()).unwrap_err(), worlds.replace_all(scenes()).unwrap_err()];
            for error in errors {
                assert!(error.to_string().ends_with("worlds is not allowed, expected at most 1048576 worlds"), "{error}");
            }
        }
        assert_eq!(worlds.len(), 1);
    }

    #[test]
    fn worlds_that_do_not_fit_in_memory_are_refused() {
        let mut scene = Scene::new();
        for x in 0..10_000 {
            scene.add_sphere(Sphere::new([x as f32, 0.0, 0.0], 0.1)).unwrap();
        }
        assert!(check(2, Some(&scene)).is_ok());
        // 2.7 TB. A system may promise it nevertheless.
        if let Err(error) = check(MOST, Some(&scene)) {
            assert!(error.to_string().contains("bytes or more is not allowed, expected worlds that fit in memory"), "{error}");
        }
    }
}
