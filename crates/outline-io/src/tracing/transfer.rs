//! How grey values stand for light.
use std::sync::LazyLock;

/// How grey values stand for light. An edge that is blurred by the lens, by pixels or by motion while the shutter is open is a mean of light: where
/// grey values are not in proportion to light, the middle between those of both sides is not the middle of the edge, and lies the farther from it the
/// wider the edge is, so that an object seems to grow towards its lighter side with its speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Transfer {
    /// In proportion to it: cameras that measure, and drawings whose edges are blended in grey values.
    #[default]
    Linear,
    /// By the transfer function of sRGB (IEC 61966-2-1, 1999): most cameras, and rendered pictures. That of video (BT.709) is near enough for most of
    /// the effect: of a twentieth of the light it makes a grey value of 48, and sRGB one of 63.
    Srgb,
}

impl Transfer {
    /// The light that each grey value stands for, 0 to 255.
    pub(crate) fn light(self) -> [f64; 256] {
        match self {
            Self::Linear => std::array::from_fn(|value| value as f64),
            Self::Srgb => *LIGHT_OF_SRGB,
        }
    }

    /// How much the light changes with the grey value, at one; of [`Linear`](Self::Linear) 1.
    pub(crate) fn slope(self, value: f64) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Srgb => slope_of_srgb(value / 255.0),
        }
    }
}

/// Looked up once for every contour.
static LIGHT_OF_SRGB: LazyLock<[f64; 256]> =
    LazyLock::new(|| std::array::from_fn(|value| 255.0 * of_srgb(value as f64 / 255.0)));

/// Numbers of the standard: up to the first of them the curve is straight.
const STRAIGHT: f64 = 0.04045;
const OF_STRAIGHT: f64 = 12.92;
const OFFSET: f64 = 0.055;
const EXPONENT: f64 = 2.4;

fn of_srgb(value: f64) -> f64 {
    if value <= STRAIGHT { value / OF_STRAIGHT } else { ((value + OFFSET) / (1.0 + OFFSET)).powf(EXPONENT) }
}

fn slope_of_srgb(value: f64) -> f64 {
    match value <= STRAIGHT {
        true => 1.0 / OF_STRAIGHT,
        false => EXPONENT / (1.0 + OFFSET) * ((value + OFFSET) / (1.0 + OFFSET)).powf(EXPONENT - 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_rises_from_none_to_all_and_its_slope_is_that_of_the_curve() {
        for transfer in [Transfer::Linear, Transfer::Srgb] {
            let light = transfer.light();
            assert!(light[0] == 0.0 && (light[255] - 255.0).abs() < 1e-9 && light.is_sorted());
            for value in 12..250 {
                let slope = 0.5 * (light[value + 1] - light[value - 1]);
                assert!((slope / transfer.slope(value as f64) - 1.0).abs() < 5e-3, "{value}");
            }
        }
        // Half of the light is a grey value of 188.
        assert!((Transfer::Srgb.light()[188] / 255.0 - 0.5).abs() < 5e-3);
    }
}
