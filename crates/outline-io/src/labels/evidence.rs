//! Whether pictures are label masks.
use std::collections::BTreeMap;

use crate::labels::label_mask::SHORT_RUN;
use crate::labels::pictures::{LabelPicture, Numbering};

/// Share of the pixels beside the ground that may have scattered values: labels may be slivers where they leave the picture. Of a smoothed body of
/// 300 pixels across a hundredth lies on its edge.
const MOST_SCATTERED: f64 = 0.005;

/// Pixels by which noise is told from labels.
const ENOUGH_PIXELS: usize = 4096;

/// Labels are counted from 1: the largest is up to this, or up to so many times their number, as of some the objects have left.
pub(crate) const LARGEST_NUMBER: i64 = 32;
const LARGEST_PER_LABEL: i64 = 4;

/// What speaks for it that pictures are label masks: their ground is 0, other values fill areas of them, and most pictures show two of them at least,
/// or borders that are marked as void go around all of them. A body whose grey value changes from picture to picture shows one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelEvidence {
    /// Different labels in the pictures that were looked at, two at least where no borders are marked as void.
    pub labels: usize,
    /// Whether they are small numbers, as labels are and grey values hardly ever. Places in a palette are small in drawings too, and count only in
    /// that of PASCAL VOC.
    pub are_numbers: bool,
    /// Whether every label borders on the ground with half of its edge or more: a mark on a body does not.
    pub are_on_ground: bool,
}

impl LabelEvidence {
    /// Whether every label is an object beyond doubt: small numbers, none of which is a mark on a body. Flat grey values that are apart may be a body
    /// and a time stamp.
    #[must_use]
    pub const fn is_convincing(&self) -> bool {
        self.are_numbers && self.are_on_ground
    }

    /// Looks at pictures; `None` where one of them is no label mask, or there are less than two labels, unless their borders are marked as void.
    pub(crate) fn of(pictures: impl IntoIterator<Item = Option<LabelPicture>>) -> Option<Self> {
        let mut all: BTreeMap<i64, Border> = BTreeMap::new();
        let (mut with_labels, mut with_several, mut with_void) = (0_usize, 0, 0);
        let (mut has_own_palette, mut are_of_voc) = (false, true);
        for picture in pictures {
            let picture = picture?;
            has_own_palette |= picture.numbering == Numbering::OwnPalette;
            let found = borders(&picture)?;
            with_labels += usize::from(!found.is_empty());
            with_several += usize::from(found.len() >= 2);
            if !found.is_empty() {
                with_void += usize::from(picture.had_void);
                are_of_voc &= picture.numbering == Numbering::Voc;
            }
            for (label, border) in found {
                let known = all.entry(label).or_default();
                known.on_ground += border.on_ground;
                known.on_others += border.on_others;
            }
        }
        let are_several = all.len() >= 2 && 2 * with_several > with_labels;
        if !are_several && with_void < with_labels {
            return None;
        }
        let largest = *all.last_key_value()?.0;
        let count = all.len() as i64;
        let are_numbers = if are_several {
            largest <= LARGEST_NUMBER || largest <= LARGEST_PER_LABEL * count
        } else {
            // A dark body with a light line around it may be drawn in any grey value.
            largest <= count || are_of_voc
        };
        Some(Self {
            labels: all.len(),
            are_numbers: are_numbers && !has_own_palette,
            are_on_ground: all.values().all(|border| border.on_ground >= border.on_others),
        })
    }
}

/// Sides of pixels of a label that are its edge.
#[derive(Debug, Clone, Copy, Default)]
struct Border {
    on_ground: u64,
    on_others: u64,
}

/// How the pixels of a value lie.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    pixels: usize,
    /// Runs along rows, and along columns.
    runs: [usize; 2],
    border: Border,
}

