//! What the law `rigid` takes of a scene. Everything else is refused by name.

use crate::error::{Error, Result};
use crate::options::Options;
use crate::scene::Scene;
use crate::simulation::frames::motions::turns_planes;

fn refused(value: &str) -> Result<()> {
    let expected = "spheres, capsules, placed bodies, joints, springs, tethers, inlets, outlets, gauges, and as walls boxes, parallelograms, \
                    triangles, meshes and planes, still or on motions: the contact law rigid has nothing else yet";
    Err(Error::Invalid { field: "contact_law", value: format!("rigid with {value}"), expected })
}

/// Checks that all rods belong to bodies that move as a whole.
///
/// # Errors
/// [`Error::Invalid`] if there is another rod.
pub(in crate::simulation) fn check_rods(scene: &Scene) -> Result<()> {
    let is_loose = |id| scene.body_of_rod(id).is_none() && scene.implied_of_rod(id).is_none();
    if scene.rod_ids().any(is_loose) { refused("a rod that is not a capsule or part of a body") } else { Ok(()) }
}

/// Checks that the law `rigid` knows every object of a scene and every option.
///
/// # Errors
/// [`Error::Invalid`], which names the first object that it does not know.
pub(in crate::simulation) fn check(scene: &Scene, options: &Options) -> Result<()> {
    let has = [
        (scene.motions().iter().any(|motion| motion.servo.is_some()), "a servo"),
        (turns_planes(scene), "a plane that turns"),
        (scene.is_periodic(), "periodic boundaries"),
        (scene.polygons().iter().any(|polygon| polygon.surface.is_round()), "a cone, a cylinder or a ball as a wall"),
        (!options.force_laws.is_empty(), "a force of the program"),
    ];
    if let Some((_, what)) = has.into_iter().find(|(has, _)| *has) {
        return refused(what);
    }
    Ok(())
}
