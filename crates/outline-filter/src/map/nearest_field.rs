//! The nearest place on the map for any point of the plane, in constant time.
use nalgebra::{Point2, Vector2};

use crate::tuning::map::{FIELD_MARGIN, FIELD_PIXELS, FINEST_PIXEL};

/// Rows from one that all places are looked through for to the next.
const STRIP: usize = 8;
/// From this number on doubles are whole numbers.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// A picture of the body frame in which every pixel holds the number of a place near it.
#[derive(Debug, Clone, Default)]
pub(crate) struct NearestField {
    origin: Point2<f64>,
    per_length: f64,
    width: usize,
    height: usize,
    nearest: Vec<u32>,
}

impl NearestField {
    /// Fills the picture, row by row. The square of the distance from a place is, but for a square that all of them share, a line over the
    /// pixels of a row: the nearest places are those whose lines are lowest somewhere.
    pub(crate) fn build(&mut self, places: &[Point2<f64>], spacing: f64) {
        let Some(first) = places.first() else {
            self.nearest.clear();
            return;
        };
        let (mut low, mut high) = (*first, *first);
        for p in places {
            low = Point2::from(low.coords.inf(&p.coords));
            high = Point2::from(high.coords.sup(&p.coords));
        }
        let extent = (high - low).amax();
        let margin = FIELD_MARGIN * extent + spacing;
        let pixel = ((extent + 2.0 * margin) / FIELD_PIXELS).max(FINEST_PIXEL * spacing);
        self.origin = low - Vector2::repeat(margin);
        self.per_length = 1.0 / pixel;
        let pixels = |length: f64| ((length + 2.0 * margin) / pixel).ceil() as usize + 1;
        (self.width, self.height) = (pixels(high.x - low.x), pixels(high.y - low.y));
        self.nearest.clear();
        self.nearest.resize(self.width * self.height, 0);
        // In pixels, from the centre of the first one.
        let in_pixels = |p: &Point2<f64>| (p - self.origin) * self.per_length - Vector2::repeat(0.5);
        let mut places: Vec<(Vector2<f64>, u32)> = places.iter().map(in_pixels).zip(0..).collect();
        places.sort_unstable_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
        let count = places.len();
        let mut rows = Rows {
            places: &places,
            width: self.width,
            nearest: &mut self.nearest,
            lowest: vec![Line::default(); count],
        };
        let all: Vec<u32> = (0..places.len() as u32).collect();
        let (mut filled, last) = (0, self.height - 1);
        let mut above = rows.fill(0, &all);
        while filled < last {
            let next = (filled + STRIP).min(last);
            let below = rows.fill(next, &all);
            let candidates = rows.between((filled, &above), (next, &below));
            (filled + 1..next).for_each(|row| drop(rows.fill(row, &candidates)));
            (filled, above) = (next, below);
        }
    }

    /// Number of a place near the point, if there is any place.
    pub(crate) fn lookup(&self, p: &Point2<f64>) -> Option<usize> {
        if self.nearest.is_empty() {
            return None;
        }
        Some(self.nearest[self.pixel_of(p)] as usize)
    }

    /// What the pixels hold.
    #[inline(always)]
    pub(super) fn nearest(&self) -> &[u32] {
        &self.nearest
    }

    /// Pixels of places, one for each: as [`lookup`](Self::lookup) takes them, several side by side.
    #[inline(always)]
    pub(super) fn pixels(&self, places: impl Iterator<Item = Point2<f64>>, pixels: &mut [u32]) {
        let (most_x, most_y) = ((self.width - 1) as f64, (self.height - 1) as f64);
        let width = self.width as f64;
        // NaN becomes 0.
        let within = |length: f64, most: f64| {
            let length = length * self.per_length;
            let length = if length > 0.0 { length } else { 0.0 };
            (if length < most { length } else { most }).floor()
        };
        for (pixel, p) in pixels.iter_mut().zip(places) {
            let number = within(p.y - self.origin.y, most_y) * width + within(p.x - self.origin.x, most_x);
            // The last bits of a number that small, whose unit is the last of them.
            *pixel = (number + WHOLE).to_bits() as u32;
        }
    }

    fn pixel_of(&self, p: &Point2<f64>) -> usize {
        // Pixels of the border stand for what lies beyond; NaN becomes 0.
        let within =
            |length: f64, count: usize| (length * self.per_length).clamp(0.0, (count - 1) as f64) as u32 as usize;
        within(p.y - self.origin.y, self.height) * self.width + within(p.x - self.origin.x, self.width)
    }
}

