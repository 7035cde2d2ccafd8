//! The transport between the processes of a cluster.

use crate::error::Result;

/// The processes that share a scene, as one of them sees them. All calls are collective: every process makes the same calls in the same
/// order.
pub trait Ranks {
    /// The number of this process, from 0.
    fn rank(&self) -> usize;

    /// The number of processes.
    fn size(&self) -> usize;

    /// Sends `to[r]` to process r, and receives from it as many words as `from[r]` has. Both are empty for this process, and for
    /// processes that exchange nothing.
    ///
    /// # Errors
    /// [`Error::Cluster`](crate::Error::Cluster) when a process has ended.
    fn exchange(&mut self, to: &[Vec<u32>], from: &mut [Vec<u32>]) -> Result<()>;

    /// Replaces every value by the largest of all processes.
    ///
    /// # Errors
    /// As for [`Ranks::exchange`].
    fn max(&mut self, values: &mut [u64]) -> Result<()>;

    /// Returns the words of all processes, by their numbers.
    ///
    /// # Errors
    /// As for [`Ranks::exchange`].
    fn gather(&mut self, mine: &[u32]) -> Result<Vec<Vec<u32>>>;
}
