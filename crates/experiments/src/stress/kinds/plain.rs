use super::of_class;
use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::course::Course;
use crate::stress::fault::Fault;
use crate::stress::kind::Kind;
use crate::stress::recipe::{Recipe, Sampling};

/// Seconds in a year.
const YEAR: f64 = 365.25 * 86_400.0;

/// What the motion filter assumes, in many settings.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let plain = Recipe::plain;
    let noise = |noise: f64| Recipe { noise, ..plain() };
    let of = |body: Body| Recipe { body, ..plain() };
    let points = |points: usize| Recipe { points, ..plain() };
    let frames = |frames: usize| Recipe { frames, ..plain() };
    let faults = |faults: &[Fault]| Recipe { faults: faults.to_vec(), ..plain() };
    let everything = [
        Fault::HiddenArc { share: 0.2 },
        Fault::Outliers { share: 0.05, radius: 0.3 },
        Fault::WrongFrames { share: 0.05 },
    ];
    let turning = |per_frame: f64| Course { omega: (30.0 * per_frame, 30.0 * per_frame), ..plain().course };
    of_class(
        Class::Plain,
        [
            ("white noise of 0.05 %", "independent errors of 0.05 % of the size", noise(0.0005)),
            ("white noise of 0.5 %", "independent errors of 0.5 % of the size, 90 frames of 300 points", plain()),
            ("white noise of 2 %", "independent errors of 2 % of the size", noise(0.02)),
            ("white noise of 5 %", "independent errors of 5 % of the size", noise(0.05)),
            ("blob", "a smooth contour without corners", of(Body::Blob)),
            (
                "blob, noise of 0.1 %",
                "a smooth contour with independent errors of 0.1 %",
                Recipe { noise: 0.001, ..of(Body::Blob) },
            ),
            (
                "disc with a notch",
                "a disc that shows its turn by a notch alone",
                of(Body::Notched { depth: 0.35, angle: 0.3 }),
            ),
            ("polygon", "a star-shaped polygon of 7 corners", of(Body::Polygon { corners: 7 })),
            ("long polygon", "a star-shaped polygon of 13 corners", of(Body::Polygon { corners: 13 })),
            (
                "slow gear",
                "a gear of 8 teeth that turns by a twentieth of a pitch per frame",
                Recipe {
                    course: turning(0.05 * std::f64::consts::TAU / 8.0),
                    ..of(Body::Gear { teeth: 8, amplitude: 0.1 })
                },
            ),
            (
                "fine gear",
                "a gear of 20 teeth that turns by a tenth of a pitch per frame",
                Recipe {
                    course: turning(0.1 * std::f64::consts::TAU / 20.0),
                    points: 600,
                    ..of(Body::Gear { teeth: 20, amplitude: 0.1 })
                },
            ),
            (
                "12 points",
                "12 points a frame of a smooth contour, errors of 0.2 %",
                Recipe { body: Body::Blob, noise: 0.002, ..points(12) },
            ),
            ("25 points", "25 points a frame", points(25)),
            ("40 points", "40 points a frame", points(40)),
            ("100 points", "100 points a frame", points(100)),
            ("1500 points", "1500 points a frame", points(1500)),
            ("3 frames", "three frames in all", frames(3)),
            ("8 frames", "eight frames in all", frames(8)),
            ("240 frames", "eight seconds", frames(240)),
            (
                "5 frames/s",
                "few frames a second: turns of up to 23 degrees from frame to frame",
                Recipe { fps: 5.0, frames: 40, ..plain() },
            ),
            ("200 frames/s", "many frames a second", Recipe { fps: 200.0, frames: 150, ..plain() }),
            (
                "points anywhere",
                "every point anywhere on the contour, not one in each stretch",
                Recipe { sampling: Sampling::Independent, ..plain() },
            ),
            (
                "hidden arc of 20 %",
                "a fifth of the contour is missing, somewhere else in every frame",
                faults(&everything[..1]),
            ),
            ("hidden arc of 40 %", "two fifths of the contour are missing", faults(&[Fault::HiddenArc { share: 0.4 }])),
            ("outliers of 5 %", "5 % of the points are up to 0.3 sizes off", faults(&everything[1..2])),
            (
                "outliers of 15 %",
                "15 % of the points are up to 0.3 sizes off",
                faults(&[Fault::Outliers { share: 0.15, radius: 0.3 }]),
            ),
            ("wrong frames of 5 %", "one frame in 20 shows another object", faults(&everything[2..])),
            ("dropped frames of 20 %", "one frame in 5 is missing", faults(&[Fault::DroppedFrames { share: 0.2 }])),
            ("everything", "a hidden arc of 20 %, 5 % of outliers, one frame in 20 wrong", faults(&everything)),
            ("everything, 30 frames", "the same in one second", Recipe { frames: 30, ..faults(&everything) }),
            (
                "fine rounding",
                "coordinates rounded to a grid of 200 pixels to a size, no other errors",
                Recipe { noise: 0.0, ..faults(&[Fault::Rounding { pixels: 200.0 }]) },
            ),
            (
                "coarse rounding",
                "coordinates rounded to a grid of 50 pixels to a size, beside independent errors",
                faults(&[Fault::Rounding { pixels: 50.0 }]),
            ),
            (
                "at rest",
                "nothing moves",
                Recipe { course: Course { omega: (0.0, 0.0), speed: (0.0, 0.0), ..plain().course }, ..plain() },
            ),
            (
                "far away",
                "the object is up to 20 sizes from the origin",
                Recipe { course: Course { start: 20.0, ..plain().course }, ..plain() },
            ),
            (
                "fast",
                "turns at 4 to 6 rad/s and runs at 2 to 3 sizes per second",
                Recipe { course: Course { omega: (4.0, 6.0), speed: (2.0, 3.0), ..plain().course }, ..plain() },
            ),
            ("nanoseconds", "a frame each nanosecond, times in seconds", Recipe { time_unit: 30e-9, ..plain() }),
            ("years", "240 frames a second, times in years", Recipe { fps: 240.0, time_unit: 1.0 / YEAR, ..plain() }),
            (
                "large lengths",
                "coordinates in units of a ten-thousandth of the size",
                Recipe { length_unit: 1e4, ..plain() },
            ),
        ],
    )
}
