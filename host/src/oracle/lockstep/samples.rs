//! The samples of a unit one by one, for walks that are not the tracer's own.

use tracer::unit::Plan;

/// Where a sample's ray goes: its pixel's place in the unit, and the column from the left and row from below of its sub-pixel.
pub(crate) type Place = (usize, [u32; 2]);

/// The places of all samples of unit `id`, in the order of [`tracer::unit::walk`].
pub(crate) fn samples(plan: &Plan, id: u32) -> impl Iterator<Item = Place> + '_ {
    let extent = plan.extent(id);
    (0..extent.pixels).flat_map(move |pixel| {
        let (column, row) = plan.place(extent.first_pixel + u32::from(pixel));
        let (left, below) = (2 * column, 2 * (u32::from(plan.height) - 1 - row));
        (0..4).flat_map(move |subpixel| {
            let place = (pixel.into(), [left + (subpixel & 1), below + (subpixel >> 1)]);
            (0..extent.samples / 4).map(move |_| place)
        })
    })
}
