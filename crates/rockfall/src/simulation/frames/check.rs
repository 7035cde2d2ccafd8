//! What the law `rigid` takes of a scene. Everything else is refused by name.

use crate::error::{Error, Result};
use crate::scene::{RodId, Scene};
use crate::simulation::frames::motions::turns_planes;
use crate::simulation::frames::repeat::{leans, turns_across};

fn refused(value: &str) -> Result<()> {
    let expected = "spheres, capsules, placed bodies, rods of fixed length, joints, springs, tethers, inlets, outlets, gauges, and \
                    all walls, still or on motions: the contact law rigid has nothing else yet";
    Err(Error::Invalid { field: "contact_law", value: format!("rigid with {value}"), expected })
}

/// Checks that all rods are capsules, parts of bodies, or keep a distance.
///
/// # Errors
/// [`Error::Invalid`] if there is another rod.
pub(in crate::simulation) fn check_rods(scene: &Scene) -> Result<()> {
    let is_free = |id| scene.rod(id).is_ok_and(|rod| rod.length.is_none()) && !is_fixed_or_part(scene, id);
    if scene.rod_ids().any(is_free) { refused("a rod of free length between moving spheres") } else { Ok(()) }
}

/// Whether a rod is part of a body, or lies between fixed spheres.
pub(super) fn is_fixed_or_part(scene: &Scene, id: RodId) -> bool {
    let is_fixed = |sphere| scene.sphere(sphere).is_ok_and(|sphere| sphere.fixed);
    let is_part = scene.body_of_rod(id).is_some() || scene.implied_of_rod(id).is_some();
    is_part || scene.rod(id).is_ok_and(|rod| is_fixed(rod.end1) && is_fixed(rod.end2))
}

/// Checks that the law `rigid` knows every object of a scene.
///
/// # Errors
/// [`Error::Invalid`], which names the first object that it does not know.
pub(in crate::simulation) fn check(scene: &Scene) -> Result<()> {
    let has = [
        (scene.motions().iter().any(|motion| motion.servo.is_some()), "a servo"),
        (turns_planes(scene), "a plane that turns"),
        (scene.shear().is_some(), "a sheared box"),
        (leans(scene), "a plane that leans towards a periodic axis"),
        (turns_across(scene), "a motion that turns, but not about the periodic axis"),
    ];
    if let Some((_, what)) = has.into_iter().find(|(has, _)| *has) {
        return refused(what);
    }
    Ok(())
}
