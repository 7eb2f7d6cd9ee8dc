use image::GrayImage;

use crate::error::TraceError;
use crate::segment::{Components, Connectivity, Run};

/// The largest object of a picture in a window around it.
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
    /// Objects of at least the smallest area.
    pub(crate) object_count: usize,
}

impl ObjectMask {
    /// Finds the largest of the objects that the pixels with `set(value)` form; the upper one if several have the same
    /// size, none if there is none. The window reaches `margin` pixels beyond it, as far as the picture goes.
    pub(crate) fn largest(
        picture: &GrayImage,
        set: impl Fn(u8) -> bool,
        minimum_area: u64,
        margin: usize,
    ) -> Result<Option<Self>, TraceError> {
        let (columns, rows) = (picture.width() as usize, picture.height() as usize);
        let pixels = picture.as_raw();
        let is_set = |column: usize, row: usize| set(pixels[row * columns + column]);
        let components = Components::of(columns, rows, Connectivity::Eight, is_set);
        let counts = components.pixel_counts();
        let largest = counts.iter().copied().reduce(|best, next| if next.1 > best.1 { next } else { best });
        let Some((root, pixel_count)) = largest else { return Ok(None) };
        if pixel_count < minimum_area {
            return Err(TraceError::TooSmall { pixels: pixel_count, needed: minimum_area });
        }
        let object_count = counts.iter().filter(|(_, count)| *count >= minimum_area).count();

        let bounds = Bounds::of(components.runs_of(root));
        let left = bounds.left.saturating_sub(margin);
        let top = bounds.top.saturating_sub(margin);
        let width = (bounds.right + margin).min(columns) - left;
        let height = (bounds.bottom + margin).min(rows) - top;
        let mut filled = vec![false; width * height];
        for run in components.runs_of(root) {
            let from = (run.row - top) * width;
            filled[from + run.start - left..from + run.end - left].fill(true);
        }
        fill_holes(&mut filled, width, height);
        Ok(Some(Self { left, top, width, height, filled, pixel_count, object_count }))
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
            left: bounds.left.min(run.start),
            right: bounds.right.max(run.end),
            top: bounds.top.min(run.row),
            bottom: bounds.bottom.max(run.row + 1),
        })
    }
}

/// Fills what is not connected, over edges, with the outside of the window.
fn fill_holes(filled: &mut [bool], width: usize, height: usize) {
    // One more pixel of ground all round, so that the outside is one component and its first run the first of all.
    let is_ground = |column: usize, row: usize| {
        let within = (1..=width).contains(&column) && (1..=height).contains(&row);
        !within || !filled[(row - 1) * width + column - 1]
    };
    let ground = Components::of(width + 2, height + 2, Connectivity::Four, is_ground);
    for run in ground.runs_not_of(0) {
        let from = (run.row - 1) * width;
        filled[from + run.start - 1..from + run.end - 1].fill(true);
    }
}
