//! Axes: where values lie, and which of them are named.

use std::fmt;

/// A quantity along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The quantity, with its unit.
    pub name: String,
    /// How values are spread along it.
    pub scale: Scale,
}

/// How values are spread along an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// By their logarithms; values are above 0.
    Log,
    /// By themselves.
    Linear,
    /// Names, the first at the top; a value is the number of one.
    Names(Vec<String>),
}

impl Axis {
    /// On a logarithmic scale.
    pub fn log(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            scale: Scale::Log,
        }
    }

    /// On a linear scale.
    pub fn linear(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            scale: Scale::Linear,
        }
    }

    /// Of names.
    pub fn names(names: Vec<String>) -> Self {
        Self {
            name: String::new(),
            scale: Scale::Names(names),
        }
    }
}

/// A place on an axis that a line is drawn at.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    /// What stands beside it; nothing at those between.
    pub(super) label: Option<String>,
}

impl Tick {
    fn named(value: f64) -> Self {
        Self {
            value,
            label: Some(number(value)),
        }
    }

    fn unnamed(value: f64) -> Self {
        Self { value, label: None }
    }
}

/// An axis laid out in units of the drawing.
#[derive(Clone, Debug)]
pub(super) struct Ruler<'a> {
    scale: &'a Scale,
    /// The ends, as the scale spreads them.
    ends: [f64; 2],
    /// Where the ends are drawn.
    places: [f64; 2],
}

/// The share of an axis that is left free at either end.
const ROOM: f64 = 0.05;
/// The shortest logarithmic axis, in decades: a factor of two.
const SHORTEST: f64 = 0.3;
/// From so many decades on, powers of ten are ticks enough.
const DECADES: f64 = 1.5;
/// Named ticks at most.
const MOST: usize = 8;

impl<'a> Ruler<'a> {
    /// From the least to the greatest of the values, and a little more.
    pub(super) fn over(scale: &'a Scale, values: impl Iterator<Item = f64>, places: [f64; 2]) -> Self {
        if let Scale::Names(names) = scale {
            let ends = [-0.5, names.len() as f64 - 0.5];
            return Self { scale, ends, places };
        }
        let spread = values.map(|value| spread(scale, value));
        let (low, high) = spread.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let shortest = match scale {
            Scale::Log => SHORTEST,
            _ => low.abs().max(high.abs()).max(f64::MIN_POSITIVE) * 1e-3,
        };
        let wider = (shortest - (high - low)).max(0.0) / 2.0;
        let (low, high) = (low - wider, high + wider);
        let room = ROOM * (high - low);
        Self {
            scale,
            ends: [low - room, high + room],
            places,
        }
    }

    /// Where a value is drawn.
    pub(super) fn place(&self, value: f64) -> f64 {
        let share = (spread(self.scale, value) - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.places[0] + share * (self.places[1] - self.places[0])
    }

    /// Whether a value is within the axis.
    pub(super) fn holds(&self, value: f64) -> bool {
        (self.ends[0]..=self.ends[1]).contains(&spread(self.scale, value))
    }

    /// The ticks, in ascending order.
    pub(super) fn ticks(&self) -> Vec<Tick> {
        let mut ticks = match self.scale {
            Scale::Log => self.log_ticks(),
            Scale::Linear => self.linear_ticks(self.ends),
            Scale::Names(names) => (0..)
                .zip(names)
                .map(|(row, name)| Tick {
                    value: f64::from(row),
                    label: Some(name.clone()),
                })
                .collect(),
        };
        ticks.retain(|tick| self.holds(tick.value));
        ticks
    }

    fn log_ticks(&self) -> Vec<Tick> {
        let [low, high] = self.ends;
        let decades = low.floor() as i32..=high.ceil() as i32;
        let step = ((high - low) / MOST as f64).ceil().max(1.0) as i32;
        if high - low >= DECADES {
            let of = |power: i32| {
                let major = (power.rem_euclid(step) == 0).then(|| Tick::named(10f64.powi(power)));
                let minor = (2..10).map(move |digit| Tick::unnamed(f64::from(digit) * 10f64.powi(power)));
                major.into_iter().chain(minor.filter(move |_| step == 1))
            };
            return decades.flat_map(of).collect();
        }
        let tick = |digit: i32, power: i32| {
            let value = f64::from(digit) * 10f64.powi(power);
            if matches!(digit, 1 | 2 | 5) {
                Tick::named(value)
            } else {
                Tick::unnamed(value)
            }
        };
        let ticks: Vec<Tick> = decades
            .flat_map(|power| (1..10).map(move |digit| tick(digit, power)))
            .collect();
        let named = ticks
            .iter()
            .filter(|tick| tick.label.is_some() && self.holds(tick.value));
        if named.count() < 2 {
            return self.linear_ticks(self.ends.map(|end| 10f64.powf(end)));
        }
        ticks
    }

    /// Multiples of 1, 2 or 5 times a power of ten.
    fn linear_ticks(&self, [low, high]: [f64; 2]) -> Vec<Tick> {
        let rough = (high - low) / 6.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
        let step = step.into_iter().find(|&step| step >= rough).unwrap_or(rough);
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        // A whole number times a step is rarely the decimal number that it is meant to be.
        let value = |count: i64| {
            let decimals = (-step.log10().floor()).max(0.0);
            let power = 10f64.powf(decimals);
            (count as f64 * step * power).round() / power
        };
        (first..=last).map(|count| Tick::named(value(count))).collect()
    }
}

fn spread(scale: &Scale, value: f64) -> f64 {
    match scale {
        Scale::Log => value.log10(),
        Scale::Linear | Scale::Names(_) => value,
    }
}

/// A number as ticks have it: digits in groups of three, or a power of ten.
pub(in crate::report) fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(9.99e-4..1e6).contains(&magnitude) {
        let power = magnitude.log10().floor() as i32;
        let mantissa = value / 10f64.powi(power);
        let power = format!("10{}", raised(power));
        return match trimmed(mantissa, 2).as_str() {
            "1" => power,
            "−1" => format!("−{power}"),
            digits => format!("{digits}·{power}"),
        };
    }
    let decimals = (2 - magnitude.log10().floor() as i32).max(0);
    trimmed(value, decimals as usize)
}

