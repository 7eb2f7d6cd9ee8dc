use super::of_class;
use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::course::Course;
use crate::stress::fault::Fault;
use crate::stress::kind::Kind;
use crate::stress::recipe::{Depth, Recipe, Sampling, Sensing};

/// Errors that depend on each other, beside independent ones of 0.2 %.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let with = |fault: Fault| Recipe { noise: 0.002, faults: vec![fault], ..Recipe::plain() };
    let smooth = |points: f64| with(Fault::Smooth { deviation: 0.005, points });
    let slow = |points: f64, keep: f64| with(Fault::Slow { deviation: 0.005, points, keep });
    let same = |recipe: Recipe| Recipe { sampling: Sampling::Same, ..recipe };
    let light = |depth: f64| with(Fault::Light { depth });
    let masks = |pixels: f64, body: Body, pace: f64| {
        let plain = Recipe::plain();
        let Course { omega, speed, .. } = plain.course;
        let course =
            Course { omega: (pace * omega.0, pace * omega.1), speed: (pace * speed.0, pace * speed.1), ..plain.course };
        Recipe { body, course, sensing: Sensing::Traced { pixels, depth: Depth::Binary }, ..plain }
    };
    let blob = |recipe: Recipe| Recipe { body: Body::Blob, ..recipe };
    of_class(
        Class::Noise,
        [
            ("smooth over 5 points", "errors of 0.5 % that are smooth along the contour over 5 points", smooth(5.0)),
            ("smooth over 20 points", "errors of 0.5 % that are smooth along the contour over 20 points", smooth(20.0)),
            ("smooth over 60 points", "errors of 0.5 % that are smooth along the contour over 60 points", smooth(60.0)),
            ("smooth over 20 points, blob", "the same over 20 points on a smooth contour", blob(smooth(20.0))),
            (
                "smooth over 5 points, kept to 0.9",
                "smooth over 5 points and going along with the body, kept from frame to frame to 0.9",
                slow(5.0, 0.9),
            ),
            ("smooth over 5 points, kept to 0.98", "the same kept to 0.98: for nearly two seconds", slow(5.0, 0.98)),
            ("smooth over 20 points, kept to 0.9", "smooth over 20 points and kept to 0.9", slow(20.0, 0.9)),
            ("smooth over 20 points, kept to 0.98", "smooth over 20 points and kept to 0.98", slow(20.0, 0.98)),
            (
                "smooth over 20 points, kept to 0.9, blob",
                "smooth over 20 points and kept to 0.9, on a smooth contour",
                blob(slow(20.0, 0.9)),
            ),
            (
                "smooth over 20 points, kept to 0.98, blob",
                "smooth over 20 points and kept to 0.98, on a smooth contour",
                blob(slow(20.0, 0.98)),
            ),
            (
                "points kept to 0.5",
                "the error of each point of the body by itself is kept from frame to frame to 0.5",
                same(slow(0.0, 0.5)),
            ),
            (
                "points kept to 0.95",
                "the error of each point of the body by itself is kept to 0.95",
                same(slow(0.0, 0.95)),
            ),
            (
                "camera shake",
                "the picture shakes by 0.5 %, anew in every frame",
                with(Fault::Shake { deviation: 0.005, keep: 0.0 }),
            ),
            (
                "slow camera shake",
                "the picture shakes by 0.5 %, kept from frame to frame to 0.9",
                with(Fault::Shake { deviation: 0.005, keep: 0.9 }),
            ),
            (
                "light of 1 %",
                "light from one side moves the outline there by 1 % of the size: fixed in the picture",
                light(0.01),
            ),
            ("light of 2 %", "the same by 2 %", light(0.02)),
            ("light of 4 %", "the same by 4 %", light(0.04)),
            ("light of 8 %", "the same by 8 %", light(0.08)),
            ("light of 4 %, blob", "light of 4 % on a smooth contour", blob(light(0.04))),
            ("shadow of 2 %", "a shadow on one side takes away 2 % of the size there", light(-0.02)),
            ("shadow of 8 %", "a shadow on one side takes away 8 % of the size there", light(-0.08)),
            (
                "clustered outliers of 5 %",
                "5 % of the points, all on one side of the picture, lie up to 0.1 sizes outside",
                with(Fault::Clustered { share: 0.05, distance: 0.05 }),
            ),
            (
                "clustered outliers of 12 %",
                "12 % of the points, all on one side of the picture, lie up to 0.2 sizes outside",
                with(Fault::Clustered { share: 0.12, distance: 0.1 }),
            ),
            (
                "occluder over 5 %",
                "a straight edge in the picture hides 5 % of the contour, and the outline is closed along it",
                with(Fault::Occluder { share: 0.05 }),
            ),
            (
                "occluder over 15 %",
                "a straight edge in the picture hides 15 % of the contour",
                with(Fault::Occluder { share: 0.15 }),
            ),
            (
                "flicker",
                "the outline moves in and out by 1 % from frame to frame",
                with(Fault::Flicker { deviation: 0.01, keep: 0.0 }),
            ),
            (
                "slow flicker",
                "the outline moves in and out by 1 %, kept from frame to frame to 0.9",
                with(Fault::Flicker { deviation: 0.01, keep: 0.9 }),
            ),
            (
                "masks of 20 pixels",
                "traced in masks of two values, 20 pixels to a size",
                masks(20.0, Body::Object, 1.0),
            ),
            ("masks of 80 pixels", "the same, 80 pixels to a size", masks(80.0, Body::Object, 1.0)),
            (
                "masks of 20 pixels, slow",
                "20 pixels to a size, at a twentieth of the speed: a pixel or two in three seconds",
                masks(20.0, Body::Object, 0.05),
            ),
            (
                "masks of 80 pixels, slow",
                "80 pixels to a size, at a twentieth of the speed",
                masks(80.0, Body::Object, 0.05),
            ),
            (
                "masks of 30 pixels, slow polygon",
                "a polygon of long sides, 30 pixels to a size, at a twentieth of the speed",
                masks(30.0, Body::Polygon { corners: 5 }, 0.05),
            ),
            (
                "masks of 30 pixels, slow blob",
                "a smooth contour, 30 pixels to a size, at a twentieth of the speed",
                masks(30.0, Body::Blob, 0.05),
            ),
        ],
    )
}
