use freeform_drawing::MeaningOfB;
use freeform_motion::estimate::PoseParameter;
use freeform_motion::tracker::{Method, MotionFamily, NotStated, ObjectPhase, ObjectResult, Observation, Sighting};
use serde::ser::{Serialize, Serializer};

use super::identify_json::{EitherAmbiguity, Parameters, Unstated, WarningJson, ambiguity_json, generator_rows};
use super::plane_json::NormalJson;
use super::velocity_json::VelocityJson;

/// One frame as one line of JSON, without its end. The pose is that of the object after the frame, where it is known.
pub(crate) fn track_line(
    observation: &Observation,
    pose: Option<&[PoseParameter]>,
    (method, family): (Method, MotionFamily),
    b: &MeaningOfB,
) -> serde_json::Result<String> {
    let estimate = observation.estimate.as_ref();
    let pose = PoseJson::new((method, family), pose, observation.pose_not_stated(), b);
    serde_json::to_string(&TrackLine {
        schema: "freeform.track/1",
        object: &observation.object,
        frame: observation.frame,
        time: observation.time,
        phase: observation.phase.map(ObjectPhase::name),
        accepted: observation.is_accepted(),
        parameters: observation.parameters().map(|found| {
            Parameters::new(found, (family, b), &observation.aliases, |name| observation.not_stated(name))
        }),
        generator: estimate.and_then(generator_rows),
        velocity: observation.velocity.as_ref().map(VelocityJson),
        normal: observation.plane.as_deref().map(NormalJson::from),
        reason: observation.rejection.as_ref().map(ToString::to_string),
        ambiguity: ambiguity_json(observation.ambiguity.as_ref(), observation.plane_ambiguity.as_deref()),
        unstated: Unstated::of(
            observation.unstated(family),
            observation.velocity_not_stated().filter(|_| family.has_velocity(method)),
        )
        .and(pose.iter().flat_map(PoseJson::unstated)),
        pose,
        segment: Some(observation.segment),
        warnings: None,
    })
}

/// The last line of an object of a stream that has left, without its end.
pub(crate) fn closing_line(seen: &Sighting, result: &ObjectResult, b: &MeaningOfB) -> serde_json::Result<String> {
    // Where it is by now nobody knows.
    let pose = PoseJson::new((result.method, result.motion), None, NotStated::Unknown, b);
    serde_json::to_string(&TrackLine {
        schema: "freeform.track/1",
        object: &seen.object,
        frame: seen.frame,
        time: seen.time,
        phase: Some("closed"),
        accepted: false,
        parameters: result
            .parameters()
            .map(|found| Parameters::new(found, (result.motion, b), &result.aliases, |name| result.not_stated(name))),
        generator: result.estimate.as_ref().and_then(generator_rows),
        velocity: result.velocity.as_ref().map(VelocityJson),
        normal: result.plane.as_deref().map(NormalJson::from),
        reason: Some("not seen for long, and forgotten".to_owned()),
        ambiguity: ambiguity_json(result.ambiguity.as_ref(), result.plane_ambiguity.as_deref()),
        unstated: Unstated::of_result(result).and(pose.iter().flat_map(PoseJson::unstated)),
        pose,
        segment: None,
        warnings: Some(result.warnings.iter().map(WarningJson::from).collect()),
    })
}

#[derive(serde::Serialize)]
struct TrackLine<'a> {
    schema: &'static str,
    object: &'a str,
    frame: u64,
    time: Option<f64>,
    phase: Option<&'static str>,
    accepted: bool,
    parameters: Option<Parameters<'a>>,
    generator: Option<[[f64; 3]; 3]>,
    velocity: Option<VelocityJson<'a>>,
    /// Of a plane in space alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<NormalJson>,
    reason: Option<String>,
    ambiguity: Option<EitherAmbiguity<'a>>,
    unstated: Unstated,
    /// Not of a plane in space, nor of the adaptive method.
    pose: Option<PoseJson>,
    segment: Option<usize>,
    /// Of the last line of an object alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    warnings: Option<Vec<WarningJson>>,
}

/// A pose by the names that the columns of a trajectory have.
struct PoseJson(Vec<(&'static str, PoseNumber)>);

/// As a parameter of the motion, where it is known.
#[derive(Clone, Copy, serde::Serialize)]
struct PoseNumber {
    value: Option<f64>,
    std: Option<f64>,
    unit: &'static str,
    #[serde(serialize_with = "reason_name")]
    reason: Option<NotStated>,
}

impl PoseJson {
    /// `why` is why numbers have no value, where they have none. `None` if the method gives no pose.
    fn new(
        (method, family): (Method, MotionFamily),
        pose: Option<&[PoseParameter]>,
        why: NotStated,
        b: &MeaningOfB,
    ) -> Option<Self> {
        let names = family.pose_names(method);
        let numbers = names.iter().map(|name| {
            let known = pose.and_then(|pose| pose.iter().find(|number| number.name == *name));
            let known = known.filter(|number| number.value.is_finite() && number.standard_deviation.is_finite());
            let number = PoseNumber {
                value: known.map(|number| number.value),
                std: known.map(|number| number.standard_deviation),
                unit: b.short_unit.of_pose(name),
                reason: known.is_none().then_some(why),
            };
            (*name, number)
        });
        (!names.is_empty()).then(|| Self(numbers.collect()))
    }

    /// Those without a value, each with why.
    fn unstated(&self) -> impl Iterator<Item = (&'static str, NotStated)> {
        self.0.iter().filter_map(|(name, number)| Some((*name, number.reason?)))
    }
}

impl Serialize for PoseJson {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, number)| (name, number)))
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, clippy::ref_option, reason = "as serde calls it")]
fn reason_name<S: Serializer>(reason: &Option<NotStated>, serializer: S) -> Result<S::Ok, S::Error> {
    reason.map(NotStated::name).serialize(serializer)
}
