//! Unit normals of a noisy outline by local regression.
use std::ops::Range;

use nalgebra::Vector2;
use pulp::{Arch, Simd, WithSimd};

use crate::{
    outline::Outline,
    vectors::{reserve, sum},
    windows::{BEYOND, Windows},
};

/// Outward unit normals of all points of an outline, in the order of [`Outline::points`].
///
/// The tangent at a point is the slope of the least-squares line of position against arc length, over the points within
/// `half_window` of it on either side and the first ones beyond; near an open end the window is one-sided. `half_window`
/// is a fraction of the total length of the outline, between 0 and 0.25; 0.02 is about 8 points a side at 400 points.
/// "Outward" follows from the sign of [`Outline::signed_area`].
///
/// # Panics
/// If `half_window` is outside 0 to 0.25.
#[must_use]
pub fn outward_normals(outline: &Outline, half_window: f64) -> Vec<Vector2<f64>> {
    // Relative to the centroid, so that the running sums of a far outline do not cancel.
    let centroid = outline.centroid();
    let (xs, ys): (Vec<f64>, Vec<f64>) = outline.points().map(|p| (p.x - centroid.x, p.y - centroid.y)).unzip();
    let (mut nx, mut ny) = (Vec::new(), Vec::new());
    let mut regression = NormalRegression::default();
    regression.run(outline, [&xs, &ys], half_window, [&mut nx, &mut ny]);
    nx.into_iter().zip(ny).map(|(x, y)| Vector2::new(x, y)).collect()
}

/// Area of an outline relative to what it encloses one way round and the other, below which its sign is rounding.
const NO_AREA: f64 = 1e-9;

/// The regression of [`outward_normals`] in buffers that are reused, for points that have been moved since they were taken.
#[derive(Debug, Default, Clone)]
pub struct NormalRegression {
    /// Whether the area of the last outline determined which side of it is the inside.
    pub(crate) has_inside: bool,
    /// Distance of every point to the one before it in its piece; 0 at an open beginning.
    steps: Vec<f64>,
    /// Arc lengths along one piece, with enough neighbours repeated beyond its ends if it is closed.
    arc_lengths: Vec<f64>,
    /// Running sums along the same, one more than there are nodes: of the arc lengths...
    length_sums: Vec<f64>,
    /// ...and of the points.
    point_sums: Vec<PointSums>,
    windows: Windows,
    /// Index ranges of the pieces among all points, and whether each is closed.
    pieces: Vec<(Range<usize>, bool)>,
}

/// Sums over all nodes of the extended piece before one: of x, y, s x and s y.
type PointSums = [f64; 4];

impl NormalRegression {
    /// Fills `nx`, `ny` with the outward unit normals of the points `[xs, ys]`, which are those of `outline` after a smooth map
    /// of the plane without reflection; `half_window` as in [`outward_normals`]. A point whose surroundings have no direction
    /// gets a zero normal. Best in coordinates of about the outline's own size, near the origin.
    ///
    /// # Panics
    /// If `half_window` is outside 0 to 0.25, or `xs` and `ys` do not hold one value per point of the outline.
    pub fn run(&mut self, outline: &Outline, points: [&[f64]; 2], half_window: f64, normals: [&mut Vec<f64>; 2]) {
        self.set_pieces(outline.pieces().map(|piece| (piece.points.len(), piece.closed)));
        self.run_along(points, half_window, normals);
    }

    /// Normals along pieces of so many points, each closed or not.
    pub(crate) fn run_pieces(
        &mut self,
        pieces: &[(usize, bool)],
        points: [&[f64]; 2],
        half_window: f64,
        normals: [&mut Vec<f64>; 2],
    ) {
        self.set_pieces(pieces.iter().copied());
        self.run_along(points, half_window, normals);
    }

    fn set_pieces(&mut self, pieces: impl Iterator<Item = (usize, bool)>) {
        self.pieces.clear();
        self.pieces.extend(pieces.scan(0, |start, (count, closed)| {
            let range = *start..*start + count;
            *start = range.end;
            Some((range, closed))
        }));
    }

    fn run_along(&mut self, [xs, ys]: [&[f64]; 2], half_window: f64, [nx, ny]: [&mut Vec<f64>; 2]) {
        assert!((0.0..=0.25).contains(&half_window), "half window {half_window} outside 0 to 0.25");
        let count = self.pieces.last().map_or(0, |(range, _)| range.end);
        assert_eq!([xs.len(), ys.len()], [count; 2], "one coordinate per point");
        for normals in [&mut *nx, &mut *ny] {
            normals.clear();
            normals.resize(xs.len(), 0.0);
        }
        self.reserve(xs.len(), half_window);
        Arch::new().dispatch(NormalKernel { regression: self, points: [xs, ys], half_window, normals: [nx, ny] });
    }

