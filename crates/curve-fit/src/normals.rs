//! Unit normals of a noisy outline by local regression.
use std::ops::Range;

use nalgebra::Vector2;
use pulp::{Arch, Simd, WithSimd};

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

/// Area of an outline relative to what it encloses one way round and the other, below which its sign is rounding.
const NO_AREA: f64 = 1e-9;

/// The regression of [`outward_normals`] in buffers that are reused, for points that have been moved since they were taken.
#[derive(Debug, Default, Clone)]
pub struct NormalRegression {
    /// Whether the area of the last outline told which side of it is the inside.
    pub(crate) has_inside: bool,
    /// Distance of every point to the one before it in its piece; 0 at an open beginning.
    steps: Vec<f64>,
    /// Arc lengths along one piece, with enough neighbours repeated beyond its ends if it is closed, and infinity after
    /// the last.
    arc_lengths: Vec<f64>,
    /// Running sums along the same, one more than there are nodes.
    sums: Vec<RunningSums>,
}

/// Sums over all nodes of the extended piece before one: of s, x, y, s x and s y.
type RunningSums = [f64; 5];

impl NormalRegression {
    /// Fills `nx`, `ny` with the outward unit normals of the points `[xs, ys]`, which are those of `outline` after a smooth map
    /// of the plane without reflection; `half_window` as in [`outward_normals`]. A point whose surroundings have no direction
    /// gets a zero normal. Best in coordinates of about the outline's own size, near the origin.
    ///
    /// # Panics
    /// If `half_window` is outside 0 to 0.25, or `xs` and `ys` do not hold one value per point of the outline.
    pub fn run(&mut self, outline: &Outline, [xs, ys]: [&[f64]; 2], half_window: f64, [nx, ny]: [&mut Vec<f64>; 2]) {
        assert!((0.0..=0.25).contains(&half_window), "half window {half_window} outside 0 to 0.25");
        assert_eq!([xs.len(), ys.len()], [outline.point_count(); 2], "one coordinate per point");
        for normals in [&mut *nx, &mut *ny] {
            normals.clear();
            normals.resize(xs.len(), 0.0);
        }
        Arch::new().dispatch(NormalKernel {
            regression: self,
            outline,
            points: [xs, ys],
            half_window,
            normals: [nx, ny],
        });
    }

    #[inline(always)]
    fn measure_steps(&mut self, outline: &Outline, xs: &[f64], ys: &[f64]) {
        self.steps.clear();
        self.steps.resize(xs.len(), 0.0);
        distances_to_previous(xs, ys, &mut self.steps);
        for (range, closed) in ranges(outline) {
            let (first, last) = (range.start, range.end - 1);
            self.steps[first] = if closed { distance(xs[first] - xs[last], ys[first] - ys[last]) } else { 0.0 };
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
        self.arc_lengths.resize(nodes + 1, 0.0);
        self.sums.resize(nodes + 1, [0.0; 5]);
        let mut slots = self.arc_lengths.iter_mut().zip(&mut self.sums);
        // The first node stands at 0.
        let mut s = -steps[(count - before) % count];
        let mut sums = [0.0; 5];
        for part in [count - before..count, 0..count, 0..after] {
            let points = xs[part.clone()].iter().zip(&ys[part.clone()]).zip(&steps[part]);
            for (((x, y), step), (arc_length, slot)) in points.zip(&mut slots) {
                s += step;
                *arc_length = s;
                *slot = sums;
                for (sum, term) in sums.iter_mut().zip([s, *x, *y, s * x, s * y]) {
                    *sum += term;
                }
            }
        }
        self.arc_lengths[nodes] = f64::INFINITY;
        self.sums[nodes] = sums;
        before
    }

    /// The normals of a piece whose first point is node `before`.
    #[inline(always)]
    fn regress(&self, before: usize, half_length: f64, outward: f64, [nx, ny]: [&mut [f64]; 2]) {
        let (arc_lengths, sums) = (self.arc_lengths.as_slice(), self.sums.as_slice());
        let nodes = arc_lengths.len() - 1;
        let (mut low, mut high) = (0, before);
        for (node, (nx, ny)) in (before..nodes).zip(nx.iter_mut().zip(ny)) {
            let s = arc_lengths[node];
            low = advance(low, arc_lengths, s - half_length);
            // A window holds the nodes within it, the first ones beyond and a neighbour on either side.
            high = advance(high.max(node), arc_lengths, s + half_length);
            let begin = low.min(node.saturating_sub(1));
            let end = (high + 2).min(nodes);
            let (tx, ty) = slope(&sums[begin], &sums[end], f64::from((end - begin) as u32));
            let norm = outward * distance(tx, ty);
            let scale = if norm == 0.0 { 0.0 } else { 1.0 / norm };
            (*nx, *ny) = (scale * ty, -scale * tx);
        }
    }
}

/// The whole regression, in a form that is compiled for the vector instructions that the machine has.
struct NormalKernel<'a> {
    regression: &'a mut NormalRegression,
    outline: &'a Outline,
    points: [&'a [f64]; 2],
    half_window: f64,
    normals: [&'a mut [f64]; 2],
}

impl WithSimd for NormalKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { regression, outline, points: [xs, ys], half_window, normals: [nx, ny] } = self;
        let (area, absolute) = signed_area(xs, ys);
        regression.has_inside = area.abs() > NO_AREA * absolute;
        let outward = 1.0_f64.copysign(area);
        regression.measure_steps(outline, xs, ys);
        // A hair less than the window, so that rounding does not decide whether evenly spaced points lie on its edge.
        let half_length = (1.0 - 1e-9) * half_window * regression.steps.iter().sum::<f64>();
        for (range, closed) in ranges(outline) {
            let before = regression.lay_out(xs, ys, range.clone(), closed, half_length);
            let piece = [&mut nx[range.clone()], &mut ny[range]];
            regression.regress(before, half_length, outward, piece);
        }
    }
}

/// The last node at or before `limit`, from one that is or the first on.
#[inline(always)]
fn advance(from: usize, arc_lengths: &[f64], limit: f64) -> usize {
    let mut node = from;
    // Evenly spread points pass one or two nodes at a time: no branch to mispredict there.
    while let Some(ahead) = arc_lengths[node..].first_chunk::<4>() {
        let passed: u32 = ahead[1..].iter().map(|&s| u32::from(s <= limit)).sum();
        node += passed as usize;
        if passed < 3 {
            return node;
        }
    }
    while arc_lengths[node + 1] <= limit {
        node += 1;
    }
    node
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

/// Covariance of arc length with position over the nodes from `a` to before `b`, up to a positive factor: the direction
/// of the regression line.
#[inline(always)]
fn slope(a: &RunningSums, b: &RunningSums, count: f64) -> (f64, f64) {
    let [s, x, y, sx, sy] = std::array::from_fn(|k| b[k] - a[k]);
    (count * sx - s * x, count * sy - s * y)
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
    let (mut area, mut absolute) = (closing, closing.abs());
    for i in 1..xs.len() {
        let cross = xs[i - 1] * ys[i] - xs[i] * ys[i - 1];
        area += cross;
        absolute += cross.abs();
    }
    (0.5 * area, 0.5 * absolute)
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
