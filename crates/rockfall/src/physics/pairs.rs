//! Properties of the contacts of two objects, which follow from their materials (docs/physics section 4.10).

use glam::Vec4;

use crate::model::step::{Constants, Step};
use crate::model::view::View;

/// Properties of the contacts of two objects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// Coefficient of restitution e.
    pub(crate) restitution: f32,
    /// Strength of the friction force of the square-root law.
    pub(crate) friction: f32,
    /// Coefficient of Coulomb friction in contacts.
    pub(crate) coulomb_friction: f32,
    /// Coefficient of Coulomb friction in collisions.
    pub(crate) collision_friction: f32,
}

impl Surface {
    /// The constants of the scene.
    fn of_scene(step: &Step) -> Self {
        let Constants { restitution, friction, coulomb_friction, collision_friction, .. } = step.constants;
        Self { restitution, friction, coulomb_friction, collision_friction }
    }

    /// The properties of a pair of objects: those of their materials, and the constants of the scene for the others.
    pub(crate) fn of(view: &View, a: u32, b: u32) -> Self {
        let of_scene = Self::of_scene(view.step);
        let Some(given) = view.pair(a, b) else {
            return of_scene;
        };
        let or = |given: f32, of_scene: f32| if given < 0.0 { of_scene } else { given };
        Self {
            restitution: or(given[0], of_scene.restitution),
            friction: or(given[1], of_scene.friction),
            coulomb_friction: or(given[2], of_scene.coulomb_friction),
            collision_friction: or(given[3], of_scene.collision_friction),
        }
    }
}

/// The friction of four contacts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surfaces {
    pub(crate) friction: Vec4,
    pub(crate) coulomb_friction: Vec4,
}

impl Surfaces {
    /// Repeats one pair four times.
    pub(crate) fn splat(surface: &Surface) -> Self {
        let [friction, coulomb_friction] = [surface.friction, surface.coulomb_friction].map(Vec4::splat);
        Self { friction, coulomb_friction }
    }

    /// The pairs of an object with four others.
    #[inline]
    pub(crate) fn of(view: &View, object: u32, others: [u32; 4]) -> Self {
        if view.step.layout.materials == 0 {
            return Self::splat(&Surface::of_scene(view.step));
        }
        let all = others.map(|other| Surface::of(view, object, other));
        Self {
            friction: Vec4::from_array(all.map(|surface| surface.friction)),
            coulomb_friction: Vec4::from_array(all.map(|surface| surface.coulomb_friction)),
        }
    }
}
