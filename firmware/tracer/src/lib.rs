//! Where light lives: geometry, materials, integrator, camera, work unit.
//!
//! The radiance loop is smallpt's (K. Beason, 2008), unrolled from recursion into a walk along one path. It is written
//! once, over a [`profile::Profile`]: number formats, random numbers, the formula of intersection and the sampling of the
//! hemisphere are chosen by a type. The firmware runs it over integers; the host runs the same source over `f64`, driven by the
//! same random numbers, so that what differs between the two is arithmetic and nothing else.
//!
//! | room | what |
//! | --- | --- |
//! | [`arithmetic`] | number formats, and the operations on directions and samples |
//! | [`capability`] | what an image must be capable of |
//! | [`geometry`] | ray, hit, interaction; the shapes, each with its arithmetic and its record |
//! | [`aggregate`] | finds the nearest of many primitives |
//! | [`material`] | the table of materials; the BSDFs, each with its arithmetic and its parameters |
//! | [`light`] | emitters, and where surfaces look for their light |
//! | [`integrator`] | radiance along a camera ray |
//! | [`camera`] | where that ray starts |
//! | [`scene`] | a view of the bytes that the host's compiler writes, taken apart by [`blob`] |
//! | [`plan`] | the picture's size and samples, and how it falls into units |
//! | [`mod@unit`] | the work unit: a pure function of scene, camera, plan and unit id |
//!
//! A shape, a BSDF, an aggregate or an integrator is a file in its room and a line in that room's list.
//!
//! There is no float, no allocation, no recursion and no `unsafe` here.
#![no_std]
#![forbid(unsafe_code)]

pub mod aggregate;
pub mod arithmetic;
pub mod blob;
pub mod camera;
pub mod capability;
pub mod geometry;
pub mod integrator;
pub mod kronecker;
pub mod light;
pub mod material;
pub mod plan;
pub mod profile;
pub mod random;
pub mod scene;
pub mod unit;
