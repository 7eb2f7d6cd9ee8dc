use std::f64::consts::PI;

use super::of_class;
use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::kind::Kind;
use crate::stress::recipe::{Deformation, Recipe};
use crate::stress::view::View;

/// Distance in sizes from which a perspective camera looks.
const DISTANCE: f64 = 5.0;

/// Rigid motion is asked for and there is more.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let plain = Recipe::plain;
    let growth = |percent: f64| Recipe { deformation: Deformation::Growth(0.01 * percent), ..plain() };
    let bending = |sag: f64, period: f64| Recipe { deformation: Deformation::Bending { sag, period }, ..plain() };
    let tilted = |degrees: f64, distance: f64| Recipe {
        view: View::Tilted { angle: degrees * PI / 180.0, axis: 0.0, distance },
        ..plain()
    };
    let seen = |view: View| Recipe { view, ..plain() };
    let blob = |recipe: Recipe| Recipe { body: Body::Blob, ..recipe };
    // So much of the distance at 1.5 sizes from the middle of the picture.
    let lens = |share: f64| seen(View::Lens { strength: share / (1.5 * 1.5) });
    // A picture three sizes high is read in this share of a thirtieth of a second.
    let shutter = |share: f64| seen(View::RollingShutter { delay: share / 30.0 / 3.0 });
    let orthographic = f64::INFINITY;
    of_class(
        Class::Family,
        [
            ("growth of 1 %/s", "the object grows by 1 % per second", growth(1.0)),
            ("growth of 2 %/s", "the object grows by 2 % per second", growth(2.0)),
            ("growth of 5 %/s", "the object grows by 5 % per second", growth(5.0)),
            ("growth of 10 %/s", "the object grows by 10 % per second", growth(10.0)),
            ("growth of 20 %/s", "the object grows by 20 % per second, 80 % in all", growth(20.0)),
            ("shrinking by 5 %/s", "the object shrinks by 5 % per second", growth(-5.0)),
            ("growth of 5 %/s, blob", "a smooth contour grows by 5 % per second", blob(growth(5.0))),
            (
                "plane tilted by 10 degrees",
                "the plane of the motion is tilted, seen by an orthographic camera",
                tilted(10.0, orthographic),
            ),
            ("plane tilted by 20 degrees", "the same by 20 degrees", tilted(20.0, orthographic)),
            ("plane tilted by 35 degrees", "the same by 35 degrees", tilted(35.0, orthographic)),
            ("plane tilted by 50 degrees", "the same by 50 degrees", tilted(50.0, orthographic)),
            ("perspective of 10 degrees", "the plane is tilted, seen by a camera 5 sizes away", tilted(10.0, DISTANCE)),
            ("perspective of 30 degrees", "the same by 30 degrees", tilted(30.0, DISTANCE)),
            ("perspective of 50 degrees", "the same by 50 degrees", tilted(50.0, DISTANCE)),
            ("pixels 2 % wider", "pixels are 2 % wider than high and taken to be square", seen(View::Aspect(0.02))),
            ("pixels 10 % wider", "pixels are 10 % wider than high and taken to be square", seen(View::Aspect(0.1))),
            ("pixels 10 % wider, blob", "the same with a smooth contour", blob(seen(View::Aspect(0.1)))),
            ("bending by 2 %", "the body bends to and fro in 4 s, its ends by 2 % of the size", bending(0.02, 4.0)),
            ("bending by 10 %", "the body bends to and fro in 4 s, its ends by 10 % of the size", bending(0.1, 4.0)),
            ("fast bending", "the body bends to and fro in 0.5 s, its ends by 3 % of the size", bending(0.03, 0.5)),
            ("lens of 0.5 %", "a lens moves points at 1.5 sizes from the middle of the picture by 0.5 %", lens(0.005)),
            ("lens of 2 %", "a lens moves points at 1.5 sizes from the middle of the picture by 2 %", lens(0.02)),
            (
                "rolling shutter, half a frame",
                "rows are read one after another, in half of the time to the next frame",
                shutter(0.5),
            ),
            (
                "rolling shutter, a frame",
                "rows are read one after another, in all of the time to the next frame",
                shutter(1.0),
            ),
        ],
    )
}
