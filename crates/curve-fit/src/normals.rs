//! Unit normals of a noisy outline by local regression.
use std::ops::Range;

use nalgebra::Vector2;
use pulp::Arch;

use crate::outline::Outline;

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

/// Reused buffers of the regression.
#[derive(Debug, Default, Clone)]
pub(crate) struct NormalRegression {
    /// Distance of every point to the one before it in its piece; 0 at an open beginning.
    steps: Vec<f64>,
    /// Arc lengths along one piece, with enough neighbours repeated beyond its ends if it is closed.
    arc_lengths: Vec<f64>,
    /// Running sums along the same, one more than there are arc lengths.
    sums: Vec<RunningSums>,
}

/// Sums over all points of the extended piece before one.
#[derive(Debug, Clone, Copy, Default)]
struct RunningSums {
    sum_s: f64,
    sum_x: f64,
    sum_y: f64,
    sum_sx: f64,
    sum_sy: f64,
}

impl NormalRegression {
    /// Fills `nx`, `ny` with the outward normals of the points `[xs, ys]`, which are those of `outline` after some
    /// similarity without reflection. A point whose surroundings have no direction gets a zero normal.
    pub(crate) fn run(
        &mut self,
        outline: &Outline,
        [xs, ys]: [&[f64]; 2],
        half_window: f64,
        [nx, ny]: [&mut Vec<f64>; 2],
    ) {
        assert!((0.0..=0.25).contains(&half_window), "half window {half_window} outside 0 to 0.25");
        for normals in [&mut *nx, &mut *ny] {
            normals.clear();
            normals.resize(xs.len(), 0.0);
        }
        let outward = 1.0_f64.copysign(signed_area(xs, ys));
        self.measure_steps(outline, xs, ys);
        // A hair less than the window, so that rounding does not decide whether evenly spaced points lie on its edge.
        let half_length = (1.0 - 1e-9) * half_window * self.steps.iter().sum::<f64>();
        for (range, closed) in ranges(outline) {
            let before = self.lay_out(xs, ys, range.clone(), closed, half_length);
            let (mut low, mut high) = (0, before);
            for (i, (nx, ny)) in (before..).zip(nx[range.clone()].iter_mut().zip(&mut ny[range])) {
                let s = self.arc_lengths[i];
                low = advance(low, &self.arc_lengths, s - half_length);
                // The window ends after the first point at or beyond it.
                high = advance(high.max(i), &self.arc_lengths, s + half_length);
                let end = (high + 2).min(self.arc_lengths.len());
                let begin = low.min(i.saturating_sub(1));
                let (tx, ty) = slope(&self.sums[begin], &self.sums[end], (end - begin) as f64);
                (*nx, *ny) = (outward * ty, -outward * tx);
            }
        }
        Arch::new().dispatch(|| scale_to_unit_length(nx, ny));
    }

    fn measure_steps(&mut self, outline: &Outline, xs: &[f64], ys: &[f64]) {
        self.steps.clear();
        self.steps.resize(xs.len(), 0.0);
        Arch::new().dispatch(|| distances_to_previous(xs, ys, &mut self.steps));
        for (range, closed) in ranges(outline) {
            let (first, last) = (range.start, range.end - 1);
            self.steps[first] = if closed { distance(xs[first] - xs[last], ys[first] - ys[last]) } else { 0.0 };
        }
    }

    /// Lays out a piece with its neighbours beyond both ends (closed pieces only) and the running sums. Returns how many
    /// points stand before the first.
    fn lay_out(&mut self, xs: &[f64], ys: &[f64], range: Range<usize>, closed: bool, half_length: f64) -> usize {
        let (start, count) = (range.start, range.len());
        let steps = &self.steps[range];
        let (before, after) = if closed {
            (nodes_to_cover(half_length, steps.iter().rev(), count), nodes_to_cover(half_length, steps.iter(), count))
        } else {
            (0, 0)
        };
        self.arc_lengths.clear();
        self.sums.clear();
        let (mut s, mut sums) = (0.0, RunningSums::default());
        let mut i = (count - before) % count;
        for n in 0..before + count + after {
            if n > 0 {
                s += steps[i];
            }
            let (x, y) = (xs[start + i], ys[start + i]);
            self.arc_lengths.push(s);
            self.sums.push(sums);
            sums.sum_s += s;
            sums.sum_x += x;
            sums.sum_y += y;
            sums.sum_sx += s * x;
            sums.sum_sy += s * y;
            i = if i + 1 == count { 0 } else { i + 1 };
        }
        self.sums.push(sums);
        before
    }
}

/// The last index from `from` on whose successor is not beyond `limit`: where evenly spread points are passed, one or two
/// at a time, the way there has no branch to mispredict.
fn advance(from: usize, arc_lengths: &[f64], limit: f64) -> usize {
    let last = arc_lengths.len() - 1;
    let mut index = from;
    for _ in 0..2 {
        index += usize::from(index < last && arc_lengths[(index + 1).min(last)] <= limit);
    }
    while index < last && arc_lengths[index + 1] <= limit {
        index += 1;
    }
    index
}

/// How many steps reach at least `length`, and one more; at most `count`.
fn nodes_to_cover<'a>(length: f64, steps: impl Iterator<Item = &'a f64>, count: usize) -> usize {
    let mut covered = 0.0;
    let short = steps.take_while(|&step| {
        covered += step;
        covered < length
    });
    (short.count() + 2).min(count)
}

/// Covariance of arc length with position over the points from `a` to before `b`, up to a positive factor: the direction
/// of the regression line.
fn slope(a: &RunningSums, b: &RunningSums, count: f64) -> (f64, f64) {
    let mean_s = (b.sum_s - a.sum_s) / count;
    let tx = (b.sum_sx - a.sum_sx) - mean_s * (b.sum_x - a.sum_x);
    let ty = (b.sum_sy - a.sum_sy) - mean_s * (b.sum_y - a.sum_y);
    (tx, ty)
}

/// Scales vectors to length 1; zero vectors stay zero.
#[inline(always)]
fn scale_to_unit_length(xs: &mut [f64], ys: &mut [f64]) {
    for (x, y) in xs.iter_mut().zip(ys) {
        let norm = distance(*x, *y);
        let scale = if norm > 0.0 { 1.0 / norm } else { 0.0 };
        (*x, *y) = (*x * scale, *y * scale);
    }
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

fn signed_area(xs: &[f64], ys: &[f64]) -> f64 {
    let last = xs.len() - 1;
    let along: f64 = (1..xs.len()).map(|i| xs[i - 1] * ys[i] - xs[i] * ys[i - 1]).sum();
    0.5 * (along + xs[last] * ys[0] - xs[0] * ys[last])
}

/// The index ranges of the pieces among all points, and whether each is closed.
fn ranges(outline: &Outline) -> impl Iterator<Item = (Range<usize>, bool)> + '_ {
    outline.pieces().scan(0, |start, piece| {
        let range = *start..*start + piece.points.len();
        *start = range.end;
        Some((range, piece.closed))
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::outline::{OpenArc, OpenOutline};

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
