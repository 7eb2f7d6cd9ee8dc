//! Names and values of settings, as a report lists them.
use freeform_motion::curve_fit::{FitSettings, Method};
use freeform_motion::outline_filter::FilterSettings;
use freeform_motion::tracker::MethodSettings;

use crate::args::TrackOptions;

/// Those of an identification.
pub(super) fn settings(options: &TrackOptions, input: &str) -> Vec<(&'static str, String)> {
    let scale = options.scale.map_or_else(|| "none: b in the image".to_owned(), |scale| scale.to_string());
    let mut listed = vec![("Input", input.to_owned()), ("Motion model", options.motion.family().to_string())];
    let settings = options.tracker_settings();
    listed.push(("Method", settings.method().to_string()));
    match settings.method {
        MethodSettings::Filter(FilterSettings { smallest_agreement, patience, .. })
        | MethodSettings::Plane(_, FilterSettings { smallest_agreement, patience, .. }) => {
            listed.push(("Agreement needed", format!("{} % of the points of a frame", 100.0 * smallest_agreement)));
            listed.push(("Searched for anew", format!("after {patience} rejected frames")));
            listed.push(("Degree of the curve drawn", options.degree_drawn().to_string()));
        }
        MethodSettings::Adaptive(settings) => listed.extend(fit_settings(&settings.fit)),
    }
    match options.perspective.camera() {
        Some(camera) => {
            let principal = camera.principal();
            listed.push(("Focal length", format!("{} pixels", camera.focal())));
            listed.push(("Principal point", format!("{},{}", principal.x, principal.y)));
        }
        None => listed.push(("Camera scale f/Z0", scale)),
    }
    if options.rectify.is_some() {
        listed.push(("Coordinates", "of the plane that --rectify leads to".to_owned()));
    }
    listed
}

/// Those of the curve fit.
pub(super) fn fit_settings(fit: &FitSettings) -> [(&'static str, String); 3] {
    let method = match fit.method {
        Method::ThreeLevel => "3L".to_owned(),
        Method::GloballyStabilised { ridge_weight } => format!("GS3L, ridge {ridge_weight}"),
        Method::Bounded { margin, ridge_weight } => format!("3L, bounded with margin {margin}, ridge {ridge_weight}"),
    };
    [
        ("Degree of the curve", fit.degree.to_string()),
        ("Curve fit", method),
        ("Level-set offset", format!("{} RMS radii", fit.offset)),
    ]
}

/// That of the program, which stands last.
pub(super) fn version() -> (&'static str, String) {
    ("Version", format!("freeform {}", env!("CARGO_PKG_VERSION")))
}
