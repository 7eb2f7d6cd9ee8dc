use std::collections::VecDeque;

use image::GrayImage;

/// Part of the pictures kept that is replaced before the median is computed again.
const RENEWED_SHARE: usize = 5;

/// What pictures are compared with, so that only what moves in front of it is an object.
#[derive(Debug, Clone, PartialEq)]
pub enum Background {
    /// A picture of the ground without objects.
    Picture(GrayImage),
    /// The median of so many pictures, 3 to 255: first of those at the beginning, which are read ahead, then of the latest.
    RunningMedian(usize),
}

/// Which differences from the background belong to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Difference {
    /// Lighter or darker.
    #[default]
    Either,
    /// Lighter.
    Lighter,
    /// Darker.
    Darker,
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
    latest: VecDeque<GrayImage>,
    median: Option<GrayImage>,
    /// Pictures added since the median was taken.
    added: usize,
}

impl RunningMedian {
    pub(crate) fn new(size: usize) -> Self {
        Self { size, latest: VecDeque::new(), median: None, added: 0 }
    }

    pub(crate) fn add(&mut self, picture: &GrayImage) {
        if self.latest.front().is_some_and(|first| first.dimensions() != picture.dimensions()) {
            // The median of pictures of different sizes is none.
            self.latest.clear();
            self.median = None;
        }
        self.added += 1;
        let oldest = if self.latest.len() == self.size { self.latest.pop_front() } else { None };
        match oldest {
            Some(mut oldest) => {
                oldest.copy_from_slice(picture);
                self.latest.push_back(oldest);
            }
            None => self.latest.push_back(picture.clone()),
        }
    }

    /// The median; `None` before the first picture.
    pub(crate) fn get(&mut self) -> Option<&GrayImage> {
        if self.median.is_none() || RENEWED_SHARE * self.added >= self.size {
            self.median = self.taken();
            self.added = 0;
        }
        self.median.as_ref()
    }

    fn taken(&self) -> Option<GrayImage> {
        let mut median = self.latest.front()?.clone();
        let pictures: Vec<&[u8]> = self.latest.iter().map(|picture| picture.as_raw().as_slice()).collect();
        let mut values = vec![0; pictures.len()];
        for (index, pixel) in median.iter_mut().enumerate() {
            values.iter_mut().zip(&pictures).for_each(|(value, picture)| *value = picture[index]);
            let middle = values.len() / 2;
            *pixel = *values.select_nth_unstable(middle).1;
        }
        Some(median)
    }
}
