//! Monte Carlo of the motion filter: root mean square error over the Cramer-Rao bound, coverage of the 95 % intervals, lost
//! runs, and time per frame, for built-in shapes and, where they are present, traced silhouettes.
//!
//! `cargo run --release --example accuracy [RUNS [SETTING [built-in|all]]]`: only settings whose name contains SETTING.
use std::{path::Path, time::Instant};

use freeform_identify::{BoundaryPoint, CramerRaoBound, FilterSettings, MotionFilter};
use freeform_riccati::{AffineMotion, MotionModel, RigidMotion};
use freeform_sim_camera::{
    BuiltInShape, Camera, Occlusion, Sampling, Scene, SequenceLength, Settings, Shape, Simulator,
};
use nalgebra::Vector2;

/// One row of the table.
struct Setting {
    name: &'static str,
    model: MotionModel,
    frames: usize,
    occlusion: f64,
    outliers: f64,
    wrong: f64,
    sampling: Sampling,
    noise: f64,
    points: usize,
    fps: f64,
}

struct Outcome {
    squared_ratios: Vec<f64>,
    covered: Vec<bool>,
    lost: bool,
    seconds_per_frame: f64,
}

fn motion(model: MotionModel) -> (AffineMotion, Vec<f64>) {
    match model {
        MotionModel::Affine => {
            let theta = [0.05, 1.2, -1.7, -0.08, -0.3, 0.4];
            let [a1, a2, a3, a4, b1, b2] = theta;
            (AffineMotion { a1, a2, a3, a4, b1, b2 }, theta.to_vec())
        }
        _ => {
            let rigid = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -0.3, b2: 0.4 };
            (rigid.into(), vec![rigid.omega, rigid.b1, rigid.b2])
        }
    }
}

/// Smallest standard deviations, from points spread evenly over the boundary, each standing for its share of those that really
/// inform: visible, no outliers, no wrong frames.
fn bound(shape: &Shape, setting: &Setting) -> Vec<f64> {
    let (truth, theta) = motion(setting.model);
    let mut bound = CramerRaoBound::new(setting.model, &theta).expect("a motion");
    let dense = 2000_usize;
    let share = (1.0 - setting.occlusion) * (1.0 - setting.outliers) * (1.0 - setting.wrong);
    for frame in 0..setting.frames {
        let time = frame as f64 / setting.fps;
        let pose = truth.flow(time);
        let linear = pose.matrix().fixed_view::<2, 2>(0, 0).into_owned();
        let cofactor = linear.try_inverse().expect("a regular flow").transpose();
        let points = (0..dense).map(|i| {
            let s = i as f64 / dense as f64;
            let normal: Vector2<f64> = (cofactor * shape.normal_at(s).into_inner()).normalize();
            BoundaryPoint { point: pose * shape.point_at(s), normal }
        });
        bound.add_frame(time, points, setting.noise, share * setting.points as f64 / dense as f64).expect("finite");
    }
    let covariance = bound.covariance().expect("finite");
    covariance.standard_deviations().map(|std| std.expect("observable")).collect()
}

