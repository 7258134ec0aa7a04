//! Where light lives: scene, ray, intersection, material, camera, integrator, work unit.
#![no_std]
#![forbid(unsafe_code)]

pub mod profile;
pub mod scene;
pub mod unit;
