//! Tests of both backends against results derived by hand.
//!
//! The derivation stands beside each test. Expected values never come from earlier output of the engine. Symbols are
//! those of `docs/physics`: o is an overlap, u an approach velocity, n a normal, w an inverse mass, j an impulse, e
//! the coefficient of restitution.

mod capsules;
mod collisions;
mod constraints;
mod contacts;
mod damping;
mod editing;
mod friction;
mod materials;
mod muscles;
mod observing;
mod rods;
mod rules;
mod springs;
mod statics;
