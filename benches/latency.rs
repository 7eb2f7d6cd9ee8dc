//! The longest steps of the motion filter, which a control loop waits for: of many recordings whose objects change their motion, are lost
//! and found again, beginning with the first frame of each.
//!
//! ```text
//! cargo bench --bench latency              100,000 steps
//! cargo bench --bench latency -- 10000     fewer
//! ```
//!
//! Every step is made by several copies of the filter, and the least of their times is taken: the longest of many steps would otherwise
//! be that in which another program ran.
use std::time::{Duration, Instant};

use freeform_motion::{
    curve_fit::Outline,
    outline_filter::{FilterSettings, MotionFilter},
    riccati::RigidMotion,
    sim_camera::{BuiltInShape, Camera, Motion, Scene, SequenceLength, Settings, Simulator},
};

const POINTS: usize = 400;
const FRAMES: usize = 400;
const FRAMES_PER_SECOND: f64 = 30.0;
/// Frames from which on the motions go on.
const CHANGES: [u32; 3] = [0, 40, 150];
/// Frames that show another object in place of the one followed, which is lost by that and looked for afterwards.
const LOST: std::ops::Range<usize> = 250..270;
const COPIES: usize = 3;

/// A recording of one shape, whose motion changes twice, with noise of its own.
fn recording(number: usize) -> Vec<(f64, Outline)> {
    let shape = BuiltInShape::ALL[number % BuiltInShape::ALL.len()];
    let other = BuiltInShape::ALL[(number + 3) % BuiltInShape::ALL.len()];
    let rate = |i: usize| 0.4 + 0.3 * ((number + i) % 7) as f64;
    let motions = [
        RigidMotion { omega: rate(0), b1: 0.3, b2: -0.2 },
        RigidMotion { omega: -rate(1), b1: -0.1, b2: 0.4 },
        RigidMotion { omega: rate(2), b1: 0.0, b2: 0.1 },
    ];
    let phases: Vec<_> = CHANGES.iter().map(|frame| f64::from(*frame) / FRAMES_PER_SECOND).zip(motions).collect();
    let outlines = |shape: BuiltInShape| {
        let motion = Motion::piecewise(phases.clone()).expect("motions");
        let scene = Scene::new(shape, motion, Camera::new(0.1).expect("a scale"));
        let settings = Settings {
            points: POINTS,
            length: SequenceLength::Frames(FRAMES),
            fps: FRAMES_PER_SECOND,
            seed: number as u64,
            ..Settings::default()
        };
        let simulator = Simulator::new(scene, settings).expect("settings");
        simulator.frames().map(|frame| (frame.time, frame.outline)).collect::<Vec<_>>()
    };
    let (mut frames, others) = (outlines(shape), outlines(other));
    frames[LOST].clone_from_slice(&others[LOST]);
    frames
}

/// Which steps a frame belongs to.
fn kind(frame: usize) -> usize {
    match frame {
        0 => 0,
        1 => 1,
        2..64 => 2,
        _ => 3,
    }
}

const KINDS: [&str; 4] = ["first frame", "second frame", "frames 3 to 64", "frames from 65 on"];

fn main() {
    // `cargo bench` passes `--bench`; without it, as in `cargo test --benches`, one recording shows that everything runs.
    let is_timed = std::env::args().any(|argument| argument == "--bench");
    let asked = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(100_000_usize);
    let steps = if is_timed { asked.max(1) } else { 1 };
    let mut times: [Vec<(Duration, [usize; 2])>; 4] = Default::default();
    for number in 0..steps.div_ceil(FRAMES) {
        let mut filter = MotionFilter::new(FilterSettings::default()).expect("settings");
        for (frame, (time, outline)) in recording(number).iter().enumerate() {
            let mut least = Duration::MAX;
            for _ in 1..COPIES {
                let mut copy = filter.clone();
                let start = Instant::now();
                copy.step(*time, outline).expect("increasing times");
                least = least.min(start.elapsed());
            }
            let start = Instant::now();
            filter.step(*time, outline).expect("increasing times");
            least = least.min(start.elapsed());
            times[kind(frame)].push((least, [number, frame]));
        }
    }
    if !is_timed {
        return;
    }
    let steps: usize = times.iter().map(Vec::len).sum();
    println!("{POINTS} points, {steps} steps; times in microseconds");
    println!(
        "{:20} {:>8} {:>8} {:>8} {:>10} {:>10} {:>10}  longest: recording, frame",
        "", "steps", "> 0.2 ms", "> 1 ms", "median", "99.9 %", "longest"
    );
    let all = times.concat();
    for (name, mut times) in KINDS.into_iter().zip(times).chain([("all", all)]) {
        times.sort_unstable();
        let at = |share: f64| 1e6 * times[(share * (times.len() - 1) as f64).round() as usize].0.as_secs_f64();
        let longest: Vec<_> = times.iter().rev().take(3).map(|(_, at)| *at).collect();
        let over = |limit| times.iter().filter(|(time, _)| *time > limit).count();
        let [long, too_long] = [200, 1000].map(|limit| over(Duration::from_micros(limit)));
        let (count, median, most, end) = (times.len(), at(0.5), at(0.999), at(1.0));
        println!("{name:20} {count:8} {long:8} {too_long:8} {median:10.1} {most:10.1} {end:10.1}  {longest:?}");
    }
}
