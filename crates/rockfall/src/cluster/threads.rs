//! Processes as threads of one program, for tests.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::cluster::ranks::Ranks;
use crate::error::{Error, Result};

/// One of several threads that exchange words through channels.
pub(crate) struct Threads {
    rank: usize,
    to: Vec<Sender<Vec<u32>>>,
    from: Vec<Receiver<Vec<u32>>>,
}

impl Threads {
    /// The ends of `size` threads.
    pub(crate) fn of(size: usize) -> Vec<Self> {
        let mut all: Vec<Self> = (0..size).map(|rank| Self { rank, to: Vec::new(), from: Vec::new() }).collect();
        for sender in 0..size {
            for receiver in 0..size {
                let (to, from) = channel();
                all[sender].to.push(to);
                // Every receiver gets the ends of the senders in their order.
                all[receiver].from.push(from);
            }
        }
        all
    }

    fn send(&self, rank: usize, words: Vec<u32>) -> Result<()> {
        self.to[rank].send(words).map_err(|_| ended(rank))
    }

    fn receive(&self, rank: usize) -> Result<Vec<u32>> {
        self.from[rank].recv().map_err(|_| ended(rank))
    }
}

fn ended(rank: usize) -> Error {
    Error::Cluster(format!("process {rank} has ended"))
}

impl Ranks for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn exchange(&mut self, to: &[Vec<u32>], from: &mut [Vec<u32>]) -> Result<()> {
        for (rank, words) in to.iter().enumerate().filter(|(_, words)| !words.is_empty()) {
            self.send(rank, words.clone())?;
        }
        for (rank, words) in from.iter_mut().enumerate().filter(|(_, words)| !words.is_empty()) {
            let received = self.receive(rank)?;
            assert_eq!(received.len(), words.len(), "process {rank} sent another number of words");
            *words = received;
        }
        Ok(())
    }

    fn max(&mut self, values: &mut [u64]) -> Result<()> {
        let halves: Vec<u32> = values.iter().flat_map(|value| [*value as u32, (*value >> 32) as u32]).collect();
        for words in self.gather(&halves)? {
            for (value, half) in values.iter_mut().zip(words.chunks_exact(2)) {
                *value = (*value).max(u64::from(half[0]) | u64::from(half[1]) << 32);
            }
        }
        Ok(())
    }

    fn gather(&mut self, mine: &[u32]) -> Result<Vec<Vec<u32>>> {
        (0..self.size()).try_for_each(|rank| self.send(rank, mine.to_vec()))?;
        (0..self.size()).map(|rank| self.receive(rank)).collect()
    }
}
