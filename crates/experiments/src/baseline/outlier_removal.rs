use std::ops::Range;

use freeform_curve_fit::{OpenArc, OpenOutline, Outline};
use nalgebra::Point2;

use super::flow_fit::median;

/// Neighbours to either side that a point is judged by.
const NEIGHBOURS: usize = 3;
/// A point so many times as far from its neighbours as points usually are is wrong.
const TOO_FAR: f64 = 3.0;

/// The outline without the points that lie far from their neighbours along it, by the median of the distances; the outline
/// itself where what is left is none.
pub(super) fn without_outliers(outline: &Outline) -> Outline {
    let distances: Vec<f64> = outline
        .pieces()
        .flat_map(|piece| (0..piece.points.len()).map(move |i| from_neighbours(piece.points, piece.closed, i)))
        .collect();
    let limit = TOO_FAR * median(distances.clone());
    let keep = |points: &[Point2<f64>], range: Range<usize>| -> Vec<Point2<f64>> {
        points.iter().zip(&distances[range]).filter(|(_, distance)| **distance <= limit).map(|(p, _)| *p).collect()
    };
    let cleaned = match outline {
        Outline::Closed(whole) => Outline::closed(keep(whole.points(), 0..distances.len())).ok(),
        Outline::Open(open) => {
            let mut start = 0;
            let arcs = open.arcs().iter().filter_map(|arc| {
                let range = start..start + arc.points().len();
                start = range.end;
                OpenArc::new(keep(arc.points(), range)).ok()
            });
            OpenOutline::new(arcs.collect()).ok().map(Outline::Open)
        }
    };
    cleaned.unwrap_or_else(|| outline.clone())
}

/// Median distance of a point to its neighbours.
fn from_neighbours(points: &[Point2<f64>], closed: bool, i: usize) -> f64 {
    let count = points.len();
    let distance = |k: usize| (points[k] - points[i]).norm();
    median(if closed {
        let around = (1..=NEIGHBOURS).flat_map(|step| [i + count * NEIGHBOURS - step, i + step]);
        around.map(|k| distance(k % count)).collect()
    } else {
        let around = i.saturating_sub(NEIGHBOURS)..(i + NEIGHBOURS + 1).min(count);
        around.filter(|k| *k != i).map(distance).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(count: u32) -> Vec<Point2<f64>> {
        let at = |i| std::f64::consts::TAU * f64::from(i) / f64::from(count);
        (0..count).map(|i| Point2::new(at(i).cos(), 0.5 * at(i).sin())).collect()
    }

    #[test]
    fn a_good_outline_stays_as_it_is_and_wrong_points_go() {
        let good = ellipse(200);
        let outline = |points: &[Point2<f64>]| Outline::closed(points.to_vec()).expect("closed");
        assert_eq!(without_outliers(&outline(&good)), outline(&good));
        let mut bad = good.clone();
        for i in [0, 1, 50, 120] {
            bad[i].y += 0.4;
        }
        let cleaned = without_outliers(&outline(&bad));
        assert_eq!(cleaned.point_count(), 196);
        assert!(cleaned.points().all(|p| good.contains(p)));
    }

    #[test]
    fn arcs_are_cleaned_one_by_one() {
        let mut points = ellipse(200);
        points[10].x -= 0.3;
        let arcs = [&points[..60], &points[80..150]].map(|arc| OpenArc::new(arc.to_vec()).expect("an arc"));
        let outline = Outline::Open(OpenOutline::new(arcs.into()).expect("two arcs"));
        let counts: Vec<_> = without_outliers(&outline).pieces().map(|piece| piece.points.len()).collect();
        assert_eq!(counts, [59, 70]);
    }
}
