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
        Look::Spans => "spans",
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

/// How a curve of a look is filled beside what its class says; a style sheet goes before it.
pub(super) const fn fill(look: Look) -> &'static str {
    match look {
        Look::Spans => r##" fill="#777" fill-opacity=".16""##,
        _ => "",
    }
}

/// The whole height, from the first to the last of some points.
pub(super) fn span(pixels: &[[f64; 2]], from: f64, to: f64) -> String {
    let ends = pixels.first().zip(pixels.last());
    ends.map_or_else(String::new, |([left, _], [right, _])| {
        format!("M{left:.2} {from:.2}H{right:.2}V{to:.2}H{left:.2}Z")
    })
}

/// Half the width of the mark of a single value, and of its band, in pixels.
const RING: f64 = 2.5;
const BAR: f64 = 2.0;

/// A ring about a point.
pub(super) fn ring([x, y]: [f64; 2]) -> String {
    format!("M{:.2} {y:.2}a{RING} {RING} 0 1 0 {w} 0a{RING} {RING} 0 1 0 -{w} 0", x - RING, w = 2.0 * RING)
}

/// A bar from the lower to the upper end of the band of one value.
pub(super) fn bar([x, lower]: [f64; 2], [_, upper]: [f64; 2]) -> String {
    let (left, right) = (x - BAR, x + BAR);
    format!("M{left:.2} {lower:.2}H{right:.2}V{upper:.2}H{left:.2}Z")
}
