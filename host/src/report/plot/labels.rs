//! Names beside marks, where they cover nothing.

/// The height of a line of text, and how wide a letter is in the mean.
pub(super) const LINE: f64 = 13.0;
const LETTER: f64 = 6.2;

/// How wide a text is, about.
pub(super) fn width(text: &str) -> f64 {
    LETTER * text.chars().count() as f64
}

/// Left, top, right, bottom.
pub(super) type Box = [f64; 4];

/// Where a text starts, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Its left end, on its base line.
    pub(super) at: [f64; 2],
    /// Whether it is so far from its mark that a line has to join them.
    pub(super) is_far: bool,
}

/// Ways from a mark to its name: to the right or to the left of it by the first, and down by the second. The nearest come first.
const WAYS: [[f64; 2]; 34] = [
    [8.0, 0.0],
    [-8.0, 0.0],
    [0.0, -14.0],
    [0.0, 14.0],
    [8.0, -9.0],
    [8.0, 9.0],
    [-8.0, -9.0],
    [-8.0, 9.0],
    [10.0, -16.0],
    [10.0, 16.0],
    [-10.0, -16.0],
    [-10.0, 16.0],
    [16.0, -24.0],
    [16.0, 24.0],
    [-16.0, -24.0],
    [-16.0, 24.0],
    [24.0, -34.0],
    [24.0, 34.0],
    [-24.0, -34.0],
    [-24.0, 34.0],
    [34.0, 0.0],
    [-34.0, 0.0],
    [34.0, -46.0],
    [34.0, 46.0],
    [-34.0, -46.0],
    [-34.0, 46.0],
    [44.0, -60.0],
    [44.0, 60.0],
    [-44.0, -60.0],
    [-44.0, 60.0],
    [54.0, -76.0],
    [54.0, 76.0],
    [-54.0, -76.0],
    [-54.0, 76.0],
];
/// From this far on a line joins mark and name.
const FAR: f64 = 20.0;
/// What a mark covers around its middle.
const MARK: f64 = 5.0;

/// A place for each name that finds one within `bounds`, in the order of the marks; names are left out where there is none.
pub(super) fn places(marks: &[[f64; 2]], names: &[Option<&str>], bounds: Box) -> Vec<Option<Place>> {
    let mut taken: Vec<Box> = marks
        .iter()
        .map(|&[x, y]| [x - MARK, y - MARK, x + MARK, y + MARK])
        .collect();
    let mut places = Vec::new();
    for (&mark, name) in marks.iter().zip(names) {
        let found = name.and_then(|name| {
            WAYS.iter()
                .map(|&way| (way, room(mark, way, width(name))))
                .find(|(_, room)| fits(room, &taken, bounds))
        });
        places.push(found.map(|([across, down], room)| {
            taken.push(room);
            Place {
                at: [room[0], room[3] - 3.0],
                is_far: across.hypot(down) >= FAR,
            }
        }));
    }
    places
}

/// What a text of this width covers that way from a mark.
fn room([x, y]: [f64; 2], [across, down]: [f64; 2], width: f64) -> Box {
    let left = match across {
        0.0 => x - width / 2.0,
        _ if across > 0.0 => x + across,
        _ => x + across - width,
    };
    let top = y + down - LINE / 2.0;
    [left, top, left + width, top + LINE]
}

fn fits(room: &Box, taken: &[Box], bounds: Box) -> bool {
    let is_within =
        room[0] >= bounds[0] && room[1] >= bounds[1] && room[2] <= bounds[2] && room[3] <= bounds[3];
    is_within && !taken.iter().any(|other| covers(room, other))
}

fn covers(one: &Box, other: &Box) -> bool {
    one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cover_neither_marks_nor_each_other() {
        let marks = [[100.0, 100.0], [104.0, 103.0], [108.0, 98.0], [101.0, 106.0]];
        let names = [Some("first"), Some("second"), Some("third"), None];
        let places = places(&marks, &names, [0.0, 0.0, 300.0, 200.0]);
        assert_eq!(places[3], None);
        let rooms: Vec<Box> = places
            .iter()
            .zip(names)
            .filter_map(|(place, name)| {
                let [left, base] = (*place)?.at;
                Some([left, base + 3.0 - LINE, left + width(name?), base + 3.0])
            })
            .collect();
        assert_eq!(rooms.len(), 3);
        for (index, room) in rooms.iter().enumerate() {
            assert!(
                rooms[..index].iter().all(|other| !covers(room, other)),
                "{rooms:?}"
            );
            assert!(
                !marks.iter().any(|&[x, y]| covers(room, &[x, y, x, y])),
                "{rooms:?}"
            );
        }
    }

    #[test]
    fn a_name_without_room_is_left_out() {
        assert_eq!(
            places(&[[5.0, 5.0]], &[Some("long name")], [0.0, 0.0, 20.0, 20.0]),
            [None]
        );
    }
}
