//! Outlines without the points that lie along an edge.
use std::ops::Range;

use freeform_curve_fit::{OpenArc, OpenOutline, Outline, OutlineError};
use nalgebra::Point2;

use super::places::{runs, runs_all_round};
use crate::tuning::occlusion::FEWEST_OF_ARC;

/// An outline without the points that are `on_edge`, nor so many next to them on either side, where the contour turns round the corner; `None`
/// where no point is on an edge.
///
/// # Errors
/// No arc is left, or all that are lie on one line.
pub(super) fn without(
    outline: &Outline,
    on_edge: impl Fn(&Point2<f64>) -> bool,
    beside: usize,
) -> Option<Result<Outline, OutlineError>> {
    if !outline.points().any(&on_edge) {
        return None;
    }
    let deviations: Option<Vec<_>> = outline.deviations().map(Iterator::collect);
    let mut arcs = Vec::new();
    let mut before = 0;
    for piece in outline.pieces() {
        let (points, count) = (piece.points, piece.points.len());
        let numbers = numbers_of_arcs(points, piece.closed, &on_edge, beside);
        for numbers in numbers.into_iter().filter(|numbers| numbers.len() >= FEWEST_OF_ARC) {
            let arc = OpenArc::new(numbers.iter().map(|i| points[*i]).collect());
            let stated = deviations.as_ref().map(|all| numbers.iter().map(|i| all[before + i]).collect());
            arcs.push(match stated {
                Some(stated) => arc.and_then(|arc| arc.with_deviations(stated)),
                None => arc,
            });
        }
        before += count;
    }
    Some(arcs.into_iter().collect::<Result<Vec<_>, _>>().and_then(OpenOutline::in_sequence).map(Outline::Open))
}

/// The numbers of the points of each arc that is left of a piece; a contour that is whole ends where it begins.
fn numbers_of_arcs(
    points: &[Point2<f64>],
    closed: bool,
    on_edge: impl Fn(&Point2<f64>) -> bool,
    beside: usize,
) -> Vec<Vec<usize>> {
    let count = points.len();
    let mut is_left = vec![true; count];
    for i in (0..count).filter(|i| on_edge(&points[*i])) {
        for k in i + count - beside.min(count)..=i + count + beside.min(count) {
            if closed || (count..2 * count).contains(&k) {
                is_left[k % count] = false;
            }
        }
    }
    if !closed {
        return runs(0..count, |i| is_left[i]).map(Iterator::collect).collect();
    }
    let round = |run: Range<usize>| run.map(|i| i % count).collect();
    match runs_all_round(count, |i| is_left[i]) {
        Some(runs) => runs.map(round).collect(),
        None => vec![round(0..count + 1)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(count: usize) -> Outline {
        let point = |i| std::f64::consts::TAU * i as f64 / count as f64;
        Outline::closed((0..count).map(point).map(|t| Point2::new(t.cos(), t.sin())).collect()).expect("a circle")
    }

    #[test]
    fn what_is_left_of_a_contour_is_one_arc_that_begins_after_the_edge() {
        let outline = circle(100).with_deviations((0..100).map(|i| 1.0 + f64::from(i)).collect()).expect("deviations");
        let cut = without(&outline, |p| p.x > 0.9, 2).expect("points on the edge").expect("an arc");
        let Outline::Open(open) = &cut else { panic!("{cut:?}") };
        let [arc] = open.arcs() else { panic!("{open:?}") };
        // Points -7 to 7 lie beyond the edge, and two on either side go with them.
        assert_eq!(arc.points().len(), 81);
        assert_eq!(arc.deviations().map(|own| (own[0], own[80])), Some((11.0, 91.0)));
        assert!(arc.points().iter().all(|p| p.x < 0.9));
    }

    #[test]
    fn contours_that_an_edge_does_not_touch_stay_whole() {
        assert!(without(&circle(50), |p| p.x > 2.0, 2).is_none());
        let hole = |i: i32| Point2::new(0.2 * f64::from(i).cos(), 0.2 * f64::from(i).sin());
        let Outline::Closed(ring) = circle(50) else { panic!("closed") };
        let ring = Outline::from(ring.with_inner(vec![(0..6).map(hole).collect()]).expect("a hole"));
        let cut = without(&ring, |p| p.x > 0.9, 0).expect("points on the edge").expect("arcs");
        let pieces: Vec<_> = cut.pieces().map(|piece| piece.points).collect();
        assert_eq!((pieces.len(), pieces[1].len()), (2, 7));
        assert_eq!(pieces[1][0], pieces[1][6], "the hole ends where it begins");
    }

    #[test]
    fn nothing_is_left_where_all_points_lie_on_edges() {
        assert!(without(&circle(50), |_| true, 0).expect("points on the edge").is_err());
    }
}
