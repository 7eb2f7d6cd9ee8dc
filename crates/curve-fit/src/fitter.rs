use nalgebra::{DMatrix, Point2};

use crate::{
    bounded,
    degree::MAX_COEFFICIENTS,
    error::{FitError, SettingsError},
    fit::{Factorisation, Fit, FitDiagnostics},
    leading_form::CircleRange,
    least_squares::TriangularSystem,
    moments::Moments,
    monomials::evaluate_monomials,
    normalisation::Normalisation,
    normals::NormalRegression,
    outline::Outline,
    polynomial::ImplicitPolynomial,
    residuals::Residuals,
    ridge::rotation_invariant_ridge,
    settings::{FitSettings, Method},
};

/// The three level sets: the value f should have, and on which side of the data.
const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];

/// Fits implicit polynomials to outlines, one after the other, in buffers that are reused: after the first outline no
/// further memory is taken unless an outline has more points than any before it.
#[derive(Debug, Clone)]
pub struct Fitter {
    settings: FitSettings,
    points: [Vec<f64>; 2],
    normals: [Vec<f64>; 2],
    level_set: [Vec<f64>; 2],
    regression: NormalRegression,
    system: TriangularSystem,
}

impl Fitter {
    /// A fitter with these settings.
    ///
    /// # Errors
    /// A setting outside its range.
    pub fn new(settings: FitSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            settings,
            points: Default::default(),
            normals: Default::default(),
            level_set: Default::default(),
            regression: NormalRegression::default(),
            system: TriangularSystem::new(),
        })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &FitSettings {
        &self.settings
    }

    /// Fits a polynomial to an outline: 3L (Blane et al. 2000) from the moments of the three level sets, in centred,
    /// scaled coordinates, by the method of the settings.
    ///
    /// # Errors
    /// Too few points, or points that do not determine the coefficients.
    pub fn fit(&mut self, outline: &Outline) -> Result<Fit, FitError> {
        let normalisation = self.load(outline)?;
        let factorisation = if self.factor_moments() {
            Factorisation::Gram
        } else {
            self.factor_rows()?;
            Factorisation::Orthogonal
        };
        self.finish(normalisation, factorisation)
    }

    /// The same fit from the QR factorisation of the tall matrix: slower, as accurate as can be, and what
    /// [`fit`](Self::fit) is tested against. Allocates.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_by_orthogonal_factorisation(&mut self, outline: &Outline) -> Result<Fit, FitError> {
        let normalisation = self.load(outline)?;
        self.factor_rows()?;
        self.finish(normalisation, Factorisation::Orthogonal)
    }

    /// Covariance of the working coefficients of the last fit for unit noise on the level-set values, `(M'M)^-1` with
    /// the ridge included; as many rows as coefficients. `None` before the first fit.
    #[must_use]
    pub fn unit_covariance(&self) -> Option<DMatrix<f64>> {
        self.system.condition().is_finite().then(|| self.system.unit_covariance())
    }

    /// Brings the points into working coordinates and finds their normals.
    fn load(&mut self, outline: &Outline) -> Result<Normalisation, FitError> {
        let degree = self.settings.degree;
        let (found, needed) = (outline.point_count(), degree.coefficient_count().div_ceil(LEVELS.len()));
        if found < needed {
            return Err(FitError::TooFewPoints { found, needed, degree });
        }
        let [xs, ys] = &mut self.points;
        xs.clear();
        ys.clear();
        for piece in outline.pieces() {
            xs.extend(piece.points.iter().map(|p| p.x));
            ys.extend(piece.points.iter().map(|p| p.y));
        }
        let normalisation = normalise(xs, ys);
        let [nx, ny] = &mut self.normals;
        self.regression.run(outline, [xs, ys], self.settings.normal_half_window, [nx, ny]);
        Ok(normalisation)
    }

    /// Moves the points by `level` offsets along their normals.
    fn place_level_set(&mut self, level: f64) {
        let distance = level * self.settings.offset;
        for axis in 0..2 {
            let (points, normals) = (&self.points[axis], &self.normals[axis]);
            self.level_set[axis].clear();
            self.level_set[axis].extend(points.iter().zip(normals).map(|(p, n)| p + distance * n));
        }
    }

    /// Forms and factors the normal equations from moments. Returns whether they can be relied on.
    fn factor_moments(&mut self) -> bool {
        let degree = self.settings.degree.value();
        let size = self.settings.degree.coefficient_count();
        let [inner, data, outer] = LEVELS.map(|level| {
            self.place_level_set(level);
            Moments::of(2 * degree, &self.level_set[0], &self.level_set[1])
        });
        // M'd: the levels are -1, 0 and 1.
        let mut projection = [0.0; MAX_COEFFICIENTS];
        for (value, (plus, minus)) in
            projection.iter_mut().zip(outer.as_slice().iter().zip(inner.as_slice())).take(size)
        {
            *value = plus - minus;
        }
        let ridge = self.ridge(&data);
        self.system.factor_gram(degree, &(inner + data + outer), &projection[..size], &ridge)
    }

    fn ridge(&self, data: &Moments) -> [f64; MAX_COEFFICIENTS] {
        match self.settings.method {
            Method::GloballyStabilised { ridge_weight } | Method::Bounded { ridge_weight, .. }
                if ridge_weight > 0.0 =>
            {
                rotation_invariant_ridge(self.settings.degree.value(), data).map(|d| ridge_weight * d)
            }
            _ => [0.0; MAX_COEFFICIENTS],
        }
    }

    /// Factors the tall matrix, one row per point and level set, and one per coefficient for a ridge.
    fn factor_rows(&mut self) -> Result<(), FitError> {
        let degree = self.settings.degree.value();
        let size = self.settings.degree.coefficient_count();
        let count = self.points[0].len();
        let data = Moments::reference(2 * degree, &self.points[0], &self.points[1]);
        let ridge = self.ridge(&data);
        let mut rows = DMatrix::zeros(LEVELS.len() * count + size, size);
        let mut right = vec![0.0; rows.nrows()];
        let mut monomials = [0.0; MAX_COEFFICIENTS];
        for (l, level) in LEVELS.into_iter().enumerate() {
            self.place_level_set(level);
            for i in 0..count {
                evaluate_monomials(degree, self.level_set[0][i], self.level_set[1][i], &mut monomials);
                rows.row_mut(l * count + i).copy_from_slice(&monomials[..size]);
                right[l * count + i] = level;
            }
        }
        (0..size).for_each(|k| rows[(LEVELS.len() * count + k, k)] = ridge[k].sqrt());
        self.system.factor_rows(&rows, &right)
    }

    /// Solves the triangular system, under the constraint where it is asked for and needed, and judges the result.
    fn finish(&mut self, normalisation: Normalisation, factorisation: Factorisation) -> Result<Fit, FitError> {
        let degree = self.settings.degree;
        let size = degree.coefficient_count();
        let mut coefficients = [0.0; MAX_COEFFICIENTS];
        self.system.solve(&mut coefficients[..size]);
        let leading = size - degree.value() - 1..size;
        let mut range = CircleRange::of(&coefficients[leading.clone()]);
        let mut constraint_active = false;
        if let Method::Bounded { margin, .. } = self.settings.method
            && range.minimum < margin * range.rms
        {
            constraint_active = true;
            bounded::constrain_leading_form(degree.value(), &self.system, margin, &mut coefficients[..size])?;
            range = CircleRange::of(&coefficients[leading]);
        }
        let working = ImplicitPolynomial::from_array(degree, coefficients);
        let residuals = Residuals::of(&working, &self.points[0], &self.points[1]);
        let diagnostics = FitDiagnostics {
            boundedness_margin: range.margin(),
            constraint_active,
            condition: self.system.condition(),
            algebraic_residual: residuals.algebraic,
            geometric_residual: residuals.geometric * normalisation.radius,
            point_count: self.points[0].len(),
            factorisation,
        };
        Ok(Fit { normalisation, working, diagnostics })
    }
}

/// Centres and scales coordinates in place to mean 0 and root mean square radius 1.
fn normalise(xs: &mut [f64], ys: &mut [f64]) -> Normalisation {
    let count = xs.len() as f64;
    // Twice, so that the mean of a far outline is exact to the last digit of its size rather than of its offset.
    let mut centre = Point2::new(xs[0], ys[0]);
    for _ in 0..2 {
        let mean = |values: &[f64], origin: f64| values.iter().map(|v| v - origin).sum::<f64>() / count;
        centre += nalgebra::Vector2::new(mean(xs, centre.x), mean(ys, centre.y));
    }
    let squares = |values: &[f64], origin: f64| values.iter().map(|v| (v - origin) * (v - origin)).sum::<f64>();
    let radius = ((squares(xs, centre.x) + squares(ys, centre.y)) / count).sqrt();
    let inverse = 1.0 / radius;
    xs.iter_mut().for_each(|x| *x = (*x - centre.x) * inverse);
    ys.iter_mut().for_each(|y| *y = (*y - centre.y) * inverse);
    Normalisation { centre, radius }
}
