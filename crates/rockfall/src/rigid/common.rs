//! What frames on the CPU and on a device have in common.

/// Frequency of contacts times the substep; twice as stiff against a side without mass.
pub(crate) const FREQUENCY: f32 = 0.18;
/// Greatest factor of a margin.
pub(crate) const MOST_MARGIN: f32 = 1e30;
/// A frame is repeated at most so often.
pub(crate) const REPEATS: u32 = 16;
/// Most substeps of a frame.
pub(crate) const MAX_SUBSTEPS: u32 = 1_000_000;
/// Number of colours.
pub(crate) const COLOURS: usize = 16;
/// The colour of blocks without one.
pub(crate) const LEFT_OVER: u8 = COLOURS as u8;

/// What a frame did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FrameReport {
    /// Times that the frame was repeated because a path left its margin.
    pub(crate) repeats: u32,
    /// Contact points that touch or whose impulse is not 0 at the end.
    pub(crate) contacts: u32,
    /// Greatest overlap of a point, in units.
    pub(crate) max_overlap: f32,
    /// Bodies whose state stopped being finite: their number, and the first one.
    pub(crate) stopped: Option<(u32, u32)>,
    /// Joints that broke.
    pub(crate) broken: u32,
}
