//! What is usually taken to recognise outlines: moment invariants of the region within.
use nalgebra::{Point2, Vector2};

/// Places and weights of the Gauss rule of three points on 0 to 1.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Central moments `mu_pq` of a polygon up to the third order, divided by the power of the area that makes them free of scale.
struct Moments([[f64; 4]; 4]);

impl Moments {
    fn of(points: &[Point2<f64>]) -> Self {
        let [area, x, y] = [(0, 0), (1, 0), (0, 1)].map(|pq| integral(points, pq, Vector2::zeros()));
        let centre = Vector2::new(x / area, y / area);
        let mut moments = [[0.0; 4]; 4];
        for (p, row) in moments.iter_mut().enumerate() {
            for (q, moment) in row.iter_mut().enumerate().take(4 - p) {
                let order = (p + q) as f64;
                *moment = integral(points, (p, q), centre) / area / area.abs().powf(order / 2.0);
            }
        }
        Self(moments)
    }
}

/// Integral of `(x - cx)^p (y - cy)^q` over the polygon, over triangles from the centre to the edges.
fn integral(points: &[Point2<f64>], (p, q): (usize, usize), centre: Vector2<f64>) -> f64 {
    let edges = points.iter().zip(points.iter().cycle().skip(1));
    let triangles = edges.map(|(a, b)| {
        let (a, b) = (a.coords - centre, b.coords - centre);
        let along = GAUSS.iter().map(|(t, weight)| {
            let r = a + *t * (b - a);
            weight * r.x.powi(p as i32) * r.y.powi(q as i32)
        });
        a.perp(&b) / (p + q + 2) as f64 * along.sum::<f64>()
    });
    triangles.sum()
}

/// The seven invariants of M.-K. Hu (Visual pattern recognition by moment invariants, 1962) under similarities, on the usual
/// logarithmic scale `sign(h) ln |h|`.
pub(crate) fn hu(points: &[Point2<f64>]) -> Vec<f64> {
    let Moments(m) = Moments::of(points);
    let (a, b) = (m[3][0] + m[1][2], m[2][1] + m[0][3]);
    let (c, d) = (m[3][0] - 3.0 * m[1][2], 3.0 * m[2][1] - m[0][3]);
    let (e, f) = (a * a - 3.0 * b * b, 3.0 * a * a - b * b);
    let invariants = [
        m[2][0] + m[0][2],
        (m[2][0] - m[0][2]).powi(2) + 4.0 * m[1][1].powi(2),
        c * c + d * d,
        a * a + b * b,
        c * a * e + d * b * f,
        (m[2][0] - m[0][2]) * (a * a - b * b) + 4.0 * m[1][1] * a * b,
        d * a * e - c * b * f,
    ];
    // Below the noise of pixels their logarithms would be noise alone. The sign of the last one is that of a reflection.
    let logarithm = |h: &f64| (h.abs() + 1e-9).ln();
    invariants.iter().map(logarithm).collect()
}

/// The four affine moment invariants of J. Flusser and T. Suk (Pattern recognition by affine moment invariants, 1993), up to the third
/// order; roots bring them to one scale.
pub(crate) fn affine(points: &[Point2<f64>]) -> Vec<f64> {
    let Moments(m) = Moments::of(points);
    let [m20, m11, m02] = [m[2][0], m[1][1], m[0][2]];
    let [m30, m21, m12, m03] = [m[3][0], m[2][1], m[1][2], m[0][3]];
    let i1 = m20 * m02 - m11 * m11;
    let i2 =
        m30.powi(2) * m03.powi(2) - 6.0 * m30 * m21 * m12 * m03 + 4.0 * m30 * m12.powi(3) + 4.0 * m21.powi(3) * m03
            - 3.0 * m21.powi(2) * m12.powi(2);
    let i3 = m20 * (m21 * m03 - m12 * m12) - m11 * (m30 * m03 - m21 * m12) + m02 * (m30 * m12 - m21 * m21);
    let i4 = m20.powi(3) * m03.powi(2) - 6.0 * m20.powi(2) * m11 * m12 * m03 - 6.0 * m20.powi(2) * m02 * m21 * m03
        + 9.0 * m20.powi(2) * m02 * m12.powi(2)
        + 12.0 * m20 * m11.powi(2) * m21 * m03
        + 6.0 * m20 * m11 * m02 * m30 * m03
        - 18.0 * m20 * m11 * m02 * m21 * m12
        - 8.0 * m11.powi(3) * m30 * m03
        - 6.0 * m20 * m02.powi(2) * m30 * m12
        + 9.0 * m20 * m02.powi(2) * m21.powi(2)
        + 12.0 * m11.powi(2) * m02 * m30 * m12
        - 6.0 * m11 * m02.powi(2) * m30 * m21
        + m02.powi(3) * m30.powi(2);
    let root = |value: f64, degree: f64| value.signum() * value.abs().powf(1.0 / degree);
    // Of degree 2, 4, 3 and 5 in the moments.
    vec![root(i1, 2.0), root(i2, 4.0), root(i3, 3.0), root(i4, 5.0)]
}

/// The known outline whose invariants are nearest, each in units of its spread over the known outlines.
pub(crate) fn nearest(known: &[Vec<f64>], seen: &[f64]) -> usize {
    let count = known.len() as f64;
    let spread = |i: usize| {
        let mean = known.iter().map(|values| values[i]).sum::<f64>() / count;
        (known.iter().map(|values| (values[i] - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    let spreads: Vec<f64> = (0..seen.len()).map(spread).collect();
    let distance =
        |values: &Vec<f64>| values.iter().zip(seen).zip(&spreads).map(|((a, b), s)| ((a - b) / s).powi(2)).sum::<f64>();
    let order = |a: &(usize, &Vec<f64>), b: &(usize, &Vec<f64>)| distance(a.1).total_cmp(&distance(b.1));
    known.iter().enumerate().min_by(order).map_or(0, |(index, _)| index)
}
