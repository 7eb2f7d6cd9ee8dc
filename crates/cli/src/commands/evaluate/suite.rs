//! The settings of docs/accuracy.md.
use freeform_motion::riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_motion::sim_camera::{BuiltInShape, Sampling};

use super::acquisition::AcquisitionSetting;
use super::setting::Setting;
use crate::failure::Failure;

/// The built-in shapes of the suite.
pub(super) const SHAPES: [BuiltInShape; 6] = [
    BuiltInShape::Bird,
    BuiltInShape::Glider,
    BuiltInShape::Phone,
    BuiltInShape::Van,
    BuiltInShape::Shoe,
    BuiltInShape::Hat,
];

/// The settings whose names contain a text.
pub(super) fn containing(text: &str) -> Result<(Vec<Setting>, Vec<AcquisitionSetting>), Failure> {
    let (mut settings, mut acquisitions) = (settings(), acquisitions());
    let names: Vec<_> = settings.iter().map(|s| &s.name).chain(acquisitions.iter().map(|a| &a.name)).collect();
    let unknown = format!("no setting of the suite contains {text:?}; they are {names:?}");
    settings.retain(|setting| setting.name.contains(text));
    acquisitions.retain(|setting| setting.name.contains(text));
    if settings.is_empty() && acquisitions.is_empty() {
        return Err(Failure::unusable(unknown));
    }
    Ok((settings, acquisitions))
}

fn settings() -> Vec<Setting> {
    let rigid = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
    let sheared = AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -0.3, b2: 0.4 };
    let clean = |name: String, frames| Setting {
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
    let affine = |name: String, frames| Setting { model: MotionModel::Affine, motion: sheared, ..clean(name, frames) };
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
        let (settings, acquisitions) = containing("arc missing").expect("some");
        assert!(settings.iter().all(|s| s.occlusion == 0.2) && settings.len() == 5 && acquisitions.len() == 1);
        let Err(failure) = containing("nonsense") else { panic!("there is no such setting") };
        assert!(failure.text().contains("rigid, clean, 3 frames") && failure.text().contains("acquisition"));
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
