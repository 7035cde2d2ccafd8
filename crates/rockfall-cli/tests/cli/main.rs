//! The program `rockfall`, run as a user runs it.

mod bench;
mod bodies;
mod commands;
mod common;
mod events;
mod evolve;
mod flow;
mod full_disk;
mod gauges;
mod import;
mod intent;
mod joints;
mod keep;
mod names;
mod newcomers;
mod odd;
mod outputs;
mod render;
mod running;
mod signals;
mod strangers;
mod tensions;
mod trajectories;
mod view;
mod warnings;
