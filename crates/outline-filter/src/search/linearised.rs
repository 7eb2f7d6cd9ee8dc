//! Points of a frame linearised in a pose of a search: how far each is from the outline, and how a unit of each parameter of the motion moves it there.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, is_affine, map_point_by, pull_back_by};
use nalgebra::{Matrix3, Point2, Vector2};

use crate::{
    map::{NullDirection, OutlineMap},
    vectors::{LANES, Lanes, vectorised},
};

/// Points as they are seen in a pose, given by its inverse, and the outline that they are brought onto.
pub(super) struct Seen<'a> {
    pub(super) points: &'a [Point2<f64>],
    pub(super) inverse: &'a Matrix3<f64>,
    pub(super) map: &'a OutlineMap,
    pub(super) offsets: &'a [f64],
}

impl Seen<'_> {
    /// Finds the cell of each point.
    #[inline(always)]
    fn associate<const AFFINE: bool>(&self, numbers: &mut [u32]) {
        let Self { points, inverse, map, .. } = self;
        map.associate_all(
            points.iter().map(
                #[inline(always)]
                |p| map_point_by::<AFFINE>(inverse, p),
            ),
            numbers,
        );
    }
}

/// Normal equations with Tukey's weights: their matrix, and their right-hand side.
pub(super) type Equations<const K: usize> = ([[f64; K]; K], [f64; K]);

/// Points linearised for a motion of K parameters.
pub(super) trait Linearised<const K: usize> {
    /// Linearises points in a pose; `numbers` has room for the cell of each.
    fn take(&mut self, seen: &Seen<'_>, numbers: &mut [u32]);

    /// Keeps steps off a direction that the outline does not show.
    fn leave_out(&mut self, direction: &NullDirection);

    /// Sizes of the residuals of points that have one, in the order of the points.
    fn write_sizes(&self, sizes: &mut Vec<f64>);

    /// With weights that are zero from a residual of `scale` on. Points that do not count add nothing.
    fn equations(&self, scale: f64) -> Equations<K>;
}

/// Residual of a point, infinite where it has none, and how far a unit of each parameter of the motion moves the outline there.
type Row<const K: usize> = (f64, [f64; K]);

/// The plain way, row by row, for all models and outlines.
pub(super) struct Rows<const K: usize> {
    model: MotionModel,
    rows: Vec<Row<K>>,
}

impl<const K: usize> Rows<K> {
    /// With room for so many points.
    pub(super) fn new(model: MotionModel, points: usize) -> Self {
        Self { model, rows: vec![(0.0, [0.0; K]); points] }
    }

    #[inline(always)]
    fn linearise<const AFFINE: bool>(
        &mut self,
        seen: &Seen<'_>,
        numbers: &mut [u32],
        velocities: impl Fn(&Point2<f64>, &Vector2<f64>) -> ParameterVector,
    ) {
        let Seen { points, inverse, map, offsets } = seen;
        seen.associate::<AFFINE>(numbers);
        let cells = map.cells();
        for ((p, number), row) in points.iter().zip(numbers).zip(&mut self.rows) {
            let q = map_point_by::<AFFINE>(inverse, p);
            let (cell, offset) = (&cells[*number as usize], offsets[*number as usize]);
            let distance = cell.normal.x * (q.x - cell.centre.x) + cell.normal.y * (q.y - cell.centre.y) - offset;
            let pulled = pull_back_by::<AFFINE>(inverse, p, &q, &cell.normal);
            let slope = 1.0 / (pulled.x * pulled.x + pulled.y * pulled.y).sqrt();
            let (residual, normal) = (distance * slope, pulled * slope);
            let along = velocities(&(p - residual * normal), &normal);
            // Beyond a known end nothing says where a point should lie.
            row.0 = if map.lies_beyond_end(*number as usize, &q) { f64::INFINITY } else { residual };
            row.1.copy_from_slice(&along[..K]);
        }
    }
}

impl<const K: usize> Linearised<K> for Rows<K> {
    fn take(&mut self, seen: &Seen<'_>, numbers: &mut [u32]) {
        let model = self.model;
        vectorised(
            #[inline(always)]
            || match (model, is_affine(seen.inverse)) {
                (MotionModel::Rigid, true) => {
                    self.linearise::<true>(seen, numbers, |p, n| MotionModel::Rigid.normal_velocities(p, n));
                }
                (_, true) => self.linearise::<true>(seen, numbers, |p, n| model.normal_velocities(p, n)),
                (_, false) => self.linearise::<false>(seen, numbers, |p, n| model.normal_velocities(p, n)),
            },
        );
    }

