//! What a frame costs, per stage and as a whole, beside what one would write first: a QR factorisation (faer) and a
//! singular value decomposition (nalgebra) of the tall 3L matrix. Compare within one run, as ratios.
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use faer::linalg::solvers::SolveLstsqCore;
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{Degree, FitSettings, Fitter, Method, Moments, Outline, evaluate_monomials, outward_normals},
    decompose::{Correspondence, Decomposition},
    identify::{CurveFilterSettings, FilterSettings, MotionFilter, WholeCurveFilter},
    riccati::{MotionModel, RigidMotion},
    sim_camera::{BuiltInShape, Camera, Motion, Scene, SequenceLength, Settings, Simulator},
};
use std::{
    hint::black_box,
    time::{Duration, Instant},
};

fn frames(points: usize, count: usize) -> Vec<(f64, Outline)> {
    let motion = RigidMotion { omega: std::f64::consts::FRAC_PI_2, b1: -3.0, b2: 4.0 };
    let camera = Camera::new(0.1).expect("a scale");
    let scene = Scene::new(BuiltInShape::Bird.shape(), Motion::constant(motion), camera);
    let settings = Settings { points, length: SequenceLength::Frames(count), ..Settings::default() };
    let simulator = Simulator::new(scene, settings).expect("settings");
    simulator.frames().map(|frame| (frame.time, frame.outline)).collect()
}

/// The rows of the 3L problem, by columns, and its right-hand side.
fn tall_matrix(outline: &Outline, degree: Degree) -> (faer::Mat<f64>, faer::Mat<f64>) {
    let (centre, radius) = (outline.centroid(), outline.rms_radius());
    let normals = outward_normals(outline, 0.02);
    let size = degree.coefficient_count();
    let count = outline.point_count();
    let mut matrix = faer::Mat::zeros(3 * count, size);
    let mut right = faer::Mat::zeros(3 * count, 1);
    let mut row = vec![0.0; size];
    for (i, (p, n)) in outline.points().zip(&normals).enumerate() {
        for (l, level) in [-1.0, 0.0, 1.0].into_iter().enumerate() {
            let q = (p - centre) / radius + 0.1 * level * n;
            evaluate_monomials(degree.value(), q.x, q.y, &mut row);
            for (j, value) in row.iter().enumerate() {
                matrix[(l * count + i, j)] = *value;
            }
            right[(l * count + i, 0)] = level;
        }
    }
    (matrix, right)
}

fn baselines(c: &mut Criterion) {
    let mut group = c.benchmark_group("tall 3L matrix");
    let (_, outline) = frames(400, 1).remove(0);
    for degree in [Degree::Quartic, Degree::Sextic] {
        let (matrix, right) = tall_matrix(&outline, degree);
        let name = format!("1200x{}", degree.coefficient_count());
        group.bench_function(BenchmarkId::new("faer QR least squares", &name), |b| {
            b.iter_batched(
                || right.clone(),
                |mut solution| {
                    matrix.qr().solve_lstsq_in_place_with_conj(faer::Conj::No, solution.as_mut());
                    solution
                },
                BatchSize::SmallInput,
            );
        });
        let dense = nalgebra::DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)]);
        group.bench_function(BenchmarkId::new("nalgebra SVD", &name), |b| {
            b.iter(|| black_box(&dense).clone().svd(true, true));
        });
    }
    group.finish();
}

fn stages(c: &mut Criterion) {
    let mut group = c.benchmark_group("stage");
    for points in [100, 400, 1600] {
        group.throughput(Throughput::Elements(points as u64));
        let list = frames(points, 2);
        let outline = &list[0].1;
        let (xs, ys): (Vec<f64>, Vec<f64>) = outline.points().map(|p| (p.x, p.y)).unzip();
        for degree in [Degree::Quartic, Degree::Sextic] {
            let name = format!("degree {degree}, {points} points");
            group.bench_function(BenchmarkId::new("moments of one level set", &name), |b| {
                b.iter(|| Moments::of(2 * degree.value(), black_box(&xs), black_box(&ys)));
            });
            let free = FitSettings { degree, method: Method::ThreeLevel, ..FitSettings::default() };
            let mut fitter = Fitter::new(free).expect("settings");
            group.bench_function(BenchmarkId::new("3L fit", &name), |b| b.iter(|| fitter.fit(black_box(outline))));
            let tight = FitSettings { method: Method::Bounded { margin: 0.5, ridge_weight: 0.0 }, ..free };
            let mut fitter = Fitter::new(tight).expect("settings");
            group.bench_function(BenchmarkId::new("fit with the boundedness constraint active", &name), |b| {
                b.iter(|| fitter.fit(black_box(outline)));
            });
        }
    }
    let list = frames(400, 2);
    for degree in [Degree::Quartic, Degree::Sextic] {
        let settings = FitSettings {
            degree,
            method: Method::Bounded { margin: 0.5, ridge_weight: 0.0 },
            ..FitSettings::default()
        };
        let mut fitter = Fitter::new(settings).expect("settings");
        let fits = [0, 1].map(|i: usize| fitter.fit(&list[i].1).expect("a fit"));
        let name = format!("degree {degree}");
        group.bench_function(BenchmarkId::new("decomposition", &name), |b| {
            b.iter(|| Decomposition::of(black_box(fits[0].working())));
        });
        let lines = fits.map(|fit| Decomposition::of(fit.working()).expect("lines"));
        group.bench_function(BenchmarkId::new("matching", &name), |b| {
            b.iter(|| Correspondence::between(black_box(&lines[0]), black_box(&lines[1]), 1.0));
        });
    }
    group.finish();
}

