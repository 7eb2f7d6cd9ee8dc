use super::of_class;
use crate::stress::body::Body;
use crate::stress::class::Class;
use crate::stress::course::{Course, Path};
use crate::stress::fault::Fault;
use crate::stress::kind::Kind;
use crate::stress::recipe::{Depth, Recipe, Sensing};

/// Outlines that are round or nearly so.
pub(in crate::stress) fn kinds() -> Vec<Kind> {
    let moving = |body: Body, omega: f64, speed: f64, path: Path| Recipe {
        body,
        course: Course { omega: (omega, omega), speed: (speed, speed), start: 1.0, path },
        ..Recipe::plain()
    };
    let disc = |omega: f64, speed: f64, path: Path| moving(Body::Circle, omega, speed, path);
    let straight = |body: Body| moving(body, 2.0, 0.3, Path::Velocity);
    let ellipse = |eccentricity: f64| straight(Body::Ellipse { eccentricity });
    let rolling = || disc(2.5, 0.0, Path::Rolling { slowing: 0.0 });
    let traced =
        |recipe: Recipe, pixels: f64, depth: Depth| Recipe { sensing: Sensing::Traced { pixels, depth }, ..recipe };
    let faulty = |fault: Fault| Recipe { faults: vec![fault], ..disc(2.0, 0.3, Path::Velocity) };
    of_class(
        Class::Round,
        [
            ("disc at rest", "a circle at rest", disc(0.0, 0.0, Path::Velocity)),
            ("disc spinning in its place", "a circle that turns about its own middle", disc(2.0, 0.0, Path::Velocity)),
            ("disc rolling", "a circle that rolls at 2.5 rad/s", rolling()),
            (
                "disc rolling to rest",
                "a circle that rolls and is slowed down",
                disc(2.5, 0.0, Path::Rolling { slowing: 0.2 }),
            ),
            ("disc on an arc", "a circle on a turntable: a constant generator", disc(1.5, 0.5, Path::Generator)),
            (
                "disc spinning and travelling",
                "a circle that spins at 2 rad/s and runs straight",
                disc(2.0, 0.3, Path::Velocity),
            ),
            (
                "disc accelerating",
                "a circle whose middle is accelerated by 0.2 sizes/s^2",
                disc(2.0, 0.3, Path::Accelerating { spin: 0.3, middle: 0.2 }),
            ),
            (
                "disc, noise of 0.05 %",
                "a circle that spins and runs straight, errors of 0.05 %",
                Recipe { noise: 0.0005, ..disc(2.0, 0.3, Path::Velocity) },
            ),
            (
                "disc with a hidden arc",
                "a circle of which a fifth is missing, somewhere else in every frame",
                faulty(Fault::HiddenArc { share: 0.2 }),
            ),
            (
                "disc with outliers",
                "a circle with 5 % of outliers",
                faulty(Fault::Outliers { share: 0.05, radius: 0.3 }),
            ),
            ("disc in light", "a circle in light of 2 % from one side", faulty(Fault::Light { depth: 0.02 })),
            (
                "grey disc of 40 pixels, rolling",
                "traced in grey pictures, where the grid of pixels leaves ripples",
                traced(rolling(), 40.0, Depth::Grey),
            ),
            ("grey disc of 120 pixels, rolling", "the same of 120 pixels", traced(rolling(), 120.0, Depth::Grey)),
            (
                "grey disc of 60 pixels, rolling, outline at 218",
                "traced at the grey value 218 of 255, where the ripples are larger",
                traced(rolling(), 60.0, Depth::GreyAt(218.0)),
            ),
            (
                "black and white disc of 60 pixels, rolling",
                "traced in masks of two values",
                traced(rolling(), 60.0, Depth::Binary),
            ),
            (
                "grey disc of 60 pixels, on an arc",
                "traced in grey pictures, on a turntable",
                traced(disc(1.5, 0.5, Path::Generator), 60.0, Depth::Grey),
            ),
            (
                "grey disc of 60 pixels, at rest",
                "traced in grey pictures, at rest: the same ripples in every frame",
                traced(disc(0.0, 0.0, Path::Velocity), 60.0, Depth::Grey),
            ),
            (
                "ellipse of eccentricity 0.02",
                "spins at 2 rad/s and runs straight; its axes differ by 0.02 %",
                ellipse(0.02),
            ),
            ("ellipse of eccentricity 0.05", "the same; its axes differ by 0.13 %", ellipse(0.05)),
            ("ellipse of eccentricity 0.1", "the same; its axes differ by 0.5 %", ellipse(0.1)),
            ("ellipse of eccentricity 0.2", "the same; its axes differ by 2 %", ellipse(0.2)),
            ("ellipse of eccentricity 0.3", "the same; its axes differ by 5 %", ellipse(0.3)),
            ("ellipse of eccentricity 0.4", "the same; its axes differ by 8 %", ellipse(0.4)),
            (
                "ellipse of eccentricity 0.3 in its place",
                "turns about its own middle",
                moving(Body::Ellipse { eccentricity: 0.3 }, 2.0, 0.0, Path::Velocity),
            ),
            (
                "ellipse of eccentricity 0.3 on an arc",
                "on a turntable: a constant generator",
                moving(Body::Ellipse { eccentricity: 0.3 }, 1.5, 0.5, Path::Generator),
            ),
            (
                "grey ellipse of eccentricity 0.2",
                "spins and runs straight, traced in grey pictures of 60 pixels",
                traced(ellipse(0.2), 60.0, Depth::Grey),
            ),
            (
                "three lobes of 2 %",
                "a circle with three waves of 2 %, spins at 2 rad/s and runs straight",
                straight(Body::Lobes { lobes: 3, amplitude: 0.02 }),
            ),
            (
                "three lobes of 0.5 %",
                "the same with waves of 0.5 %",
                straight(Body::Lobes { lobes: 3, amplitude: 0.005 }),
            ),
            (
                "egg of 1 %, noise of 0.05 %",
                "the egg of 1 % with errors of 0.05 %",
                Recipe { noise: 0.0005, ..straight(Body::Egg { amplitude: 0.01 }) },
            ),
            (
                "ellipse of eccentricity 0.3, noise of 0.05 %",
                "spins at 2 rad/s and runs straight, errors of 0.05 %",
                Recipe { noise: 0.0005, ..ellipse(0.3) },
            ),
            (
                "egg of 1 %",
                "an egg that differs from a circle by 1 %, spins at 2 rad/s and runs straight",
                straight(Body::Egg { amplitude: 0.01 }),
            ),
            ("egg of 0.2 %", "the same that differs by 0.2 %", straight(Body::Egg { amplitude: 0.002 })),
        ],
    )
}