/// The edges of every label of a picture; `None` where it is no label mask.
fn borders(LabelPicture { width, height, labels, .. }: &LabelPicture) -> Option<BTreeMap<i64, Border>> {
    if labels.is_empty() {
        return None;
    }
    let at = |column: usize, row: usize| labels[row * width + column];
    let mut tallies: BTreeMap<i64, Tally> = BTreeMap::new();
    let (mut pixels, mut runs) = (0, 0);
    for (row, line) in labels.chunks_exact(*width).enumerate() {
        let mut column = 0_usize;
        for run in line.chunk_by(|a, b| a == b) {
            let label = run[0];
            if label > 0 {
                let tally = tallies.entry(label).or_default();
                tally.pixels += run.len();
                tally.runs[0] += 1;
                pixels += run.len();
                runs += 1;
                let beside = [column.checked_sub(1), Some(column + run.len()).filter(|end| end < width)];
                beside.into_iter().flatten().for_each(|other| tally.border.meets(at(other, row)));
                for column in column..column + run.len() {
                    let above = row.checked_sub(1).map(|row| at(column, row));
                    let below = Some(row + 1).filter(|row| row < height).map(|row| at(column, row));
                    tally.runs[1] += usize::from(above != Some(label));
                    [above, below]
                        .into_iter()
                        .flatten()
                        .filter(|other| *other != label)
                        .for_each(|other| tally.border.meets(other));
                }
            }
            column += run.len();
        }
        // Noise is seen in the first rows.
        if pixels > ENOUGH_PIXELS && pixels < SHORT_RUN * runs {
            return None;
        }
    }
    let is_scattered = |tally: &&Tally| tally.runs.iter().any(|runs| tally.pixels < SHORT_RUN * runs);
    // An edge of a large body is a small share of its pixels, but has most of its values.
    if 2 * tallies.values().filter(is_scattered).count() > tallies.len() {
        return None;
    }
    let all: usize = tallies.values().map(|tally| tally.pixels).sum();
    let scattered: usize = tallies.values().filter(is_scattered).map(|tally| tally.pixels).sum();
    if scattered as f64 > MOST_SCATTERED * all as f64 {
        return None;
    }
    Some(tallies.into_iter().map(|(label, tally)| (label, tally.border)).collect())
}

impl Border {
    fn meets(&mut self, other: i64) {
        match other {
            0 => self.on_ground += 1,
            _ => self.on_others += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: usize, height: usize, label: impl Fn(usize, usize) -> i64) -> Option<LabelPicture> {
        let labels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let labels = labels.map(|(column, row)| label(column, row)).collect();
        Some(LabelPicture { width, height, labels, numbering: Numbering::Grey, had_void: false })
    }

    /// Two squares of these values.
    fn squares([left, right]: [i64; 2]) -> Option<LabelPicture> {
        picture(60, 40, |column, row| match (column, (10..30).contains(&row)) {
            (5..25, true) => left,
            (30..50, true) => right,
            _ => 0,
        })
    }

    #[test]
    fn small_numbers_that_are_seen_together_are_labels_beyond_doubt_and_large_ones_are_not() {
        let convincing =
            |labels| LabelEvidence::of([squares(labels), squares(labels)]).map(|found| found.is_convincing());
        assert_eq!(convincing([1, 2]), Some(true));
        assert_eq!(convincing([128, 255]), Some(false));
        assert_eq!(convincing([7, 7]), None);
        // Each picture shows one of them.
        assert_eq!(LabelEvidence::of([squares([1, 1]), squares([2, 2])]), None);
    }

    /// A square of a value with a border of void that has been shared out.
    fn square_with_void(value: i64, numbering: Numbering) -> Option<LabelPicture> {
        Some(LabelPicture { numbering, had_void: true, ..squares([value, 0])? })
    }

    #[test]
    fn one_object_with_a_void_border_is_a_label_beyond_doubt_by_the_number_1_or_by_the_palette() {
        let convincing = |pictures: [Option<LabelPicture>; 2]| LabelEvidence::of(pictures).map(|e| e.is_convincing());
        let of = |value, numbering| convincing([(); 2].map(|()| square_with_void(value, numbering)));
        assert_eq!(of(1, Numbering::Grey), Some(true));
        assert_eq!(of(15, Numbering::Voc), Some(true));
        // A line around a body that is a little lighter than the ground may be drawn.
        assert_eq!(of(15, Numbering::Grey), Some(false));
        assert_eq!(of(1, Numbering::OwnPalette), Some(false));
        // The other picture has no such border.
        assert_eq!(convincing([square_with_void(1, Numbering::Grey), squares([1, 0])]), None);
        assert_eq!(convincing([square_with_void(1, Numbering::Grey), squares([0, 0])]), Some(true));
    }

    #[test]
    fn the_smoothed_edge_of_a_large_body_is_no_label_mask() {
        let disc = |column: usize, row: usize| {
            let from_middle = (column as f64 - 500.3).hypot(row as f64 - 500.7);
            (255.0 * (480.5 - from_middle).clamp(0.0, 1.0)) as i64
        };
        assert_eq!(LabelEvidence::of([picture(1000, 1000, disc)]), None);
    }

    #[test]
    fn a_picture_without_pixels_is_no_label_mask() {
        assert_eq!(LabelEvidence::of([picture(0, 0, |_, _| 0)]), None);
        assert_eq!(LabelEvidence::of([picture(0, 5, |_, _| 0)]), None);
    }
}
