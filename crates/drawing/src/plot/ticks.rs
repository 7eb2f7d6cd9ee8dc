/// Round numbers along an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) positions: Vec<f64>,
    pub(crate) labels: Vec<String>,
}

impl Ticks {
    /// About `count` multiples of 1, 2 or 5 times a power of ten within a range.
    pub(crate) fn within(low: f64, high: f64, count: usize) -> Self {
        let step = round_step((high - low) / count.max(1) as f64);
        // A hair of tolerance, so that an end of the range that is a multiple gets its tick.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        if !(step > 0.0 && first.is_finite() && last.is_finite() && last - first < 1000.0) {
            return Self { positions: Vec::new(), labels: Vec::new() };
        }
        let multiples = (0..=(last - first) as i64).map(|k| first + k as f64);
        // Adding 0 makes -0 a 0.
        let positions: Vec<f64> = multiples.map(|multiple| multiple * step + 0.0).collect();
        let largest = low.abs().max(high.abs());
        let exponent = step.log10().floor() as i32;
        let is_plain = largest < 1e5 && exponent >= -4;
        let decimals = usize::try_from(-exponent).unwrap_or(0);
        let digits = usize::try_from((largest.log10().floor() as i32 - exponent).clamp(0, 15)).unwrap_or(0);
        let label = |value: &f64| match is_plain {
            true => format!("{value:.decimals$}"),
            false if *value == 0.0 => "0".to_owned(),
            false => format!("{value:.digits$e}"),
        };
        let labels = positions.iter().map(label).collect();
        Self { positions, labels }
    }

    /// Powers of ten within a range of positive numbers, every so many so that there are about `count` at most; with 2
    /// and 5 times them where the range is short.
    pub(crate) fn of_decades(low: f64, high: f64, count: usize) -> Self {
        let (first, last) = (low.log10().floor(), high.log10().ceil());
        if !(low > 0.0 && low < high && first.is_finite() && last.is_finite()) {
            return Self { positions: Vec::new(), labels: Vec::new() };
        }
        let every = ((last - first) as usize).div_ceil(count.max(1)).max(1);
        let factors: &[f64] = if high / low < 50.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let decades = (first as i32..=last as i32).step_by(every);
        let all = decades.flat_map(|k| factors.iter().map(move |factor| (k, *factor)));
        let (mut positions, mut labels) = (Vec::new(), Vec::new());
        for (k, factor) in all {
            // Read from text, so that 0.001 is the nearest number to it.
            let text = format!("{factor}e{k}");
            let Some(value) = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value)) else { continue };
            positions.push(value);
            labels.push(if (-4..=5).contains(&k) { format!("{value}") } else { text });
        }
        Self { positions, labels }
    }
}

/// The smallest of 1, 2, 5 times a power of ten that is not below a positive number.
fn round_step(rough: f64) -> f64 {
    let power = 10.0_f64.powf(rough.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= rough * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_at_round_numbers_within_the_range() {
        let ticks = Ticks::within(-0.31, 0.42, 5);
        assert_eq!(ticks.labels, ["-0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(Ticks::within(0.0, 30.0, 6).labels, ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(Ticks::within(1.569, 1.5712, 4).labels, ["1.569", "1.570", "1.571"]);
        assert_eq!(Ticks::within(0.0, 2e7, 2).labels, ["0", "1e7", "2e7"]);
    }

    #[test]
    fn a_logarithmic_axis_has_ticks_at_powers_of_ten() {
        assert_eq!(Ticks::of_decades(0.0009, 20.0, 9).labels, ["0.001", "0.01", "0.1", "1", "10"]);
        assert_eq!(Ticks::of_decades(1e-8, 1e2, 6).labels, ["1e-8", "1e-6", "0.0001", "0.01", "1", "100"]);
        assert_eq!(Ticks::of_decades(0.3, 3.0, 6).labels, ["0.5", "1", "2"]);
        for (low, high) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert!(Ticks::of_decades(low, high, 5).positions.is_empty(), "{low} {high}");
        }
    }

    #[test]
    fn a_range_that_is_no_range_has_no_ticks() {
        for (low, high) in [(0.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY), (1.0, 1.0 + 1e-16)] {
            assert!(Ticks::within(low, high, 5).positions.is_empty(), "{low} {high}");
        }
    }
}
