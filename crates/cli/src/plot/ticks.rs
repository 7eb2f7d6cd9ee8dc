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
    fn a_range_that_is_no_range_has_no_ticks() {
        for (low, high) in [(0.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY), (1.0, 1.0 + 1e-16)] {
            assert!(Ticks::within(low, high, 5).positions.is_empty(), "{low} {high}");
        }
    }
}
