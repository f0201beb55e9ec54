//! Ranges of axes, their ticks at round numbers, and readable numbers.

/// The quantity of an axis or a colour bar: the words and the unit of its label.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Quantity {
    /// Its name, with the symbol: `contact pressure p`.
    pub name: String,
    /// Its unit; empty if it has none.
    pub unit: String,
}

impl Quantity {
    /// A quantity with its unit; an empty unit for a pure number.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Quantity { name: name.into(), unit: unit.into() }
    }

    /// The name with the unit in brackets, as the heading of a column.
    pub(crate) fn in_brackets(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} [{}]", self.name, self.unit) }
    }

    /// The label of an axis with ticks in multiples of ten to the `exponent`: `contact pressure p (MPa)` for pascals
    /// and 6; with the power of ten if the unit takes no prefix.
    pub fn label(&self, exponent: i32) -> String {
        if let Some(unit) = prefixed(&self.unit, exponent).filter(|_| exponent != 0) {
            return format!("{} ({unit})", self.name);
        }
        let factor = if exponent == 0 { String::new() } else { power_of_ten(exponent) };
        match (self.unit.is_empty(), factor.is_empty()) {
            (true, true) => self.name.clone(),
            (true, false) => format!("{} (×{factor})", self.name),
            (false, true) => format!("{} ({})", self.name, self.unit),
            (false, false) => format!("{} ({factor} {})", self.name, self.unit),
        }
    }
}

/// The prefixes of a unit with their exponents of ten.
const PREFIXES: [(&str, i32); 8] = [("n", -9), ("µ", -6), ("m", -3), ("", 0), ("k", 3), ("M", 6), ("G", 9), ("T", 12)];

/// Units that take prefixes, with the largest exponent in use: nobody writes megametres.
const BASES: [(&str, i32); 5] = [("Pa", 12), ("N", 12), ("J", 12), ("m", 3), ("s", 0)];

/// `unit` times ten to the `exponent` as a unit with a prefix: `Pa` and 6 are `MPa`, `kN/m` and 3 `MN/m`. `None` if the
/// unit has no such prefix.
fn prefixed(unit: &str, exponent: i32) -> Option<String> {
    let end = unit.find(['/', ' ', '·']).unwrap_or(unit.len());
    let (head, rest) = unit.split_at(end);
    let parts = PREFIXES.iter().flat_map(|prefix| BASES.iter().map(move |base| (prefix, base)));
    let (&(_, own), &(base, most)) = parts.clone().find(|(prefix, base)| format!("{}{}", prefix.0, base.0) == head)?;
    let (prefix, _) = PREFIXES.into_iter().find(|&(_, power)| power == own + exponent && power <= most)?;
    Some(format!("{prefix}{base}{rest}"))
}

/// A value with its unit, rounded and with a prefix: `70.77 kN`.
pub(crate) fn amount(value: f64, unit: &str) -> String {
    let exponent = common_exponent(value.abs());
    match prefixed(unit, exponent) {
        Some(unit) => format!("{} {unit}", brief(value / 10f64.powi(exponent))),
        None => format!("{} {unit}", brief(value)).trim_end().to_owned(),
    }
}

/// The map from numbers to lengths on an axis, linear or logarithmic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios; shows positive numbers only.
    Logarithmic,
}

impl Scale {
    /// Returns `true` if `value` can be shown on this scale: it is not near the ends of the floating-point range.
    pub fn shows(self, value: f64) -> bool {
        value.abs() < 1e290 && (self == Scale::Linear || value > 1e-290)
    }

    /// The value in the coordinate that is linear in length along the axis.
    fn along(self, value: f64) -> f64 {
        if self == Scale::Linear { value } else { value.log10() }
    }

    /// Position of `value` between the ends `[from, to]` of a range, in the same unit: 0 at its start and 1 at its end.
    pub fn fraction(self, value: f64, [from, to]: [f64; 2]) -> f64 {
        let [from, to] = [self.along(from), self.along(to)];
        (self.along(value) - from) / (to - from)
    }

