//! What one frame says of a polynomial: the sums of its 3L problem, taken in the body frame.
use freeform_curve_fit::{
    Degree, MAX_COEFFICIENTS, Moments, NormalRegression, Outline, exponents, monomial_index, rotation_invariant_ridge,
};
use nalgebra::{Matrix3, Point2};

use crate::{filter::median, motion_algebra::map_point};

/// Standard deviation of noise from the median of its absolute values.
const NORMAL_MEDIAN: f64 = 1.4826;
/// Values of the polynomial up to which points always count...
const LEAST_GATE: f64 = 1.0;
/// ...and up to how many times the usual value they do.
const GATE: f64 = 5.0;
/// Points evaluated together.
const CHUNK: usize = 8;

/// The normal equations `G a = h` of `min |M a - d|^2` for one frame (Blane, Lei, Civi, Cooper 2000), in buffers that are reused.
/// Points are mapped back to the body frame first; normals and offsets are taken there, so that they go along with affine
/// and projective motion.
#[derive(Debug, Clone)]
pub(super) struct LevelSums {
    degree: Degree,
    offset: f64,
    half_window: f64,
    /// In the normalised image.
    points: [Vec<f64>; 2],
    body: [Vec<f64>; 2],
    normals: [Vec<f64>; 2],
    kept: [Vec<f64>; 2],
    kept_normals: [Vec<f64>; 2],
    values: Vec<f64>,
    regression: NormalRegression,
    /// `G = M' M` by columns.
    pub(super) gram: Vec<f64>,
    /// `h = M' d`.
    pub(super) projection: [f64; MAX_COEFFICIENTS],
    /// Points that count.
    pub(super) count: usize,
    /// Mean of the squared values of the polynomial, each at most 1.
    pub(super) misfit: f64,
    /// Mean square of the values that count.
    pub(super) mean_square: f64,
}

impl LevelSums {
    pub(super) fn new(degree: Degree, offset: f64, half_window: f64) -> Self {
        Self {
            degree,
            offset,
            half_window,
            points: Default::default(),
            body: Default::default(),
            normals: Default::default(),
            kept: Default::default(),
            kept_normals: Default::default(),
            values: Vec::new(),
            regression: NormalRegression::default(),
            gram: vec![0.0; degree.coefficient_count().pow(2)],
            projection: [0.0; MAX_COEFFICIENTS],
            count: 0,
            misfit: 1.0,
            mean_square: 0.0,
        }
    }

    /// Takes the points of an outline into normalised coordinates.
    pub(super) fn load(&mut self, outline: &Outline, origin: &Point2<f64>, radius: f64) {
        let scale = 1.0 / radius;
        let [xs, ys] = &mut self.points;
        xs.clear();
        ys.clear();
        for piece in outline.pieces() {
            xs.extend(piece.points.iter().map(|p| (p.x - origin.x) * scale));
            ys.extend(piece.points.iter().map(|p| (p.y - origin.y) * scale));
        }
    }

    /// Mean of the loaded points.
    pub(super) fn centroid(&self) -> Point2<f64> {
        let count = self.points[0].len() as f64;
        Point2::new(self.points[0].iter().sum::<f64>() / count, self.points[1].iter().sum::<f64>() / count)
    }

    /// Forms the sums with the points mapped to the body frame by `inverse`. Points that a polynomial, where one is given with the
    /// usual mean square of its values, says lie far off do not count.
    pub(super) fn measure(&mut self, outline: &Outline, inverse: &Matrix3<f64>, known: Option<(&[f64], f64)>) {
        self.map_back(inverse);
        let gate = self.judge_points(known);
        let [nx, ny] = &mut self.normals;
        self.regression.run(outline, [&self.body[0], &self.body[1]], self.half_window, [nx, ny]);
        self.keep_points(gate);
        self.count = self.kept[0].len();
        let degree = 2 * self.degree.value();
        let data = Moments::of(degree, &self.kept[0], &self.kept[1]);
        self.shift_by(self.offset);
        let outer = Moments::of(degree, &self.kept[0], &self.kept[1]);
        self.shift_by(-2.0 * self.offset);
        let inner = Moments::of(degree, &self.kept[0], &self.kept[1]);
        let [inner, data, outer] = [&inner, &data, &outer].map(Moments::as_slice);
        let size = self.degree.coefficient_count();
        for ((h, plus), minus) in self.projection.iter_mut().zip(outer).zip(inner).take(size) {
            *h = plus - minus;
        }
        for ((k, l), column) in exponents(self.degree.value()).zip(self.gram.chunks_exact_mut(size)) {
            for ((i, j), entry) in exponents(self.degree.value()).zip(column) {
                let position = monomial_index(i + k, j + l);
                *entry = inner[position] + data[position] + outer[position];
            }
        }
    }

