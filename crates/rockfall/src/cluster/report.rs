//! Counts of the steps of all processes.

use super::{Cluster, Ranks};
use crate::error::Result;
use crate::report::Report;

impl<R: Ranks> Cluster<R> {
    /// Time simulated, in s. This call does not communicate.
    pub fn time(&self) -> f64 {
        self.whole.report.time
    }

    /// Counts and times of all steps so far, on every process, without gathering the spheres. The counters `replays` and `list_builds` are
    /// those of the start.
    ///
    /// # Errors
    /// [`Error::Cluster`](crate::Error::Cluster) when a process has ended.
    pub fn report(&mut self) -> Result<Report> {
        let mut report = self.whole.report;
        if let Some(part) = &self.part {
            let Report { contacts, max_overlap, .. } = part.report();
            let all = self.ranks.gather(&[contacts, max_overlap.to_bits()])?;
            report.contacts = all.iter().map(|words| words[0]).sum();
            report.max_overlap = all.iter().map(|words| f32::from_bits(words[1])).fold(0.0, f32::max);
        }
        Ok(report)
    }
}
