use freeform_curve_fit::{Degree, ImplicitPolynomial, coefficient_count, exponents, monomial_index};
use freeform_decompose::from_rotation_chart;
use nalgebra::{Affine2, Complex, Matrix3, Rotation2, Vector2};
use proptest::prelude::*;

pub(crate) type C = Complex<f64>;

/// Product of bivariate polynomials in graded order, written independently of the crate.
pub(crate) fn product(a: &[f64], degree_a: usize, b: &[f64], degree_b: usize) -> Vec<f64> {
    let mut out = vec![0.0; coefficient_count(degree_a + degree_b)];
    for ((i, j), &ca) in exponents(degree_a).zip(a) {
        for ((k, l), &cb) in exponents(degree_b).zip(b) {
            out[monomial_index(i + k, j + l)] += ca * cb;
        }
    }
    out
}

/// The bounded curve `scale * (prod |x + l y|^2 + lower)`, l given in the rotation chart, lower of degree n - 1.
pub(crate) fn bounded_curve(degree: Degree, w: &[C], lower: &[f64], scale: f64) -> ImplicitPolynomial {
    let mut form = vec![1.0];
    for (i, &w) in w.iter().enumerate() {
        let l = from_rotation_chart(w);
        form = product(&form, 2 * i, &[0.0, 0.0, 0.0, 1.0, 2.0 * l.re, l.norm_sqr()], 2);
    }
    form.iter_mut().zip(lower).for_each(|(a, b)| *a += b);
    form.iter_mut().for_each(|a| *a *= scale);
    ImplicitPolynomial::new(degree, &form).expect("finite coefficients")
}

/// Bounded curves of unit size whose leading lines are apart from each other, from the circle and from the real axis.
pub(crate) fn bounded_curves(degree: Degree) -> impl Strategy<Value = ImplicitPolynomial> {
    let pairs = degree.value() / 2;
    let w = prop::collection::vec((0.05..0.8_f64, 0.0..std::f64::consts::TAU), pairs);
    let lower = prop::collection::vec(-1.0..1.0_f64, coefficient_count(degree.value() - 1));
    let apart = |w: &[C]| w.iter().enumerate().all(|(i, a)| w[i + 1..].iter().all(|b| (a - b).norm() > 0.25));
    w.prop_map(|polar| polar.into_iter().map(|(r, phi)| C::from_polar(r, phi)).collect::<Vec<_>>())
        .prop_filter("leading lines apart", move |w| apart(w))
        .prop_flat_map(move |w| (Just(w), lower.clone(), 0.1..10.0_f64))
        .prop_map(move |(w, lower, scale)| bounded_curve(degree, &w, &lower, scale))
}

pub(crate) fn any_degree_curves() -> impl Strategy<Value = ImplicitPolynomial> {
    prop_oneof![
        bounded_curves(Degree::Conic),
        bounded_curves(Degree::Quartic),
        bounded_curves(Degree::Sextic),
        bounded_curves(Degree::Octic),
    ]
}

pub(crate) fn affine(m: [[f64; 2]; 2], b: [f64; 2]) -> Affine2<f64> {
    Affine2::from_matrix_unchecked(Matrix3::new(m[0][0], m[0][1], b[0], m[1][0], m[1][1], b[1], 0.0, 0.0, 1.0))
}

/// Rotation (radians, counter-clockwise), isotropic scale and translation.
pub(crate) fn similarity(angle: f64, scale: f64, translation: Vector2<f64>) -> Affine2<f64> {
    let r = Rotation2::new(angle).into_inner() * scale;
    affine([[r[(0, 0)], r[(0, 1)]], [r[(1, 0)], r[(1, 1)]]], [translation.x, translation.y])
}

/// Orientation-preserving affine maps, no worse than a stretch by 4.
pub(crate) fn affine_maps() -> impl Strategy<Value = Affine2<f64>> {
    let angle = || 0.0..std::f64::consts::TAU;
    (angle(), angle(), 0.5..2.0_f64, 0.5..2.0_f64, -1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(p, q, s, t, bx, by)| {
        let stretch = affine([[s, 0.0], [0.0, t]], [bx, by]);
        similarity(p, 1.0, Vector2::zeros()) * stretch * similarity(q, 1.0, Vector2::zeros())
    })
}

/// Largest difference of two coefficient lists relative to the largest coefficient.
pub(crate) fn relative_difference(a: &ImplicitPolynomial, b: &ImplicitPolynomial) -> f64 {
    let size = a.coefficients().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let pairs = a.coefficients().iter().zip(b.coefficients());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / size
}
