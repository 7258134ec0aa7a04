//! Where light lives: scene, ray, intersection, material, camera, integrator, work unit.
//!
//! The radiance loop is smallpt's (K. Beason, 2008), unrolled from recursion into a walk along one path. It is written
//! once, over a [`profile::Profile`]: number formats, random numbers, intersection formula and hemisphere warp are chosen
//! by a type. The firmware runs it over integers; the host runs the same source over `f64`, driven by the same random
//! numbers, so that what differs between the two is arithmetic and nothing else.
//!
//! A [`mod@unit`] is a pure function of scene, plan and unit id. There is no float, no allocation, no recursion and no
//! `unsafe` here.
#![no_std]
#![forbid(unsafe_code)]

pub mod camera;
pub mod integrator;
pub mod intersect;
pub mod material;
pub mod numbers;
pub mod profile;
pub mod random;
pub mod ray;
pub mod scene;
pub mod sphere;
pub mod unit;
pub mod vector;
