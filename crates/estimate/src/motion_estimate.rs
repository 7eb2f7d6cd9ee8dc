use freeform_riccati::{CameraScale, MotionModel};
use nalgebra::{Affine2, Matrix3};

/// Largest number of parameters of a motion model, that of a projective motion.
pub(crate) const MAX_PARAMETERS: usize = MotionModel::MAX_PARAMETERS;

/// An identified motion in the image frame: one value per parameter of its model, and how well each is known.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionEstimate {
    model: MotionModel,
    values: [f64; MAX_PARAMETERS],
    standard_deviations: Option<[f64; MAX_PARAMETERS]>,
    /// Systematic parts of these.
    systematic: [f64; MAX_PARAMETERS],
    observable: [bool; MAX_PARAMETERS],
}

/// One parameter of a [`MotionEstimate`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterEstimate {
    /// Name as in the paper: `omega`, `b1`, `a3`, ...
    pub name: &'static str,
    /// Unit: `rad/s` or `1/s` (lengths of the image per second for b1 and b2).
    pub unit: &'static str,
    /// The value, or `None` where the outlines tell nothing of it.
    pub value: Option<f64>,
    /// Its standard deviation, random and systematic together, or `None` where the method gives none.
    pub standard_deviation: Option<f64>,
    /// The part of it that comes from random errors of the points.
    pub random_deviation: Option<f64>,
    /// The part of it that comes from errors of whole outlines, which more frames do not average out.
    pub systematic_deviation: Option<f64>,
}

impl MotionEstimate {
    /// An estimate in which all parameters are observable.
    ///
    /// # Panics
    /// If the slices do not hold one value per parameter of the model.
    #[must_use]
    pub fn new(model: MotionModel, values: &[f64], standard_deviations: Option<&[f64]>) -> Self {
        let pad = |list: &[f64]| {
            assert_eq!(list.len(), model.parameter_count(), "one value per parameter");
            let mut padded = [0.0; MAX_PARAMETERS];
            padded[..list.len()].copy_from_slice(list);
            padded
        };
        Self {
            model,
            values: pad(values),
            standard_deviations: standard_deviations.map(pad),
            systematic: [0.0; MAX_PARAMETERS],
            observable: [true; MAX_PARAMETERS],
        }
    }

    /// This estimate with parameter `index` marked as not observable.
    ///
    /// # Panics
    /// If there is no such parameter.
    #[must_use]
    pub fn with_unobservable(mut self, index: usize) -> Self {
        assert!(index < self.model.parameter_count(), "parameter {index} of {:?}", self.model);
        self.observable[index] = false;
        self
    }

    /// This estimate with the random parts of its standard deviations given; the rest of them is systematic.
    ///
    /// # Panics
    /// If there is not one for every parameter of the model.
    #[must_use]
    pub fn with_random_part(mut self, random: &[f64]) -> Self {
        assert_eq!(random.len(), self.model.parameter_count(), "one deviation per parameter");
        if let Some(all) = &self.standard_deviations {
            for ((systematic, all), random) in self.systematic.iter_mut().zip(all).zip(random) {
                *systematic = (all * all - random * random).max(0.0).sqrt();
            }
        }
        self
    }

    /// The motion model.
    #[must_use]
    pub fn model(&self) -> MotionModel {
        self.model
    }

    /// The parameters in the order of the model.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterEstimate> + '_ {
        let names = self.model.parameter_names().iter().zip(self.model.units());
        names.enumerate().map(|(i, (&name, &unit))| ParameterEstimate {
            name,
            unit,
            value: self.observable[i].then_some(self.values[i]),
            standard_deviation: self.standard_deviations.filter(|_| self.observable[i]).map(|list| list[i]),
            random_deviation: self.standard_deviations.filter(|_| self.observable[i]).map(|list| {
                let (all, systematic) = (list[i], self.systematic[i]);
                (all * all - systematic * systematic).max(0.0).sqrt()
            }),
            systematic_deviation: self.standard_deviations.filter(|_| self.observable[i]).map(|_| self.systematic[i]),
        })
    }

    /// The angular velocity, or the mean one `(a2 - a3) / 2` where that is not one of the parameters, rad/s; `None` where it is not stated.
    #[must_use]
    pub fn mean_rate_of_turn(&self) -> Option<f64> {
        let value = |name: &str| self.parameters().find(|parameter| parameter.name == name)?.value;
        value("omega").or_else(|| Some(0.5 * (value("a2")? - value("a3")?)))
    }

    /// The raw values in the order of the model, those of unobservable parameters included.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values[..self.model.parameter_count()]
    }

    /// The generator A of the motion (equation 4), unobservable parameters taken as they stand.
    #[must_use]
    pub fn generator(&self) -> Matrix3<f64> {
        self.model.generator(self.values())
    }

    /// Whether every number that is stated is finite: not where an estimator has diverged.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let is_finite = |number: Option<f64>| number.is_none_or(f64::is_finite);
        self.parameters().all(|p| is_finite(p.value) && is_finite(p.standard_deviation))
    }

    /// The generator A where all of it is known; `None` where a parameter is unobservable or an entry not finite.
    #[must_use]
    pub fn known_generator(&self) -> Option<Matrix3<f64>> {
        let generator = self.generator();
        let is_known = self.parameters().all(|p| p.value.is_some()) && generator.iter().all(|a| a.is_finite());
        is_known.then_some(generator)
    }

    /// This motion in other coordinates. `map`, a scaling and a shift, maps the present coordinates to the new ones.
    ///
    /// # Panics
    /// If there are standard deviations: they cannot be transformed without the covariances.
    #[must_use]
    pub fn in_coordinates(mut self, map: &Affine2<f64>) -> Self {
        assert!(self.standard_deviations.is_none(), "standard deviations alone cannot change coordinates");
        let moved = map.matrix() * self.generator() * map.inverse().matrix();
        self.values = self.model.parameters_of(&moved);
        self
    }

    /// This motion in space, for a scaled orthographic camera: b and its standard deviations are divided by f/Z0, c and its
    /// standard deviations are multiplied by it (equations 23 and 24).
    #[must_use]
    pub fn in_space(mut self, camera: CameraScale) -> Self {
        // Every parameter is multiplied by a number of its own, so that standard deviations change as values do.
        let (model, count) = (self.model, self.model.parameter_count());
        let in_space =
            |values: &[f64]| model.parameters_of(&camera.generator_in_space(&model.generator(&values[..count])));
        self.values = in_space(&self.values);
        self.standard_deviations = self.standard_deviations.map(|list| in_space(&list));
        self.systematic = in_space(&self.systematic);
        self
    }
}
