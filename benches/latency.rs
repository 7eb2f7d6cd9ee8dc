//! The longest steps of the motion filter, which a control loop waits for: of many recordings whose objects change their motion, are lost
//! and found again, beginning with the first frame of each. They are made without and with calls of `prepare` between frames, which are timed by
//! themselves.
//!
//! ```text
//! cargo bench --bench latency              100,000 steps
//! cargo bench --bench latency -- 10000     fewer
//! ```
//!
//! Every step is made by several copies of the filter, and the least of their times is taken: the longest of many steps would otherwise
//! be that in which another program ran.
mod recordings;

use std::time::{Duration, Instant};

use freeform_motion::outline_filter::{FilterSettings, MotionFilter};

use recordings::{FRAMES, POINTS, recording};

const COPIES: usize = 3;

/// Times of steps of each kind, with the recording and the frame.
type Times = [Vec<(Duration, [usize; 2])>; 4];

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

/// What some work with a filter gives, and the least time that it takes of several copies.
fn timed<T>(filter: &mut MotionFilter, work: impl Fn(&mut MotionFilter) -> T) -> (T, Duration) {
    let time_of = |filter: &mut MotionFilter| {
        let start = Instant::now();
        (work(filter), start.elapsed())
    };
    let of_copies = (1..COPIES).map(|_| time_of(&mut filter.clone()).1).min();
    let (result, time) = time_of(filter);
    (result, of_copies.map_or(time, |least| least.min(time)))
}

fn main() {
    // `cargo bench` passes `--bench`; without it, as in `cargo test --benches`, one recording shows that everything runs.
    let is_timed = std::env::args().any(|argument| argument == "--bench");
    let asked = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(100_000_usize);
    let steps = if is_timed { asked.max(1) } else { 1 };
    let (mut alone, mut with_calls) = (Times::default(), Times::default());
    let mut calls = Vec::new();
    for number in 0..steps.div_ceil(FRAMES) {
        let mut filters = [0, 1].map(|_| MotionFilter::new(FilterSettings::default()).expect("settings"));
        for (frame, (time, outline)) in recording(number).iter().enumerate() {
            for (filter, times) in filters.iter_mut().zip([&mut alone, &mut with_calls]) {
                let (step, least) = timed(filter, |filter| filter.step(*time, outline));
                step.expect("increasing times");
                times[kind(frame)].push((least, [number, frame]));
            }
            loop {
                let (is_more_waiting, least) = timed(&mut filters[1], MotionFilter::prepare);
                calls.push((least, [number, frame]));
                if !is_more_waiting {
                    break;
                }
            }
        }
    }
    if !is_timed {
        return;
    }
    let steps: usize = alone.iter().map(Vec::len).sum();
    println!("{POINTS} points, {steps} steps; times in microseconds");
    print_table("steps alone", alone);
    print_table("steps with calls between", with_calls);
    print_row("calls between frames", calls);
}

fn print_table(title: &str, times: Times) {
    println!(
        "\n{title:24} {:>8} {:>8} {:>8} {:>10} {:>10} {:>10}  longest: recording, frame",
        "number", "> 0.2 ms", "> 1 ms", "median", "99.9 %", "longest"
    );
    let all = times.concat();
    for (name, times) in KINDS.into_iter().zip(times).chain([("all", all)]) {
        print_row(name, times);
    }
}

fn print_row(name: &str, mut times: Vec<(Duration, [usize; 2])>) {
    times.sort_unstable();
    let at = |share: f64| 1e6 * times[(share * (times.len() - 1) as f64).round() as usize].0.as_secs_f64();
    let longest: Vec<_> = times.iter().rev().take(3).map(|(_, at)| *at).collect();
    let over = |limit| times.iter().filter(|(time, _)| *time > limit).count();
    let [long, too_long] = [200, 1000].map(|limit| over(Duration::from_micros(limit)));
    let (count, median, most, end) = (times.len(), at(0.5), at(0.999), at(1.0));
    println!("{name:24} {count:8} {long:8} {too_long:8} {median:10.1} {most:10.1} {end:10.1}  {longest:?}");
}
