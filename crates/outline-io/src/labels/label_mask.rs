//! The outlines of the objects of one label mask.
use std::collections::BTreeMap;

use image::{GrayImage, Luma};

use crate::picture_file::error::TraceError;
use crate::tracing::field::{Field, blur_reach};
use crate::tracing::object_mask::Objects;
use crate::tracing::settings::{MASK_SIGMA, Smoothing, TraceSettings};
use crate::tracing::trace::{TracedOutline, Window};

/// Grey value of the pixels of an object in its window.
const SET: u8 = 255;

/// Labels of a mask from which on grey values are suspected, and the mean length of their runs in pixels below which most of them have to
/// be. Grey values change from pixel to pixel, at a smoothed edge or in noise; labels of objects do not.
const MANY_LABELS: usize = 16;
pub(crate) const SHORT_RUN: usize = 2;

/// A labelled mask, as segmentation programs give it: every pixel holds the label of the object that it belongs to, 0 or less for the
/// ground.
#[derive(Debug, Clone, Copy)]
pub struct LabelMask<'a> {
    labels: &'a [i64],
    width: usize,
    height: usize,
}

/// An object of a [`LabelMask`].
#[derive(Debug)]
pub struct TracedLabel {
    /// Its label.
    pub label: i64,
    /// The outline of its largest part, or what is wrong with it.
    pub outline: Result<TracedOutline, TraceError>,
    /// Pixels of its next largest part of at least the smallest area, which is left out; 0 if there is none.
    pub next_part: u64,
}

/// Half-open bounds of the pixels of a label, and how they lie.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    left: usize,
    right: usize,
    top: usize,
    bottom: usize,
    pixels: usize,
    /// Runs of pixels that follow each other in a row.
    runs: usize,
}

impl<'a> LabelMask<'a> {
    /// Of labels row by row from the top, `width * height` of them.
    ///
    /// # Errors
    /// No pixel, more than `u32::MAX` in a row or column, or a number of labels other than `width * height`.
    pub fn new(labels: &'a [i64], width: usize, height: usize) -> Result<Self, TraceError> {
        let fits = [width, height].iter().all(|side| u32::try_from(*side).is_ok());
        if labels.is_empty() || !fits || width.checked_mul(height) != Some(labels.len()) {
            return Err(TraceError::NoPixels);
        }
        Ok(Self { labels, width, height })
    }

    /// Columns and rows.
    #[must_use]
    pub fn dimensions(&self) -> (u32, u32) {
        // As many as [`new`](Self::new) takes.
        (self.width as u32, self.height as u32)
    }

    /// Traces the outer outline of every label, in increasing order of the labels, to a fraction of a pixel; of a label in several parts,
    /// that of the largest. Outlines and settings are those of [`trace_mask`](crate::trace_mask) for a mask of two values; contrast,
    /// threshold and ring are not looked at. The smallest area is that of the largest part.
    ///
    /// ```
    /// use freeform_outline_io::{LabelMask, TraceSettings};
    ///
    /// // A square of 10 by 10 pixels with the label 7, the upper left one at column 5 and row 8.
    /// let labels: Vec<i64> = (0..30 * 40).map(|i| if (5..15).contains(&(i % 40)) && (8..18).contains(&(i / 40)) { 7 } else { 0 }).collect();
    /// let outlines = LabelMask::new(&labels, 40, 30)?.trace(&TraceSettings::default())?;
    /// let centre = outlines[0].outline.as_ref().expect("a square").centre;
    /// assert_eq!(outlines[0].label, 7);
    /// assert!((centre - nalgebra::Point2::new(10.0, 30.0 - 13.0)).norm() < 1e-3);
    /// # Ok::<(), freeform_outline_io::TraceError>(())
    /// ```
    ///
    /// # Errors
    /// A setting out of range, and grey values in place of labels. What is wrong with the outline of one label stands in its place.
    pub fn trace(&self, settings: &TraceSettings) -> Result<Vec<TracedLabel>, TraceError> {
        settings.check()?;
        let bounds = self.bounds();
        let labels = bounds.len();
        let scattered = bounds.values().filter(|bounds| bounds.pixels < SHORT_RUN * bounds.runs).count();
        if labels >= MANY_LABELS && 2 * scattered > labels {
            return Err(TraceError::GreyValues { scattered, labels });
        }
        Ok(bounds.into_iter().map(|(label, bounds)| self.trace_one(label, bounds, settings, labels)).collect())
    }

    fn bounds(&self) -> BTreeMap<i64, Bounds> {
        let mut all = BTreeMap::new();
        for (row, labels) in self.labels.chunks_exact(self.width).enumerate() {
            let mut column = 0;
            for run in labels.chunk_by(|a, b| a == b) {
                let (left, right) = (column, column + run.len());
                column = right;
                if run[0] > 0 {
                    let found = all.entry(run[0]).or_insert(Bounds {
                        left,
                        right,
                        top: row,
                        bottom: row + 1,
                        pixels: 0,
                        runs: 0,
                    });
                    found.left = found.left.min(left);
                    found.right = found.right.max(right);
                    found.bottom = row + 1;
                    found.pixels += run.len();
                    found.runs += 1;
                }
            }
        }
        all
    }

    fn trace_one(&self, label: i64, bounds: Bounds, settings: &TraceSettings, object_count: usize) -> TracedLabel {
        let sigma = match settings.smoothing {
            Smoothing::Automatic => MASK_SIGMA,
            Smoothing::Gaussian(sigma) => sigma,
        };
        // As far around the object as smoothing reaches.
        let margin = blur_reach(sigma) + 2;
        let (left, top) = (bounds.left.saturating_sub(margin), bounds.top.saturating_sub(margin));
        let (right, bottom) = ((bounds.right + margin).min(self.width), (bounds.bottom + margin).min(self.height));
        let is_set = |x: u32, y: u32| self.labels[(top + y as usize) * self.width + left + x as usize] == label;
        let part = GrayImage::from_fn((right - left) as u32, (bottom - top) as u32, |x, y| {
            Luma([if is_set(x, y) { SET } else { 0 }])
        });
        let parts = match Objects::of(&part, |value| value == SET, settings.minimum_area, 2) {
            Ok(parts) => parts,
            Err(error) => return TracedLabel { label, outline: Err(error), next_part: 0 },
        };
        let next_part = parts.pixel_counts().nth(1).unwrap_or(0);
        let of_largest = || {
            let mask = parts.into_masks(margin).next().ok_or(TraceError::NoPixels)?;
            let values = mask.filled.iter().map(|filled| f32::from(u8::from(*filled))).collect();
            let mut field = Field { width: mask.width, height: mask.height, values };
            if sigma > 0.0 {
                field.blur(sigma);
            }
            let window = Window { left: left + mask.left, top: top + mask.top, field: &field, level: 0.5, edges: None };
            // Labels are those of the whole picture.
            let settings = TraceSettings { margins: None, ..*settings };
            let seen = window.outline(self.height as u32, &settings)?.ok_or(TraceError::SmoothedAway { sigma })?;
            Ok(seen.traced(mask.pixel_count, object_count, 0.5))
        };
        TracedLabel { label, outline: of_largest(), next_part }
    }
}
