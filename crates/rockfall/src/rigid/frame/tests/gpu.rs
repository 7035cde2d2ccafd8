//! The device against the CPU, stage by stage and frame by frame.

mod broken;
mod device;
mod device_joints;
mod device_round;
mod device_world;
mod joints_agree;
mod search;
