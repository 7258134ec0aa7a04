//! Rays of the camera.

use super::ball::Ray;
use super::sampling::tent;
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
}

/// One of the 2x2 sub-pixels of the pixel at a column and row, row 0 at the top.
pub(super) struct SubPixel<'a> {
    pub(super) view: &'a View,
    pub(super) pixel: [u16; 2],
    pub(super) part: [u8; 2],
}

impl SubPixel<'_> {
    /// A ray through it, by a point of the unit square that the filter spreads.
    pub(super) fn ray(&self, point: [f64; 2]) -> Ray {
        let view = self.view;
        let [column, row] = self.pixel.map(f64::from);
        let [part_x, part_y] = self.part.map(f64::from);
        let [filter_x, filter_y] = point.map(tent);
        let x = (column + (part_x + 0.5 + filter_x) / 2.0) / view.width - 0.5;
        let y = 0.5 - (row + (part_y + 0.5 + filter_y) / 2.0) / view.height;
        let direction = (view.direction + view.across * x + view.upwards * y).normalised();
        Ray {
            origin: view.position + direction * view.near,
            direction,
            departed: None,
        }
    }
}
