//! Objects with a line of other grey values around them.
use image::GrayImage;

use crate::picture_file::error::TraceError;
use crate::tracing::basins::{Basin, basins};
use crate::tracing::contrast::{Contrast, signal};
use crate::tracing::field::Field;
use crate::tracing::morphology::{dilated, eroded, opened};
use crate::tracing::object_mask::fill_holes;

/// Widest ring expected where none is given, as a share of the shorter side of the picture.
const WIDTH_SHARE: f64 = 1.0 / 60.0;

/// Smallest value of that width, in pixels.
const LEAST_WIDTH: f64 = 4.0;

/// Standard deviation of the smoothing before rings are looked for where none is given, in pixels.
pub(crate) const SIGMA: f64 = 1.0;

/// A ring stands out where its weakest point is so many times as strong as the median of the picture.
const STANDS_OUT: f32 = 2.0;

/// Largest number of pixels of a picture that rings are looked for in: about 40 bytes a pixel are needed.
const PIXEL_LIMIT: u64 = 1 << 25;

/// Rings of at least this share of the score of the clearest one are objects too.
const CLEAR_SHARE: f64 = 0.5;

/// Of an object at the edge of the picture, the edge makes no more than this share of the contour: the ground that an
/// object cuts off has more.
const EDGE_SHARE: f64 = 0.6;

/// A line around an object that otherwise looks like the background.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ring {
    /// Whether the line is lighter or darker than the ground and the object.
    pub contrast: Contrast,
    /// Widest line expected in pixels, 1 to 100; `None` for a sixtieth of the shorter side of the picture, at least 4.
    pub width: Option<f64>,
}

/// What a ring closes in, in a window around it: 1 within, falling to 0 over the outer edge of the ring.
#[derive(Debug)]
pub(crate) struct RingObject {
    /// First column of the window.
    pub(crate) left: usize,
    /// First row of the window.
    pub(crate) top: usize,
    pub(crate) field: Field,
    /// Pixels of the object with its ring.
    pub(crate) pixel_count: u64,
}

impl Ring {
    /// Widest line expected in a picture of so many columns and rows, in pixels.
    #[must_use]
    pub fn widest(&self, columns: u32, rows: u32) -> f64 {
        self.width.unwrap_or_else(|| (WIDTH_SHARE * f64::from(columns.min(rows))).max(LEAST_WIDTH))
    }

    /// The objects with the clearest rings, the clearest first: those with the largest product of the strength of the
    /// weakest point of the ring and the root of the area that it closes in.
    ///
    /// The strength of a ring is how far it stands out from the ground within its width (a top-hat transform), so that
    /// neither the lightness of the picture nor that of a part of it matters, and no threshold is needed. A ring that the
    /// edge of the picture cuts is closed by the edge, if there is more ground than object. `sigma` is the standard deviation of the smoothing
    /// before, in pixels.
    pub(crate) fn objects(
        &self,
        picture: &GrayImage,
        smallest_area: u64,
        limit: usize,
        sigma: f64,
    ) -> Result<Vec<RingObject>, TraceError> {
        let (width, height) = picture.dimensions();
        if u64::from(width) * u64::from(height) > PIXEL_LIMIT {
            return Err(TraceError::TooLargeForRings { width, height, limit: PIXEL_LIMIT });
        }
        let reach = self.widest(width, height).ceil() as usize;
        let strength = self.strength(picture, reach, sigma);
        let median = median(&strength.values);
        let area = u32::try_from(smallest_area).unwrap_or(u32::MAX).max(1);
        let mut candidates = basins(&strength, area, STANDS_OUT * median);
        let score = |basin: &Basin| f64::from(basin.level) * f64::from(basin.area).sqrt();
        candidates.sort_by(|a, b| score(b).total_cmp(&score(a)));
        let mut taken = vec![false; strength.values.len()];
        let mut objects = Vec::new();
        let mut clearest = None;
        for basin in &candidates {
            let is_clear = clearest.is_none_or(|clearest| score(basin) >= CLEAR_SHARE * clearest);
            if objects.len() == limit || !is_clear {
                break;
            }
            if taken[basin.seed] {
                continue;
            }
            let within = flooded(basin, &strength, &mut taken);
            if basin.at_edge && edge_share(&within, &strength, &taken) > EDGE_SHARE {
                within.iter().for_each(|&index| taken[index] = false);
                continue;
            }
            clearest = clearest.or(Some(score(basin)));
            objects.push(around(basin, &within, &strength, reach));
        }
        if objects.is_empty() { Err(TraceError::NoRing) } else { Ok(objects) }
    }

    fn strength(&self, picture: &GrayImage, reach: usize, sigma: f64) -> Field {
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let values = picture.as_raw().iter().map(|value| f32::from(signal(*value, self.contrast))).collect();
        let mut lines = Field { width, height, values };
        if sigma > 0.0 {
            lines.blur(sigma);
        }
        let ground = opened(&lines, reach);
        lines.values.iter_mut().zip(&ground.values).for_each(|(line, ground)| *line -= ground);
        lines
    }
}

