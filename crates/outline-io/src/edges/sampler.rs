use image::GrayImage;
use nalgebra::{Point2, Vector2};

use super::interpolated;
use super::step_fit::{Offsets, SIDE_BY_SIDE};
use crate::contrast::{Contrast, signal};

/// A number from 0 on that is less than it by far is rounded to a whole one where both are added, which is then in the last bits of the sum.
const ROUNDS: f64 = (1_u64 << (f64::MANTISSA_DIGITS - 1)) as f64;

/// The bits of what was added to it.
const LAST_BITS: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;

/// Grey values of a picture along the normals of an outline.
pub(super) struct Sampler<'a> {
    picture: &'a GrayImage,
    /// Of every grey value, what it is on a scale where objects are lighter.
    signals: [f64; 256],
}

impl<'a> Sampler<'a> {
    pub(super) fn new(picture: &'a GrayImage, contrast: Contrast) -> Self {
        let signals = std::array::from_fn(|value| f64::from(signal(value as u8, contrast)));
        Self { picture, signals }
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
            for (block, offsets) in blocks.iter_mut().zip(side_by_side) {
                *block = self.within(place, along, offsets);
            }
            values.truncate(offsets.count());
        } else {
            let value =
                |offset| interpolated(self.picture, place + offset * along, |pixel| self.signals[usize::from(pixel)]);
            values.extend(offsets.iter().map(value));
        }
    }

    /// What [`interpolated`] says of places within the picture, without its care for the edge of the picture: places first, so that they are worked
    /// out side by side.
    #[inline(always)]
    fn within(&self, place: Point2<f64>, along: Vector2<f64>, offsets: &[f64; SIDE_BY_SIDE]) -> [f64; SIDE_BY_SIDE] {
        let (stride, pixels) = (self.picture.width() as usize, self.picture.as_raw().as_slice());
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
            let from = at[k] as usize;
            let around = &pixels[from..from + stride + 2];
            let pixel = |index: usize| self.signals[usize::from(around[index])];
            let upper = pixel(0) + across[k] * (pixel(1) - pixel(0));
            let lower = pixel(stride) + across[k] * (pixel(stride + 1) - pixel(stride));
            upper + down[k] * (lower - upper)
        })
    }
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

    #[test]
    fn whole_parts_are_those_of_the_library() {
        for number in [0.0, 0.2, 0.5, 0.999_999_999, 1.0, 1.5, 2.5, 3.5, 638.999_999_999_9, 639.0, 65_534.75] {
            assert!(whole_part(number).to_bits() == f64::floor(number).to_bits(), "{number}");
        }
    }

    #[test]
    fn profiles_within_the_picture_and_beyond_its_edge_are_those_of_the_interpolation_to_the_last_bit() {
        let picture = GrayImage::from_fn(37, 23, |x, y| image::Luma([(x * x * 7 + y * 31 + x * y * 5) as u8]));
        for contrast in [Contrast::LightOnDark, Contrast::DarkOnLight] {
            let sampler = Sampler::new(&picture, contrast);
            let mut values = Vec::new();
            for k in 0..400_u32 {
                let turn = 0.37 * f64::from(k);
                let place = Point2::new(18.0 + 16.0 * (0.7 * turn).cos(), 11.0 + 11.5 * (1.3 * turn).sin());
                let (along, offsets) = (Vector2::new(turn.cos(), turn.sin()), Offsets::within(3 + k as usize % 7));
                sampler.profile(place, along, &offsets, &mut values);
                let value = |s| interpolated(&picture, place + s * along, |pixel| f64::from(signal(pixel, contrast)));
                let expected: Vec<f64> = offsets.iter().map(value).collect();
                assert_eq!(values, expected, "{place} {along}");
            }
        }
    }
}