    /// Makes room for outlines of so many points, whose neighbours beyond the ends may be twice as many as if the points
    /// were evenly spread; more is taken where it is needed.
    fn reserve(&mut self, points: usize, half_window: f64) {
        let nodes = points + (4.0 * half_window * points as f64) as usize + 16;
        reserve(&mut self.arc_lengths, nodes + BEYOND);
        reserve(&mut self.length_sums, nodes + 1);
        reserve(&mut self.point_sums, nodes + 1);
        self.windows.reserve(nodes);
    }

    #[inline(always)]
    fn measure_steps(&mut self, xs: &[f64], ys: &[f64]) {
        self.steps.clear();
        self.steps.resize(xs.len(), 0.0);
        distances_to_previous(xs, ys, &mut self.steps);
        for (range, closed) in &self.pieces {
            let (first, last) = (range.start, range.end - 1);
            self.steps[first] = if *closed { distance(xs[first] - xs[last], ys[first] - ys[last]) } else { 0.0 };
        }
    }

    /// Lays out a piece with its neighbours beyond both ends (closed pieces only) and the running sums. Returns how many
    /// nodes stand before the first.
    #[inline(always)]
    fn lay_out(&mut self, xs: &[f64], ys: &[f64], range: Range<usize>, closed: bool, half_length: f64) -> usize {
        let (xs, ys, steps) = (&xs[range.clone()], &ys[range.clone()], &self.steps[range]);
        let count = xs.len();
        let (before, after) = if closed {
            (nodes_to_cover(half_length, steps.iter().rev(), count), nodes_to_cover(half_length, steps.iter(), count))
        } else {
            (0, 0)
        };
        let nodes = before + count + after;
        self.arc_lengths.resize(nodes, 0.0);
        self.length_sums.resize(nodes + 1, 0.0);
        self.point_sums.resize(nodes + 1, [0.0; 4]);
        let mut slots = self.arc_lengths.iter_mut().zip(&mut self.length_sums).zip(&mut self.point_sums);
        // The first node stands at 0.
        let mut s = -steps[(count - before) % count];
        let (mut length_sum, mut point_sum) = (0.0, [0.0; 4]);
        for part in [count - before..count, 0..count, 0..after] {
            let points = xs[part.clone()].iter().zip(&ys[part.clone()]).zip(&steps[part]);
            for (((x, y), step), ((arc_length, length_slot), point_slot)) in points.zip(&mut slots) {
                s += step;
                *arc_length = s;
                *length_slot = length_sum;
                *point_slot = point_sum;
                length_sum += s;
                point_sum.iter_mut().zip([*x, *y, s * x, s * y]).for_each(|(sum, term)| *sum += term);
            }
        }
        self.length_sums[nodes] = length_sum;
        self.point_sums[nodes] = point_sum;
        before
    }

    /// The directions of the normals of a piece whose first point is node `before`, of any length.
    #[inline(always)]
    fn regress(&self, before: usize, [nx, ny]: [&mut [f64]; 2]) {
        let (lengths, points) = (self.length_sums.as_slice(), self.point_sums.as_slice());
        for ((begin, end), (nx, ny)) in self.windows.iter(before).zip(nx.iter_mut().zip(ny)) {
            // Covariance of arc length with position, up to a positive factor: the direction of the regression line.
            let count = f64::from((end - begin) as u32);
            let s = lengths[end] - lengths[begin];
            let [x, y, sx, sy] = std::array::from_fn(|k| points[end][k] - points[begin][k]);
            (*nx, *ny) = (count * sy - s * y, s * x - count * sx);
        }
    }
}

/// The whole regression, in a form that is compiled for the vector instructions that the machine has.
struct NormalKernel<'a> {
    regression: &'a mut NormalRegression,
    points: [&'a [f64]; 2],
    half_window: f64,
    normals: [&'a mut [f64]; 2],
}

impl WithSimd for NormalKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { regression, points: [xs, ys], half_window, normals: [nx, ny] } = self;
        let (area, absolute) = signed_area(xs, ys);
        regression.has_inside = area.abs() > NO_AREA * absolute;
        let outward = 1.0_f64.copysign(area);
        regression.measure_steps(xs, ys);
        // A hair less than the window, so that rounding does not decide whether evenly spaced points lie on its edge.
        let half_length = (1.0 - 1e-9) * half_window * sum(&regression.steps, |step| step);
        // Coordinates beyond all measure have no direction anywhere, and no order along the outline to look for windows in.
        if !half_length.is_finite() {
            return;
        }
        for piece in 0..regression.pieces.len() {
            let (range, closed) = regression.pieces[piece].clone();
            let before = regression.lay_out(xs, ys, range.clone(), closed, half_length);
            regression.windows.find(&mut regression.arc_lengths, before, half_length);
            regression.regress(before, [&mut nx[range.clone()], &mut ny[range]]);
        }
        for (x, y) in nx.iter_mut().zip(ny) {
            let norm = outward * distance(*x, *y);
            let scale = if norm == 0.0 { 0.0 } else { 1.0 / norm };
            (*x, *y) = (scale * *x, scale * *y);
        }
    }
}

