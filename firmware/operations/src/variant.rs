//! Ways to do an operation.

use fixedmath::random::Lcg64;

use crate::number::{Input, Number};
use crate::operation::{Function, Operation};

/// Who wrote a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Maker {
    /// `fixedmath`'s own.
    Ours,
    /// The published system's, as `fixedmath` has it.
    Published,
    /// A crate that a user might pick instead.
    Rival(&'static str),
}

/// One way to do an operation: a row of the price list.
pub trait Variant: 'static {
    /// What it does.
    type Operation: Operation;
    /// Its own form of the operation's input.
    type Given: Number;
    /// Its own form of the operation's output.
    type Found: Number;
    /// The path of its function.
    const NAME: &'static str;
    /// Who wrote it.
    const MAKER: Maker;
    /// The function it approaches: the operation's, unless variants differ in more than arithmetic.
    const FUNCTION: Function = <Self::Operation as Operation>::FUNCTION;
    /// The inputs its errors are for, in words.
    const DOMAIN: &'static str = <Self::Operation as Operation>::DOMAIN;
    /// Whether a result that the format does not hold gives the format's end. If not, such inputs are not in its domain.
    const SATURATES: bool = Self::TOTAL;
    /// Whether every input of the operation has a defined result, also outside the domain.
    const TOTAL: bool = !matches!(Self::MAKER, Maker::Rival(_));

    /// The input in this variant's own form.
    fn given(input: OperationInput<Self>) -> Self::Given;

    /// Whether this variant can take an input of the operation's domain.
    fn accepts(_input: OperationInput<Self>) -> bool {
        true
    }

    /// Does it.
    fn apply(given: Self::Given) -> Self::Found;
}

/// The input of a variant's operation.
pub type OperationInput<V> = <<V as Variant>::Operation as Operation>::Input;

/// Goes through rows.
pub trait Visitor {
    /// Called once a row.
    fn visit<V: Variant>(&mut self);
}

/// Whether an input is in the domain of both the operation and the variant.
pub fn accepts<V: Variant>(input: OperationInput<V>) -> bool {
    V::Operation::accepts(input) && V::accepts(input)
}

/// An input in the domain of a variant.
#[inline(never)]
pub(crate) fn draw<V: Variant>(random: &mut Lcg64) -> OperationInput<V> {
    loop {
        let input = Input::draw(random);
        if accepts::<V>(input) {
            return input;
        }
    }
}
