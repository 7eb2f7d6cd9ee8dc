//! Bars around the picture proper.
use std::borrow::Cow;
use std::sync::Arc;

use image::{GenericImageView as _, GrayImage};

use crate::TraceError;

/// Grey values of a bar differ by no more than this from its middle one, as compression has it.
const EVEN: u8 = 8;

/// Beside a bar, this share of the pixels differs from it by more than [`OTHER`], in so many of eight pictures.
const ALONG: f64 = 0.8;
const OTHER: u8 = 16;
const OF_EIGHT: usize = 6;

/// Rows farther in, as many as a bar has at least, of which so large a share has its grey value in as many pictures, are of the same ground: bodies
/// on it hide less of it.
const GROUND: f64 = 0.6;

/// Fewest rows of a bar: fewer are the edge of a picture that has been scaled or filtered.
const FEWEST: u32 = 3;

/// Rows between a bar and the picture, where both are mixed.
const MIXED: u32 = 2;

/// What is left out at the sides of a picture, in pixels. Outlines keep the coordinates of the whole picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Margins {
    /// Columns at the left.
    pub left: u32,
    /// Rows above.
    pub top: u32,
    /// Columns at the right.
    pub right: u32,
    /// Rows below.
    pub bottom: u32,
}

impl Margins {
    /// Whether nothing is left out.
    #[must_use]
    pub fn are_none(self) -> bool {
        self == Self::default()
    }

    /// The even bars at the sides of pictures, as video has them that was fitted into another shape: of one grey value in all pictures, and
    /// beside it something else all along. None where a bar goes on into the picture, as between two pictures side by side: what is left of it
    /// would be taken for a body; nor where there is more of the same beyond what is beside it, as of a ground on which a line is painted. None in
    /// pictures of several sizes.
    #[must_use]
    pub fn of_bars(pictures: &[Arc<GrayImage>]) -> Self {
        let Some((columns, rows)) = pictures.first().map(|picture| picture.dimensions()) else {
            return Self::default();
        };
        if pictures.iter().any(|picture| picture.dimensions() != (columns, rows)) {
            return Self::default();
        }
        let sides = || {
            let top = bar(pictures, (rows, columns), |row, column| (column, row))?;
            let bottom = bar(pictures, (rows, columns), |row, column| (column, rows - 1 - row))?;
            // The bars above and below take nothing from those at the sides.
            let height = rows.saturating_sub(top + bottom);
            let left = bar(pictures, (columns, height), |column, row| (column, top + row))?;
            let right = bar(pictures, (columns, height), |column, row| (columns - 1 - column, top + row))?;
            Some(Self { left, top, right, bottom })
        };
        sides().unwrap_or_default()
    }

    /// The same in pictures of which so many pixels are one along rows and columns, and more rather than less.
    pub(crate) fn scaled(self, factor: u32) -> Self {
        let of = |pixels: u32| pixels.div_ceil(factor);
        Self { left: of(self.left), top: of(self.top), right: of(self.right), bottom: of(self.bottom) }
    }

    /// As many times as large.
    pub(crate) fn times(self, factor: u32) -> Self {
        let of = |pixels: u32| pixels * factor;
        Self { left: of(self.left), top: of(self.top), right: of(self.right), bottom: of(self.bottom) }
    }

    /// What is left of a picture.
    ///
    /// # Errors
    /// [`TraceError::NothingLeft`].
    pub(crate) fn within(self, picture: &GrayImage) -> Result<Cow<'_, GrayImage>, TraceError> {
        let (columns, rows) = picture.dimensions();
        if self.are_none() {
            return Ok(Cow::Borrowed(picture));
        }
        let (across, down) = (self.left.saturating_add(self.right), self.top.saturating_add(self.bottom));
        if across >= columns || down >= rows {
            return Err(TraceError::NothingLeft { margins: self, columns, rows });
        }
        Ok(Cow::Owned(picture.view(self.left, self.top, columns - across, rows - down).to_image()))
    }
}

/// Rows of an even bar at the first side of pictures with so many rows and columns, whose pixels `at` gives by row and column; 0 where there
/// is no bar, `None` where it goes on into the picture.
fn bar(pictures: &[Arc<GrayImage>], (rows, columns): (u32, u32), at: impl Fn(u32, u32) -> (u32, u32)) -> Option<u32> {
    if columns == 0 || rows < 2 * (FEWEST + MIXED) {
        return Some(0);
    }
    let grey = |picture: &GrayImage, row: u32, column: u32| {
        let (x, y) = at(row, column);
        picture.get_pixel(x, y).0[0]
    };
    let level = grey(&pictures[0], 0, columns / 2);
    let differs = |picture: &GrayImage, row: u32, by: u8| {
        (0..columns).filter(|&column| grey(picture, row, column).abs_diff(level) > by).count()
    };
    let is_even = |row: &u32| pictures.iter().all(|picture| differs(picture, *row, EVEN) == 0);
    let even = (0..rows / 2).take_while(is_even).count() as u32;
    let beside = even + MIXED;
    if even < FEWEST || beside >= rows / 2 {
        return Some(0);
    }
    let ends = |picture: &&Arc<GrayImage>| differs(picture, beside, OTHER) as f64 >= ALONG * f64::from(columns);
    let are_most = |count: usize| 8 * count >= OF_EIGHT * pictures.len();
    let goes_on = |row: u32| {
        let is_ground =
            |picture: &&Arc<GrayImage>| differs(picture, row, EVEN) as f64 <= (1.0 - GROUND) * f64::from(columns);
        are_most(pictures.iter().filter(is_ground).count())
    };
    if !are_most(pictures.iter().filter(ends).count()) || has_run((beside..rows / 2).map(goes_on)) {
        return Some(0);
    }
    // But for those at the ends, which are of other bars.
    let is_bar = |column: &u32| pictures.iter().all(|picture| grey(picture, beside, *column).abs_diff(level) <= EVEN);
    let first = (0..columns).find(|column| !is_bar(column))?;
    let last = (0..columns).rev().find(|column| !is_bar(column))?;
    if (first..last).any(|column| is_bar(&column)) { None } else { Some(beside) }
}

/// Whether as many in a row are true as a bar has rows at least.
fn has_run(mut rows: impl Iterator<Item = bool>) -> bool {
    let mut run = 0;
    rows.any(|is_true| {
        run = if is_true { run + 1 } else { 0 };
        run >= FEWEST
    })
}
