//! docs/warnings.md has every warning: its code, an example of its message, and nothing else.
use std::collections::BTreeSet;

use freeform_motion::estimate::PlaneEstimate;
use freeform_motion::outline_filter::{Ambiguity, PlaneAmbiguity, PlaneSolution, Rejection, StandingEdge, WrongFamily};
use freeform_motion::outline_io::{OriginWarning, TracingWarning};
use freeform_motion::riccati::{MotionModel, PlaneMotion};
use freeform_motion::tracker::{FrameRejection, RejectionCause};
use freeform_motion::{TracedContours, TracedGround, Warning};
use nalgebra::{Point2, SMatrix};

const PAGE: &str = include_str!("../../docs/warnings.md");
const UNCERTAINTIES: &str = include_str!("../../docs/reading-uncertainties.md");
const SOURCE: &str = include_str!("../../src/warning.rs");
const TRACING_SOURCE: &str = include_str!("../../crates/outline-io/src/choice/warning.rs");

/// One example of each warning.
fn examples() -> Vec<Warning> {
    let family = |family| Warning::WrongFamily { family, motion: MotionModel::Rigid, ground: TracedGround::default() };
    let plane = PlaneEstimate::new(PlaneMotion::of_parameters([0.0; 8]), SMatrix::zeros(), [true; 8]);
    let solution = |probability| PlaneSolution { estimate: plane, probability };
    vec![
        Warning::PointsOutOfOrder { frame: 3, perimeters: 12.0 },
        Warning::Diverged,
        Warning::StateLost { reason: "the file is truncated".to_owned() },
        Warning::TooManyRejected { rejected: 37, frames: 75 },
        Warning::Lost { last_known: Some(1.733) },
        Warning::Reacquiring { last_known: 1.733 },
        Warning::OfTwoFrames,
        Warning::Restarted { times: 2 },
        Warning::Ambiguous(Ambiguity {
            turn: -50_f64.to_radians(),
            rival_turns: vec![40_f64.to_radians()],
            parameters: vec!["omega"],
        }),
        Warning::Aliases { omega: vec![-4.712, 7.854], motion: MotionModel::Rigid },
        Warning::TwoPlanes(Box::new(PlaneAmbiguity {
            solutions: [solution(0.6), solution(0.4)],
            parameters: vec!["wx", "wy", "normal"],
        })),
        Warning::AmbiguousCorrespondence { ambiguous: 9, matched: 60 },
        family(WrongFamily::Growth),
        family(WrongFamily::Shear),
        family(WrongFamily::Perspective),
        family(WrongFamily::RollingShutter),
        family(WrongFamily::Lens),
        family(WrongFamily::Shape),
        Warning::StandingEdge(StandingEdge {
            from: Point2::new(412.0, 96.5),
            to: Point2::new(398.2, 310.4),
            since: 0.9667,
            until: None,
        }),
        Warning::PartDisagrees { share: 0.27 },
        Warning::PlaneMisfit { excess: 3.2 },
        Warning::AffineBias,
        Warning::MotionChanged { dynamics: None },
        Warning::NotObservable { parameters: vec!["omega"], contours: TracedContours::default() },
        Warning::NotKnown { parameters: vec!["b1", "b2"] },
        Warning::RotationNotObservable { parameters: vec!["omega", "b1", "b2"] },
        Warning::RotationFromPath,
        Warning::PlaneHardlyMoves { parameters: vec!["vx", "vy", "vz", "normal"] },
        Warning::MayNotHaveSettled { seconds: 4.0 },
        Warning::LinesNotFollowed { skipped: 12, intervals: 59 },
        Warning::FramesRejected { rejected: 18, frames: 120 },
        Warning::RepeatedFrames { every: 6, rate: 30.0 },
        Warning::FrameRejected(FrameRejection {
            object: "0".to_owned(),
            frame: 17,
            cause: RejectionCause::NotAccepted(Rejection::AgreementTooSmall { agreement: 0.34, smallest: 0.5 }),
        }),
        Warning::MoreFramesRejected { count: 3, frames: [18, 19, 20].into_iter().collect() },
    ]
}

