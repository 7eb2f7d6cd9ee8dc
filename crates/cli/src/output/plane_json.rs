//! What is found of a plane in space, as JSON.
use std::collections::BTreeMap;

use freeform_motion::estimate::PlaneEstimate;
use freeform_motion::outline_filter::{PlaneAmbiguity, PlaneSolution};
use freeform_motion::riccati::PlaneMotion;

/// The normal at the first frame, its z being 1; nulls where it is not known.
#[derive(serde::Serialize)]
pub(super) struct NormalJson {
    value: Option<[f64; 3]>,
    std: Option<[f64; 3]>,
    covariance: Option<[[f64; 3]; 3]>,
    observable: bool,
}

impl From<&PlaneEstimate> for NormalJson {
    fn from(estimate: &PlaneEstimate) -> Self {
        let normal = estimate.normal();
        Self {
            value: normal.map(|normal| normal.value.into()),
            std: normal.map(|normal| normal.covariance.diagonal().map(|variance| variance.max(0.0).sqrt()).into()),
            covariance: normal.map(|normal| [0, 1, 2].map(|i| [0, 1, 2].map(|j| normal.covariance[(i, j)]))),
            observable: normal.is_some(),
        }
    }
}

/// Two motions that the outlines do not decide between, the more probable one first.
#[derive(serde::Serialize)]
pub(super) struct PlanesJson<'a> {
    solutions: [SolutionJson; 2],
    parameters: &'a [&'static str],
}

#[derive(serde::Serialize)]
struct SolutionJson {
    probability: f64,
    parameters: BTreeMap<&'static str, ValueJson>,
    normal: NormalJson,
}

#[derive(serde::Serialize)]
struct ValueJson {
    value: f64,
    std: f64,
}

impl<'a> From<&'a PlaneAmbiguity> for PlanesJson<'a> {
    fn from(PlaneAmbiguity { solutions, parameters }: &'a PlaneAmbiguity) -> Self {
        Self { solutions: [0, 1].map(|i| SolutionJson::from(&solutions[i])), parameters }
    }
}

impl From<&PlaneSolution> for SolutionJson {
    fn from(PlaneSolution { estimate, probability }: &PlaneSolution) -> Self {
        let deviations = estimate.covariance().diagonal().map(|variance| variance.max(0.0).sqrt());
        let values = estimate.motion().parameters().into_iter().zip(deviations.iter().copied());
        let parameters = PlaneMotion::NAMES.into_iter().zip(values);
        Self {
            probability: *probability,
            parameters: parameters.map(|(name, (value, std))| (name, ValueJson { value, std })).collect(),
            normal: estimate.into(),
        }
    }
}
