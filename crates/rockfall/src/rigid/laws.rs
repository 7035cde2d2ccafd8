//! Forces of the program on bodies (docs/physics sections 4.14 and 11.9).

use glam::Vec3A;

use crate::user_laws::ForceInput;
use crate::user_laws::forces::ForceLaws;

/// The forces of the program in a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Laws {
    pub(crate) forces: ForceLaws,
    /// Where the coordinates of the world begin in those of the scene, in units.
    pub(crate) base: Vec3A,
    /// Time at the start of the frame, in s.
    pub(crate) time: f32,
}

impl Laws {
    pub(crate) fn is_empty(&self) -> bool {
        self.forces.is_empty()
    }

    /// Force and torque on a body in a substep of `h` seconds, counted from 0. The position is that in the world, and the time is left out.
    pub(crate) fn load(&self, body: &ForceInput<'_>, substep: u32, h: f32) -> [Vec3A; 2] {
        let position = (self.base + Vec3A::from(body.position)).into();
        let load = self.forces.load(&ForceInput { position, time: self.time + substep as f32 * h, ..*body });
        [load.force.into(), load.torque.into()]
    }
}
