//! Rays of the camera.

use super::ball::Ray;
use super::sampling::{Draws, tent};
use super::vector::Vector;
use crate::scene::Camera;

/// The camera for one picture size.
pub(super) struct View {
    position: Vector,
    direction: Vector,
    /// Across the image plane, left to right and bottom to top.
    across: Vector,
    upwards: Vector,
    near: f64,
    width: f64,
    height: f64,
}

impl View {
    pub(super) fn new(camera: &Camera, width: u16, height: u16) -> Self {
        let plane_height = camera.height_for(width, height);
        let (width, height) = (f64::from(width), f64::from(height));
        let direction = Vector::of(camera.direction);
        let across = direction.cross(Vector::of(camera.up)).normalised() * (plane_height * width / height);
        let upwards = across.cross(direction).normalised() * plane_height;
        Self {
            position: Vector::of(camera.position),
            direction,
            across,
            upwards,
            near: camera.near,
            width,
            height,
        }
    }

    /// A ray through one of the 2x2 sub-pixels of the pixel at `column` and `row`, row 0 at the top.
    pub(super) fn ray(&self, [column, row]: [u16; 2], sub_pixel: [u8; 2], draws: &mut Draws<'_>) -> Ray {
        let [sub_x, sub_y] = sub_pixel.map(f64::from);
        let [filter_x, filter_y] = draws.of_pixel().map(tent);
        let x = (f64::from(column) + (sub_x + 0.5 + filter_x) / 2.0) / self.width - 0.5;
        let y = 0.5 - (f64::from(row) + (sub_y + 0.5 + filter_y) / 2.0) / self.height;
        let direction = (self.direction + self.across * x + self.upwards * y).normalised();
        Ray {
            origin: self.position + direction * self.near,
            direction,
            departed: None,
        }
    }
}
