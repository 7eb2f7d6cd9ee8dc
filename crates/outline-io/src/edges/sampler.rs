use image::GrayImage;
use nalgebra::{Point2, Vector2};

use super::step_fit::{Offsets, SIDE_BY_SIDE};
use super::{EdgeSource, interpolated, median};
use crate::background::Difference;
use crate::contrast::Contrast;
use crate::transfer::Transfer;

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
        let &EdgeSource { picture, contrast, transfer, compared, along: _ } = source;
        let (picture, ground) = match compared {
            // Of grey values as they are the difference is known.
            Some(compared) if transfer != Transfer::Linear => {
                (compared.picture, Some((compared.ground, compared.difference)))
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
            for (block, offsets) in blocks.iter_mut().zip(side_by_side) {
                *block = self.within(place, along, offsets);
            }
            values.truncate(offsets.count());
        } else {
            let size = self.picture.dimensions();
            let value = |offset| interpolated(size, place + offset * along, |pixel| self.signal(pixel));
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
            let pixel = |index: usize| match self.ground {
                None => self.signals[usize::from(around[index])],
                Some(_) => self.signal(from + index),
            };
            let upper = pixel(0) + across[k] * (pixel(1) - pixel(0));
            let lower = pixel(stride) + across[k] * (pixel(stride + 1) - pixel(stride));
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
    use crate::compared::Compared;

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
        let either = Compared { picture: &picture, ground: &ground, difference: Difference::Either };
        for (contrast, transfer, compared) in [
            (Contrast::LightOnDark, Transfer::Linear, None),
            (Contrast::DarkOnLight, Transfer::Linear, None),
            (Contrast::DarkOnLight, Transfer::Srgb, None),
            (Contrast::LightOnDark, Transfer::Srgb, Some(either)),
        ] {
            let source = EdgeSource { picture: &picture, compared, contrast, transfer, along: 0.0 };
            let sampler = Sampler::new(&source, &[Point2::new(4.0, 5.0)]);
            let mut values = Vec::new();
            for k in 0..400_u32 {
                let turn = 0.37 * f64::from(k);
                let place = Point2::new(18.0 + 16.0 * (0.7 * turn).cos(), 11.0 + 11.5 * (1.3 * turn).sin());
                let (along, offsets) = (Vector2::new(turn.cos(), turn.sin()), Offsets::within(3 + k as usize % 7));
                sampler.profile(place, along, &offsets, &mut values);
                let value = |s| interpolated((37, 23), place + s * along, |pixel| sampler.signal(pixel));
                let expected: Vec<f64> = offsets.iter().map(value).collect();
                assert_eq!(values, expected, "{place} {along}");
            }
        }
    }

    #[test]
    fn what_is_light_is_compared_and_dark_objects_are_the_lighter_ones() {
        let picture = GrayImage::from_fn(4, 4, |x, _| image::Luma([50 * x as u8]));
        let ground = GrayImage::from_pixel(4, 4, image::Luma([100]));
        let sampler = |contrast, transfer, compared| {
            let source = EdgeSource { picture: &picture, compared, contrast, transfer, along: 0.0 };
            Sampler::new(&source, &[Point2::new(2.0, 1.0)])
        };
        let dark = sampler(Contrast::DarkOnLight, Transfer::Linear, None);
        assert_eq!([0, 1, 2, 3].map(|pixel| dark.signal(pixel)), [255.0, 205.0, 155.0, 105.0]);
        let light = Transfer::Srgb.light();
        let dark = sampler(Contrast::DarkOnLight, Transfer::Srgb, None);
        let step = dark.signal(1) - dark.signal(3);
        assert!((step - (light[150] - light[50]) / Transfer::Srgb.slope(100.0)).abs() < 1e-9, "{step}");
        for (difference, sign) in [(Difference::Either, 1.0), (Difference::Lighter, 1.0), (Difference::Darker, 0.0)] {
            let compared = Compared { picture: &picture, ground: &ground, difference };
            let of = sampler(Contrast::LightOnDark, Transfer::Srgb, Some(compared)).signal(3);
            assert!((of - sign * (light[150] - light[100]) / Transfer::Srgb.slope(100.0)).abs() < 1e-9, "{of}");
        }
    }
}