/// The rows of a picture, and the places in order from left to right, in pixels, with their numbers.
struct Rows<'a> {
    places: &'a [(Vector2<f64>, u32)],
    width: usize,
    nearest: &'a mut [u32],
    lowest: Vec<Line>,
}

impl Rows<'_> {
    /// Fills a row with the nearest of some places, given by where they are in order; those of them that are nearest somewhere.
    fn fill(&mut self, row: usize, candidates: &[u32]) -> Vec<u32> {
        let Self { places, width, nearest, lowest } = self;
        let lowest = lowest_lines(places, candidates, row as f64, lowest);
        // Each line from the column that it is lowest from to that of the next.
        let pixels = &mut nearest[row * *width..][..*width];
        let mut column = 0;
        for (number, line) in lowest.iter().enumerate() {
            let end = lowest.get(number + 1).map_or(*width, |next| column_from(next.from, *width));
            while column < end {
                pixels[column] = line.number;
                column += 1;
            }
        }
        lowest.iter().map(|line| line.index).collect()
    }

    /// Places that may be nearest in the rows between two, given with those that are nearest there. What lies nearer to a place than to any
    /// other is convex and holds the place: it meets a row between only if it meets one of the two, or the place lies between them.
    fn between(&self, (above, of_above): (usize, &[u32]), (below, of_below): (usize, &[u32])) -> Vec<u32> {
        let (top, bottom) = (above as f64, below as f64);
        let mut is_candidate: Vec<bool> = self.places.iter().map(|(p, _)| p.y >= top && p.y <= bottom).collect();
        of_above.iter().chain(of_below).for_each(|index| is_candidate[*index as usize] = true);
        (0..).zip(is_candidate).filter_map(|(index, is_candidate)| is_candidate.then_some(index)).collect()
    }
}

/// The square of the distance from a place along a row of pixels, less the square of the column.
#[derive(Debug, Clone, Copy, Default)]
struct Line {
    /// Column of the place; the line falls by twice as much from one column to the next.
    x: f64,
    /// In the first column.
    at_none: f64,
    /// Column from which on no line before it is lower.
    from: f64,
    /// Where the place is in order.
    index: u32,
    /// Of the place.
    number: u32,
}

/// Those of the lines of some places, which fall faster from one to the next, that are lowest somewhere in a row; written over `lines`, which has room
/// for all of them.
fn lowest_lines<'a>(places: &[(Vector2<f64>, u32)], candidates: &[u32], row: f64, lines: &'a mut [Line]) -> &'a [Line] {
    let mut count = 0;
    'candidates: for index in candidates {
        let (p, number) = &places[*index as usize];
        let across = p.y - row;
        let at_none = p.x * p.x + across * across;
        let mut from = 0.0;
        // What a line that is steeper undercuts before it is lowest itself is lowest nowhere.
        while count > 0 {
            let last = &lines[count - 1];
            let apart = p.x - last.x;
            if apart > 0.0 {
                let begins = 0.5 * (at_none - last.at_none) / apart;
                if begins > last.from {
                    from = begins;
                    break;
                }
            } else if at_none >= last.at_none {
                continue 'candidates;
            }
            count -= 1;
        }
        lines[count] = Line { x: p.x, at_none, from, index: *index, number: *number };
        count += 1;
    }
    &lines[..count]
}

/// The first column of so many that is not before a place in a row, which is not before the first; their number where none is.
fn column_from(place: f64, columns: usize) -> usize {
    let last = columns as f64;
    let place = if place < last { place } else { last };
    // Small whole numbers are turned to and fro by one instruction each.
    let before = place as i32;
    before as usize + usize::from(f64::from(before) < place)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_pixel_holds_the_place_nearest_to_its_centre(
            places in prop::collection::vec((-1.0_f64..1.0, -0.5_f64..0.5), 1..40), spacing in 0.02_f64..0.3,
        ) {
            // Places in a row and in a column too.
            let mut places: Vec<_> = places.into_iter().map(|(x, y)| Point2::new(x, y)).collect();
            places.extend([Point2::new(0.25, 0.25), Point2::new(0.25, -0.25), Point2::new(-0.25, 0.25)]);
            let mut field = NearestField::default();
            field.build(&places, spacing);
            for (index, number) in field.nearest.iter().enumerate() {
                let (row, column) = (index / field.width, index % field.width);
                let centre = field.origin + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) / field.per_length;
                let least = places.iter().map(|p| (p - centre).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!((places[*number as usize] - centre).norm() < least + 1e-9);
            }
        }
    }
}
