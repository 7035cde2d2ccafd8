//! Tests of both backends against results derived by hand.
//!
//! The derivation stands beside each test. Expected values never come from earlier output of the engine. Symbols are
//! those of `docs/physics.md`: o is an overlap, u an approach velocity, n a normal, w an inverse mass, j an impulse, e
//! the coefficient of restitution.

#[macro_use]
mod common;

#[path = "closed_form/capsules.rs"]
mod capsules;
#[path = "closed_form/collisions.rs"]
mod collisions;
#[path = "closed_form/constraints.rs"]
mod constraints;
#[path = "closed_form/contacts.rs"]
mod contacts;
#[path = "closed_form/damping.rs"]
mod damping;
#[path = "closed_form/editing.rs"]
mod editing;
#[path = "closed_form/friction.rs"]
mod friction;
#[path = "closed_form/materials.rs"]
mod materials;
#[path = "closed_form/muscles.rs"]
mod muscles;
#[path = "closed_form/observing.rs"]
mod observing;
#[path = "closed_form/rods.rs"]
mod rods;
#[path = "closed_form/rules.rs"]
mod rules;
#[path = "closed_form/springs.rs"]
mod springs;
#[path = "closed_form/statics.rs"]
mod statics;
