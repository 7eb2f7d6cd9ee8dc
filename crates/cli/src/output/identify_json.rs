use std::io::{self, Write};

use freeform_drawing::MeaningOfB;
use freeform_motion::Warning;
use freeform_motion::estimate::{MotionEstimate, ParameterEstimate};
use freeform_motion::outline_filter::{Ambiguity, DynamicsWeights, PlaneAmbiguity};
use freeform_motion::outline_io::OriginWarning;
use freeform_motion::riccati::CameraScale;
use freeform_motion::tracker::{MotionFamily, NotStated, ObjectResult};
use serde::ser::{Serialize, SerializeMap, SerializeStruct, Serializer};

use super::plane_json::{NormalJson, PlanesJson};
use super::velocity_json::VelocityJson;
use crate::left_out::LeftOut;

/// The result as one JSON object.
pub(crate) fn write_identify_json(
    sink: &mut impl Write,
    results: &[ObjectResult],
    b: &MeaningOfB,
    left_out: &LeftOut,
    warnings: &[(OriginWarning, String)],
) -> io::Result<()> {
    let objects: Vec<_> = results.iter().map(|result| ObjectJson { result, meaning: b }).collect();
    let pictures = left_out.pictures.iter().map(|(frame, reason)| PictureJson { frame: *frame, reason }).collect();
    let left_out = LeftOutJson { count: left_out.listed.count(), pictures };
    let b = MeaningJson { point: b.point, unit: &b.unit, scale: b.scale.map(CameraScale::value) };
    let warnings =
        warnings.iter().map(|(warning, message)| InputWarningJson { code: warning.code(), message }).collect();
    let document = Document { schema: "freeform.identify/2", objects, b, left_out, warnings };
    serde_json::to_writer_pretty(&mut *sink, &document)?;
    writeln!(sink)
}

#[derive(serde::Serialize)]
struct Document<'a> {
    schema: &'static str,
    objects: Vec<ObjectJson<'a>>,
    b: MeaningJson<'a>,
    left_out: LeftOutJson<'a>,
    /// Of how the outlines were found; left out where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<InputWarningJson<'a>>,
}

#[derive(serde::Serialize)]
struct InputWarningJson<'a> {
    code: &'static str,
    message: &'a str,
}

/// Which point b is the velocity of, in which unit, and what f/Z0 it was divided by.
#[derive(serde::Serialize)]
struct MeaningJson<'a> {
    point: &'static str,
    unit: &'a str,
    scale: Option<f64>,
}

/// Pictures that gave no outline; of very many only the first are listed.
#[derive(serde::Serialize)]
struct LeftOutJson<'a> {
    count: u64,
    pictures: Vec<PictureJson<'a>>,
}

#[derive(serde::Serialize)]
struct PictureJson<'a> {
    frame: u64,
    reason: &'a str,
}

/// Parameters and velocity that are not stated, by their names, with the word that says why.
pub(super) struct Unstated(Vec<(&'static str, NotStated)>);

impl Unstated {
    pub(super) fn of(parameters: Vec<(&'static str, NotStated)>, velocity: Option<NotStated>) -> Self {
        Self(parameters.into_iter().chain(velocity.map(|reason| ("velocity", reason))).collect())
    }

    /// The same, and others after them.
    pub(super) fn and(mut self, others: impl IntoIterator<Item = (&'static str, NotStated)>) -> Self {
        self.0.extend(others);
        self
    }

    pub(super) fn of_result(result: &ObjectResult) -> Self {
        let velocity = result.velocity_not_stated().filter(|_| result.has_velocity());
        Self::of(result.unstated(), velocity)
    }
}

impl Serialize for Unstated {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, reason)| (name, reason.name())))
    }
}

/// Turns of an object of the picture, or motions of a plane in space.
#[derive(serde::Serialize)]
#[serde(untagged)]
pub(super) enum EitherAmbiguity<'a> {
    Turns(AmbiguityJson<'a>),
    Planes(Box<PlanesJson<'a>>),
}

pub(super) fn ambiguity_json<'a>(
    turns: Option<&'a Ambiguity>,
    planes: Option<&'a PlaneAmbiguity>,
) -> Option<EitherAmbiguity<'a>> {
    let turns = turns.map(|turns| EitherAmbiguity::Turns(turns.into()));
    turns.or_else(|| planes.map(|planes| EitherAmbiguity::Planes(Box::new(planes.into()))))
}

