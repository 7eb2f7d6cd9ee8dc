//! The settings of docs/accuracy.md.
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{BuiltInShape, Sampling};

use super::acquisition::AcquisitionSetting;
use super::setting::Setting;
use crate::ExperimentError;

/// The built-in shapes that every setting is evaluated on.
pub const SHAPES: [BuiltInShape; 6] = [
    BuiltInShape::Bird,
    BuiltInShape::Glider,
    BuiltInShape::Phone,
    BuiltInShape::Van,
    BuiltInShape::Shoe,
    BuiltInShape::Hat,
];

/// What the names of settings contain, one or another of them in each.
pub const WORDS: [&str; 10] =
    ["rigid", "affine", "clean", "stratified", "arc", "outliers", "noise", "points", "frames/s", "acquisition"];

/// The settings whose names contain a text, all for an empty one.
///
/// # Errors
/// There is none.
pub fn containing(text: &str) -> Result<(Vec<Setting>, Vec<AcquisitionSetting>), ExperimentError> {
    let (mut settings, mut acquisitions) = (settings(), acquisitions());
    settings.retain(|setting| setting.name.contains(text));
    acquisitions.retain(|setting| setting.name.contains(text));
    if settings.is_empty() && acquisitions.is_empty() {
        return Err(ExperimentError::NoSuchSetting { text: text.to_owned() });
    }
    Ok((settings, acquisitions))
}

/// How many times more runs the suite makes of an acquisition than of a motion: shares near 1 need many.
pub const ACQUISITION_RUNS: usize = 10;

fn settings() -> Vec<Setting> {
    let rigid = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
    let sheared = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -0.3, b2: 0.4 };
    let clean = |name: String, frames| Setting {
        plane: None,
        name,
        model: MotionModel::Rigid,
        motion: rigid.into(),
        frames,
        fps: 30.0,
        points: 400,
        noise: 0.005,
        occlusion: 0.0,
        outliers: 0.0,
        wrong_frames: 0.0,
        sampling: Sampling::Independent,
    };
    let affine =
        |name: String, frames| Setting { model: MotionModel::Affine, motion: sheared.into(), ..clean(name, frames) };
    let mut settings: Vec<Setting> = [3, 8, 30, 120].map(|n| clean(format!("rigid, clean, {n} frames"), n)).into();
    settings
        .push(Setting { sampling: Sampling::default(), ..clean("rigid, clean, stratified, 120 frames".into(), 120) });
    for n in [8, 30, 120] {
        settings.push(Setting { occlusion: 0.2, ..clean(format!("20 % arc missing, {n} frames"), n) });
    }
    for n in [8, 30, 120] {
        settings.push(Setting { outliers: 0.05, ..clean(format!("5 % outliers, {n} frames"), n) });
    }
    for n in [30, 120] {
        let name = format!("arc, outliers, 1 frame in 20 wrong, {n} frames");
        settings.push(Setting { occlusion: 0.2, outliers: 0.05, wrong_frames: 0.05, ..clean(name, n) });
    }
    settings.extend([30, 60, 120].map(|n| affine(format!("affine, clean, {n} frames"), n)));
    for n in [60, 120] {
        settings.push(Setting { occlusion: 0.2, ..affine(format!("affine, 20 % arc missing, {n} frames"), n) });
    }
    for noise in [0.0005, 0.002, 0.02, 0.05] {
        settings.push(Setting { noise, ..clean(format!("noise {noise}, 60 frames"), 60) });
    }
    for points in [40, 100, 1000, 4000] {
        settings.push(Setting { points, ..clean(format!("{points} points, 60 frames"), 60) });
    }
    for (fps, n) in [(2.0, 30), (10.0, 60), (200.0, 120)] {
        settings.push(Setting { fps, ..clean(format!("{fps} frames/s, {n} frames"), n) });
    }
    settings
}

fn acquisitions() -> Vec<AcquisitionSetting> {
    let acquisition = |name: &str, occlusion, outliers| AcquisitionSetting {
        name: name.to_owned(),
        model: MotionModel::Rigid,
        points: 400,
        noise: 0.005,
        occlusion,
        outliers,
        sampling: Sampling::Independent,
    };
    vec![
        acquisition("acquisition", 0.0, 0.0),
        acquisition("acquisition, 20 % arc missing", 0.2, 0.0),
        acquisition("acquisition, 5 % outliers", 0.0, 0.05),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_suite_is_chosen_by_its_name() {
        let (missing, acquired) = containing("arc missing").expect("some");
        assert!(missing.iter().all(|s| s.occlusion == 0.2) && missing.len() == 5 && acquired.len() == 1);
        let (settings, acquisitions) = containing("").expect("all");
        let message = containing("nonsense").expect_err("there is no such setting").to_string();
        assert!(message.len() < 200, "{message}");
        WORDS.iter().for_each(|word| assert!(message.contains(word) && containing(word).is_ok(), "{word}"));
        let names = settings.iter().map(|s| &s.name).chain(acquisitions.iter().map(|a| &a.name));
        names.for_each(|name| assert!(WORDS.iter().any(|word| name.contains(word)), "{name}"));
    }

    #[test]
    fn every_setting_has_a_name_of_its_own_and_can_be_simulated() {
        let all = settings();
        for (index, setting) in all.iter().enumerate() {
            assert!(all[..index].iter().all(|other| other.name != setting.name), "{}", setting.name);
            setting.simulator(&SHAPES[0].shape(), 0).expect("a simulator");
        }
    }
}
