//! How a curve of a look is drawn.
use crate::figure::{Look, SERIES};

/// The class that the style sheets draw a curve of this look by.
pub(super) const fn class(look: Look) -> &'static str {
    const SOLID: [&str; SERIES] = ["s s0", "s s1", "s s2", "s s3", "s s4", "s s5"];
    const DASHED: [&str; SERIES] = ["s d s0", "s d s1", "s d s2", "s d s3", "s d s4", "s d s5"];
    match look {
        Look::FineDots => "dots fine",
        Look::Faint => "faint",
        Look::Series(colour) => SOLID[colour % SERIES],
        Look::Dashed(colour) => DASHED[colour % SERIES],
        Look::Line => "line",
        Look::Truth => "truth",
        Look::Reference => "reference",
        Look::Band => "band",
        Look::Dots => "dots",
        Look::Crosses => "crosses",
        Look::Marks => SOLID[1],
    }
}

pub(super) fn dots(pixels: &[[f64; 2]]) -> String {
    // Lines of no length with round ends.
    pixels.iter().map(|[x, y]| format!("M{x:.2} {y:.2}h0")).collect()
}

pub(super) fn crosses(pixels: &[[f64; 2]]) -> String {
    pixels.iter().map(|[x, y]| format!("M{:.2} {:.2}l8 8m0 -8l-8 8", x - 4.0, y - 4.0)).collect()
}

pub(super) fn marks(pixels: &[[f64; 2]], from: f64, to: f64) -> String {
    pixels.iter().map(|[x, _]| format!("M{x:.2} {from:.2}V{to:.2}")).collect()
}
