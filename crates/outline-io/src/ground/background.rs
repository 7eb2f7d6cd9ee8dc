//! The ground as a picture, given or the median of pictures, and differences from it.
use std::collections::VecDeque;
use std::sync::Arc;

use image::GrayImage;

/// Part of the pictures kept that is replaced before the median is computed again.
const RENEWED_SHARE: usize = 5;

/// Pixels of all pictures kept for the median.
const PIXELS_KEPT: u64 = 1 << 28;

/// Pixels whose medians are taken side by side: some registers full.
const SIDE_BY_SIDE: usize = 64;

/// Most pictures of which they are: the work grows with the square of their number.
const MOST_SIDE_BY_SIDE: usize = 96;

/// Fewest pictures that a median is taken of.
const FEWEST_KEPT: usize = 3;

/// What pictures are compared with, so that only what moves in front of it is an object.
#[derive(Debug, Clone, PartialEq)]
pub enum Background {
    /// A picture of the ground without objects.
    Picture(Arc<GrayImage>),
    /// The median of so many pictures, 3 to 255: first of those at the beginning, which are read ahead, then of the latest. Of
    /// fewer where they have more than 2^28 pixels together, but of 3 at least.
    RunningMedian(usize),
    /// A surface of the second degree through the grey values of the ground of each picture itself: light that is uneven.
    Surface,
}

/// Which differences from the background belong to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Difference {
    /// Lighter or darker.
    #[default]
    Either,
    /// Lighter.
    Lighter,
    /// Darker.
    Darker,
}

/// The median of pictures of one size, pixel by pixel; `None` of none.
#[must_use]
pub fn median_picture(pictures: &[Arc<GrayImage>]) -> Option<Arc<GrayImage>> {
    let mut median = RunningMedian::new(pictures.len());
    pictures.iter().for_each(|picture| median.add(picture));
    median.taken()
}

impl Difference {
    /// How far a value differs from that of the ground.
    #[inline]
    pub(crate) fn of_values(self, value: f64, ground: f64) -> f64 {
        match self {
            Self::Either => (value - ground).abs(),
            Self::Lighter => (value - ground).max(0.0),
            Self::Darker => (ground - value).max(0.0),
        }
    }

    /// How far each pixel differs from the background; both of one size.
    pub(crate) fn of(self, picture: &GrayImage, background: &GrayImage) -> GrayImage {
        let mut difference = picture.clone();
        for (value, ground) in difference.iter_mut().zip(background.as_raw()) {
            *value = match self {
                Self::Either => value.abs_diff(*ground),
                Self::Lighter => value.saturating_sub(*ground),
                Self::Darker => ground.saturating_sub(*value),
            };
        }
        difference
    }
}

/// The median of pictures, pixel by pixel; of an even number the upper one of the two in the middle.
fn medians(pictures: &[&[u8]], medians: &mut [u8]) {
    let middle = pictures.len() / 2;
    if pictures.len() > MOST_SIDE_BY_SIDE {
        let mut values = vec![0; pictures.len()];
        for (index, median) in medians.iter_mut().enumerate() {
            values.iter_mut().zip(pictures).for_each(|(value, picture)| *value = picture[index]);
            *median = *values.select_nth_unstable(middle).1;
        }
        return;
    }
    // The smallest values are brought to the front one after the other, up to the middle, of many pixels at once.
    let mut values = vec![[0; SIDE_BY_SIDE]; pictures.len()];
    for (block, medians) in medians.chunks_mut(SIDE_BY_SIDE).enumerate() {
        let (start, count) = (block * SIDE_BY_SIDE, medians.len());
        for (values, picture) in values.iter_mut().zip(pictures) {
            values[..count].copy_from_slice(&picture[start..start + count]);
        }
        for place in 0..=middle {
            let (front, behind) = values.split_at_mut(place + 1);
            for other in behind {
                sort_pairs(&mut front[place], other);
            }
        }
        medians.copy_from_slice(&values[middle][..count]);
    }
}

/// Puts the smaller value of each pair into the first array.
fn sort_pairs(first: &mut [u8; SIDE_BY_SIDE], second: &mut [u8; SIDE_BY_SIDE]) {
    for (a, b) in first.iter_mut().zip(second) {
        (*a, *b) = ((*a).min(*b), (*a).max(*b));
    }
}

/// The median of the latest pictures, pixel by pixel.
#[derive(Debug)]
pub(crate) struct RunningMedian {
    size: usize,
    latest: VecDeque<Arc<GrayImage>>,
    median: Option<Arc<GrayImage>>,
    /// Pictures added since the median was taken.
    added: usize,
}

impl RunningMedian {
    pub(crate) fn new(size: usize) -> Self {
        Self { size, latest: VecDeque::new(), median: None, added: 0 }
    }

    /// How many pictures of this size are kept: fewer of large ones, so that they fit in the memory.
    pub(crate) fn kept(size: usize, picture: &GrayImage) -> usize {
        let pixels = (picture.as_raw().len() as u64).max(1);
        size.min(usize::try_from(PIXELS_KEPT / pixels).unwrap_or(usize::MAX).max(FEWEST_KEPT))
    }

    pub(crate) fn add(&mut self, picture: &Arc<GrayImage>) {
        if self.latest.front().is_some_and(|first| first.dimensions() != picture.dimensions()) {
            // The median of pictures of different sizes is none.
            self.latest.clear();
            self.median = None;
        }
        self.added += 1;
        while self.latest.len() >= Self::kept(self.size, picture) {
            self.latest.pop_front();
        }
        self.latest.push_back(Arc::clone(picture));
    }

    /// The median; `None` before the first picture.
    pub(crate) fn get(&mut self) -> Option<&Arc<GrayImage>> {
        if self.median.is_none() || RENEWED_SHARE * self.added >= self.size {
            self.median = self.taken();
            self.added = 0;
        }
        self.median.as_ref()
    }

    pub(crate) fn taken(&self) -> Option<Arc<GrayImage>> {
        let first = self.latest.front()?;
        if self.latest.iter().all(|picture| Arc::ptr_eq(picture, first)) {
            return Some(Arc::clone(first));
        }
        let mut median = GrayImage::clone(first);
        let pictures: Vec<&[u8]> = self.latest.iter().map(|picture| picture.as_raw().as_slice()).collect();
        medians(&pictures, &mut median);
        Some(Arc::new(median))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_median_has_as_many_values_below_it_whatever_the_number_of_pictures_and_pixels(
            count in prop_oneof![1..30_usize, 90..100_usize],
            pixels in prop_oneof![1..70_usize, Just(64), Just(128)],
            seed in any::<u32>(),
        ) {
            let value = |k: usize, p: usize| ((k * 7919 + p * 104_729) as u32 ^ seed).wrapping_mul(2_654_435_761).to_be_bytes()[0];
            let pictures: Vec<Vec<u8>> =
                (0..count).map(|k| (0..pixels).map(|p| value(k, p)).collect()).collect();
            let slices: Vec<&[u8]> = pictures.iter().map(Vec::as_slice).collect();
            let mut found = vec![0; pixels];
            medians(&slices, &mut found);
            for (pixel, median) in found.iter().enumerate() {
                let mut values: Vec<u8> = pictures.iter().map(|picture| picture[pixel]).collect();
                values.sort_unstable();
                prop_assert_eq!(*median, values[count / 2]);
            }
        }
    }
}