/// So many decimals, without zeros at the end and with commas between thousands.
fn trimmed(value: f64, decimals: usize) -> String {
    let digits = format!("{value:.decimals$}");
    let (whole, part) = digits.split_once('.').unwrap_or((&digits, ""));
    let (sign, whole) = whole.strip_prefix('-').map_or(("", whole), |whole| ("−", whole));
    let part = part.trim_end_matches('0');
    let point = if part.is_empty() { "" } else { "." };
    format!("{sign}{}{point}{part}", Grouped(whole))
}

struct Grouped<'a>(&'a str);

impl fmt::Display for Grouped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.0.len();
        for (place, digit) in self.0.chars().enumerate() {
            if place > 0 && (count - place).is_multiple_of(3) {
                f.write_str(",")?;
            }
            write!(f, "{digit}")?;
        }
        Ok(())
    }
}

/// An exponent as it stands beside its base.
fn raised(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digit = |digit: char| match digit.to_digit(10) {
        Some(digit) => DIGITS[digit as usize],
        None => '⁻',
    };
    power.to_string().chars().map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale, values: [f64; 2]) -> Vec<String> {
        let ticks = Ruler::over(scale, values.into_iter(), [0.0, 100.0]).ticks();
        ticks.into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn decades_are_ticks_of_a_long_logarithmic_axis() {
        assert_eq!(
            labels(&Scale::Log, [2.0, 9e4]),
            ["10", "100", "1,000", "10,000", "100,000"]
        );
        assert_eq!(
            labels(&Scale::Log, [1e-7, 1e-4]),
            ["10⁻⁷", "10⁻⁶", "10⁻⁵", "10⁻⁴"]
        );
        let far = labels(&Scale::Log, [1e-12, 1e12]);
        assert!((4..=MOST).contains(&far.len()), "{far:?}");
    }

    #[test]
    fn digits_are_ticks_of_a_short_one() {
        assert_eq!(labels(&Scale::Log, [4.0, 60.0]), ["5", "10", "20", "50"]);
        assert_eq!(
            labels(&Scale::Log, [4700.0, 5300.0]),
            ["4,000", "5,000", "6,000", "7,000"]
        );
        assert_eq!(
            labels(&Scale::Log, [3.0, 3.0]).len(),
            4,
            "a single value has an axis, too"
        );
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(
            labels(&Scale::Linear, [0.0, 1.0]),
            ["0", "0.2", "0.4", "0.6", "0.8", "1"]
        );
        assert_eq!(labels(&Scale::Linear, [-40.0, 35.0]), ["−40", "−20", "0", "20"]);
    }

    #[test]
    fn values_lie_between_the_ends_in_their_order() {
        let scale = Scale::Log;
        let ruler = Ruler::over(&scale, [1.0, 100.0].into_iter(), [10.0, 210.0]);
        let places = [1.0, 10.0, 100.0].map(|value| ruler.place(value));
        assert!(10.0 < places[0] && places[2] < 210.0, "{places:?}");
        assert!((places[1] - 110.0).abs() < 1e-9, "{places:?}");
    }

    #[test]
    fn names_have_a_row_each() {
        let names = Scale::Names(vec!["a".to_owned(), "b".to_owned()]);
        let ruler = Ruler::over(&names, [].into_iter(), [0.0, 40.0]);
        assert_eq!([ruler.place(0.0), ruler.place(1.0)], [10.0, 30.0]);
        assert_eq!(ruler.ticks().len(), 2);
    }

    #[test]
    fn numbers_read_well() {
        let written = [0.0, 0.001, 0.25, 3.0, 12.5, 1234.0, 205_000.0, 1e6, 2.5e7, -1e-9].map(number);
        assert_eq!(
            written,
            [
                "0",
                "0.001",
                "0.25",
                "3",
                "12.5",
                "1,234",
                "205,000",
                "10⁶",
                "2.5·10⁷",
                "−10⁻⁹"
            ]
        );
    }
}