/// How many steps reach at least `length`, and one more; at most `count`.
#[inline(always)]
fn nodes_to_cover<'a>(length: f64, steps: impl Iterator<Item = &'a f64>, count: usize) -> usize {
    let mut covered = 0.0;
    let short = steps.take_while(|&step| {
        covered += step;
        covered < length
    });
    (short.count() + 2).min(count)
}

/// Distance of every point but the first to the one before it.
#[inline(always)]
fn distances_to_previous(xs: &[f64], ys: &[f64], out: &mut [f64]) {
    let (earlier, later) = (xs.iter().zip(ys), xs.iter().zip(ys).skip(1));
    for (out, ((x0, y0), (x1, y1))) in out.iter_mut().skip(1).zip(earlier.zip(later)) {
        *out = distance(x1 - x0, y1 - y0);
    }
}

/// Euclidean length, without the guard of `f64::hypot` against overflow, which coordinates of unit size do not need.
#[inline(always)]
fn distance(dx: f64, dy: f64) -> f64 {
    (dx * dx + dy * dy).sqrt()
}

/// The area of the polygon through the points, positive counter-clockwise, and that of its triangles about the origin.
#[inline(always)]
fn signed_area(xs: &[f64], ys: &[f64]) -> (f64, f64) {
    let last = xs.len() - 1;
    let closing = xs[last] * ys[0] - xs[0] * ys[last];
    let (mut area, mut absolute) = ([0.0; 8], [0.0; 8]);
    let from = xs[..last].chunks(8).zip(ys[..last].chunks(8));
    let to = xs[1..].chunks(8).zip(ys[1..].chunks(8));
    for ((x0, y0), (x1, y1)) in from.zip(to) {
        let sums = area.iter_mut().zip(&mut absolute);
        for ((area, absolute), ((x0, y0), (x1, y1))) in sums.zip(x0.iter().zip(y0).zip(x1.iter().zip(y1))) {
            let cross = x0 * y1 - x1 * y0;
            *area += cross;
            *absolute += cross.abs();
        }
    }
    (0.5 * (closing + area.iter().sum::<f64>()), 0.5 * (closing.abs() + absolute.iter().sum::<f64>()))
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::open_outline::{OpenArc, OpenOutline};

    fn circle(count: usize) -> Vec<Point2<f64>> {
        let angle = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
        (0..count).map(|i| Point2::new(angle(i).cos() + 5.0, angle(i).sin() - 3.0)).collect()
    }

    fn radial_error(points: &[Point2<f64>], normals: &[Vector2<f64>]) -> f64 {
        let centre = Point2::new(5.0, -3.0);
        points.iter().zip(normals).map(|(p, n)| (n - (p - centre)).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn normals_of_a_circle_point_away_from_its_centre_whichever_way_round_it_runs() {
        for count in [5, 12, 400] {
            let mut points = circle(count);
            for _ in 0..2 {
                let outline = Outline::closed(points.clone()).expect("a circle");
                assert!(radial_error(&points, &outward_normals(&outline, 0.02)) < 1e-9);
                points.reverse();
            }
        }
    }

    #[test]
    fn normals_near_an_open_end_stay_within_the_turn_of_half_a_window() {
        let points = circle(400)[..320].to_vec();
        let arc = OpenArc::new(points.clone()).expect("an arc");
        let outline = Outline::Open(OpenOutline::new(vec![arc]).expect("one arc"));
        assert!(radial_error(&points, &outward_normals(&outline, 0.02)) < 0.02 * std::f64::consts::TAU);
    }

    #[test]
    fn repeated_points_have_the_normal_of_their_surroundings() {
        let points: Vec<_> = circle(40).into_iter().flat_map(|p| [p; 5]).collect();
        let outline = Outline::closed(points.clone()).expect("a circle");
        assert!(radial_error(&points, &outward_normals(&outline, 0.02)) < 0.1);
    }

    #[test]
    fn points_whose_distances_overflow_have_no_normals() {
        let points = circle(40);
        let (xs, ys): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (1e300 * p.x, 1e300 * p.y)).unzip();
        let outline = Outline::closed(points).expect("a circle");
        let (mut nx, mut ny) = (Vec::new(), Vec::new());
        NormalRegression::default().run(&outline, [&xs, &ys], 0.02, [&mut nx, &mut ny]);
        assert!(nx.len() == 40 && nx.iter().chain(&ny).all(|n| *n == 0.0));
    }

    #[test]
    fn the_starting_point_does_not_matter() {
        let mut points = circle(100);
        points.iter_mut().enumerate().for_each(|(i, p)| p.x += 0.01 * (7.0 * i as f64).sin());
        let normals = outward_normals(&Outline::closed(points.clone()).expect("closed"), 0.02);
        points.rotate_left(37);
        let rotated = outward_normals(&Outline::closed(points).expect("closed"), 0.02);
        for (i, n) in rotated.iter().enumerate() {
            assert!((n - normals[(i + 37) % 100]).norm() < 1e-10);
        }
    }
}
