//! What a frame costs, per stage and as a whole, beside what one would write first: a QR factorisation (faer) and a
//! singular value decomposition (nalgebra) of the tall 3L matrix. Compare within one run, as ratios.
use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use faer::linalg::solvers::SolveLstsqCore;
use freeform_motion::{
    Pipeline, PipelineSettings,
    curve_fit::{
        Degree, FitSettings, Fitter, Method, Moments, NormalRegression, Outline, PixelGrid, evaluate_monomials,
        outward_normals,
    },
    decompose::{Correspondence, Decomposition},
    outline_filter::{FilterSettings, MotionFilter, Phase},
    outline_io::{
        DEFAULT_OBJECT, GrayImage, OutlineFrame, OutlineReader, OutlineWriter, TraceSettings, WriterOptions, trace_mask,
    },
    riccati::MotionModel,
    sim_camera::{Mask, PaperExperiment, SequenceLength, Settings, Simulator},
};
use std::{
    hint::black_box,
    time::{Duration, Instant},
};

fn frames(points: usize, count: usize) -> Vec<(f64, Outline)> {
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).expect("a scale");
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
            if degree == Degree::Quartic {
                let (mut regression, mut nx, mut ny) = (NormalRegression::default(), Vec::new(), Vec::new());
                group.bench_function(BenchmarkId::new("normals", format!("{points} points")), |b| {
                    b.iter(|| regression.run(black_box(outline), [&xs, &ys], 0.02, [&mut nx, &mut ny]));
                });
            }
            if points == 400 {
                group.bench_function(BenchmarkId::new("solve", &name), |b| b.iter(|| fitter.solve_last()));
            }
            let tight = FitSettings { method: Method::Bounded { margin: 0.5, ridge_weight: 0.0 }, ..free };
            let mut fitter = Fitter::new(tight).expect("settings");
            group.bench_function(BenchmarkId::new("fit with the boundedness constraint active", &name), |b| {
                b.iter(|| fitter.fit(black_box(outline)));
            });
            let fit = fitter.fit(outline).expect("a fit");
            assert!(fit.diagnostics().constraint_active, "the constraint is to be active");
            if points == 400 {
                let name = BenchmarkId::new("solve with the boundedness constraint active", &name);
                group.bench_function(name, |b| b.iter(|| fitter.solve_last()));
            }
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

/// Frames before the timed ones, so that a filter has settled.
const SETTLED: usize = 60;

/// The time of single steps of an identifier that goes on along `list` from its state `begun`, with the frames from
/// [`SETTLED`] on and back again from time to time, so that the motion goes on without a jump.
fn time_of_steps<F: Clone>(
    begun: &F,
    list: &[(f64, Outline)],
    iterations: u64,
    mut step: impl FnMut(&mut F, f64, &Outline) -> bool,
) -> Duration {
    let mut spent = Duration::ZERO;
    let (mut filter, mut next) = (begun.clone(), SETTLED);
    for _ in 0..iterations {
        if next == list.len() {
            (filter, next) = (begun.clone(), SETTLED);
        }
        let (time, outline) = &list[next];
        next += 1;
        let start = Instant::now();
        let accepted = black_box(step(&mut filter, *time, black_box(outline)));
        spent += start.elapsed();
        assert!(accepted, "a frame was rejected");
    }
    spent
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
        for (time, outline) in &list[..SETTLED] {
            assert!(begun.step(*time, outline).expect("increasing times").is_accepted());
        }
        group.bench_function(BenchmarkId::from_parameter(format!("{model}, {points} points")), |b| {
            // Single frames may be rejected, as the noise is not kept from it.
            let step = |filter: &mut MotionFilter, time, outline: &_| filter.step(time, outline).is_ok();
            b.iter_custom(|iterations| time_of_steps(&begun, &list, iterations, step));
        });
    }
    group.finish();
}

/// The second frame, which is searched for over all turns.
fn acquisition(c: &mut Criterion) {
    let mut group = c.benchmark_group("acquisition");
    for (points, model) in
        [(100, MotionModel::Rigid), (400, MotionModel::Rigid), (1600, MotionModel::Rigid), (400, MotionModel::Affine)]
    {
        group.throughput(Throughput::Elements(points as u64));
        let list = frames(points, 2);
        let mut begun = MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("settings");
        begun.step(list[0].0, &list[0].1).expect("a first frame");
        group.bench_function(BenchmarkId::new("motion filter", format!("{model}, {points} points")), |b| {
            b.iter_batched_ref(
                || begun.clone(),
                |filter| {
                    let step = filter.step(list[1].0, black_box(&list[1].1)).expect("increasing times");
                    assert_eq!((step.phase, step.is_accepted()), (Phase::Tracking, true));
                },
                BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

/// From a grey picture of 640 x 480 pixels, in which the object is about half as high as the picture, to its outline.
fn picture(c: &mut Criterion) {
    let mut group = c.benchmark_group("picture to outline");
    let (_, outline) = frames(400, 1).remove(0);
    let pixels_per_unit = 120.0 / outline.rms_radius();
    let pitch = nalgebra::Vector2::new(1.0, -1.0) / pixels_per_unit;
    let grid = PixelGrid::new([320.0, 240.0], outline.centroid(), pitch);
    let mask = Mask::of_outline(&outline, [640, 480], &grid).expect("a good grid");
    let picture = GrayImage::from_raw(640, 480, mask.grey).expect("all pixels");
    group.throughput(Throughput::Elements(640 * 480));
    group.bench_function("640x480", |b| {
        b.iter(|| trace_mask(black_box(&picture), &TraceSettings::default()).expect("an object"));
    });
    group.finish();
}

/// Rows of an outline file, beside the same fields read by the csv crate alone.
fn csv_rows(c: &mut Criterion) {
    let mut group = c.benchmark_group("CSV");
    let (points, count) = (400, 50);
    let mut writer = OutlineWriter::new(Vec::new(), WriterOptions::default()).expect("memory");
    for (index, (time, outline)) in frames(points, count).into_iter().enumerate() {
        let frame = OutlineFrame { frame: index as u64, time, object: DEFAULT_OBJECT.to_owned(), outline };
        writer.write(&frame).expect("memory");
    }
    let text = writer.finish().expect("memory");
    group.throughput(Throughput::Elements((points * count) as u64));
    group.bench_function("outlines", |b| {
        b.iter(|| {
            let reader = OutlineReader::new(black_box(text.as_slice()), "memory").expect("a header");
            assert_eq!(reader.filter_map(Result::ok).count(), count);
        });
    });
    group.bench_function("csv crate, rows of numbers", |b| {
        b.iter(|| {
            let mut reader = csv::Reader::from_reader(black_box(text.as_slice()));
            let mut record = csv::ByteRecord::new();
            let mut sum = 0.0;
            while reader.read_byte_record(&mut record).expect("rows") {
                let fields = record.iter().filter_map(|field| std::str::from_utf8(field).ok());
                sum += fields.filter_map(|field| field.parse::<f64>().ok()).sum::<f64>();
            }
            sum
        });
    });
    group.finish();
}

criterion_group!(hot_path, baselines, stages, whole_frame, motion_filter_frame, acquisition, picture, csv_rows);
criterion_main!(hot_path);
