//! How wrong operations are: every variant against the truth, over a sample or over every input there is.
//!
//! The variants of an operation share inputs and, where they take the same ones, the truth about them, which is what
//! takes the time. Work is cut into tasks of a fixed size whose results are put together in order: two runs give the same
//! figures to the bit.

use std::any::{Any, TypeId};
use std::iter;

use fixedmath::random::Lcg64;
use indicatif::ProgressBar;
use operations::{
    Format, Function, Group, Input, Maker, Number, Operation, OperationInput, Variant, Visitor,
};
use rayon::prelude::*;

use super::truth::{self, Oracle, RESULTS, Real};
use super::{Entry, entries};

/// How many inputs are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// A million drawn ones, and a quarter of that of hard ones.
    Sampled,
    /// All 2^32 where 32 bits are all there are; elsewhere a thousand million drawn ones, and sixty million hard ones.
    Exhaustive,
}

/// Cases in a task.
const TASK: u32 = 1 << 16;
/// The most words an input has, as real numbers.
const ARGUMENTS: usize = 6;

/// What was found about a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Inputs within the domain.
    pub cases: u64,
    /// The largest error in ulp.
    pub max_error: f64,
    /// The mean error in ulp.
    pub mean_error: f64,
    /// The words of an input with the largest error.
    pub worst_input: Vec<u32>,
}

impl Depth {
    /// Rivals are slow, and not ours to prove: they are only ever sampled.
    pub fn covers(self, entry: &Entry) -> bool {
        self == Self::Sampled || !matches!(entry.maker, Maker::Rival(_))
    }
}

/// A row and what was found about it; nothing, where there is no truth.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The row.
    pub entry: Entry,
    /// What was found.
    pub figures: Option<Figures>,
}

/// Judges the rows that `wanted` picks. `progress` is told how many tasks there are, and of each one that is done.
pub fn verify(
    depth: Depth,
    wanted: &dyn Fn(&Entry) -> bool,
    progress: &(dyn Progress + Sync),
) -> Vec<Verdict> {
    let rows: Vec<Entry> = Group::ALL.into_iter().flat_map(entries).collect();
    let mut subjects = Subjects {
        wanted: rows.iter().map(wanted).collect(),
        next: 0,
        list: Vec::new(),
    };
    for group in Group::ALL {
        group.show(&mut subjects);
    }
    let tasks = subjects
        .list
        .iter()
        .map(|subject| subject.sources(depth).count() as u64);
    progress.tasks(tasks.sum());
    let mut figures: Vec<Option<Figures>> = vec![None; rows.len()];
    for subject in &subjects.list {
        let sources: Vec<Source> = subject.sources(depth).collect();
        let tallies: Vec<Vec<Tally>> = sources
            .into_par_iter()
            .map(|source| {
                let tallies = subject.judge(source);
                progress.done();
                tallies
            })
            .collect();
        for (place, row) in subject.rows().into_iter().enumerate() {
            figures[row] = Tally::figures(tallies.iter().map(|tallies| &tallies[place]));
        }
    }
    rows.into_iter()
        .zip(figures)
        .zip(subjects.wanted)
        .filter_map(|((entry, figures), wanted)| wanted.then_some(Verdict { entry, figures }))
        .collect()
}

/// Somebody who watches.
pub trait Progress {
    /// There are so many tasks.
    fn tasks(&self, tasks: u64);
    /// One is done.
    fn done(&self);
}

/// Nobody watches.
impl Progress for () {
    fn tasks(&self, _tasks: u64) {}
    fn done(&self) {}
}

impl Progress for ProgressBar {
    fn tasks(&self, tasks: u64) {
        self.set_length(tasks);
    }

    fn done(&self) {
        self.inc(1);
    }
}

/// The operations with their rows, as they are shown.
struct Subjects {
    wanted: Vec<bool>,
    next: usize,
    list: Vec<Box<dyn Subject>>,
}

