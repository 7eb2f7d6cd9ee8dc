//! Borders of objects that label masks mark as void, where whoever marked the objects could not tell what a pixel belongs to (M. Everingham and
//! others, The PASCAL Visual Object Classes Challenge, 2010).
use std::collections::VecDeque;

use crate::labels::evidence::LARGEST_NUMBER;

/// The value of such borders, which is no number of an object where all others are small.
const VOID: i64 = 255;

/// Farthest that the middle of a border is from what it lies between, in pixels: those of PASCAL VOC are five pixels wide, and somewhat more at
/// corners.
const HALF_WIDTH: usize = 5;

/// Most of the sides of pixels where an object lies at the ground, over those where it lies at a border: borders go all around objects.
const AT_GROUND: f64 = 0.1;

/// The labels of a mask with every void pixel given to what is nearest to it, objects or ground, so that an object reaches to the middle of its
/// border; nothing where there is no such border.
pub(crate) fn without_void(labels: &[i64], width: usize, height: usize) -> Option<Vec<i64>> {
    if !labels.contains(&VOID) || labels.iter().any(|label| (LARGEST_NUMBER + 1..VOID).contains(label) || *label > VOID)
    {
        return None;
    }
    let (mut at_ground, mut at_void) = (0_u32, 0_u32);
    for (place, _) in labels.iter().enumerate().filter(|(_, label)| **label > 0 && **label != VOID) {
        for beside in beside(place, width, height) {
            at_ground += u32::from(labels[beside] == 0);
            at_void += u32::from(labels[beside] == VOID);
        }
    }
    let goes_around = f64::from(at_ground) <= AT_GROUND * f64::from(at_void);
    (at_void > 0 && goes_around).then(|| shared_out(labels, width, height)).flatten()
}

/// Every void pixel has the label of the nearest that is not, by straight distance: each takes the source of one of its neighbours, the nearest
/// sources first. Nothing where one is farther from all others than the middle of a border: that is an object.
fn shared_out(labels: &[i64], width: usize, height: usize) -> Option<Vec<i64>> {
    let mut source: Vec<Option<usize>> =
        labels.iter().enumerate().map(|(place, label)| (*label != VOID).then_some(place)).collect();
    let distance = |from: usize, to: usize| {
        let across = (from % width).abs_diff(to % width);
        let down = (from / width).abs_diff(to / width);
        across * across + down * down
    };
    let at_void = |place: &usize| labels[*place] != VOID && beside(*place, width, height).any(|b| labels[b] == VOID);
    let mut waiting: VecDeque<usize> = (0..labels.len()).filter(at_void).collect();
    while let Some(place) = waiting.pop_front() {
        let Some(from) = source[place] else { continue };
        for next in around(place, width, height).filter(|next| labels[*next] == VOID) {
            if source[next].is_none_or(|known| distance(from, next) < distance(known, next)) {
                source[next] = Some(from);
                waiting.push_back(next);
            }
        }
    }
    let is_near = |(place, source): (usize, &Option<usize>)| {
        source.is_some_and(|source| distance(source, place) <= HALF_WIDTH * HALF_WIDTH)
    };
    let is_border = source.iter().enumerate().all(is_near);
    is_border.then(|| source.iter().flatten().map(|source| labels[*source]).collect())
}

/// The pixels that share a side with one.
fn beside(place: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (place % width, place / width);
    around(place, width, height).filter(move |next| next % width == column || next / width == row)
}

/// The pixels that share a side or a corner with one.
fn around(place: usize, width: usize, height: usize) -> impl Iterator<Item = usize> {
    let (column, row) = (place % width, place / width);
    let rows = row.saturating_sub(1)..(row + 2).min(height);
    let columns = column.saturating_sub(1)..(column + 2).min(width);
    rows.flat_map(move |row| columns.clone().map(move |column| row * width + column)).filter(move |next| *next != place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 90;
    const HEIGHT: usize = 70;

    fn mask(label: impl Fn(f64, f64) -> i64) -> Vec<i64> {
        (0..WIDTH * HEIGHT).map(|i| label((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5)).collect()
    }

    fn disc(x: f64, y: f64) -> f64 {
        (x - 45.0).hypot(y - 35.0) - 20.0
    }

    #[test]
    fn an_object_reaches_to_the_middle_of_its_void_border() {
        let whole = mask(|x, y| i64::from(disc(x, y) < 0.0));
        for half in [1.0, 2.0, 2.5] {
            let marked = mask(|x, y| if disc(x, y).abs() < half { VOID } else { i64::from(disc(x, y) < 0.0) });
            let shared = without_void(&marked, WIDTH, HEIGHT).expect("a border");
            let wrong = shared.iter().zip(&whole).filter(|(a, b)| a != b).count();
            // Of 125 pixels along the edge some lie on the middle of the border.
            assert!(wrong < 40, "{half}: {wrong}");
            let count = |labels: &[i64]| labels.iter().sum::<i64>();
            assert!((count(&shared) - count(&whole)).abs() < 40, "{half}");
        }
    }

    #[test]
    fn an_object_of_that_number_and_grey_values_are_no_borders() {
        // An object of its own.
        let own = mask(|x, y| if disc(x, y) < 0.0 { VOID } else { i64::from(y < 9.0) });
        assert_eq!(without_void(&own, WIDTH, HEIGHT), None);
        let grey = mask(|x, y| if disc(x, y).abs() < 2.0 { VOID } else { 120 * i64::from(disc(x, y) < 0.0) });
        assert_eq!(without_void(&grey, WIDTH, HEIGHT), None);
        // One that touches another, or lies half on it, however small it is.
        for (x, half) in [(70.0, 6.0), (65.0, 6.0), (60.0, 3.0), (64.0, 2.0)] {
            let is_other = move |px: f64, py: f64| (px - x).abs().max((py - 35.0).abs()) < half;
            let touching = mask(|x, y| if is_other(x, y) { VOID } else { i64::from(disc(x, y) < 0.0) });
            assert_eq!(without_void(&touching, WIDTH, HEIGHT), None, "{x} {half}");
        }
        // A broad frame of void around the object is no border.
        let broad = mask(|x, y| {
            if disc(x, y) < 0.0 {
                1
            } else if disc(x, y) < 12.0 {
                VOID
            } else {
                0
            }
        });
        assert_eq!(without_void(&broad, WIDTH, HEIGHT), None);
        assert_eq!(without_void(&[0; WIDTH * HEIGHT], WIDTH, HEIGHT), None);
    }
}
