//! Evolution of creatures: bodies of masses and springs whose muscles move them over the ground.
//!
//! - A [`Genome`] encodes body and controller together. [`Genome::scene`] builds the creature on a [`Ground`].
//! - A [`Trial`] runs many creatures side by side in [`Worlds`](rockfall::Worlds) and gives each an [`Outcome`].
//! - An [`Archive`] keeps the best creature of every kind (MAP-Elites, Mouret and Clune 2015), so that a run ends with a gallery of
//!   different gaits.
//! - An [`Evolution`] repeats: choose parents from the archive, vary them, try the offspring, keep the best of each kind. Those that
//!   would become the champion are audited first ([`audit`]).
//!
//! The same seed gives the same champion on the same device, also when a run was stopped and resumed ([`Evolution::save`]).
//! docs/creatures.md describes the encoding, the rules against cheating, and what evolution found.

mod archive;
pub mod audit;
mod evolution;
mod genome;
mod goal;
mod ground;
mod store;
mod surface;
mod trial;
mod variation;
mod watch;

pub use archive::{Archive, Elite, Niche};
pub use evolution::{Champion, Evolution, Generation, Plan};
pub use genome::{Body, Genome, Node};
pub use goal::{Goal, Outcome, Verdict};
pub use ground::Ground;
pub use trial::Trial;