/// Turns from one frame to the next that the outlines do not decide between, in degrees, positive where omega is.
#[derive(serde::Serialize)]
pub(super) struct AmbiguityJson<'a> {
    turn: f64,
    rival_turns: Vec<f64>,
    parameters: &'a [&'static str],
}

impl<'a> From<&'a Ambiguity> for AmbiguityJson<'a> {
    fn from(Ambiguity { turn, rival_turns, parameters }: &'a Ambiguity) -> Self {
        let as_omega = |anticlockwise: f64| -anticlockwise.to_degrees();
        Self { turn: as_omega(*turn), rival_turns: rival_turns.iter().copied().map(as_omega).collect(), parameters }
    }
}

struct ObjectJson<'a> {
    result: &'a ObjectResult,
    meaning: &'a MeaningOfB,
}

impl Serialize for ObjectJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { result, meaning } = self;
        let mut object =
            serializer.serialize_struct("Object", if result.motion == MotionFamily::Plane { 13 } else { 12 })?;
        object.serialize_field("object", &result.object)?;
        object.serialize_field("method", result.method.name())?;
        object.serialize_field("motion", &result.motion.to_string())?;
        object.serialize_field("frames", &result.frames)?;
        object.serialize_field("frames_rejected", &result.frames_rejected)?;
        match result.parameters() {
            Some(found) => {
                let parameters =
                    Parameters::new(found, (result.motion, meaning), &result.aliases, |name| result.not_stated(name));
                object.serialize_field("parameters", &parameters)?;
            }
            None => object.serialize_field("parameters", &NoParameters { result, meaning })?,
        }
        object.serialize_field("generator", &result.estimate.as_ref().and_then(generator_rows))?;
        if result.motion == MotionFamily::Plane {
            object.serialize_field("normal", &result.plane.as_deref().map(NormalJson::from))?;
        }
        object.serialize_field("velocity", &result.velocity.as_ref().map(VelocityJson))?;
        let ambiguity = ambiguity_json(result.ambiguity.as_ref(), result.plane_ambiguity.as_deref());
        object.serialize_field("ambiguity", &ambiguity)?;
        object.serialize_field("dynamics", &result.dynamics.map(DynamicsJson::from))?;
        let warnings: Vec<WarningJson> = result.warnings.iter().map(WarningJson::from).collect();
        object.serialize_field("warnings", &warnings)?;
        object.serialize_field("unstated", &Unstated::of_result(result))?;
        object.end()
    }
}

/// The hypothesis of dynamics that holds, and the probabilities of all.
#[derive(serde::Serialize)]
struct DynamicsJson {
    held: &'static str,
    weights: WeightsJson,
}

#[derive(serde::Serialize)]
struct WeightsJson {
    generator: f64,
    velocity: f64,
    accelerating: f64,
}

impl From<DynamicsWeights> for DynamicsJson {
    fn from(weights: DynamicsWeights) -> Self {
        let DynamicsWeights { generator, velocity, accelerating } = weights;
        Self { held: weights.most_probable().name(), weights: WeightsJson { generator, velocity, accelerating } }
    }
}

/// A warning by its code.
#[derive(serde::Serialize)]
pub(super) struct WarningJson {
    code: &'static str,
    message: String,
}

impl From<&Warning> for WarningJson {
    fn from(warning: &Warning) -> Self {
        Self { code: warning.code(), message: warning.to_string() }
    }
}

#[derive(serde::Serialize)]
struct ParameterJson<'a> {
    value: Option<f64>,
    std: Option<f64>,
    std_random: Option<f64>,
    std_systematic: Option<f64>,
    unit: &'static str,
    observable: bool,
    /// The word of the table where there is no value.
    reason: Option<&'static str>,
    /// Of omega alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    aliases: Option<&'a [f64]>,
}

/// An estimate, with the units of its parameters, why a parameter is not stated, and other angular velocities that explain the outlines as well.
pub(super) struct Parameters<'a> {
    found: Vec<(ParameterEstimate, &'static str, Option<NotStated>)>,
    aliases: &'a [f64],
}

