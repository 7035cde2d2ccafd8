//! Trajectories and fields.

mod come_and_go;
mod fields;
mod reader;
mod writer;
