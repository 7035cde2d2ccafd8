//! A frame of the law `rigid`.

use crate::rigid::world::RigidWorld;

/// What the solver keeps from frame to frame: contacts with their impulses, and colours of blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct History {}

/// What a frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FrameReport {
    /// Times that the frame was repeated because a path left its margin.
    pub(crate) repeats: u32,
    /// Contact points that touch or whose impulse is not 0 at the end.
    pub(crate) contacts: u32,
    /// Greatest overlap of a point, in units.
    pub(crate) max_overlap: f32,
}

/// Advances all bodies by a frame of `dt` seconds in `substeps` substeps.
pub(crate) fn advance(world: &mut RigidWorld, dt: f32, substeps: u32) -> FrameReport {
    let _ = (world, dt, substeps);
    FrameReport::default()
}
