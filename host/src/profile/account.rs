//! From prices of instructions to an account: by function, class, line.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::Hash;

use cycles::Priced;
use cycles::flow::Flow;

use super::calls::Node;
use super::code::{Code, Name};
use super::cost::Cost;
use super::run::{Function, Named};
use crate::render::report::BlindSpot;

/// What the instruction at each address costs.
pub(super) fn by_address(prices: &[Priced]) -> BTreeMap<u32, Cost> {
    let mut costs: BTreeMap<u32, Cost> = BTreeMap::new();
    for priced in prices.iter().filter(|priced| priced.executions > 0) {
        *costs.entry(priced.address).or_default() += priced.into();
    }
    costs
}

/// All of it.
pub(super) fn total<'a>(costs: impl Iterator<Item = &'a Cost>) -> Cost {
    costs.fold(Cost::default(), |mut sum, &cost| {
        sum += cost;
        sum
    })
}

/// What the price does not see, as shares of all cycles.
pub(super) fn blind_spots(flow: &Flow, total: Cost) -> Vec<BlindSpot> {
    let share = |cycles: u64| cycles as f64 / total.cycles as f64;
    let spots = cycles::blind_spots(flow).into_iter();
    spots
        .map(|spot| BlindSpot {
            what: spot.what.to_owned(),
            less: share(spot.less),
            more: share(spot.more),
        })
        .collect()
}

/// By class of instruction.
pub(super) fn classes(prices: &[Priced]) -> Vec<Named> {
    named(prices.iter().map(|priced| (priced.class.name(), priced.into())))
}

/// By line of the source.
pub(super) fn lines(costs: &BTreeMap<u32, Cost>, code: &Code) -> Vec<Named> {
    named(costs.iter().map(|(&address, &cost)| (code.line(address), cost)))
}

fn named<'a>(costs: impl Iterator<Item = (&'a str, Cost)>) -> Vec<Named> {
    let named = sums(costs).into_iter().map(|(name, cost)| Named {
        name: name.to_owned(),
        cost,
    });
    let mut named: Vec<Named> = named.filter(|named| named.cost != Cost::default()).collect();
    named.sort_by(|a, b| (b.cost.cycles, &a.name).cmp(&(a.cost.cycles, &b.name)));
    named
}

fn sums<K: Eq + Hash>(costs: impl Iterator<Item = (K, Cost)>) -> HashMap<K, Cost> {
    let mut sums: HashMap<K, Cost> = HashMap::new();
    for (key, cost) in costs {
        *sums.entry(key).or_default() += cost;
    }
    sums
}

/// By function: by itself, and by the stacks that it is in.
pub(super) fn functions(costs: &BTreeMap<u32, Cost>, stacks: &[Node], code: &Code) -> Vec<Function> {
    let innermost = |address| *code.functions(address).last().unwrap_or(&code.outermost(address));
    let own = sums(costs.iter().map(|(&address, &cost)| (innermost(address), cost)));
    let mut inclusive = BTreeMap::new();
    for node in stacks {
        include(node, &mut BTreeSet::new(), &mut inclusive);
    }
    let function = |(name, (cycles, instructions)): (Name, (f64, f64))| Function {
        name: code.word(name).to_owned(),
        own: own.get(&name).copied().unwrap_or_default(),
        // Shares of calls are fractions.
        inclusive_cycles: cycles.round() as u64,
        inclusive_instructions: instructions.round() as u64,
    };
    let mut functions: Vec<Function> = inclusive.into_iter().map(function).collect();
    functions.sort_by(|a, b| (b.own.cycles, &a.name).cmp(&(a.own.cycles, &b.name)));
    functions
}

/// Adds what stands below a function to it, once, however often it stands in one stack.
fn include(node: &Node, above: &mut BTreeSet<Name>, inclusive: &mut BTreeMap<Name, (f64, f64)>) {
    let first = above.insert(node.name);
    if first {
        let sum = inclusive.entry(node.name).or_default();
        *sum = (sum.0 + node.cycles, sum.1 + node.instructions);
    }
    for below in &node.below {
        include(below, above, inclusive);
    }
    if first {
        above.remove(&node.name);
    }
}

#[cfg(test)]
mod tests {
    use cycles::class::Class;

    use super::super::code::tests::code;
    use super::*;

    fn priced(address: u32, cycles: u64, class: Class) -> Priced {
        Priced {
            address,
            executions: cycles.min(1),
            cycles,
            load_stalls: 0,
            multiply_stalls: 0,
            class,
        }
    }

    #[test]
    fn each_account_holds_every_cycle_once() {
        let code = code(&[(0, "f"), (4, "f > g"), (8, "f > g > f"), (12, "f > h")]);
        let prices = [
            priced(0, 1, Class::Alu),
            priced(4, 10, Class::Load),
            priced(8, 100, Class::Alu),
            priced(12, 1000, Class::Branch),
            // Recorded in a block of which it never ran.
            priced(16, 0, Class::Divide),
        ];
        let costs = by_address(&prices);
        assert_eq!(total(costs.values()).cycles, 1111);
        let words = |named: Vec<Named>| -> Vec<(String, u64)> {
            named
                .into_iter()
                .map(|named| (named.name, named.cost.cycles))
                .collect()
        };
        let classes = words(classes(&prices));
        assert_eq!(
            classes,
            [("branch", 1000), ("alu", 101), ("load", 10)].map(|(name, cycles)| (name.to_owned(), cycles))
        );
        let lines = words(lines(&costs, &code));
        assert_eq!(lines[0], ("h.rs:12".to_owned(), 1000));
        assert_eq!(lines.iter().map(|(_, cycles)| cycles).sum::<u64>(), 1111);

        let stacks = {
            let leaf = |address: u32, below| Node {
                name: *code.functions(address).last().expect("a function"),
                cycles: 0.0,
                instructions: 0.0,
                below,
            };
            let mut inner = leaf(8, vec![]);
            inner.cycles = 100.0;
            let mut g = leaf(4, vec![inner]);
            g.cycles = 110.0;
            let mut h = leaf(12, vec![]);
            h.cycles = 1000.0;
            let mut f = leaf(0, vec![g, h]);
            f.cycles = 1111.0;
            [f]
        };
        let functions = functions(&costs, &stacks, &code);
        let found: Vec<(&str, u64, u64)> = functions
            .iter()
            .map(|function| {
                (
                    function.name.as_str(),
                    function.own.cycles,
                    function.inclusive_cycles,
                )
            })
            .collect();
        // `f` stands twice in a stack, and is counted once.
        assert_eq!(found, [("h", 1000, 1000), ("f", 101, 1111), ("g", 10, 110)]);
    }
}