/// One example of each warning of how pictures are traced.
const TRACING_EXAMPLES: [TracingWarning; 3] = [
    TracingWarning::Doubtful,
    TracingWarning::MovesBesideRest { seen: 12, pictures: 24 },
    TracingWarning::MovesBeside { seen: 9, pictures: 24 },
];

/// Warnings of where outlines come from that are none of tracing.
const OF_ORIGIN: [OriginWarning; 9] = [
    OriginWarning::FilesOutOfOrder,
    OriginWarning::RateAssumed,
    OriginWarning::Interlaced,
    OriginWarning::LabelInParts,
    OriginWarning::LabelLeftOut,
    OriginWarning::VoidBorders,
    OriginWarning::PixelAspect,
    OriginWarning::NewAfterContact,
    OriginWarning::AmongAlike,
];

/// Code and example of every section of the page: the lines that begin with `>`, as one.
fn sections() -> Vec<(String, String)> {
    let sections = PAGE.split("\n### `").skip(1);
    sections
        .map(|section| {
            let (code, text) = section.split_once('`').expect("a code ends with a backquote");
            let quoted: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("> ")).collect();
            (code.to_owned(), quoted.join(" "))
        })
        .collect()
}

#[test]
fn every_warning_stands_on_the_page_with_its_message() {
    let written: BTreeSet<_> = sections().into_iter().collect();
    let of_objects = examples();
    let of_objects = of_objects.iter().map(|warning| (warning.code().to_owned(), warning.to_string()));
    let of_tracing = TRACING_EXAMPLES.iter().map(|warning| (warning.code().to_owned(), warning.to_string()));
    let of_origin = OF_ORIGIN.iter().map(|warning| (warning.code().to_owned(), warning.to_string()));
    let expected: BTreeSet<_> = of_objects.chain(of_tracing).chain(of_origin).collect();
    assert_eq!(written, expected);
}

#[test]
fn the_list_of_what_to_ask_before_a_number_is_used_has_every_warning() {
    let list = UNCERTAINTIES.split("\n## ").find(|section| section.starts_with("May I use this number?"));
    let list = list.expect("a section");
    let codes: BTreeSet<&str> = list.split('`').skip(1).step_by(2).collect();
    let missing: Vec<String> =
        sections().into_iter().map(|(code, _)| code).filter(|code| !codes.contains(&**code)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn there_is_an_example_of_every_code_of_the_enum() {
    fn codes(source: &str) -> BTreeSet<&str> {
        let body = source.split("pub const fn code").nth(1).and_then(|rest| rest.split("\n    }\n").next());
        let lines = body.expect("a body").lines();
        lines.filter_map(|line| line.split_once("=> \"")?.1.strip_suffix("\",")).collect()
    }
    let shown: Vec<Warning> = examples();
    assert_eq!(codes(SOURCE), shown.iter().map(Warning::code).collect());
    assert_eq!(codes(TRACING_SOURCE), TRACING_EXAMPLES.iter().map(TracingWarning::code).collect());
    let of_tracing = TRACING_EXAMPLES.iter().map(|warning| OriginWarning::from(*warning));
    let all: BTreeSet<_> = of_tracing.chain(OF_ORIGIN).map(OriginWarning::code).collect();
    assert_eq!(all, OriginWarning::ALL.into_iter().map(OriginWarning::code).collect());
}

#[test]
fn every_section_says_what_to_make_of_it() {
    for (section, (code, _)) in PAGE.split("\n### `").skip(1).zip(sections()) {
        let told = section.lines().skip(1).filter(|line| !line.starts_with('>') && !line.starts_with('#'));
        assert!(told.map(str::len).sum::<usize>() > 40, "{code}");
    }
}

#[test]
fn what_is_advised_against_light_fits_how_objects_were_told_from_the_ground() {
    let advised =
        |ground| Warning::WrongFamily { family: WrongFamily::Shape, motion: MotionModel::Rigid, ground }.to_string();
    assert!(advised(TracedGround::GreyValues).contains("(--background)"));
    let against_background = advised(TracedGround::Background);
    assert!(!against_background.contains("--background") && against_background.contains("--edge-uncertainty"));
    let unknown = advised(TracedGround::Unknown);
    assert!(against_background.starts_with(&unknown) && !unknown.contains("--edge-uncertainty"));
}
