//! One object of a picture, in a window around it.
use image::GrayImage;

use crate::picture_file::error::TraceError;
use crate::tracing::connected_components::{Components, Connectivity, Run};

/// An object of a picture in a window around it.
#[derive(Debug)]
pub(crate) struct ObjectMask {
    /// First column of the window.
    pub(crate) left: usize,
    /// First row of the window.
    pub(crate) top: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Row by row, whether a pixel of the window belongs to the object or to a hole in it.
    pub(crate) filled: Vec<bool>,
    /// Pixels of the object, without its holes.
    pub(crate) pixel_count: u64,
}

/// Windows of the objects of a picture have no more pixels than this together: twice those of the largest picture. Of a picture of up to
/// half a million pixels that is never reached; of larger ones only by objects that lie within each other, such as rings, which windows would hold
/// many times.
const WINDOW_LIMIT: usize = 1 << 27;

/// The largest objects of a picture: 8-connected sets of pixels.
#[derive(Debug)]
pub(crate) struct Objects {
    /// Number of all objects, also of those that were not asked for.
    pub(crate) count: usize,
    /// Pixels and runs of each, the largest first.
    largest: Vec<(u64, Vec<Run>)>,
    columns: usize,
    rows: usize,
}

impl Objects {
    /// Finds the objects of at least the smallest area among those that the pixels with `set(value)` form, which are all from one grey value to
    /// another; the upper one first where several have the same size. Keeps up to `limit` of them.
    pub(crate) fn of(
        picture: &GrayImage,
        set: impl Fn(u8) -> bool,
        minimum_area: u64,
        limit: usize,
    ) -> Result<Self, TraceError> {
        let (columns, rows) = (picture.width() as usize, picture.height() as usize);
        let pixels = picture.as_raw();
        let set = ValueRange::of(set);
        let components = Components::of_rows(columns, rows, Connectivity::Eight, |row, is_set| {
            let of_row = &pixels[row * columns..(row + 1) * columns];
            is_set.iter_mut().zip(of_row).for_each(|(is_set, value)| *is_set = u8::from(set.has(*value)));
        });
        let (mut sizes, mut largest) = (Vec::new(), 0);
        for (root, count) in components.pixel_counts() {
            largest = largest.max(count);
            if count >= minimum_area {
                sizes.push((root, count));
            }
        }
        if sizes.is_empty() && largest > 0 {
            return Err(TraceError::TooSmall { pixels: largest, needed: minimum_area });
        }
        let count = sizes.len();
        sizes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        sizes.truncate(limit);
        let roots: Vec<u32> = sizes.iter().map(|(root, _)| *root).collect();
        let runs = components.into_runs_of(&roots);
        let largest = sizes.into_iter().map(|(_, count)| count).zip(runs).collect();
        Ok(Self { count, largest, columns, rows })
    }

    /// Pixels of each of those that were asked for, the largest first.
    pub(crate) fn pixel_counts(&self) -> impl Iterator<Item = u64> {
        self.largest.iter().map(|(pixels, _)| *pixels)
    }

    /// The objects, each in a window that reaches `margin` pixels beyond it, as far as the picture goes.
    pub(crate) fn into_masks(self, margin: usize) -> impl Iterator<Item = ObjectMask> {
        let Self { largest, columns, rows, .. } = self;
        let mut left_over = WINDOW_LIMIT;
        largest.into_iter().map_while(move |(pixel_count, runs)| {
            let bounds = Bounds::of(runs.iter().copied());
            let left = bounds.left.saturating_sub(margin);
            let top = bounds.top.saturating_sub(margin);
            let width = (bounds.right + margin).min(columns) - left;
            let height = (bounds.bottom + margin).min(rows) - top;
            left_over = left_over.checked_sub(width * height)?;
            let mut filled = vec![false; width * height];
            for run in runs {
                let (from, columns) = ((run.row() - top) * width, run.columns());
                filled[from + columns.start - left..from + columns.end - left].fill(true);
            }
            fill_holes(&mut filled, width, height);
            Some(ObjectMask { left, top, width, height, filled, pixel_count })
        })
    }
}

/// Grey values from one to another, which are told without a table: many pixels side by side.
#[derive(Debug, Clone, Copy)]
struct ValueRange {
    lowest: u8,
    /// How many there are after the lowest; `None` where there is no value at all.
    more: Option<u8>,
}

impl ValueRange {
    /// From the lowest to the highest of the values that are set, all of which must be, as those beyond a threshold are.
    fn of(set: impl Fn(u8) -> bool) -> Self {
        let lowest = (0..=u8::MAX).find(|value| set(*value));
        let highest = (0..=u8::MAX).rfind(|value| set(*value));
        let bounds = lowest.zip(highest);
        debug_assert!(
            bounds.is_none_or(|(lowest, highest)| (lowest..=highest).all(set)),
            "values between others are not set"
        );
        Self { lowest: lowest.unwrap_or(0), more: bounds.map(|(lowest, highest)| highest - lowest) }
    }

    #[inline(always)]
    fn has(self, value: u8) -> bool {
        self.more.is_some_and(|more| value.wrapping_sub(self.lowest) <= more)
    }
}

/// Half-open bounds of the pixels of an object.
struct Bounds {
    left: usize,
    right: usize,
    top: usize,
    bottom: usize,
}

impl Bounds {
    fn of(runs: impl Iterator<Item = Run>) -> Self {
        let none = Self { left: usize::MAX, right: 0, top: usize::MAX, bottom: 0 };
        runs.fold(none, |bounds, run| Self {
            left: bounds.left.min(run.columns().start),
            right: bounds.right.max(run.columns().end),
            top: bounds.top.min(run.row()),
            bottom: bounds.bottom.max(run.row() + 1),
        })
    }
}

/// Fills what is not connected, over edges, with the outside of the window.
pub(crate) fn fill_holes(filled: &mut [bool], width: usize, height: usize) {
    // One more pixel of ground all round, so that the outside is one component and its first run the first of all.
    let ground = Components::of_rows(width + 2, height + 2, Connectivity::Four, |row, is_ground| {
        is_ground.fill(1);
        if (1..=height).contains(&row) {
            let of_row = &filled[(row - 1) * width..row * width];
            is_ground[1..=width].iter_mut().zip(of_row).for_each(|(is_ground, filled)| *is_ground = u8::from(!filled));
        }
    });
    for run in ground.runs_but_first() {
        let (from, columns) = ((run.row() - 1) * width, run.columns());
        filled[from + columns.start - 1..from + columns.end - 1].fill(true);
    }
}
