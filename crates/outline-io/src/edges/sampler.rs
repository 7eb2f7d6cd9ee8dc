//! Grey values of pictures along the normals of an outline.
use image::GrayImage;
use nalgebra::{Point2, Vector2};

use super::step_fit::{Offsets, SIDE_BY_SIDE};
use super::{EdgeSource, interpolated, median};
use crate::ground::background::Difference;
use crate::tracing::contrast::Contrast;
use crate::tracing::transfer::Transfer;

/// A number from 0 on that is less than it by far is rounded to a whole one where both are added, which is then in the last bits of the sum.
const ROUNDS: f64 = (1_u64 << (f64::MANTISSA_DIGITS - 1)) as f64;

/// The bits of what was added to it.
const LAST_BITS: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;

/// What pictures show along the normals of an outline.
pub(super) struct Sampler<'a> {
    picture: &'a GrayImage,
    /// What it is compared with, where that is not done already.
    ground: Option<(&'a GrayImage, Difference)>,
    /// Of every grey value, what it is on a scale where objects are lighter, or the light that is compared.
    signals: [f64; 256],
}

impl<'a> Sampler<'a> {
    /// Of what is looked at along an outline through these points.
    pub(super) fn new(source: &EdgeSource<'a>, points: &[Point2<f64>]) -> Self {
        let &EdgeSource { picture, contrast, transfer, comparison, along: _ } = source;
        let (picture, ground) = match comparison {
            // Of grey values as they are the difference is known.
            Some(comparison) if transfer != Transfer::Linear => {
                (comparison.picture, Some((comparison.ground, comparison.difference)))
            }
            _ => (picture, None),
        };
        let scale = match transfer {
            Transfer::Linear => 1.0,
            // In the middle of the edges it is that of the grey values.
            Transfer::Srgb => transfer.slope(median(points.iter().map(|p| nearest(picture, *p))).unwrap_or_default()),
        };
        let of_light = |light: f64| match contrast {
            Contrast::LightOnDark => light,
            Contrast::DarkOnLight => 255.0 - light,
        };
        let signals = transfer.light().map(|light| of_light(light) / scale);
        Self { picture, ground, signals }
    }

    /// What a pixel shows, by its number, row by row.
    #[inline(always)]
    fn signal(&self, pixel: usize) -> f64 {
        let of = |picture: &GrayImage| self.signals[usize::from(picture.as_raw()[pixel])];
        match self.ground {
            None => of(self.picture),
            Some((ground, difference)) => difference.of_values(of(self.picture), of(ground)),
        }
    }

    /// Puts the values at these distances from a place along a direction into `values`, between the pixels by bilinear interpolation.
    pub(super) fn profile(&self, place: Point2<f64>, along: Vector2<f64>, offsets: &Offsets, values: &mut Vec<f64>) {
        values.clear();
        let [right, lower] = [self.picture.width(), self.picture.height()].map(|size| f64::from(size) - 1.0);
        let has_pixels_around = |offset: f64| {
            let p = place + offset * along;
            p.x >= 0.0 && p.y >= 0.0 && p.x < right && p.y < lower
        };
        // Those between lie between them.
        if offsets.ends().into_iter().all(has_pixels_around) {
            let side_by_side = offsets.side_by_side();
            values.resize(SIDE_BY_SIDE * side_by_side.len(), 0.0);
            let (blocks, _) = values.as_chunks_mut::<SIDE_BY_SIDE>();
            let (stride, pixels) = (self.picture.width() as usize, self.picture.as_raw().as_slice());
            let plain = |from: usize| {
                let around = &pixels[from..from + stride + 2];
                [0, 1, stride, stride + 1].map(|index| self.signals[usize::from(around[index])])
            };
            let differences = |from: usize| [0, 1, stride, stride + 1].map(|index| self.signal(from + index));
            let blocks = blocks.iter_mut().zip(side_by_side);
            match self.ground {
                None => blocks.for_each(|(block, offsets)| *block = self.within(place, along, offsets, plain)),
                Some(_) => blocks.for_each(|(block, offsets)| *block = self.within(place, along, offsets, differences)),
            }
            values.truncate(offsets.count());
        } else {
            let size = self.picture.dimensions();
            let value = |offset| interpolated(size, place + offset * along, |pixel| self.signal(pixel));
            values.extend(offsets.iter().map(value));
        }
    }

    /// What [`interpolated`] says of places within the picture, without its care for the edge of the picture: places first, so that they are worked
    /// out side by side. `around` gives what a pixel shows, the one on its right, and the two below these.
    #[inline(always)]
    fn within(
        &self,
        place: Point2<f64>,
        along: Vector2<f64>,
        offsets: &[f64; SIDE_BY_SIDE],
        around: impl Fn(usize) -> [f64; 4],
    ) -> [f64; SIDE_BY_SIDE] {
        let columns = f64::from(self.picture.width());
        let [mut across, mut down] = [[0.0; SIDE_BY_SIDE]; 2];
        let mut at = [0; SIDE_BY_SIDE];
        for k in 0..SIDE_BY_SIDE {
            let [x, y] = [place.x + along.x * offsets[k], place.y + along.y * offsets[k]];
            let [column, row] = [x, y].map(whole_part);
            (across[k], down[k]) = (x - column, y - row);
            at[k] = (row * columns + column + ROUNDS).to_bits() & LAST_BITS;
        }
        std::array::from_fn(|k| {
            let [left, right, lower_left, lower_right] = around(at[k] as usize);
            let upper = left + across[k] * (right - left);
            let lower = lower_left + across[k] * (lower_right - lower_left);
            upper + down[k] * (lower - upper)
        })
    }
}

