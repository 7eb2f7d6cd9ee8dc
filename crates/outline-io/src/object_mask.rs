use image::GrayImage;

use crate::picture_error::TraceError;
use crate::segment::{Components, Connectivity, Run};

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

/// The objects of a picture: 8-connected sets of pixels.
#[derive(Debug)]
pub(crate) struct Objects {
    components: Components,
    /// First run and pixels of each, the largest first.
    sizes: Vec<(usize, u64)>,
    columns: usize,
    rows: usize,
}

impl Objects {
    /// Finds the objects of at least the smallest area among those that the pixels with `set(value)` form; the upper one
    /// first where several have the same size.
    pub(crate) fn of(picture: &GrayImage, set: impl Fn(u8) -> bool, minimum_area: u64) -> Result<Self, TraceError> {
        let (columns, rows) = (picture.width() as usize, picture.height() as usize);
        let pixels = picture.as_raw();
        let is_set = |column: usize, row: usize| set(pixels[row * columns + column]);
        let components = Components::of(columns, rows, Connectivity::Eight, is_set);
        let mut sizes = components.pixel_counts();
        sizes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        if let Some((_, pixels)) = sizes.first().filter(|(_, count)| *count < minimum_area) {
            return Err(TraceError::TooSmall { pixels: *pixels, needed: minimum_area });
        }
        sizes.retain(|(_, count)| *count >= minimum_area);
        Ok(Self { components, sizes, columns, rows })
    }

    /// Number of objects.
    pub(crate) fn count(&self) -> usize {
        self.sizes.len()
    }

    /// The objects, each in a window that reaches `margin` pixels beyond it, as far as the picture goes.
    pub(crate) fn masks(&self, margin: usize) -> impl Iterator<Item = ObjectMask> + '_ {
        self.sizes.iter().map(move |&(root, pixel_count)| {
            let bounds = Bounds::of(self.components.runs_of(root));
            let left = bounds.left.saturating_sub(margin);
            let top = bounds.top.saturating_sub(margin);
            let width = (bounds.right + margin).min(self.columns) - left;
            let height = (bounds.bottom + margin).min(self.rows) - top;
            let mut filled = vec![false; width * height];
            for run in self.components.runs_of(root) {
                let from = (run.row - top) * width;
                filled[from + run.start - left..from + run.end - left].fill(true);
            }
            fill_holes(&mut filled, width, height);
            ObjectMask { left, top, width, height, filled, pixel_count }
        })
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
pub(crate) fn fill_holes(filled: &mut [bool], width: usize, height: usize) {
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
