//! The model of docs/physics on both backends, against results derived by hand.

#[path = "../common/mod.rs"]
#[macro_use]
mod common;

mod bodies;
mod body_springs;
mod boxes;
mod closed_form;
mod contact_laws;
mod continuous;
mod errata;
mod events;
mod faults;
mod force_laws;
mod gauges;
mod hard;
mod hard_far;
mod hard_flow;
mod hard_forces;
mod hard_grips;
mod hard_joints;
mod hard_laws;
mod hard_mechanisms;
mod hard_motions;
mod hard_periodic;
mod hard_samples;
mod hard_springs;
mod hard_walls;
mod hulls;
mod laws;
mod meshes;
mod passages;
mod periodic;
mod ray;
mod rod_walls;
mod servos;
mod shear;
mod short_steps;
mod smooth;
mod verlet;
mod walls;