    /// The range `[from, to]` of the values that can be shown, in their unit, widened by `margin` of itself at both
    /// ends.
    ///
    /// Always an increasing range: `[0, 1]` (logarithmic: `[1, 10]`) if there is no value, and something around
    /// the value if there is only one.
    pub fn range(self, values: impl IntoIterator<Item = f64>, margin: f64) -> [f64; 2] {
        let values = values.into_iter().filter(|&value| self.shows(value));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if self == Scale::Logarithmic {
            if low > high {
                return [1.0, 10.0];
            }
            let (low, high) = (low.log10(), high.log10());
            let pad = if high - low < 1e-3 { 0.5 } else { margin * (high - low) };
            return [10f64.powf(low - pad), 10f64.powf(high + pad)];
        }
        if low > high {
            return [0.0, 1.0];
        }
        let largest = low.abs().max(high.abs());
        // Differences within rounding are no range: they would show noise as data.
        let pad = match high - low {
            _ if largest < 1e-290 => 1.0,
            span if span <= 1e-12 * largest => 0.5 * largest,
            span => margin * span,
        };
        [low - pad, high + pad]
    }
}

/// Positions and labels of ticks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// Increasing positions within the range.
    pub positions: Vec<f64>,
    /// One label for each position.
    pub labels: Vec<String>,
    /// The labels count multiples of ten to this exponent, which the label of the axis must name.
    pub exponent: i32,
    /// Positions of small ticks without labels.
    pub minor: Vec<f64>,
    /// Distance of the ticks of a linear axis; zero on a logarithmic one.
    pub step: f64,
}

impl Ticks {
    /// About `count` ticks within `[from, to]`, on a step of 1, 2, 2.5 or 5 times a power of ten (on a logarithmic
    /// scale: on powers of ten).
    pub fn new(scale: Scale, range: [f64; 2], count: usize) -> Self {
        match scale {
            Scale::Linear => linear(range, count.max(1)),
            Scale::Logarithmic => logarithmic(range, count.max(1)),
        }
    }

    /// The same ticks of a linear axis, labelled in multiples of ten to another exponent.
    pub fn in_powers_of(mut self, exponent: i32) -> Self {
        let unit = 10f64.powi(exponent);
        let decimals = (0..=15).find(|&places| is_whole(self.step / unit * 10f64.powi(places))).unwrap_or(15);
        self.labels = self.positions.iter().map(|position| decimal(position / unit, decimals as usize)).collect();
        self.exponent = exponent;
        self
    }
}

fn linear([from, to]: [f64; 2], count: usize) -> Ticks {
    let span = to - from;
    if !(span.is_finite() && span > 0.0) {
        return Ticks::default();
    }
    let step = round_step(span / count as f64);
    // Half a percent of a step: a range that ends on a tick has that tick.
    let (first, last) = ((from / step - 0.005).ceil(), (to / step + 0.005).floor());
    // At most three ticks per requested one; otherwise the range is below the resolution of doubles.
    let number = (last - first + 1.0).clamp(0.0, 3.0 * count as f64) as usize;
    let positions: Vec<f64> =
        (0..number).map(|k| (first + k as f64) * step).filter(|p| *p >= from - span && *p <= to + span).collect();
    let exponent = common_exponent(from.abs().max(to.abs()));
    Ticks { positions, step, ..Ticks::default() }.in_powers_of(exponent)
}

