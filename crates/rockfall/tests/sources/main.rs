//! The sources: kernels as text, and citations of the specification.

mod citations;
mod kernels;
mod portable;
mod wgsl;
mod writers;
