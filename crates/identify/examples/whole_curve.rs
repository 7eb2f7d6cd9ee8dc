//! Monte Carlo of the whole-curve filter: root mean square error over the Cramer-Rao bound per parameter, coverage of the 95 %
//! intervals, lost runs, and time per frame.
//!
//! `cargo run --release -p freeform-identify --example whole_curve [RUNS [SETTING]]`: only settings whose name contains SETTING.
use std::time::Instant;

use freeform_curve_fit::Degree;
use freeform_identify::{BoundaryPoint, CramerRaoBound, CurveFilterSettings, WholeCurveFilter};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{
    BuiltInShape, Camera, Motion, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator,
};
use nalgebra::{Matrix3, Vector2};

struct Setting {
    name: String,
    shape: BuiltInShape,
    model: MotionModel,
    degree: Degree,
    frames: usize,
    occlusion: f64,
    outliers: f64,
    sampling: Sampling,
}

fn parameters(model: MotionModel) -> &'static [f64] {
    match model {
        MotionModel::Rigid => &[std::f64::consts::FRAC_PI_2, -0.3, 0.4],
        MotionModel::Similarity => &[-0.1, 1.2, -0.3, 0.4],
        _ => &[0.05, 1.2, -1.7, -0.08, -0.3, 0.4],
    }
}

fn motion(model: MotionModel) -> Motion {
    let g = model.generator(parameters(model));
    let [a1, a2, a3, a4] = [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)]];
    Motion::constant(freeform_riccati::AffineMotion { a1, a2, a3, a4, b1: g[(0, 2)], b2: g[(1, 2)] })
}

/// Smallest standard deviations; each of the points spread evenly stands for its share of those that inform.
fn bound(setting: &Setting) -> Vec<f64> {
    let shape = Shape::from(setting.shape);
    let theta = parameters(setting.model);
    let mut bound = CramerRaoBound::new(setting.model, theta).expect("a motion");
    let share = (1.0 - setting.occlusion) * (1.0 - setting.outliers);
    for frame in 0..setting.frames {
        let time = frame as f64 / 30.0;
        let pose: Matrix3<f64> = setting.model.flow(theta, time).into_inner();
        let cofactor = pose.fixed_view::<2, 2>(0, 0).try_inverse().expect("regular").transpose();
        let points = (0..1000).map(|i| {
            let s = f64::from(i) / 1000.0;
            let normal: Vector2<f64> = (cofactor * shape.normal_at(s).into_inner()).normalize();
            BoundaryPoint { point: pose.transform_point(&shape.point_at(s)), normal }
        });
        bound.add_frame(time, points, 0.005, share * 0.4).expect("finite");
    }
    bound.covariance().expect("finite").standard_deviations().map(|s| s.expect("observable")).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let runs: u64 = arguments.get(1).and_then(|a| a.parse().ok()).unwrap_or(20);
    let wanted = arguments.get(2).cloned().unwrap_or_default();
    let mut settings = Vec::new();
    for shape in [BuiltInShape::Bird, BuiltInShape::Glider] {
        for (model, frames, occlusion, outliers) in [
            (MotionModel::Rigid, 3, 0.0, 0.0),
            (MotionModel::Rigid, 8, 0.0, 0.0),
            (MotionModel::Rigid, 30, 0.0, 0.0),
            (MotionModel::Rigid, 120, 0.0, 0.0),
            (MotionModel::Rigid, 120, 0.2, 0.0),
            (MotionModel::Rigid, 120, 0.0, 0.05),
            (MotionModel::Similarity, 60, 0.0, 0.0),
            (MotionModel::Affine, 60, 0.0, 0.0),
        ] {
            for degree in [Degree::Quartic, Degree::Sextic, Degree::Octic] {
                for (sampling, spread) in [(Sampling::default(), "stratified"), (Sampling::Independent, "independent")]
                {
                    let corrupted = if occlusion > 0.0 {
                        " arc"
                    } else if outliers > 0.0 {
                        " outliers"
                    } else {
                        ""
                    };
                    let name = format!("{shape} {model} degree {degree} {frames} frames{corrupted} {spread}");
                    settings.push(Setting { name, shape, model, degree, frames, occlusion, outliers, sampling });
                }
            }
        }
    }
    println!("{:<54} {:>8} {:>4} {:>8}  RMSE / bound", "setting", "coverage", "lost", "us/frame");
    for setting in settings.iter().filter(|s| s.name.contains(&wanted)) {
        let bound = bound(setting);
        let theta = parameters(setting.model);
        let mut squares = vec![0.0; theta.len()];
        let (mut covered, mut lost, mut spent) = (0.0, 0, 0.0);
        for seed in 0..runs {
            let options = Settings {
                length: SequenceLength::Frames(setting.frames),
                sampling: setting.sampling,
                occlusion: Occlusion { fraction: setting.occlusion, ..Occlusion::default() },
                outliers: setting.outliers,
                seed,
                ..Settings::default()
            };
            let scene = Scene::new(setting.shape, motion(setting.model), Camera::default());
            let frames: Vec<_> = Simulator::new(scene, options).expect("good settings").frames().collect();
            let settings =
                CurveFilterSettings { model: setting.model, degree: setting.degree, ..CurveFilterSettings::default() };
            let mut filter = WholeCurveFilter::new(settings).expect("good settings");
            for frame in &frames {
                let start = Instant::now();
                let step = filter.step(frame.time, &frame.outline).expect("increasing times");
                if frame.index > 3 {
                    spent += start.elapsed().as_secs_f64();
                }
                if std::env::var_os("TRACE").is_some() {
                    println!("{step:?}");
                }
            }
            let errors: Option<Vec<f64>> =
                filter.estimate().map(|estimate| estimate.values().iter().zip(theta).map(|(v, t)| v - t).collect());
            let Some(errors) = errors.filter(|list| list.iter().zip(&bound).all(|(e, b)| e.abs() < 100.0 * b)) else {
                lost += 1;
                continue;
            };
            let estimate = filter.estimate().expect("there is one");
            for (j, parameter) in estimate.parameters().enumerate() {
                squares[j] += (errors[j] / bound[j]).powi(2);
                covered += f64::from(u8::from(
                    parameter.standard_deviation.is_some_and(|std| errors[j].abs() <= 1.959_964 * std),
                ));
            }
        }
        let kept = (runs - lost) as f64;
        let ratios: Vec<String> = squares.iter().map(|s| format!("{:.2}", (s / kept).sqrt())).collect();
        println!(
            "{:<54} {:>8.3} {:>4} {:>8.1}  {}",
            setting.name,
            covered / (kept * theta.len() as f64),
            lost,
            1e6 * spent / (runs as f64 * setting.frames.saturating_sub(4).max(1) as f64),
            ratios.join(" ")
        );
    }
}
