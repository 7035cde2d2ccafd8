//! Trajectories and fields.

mod fields;
mod reader;
mod writer;
