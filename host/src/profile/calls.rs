//! Who calls whom: the stacks that inlining shows, joined by the calls between functions of the image.
//!
//! What an instruction is inlined into is known for each. Of calls the flow knows how often each was made, but not what each of
//! them cost: where a function has several callers, its cost is shared among them in proportion to their calls. A call that closes a
//! circle, as of a function by itself, counts for nobody.

use std::collections::{BTreeMap, BTreeSet};

use cycles::flow::Flow;

use super::code::{Code, Name};
use super::cost::Cost;

/// Calls of each function: how many were made by each instruction, or by nobody where recording began.
type Calls = BTreeMap<Name, BTreeMap<Option<u32>, u64>>;

/// A function in a stack, with what is inlined into it or called from there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    /// The function.
    pub(super) name: Name,
    /// Cycles of it and of all below.
    pub(super) cycles: f64,
    /// Instructions, likewise.
    pub(super) instructions: f64,
    /// What it called or what was inlined.
    pub(super) below: Vec<Node>,
}

/// The stacks of a flow, one tree for each function that recording began with.
pub(super) fn stacks(flow: &Flow, costs: &BTreeMap<u32, Cost>, code: &Code) -> Vec<Node> {
    let calls = calls(flow, code);
    let mut functions: BTreeMap<Name, Vec<u32>> = BTreeMap::new();
    for &address in costs.keys() {
        functions
            .entry(code.outermost(address))
            .or_default()
            .push(address);
    }
    let began = calls.iter().filter(|(_, callers)| callers.contains_key(&None));
    let mut forward = Forward::default();
    for (&function, _) in began.clone() {
        forward.visit(function, &calls, code);
    }
    let mut builder = Builder {
        costs,
        code,
        functions,
        callees: BTreeMap::new(),
        reached: BTreeSet::new(),
        roots: Vec::new(),
    };
    let mut shares = Vec::new();
    for (&function, callers) in &calls {
        let counted = callers
            .iter()
            .filter(|(site, _)| site.is_none_or(|site| forward.is_forward(code.outermost(site), function)));
        let all: u64 = counted.clone().map(|(_, count)| count).sum();
        for (&site, &count) in counted {
            let share = count as f64 / all as f64;
            match site {
                Some(site) => builder.callees.entry(site).or_default().push((function, share)),
                None => shares.push((function, share)),
            }
        }
    }
    for (function, share) in shares {
        builder.enter(function, &mut Vec::new(), share);
    }
    // What no call explains stands by itself: the sum of all stacks is that of all instructions.
    let unexplained: Vec<Name> = builder.functions.keys().copied().collect();
    for function in unexplained {
        if !builder.reached.contains(&function) {
            builder.enter(function, &mut Vec::new(), 1.0);
        }
    }
    builder.roots
}

/// The calls of a flow: what goes from one function of the image into another and is no return.
fn calls(flow: &Flow, code: &Code) -> Calls {
    let ends = |block: usize| {
        let block = &flow.blocks[block].instructions;
        Some((block.first()?.address, *block.last()?))
    };
    let crossings = || {
        flow.edges.iter().filter_map(|edge| {
            let (to, _) = ends(edge.to)?;
            let from = match edge.from {
                Some(from) => Some(ends(from)?.1),
                None => None,
            };
            let crosses = from.is_none_or(|from| code.outermost(from.address) != code.outermost(to));
            crosses.then_some((from, to, edge.count))
        })
    };
    // A callee comes back behind the instruction that called.
    let returns: BTreeSet<u32> = crossings()
        .filter_map(|(from, ..)| from)
        .map(|from| (from, from.end()))
        .filter(|(from, end)| code.knows(*end) && code.outermost(from.address) == code.outermost(*end))
        .map(|(_, end)| end)
        .collect();
    let mut calls = Calls::new();
    for (from, to, count) in crossings().filter(|(from, to, _)| from.is_none() || !returns.contains(to)) {
        let callers = calls.entry(code.outermost(to)).or_default();
        *callers.entry(from.map(|from| from.address)).or_default() += count;
    }
    calls
}

/// The calls that close no circle.
#[derive(Default)]
struct Forward {
    calls: BTreeSet<(Name, Name)>,
    above: Vec<Name>,
    done: BTreeSet<Name>,
}

impl Forward {
    fn visit(&mut self, function: Name, calls: &Calls, code: &Code) {
        if !self.done.insert(function) {
            return;
        }
        self.above.push(function);
        let calls_of = |(callee, callers): (&Name, &BTreeMap<Option<u32>, u64>)| {
            let mut sites = callers.keys().flatten();
            sites
                .any(|&site| code.outermost(site) == function)
                .then_some(*callee)
        };
        for callee in calls.iter().filter_map(calls_of) {
            if !self.above.contains(&callee) {
                self.calls.insert((function, callee));
                self.visit(callee, calls, code);
            }
        }
        self.above.pop();
    }

    fn is_forward(&self, caller: Name, callee: Name) -> bool {
        self.calls.contains(&(caller, callee))
    }
}

/// Grows the trees.
struct Builder<'a> {
    costs: &'a BTreeMap<u32, Cost>,
    code: &'a Code,
    functions: BTreeMap<Name, Vec<u32>>,
    /// What an instruction calls, and the share of the callee's cost that is its.
    callees: BTreeMap<u32, Vec<(Name, f64)>>,
    reached: BTreeSet<Name>,
    roots: Vec<Node>,
}