fn run(shape: &Shape, setting: &Setting, bound: &[f64], seed: u64) -> Outcome {
    let (truth, theta) = motion(setting.model);
    let scene = Scene::new(shape.clone(), truth, Camera::default());
    let settings = Settings {
        fps: setting.fps,
        length: SequenceLength::Frames(setting.frames),
        points: setting.points,
        sampling: setting.sampling,
        noise: setting.noise,
        occlusion: Occlusion { fraction: setting.occlusion, ..Occlusion::default() },
        outliers: setting.outliers,
        wrong_frames: setting.wrong,
        seed,
        ..Settings::default()
    };
    let simulator = Simulator::new(scene, settings).expect("good settings");
    let frames: Vec<_> = simulator.frames().collect();
    let mut filter =
        MotionFilter::new(FilterSettings { model: setting.model, ..FilterSettings::default() }).expect("ok");
    let (mut spent, mut timed) = (0.0, 0);
    for frame in &frames {
        let start = Instant::now();
        let step = filter.step(frame.time, &frame.outline).expect("increasing times");
        if std::env::var_os("TRACE").is_some() {
            println!("{} {:?} wrong {:?}", frame.index, step, frame.corruption.wrong_shape);
        }
        if frame.index >= 4 {
            spent += start.elapsed().as_secs_f64();
            timed += 1;
        }
    }
    let seconds_per_frame = spent / f64::from(timed.max(1));
    let Some(estimate) = filter.estimate() else {
        return Outcome { squared_ratios: Vec::new(), covered: Vec::new(), lost: true, seconds_per_frame };
    };
    let mut outcome = Outcome { squared_ratios: Vec::new(), covered: Vec::new(), lost: false, seconds_per_frame };
    for (i, parameter) in estimate.parameters().enumerate() {
        let error = estimate.values()[i] - theta[i];
        let ratio = error / bound[i];
        outcome.lost |= ratio.is_nan() || ratio.abs() > 30.0;
        outcome.squared_ratios.push(ratio * ratio);
        outcome.covered.push(parameter.standard_deviation.is_some_and(|std| error.abs() <= 1.959_964 * std));
    }
    outcome
}

fn shapes(all: bool) -> Vec<Shape> {
    use BuiltInShape::{Bird, Glider, Hat, Phone, Shoe, Van};
    let mut shapes: Vec<Shape> = [Bird, Glider, Phone, Van, Shoe, Hat].into_iter().map(Shape::from).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/silhouettes");
    for name in ["bat", "fish", "crescent_leaf", "car", "vase"].iter().filter(|_| all) {
        let Ok(outline) = freeform_outline_io::read_shape(folder.join(format!("{name}.png"))) else { continue };
        let points: Vec<_> = outline.points().copied().collect();
        if let Ok(shape) = Shape::from_polygon(&points) {
            shapes.push(shape.normalised().with_name(format!("{name}.png")));
        }
    }
    shapes
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let runs: u64 = arguments.get(1).and_then(|a| a.parse().ok()).unwrap_or(10);
    let wanted = arguments.get(2).cloned().unwrap_or_default();
    let shapes = shapes(arguments.get(3).is_some_and(|a| a == "all"));
    let plain = |name, frames| Setting {
        name,
        model: MotionModel::Rigid,
        frames,
        occlusion: 0.0,
        outliers: 0.0,
        wrong: 0.0,
        sampling: Sampling::Independent,
        noise: 0.005,
        points: 400,
        fps: 30.0,
    };
    let settings = [
        plain("clean 3", 3),
        plain("clean 8", 8),
        plain("clean 30", 30),
        plain("clean 120", 120),
        Setting { sampling: Sampling::default(), ..plain("stratified 120", 120) },
        Setting { occlusion: 0.2, ..plain("arc 30", 30) },
        Setting { occlusion: 0.2, ..plain("arc 120", 120) },
        Setting { outliers: 0.05, ..plain("outliers 30", 30) },
        Setting { outliers: 0.05, ..plain("outliers 120", 120) },
        Setting { occlusion: 0.2, outliers: 0.05, wrong: 0.05, ..plain("both 120", 120) },
        Setting { model: MotionModel::Affine, ..plain("affine 60", 60) },
        Setting { model: MotionModel::Affine, ..plain("affine 120", 120) },
        Setting { model: MotionModel::Affine, occlusion: 0.2, ..plain("affine arc 120", 120) },
        Setting { noise: 0.0005, ..plain("noise 0.0005", 60) },
        Setting { noise: 0.02, ..plain("noise 0.02", 60) },
        Setting { noise: 0.05, ..plain("noise 0.05", 60) },
        Setting { points: 40, ..plain("points 40", 60) },
        Setting { points: 100, ..plain("points 100", 60) },
        Setting { points: 4000, ..plain("points 4000", 60) },
        Setting { fps: 2.0, ..plain("fps 2", 30) },
        Setting { fps: 200.0, ..plain("fps 200", 120) },
    ];
    println!(
        "{:<16} {:>7} {:>7} {:>9} {:>6} {:>9}  by shape",
        "setting", "pooled", "worst", "coverage", "lost", "us/frame"
    );
    for setting in settings.iter().filter(|s| s.name.contains(&wanted)) {
        let (mut sum, mut count, mut covered, mut lost, mut worst, mut spent) = (0.0, 0.0, 0.0, 0, 0.0_f64, 0.0);
        let mut by_shape = String::new();
        for shape in &shapes {
            let bound = bound(shape, setting);
            let (mut shape_sum, mut shape_count) = (0.0, 0.0);
            for seed in 0..runs {
                let outcome = run(shape, setting, &bound, seed);
                spent += outcome.seconds_per_frame;
                if outcome.lost {
                    lost += 1;
                    if std::env::var_os("LOST").is_some() {
                        println!("lost: {} seed {seed} {:?}", shape.name(), outcome.squared_ratios);
                    }
                    continue;
                }
                shape_count += outcome.squared_ratios.len() as f64;
                shape_sum += outcome.squared_ratios.iter().sum::<f64>();
                covered += outcome.covered.iter().filter(|c| **c).count() as f64;
            }
            let ratio = (shape_sum / f64::max(shape_count, 1.0)).sqrt();
            worst = worst.max(ratio);
            by_shape += &format!(" {}:{ratio:.2}", shape.name());
            sum += shape_sum;
            count += shape_count;
        }
        println!(
            "{:<16} {:>7.3} {:>7.2} {:>9.3} {:>6} {:>9.1} {by_shape}",
            setting.name,
            (sum / count).sqrt(),
            worst,
            covered / count,
            lost,
            1e6 * spent / (runs as f64 * shapes.len() as f64),
        );
    }
    if "acquisition".contains(&wanted) {
        acquisition(&shapes, 10 * runs);
    }
}

