//! Hard contacts: bodies, shapes, colliders, pairs and contacts, and the solver of the contact law `rigid` (docs/physics section 11).
//!
//! | room | what it knows |
//! |---|---|
//! | [`pose`] | where a frame lies, and one pose relative to another |
//! | [`shape`] | cores with a radius: AABB, extent, mass |
//! | [`collide`] | the contact points of two shapes in a relative pose |
//! | [`common`] | constants and the report of a frame, for the CPU and a device |
//! | [`broad`] | pairs of AABBs that overlap |
//! | [`groups`] | which colliders touch each other |
//! | [`history`] | what is kept from frame to frame |
//! | [`world`] | bodies, colliders and materials of a scene |
//! | [`springs`], [`spring_bound`] | springs, tethers and muscles, and the substep that they bound |
//! | [`joints`] | joints, their drives and colours |
//! | [`grip`] | the force on a point that is pulled |
//! | [`laws`] | forces of the program |
//! | [`periods`] | periodic boundaries |
//! | [`frame`] | a frame: margins, pairs, blocks, colours, substeps |
//! | `gpu` | all of it on a device |

// What tests alone use: energies, states that come back from the device after single stages, and masses of shapes other than hulls.
#![allow(dead_code)]

pub(crate) mod broad;
pub(crate) mod collide;
pub(crate) mod common;
pub(crate) mod frame;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
pub(crate) mod gpu;
pub(crate) mod grip;
pub(crate) mod groups;
pub(crate) mod history;
pub(crate) mod joints;
pub(crate) mod laws;
pub(crate) mod periods;
pub(crate) mod pose;
pub(crate) mod shape;
pub(crate) mod spring_bound;
pub(crate) mod springs;
pub(crate) mod world;