    fn leave_out(&mut self, direction: &NullDirection) {
        for (_, row) in &mut self.rows {
            let mut jacobian = [0.0; MAX_PARAMETERS];
            jacobian[..K].copy_from_slice(row);
            direction.project_out(&mut jacobian);
            row.copy_from_slice(&jacobian[..K]);
        }
    }

    fn write_sizes(&self, sizes: &mut Vec<f64>) {
        sizes.clear();
        sizes.extend(self.rows.iter().map(|(residual, _)| residual.abs()).filter(|size| size.is_finite()));
    }

    fn equations(&self, scale: f64) -> Equations<K> {
        vectorised(
            #[inline(always)]
            || weighted_sums(&self.rows, 1.0 / scale),
        )
    }
}

/// Normal equations with Tukey's weights, for the inverse of their scale.
#[inline(always)]
fn weighted_sums<const K: usize>(rows: &[Row<K>], scale: f64) -> Equations<K> {
    let (mut gram, mut right) = ([[0.0; K]; K], [0.0; K]);
    for (residual, row) in rows {
        let u = residual * scale;
        let kept = 1.0 - u * u;
        // Points that do not count are left out: their rows may be no numbers, which nothing multiplied by zero takes back.
        if kept.is_nan() || kept <= 0.0 {
            continue;
        }
        let weight = kept * kept;
        for i in 0..K {
            let weighted = weight * row[i];
            right[i] += residual * weighted;
            for j in 0..K {
                gram[i][j] += weighted * row[j];
            }
        }
    }
    (gram, right)
}

/// The points of a rigid motion side by side in the lanes of the processor, of affine poses and outlines without ends; a test compares them with
/// [`Rows`].
#[derive(Default)]
pub(super) struct SideBySide {
    count: usize,
    /// Normals of the cells of points, and where along them the outline lies, in the body frame.
    lines: Vec<Lanes>,
    /// Residuals, and by how much a turn and shifts along the axes move the outline. Numbers beyond those of the points fill the last lanes.
    columns: [Vec<Lanes>; 4],
}

impl SideBySide {
    #[inline(always)]
    fn linearise(&mut self, seen: &Seen<'_>, numbers: &mut [u32]) {
        let Seen { points, inverse, map, offsets } = seen;
        seen.associate::<true>(numbers);
        // What lies anywhere is looked up first: the loop after that runs in vectors.
        let (cells, lines) = (map.cells(), self.lines.as_mut_slice());
        for (line, number) in lines.iter_mut().zip(numbers) {
            let (cell, offset) = (&cells[*number as usize], offsets[*number as usize]);
            let at = cell.normal.x * cell.centre.x + cell.normal.y * cell.centre.y + offset;
            *line = [cell.normal.x, cell.normal.y, at, 0.0];
        }
        let (points, last_points) = points.as_chunks::<LANES>();
        let (lines, last_lines) = lines.as_chunks::<LANES>();
        let [residuals, turns, along_x, along_y] = &mut self.columns;
        let columns = residuals.iter_mut().zip(turns).zip(along_x.iter_mut().zip(along_y));
        let mut of_columns = columns.map(
            #[inline(always)]
            |((residual, turn), (u, v))| [residual, turn, u, v],
        );
        for ((points, lines), columns) in points.iter().zip(lines).zip(&mut of_columns) {
            linearise_lanes(points, lines, inverse, columns);
        }
        if let Some([residual, turn, u, v]) = of_columns.next() {
            // The lanes that are left over go along with the last point, and have no residual.
            let (mut points, mut lines) = ([Point2::origin(); LANES], [[1.0, 0.0, 0.0, 0.0]; LANES]);
            points[..last_points.len()].copy_from_slice(last_points);
            lines[..last_lines.len()].copy_from_slice(last_lines);
            linearise_lanes(&points, &lines, inverse, [&mut *residual, turn, u, v]);
            residual[last_points.len()..].fill(f64::INFINITY);
        }
    }