/// Share of runs in which the second frame is found, the turn between being within 60 degrees and the shift within half the
/// object's size: the turn to a tenth of a radian. Without and with a fifth of the outline missing.
fn acquisition(shapes: &[Shape], runs: u64) {
    for (name, occlusion) in [("acquisition", 0.0), ("acquisition arc", 0.2)] {
        let (mut found, mut by_shape) = (0.0, String::new());
        for shape in shapes {
            let mut here = 0.0;
            for seed in 0..runs {
                // A golden-ratio sequence spreads turns and directions evenly.
                let fraction = |step: f64| 2.0 * (step * (seed as f64 + 0.5)).fract() - 1.0;
                let turn = fraction(0.618_034) * std::f64::consts::FRAC_PI_3;
                let (shift, direction) = (0.5 * fraction(0.754_878).abs(), std::f64::consts::PI * fraction(0.569_84));
                let motion = RigidMotion { omega: turn, b1: shift * direction.cos(), b2: shift * direction.sin() };
                let settings = Settings {
                    fps: 1.0,
                    length: SequenceLength::Frames(2),
                    occlusion: Occlusion { fraction: occlusion, ..Occlusion::default() },
                    seed,
                    ..Settings::default()
                };
                let simulator =
                    Simulator::new(Scene::new(shape.clone(), motion, Camera::default()), settings).expect("ok");
                let mut filter = MotionFilter::new(FilterSettings::default()).expect("ok");
                for frame in simulator.frames() {
                    filter.step(frame.time, &frame.outline).expect("increasing times");
                }
                let hit = filter.estimate().is_some_and(|estimate| (estimate.values()[0] - turn).abs() < 0.1);
                here += f64::from(u8::from(hit));
            }
            found += here;
            by_shape += &format!(" {}:{:.3}", shape.name(), here / runs as f64);
        }
        println!("{name:<16} found {:.4} {by_shape}", found / (runs as f64 * shapes.len() as f64));
    }
}