fn logarithmic([from, to]: [f64; 2], count: usize) -> Ticks {
    if !(from > 0.0 && to > from && to.is_finite()) {
        return Ticks::default();
    }
    let (low, high) = (from.log10(), to.log10());
    let decades = (low - 1e-9).ceil() as i32..=(high + 1e-9).floor() as i32;
    let within = |value: &f64| (from * (1.0 - 1e-9)..=to * (1.0 + 1e-9)).contains(value);
    if high - low < 1.2 {
        let whole = low.floor() as i32..=high.floor() as i32;
        let multiples = |factors: &'static [f64]| {
            whole.clone().flat_map(move |k| factors.iter().map(move |factor| factor * 10f64.powi(k))).filter(within)
        };
        let positions: Vec<f64> = multiples(&[1.0, 2.0, 5.0]).collect();
        if positions.len() < 2 {
            // A logarithmic axis over less than a factor of two is nearly linear.
            return linear([from, to], count);
        }
        let labels = positions.iter().map(|&position| brief(position)).collect();
        let minor = multiples(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]).collect();
        return Ticks { positions, labels, minor, ..Ticks::default() };
    }
    if decades.clone().count() < 2 {
        // A single power of ten does not define a scale.
        let whole = low.floor() as i32..=high.floor() as i32;
        let multiples = |factors: &'static [f64]| -> Vec<f64> {
            let all = whole.clone().flat_map(|k| factors.iter().map(move |factor| factor * 10f64.powi(k)));
            all.filter(within).collect()
        };
        let positions = [&[1.0, 2.0, 5.0][..], &[1.0, 3.0], &[1.0]].map(multiples);
        if let Some(positions) = positions.into_iter().find(|found| (2..=count.max(3)).contains(&found.len())) {
            let labels = positions.iter().map(|&position| brief(position)).collect();
            let minor = multiples(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
            return Ticks { positions, labels, minor, ..Ticks::default() };
        }
    }
    let every = ((decades.clone().count() as f64 / count as f64).ceil() as i32).max(1);
    let (labelled, rest): (Vec<i32>, Vec<i32>) = decades.clone().partition(|k| k.rem_euclid(every) == 0);
    let minor = if every == 1 {
        let decades = decades.start() - 1..=*decades.end();
        decades.flat_map(|k| (2..10).map(move |m| f64::from(m) * 10f64.powi(k))).filter(within).collect()
    } else {
        rest.iter().map(|&k| 10f64.powi(k)).collect()
    };
    Ticks {
        positions: labelled.iter().map(|&k| 10f64.powi(k)).collect(),
        labels: labelled.iter().map(|&k| power_of_ten(k)).collect(),
        minor,
        ..Ticks::default()
    }
}

/// The step of 1, 2, 2.5 or 5 times a power of ten that is nearest above `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 2.5, 5.0].into_iter().find(|factor| rough <= factor * power * 1.0001).unwrap_or(10.0);
    factor * power
}

fn is_whole(value: f64) -> bool {
    (value - value.round()).abs() <= 1e-6 * value
}

/// A multiple of three, so that numbers up to `largest` read as 1 to 999; zero for numbers that read well as they are.
pub(crate) fn common_exponent(largest: f64) -> i32 {
    if !largest.is_finite() || largest == 0.0 || (0.01..1e4).contains(&largest) {
        return 0;
    }
    // A ten-thousandth of slack, so that 999.99999 counts as 1000.
    ((largest * 1.0001).log10() / 3.0).floor() as i32 * 3
}

/// `10⁵`, with true superscript digits.
pub fn power_of_ten(exponent: i32) -> String {
    let digits = exponent.to_string();
    let raised = digits.chars().map(|character| match character {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    });
    "10".chars().chain(raised).collect()
}

/// `value` with `places` decimals and a true minus; zero has no sign.
pub fn decimal(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let is_zero = !text.contains(|character: char| character.is_ascii_digit() && character != '0');
    match text.strip_prefix('-') {
        Some(positive) if is_zero && value.is_finite() => positive.to_owned(),
        Some(positive) => format!("−{positive}"),
        None => text,
    }
}

/// `value` to four significant digits: `0.012`, `−350`, `1.25×10⁶`.
pub fn brief(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return decimal(value, 0);
    }
    let scientific = format!("{value:.3e}");
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: String| {
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    if (-3..5).contains(&exponent) {
        return trimmed(decimal(value, (3 - exponent).max(0) as usize));
    }
    match trimmed(mantissa.replace('-', "−")).as_str() {
        "1" => power_of_ten(exponent),
        mantissa => format!("{mantissa}×{}", power_of_ten(exponent)),
    }
}