    fn map_back(&mut self, inverse: &Matrix3<f64>) {
        let [bx, by] = &mut self.body;
        bx.clear();
        by.clear();
        let m = |i, j| inverse[(i, j)];
        let points = self.points[0].iter().zip(&self.points[1]);
        if m(2, 0) == 0.0 && m(2, 1) == 0.0 && m(2, 2) == 1.0 {
            bx.extend(points.clone().map(|(x, y)| m(0, 0) * x + m(0, 1) * y + m(0, 2)));
            by.extend(points.map(|(x, y)| m(1, 0) * x + m(1, 1) * y + m(1, 2)));
        } else {
            for (x, y) in points {
                let q = map_point(inverse, &Point2::new(*x, *y));
                bx.push(q.x);
                by.push(q.y);
            }
        }
    }

    /// Judges how well the polynomial goes with the frame; returns the largest value that counts. A point beyond it is put
    /// where the one before it is, so that it does not turn the normals of its neighbours.
    fn judge_points(&mut self, known: Option<(&[f64], f64)>) -> f64 {
        let Some((coefficients, mean_square)) = known else {
            self.values.clear();
            self.values.resize(self.body[0].len(), 0.0);
            return 0.0;
        };
        evaluate(self.degree.value(), coefficients, &self.body, &mut self.values);
        let gate = LEAST_GATE.max(GATE * mean_square.sqrt());
        let (mut clipped, mut squares, mut count) = (0.0, 0.0, 0usize);
        let mut last = None;
        for (i, value) in self.values.iter().enumerate() {
            // A value that is not a number lies nowhere.
            if value.abs() <= gate {
                clipped += (value * value).min(1.0);
                squares += value * value;
                count += 1;
                last = Some(i);
            } else {
                clipped += 1.0;
                if let Some(last) = last {
                    self.body.iter_mut().for_each(|axis| axis[i] = axis[last]);
                }
            }
        }
        self.misfit = clipped / self.values.len().max(1) as f64;
        self.mean_square = squares / count.max(1) as f64;
        gate
    }

    fn keep_points(&mut self, gate: f64) {
        for axis in 0..2 {
            let chosen = |from: &[f64], to: &mut Vec<f64>| {
                to.clear();
                to.extend(from.iter().zip(&self.values).filter(|(_, value)| value.abs() <= gate).map(|(p, _)| p));
            };
            chosen(&self.body[axis], &mut self.kept[axis]);
            chosen(&self.normals[axis], &mut self.kept_normals[axis]);
        }
    }

    /// Square of the usual value at all points measured last, by the median.
    pub(super) fn usual_square(&mut self) -> f64 {
        let mut sizes: Vec<f64> = self.values.iter().map(|v| v.abs()).collect();
        (NORMAL_MEDIAN * median(&mut sizes).unwrap_or(0.0)).powi(2)
    }

    /// Diagonal of the rotation-invariant ridge for the points measured last. Allocates nothing, but is slow.
    pub(super) fn ridge(&self) -> [f64; MAX_COEFFICIENTS] {
        let degree = self.degree.value();
        rotation_invariant_ridge(degree, &Moments::of(2 * degree, &self.body[0], &self.body[1]))
    }

    fn shift_by(&mut self, distance: f64) {
        for axis in 0..2 {
            let normals = &self.kept_normals[axis];
            self.kept[axis].iter_mut().zip(normals).for_each(|(p, n)| *p += distance * n);
        }
    }

    /// Standard deviation of the noise along the normals of the points measured last, body lengths: from how far points lie off
    /// the middle of their neighbours, by the median. Curvature over the spacing of the points is in it.
    pub(super) fn noise(&mut self) -> f64 {
        let n = self.body[0].len();
        let off = |i: usize| {
            let along = |axis: usize| {
                let p = &self.body[axis];
                self.normals[axis][i] * (p[i] - 0.5 * (p[i - 1] + p[i + 1]))
            };
            (along(0) + along(1)).abs()
        };
        self.values.clear();
        self.values.extend((1..n.max(1) - 1).map(off));
        NORMAL_MEDIAN / 1.5_f64.sqrt() * median(&mut self.values).unwrap_or(0.0)
    }
}

/// Values of a polynomial at points, by Horner's rule in y over Horner's rule in x.
fn evaluate(degree: usize, coefficients: &[f64], [xs, ys]: &[Vec<f64>; 2], out: &mut Vec<f64>) {
    out.clear();
    let mut x = [0.0; CHUNK];
    let mut y = [0.0; CHUNK];
    for (cx, cy) in xs.chunks(CHUNK).zip(ys.chunks(CHUNK)) {
        x[..cx.len()].copy_from_slice(cx);
        y[..cy.len()].copy_from_slice(cy);
        let mut sum = [0.0; CHUNK];
        for j in (0..=degree).rev() {
            let mut inner = [0.0; CHUNK];
            for i in (0..=degree - j).rev() {
                let a = coefficients[monomial_index(i, j)];
                inner.iter_mut().zip(&x).for_each(|(s, x)| *s = *s * x + a);
            }
            sum.iter_mut().zip(inner).zip(&y).for_each(|((s, i), y)| *s = *s * y + i);
        }
        out.extend_from_slice(&sum[..cx.len()]);
    }
}
