use super::of_class;
use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::course::{Course, Path};
use crate::stress::kind::Kind;
use crate::stress::recipe::Recipe;

/// Motions that are no constant generator, of contours that show their turn. The truth is that at the last frame.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let on = |path: Path| Recipe { course: Course { path, ..Recipe::plain().course }, frames: 120, ..Recipe::plain() };
    let blob = |recipe: Recipe| Recipe { body: Body::Blob, ..recipe };
    let spin = |recipe: Recipe, low: f64, high: f64| Recipe {
        course: Course { omega: (low, high), ..recipe.course },
        ..recipe
    };
    let speed = |recipe: Recipe, low: f64, high: f64| Recipe {
        course: Course { speed: (low, high), ..recipe.course },
        ..recipe
    };
    let in_place = |recipe: Recipe| speed(recipe, 0.0, 0.0);
    let gaining = |spin: f64| on(Path::Accelerating { spin, middle: 0.0 });
    // From 1 rad/s to so much more in the four seconds of the sequence.
    let growing = |gain: f64| in_place(spin(gaining(gain / 4.0), 1.0, 1.0));
    let straight = || on(Path::Velocity);
    let swinging = |period: f64, share: f64| on(Path::Oscillating { period, share });
    of_class(
        Class::Dynamics,
        [
            ("straight", "constant spin, and the middle runs straight", straight()),
            ("straight, blob", "the same with a smooth contour", blob(straight())),
            ("straight, slow spin", "the same at 0.1 to 0.3 rad/s", spin(straight(), 0.1, 0.3)),
            ("straight, fast spin", "the same at 3 to 5 rad/s", spin(straight(), 3.0, 5.0)),
            ("straight, fast travel", "the same at 1 to 2 sizes per second", speed(straight(), 1.0, 2.0)),
            (
                "straight, very slow",
                "the same at 0.02 rad/s and 0.01 sizes per second",
                spin(speed(straight(), 0.01, 0.01), 0.02, 0.02),
            ),
            (
                "spin about a point aside",
                "spins at 3 to 10 rad/s, and a point a tenth of a size from the middle runs straight",
                spin(on(Path::Aside { distance: 0.1 }), 3.0, 10.0),
            ),
            (
                "fast spin about a point aside",
                "the same at 20 to 40 rad/s about a point a twentieth of a size from the middle",
                spin(on(Path::Aside { distance: 0.05 }), 20.0, 40.0),
            ),
            ("straight, 15 frames", "the same in half a second", Recipe { frames: 15, ..straight() }),
            ("spin grows by 0.02 rad/s^2", "the spin grows, and the middle runs straight", gaining(0.02)),
            ("spin grows by 0.1 rad/s^2", "the same by 0.1 rad/s^2", gaining(0.1)),
            ("spin grows by 0.5 rad/s^2", "the same by 0.5 rad/s^2", gaining(0.5)),
            ("spin grows by 1 rad/s^2", "the same by 1 rad/s^2", gaining(1.0)),
            ("spin grows by 3 rad/s^2", "the same by 3 rad/s^2", gaining(3.0)),
            ("spin grows by 0.02 rad/s^2, blob", "the same by 0.02 rad/s^2 with a smooth contour", blob(gaining(0.02))),
            ("spin grows by 0.5 rad/s^2, blob", "the same by 0.5 rad/s^2 with a smooth contour", blob(gaining(0.5))),
            ("omega 1 to 1.05", "turns in its place, from 1 to 1.05 rad/s in 4 s", growing(0.05)),
            ("omega 1 to 1.05, blob", "the same with a smooth contour", blob(growing(0.05))),
            ("omega 1 to 1.5", "turns in its place, from 1 to 1.5 rad/s in 4 s", growing(0.5)),
            ("omega 1 to 1.5, blob", "the same with a smooth contour", blob(growing(0.5))),
            (
                "turntable that speeds up",
                "about a point half a size away, the spin growing by 0.2 rad/s^2",
                on(Path::Pivot { spin: 0.2 }),
            ),
            ("turntable that speeds up, blob", "the same with a smooth contour", blob(on(Path::Pivot { spin: 0.2 }))),
            (
                "middle accelerates",
                "the spin is constant, and the middle is accelerated by 0.2 sizes/s^2",
                on(Path::Accelerating { spin: 0.0, middle: 0.2 }),
            ),
            (
                "thrown",
                "thrown with spin: the middle falls by 2 sizes/s^2",
                Recipe { frames: 60, ..speed(on(Path::Thrown { gravity: 2.0 }), 1.0, 2.0) },
            ),
            (
                "thrown, small",
                "the same of a body of 12 cm: by 80 sizes/s^2, at 5 to 15 sizes per second",
                Recipe { frames: 24, ..speed(on(Path::Thrown { gravity: 80.0 }), 5.0, 15.0) },
            ),
            ("rolling", "on a wheel of the size of the object, without slipping", on(Path::Rolling { slowing: 0.0 })),
            (
                "rolling to rest",
                "the same, slowed down by a fifth of its speed per second",
                on(Path::Rolling { slowing: 0.2 }),
            ),
            ("sudden stop", "straight with constant spin, and from 2.5 s on at rest", on(Path::Stop { time: 2.5 })),
            ("sudden stop, blob", "the same with a smooth contour", blob(on(Path::Stop { time: 2.5 }))),
            ("late stop", "at rest for the last half second only", on(Path::Stop { time: 3.45 })),
            (
                "stop and go",
                "moves for 0.68 s and rests for 0.68 s, over and over",
                on(Path::StopAndGo { period: 1.36 }),
            ),
            ("slow oscillation", "spin and velocity vary by half to and fro in 4 s", swinging(4.0, 0.25)),
            ("swing", "swings to and fro in 3 s", swinging(3.0, 1.0)),
            ("swing, blob", "the same with a smooth contour", blob(swinging(3.0, 1.0))),
            ("fast swing", "swings to and fro in 0.7 s", swinging(0.7, 1.0)),
            (
                "wide swing",
                "swings to and fro in 1 s, at up to 5 to 10 sizes per second and 3 to 6 rad/s",
                spin(speed(swinging(1.0, 1.0), 5.0, 10.0), 3.0, 6.0),
            ),
            (
                "hops",
                "moves for 0.2 s at 5 to 10 sizes per second and rests for 0.2 s, over and over",
                speed(on(Path::StopAndGo { period: 0.4 }), 5.0, 10.0),
            ),
            (
                "disc with a notch that swings",
                "a disc with a notch swings to and fro in 1 s, in its place, at up to 4 to 7 rad/s",
                Recipe {
                    body: Body::Notched { depth: 0.35, angle: 0.3 },
                    ..in_place(spin(swinging(1.0, 1.0), 4.0, 7.0))
                },
            ),
        ],
    )
}