    #[inline(always)]
    fn weighted_sums(&self, scale: f64) -> [Lanes; 9] {
        let [residuals, turns, along_x, along_y] = &self.columns;
        let mut sums = [[0.0; LANES]; 9];
        let columns = residuals.iter().zip(turns).zip(along_x.iter().zip(along_y));
        for ((residual, a), (b, c)) in columns {
            let (mut weight, mut r) = ([0.0; LANES], [0.0; LANES]);
            for lane in 0..LANES {
                let u = residual[lane] * scale;
                let kept = 1.0 - u * u;
                // As in the plain way; no number is not greater than zero. Normals of an affine pose are numbers always.
                weight[lane] = if kept > 0.0 { kept * kept } else { 0.0 };
                r[lane] = if kept > 0.0 { residual[lane] } else { 0.0 };
            }
            let (wa, wb, wc) = (product(&weight, a), product(&weight, b), product(&weight, c));
            let [aa, ab, ac, bb, bc, cc, ra, rb, rc] = &mut sums;
            add_product(aa, &wa, a);
            add_product(ab, &wa, b);
            add_product(ac, &wa, c);
            add_product(bb, &wb, b);
            add_product(bc, &wb, c);
            add_product(cc, &wc, c);
            add_product(ra, &wa, &r);
            add_product(rb, &wb, &r);
            add_product(rc, &wc, &r);
        }
        sums
    }
}

/// Points linearised in a pose, given by its inverse, on the lines of their cells. Step by step for all lanes, and written in the end: the compiler
/// does not turn into vectors what might overwrite what is still to be read.
#[inline(always)]
fn linearise_lanes(
    points: &[Point2<f64>; LANES],
    lines: &[Lanes; LANES],
    inverse: &Matrix3<f64>,
    [residual, turn, u, v]: [&mut Lanes; 4],
) {
    let (a, b, c) =
        ([inverse[(0, 0)], inverse[(1, 0)]], [inverse[(0, 1)], inverse[(1, 1)]], [inverse[(0, 2)], inverse[(1, 2)]]);
    let [mut px, mut py, mut x, mut y, mut at] = [[0.0; LANES]; 5];
    for lane in 0..LANES {
        (px[lane], py[lane]) = (points[lane].x, points[lane].y);
        [x[lane], y[lane], at[lane], _] = lines[lane];
    }
    let [mut pulled_x, mut pulled_y, mut distance, mut slope, mut turned] = [[0.0; LANES]; 5];
    for lane in 0..LANES {
        pulled_x[lane] = x[lane] * a[0] + y[lane] * a[1];
        pulled_y[lane] = x[lane] * b[0] + y[lane] * b[1];
        let from = x[lane] * c[0] + y[lane] * c[1] - at[lane];
        distance[lane] = pulled_x[lane] * px[lane] + pulled_y[lane] * py[lane] + from;
        slope[lane] = 1.0 / (pulled_x[lane] * pulled_x[lane] + pulled_y[lane] * pulled_y[lane]).sqrt();
    }
    let (along_x, along_y) = (product(&pulled_x, &slope), product(&pulled_y, &slope));
    for lane in 0..LANES {
        // Of the foot of the point, which lies along the normal.
        turned[lane] = along_x[lane] * py[lane] - along_y[lane] * px[lane];
    }
    (*residual, *turn, *u, *v) = (product(&distance, &slope), turned, along_x, along_y);
}

#[inline(always)]
fn product(a: &Lanes, b: &Lanes) -> Lanes {
    let mut product = [0.0; LANES];
    for lane in 0..LANES {
        product[lane] = a[lane] * b[lane];
    }
    product
}

#[inline(always)]
fn add_product(sum: &mut Lanes, a: &Lanes, b: &Lanes) {
    for lane in 0..LANES {
        sum[lane] += a[lane] * b[lane];
    }
}

impl Linearised<3> for SideBySide {
    fn take(&mut self, seen: &Seen<'_>, numbers: &mut [u32]) {
        if self.count != seen.points.len() {
            self.count = seen.points.len();
            self.lines.resize(self.count, [0.0; LANES]);
            self.columns
                .iter_mut()
                .for_each(|column| column.resize(self.count.div_ceil(LANES), [f64::INFINITY; LANES]));
        }
        vectorised(
            #[inline(always)]
            || self.linearise(seen, numbers),
        );
    }