/// The object that a ring closes in. Its edge is where the strength falls to half of the largest nearby.
fn around(basin: &Basin, within: &[usize], strength: &Field, reach: usize) -> RingObject {
    let (columns, rows) = (strength.width, strength.height);
    let column = |index: &usize| index % columns;
    let row = |index: &usize| index / columns;
    let margin = 3 * reach + 2;
    let bounds = |of: &dyn Fn(&usize) -> usize, count: usize| {
        let (low, high) = within.iter().map(of).fold((usize::MAX, 0), |(l, h), v| (l.min(v), h.max(v)));
        (low.saturating_sub(margin), (high + 1 + margin).min(count))
    };
    let ((left, right), (top, bottom)) = (bounds(&column, columns), bounds(&row, rows));
    let (width, height) = (right - left, bottom - top);
    let rows_of = (top..bottom).flat_map(|row| &strength.values[row * columns + left..row * columns + right]);
    let local = Field { width, height, values: rows_of.copied().collect() };
    let strongest = dilated(&local, reach);
    let mut region = Field { width, height, values: vec![0.0; width * height] };
    within.iter().for_each(|index| region.values[(row(index) - top) * width + column(index) - left] = 1.0);
    let near = dilated(&region, reach + 1);
    climb(&mut region, &local, &near);

    let share = |index: usize| local.values[index] / strongest.values[index].max(f32::MIN_POSITIVE);
    let is_ring = |i: usize| near.values[i] > 0.0 && local.values[i] >= 0.5 * basin.level && share(i) >= 0.5;
    let mut filled: Vec<bool> = (0..width * height).map(|i| region.values[i] > 0.0 || is_ring(i)).collect();
    fill_holes(&mut filled, width, height);
    let ring = |i: usize| if near.values[i] > 0.0 { share(i) } else { 0.0 };
    let value = |i: usize| match (filled[i], is_ring(i)) {
        (true, true) => ring(i),
        (true, false) => 1.0,
        (false, _) => ring(i).min(0.49),
    };
    let pixel_count = filled.iter().filter(|filled| **filled).count() as u64;
    let mut field = Field { width, height, values: (0..width * height).map(value).collect() };
    // What is clearly within is not to be thinned by the fall of the strength towards it.
    let deep = eroded(&Field { width, height, values: filled.iter().map(|f| f32::from(u8::from(*f))).collect() }, 2);
    field.values.iter_mut().zip(&deep.values).filter(|(_, deep)| **deep > 0.0).for_each(|(value, _)| *value = 1.0);
    RingObject { left, top, field, pixel_count }
}

/// Adds to a region what is uphill from it, up to the crest of the ring: a basin ends where its weakest point overflows,
/// which is far below the crest elsewhere.
fn climb(region: &mut Field, strength: &Field, near: &Field) {
    let mut open: Vec<usize> = (0..region.values.len()).filter(|&index| region.values[index] > 0.0).collect();
    while let Some(index) = open.pop() {
        for next in strength.neighbours(index) {
            let is_uphill = strength.values[next] > strength.values[index];
            if is_uphill && near.values[next] > 0.0 && region.values[next] == 0.0 {
                region.values[next] = 1.0;
                open.push(next);
            }
        }
    }
}

/// Indices of the samples of a basin, which are marked as taken.
fn flooded(basin: &Basin, strength: &Field, taken: &mut [bool]) -> Vec<usize> {
    let mut within = vec![basin.seed];
    taken[basin.seed] = true;
    let mut next = 0;
    while let Some(&index) = within.get(next) {
        next += 1;
        for neighbour in strength.neighbours(index) {
            if strength.values[neighbour] < basin.level && !taken[neighbour] {
                taken[neighbour] = true;
                within.push(neighbour);
            }
        }
    }
    within
}

/// Share of the edge of the grid in the contour of a region whose samples are marked.
fn edge_share(within: &[usize], field: &Field, marked: &[bool]) -> f64 {
    let (mut edge, mut own) = (0.0_f64, 0.0);
    for &index in within {
        if field.is_at_edge(index) {
            edge += 1.0;
        } else if field.neighbours(index).any(|neighbour| !marked[neighbour]) {
            own += 1.0;
        }
    }
    edge / (edge + own).max(1.0)
}

/// Median of values that are not negative.
fn median(values: &[f32]) -> f32 {
    // Numbers that are not negative lie in the order of their bits.
    let mut sample: Vec<u32> = values.iter().step_by(1 + values.len() / 100_000).map(|value| value.to_bits()).collect();
    let middle = sample.len() / 2;
    if sample.is_empty() { 0.0 } else { f32::from_bits(*sample.select_nth_unstable(middle).1) }
}