impl Visitor for Subjects {
    fn visit<V: Variant>(&mut self) {
        let row = self.next;
        self.next += 1;
        if !self.wanted[row] {
            return;
        }
        let judge = judge::<V> as Judge<V::Operation>;
        let known = self.list.iter_mut().find_map(|subject| {
            let subject: &mut dyn Any = subject.as_mut();
            subject.downcast_mut::<Rows<V::Operation>>()
        });
        match known {
            Some(rows) => rows.0.push((row, judge)),
            None => self.list.push(Box::new(Rows::<V::Operation>(vec![(row, judge)]))),
        }
    }
}

type Judge<O> = fn(&Chunk<O>, &mut Tally);

/// The rows of one operation: which of all they are, and how to judge them.
struct Rows<O: Operation>(Vec<(usize, Judge<O>)>);

/// An operation, whichever it is: what runs in parallel is compiled once for all.
trait Subject: Any + Sync {
    fn rows(&self) -> Vec<usize>;
    fn sources(&self, depth: Depth) -> Box<dyn Iterator<Item = Source>>;
    /// What one task finds about each of the rows.
    fn judge(&self, source: Source) -> Vec<Tally>;
}

impl<O: Operation> Subject for Rows<O> {
    fn rows(&self) -> Vec<usize> {
        self.0.iter().map(|&(row, _)| row).collect()
    }

    fn sources(&self, depth: Depth) -> Box<dyn Iterator<Item = Source>> {
        let every = O::Input::of_bits(0).is_some();
        let (bits, drawn, hard) = match depth {
            Depth::Sampled => (0, 16, 4),
            Depth::Exhaustive if every => (1 << 16, 0, 0),
            Depth::Exhaustive => (0, 1_000_000_000 / TASK + 1, 1000),
        };
        let bits = (0..bits).map(Source::Bits);
        let drawn = (0..drawn).map(Source::Drawn);
        Box::new(bits.chain(drawn).chain((0..hard).map(Source::Hard)))
    }

    fn judge(&self, source: Source) -> Vec<Tally> {
        let chunk = Chunk::<O>::of(source);
        let mut tallies = vec![Tally::default(); self.0.len()];
        for ((_, judge), tally) in self.0.iter().zip(&mut tallies) {
            judge(&chunk, tally);
        }
        tallies
    }
}

/// Where the inputs of a task come from.
#[derive(Clone, Copy)]
enum Source {
    Bits(u32),
    Drawn(u32),
    Hard(u32),
}

/// Inputs of an operation, and the truth about them.
struct Chunk<O: Operation> {
    inputs: Vec<O::Input>,
    truths: Vec<[Real; RESULTS]>,
}

impl<O: Operation> Chunk<O> {
    fn of(source: Source) -> Self {
        let stream = |kind: u64, task: u32| Lcg64::new(kind << 32 | u64::from(task));
        let accepted = |&input: &O::Input| O::accepts(input);
        let inputs: Vec<O::Input> = match source {
            Source::Bits(task) => (0..TASK)
                .filter_map(|case| O::Input::of_bits(task << 16 | case))
                .filter(accepted)
                .collect(),
            Source::Drawn(task) => {
                let mut random = stream(1, task);
                let drawn = iter::repeat_with(|| O::Input::draw(&mut random));
                drawn.filter(accepted).take(TASK as usize).collect()
            }
            Source::Hard(task) => {
                let mut random = stream(2, task);
                let hard = iter::repeat_with(|| O::hard(&mut random));
                hard.filter(accepted).take(TASK as usize).collect()
            }
        };
        let truths = truth::oracle(O::FUNCTION)
            .map(|oracle| inputs.iter().map(|input| truth_about(oracle, input)).collect());
        Self {
            inputs,
            truths: truths.unwrap_or_default(),
        }
    }
}

