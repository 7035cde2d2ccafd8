//! Problems with answers from nature: closed forms and conservation. Their numbers are those of docs/physics.md section 11.11.

#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod broken;
mod changes;
mod colours;
mod conservation;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod device;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod device_joints;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod device_round;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod device_world;
mod ells;
mod fast;
mod flight;
mod friction;
mod impact;
mod joints;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod joints_agree;
mod pile;
mod rest;
mod scene;
#[cfg(all(feature = "gpu", not(target_family = "wasm")))]
mod search;
mod stack;
