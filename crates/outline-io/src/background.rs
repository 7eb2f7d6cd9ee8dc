use std::collections::VecDeque;
use std::sync::Arc;

use image::GrayImage;

/// Part of the pictures kept that is replaced before the median is computed again.
const RENEWED_SHARE: usize = 5;

/// Pixels of all pictures kept for the median.
const PIXELS_KEPT: u64 = 1 << 28;

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
        let mut values = vec![0; pictures.len()];
        for (index, pixel) in median.iter_mut().enumerate() {
            values.iter_mut().zip(&pictures).for_each(|(value, picture)| *value = picture[index]);
            let middle = values.len() / 2;
            *pixel = *values.select_nth_unstable(middle).1;
        }
        Some(Arc::new(median))
    }
}