fn truth_about(oracle: Oracle, given: &impl Number) -> [Real; RESULTS] {
    let mut arguments = [Real::default(); ARGUMENTS];
    let mut places = arguments.iter_mut();
    given.reals(&mut |high, low| {
        if let Some(place) = places.next() {
            *place = Real { high, low };
        }
    });
    oracle(&arguments)
}

/// Sums up the errors of a row over a chunk.
fn judge<V: Variant>(chunk: &Chunk<V::Operation>, tally: &mut Tally) {
    let Some(oracle) = truth::oracle(V::FUNCTION) else {
        return;
    };
    let shares = TypeId::of::<V::Given>() == TypeId::of::<OperationInput<V>>()
        && V::FUNCTION == V::Operation::FUNCTION;
    for (&input, &shared) in chunk.inputs.iter().zip(&chunk.truths) {
        if V::accepts(input) {
            let given = V::given(input);
            let truth = if shares {
                shared
            } else {
                truth_about(oracle, &given)
            };
            if let Some(error) = error::<V>(given, truth) {
                tally.see(error, input);
            }
        }
    }
}

/// The largest error in ulp of a variant's results; `None` where the truth is out of its domain.
fn error<V: Variant>(given: V::Given, truth: [Real; RESULTS]) -> Option<f64> {
    const fn format<V: Variant>() -> Format {
        <V::Operation as Operation>::FORMAT
    }
    if !V::SATURATES && !truth.iter().all(|truth| truth.fits(format::<V>())) {
        return None;
    }
    let mut truths = truth.iter();
    let mut worst = 0f64;
    V::apply(given).reals(&mut |high, low| {
        if let Some(truth) = truths.next() {
            let error = truth::error(V::FUNCTION, truth.clamped(format::<V>()), Real { high, low });
            // What is no number is infinitely wrong.
            worst = worst.max(if error.is_nan() { f64::INFINITY } else { error });
        }
    });
    Some(worst * 2f64.powi(format::<V>().fraction_bits))
}

/// The error of a variant for the input of these words; `None` where that is out of its domain.
pub(super) fn error_at<V: Variant>(words: &[u32]) -> Option<f64> {
    let oracle = truth::oracle(V::FUNCTION)?;
    let mut words = words.iter();
    let any = OperationInput::<V>::draw(&mut Lcg64::new(0));
    let input = any.through(&mut |_| words.next().copied().unwrap_or_default());
    if !operations::accepts::<V>(input) {
        return None;
    }
    let given = V::given(input);
    error::<V>(given, truth_about(oracle, &given))
}

/// Whether every input of a variant can be tried.
pub(super) fn can_be_exhausted<V: Variant>() -> bool {
    OperationInput::<V>::of_bits(0).is_some() && V::FUNCTION != Function::RandomNumber
}

/// Errors, summed up.
#[derive(Clone, Debug, Default)]
struct Tally {
    cases: u64,
    max: f64,
    sum: f64,
    /// The words of the first input with the largest error; none before the first case.
    worst: Option<Vec<u32>>,
}

impl Tally {
    fn see(&mut self, error: f64, input: impl Number) {
        self.cases += 1;
        self.sum += error;
        if error > self.max || self.worst.is_none() {
            self.max = error;
            self.worst = Some(words(input));
        }
    }

    /// The parts together; the worst input is the first of the worst.
    fn figures<'a>(parts: impl Iterator<Item = &'a Self>) -> Option<Figures> {
        let mut whole = Self::default();
        for part in parts {
            whole.cases += part.cases;
            whole.sum += part.sum;
            if part.max > whole.max || whole.worst.is_none() {
                whole.max = part.max;
                whole.worst.clone_from(&part.worst);
            }
        }
        Some(Figures {
            cases: whole.cases,
            max_error: whole.max,
            mean_error: whole.sum / whole.cases as f64,
            worst_input: whole.worst?,
        })
    }
}

fn words(input: impl Number) -> Vec<u32> {
    let mut words = Vec::new();
    input.through(&mut |word| {
        words.push(word);
        word
    });
    words
}