impl<'a> Parameters<'a> {
    pub(super) fn new(
        found: Vec<ParameterEstimate>,
        (family, b): (MotionFamily, &MeaningOfB),
        aliases: &'a [f64],
        why: impl Fn(&str) -> Option<NotStated>,
    ) -> Self {
        let with_kinds = found.into_iter().zip(family.parameter_kinds());
        let found =
            with_kinds.map(|(parameter, kind)| (parameter, b.unit_in_data(*kind, parameter.unit), why(parameter.name)));
        Self { found: found.collect(), aliases }
    }
}

impl Serialize for Parameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (parameter, unit, reason) in &self.found {
            let value = parameter.value;
            let json = ParameterJson {
                value,
                std: parameter.standard_deviation,
                std_random: parameter.random_deviation,
                std_systematic: parameter.systematic_deviation,
                unit,
                observable: value.is_some(),
                reason: reason.map(NotStated::name),
                aliases: (parameter.name == "omega").then_some(self.aliases),
            };
            map.serialize_entry(parameter.name, &json)?;
        }
        map.end()
    }
}

/// The parameters of an object without a result.
struct NoParameters<'a> {
    result: &'a ObjectResult,
    meaning: &'a MeaningOfB,
}

impl Serialize for NoParameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        let Self { result, meaning } = self;
        let model = result.motion;
        let kinds = model.parameter_kinds();
        for ((name, unit), kind) in model.parameter_names().iter().zip(model.units()).zip(kinds) {
            let nothing = ParameterJson {
                value: None,
                std: None,
                std_random: None,
                std_systematic: None,
                unit: meaning.unit_in_data(*kind, unit),
                observable: false,
                reason: result.not_stated(name).map(NotStated::name),
                aliases: (*name == "omega").then_some(&[]),
            };
            map.serialize_entry(name, &nothing)?;
        }
        map.end()
    }
}

pub(super) fn generator_rows(estimate: &MotionEstimate) -> Option<[[f64; 3]; 3]> {
    let a = estimate.known_generator()?;
    Some([0, 1, 2].map(|row| [a[(row, 0)], a[(row, 1)], a[(row, 2)]]))
}

#[cfg(test)]
mod tests {
    use freeform_motion::riccati::MotionModel;
    use freeform_motion::tracker::Method;
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn what_is_not_observable_is_null_and_so_is_the_generator() {
        let estimate = MotionEstimate::new(MotionModel::Rigid, &[1.5, -0.3, 0.4], Some(&[0.1, 0.2, 0.3]));
        let result = ObjectResult {
            frames: 12,
            frames_rejected: 1,
            estimate: Some(estimate.with_unobservable(0).in_space(CameraScale::new(0.1).expect("a scale"))),
            warnings: vec![Warning::AffineBias, Warning::Lost { last_known: Some(1.733) }],
            ..ObjectResult::unknown("left", Method::Adaptive, MotionModel::Rigid)
        };
        let mut text = Vec::new();
        let b = MeaningOfB::in_coordinates(None);
        write_identify_json(&mut text, &[result], &b, &LeftOut::default(), &[]).expect("memory");
        let document: Value = serde_json::from_slice(&text).expect("JSON");
        let object = &document["objects"][0];
        let nothing = json!({
            "value": null, "std": null, "std_random": null, "std_systematic": null, "unit": "rad/s", "observable": false,
            "reason": "unknown", "aliases": [],
        });
        assert_eq!(object["parameters"]["omega"], nothing);
        assert_eq!(
            object["parameters"]["b2"],
            json!({
                "value": 0.4 / 0.1, "std": 0.3 / 0.1, "std_random": 0.3 / 0.1, "std_systematic": 0.0, "unit": "1/s",
                "observable": true, "reason": null,
            })
        );
        assert_eq!(
            (&object["generator"], &object["warnings"]),
            (
                &Value::Null,
                &json!([
                    {"code": "affine_bias", "message": Warning::AffineBias.to_string()},
                    {"code": "lost", "message": "the object was lost at the end; it was followed until 1.733 s: trajectory and trace have its last poses and motion"},
                ])
            )
        );
    }
}
