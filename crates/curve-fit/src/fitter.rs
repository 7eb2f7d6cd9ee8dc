use nalgebra::{Affine2, DMatrix, Point2, Vector2};
use pulp::Arch;

use crate::{
    area_moments::AreaMoments,
    bounded,
    covariance::{FitCovariance, Fitted, noise_along},
    degree::MAX_COEFFICIENTS,
    error::{FitError, SettingsError},
    fit::{Factorisation, Fit, FitDiagnostics},
    leading_form::CircleRange,
    least_squares::TriangularSystem,
    level_set_moments::{LEVELS, LevelSetMoments, OrientedPoints},
    monomials::evaluate_monomials,
    normalisation::Normalisation,
    normals::NormalRegression,
    outline::Outline,
    polynomial::ImplicitPolynomial,
    resampling::EvenOutline,
    residuals::Residuals,
    ridge::ridge_of_radial_sums,
    settings::{FitSettings, Method, Normalise},
    vectors::sum,
};

/// Fits implicit polynomials to outlines, one after the other, in buffers that are reused: after the first outline no
/// further memory is taken unless an outline has more points than any before it.
#[derive(Debug, Clone)]
pub struct Fitter {
    settings: FitSettings,
    points: [Vec<f64>; 2],
    normals: [Vec<f64>; 2],
    regression: NormalRegression,
    even: EvenOutline,
    /// RMS radius of `even` in the coordinates that it was spread in.
    even_radius: f64,
    moments: LevelSetMoments,
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
            regression: NormalRegression::default(),
            even: EvenOutline::default(),
            even_radius: 1.0,
            moments: LevelSetMoments::ZERO,
            system: TriangularSystem::new(),
        })
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &FitSettings {
        &self.settings
    }

    /// Fits a polynomial to an outline: 3L (Blane et al. 2000) from the moments of the three level sets, by the method of the
    /// settings and in the coordinates that they ask for.
    ///
    /// # Errors
    /// Too few points, points that do not determine the coefficients, an outline that does not tell its inside from its
    /// outside, a bounded fit that does not converge; open arcs where the settings ask for an affine normalisation.
    pub fn fit(&mut self, outline: &Outline) -> Result<Fit, FitError> {
        let outline = &*outline.boundary();
        let normalisation = self.load(outline)?;
        self.fit_loaded(outline, normalisation)
    }

    /// Fits an outline in coordinates that are given: it is spread evenly by arc length there and fitted as it is. For open arcs
    /// of an object whose pose is known, which have no area moments. `image_from_working` maps coordinates to the image in which the
    /// whole outline has about the mean 0 and the RMS radius 1, such as the
    /// [`normalisation`](Fit::normalisation) of an affine-normalised fit of an earlier outline, moved as the object has moved.
    ///
    /// # Errors
    /// As [`fit`](Self::fit); a map that is singular or not finite.
    pub fn fit_in(&mut self, outline: &Outline, image_from_working: &Affine2<f64>) -> Result<Fit, FitError> {
        let outline = &*outline.boundary();
        self.check_count(outline)?;
        let normalisation = Normalisation::affine(image_from_working).ok_or(FitError::SingularNormalisation)?;
        self.load_evenly(outline, &normalisation);
        self.find_normals();
        self.fit_loaded(outline, normalisation)
    }

    /// Fits a polynomial to an outline and says how uncertain its coefficients are. The covariance is that of the least-squares
    /// solution, carried from independent noise of the points, whose size is told from the outline itself; where a
    /// [constraint](crate::FitDiagnostics::constraint_active) is active the solution varies less than it says. What the curve
    /// misses of the shape is no noise and is left out. Allocates.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_with_covariance(&mut self, outline: &Outline) -> Result<(Fit, FitCovariance), FitError> {
        let outline = &*outline.boundary();
        let fit = self.fit(outline)?;
        let condition = fit.diagnostics.condition;
        let size = self.settings.degree.coefficient_count();
        let singular = FitError::RankDeficient { rank: size - 1, needed: size, condition };
        let inverse = self.system.inverse().ok_or(singular)?;
        let fitted = Fitted {
            points: self.points.each_ref().map(Vec::as_slice),
            normals: self.normals.each_ref().map(Vec::as_slice),
            interpolated_from: (self.settings.normalise == Normalise::Affine).then(|| outline.point_count()),
            noise: self.noise(outline),
            offset: self.settings.offset,
            polynomial: &fit.working,
            inverse: &inverse,
        };
        Ok((fit, fitted.covariance()))
    }

    /// Standard deviation of the noise of the outline loaded, along its normals and in working coordinates.
    fn noise(&self, outline: &Outline) -> f64 {
        if self.settings.normalise != Normalise::Affine {
            let [points, normals] = [&self.points, &self.normals].map(|pair| pair.each_ref().map(Vec::as_slice));
            return noise_along(points, normals, None);
        }
        // Of what was smoothed, the noise is gone.
        let (xs, ys): (Vec<_>, Vec<_>) = self.even.rough().map(|(p, _)| (p.x, p.y)).unzip();
        let (nx, ny): (Vec<_>, Vec<_>) = self.even.rough().map(|(_, n)| (n.x, n.y)).unzip();
        noise_along([&xs, &ys], [&nx, &ny], Some(outline.point_count())) / self.even_radius
    }

    fn fit_loaded(&mut self, outline: &Outline, normalisation: Normalisation) -> Result<Fit, FitError> {
        self.sum_moments();
        let factorisation = self.factor()?;
        self.finish(outline, normalisation, factorisation)
    }

    /// Factors and solves the problem of the last outline once more, under the constraint where that is active: what a fit
    /// costs besides normals, sums and residuals. For measurements.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    #[doc(hidden)]
    pub fn solve_last(&mut self) -> Result<[f64; MAX_COEFFICIENTS], FitError> {
        self.factor()?;
        self.solve().map(|solution| solution.coefficients)
    }

    /// Fits by the QR factorisation of the tall matrix. Slower than [`fit`](Self::fit), as accurate as possible, and the reference
    /// of its tests. Allocates.
    ///
    /// # Errors
    /// As [`fit`](Self::fit).
    pub fn fit_by_orthogonal_factorisation(&mut self, outline: &Outline) -> Result<Fit, FitError> {
        let outline = &*outline.boundary();
        let normalisation = self.load(outline)?;
        self.factor_rows()?;
        self.finish(outline, normalisation, Factorisation::Orthogonal)
    }

    fn check_count(&self, outline: &Outline) -> Result<(), FitError> {
        let degree = self.settings.degree;
        let (found, needed) = (outline.point_count(), degree.coefficient_count().div_ceil(LEVELS.len()));
        if found < needed { Err(FitError::TooFewPoints { found, needed, degree }) } else { Ok(()) }
    }

    /// Brings the points into working coordinates and finds their normals.
    fn load(&mut self, outline: &Outline) -> Result<Normalisation, FitError> {
        self.check_count(outline)?;
        if self.settings.normalise == Normalise::Affine {
            let Outline::Closed(whole) = outline else { return Err(FitError::NoAreaMoments) };
            let frame = AreaMoments::of(whole).ok_or(FitError::NoInside)?.image_from_inertia_circle();
            let frame = Normalisation::affine(&frame).ok_or(FitError::SingularNormalisation)?;
            self.load_evenly(outline, &frame);
            let [xs, ys] = &mut self.points;
            let within = Arch::new().dispatch(|| normalise(xs, ys));
            self.even_radius = within.radius;
            self.find_normals();
            return Ok(frame.after(&within));
        }
        let [xs, ys] = &mut self.points;
        xs.clear();
        ys.clear();
        for piece in outline.pieces() {
            xs.extend(piece.points.iter().map(|p| p.x));
            ys.extend(piece.points.iter().map(|p| p.y));
        }
        let normalisation = Arch::new().dispatch(|| normalise(xs, ys));
        let [nx, ny] = &mut self.normals;
        self.regression.run(outline, [xs, ys], self.settings.normal_half_window, [nx, ny]);
        Ok(normalisation)
    }

    /// Brings points that are evenly spaced in the coordinates of `frame` there.
    fn load_evenly(&mut self, outline: &Outline, frame: &Normalisation) {
        self.even.spread(outline, |p| frame.to_working(p));
        let [xs, ys] = &mut self.points;
        xs.clear();
        ys.clear();
        xs.extend(self.even.points().iter().map(|p| p.x));
        ys.extend(self.even.points().iter().map(|p| p.y));
    }

    /// The normals of points that are evenly spaced.
    fn find_normals(&mut self) {
        let [xs, ys] = &self.points;
        let [nx, ny] = &mut self.normals;
        self.regression.run_pieces(self.even.pieces(), [xs, ys], self.settings.normal_half_window, [nx, ny]);
    }

    /// The sums over the level sets.
    fn sum_moments(&mut self) {
        let data = OrientedPoints {
            points: self.points.each_ref().map(Vec::as_slice),
            normals: self.normals.each_ref().map(Vec::as_slice),
        };
        self.moments.set_to(self.settings.degree.value(), self.settings.offset, data);
    }

    /// Forms and factors the normal equations from the sums or, where they cannot be relied on, the tall matrix.
    fn factor(&mut self) -> Result<Factorisation, FitError> {
        let radial = self.moments.radial;
        let ridge = self.ridge(|d| radial[d]);
        if self.system.factor_gram(self.settings.degree.value(), &self.moments, &ridge) {
            return Ok(Factorisation::Gram);
        }
        self.factor_rows()?;
        Ok(Factorisation::Orthogonal)
    }

    /// The ridge of the settings, from `sum (x^2 + y^2)^d` over the data.
    fn ridge(&self, radial: impl Fn(usize) -> f64) -> [f64; MAX_COEFFICIENTS] {
        match self.settings.method {
            Method::GloballyStabilised { ridge_weight } | Method::Bounded { ridge_weight, .. }
                if ridge_weight > 0.0 =>
            {
                ridge_of_radial_sums(self.settings.degree.value(), radial).map(|d| ridge_weight * d)
            }
            _ => [0.0; MAX_COEFFICIENTS],
        }
    }

    /// Factors the tall matrix, one row per point and level set, and one per coefficient for a ridge.
    fn factor_rows(&mut self) -> Result<(), FitError> {
        let degree = self.settings.degree.value();
        let size = self.settings.degree.coefficient_count();
        let count = self.points[0].len();
        let ridge = self.ridge(|d| {
            let squares = self.points[0].iter().zip(&self.points[1]).map(|(x, y)| x * x + y * y);
            squares.map(|square| square.powi(d as i32)).sum()
        });
        let mut rows = DMatrix::zeros(LEVELS.len() * count + size, size);
        let mut right = vec![0.0; rows.nrows()];
        let mut monomials = [0.0; MAX_COEFFICIENTS];
        for (l, level) in LEVELS.into_iter().enumerate() {
            for i in 0..count {
                let [x, y] =
                    [0, 1].map(|axis| self.points[axis][i] + level * self.settings.offset * self.normals[axis][i]);
                evaluate_monomials(degree, x, y, &mut monomials);
                rows.row_mut(l * count + i).copy_from_slice(&monomials[..size]);
                right[l * count + i] = level;
            }
        }
        (0..size).for_each(|k| rows[(LEVELS.len() * count + k, k)] = ridge[k].sqrt());
        self.system.factor_rows(&rows, &right)
    }

    /// Solves the triangular system, under the constraint where it is asked for and needed.
    fn solve(&self) -> Result<Solution, FitError> {
        let degree = self.settings.degree;
        let size = degree.coefficient_count();
        let mut coefficients = [0.0; MAX_COEFFICIENTS];
        self.system.solve(&mut coefficients[..size]);
        let leading = size - degree.value() - 1..size;
        let mut range = CircleRange::of(&coefficients[leading]);
        if range.rms == 0.0 {
            return Err(FitError::NoInside);
        }
        let mut constraint_active = false;
        if let Method::Bounded { margin, .. } = self.settings.method
            && range.minimum < margin * range.rms
        {
            constraint_active = true;
            let floor = margin * range.rms;
            range = bounded::constrain_leading_form(degree.value(), &self.system, floor, &mut coefficients[..size])?;
        }
        Ok(Solution { coefficients, range, constraint_active })
    }

    /// Solves the triangular system and judges the result.
    fn finish(
        &mut self,
        outline: &Outline,
        normalisation: Normalisation,
        factorisation: Factorisation,
    ) -> Result<Fit, FitError> {
        if !self.regression.has_inside {
            return Err(FitError::NoInside);
        }
        let Solution { coefficients, range, constraint_active } = self.solve()?;
        let working = ImplicitPolynomial::from_array(self.settings.degree, coefficients);
        let mut residuals = Residuals::of(&working, &self.points[0], &self.points[1]);
        residuals.geometric *= normalisation.radius;
        if normalisation.is_affine() {
            // Distances in the image, and what the image shows of the curve is finite.
            residuals.geometric = Residuals::geometric_in_image(&working, &normalisation, outline);
            if working.moved(&normalisation.stretching()).is_err() {
                return Err(FitError::SingularNormalisation);
            }
        }
        let diagnostics = FitDiagnostics {
            boundedness_margin: range.margin(),
            constraint_active,
            condition: self.system.condition(),
            algebraic_residual: residuals.algebraic,
            geometric_residual: residuals.geometric,
            point_count: outline.point_count(),
            factorisation,
        };
        Ok(Fit { normalisation, working, diagnostics })
    }
}

/// Coefficients in working coordinates.
struct Solution {
    coefficients: [f64; MAX_COEFFICIENTS],
    /// Of their leading form.
    range: CircleRange,
    constraint_active: bool,
}

/// Centres and scales coordinates in place to mean 0 and root mean square radius 1.
#[inline(always)]
fn normalise(xs: &mut [f64], ys: &mut [f64]) -> Normalisation {
    // Relative to the first point, so that the mean of a far outline is exact to the last digit of its size rather than
    // of its offset.
    let first = Point2::new(xs[0], ys[0]);
    let count = xs.len() as f64;
    let mean = Vector2::new(sum(xs, |x| x - first.x), sum(ys, |y| y - first.y)) / count;
    let centre = first + mean;
    let squares = sum(xs, |x| (x - centre.x) * (x - centre.x)) + sum(ys, |y| (y - centre.y) * (y - centre.y));
    let radius = (squares / count).sqrt();
    let inverse = 1.0 / radius;
    xs.iter_mut().for_each(|x| *x = (*x - centre.x) * inverse);
    ys.iter_mut().for_each(|y| *y = (*y - centre.y) * inverse);
    Normalisation::similarity(centre, radius)
}