impl Builder<'_> {
    /// Adds a share of a function's cost, and of what it calls, below a stack of functions.
    fn enter(&mut self, function: Name, above: &mut Vec<Name>, share: f64) {
        self.reached.insert(function);
        let depth = above.len();
        for address in self.functions.get(&function).cloned().unwrap_or_default() {
            above.extend(self.code.functions(address));
            let cost = self.costs[&address];
            add(
                &mut self.roots,
                above,
                share * cost.cycles as f64,
                share * cost.instructions as f64,
            );
            for (callee, part) in self.callees.get(&address).cloned().unwrap_or_default() {
                self.enter(callee, above, share * part);
            }
            above.truncate(depth);
        }
    }
}

/// Adds a cost along a stack.
fn add(nodes: &mut Vec<Node>, stack: &[Name], cycles: f64, instructions: f64) {
    let Some((&name, below)) = stack.split_first() else {
        return;
    };
    let place = nodes
        .iter()
        .position(|node| node.name == name)
        .unwrap_or_else(|| {
            nodes.push(Node {
                name,
                cycles: 0.0,
                instructions: 0.0,
                below: Vec::new(),
            });
            nodes.len() - 1
        });
    let node = &mut nodes[place];
    node.cycles += cycles;
    node.instructions += instructions;
    add(&mut node.below, below, cycles, instructions);
}

#[cfg(test)]
mod tests {
    use cycles::flow::{self, Block, Edge, Instruction, Isa};

    use super::super::code::tests::code;
    use super::*;

    /// A block of two instructions at each of these addresses.
    fn blocks(starts: &[u32]) -> Vec<Block> {
        let instruction = |address| Instruction {
            address,
            encoding: 0,
            bytes: 4,
        };
        let block = |&start: &u32| Block {
            instructions: vec![instruction(start), instruction(start + 4)],
            ..flow::Block::default()
        };
        starts.iter().map(block).collect()
    }

    fn edge(from: Option<usize>, to: usize, count: u64) -> Edge {
        Edge { from, to, count }
    }

    fn costs(code: &[(u32, u64)]) -> BTreeMap<u32, Cost> {
        let cost = |cycles| Cost {
            cycles,
            instructions: cycles,
            ..Cost::default()
        };
        code.iter()
            .map(|&(address, cycles)| (address, cost(cycles)))
            .collect()
    }

    /// A tree in words, as in `a 3 (b 2)`.
    fn words(nodes: &[Node], code: &Code) -> String {
        let node = |node: &Node| {
            let below = words(&node.below, code);
            let below = if below.is_empty() {
                below
            } else {
                format!(" ({below})")
            };
            format!("{} {}{below}", code.word(node.name), node.cycles)
        };
        nodes.iter().map(node).collect::<Vec<_>>().join(", ")
    }

    #[test]
    fn a_callee_stands_below_its_callers_in_proportion_to_their_calls() {
        // `render` calls `root` three times from what is inlined into it, and `other` once, which calls `root` once.
        let code = code(&[
            (0, "render"),
            (4, "render > hit"),
            (8, "render"),
            (12, "render"),
            (100, "root"),
            (104, "root"),
            (200, "other"),
            (204, "other"),
            (208, "other"),
            (212, "other"),
        ]);
        let flow = Flow {
            isa: Isa::Arm,
            blocks: blocks(&[0, 8, 100, 200, 208]),
            edges: vec![
                edge(None, 0, 3),
                edge(Some(0), 2, 3),
                edge(Some(2), 1, 3),
                edge(Some(1), 3, 1),
                edge(Some(3), 2, 1),
                edge(Some(2), 4, 1),
            ],
        };
        let costs = costs(&[
            (0, 3),
            (4, 3),
            (8, 3),
            (12, 3),
            (100, 4),
            (104, 4),
            (200, 1),
            (204, 1),
            (208, 1),
            (212, 1),
        ]);
        let trees = stacks(&flow, &costs, &code);
        assert_eq!(
            words(&trees, &code),
            "render 24 (hit 9 (root 6), other 6 (root 2))"
        );
    }

    #[test]
    fn a_function_that_calls_itself_by_another_is_counted_once() {
        let code = code(&[(0, "a"), (4, "a"), (100, "b"), (104, "b"), (108, "b"), (112, "b")]);
        let flow = Flow {
            isa: Isa::Arm,
            blocks: blocks(&[0, 100, 108]),
            edges: vec![
                edge(None, 0, 1),
                edge(Some(0), 1, 6),
                edge(Some(1), 0, 5),
                edge(Some(2), 2, 1),
            ],
        };
        let trees = stacks(&flow, &costs(&[(0, 6), (4, 6), (100, 6), (104, 6)]), &code);
        assert_eq!(words(&trees, &code), "a 24 (b 12)");
    }

    #[test]
    fn what_nobody_called_stands_by_itself() {
        let code = code(&[(0, "a"), (4, "a"), (8, "b"), (12, "b")]);
        // What looks like a call from `a`'s last instruction is where `b` begins behind it: never seen as a return into `a`.
        let flow = Flow {
            isa: Isa::Arm,
            blocks: blocks(&[0, 8]),
            edges: vec![edge(None, 0, 1)],
        };
        let trees = stacks(&flow, &costs(&[(0, 1), (4, 1), (8, 2), (12, 2)]), &code);
        assert_eq!(words(&trees, &code), "a 2, b 4");
    }
}
