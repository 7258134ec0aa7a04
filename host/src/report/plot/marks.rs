//! Marks: a shape for each series, so that none is known by its colour alone.

use std::fmt::Write as _;

/// Colours and shapes there are; later series have the first ones again.
pub(super) const LOOKS: usize = 7;

/// The outline of a series' mark, of about this radius.
pub(super) fn outline(look: usize, [x, y]: [f64; 2], radius: f64) -> String {
    let corners = |corners: &[[f64; 2]]| {
        let mut path = String::new();
        for (place, [across, down]) in corners.iter().enumerate() {
            let verb = if place == 0 { 'M' } else { 'L' };
            // Writing to a string does not fail.
            let _ = write!(path, "{verb}{:.1} {:.1}", x + across * radius, y + down * radius);
        }
        path + "Z"
    };
    match look % LOOKS {
        0 => {
            let (left, width) = (x - radius, 2.0 * radius);
            let half = format!("a{radius} {radius} 0 1 0");
            format!("M{left:.1} {y:.1}{half} {width} 0{half} -{width} 0Z")
        }
        1 => corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        2 => corners(&[[0.0, -1.2], [1.1, 0.8], [-1.1, 0.8]]),
        3 => corners(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]),
        4 => corners(&[[0.0, 1.2], [1.1, -0.8], [-1.1, -0.8]]),
        5 => corners(&[
            [-0.4, -1.2],
            [0.4, -1.2],
            [0.4, -0.4],
            [1.2, -0.4],
            [1.2, 0.4],
            [0.4, 0.4],
            [0.4, 1.2],
            [-0.4, 1.2],
            [-0.4, 0.4],
            [-1.2, 0.4],
            [-1.2, -0.4],
            [-0.4, -0.4],
        ]),
        _ => corners(&[[-1.2, -0.5], [0.0, -1.3], [1.2, -0.5], [0.8, 1.0], [-0.8, 1.0]]),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_look_has_a_shape_of_its_own() {
        let shapes: BTreeSet<String> = (0..LOOKS).map(|look| outline(look, [10.0, 10.0], 4.0)).collect();
        assert_eq!(shapes.len(), LOOKS);
        assert_eq!(outline(0, [1.0, 1.0], 4.0), outline(LOOKS, [1.0, 1.0], 4.0));
    }
}
