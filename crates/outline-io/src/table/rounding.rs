//! How numbers are rounded where that is asked for.
use freeform_curve_fit::Outline;

/// Decimals of times in seconds where numbers are rounded.
const TIME_DECIMALS: usize = 9;

/// Rounds what is written to a share of the size of the first outline, or not at all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounding {
    share: Option<f64>,
    /// Decimals of coordinates, known from the first outline.
    decimals: Option<usize>,
}

impl Rounding {
    pub(crate) fn to_share(share: Option<f64>) -> Self {
        Self { share, decimals: None }
    }

    /// The first outline tells the size.
    pub(crate) fn take(&mut self, outline: &Outline) {
        if let (Some(share), None) = (self.share, self.decimals) {
            self.decimals = decimals_of(share * outline.rms_radius());
        }
    }

    pub(crate) fn time(&self, value: f64) -> f64 {
        rounded(value, self.decimals.map(|_| TIME_DECIMALS))
    }

    pub(crate) fn coordinate(&self, value: f64) -> f64 {
        rounded(value, self.decimals)
    }
}

fn rounded(value: f64, decimals: Option<usize>) -> f64 {
    let Some(decimals) = decimals else { return value };
    let scale = 10_f64.powi(decimals as i32);
    let rounded = (value * scale).round() / scale;
    // Beyond 2^53 steps there is nothing to round.
    if (value * scale).abs() < 9e15 { rounded } else { value }
}

/// Decimals that tell steps of this size apart; `None` where no number of them serves.
fn decimals_of(step: f64) -> Option<usize> {
    let decimals = -step.log10().floor();
    (0.0..=15.0).contains(&decimals).then_some(decimals as usize)
}
