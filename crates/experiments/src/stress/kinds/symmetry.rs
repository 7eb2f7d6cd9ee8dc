use std::f64::consts::TAU;

use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::course::{Course, Path};
use crate::stress::kind::Kind;
use crate::stress::recipe::Recipe;

/// Teeth, amplitude in percent of the radius, and points of each gear.
const GEARS: [(usize, u8, usize); 6] =
    [(5, 10, 300), (8, 12, 300), (12, 8, 400), (20, 15, 600), (32, 6, 1000), (48, 4, 1500)];

/// Turns from frame to frame, shares of the pitch.
const TURNS: [f64; 5] = [0.2, 0.3, 0.4, 0.45, 0.5];

/// Outlines that look the same after a part of a turn.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let mut kinds = Vec::new();
    let mut add = |name: String, explanation: String, recipe: Recipe| {
        kinds.push(Kind::new(Class::Symmetry, name, explanation, recipe));
    };
    for (teeth, percent, points) in GEARS {
        for share in TURNS {
            let body = Body::Gear { teeth, amplitude: 0.01 * f64::from(percent) };
            let recipe = Recipe { points, ..turning(body, teeth, share, 0.0) };
            let explanation = format!("teeth of {percent} %, turns about its axis by {share} of a pitch per frame");
            add(format!("gear of {teeth} teeth, {share} of a pitch"), explanation, recipe);
        }
    }
    for (corners, shares) in [(3, [0.3, 0.45]), (4, [0.3, 0.45]), (6, [0.3, 0.45])] {
        for share in shares {
            let recipe = turning(Body::Regular { corners }, corners, share, 0.0);
            let explanation =
                format!("turns about its middle by {share} of the angle after which it looks the same, per frame");
            add(format!("polygon of {corners} sides, {share} of a pitch"), explanation, recipe);
        }
    }
    let travelling = Recipe { points: 600, ..turning(Body::Gear { teeth: 20, amplitude: 0.15 }, 20, 0.4, 0.3) };
    let explanation = "the gear of 20 teeth turns by 0.4 of a pitch per frame and runs straight".to_owned();
    add("gear of 20 teeth, 0.4 of a pitch, travelling".to_owned(), explanation, travelling);
    for share in [0.45, 0.5] {
        let explanation =
            format!("an object without symmetry turns about its middle by {share} of a full turn per frame");
        add(format!("object, {share} of a turn"), explanation, turning(Body::Object, 1, share, 0.0));
    }
    let half = Recipe { body: Body::Ellipse { eccentricity: 0.8 }, ..turning(Body::Circle, 2, 0.45, 0.0) };
    let explanation = "turns about its middle by 0.45 of half a turn per frame".to_owned();
    add("ellipse, 0.45 of half a turn".to_owned(), explanation, half);
    kinds
}

/// Two seconds of a body that turns by a share of the pitch per frame.
fn turning(body: Body, fold: usize, share: f64, speed: f64) -> Recipe {
    let plain = Recipe::plain();
    let omega = share * TAU / fold as f64 * plain.fps;
    let course = Course { omega: (omega, omega), speed: (speed, speed), start: 1.0, path: Path::Velocity };
    Recipe { body, course, frames: 60, noise: 0.002, ..plain }
}
