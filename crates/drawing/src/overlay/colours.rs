//! The colours of what is drawn.
use image::Rgb;

pub(super) const OUTLINE: Rgb<u8> = Rgb([255, 230, 60]);
pub(super) const REJECTED: Rgb<u8> = Rgb([255, 80, 80]);
pub(super) const CURVE: Rgb<u8> = Rgb([86, 180, 233]);
pub(super) const RELATED: Rgb<u8> = Rgb([240, 120, 220]);
pub(super) const MOTION: Rgb<u8> = Rgb([0, 220, 150]);

/// All colours of drawings.
pub(super) const COLOURS: [Rgb<u8>; 5] = [OUTLINE, REJECTED, CURVE, RELATED, MOTION];
