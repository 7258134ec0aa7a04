//! Prints what a recording costs in cycles, by the functions of its image: `price RECORDING IMAGE`.

use std::collections::BTreeMap;
use std::io::Write;

use anyhow::Context;
use cycles::{Assumptions, file, price};
use object::{Object, ObjectSymbol, SymbolKind};

fn main() -> anyhow::Result<()> {
    let mut words = std::env::args_os().skip(1);
    let (recording, image) = words.next().zip(words.next()).context("price RECORDING IMAGE")?;
    let recording = file::read(recording.as_ref())?;
    let bytes = std::fs::read(image)?;
    let image = object::File::parse(bytes.as_slice())?;
    let mut functions: BTreeMap<u64, &str> = BTreeMap::new();
    for symbol in image
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
    {
        functions.insert(symbol.address() & !1, symbol.name()?);
    }
    let mut sums: BTreeMap<&str, (u64, u64, u64)> = BTreeMap::new();
    for priced in recording
        .segments
        .iter()
        .flat_map(|flow| price(flow, Assumptions::default()))
    {
        let function = functions
            .range(..=u64::from(priced.address))
            .next_back()
            .map_or("?", |(_, name)| name);
        let stalls = priced.load_stalls + priced.multiply_stalls;
        for name in [function, "all", priced.class.name()] {
            let sum = sums.entry(name).or_default();
            *sum = (sum.0 + priced.cycles, sum.1 + priced.executions, sum.2 + stalls);
        }
    }
    let mut rows: Vec<_> = sums.into_iter().collect();
    rows.sort_by_key(|&(_, (cycles, ..))| std::cmp::Reverse(cycles));
    let mut out = std::io::stdout().lock();
    writeln!(out, "{:>14} {:>14} {:>14}", "cycles", "instructions", "stalls")?;
    for (name, (cycles, instructions, stalls)) in rows {
        writeln!(out, "{cycles:14} {instructions:14} {stalls:14}  {name}")?;
    }
    Ok(())
}