    fn leave_out(&mut self, direction: &NullDirection) {
        let [_, turns, along_x, along_y] = &mut self.columns;
        for ((turn, x), y) in turns.iter_mut().zip(along_x).zip(along_y) {
            for lane in 0..LANES {
                let mut jacobian = [0.0; MAX_PARAMETERS];
                jacobian[..3].copy_from_slice(&[turn[lane], x[lane], y[lane]]);
                direction.project_out(&mut jacobian);
                (turn[lane], x[lane], y[lane]) = (jacobian[0], jacobian[1], jacobian[2]);
            }
        }
    }

    fn write_sizes(&self, sizes: &mut Vec<f64>) {
        sizes.clear();
        let residuals = self.columns[0].as_flattened();
        sizes.extend(residuals[..self.count].iter().map(|residual| residual.abs()));
        if !sizes.iter().fold(true, |all, size| all & size.is_finite()) {
            sizes.retain(|size| size.is_finite());
        }
    }

    fn equations(&self, scale: f64) -> Equations<3> {
        let sums = vectorised(
            #[inline(always)]
            || self.weighted_sums(1.0 / scale),
        );
        let [aa, ab, ac, bb, bc, cc, a, b, c] = sums.map(|lanes| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]));
        ([[aa, ab, ac], [ab, bb, bc], [ac, bc, cc]], [a, b, c])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        drawn_curves::{lobed, outline, polar},
        measurement::Frame,
        track::Track,
    };

    #[test]
    fn points_that_do_not_count_add_nothing_even_where_they_are_no_numbers() {
        let good = [(0.1, [1.0, 0.5, -0.2]), (-0.3, [0.4, 1.0, 0.7])];
        let sums = weighted_sums(&good, 1.0);
        for bad in [(f64::NAN, [1.0; 3]), (f64::INFINITY, [1.0; 3]), (2.0, [f64::NAN; 3]), (1.0, [f64::INFINITY; 3])] {
            assert_eq!(weighted_sums(&[good[0], bad, good[1]], 1.0), sums, "{bad:?}");
        }
        assert!(sums.1.iter().all(|sum| *sum != 0.0), "{sums:?}");
    }

    #[test]
    fn points_side_by_side_give_the_equations_of_those_row_by_row() {
        let shown =
            |turn: f64, count| outline(count, |t| polar(lobed(t, &[(3.0, [0.25, 0.0]), (2.0, [0.0, 0.1])]), t + turn));
        let mut frame = Frame::default();
        let track = Track::begin(MotionModel::Rigid, &shown(0.0, 400), 0.0, &mut frame).expect("a track");
        let view = track.view();
        for (number, count) in [400, 80, 81, 82, 83].into_iter().enumerate() {
            frame.load(&shown(0.3 * number as f64, count), track.reference());
            // Stretched too, as a pose of another model.
            let stretch = 1.0 + 0.1 * number as f64;
            let pose = Matrix3::new(0.8 * stretch, -0.6, 0.1, 0.6 * stretch, 0.8, -0.05, 0.0, 0.0, 1.0);
            let inverse = pose.try_inverse().expect("an inverse");
            let offsets = view.belief.offsets.as_slice();
            let seen = Seen { points: &frame.points, inverse: &inverse, map: view.map, offsets };
            let mut numbers = vec![0; count as usize];
            let (mut rows, mut lanes) = (Rows::<3>::new(MotionModel::Rigid, count as usize), SideBySide::default());
            rows.take(&seen, &mut numbers);
            lanes.take(&seen, &mut numbers);
            let mut sizes = [Vec::new(), Vec::new()];
            rows.write_sizes(&mut sizes[0]);
            lanes.write_sizes(&mut sizes[1]);
            assert_eq!(sizes[0].len(), sizes[1].len());
            assert!(sizes[0].iter().zip(&sizes[1]).all(|(a, b)| (a - b).abs() < 1e-12), "{count}");
            for is_reduced in [false, true] {
                if is_reduced {
                    let direction = [0.6, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                    let null = NullDirection { direction, dual: direction };
                    rows.leave_out(&null);
                    lanes.leave_out(&null);
                }
                // Some points count, others do not.
                for scale in [0.05, 0.2, 10.0] {
                    let (expected, found) = (rows.equations(scale), lanes.equations(scale));
                    let all = |(gram, right): Equations<3>| gram.into_iter().flatten().chain(right).collect::<Vec<_>>();
                    for (a, b) in all(expected).into_iter().zip(all(found)) {
                        assert!((a - b).abs() < 1e-10, "{count} {scale}: {expected:?} {found:?}");
                    }
                    assert!(expected.0[0][0] > 0.0);
                }
            }
        }
    }
}