/// The grey value of the pixel that a place lies in, or of the nearest.
fn nearest(picture: &GrayImage, place: Point2<f64>) -> f64 {
    let within = |at: f64, size: u32| (at.round().max(0.0) as u32).min(size - 1);
    f64::from(picture.get_pixel(within(place.x, picture.width()), within(place.y, picture.height())).0[0])
}

/// The whole part of a number from 0 to 2^51.
#[inline(always)]
fn whole_part(number: f64) -> f64 {
    let nearest = (number + ROUNDS) - ROUNDS;
    nearest - f64::from(u8::from(nearest > number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracing::input::GroundComparison;

    #[test]
    fn whole_parts_are_those_of_the_library() {
        for number in [0.0, 0.2, 0.5, 0.999_999_999, 1.0, 1.5, 2.5, 3.5, 638.999_999_999_9, 639.0, 65_534.75] {
            assert!(whole_part(number).to_bits() == f64::floor(number).to_bits(), "{number}");
        }
    }

    #[test]
    fn profiles_within_the_picture_and_beyond_its_edge_are_those_of_the_interpolation_to_the_last_bit() {
        let picture = GrayImage::from_fn(37, 23, |x, y| image::Luma([(x * x * 7 + y * 31 + x * y * 5) as u8]));
        let ground = GrayImage::from_fn(37, 23, |x, y| image::Luma([(3 * x + y) as u8]));
        let either = GroundComparison { picture: &picture, ground: &ground, difference: Difference::Either };
        for (contrast, transfer, comparison) in [
            (Contrast::LightOnDark, Transfer::Linear, None),
            (Contrast::DarkOnLight, Transfer::Linear, None),
            (Contrast::DarkOnLight, Transfer::Srgb, None),
            (Contrast::LightOnDark, Transfer::Srgb, Some(either)),
        ] {
            let source = EdgeSource { picture: &picture, comparison, contrast, transfer, along: 0.0 };
            let sampler = Sampler::new(&source, &[Point2::new(4.0, 5.0)]);
            let slope = transfer.slope(f64::from(picture.get_pixel(4, 5).0[0]));
            let expected_signal = |pixel: usize| {
                let light = |picture: &GrayImage| transfer.light()[usize::from(picture.as_raw()[pixel])];
                match (comparison, contrast) {
                    (Some(_), _) => (light(&picture) / slope - light(&ground) / slope).abs(),
                    (None, Contrast::LightOnDark) => light(&picture) / slope,
                    (None, Contrast::DarkOnLight) => (255.0 - light(&picture)) / slope,
                }
            };
            let mut values = Vec::new();
            for k in 0..400_u32 {
                let turn = 0.37 * f64::from(k);
                let place = Point2::new(18.0 + 16.0 * (0.7 * turn).cos(), 11.0 + 11.5 * (1.3 * turn).sin());
                let (along, offsets) = (Vector2::new(turn.cos(), turn.sin()), Offsets::within(3 + k as usize % 7));
                sampler.profile(place, along, &offsets, &mut values);
                let value = |s| interpolated((37, 23), place + s * along, expected_signal);
                let expected: Vec<f64> = offsets.iter().map(value).collect();
                assert_eq!(values, expected, "{place} {along}");
            }
        }
    }

    #[test]
    fn light_is_compared_and_dark_objects_are_the_lighter_ones() {
        let picture = GrayImage::from_fn(4, 4, |x, _| image::Luma([50 * x as u8]));
        let ground = GrayImage::from_pixel(4, 4, image::Luma([100]));
        let sampler = |contrast, transfer, comparison| {
            let source = EdgeSource { picture: &picture, comparison, contrast, transfer, along: 0.0 };
            Sampler::new(&source, &[Point2::new(2.0, 1.0)])
        };
        let dark = sampler(Contrast::DarkOnLight, Transfer::Linear, None);
        assert_eq!([0, 1, 2, 3].map(|pixel| dark.signal(pixel)), [255.0, 205.0, 155.0, 105.0]);
        let light = Transfer::Srgb.light();
        let dark = sampler(Contrast::DarkOnLight, Transfer::Srgb, None);
        let step = dark.signal(1) - dark.signal(3);
        assert!((step - (light[150] - light[50]) / Transfer::Srgb.slope(100.0)).abs() < 1e-9, "{step}");
        for (difference, sign) in [(Difference::Either, 1.0), (Difference::Lighter, 1.0), (Difference::Darker, 0.0)] {
            let comparison = GroundComparison { picture: &picture, ground: &ground, difference };
            let sampler = sampler(Contrast::LightOnDark, Transfer::Srgb, Some(comparison));
            let [lighter, darker] = [sampler.signal(3), sampler.signal(1)];
            let slope = Transfer::Srgb.slope(100.0);
            assert!((lighter - sign * (light[150] - light[100]) / slope).abs() < 1e-9, "{lighter}");
            let of_darker = if difference == Difference::Lighter { 0.0 } else { (light[100] - light[50]) / slope };
            assert!((darker - of_darker).abs() < 1e-9, "{darker}");
        }
    }
}
