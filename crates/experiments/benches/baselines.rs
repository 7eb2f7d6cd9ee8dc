//! What a frame of 400 points costs by the motion filter, and by what one would take in its place: area moments, and iterated closest points
//! (point to line) to the first frame. Compare within one run, as ratios.
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use freeform_curve_fit::Outline;
use freeform_experiments::baseline::{AreaMomentEstimator, RegistrationEstimator};
use freeform_outline_filter::{FilterSettings, MotionFilter};
use freeform_riccati::MotionModel;
use freeform_sim_camera::{PaperExperiment, SequenceLength, Settings, Simulator};

/// Frames before the timed ones, so that a filter has settled.
const SETTLED: usize = 60;

fn frames() -> Vec<(f64, Outline)> {
    let scene = PaperExperiment::FLIGHT_BIRD.scene(PaperExperiment::SCALE).expect("a scale");
    let settings = Settings { points: 400, length: SequenceLength::Frames(240), ..Settings::default() };
    let simulator = Simulator::new(scene, settings).expect("settings");
    simulator.frames().map(|frame| (frame.time, frame.outline)).collect()
}

/// The time of single steps of an estimator that goes on along the frames, and begins anew at their end.
fn time_of_steps<E>(
    list: &[(f64, Outline)],
    iterations: u64,
    begin: impl Fn() -> E,
    mut step: impl FnMut(&mut E, f64, &Outline),
) -> Duration {
    let mut spent = Duration::ZERO;
    let mut estimator = begin();
    let mut left = list.iter();
    for _ in 0..iterations {
        if left.len() == 0 {
            (estimator, left) = (begin(), list.iter());
        }
        if left.len() == list.len() {
            left.by_ref().take(SETTLED).for_each(|(time, outline)| step(&mut estimator, *time, outline));
        }
        let (time, outline) = left.next().expect("more frames than settle it");
        let start = Instant::now();
        step(&mut estimator, *time, black_box(outline));
        spent += start.elapsed();
    }
    spent
}

fn baselines(c: &mut Criterion) {
    let (list, model) = (frames(), MotionModel::Rigid);
    let mut group = c.benchmark_group("rigid, 400 points");
    group.bench_function("motion filter", |b| {
        let begin = || MotionFilter::new(FilterSettings { model, ..FilterSettings::default() }).expect("settings");
        b.iter_custom(|iterations| {
            time_of_steps(&list, iterations, begin, |filter: &mut MotionFilter, time, outline| {
                assert!(filter.step(time, outline).is_ok());
            })
        });
    });
    group.bench_function("area moments", |b| {
        let begin = || AreaMomentEstimator::new(model).expect("a model that moments have");
        b.iter_custom(|iterations| {
            time_of_steps(&list, iterations, begin, |moments: &mut AreaMomentEstimator, time, outline| {
                assert!(moments.step(time, outline).is_ok());
            })
        });
    });
    group.sample_size(10);
    group.bench_function("iterated closest points", |b| {
        b.iter_custom(|iterations| {
            let begin = || RegistrationEstimator::new(model);
            time_of_steps(&list, iterations, begin, |registration: &mut RegistrationEstimator, time, outline| {
                assert!(registration.step(time, outline).is_ok());
            })
        });
    });
    group.finish();
}

criterion_group!(benches, baselines);
criterion_main!(benches);