fn whole_frame(c: &mut Criterion) {
    let mut group = c.benchmark_group("whole adaptive frame");
    for points in [100, 400, 1600] {
        group.throughput(Throughput::Elements(points as u64));
        let list = frames(points, 64);
        let mut pipeline = Pipeline::new(PipelineSettings::default()).expect("settings");
        let (mut next, mut time) = (0, 0.0);
        group.bench_function(BenchmarkId::from_parameter(format!("{points} points")), |b| {
            b.iter(|| {
                next = (next + 1) % list.len();
                // Time goes on; from the last frame back to the first the lines jump and the law starts anew.
                time += 1.0 / 30.0;
                pipeline.push(time, black_box(&list[next].1))
            });
        });
    }
    group.finish();
}

/// Beside the QR of the 3L matrix of its degree.
fn whole_curve_frame(c: &mut Criterion) {
    let mut group = c.benchmark_group("whole-curve filter");
    let list = frames(400, 240);
    for degree in [Degree::Quartic, Degree::Sextic] {
        let settings = CurveFilterSettings { degree, ..CurveFilterSettings::default() };
        let mut begun = WholeCurveFilter::new(settings).expect("settings");
        for (time, outline) in &list[..60] {
            assert!(begun.step(*time, outline).expect("increasing times").accepted);
        }
        group.bench_function(BenchmarkId::from_parameter(format!("degree {degree}, 400 points")), |b| {
            b.iter_custom(|iterations| {
                let mut spent = Duration::ZERO;
                let (mut filter, mut next) = (begun.clone(), 60);
                for _ in 0..iterations {
                    // Back to the 60th frame from time to time, so that the motion goes on without a jump.
                    if next == list.len() {
                        (filter, next) = (begun.clone(), 60);
                    }
                    let (time, outline) = &list[next];
                    next += 1;
                    let start = Instant::now();
                    let step = black_box(filter.step(*time, black_box(outline)));
                    spent += start.elapsed();
                    assert!(step.is_ok_and(|step| step.accepted));
                }
                spent
            });
        });
    }
    group.finish();
}

fn motion_filter_frame(c: &mut Criterion) {
    let mut group = c.benchmark_group("motion filter");
    for (points, model) in
        [(100, MotionModel::Rigid), (400, MotionModel::Rigid), (1600, MotionModel::Rigid), (400, MotionModel::Affine)]
    {
        group.throughput(Throughput::Elements(points as u64));
        let list = frames(points, 240);
        let settings = FilterSettings { model, ..FilterSettings::default() };
        let mut begun = MotionFilter::new(settings).expect("settings");
        for (time, outline) in &list[..60] {
            assert!(begun.step(*time, outline).expect("increasing times").accepted);
        }
        group.bench_function(BenchmarkId::from_parameter(format!("{model}, {points} points")), |b| {
            b.iter_custom(|iterations| {
                let mut spent = Duration::ZERO;
                let (mut filter, mut next) = (begun.clone(), 60);
                for _ in 0..iterations {
                    if next == list.len() {
                        (filter, next) = (begun.clone(), 60);
                    }
                    let (time, outline) = &list[next];
                    next += 1;
                    let start = Instant::now();
                    let step = black_box(filter.step(*time, black_box(outline)));
                    spent += start.elapsed();
                    assert!(step.is_ok());
                }
                spent
            });
        });
    }
    group.finish();
}

criterion_group!(hot_path, baselines, stages, whole_frame, whole_curve_frame, motion_filter_frame);
criterion_main!(hot_path);
