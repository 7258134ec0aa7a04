//! What was counted, to read.

use super::classes::CLASSES;
use super::neighbours::KINDS;
use super::tally::{BINS, CLEAR, Count};
use super::{Column, ROUNDING};
use crate::stability::Table;
use crate::stability::table::share;

const SELF_HITS: &str = "By profile and epsilon, shares of the rays that leave this way. \
    Wrong: the ray meets the surface it leaves where that is not, or at its very start. \
    Lost: it leads through the solid, or away from a wall that it must come back to, and does not meet the other end of its chord.";
const NEIGHBOURS: &str = "Another surface stands at least an ulp in front of where the ray leaves, and the ray leads more than an ulp deep into it: \
    the share of rays that pass through it, by how far along the ray it is, up to so many ulp.";
const WAYS: [[&str; 2]; 2] = [["reflected without", "inwards"], ["outwards", "reflected within"]];

/// The surfaces that rays leave.
pub(super) fn self_hits(columns: &[Column]) -> Table {
    let mut head = vec!["surface".to_owned()];
    for column in columns {
        head.extend([format!("{}: wrong", column.name), "lost".to_owned()]);
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut table = Table::new("The surface that a ray leaves", SELF_HITS, &head);
    for (place, class) in CLASSES.iter().enumerate() {
        for (from, to) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let hits = columns.iter().map(|column| &column.tallies[place].ways[from][to]);
            if hits.clone().any(|hits| hits.wrong.all > 0) {
                let name = format!("{}, {}", class.name, WAYS[from][to]);
                let shares = hits.flat_map(|hits| [hits.wrong, hits.lost]).map(Count::share);
                table.push(std::iter::once(name).chain(shares).collect());
            }
        }
    }
    table
}

/// What stands next to them: kind by kind for the first epsilon, all together for the others.
pub(super) fn neighbours_passed(columns: &[Column]) -> Table {
    let mut head = vec!["neighbour"];
    head.extend(BINS.map(|(_, name)| name));
    let mut table = Table::new("Neighbours", NEIGHBOURS, &head);
    let mut push = |name: String, column: &Column, kinds: &[usize]| {
        let shares = (0..BINS.len()).map(|bin| passed(column, kinds, bin).share());
        table.push(std::iter::once(name).chain(shares).collect());
    };
    for (kind, name) in KINDS.iter().enumerate() {
        push(format!("{}: {name}", columns[0].name), &columns[0], &[kind]);
    }
    let all: Vec<usize> = (0..KINDS.len()).collect();
    for column in &columns[1..] {
        push(format!("{}: all", column.name), column, &all);
    }
    table
}

fn passed(column: &Column, kinds: &[usize], bin: usize) -> Count {
    let mut sum = Count::default();
    for tally in &column.tallies {
        for &kind in kinds {
            sum.merge(tally.neighbours[kind][bin]);
        }
    }
    sum
}

/// What must not happen and does.
pub(super) fn faults(column: &Column) -> Vec<String> {
    let mut faults = Vec::new();
    for (tally, class) in column.tallies.iter().zip(CLASSES) {
        let name = format!("{}, {}", column.name, class.name);
        for hits in tally.ways.as_flattened() {
            if hits.wrong.failed > 0 {
                faults.push(format!(
                    "{name}: {} of {} rays meet what they leave, up to {} ulp away",
                    hits.wrong.failed, hits.wrong.all, hits.furthest
                ));
            }
            // The other end of a shorter chord is where it starts.
            if hits.longest > ROUNDING {
                faults.push(format!(
                    "{name}: {} of {} rays lose a chord, of up to {} ulp",
                    hits.lost.failed, hits.lost.all, hits.longest
                ));
            }
        }
        for (neighbours, kind) in tally.neighbours.iter().zip(KINDS) {
            for (count, (_, distance)) in neighbours.iter().zip(BINS).skip(CLEAR) {
                if count.failed > 0 {
                    faults.push(format!(
                        "{name}: {} of {} rays pass through a neighbour ({kind}) of distance up to {distance}",
                        count.failed, count.all
                    ));
                }
            }
        }
    }
    faults
}

impl Count {
    fn share(self) -> String {
        share(self.failed, self.all)
    }
}
