//! Outlines that are polygons, given by their corners.
use freeform_curve_fit::Outline;

/// Points that the sides of a polygon are filled with, together: a contour with as many hardly tells more with further ones.
const POINTS_OF_POLYGON: f64 = 300.0;
/// A contour of fewer points than this is taken for a polygon if its coordinates are whole numbers...
const FEW_CORNERS: usize = 40;
/// ...and so is one whose longest side is so many times as long as the mean: points that sample a contour are never as uneven.
const UNEVEN: f64 = 4.0;

/// The outline of a polygon whose corners alone are given, as annotation programs do, with about 300 points along its sides. Methods that take the
/// points for samples of the contour would see the corners alone, which are other places of the body in every frame. Open outlines, and those whose
/// points have standard deviations, stay as they are.
///
/// ```
/// use freeform_motion::{curve_fit::Outline, outline_of_polygon};
/// use nalgebra::Point2;
///
/// let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)];
/// let polygon = Outline::closed(corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect())?;
/// assert_eq!(outline_of_polygon(&polygon).point_count(), 302);
/// # Ok::<(), freeform_motion::curve_fit::OutlineError>(())
/// ```
#[must_use]
pub fn outline_of_polygon(outline: &Outline) -> Outline {
    match outline {
        Outline::Closed(polygon) => polygon.with_sides(polygon.length() / POINTS_OF_POLYGON).into(),
        Outline::Open(_) => outline.clone(),
    }
}

/// The outline of a polygon in pixels, with a point for each pixel of its sides; `None` where the points are no such polygon, or all there already.
/// Masks are traced to such polygons, with the corners of straight stretches alone. Such a polygon is closed, has whole numbers for coordinates
/// and no standard deviations, and has fewer than 40 points or a side of more than four times the mean length. [`Tracker`](crate::Tracker) fills
/// them.
///
/// ```
/// use freeform_motion::{curve_fit::Outline, outline_of_pixel_polygon};
/// use nalgebra::Point2;
///
/// let corners = [(0.0, 0.0), (30.0, 0.0), (30.0, 10.0), (0.0, 10.0)];
/// let polygon = Outline::closed(corners.iter().map(|(x, y)| Point2::new(*x, *y)).collect())?;
/// assert_eq!(outline_of_pixel_polygon(&polygon).map(|outline| outline.point_count()), Some(80));
/// # Ok::<(), freeform_motion::curve_fit::OutlineError>(())
/// ```
#[must_use]
pub fn outline_of_pixel_polygon(outline: &Outline) -> Option<Outline> {
    let Outline::Closed(polygon) = outline else { return None };
    let is_whole = |value: f64| value.fract() == 0.0;
    if outline.deviations().is_some() || !outline.points().all(|point| is_whole(point.x) && is_whole(point.y)) {
        return None;
    }
    let sides = polygon.side_lengths();
    let (count, longest) = (sides.len(), sides.clone().fold(0.0, f64::max));
    let mean = sides.sum::<f64>() / count as f64;
    let is_polygon = count < FEW_CORNERS || longest > UNEVEN * mean;
    let filled = is_polygon.then(|| Outline::from(polygon.with_sides(1.0)))?;
    (filled.point_count() > outline.point_count()).then_some(filled)
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::ClosedOutline;
    use nalgebra::Point2;

    use super::*;

    #[test]
    fn a_long_side_tells_a_polygon_whatever_contours_lie_within() {
        // Every pixel of three sides of a square, and nothing between the ends of the fourth.
        let side = |from: (i32, i32), step: (i32, i32)| {
            (0..20).map(move |k| Point2::new(f64::from(from.0 + k * step.0), f64::from(from.1 + k * step.1)))
        };
        let three = side((0, 0), (1, 0)).chain(side((20, 0), (0, 1))).chain(side((20, 20), (-1, 0)));
        let square = three.chain([Point2::new(0.0, 20.0)]).collect();
        let boundary = ClosedOutline::new(square).expect("a boundary");
        // A mark that runs to and fro within it.
        let zigzag = (0..40).map(|k| Point2::new(1.0 + 0.25 * f64::from(k) * 2.0, if k % 2 == 0 { 2.0 } else { 18.0 }));
        let zigzag = zigzag.map(|p| p.map(f64::floor)).collect();
        for outline in [boundary.clone(), boundary.with_inner(vec![zigzag]).expect("a mark")] {
            let filled = outline_of_pixel_polygon(&outline.into()).expect("a polygon");
            assert_eq!(filled.pieces().next().map(|piece| piece.points.len()), Some(80));
        }
    }
}
