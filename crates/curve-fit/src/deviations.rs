//! Standard deviations of points along the normal of their contour.
use nalgebra::{Point2, Vector2};

use crate::error::OutlineError;

/// Refuses a list that is not one positive finite number for each of so many points.
pub(crate) fn check_deviations(deviations: &[f64], points: usize) -> Result<(), OutlineError> {
    if deviations.len() != points {
        return Err(OutlineError::DeviationCount { found: deviations.len(), points });
    }
    let is_wrong = |value: &f64| !(value.is_finite() && *value > 0.0);
    match deviations.iter().position(is_wrong) {
        Some(index) => Err(OutlineError::Deviation { index, value: deviations[index] }),
        None => Ok(()),
    }
}

/// Share of the distance of its neighbours that a point is moved by to see what a map makes of its deviation: small for the bends of the map,
/// and large for the rounding of coordinates.
const STEP: f64 = 1e-4;

/// The deviations of the points of a run after a map: how far it moves a point across the mapped contour that is moved a little across the
/// contour, over that, times its deviation.
pub(crate) fn mapped_deviations<'a>(
    points: &'a [Point2<f64>],
    closed: bool,
    deviations: &'a [f64],
    map: impl Fn(&Point2<f64>) -> Point2<f64> + 'a,
) -> impl Iterator<Item = f64> + 'a {
    let last = points.len() - 1;
    deviations.iter().enumerate().map(move |(i, deviation)| {
        let before = if i > 0 { i - 1 } else { usize::from(closed) * last };
        let after = if i < last { i + 1 } else { usize::from(!closed) * last };
        let along = points[after] - points[before];
        let (across, length) = match along.try_normalize(0.0) {
            Some(along_unit) => (Vector2::new(-along_unit.y, along_unit.x), along.norm()),
            None => (Vector2::x(), points[i].coords.norm().max(1.0)),
        };
        let step = STEP * length;
        let moved = map(&(points[i] + step * across)) - map(&points[i]);
        let stretch = match (map(&points[after]) - map(&points[before])).try_normalize(0.0) {
            Some(direction) => direction.perp(&moved).abs(),
            None => moved.norm(),
        };
        (deviation * (stretch / step)).clamp(f64::MIN_POSITIVE, f64::MAX)
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Affine2, Matrix3};

    use super::*;
    use crate::points::points;
    use crate::{ClosedOutline, OpenArc, OpenOutline, Outline};

    fn square() -> Outline {
        Outline::closed(points(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])).expect("a square")
    }

    #[test]
    fn deviations_that_are_none_are_refused_with_the_reason() {
        let stating = |list: &[f64]| square().with_deviations(list.to_vec()).map(|_| ());
        assert_eq!(stating(&[1.0; 4]), Ok(()));
        assert_eq!(stating(&[1.0; 3]), Err(OutlineError::DeviationCount { found: 3, points: 4 }));
        assert_eq!(stating(&[1.0; 5]), Err(OutlineError::DeviationCount { found: 5, points: 4 }));
        for value in [0.0, -1.0, f64::INFINITY] {
            assert_eq!(stating(&[1.0, 1.0, value, 1.0]), Err(OutlineError::Deviation { index: 2, value }));
        }
        assert!(matches!(stating(&[f64::NAN; 4]), Err(OutlineError::Deviation { index: 0, .. })));
        let arcs = || [[(0.0, 0.0), (1.0, 0.0)], [(1.0, 1.0), (0.0, 1.0)]].map(|arc| OpenArc::new(points(&arc)));
        let [first, second] = arcs().map(|arc| arc.expect("an arc"));
        let some = vec![first.with_deviations(vec![1.0; 2]).expect("two"), second];
        assert_eq!(OpenOutline::new(some), Err(OutlineError::DeviationCount { found: 2, points: 4 }));
    }

    #[test]
    fn deviations_stay_with_their_points_where_arcs_are_turned_round_and_holes_left_out() {
        let arcs = [[(0.0, 0.0), (1.0, 0.0)], [(0.0, 1.0), (1.0, 1.0)]].map(|arc| {
            let arc = OpenArc::new(points(&arc)).expect("an arc");
            let stated = arc.points().iter().map(|p| 1.0 + p.x + 2.0 * p.y).collect();
            arc.with_deviations(stated).expect("deviations")
        });
        let outline = Outline::Open(OpenOutline::new(arcs.into()).expect("arcs"));
        assert_eq!(outline.points().last().expect("a point").x, 0.0, "the second arc is turned round");
        let of_points = outline.points().map(|p| 1.0 + p.x + 2.0 * p.y);
        assert!(outline.deviations().expect("deviations").eq(of_points));

        let holed = ClosedOutline::new(square().points().copied().collect()).expect("a square");
        let holed = holed.with_inner(vec![points(&[(0.5, 0.5), (1.0, 0.5), (0.5, 1.0)])]).expect("a hole");
        let holed = Outline::from(holed).with_deviations((1..8).map(f64::from).collect()).expect("deviations");
        let boundary = holed.boundary().into_owned();
        assert!(boundary.deviations().expect("deviations").eq([1.0, 2.0, 3.0, 4.0]));
        assert_eq!(square().deviations().map(Iterator::count), None);
    }

    #[test]
    fn deviations_grow_as_a_map_stretches_what_lies_across_the_contour() {
        // Sides along x move by what y is stretched by, and the other way round.
        let stretched = Matrix3::new(3.0, 0.0, 5.0, 0.0, 0.5, -1.0, 0.0, 0.0, 1.0);
        let side = |k: i32| f64::from(k) / 10.0;
        let lower = (0..11).map(|k| Point2::new(side(k), 0.0));
        let right = (0..11).map(|k| Point2::new(1.0, 0.1 + side(k)));
        let arc = OpenArc::new(lower.chain(right).collect()).expect("an arc");
        let arc = arc.with_deviations(vec![0.02; 22]).expect("deviations");
        let outline = Outline::Open(OpenOutline::new(vec![arc]).expect("an outline"));
        let moved = outline.moved(&Affine2::from_matrix_unchecked(stretched)).expect("an outline");
        let moved: Vec<f64> = moved.deviations().expect("deviations").collect();
        assert!(moved[..10].iter().all(|deviation| (deviation - 0.01).abs() < 1e-12), "{moved:?}");
        assert!(moved[12..].iter().all(|deviation| (deviation - 0.06).abs() < 1e-12), "{moved:?}");
    }
}
