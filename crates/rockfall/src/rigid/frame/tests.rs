//! Problems with answers from nature: closed forms and conservation. Their numbers are those of docs/physics section 11.11.

mod changes;
mod colours;
mod conservation;
mod drives;
mod ells;
mod fast;
mod flight;
mod friction;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod gpu;
mod impact;
mod joints;
mod pile;
mod rest;
mod scene;
mod seams;
mod stack;
