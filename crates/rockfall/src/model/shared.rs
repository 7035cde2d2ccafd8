//! Which spheres a process shares with others (docs/cluster.md).

/// Words of a row that is sent to another process: the motion of a sphere.
pub(crate) const SENT_WORDS: usize = 12;

/// What a process shares with others. Spheres are given by their indices in its simulation.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    /// The own spheres, in ascending order.
    pub(crate) own: Vec<u32>,
    /// Where the own spheres were when spheres were divided, in units along `axis`.
    pub(crate) starts: Vec<f32>,
    /// For every process, the own spheres of which it has copies.
    pub(crate) sent: Vec<Vec<u32>>,
    /// For every process, the copies of its spheres.
    pub(crate) received: Vec<Vec<u32>>,
    /// The axis along which spheres are divided.
    pub(crate) axis: usize,
    /// How far a sphere may move along it, in units.
    pub(crate) room: f64,
}
