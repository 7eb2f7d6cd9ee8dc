//! Every law against an integration of its equations that shares nothing with it: complex Riccati equations, all of it by the method of Runge
//! and Kutta, in steps far smaller than a frame. The lines follow a motion that changes, so that no law may simply be at the truth.
use freeform_decompose::{Line, MAX_PAIRS};
use freeform_riccati::MotionModel;
use nalgebra::{Complex, DVector, Matrix3, Matrix4, SMatrix, Vector3, Vector4};

use super::{
    running_law::{Frame, Last, RunningLaw},
    settings::{AdaptiveLaw, AdaptiveSettings, PairChoice},
    solve_lyapunov,
};

const PAIRS: usize = 2;
const WEIGHTS: [f64; PAIRS] = [1.0, 0.4];
const START: [[f64; 4]; PAIRS] = [[0.3, 0.8, 0.1, -0.2], [-0.4, 1.3, -0.2, 0.3]];
const INITIAL: [f64; 3] = [0.3, 0.1, -0.2];
/// As stated of filtered least squares and regressor mixing, per second.
const FILTER_RATE: f64 = 4.0;
const FORGETTING_RATE: f64 = 0.05;
const MIXING_GAIN: f64 = 2.0;
const SECONDS: f64 = 3.0;

/// Angular velocity and velocity at a time.
fn motion(time: f64) -> [f64; 3] {
    [1.2 + 0.4 * (1.7 * time).sin(), -0.3, 0.4 + 0.1 * time]
}

type Regressor = SMatrix<f64, 4, 3>;

/// What omega, b1 and b2 add to `l' = -a2 + a3 l^2` and `k' = a3 l k - b1 - b2 l`, with `a2 = -a3 = omega`.
fn regressor(x: &Vector4<f64>) -> Regressor {
    let (l, k) = (Complex::new(x[0], x[1]), Complex::new(x[2], x[3]));
    let columns = [(-1.0 - l * l, -l * k), (Complex::ZERO, -Complex::ONE), (Complex::ZERO, -l)];
    Regressor::from_columns(&columns.map(|(l, k)| Vector4::new(l.re, l.im, k.re, k.im)))
}

/// What the state of an integration begins with: the lines.
fn line(y: &DVector<f64>, pair: usize) -> Vector4<f64> {
    y.fixed_rows::<4>(4 * pair).into_owned()
}

/// Gains: Am and P.
struct Gains {
    stability: Matrix4<f64>,
    lyapunov: Matrix4<f64>,
}

impl Gains {
    /// Of the paper.
    fn new() -> Self {
        let stability = Matrix4::from_diagonal(&Vector4::new(-0.5, -0.5, -1.0, -1.0));
        let lyapunov = solve_lyapunov(&stability, &Matrix4::identity()).expect("stable");
        Self { stability, lyapunov }
    }

    /// `Xh' = Am e + W theta`, `theta' = - sum w W' P e`, with Xh of every pair, then theta.
    fn structured(&self, y: &DVector<f64>) -> Vec<f64> {
        let theta: Vector3<f64> = y.fixed_rows::<3>(8 * PAIRS).into_owned();
        let (mut rate, mut pull) = (Vec::new(), Vector3::zeros());
        for (pair, weight) in WEIGHTS.into_iter().enumerate() {
            let x = line(y, pair);
            let (e, w) = (y.fixed_rows::<4>(4 * (PAIRS + pair)) - x, regressor(&x));
            rate.extend((self.stability * e + w * theta).iter());
            pull -= weight * w.transpose() * self.lyapunov * e;
        }
        rate.extend(pull.iter());
        rate
    }

    /// `Xh' = Am e + M s`, `M' = -P e s'`, s = (X, Re and Im of l^2 and l k, -1), over the first pair: Xh, then M column by column.
    fn printed(&self, y: &DVector<f64>) -> Vec<f64> {
        let x = line(y, 0);
        let (l, k) = (Complex::new(x[0], x[1]), Complex::new(x[2], x[3]));
        let signals = [x[0], x[1], x[2], x[3], (l * l).re, (l * l).im, (l * k).re, (l * k).im, -1.0];
        let e = y.fixed_rows::<4>(4 * PAIRS) - x;
        let mut rate = self.stability * e;
        let mut change = Vec::new();
        for (j, signal) in signals.into_iter().enumerate() {
            rate += signal * y.fixed_rows::<4>(4 * (PAIRS + 1 + j));
            change.extend((-signal * self.lyapunov * e).iter());
        }
        rate.iter().copied().chain(change).collect()
    }
}

/// Filters over every pair (X, W, and what is left of the first X), sums, and theta of mixing.
fn filtered(y: &DVector<f64>) -> Vec<f64> {
    let (mut rate, mut sums, mut right) = (Vec::new(), Matrix3::zeros(), Vector3::zeros());
    for (pair, weight) in WEIGHTS.into_iter().enumerate() {
        let x = line(y, pair);
        let own = y.rows(4 * PAIRS + 20 * pair, 20);
        let (state, first) = (own.fixed_rows::<4>(0), own.fixed_rows::<4>(16));
        let w = Regressor::from_column_slice(&own.as_slice()[4..16]);
        rate.extend((x - FILTER_RATE * state).iter());
        rate.extend((regressor(&x) - FILTER_RATE * w).iter());
        rate.extend((-FILTER_RATE * first).iter());
        let swung_out = 0.5 * (x[0].powi(2) + (x[1].abs() + 1.0).powi(2));
        let precision = weight / swung_out.powi(2);
        sums += precision * w.transpose() * w;
        right += precision * w.transpose() * (x - FILTER_RATE * state - first);
    }
    let own = y.rows(24 * PAIRS, 15);
    let own_sums = Matrix3::from_column_slice(&own.as_slice()[..9]);
    let own_right = Vector3::from_column_slice(&own.as_slice()[9..12]);
    let theta = Vector3::from_column_slice(&own.as_slice()[12..]);
    rate.extend((sums - FORGETTING_RATE * own_sums).iter());
    rate.extend((right - FORGETTING_RATE * own_right).iter());
    let evenness = own_sums.determinant() / (own_sums.trace() / 3.0).powi(3);
    let towards = own_sums.try_inverse().map(|inverse| inverse * own_right);
    let mixed = towards.filter(|_| evenness > 0.0).map(|towards| MIXING_GAIN * evenness * (towards - theta));
    rate.extend(mixed.unwrap_or_else(Vector3::zeros).iter());
    rate
}

/// Lines and law, `begun` being the law's own state.
fn integrated(begun: Vec<f64>, law: impl Fn(&DVector<f64>) -> Vec<f64>) -> DVector<f64> {
    let rate = |time: f64, y: &DVector<f64>| {
        let lines = (0..PAIRS).flat_map(|pair| {
            let rate = regressor(&line(y, pair)) * Vector3::from(motion(time));
            [rate[0], rate[1], rate[2], rate[3]]
        });
        DVector::from_iterator(y.len(), lines.chain(law(y)))
    };
    let mut y = DVector::from_iterator(4 * PAIRS + begun.len(), START.into_iter().flatten().chain(begun));
    let steps = 6000;
    let h = SECONDS / f64::from(steps);
    for i in 0..steps {
        let t = f64::from(i) * h;
        let k1 = rate(t, &y);
        let k2 = rate(t + 0.5 * h, &(&y + 0.5 * h * &k1));
        let k3 = rate(t + 0.5 * h, &(&y + 0.5 * h * &k2));
        let k4 = rate(t + h, &(&y + h * &k3));
        y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    y
}

/// The lines at evenly spaced times, by the same method.
fn lines(frames: usize) -> Vec<[Line; PAIRS]> {
    let (within, mut y) = (6000 / frames, START.map(Vector4::from));
    let h = SECONDS / 6000.0;
    let as_lines =
        |y: &[Vector4<f64>; PAIRS]| y.map(|x| Line { l: Complex::new(x[0], x[1]), k: Complex::new(x[2], x[3]) });
    let mut all = vec![as_lines(&y)];
    for i in 0..frames * within {
        let t = i as f64 * h;
        for x in &mut y {
            let rate = |t: f64, x: &Vector4<f64>| regressor(x) * Vector3::from(motion(t));
            let k1 = rate(t, x);
            let k2 = rate(t + 0.5 * h, &(*x + 0.5 * h * k1));
            let k3 = rate(t + 0.5 * h, &(*x + 0.5 * h * k2));
            let k4 = rate(t + h, &(*x + h * k3));
            *x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        }
        if (i + 1) % within == 0 {
            all.push(as_lines(&y));
        }
    }
    all
}

/// A law after all frames.
fn run(law: AdaptiveLaw, pairs: PairChoice, frames: usize) -> RunningLaw<3> {
    let gains = Gains::new();
    let settings = AdaptiveSettings {
        law,
        pairs,
        model: MotionModel::Rigid,
        stability: gains.stability,
        initial_values: INITIAL.to_vec(),
        ..AdaptiveSettings::default()
    };
    let mut running = RunningLaw::<3>::candidates(&settings, gains.lyapunov).remove(0);
    let mut weights = [0.0; MAX_PAIRS];
    weights[..PAIRS].copy_from_slice(&WEIGHTS);
    let mut last = None;
    for (i, seen) in lines(frames).into_iter().enumerate() {
        let time = SECONDS * i as f64 / frames as f64;
        let mut all = [seen[0]; MAX_PAIRS];
        all[..PAIRS].copy_from_slice(&seen);
        let is_followed = running.take(&Frame { time, lines: all, count: PAIRS, last, weights });
        assert_eq!(is_followed, i > 0);
        last = Some(Last { time, lines: all, count: PAIRS });
    }
    running
}

/// The law with more and more frames against its equations: errors fall at least as fast as frames get closer.
fn check(law: AdaptiveLaw, pairs: PairChoice, expected: &[f64], found: impl Fn(&RunningLaw<3>) -> Vec<f64>) {
    let size = expected.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let errors = [150, 600, 3000].map(|frames| {
        let found = found(&run(law, pairs, frames));
        assert_eq!(found.len(), expected.len());
        found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size
    });
    println!("{law:?}: {errors:?} of {size}");
    assert!(errors[2] < 1e-3 && errors[1] < 0.35 * errors[0] && errors[2] < 0.3 * errors[1], "{law:?}: {errors:?}");
    // The motion changes: no law is where a constant one would have led it.
    let truth = motion(SECONDS);
    assert!(expected.len() != 3 || (0..3).any(|j| (expected[j] - truth[j]).abs() > 0.05), "{expected:?}");
}

fn parameters(law: &RunningLaw<3>) -> Vec<f64> {
    law.parameters().as_slice()[..3].to_vec()
}

#[test]
fn the_structured_law_is_an_independent_integration_of_its_equations() {
    let gains = Gains::new();
    let begun = START.into_iter().flatten().chain(INITIAL).collect();
    let y = integrated(begun, |y| gains.structured(y));
    check(AdaptiveLaw::Structured, PairChoice::All, &y.as_slice()[8 * PAIRS..], parameters);
}

#[test]
fn the_36_numbers_are_an_independent_integration_of_equation_21() {
    let gains = Gains::new();
    // At the start they belong to the motion that the parameters start from: f times -omega, -1 times omega and b1, X times -b2.
    let [omega, b1, b2] = INITIAL;
    let mut begun = START[0].to_vec();
    let mut matrices = SMatrix::<f64, 4, 9>::zeros();
    (0..4).for_each(|i| matrices[(i, 4 + i)] = -omega);
    (matrices[(0, 8)], matrices[(2, 8)], matrices[(2, 0)], matrices[(3, 1)]) = (omega, b1, -b2, -b2);
    begun.extend(matrices.iter());
    let y = integrated(begun, |y| gains.printed(y));
    let numbers = |law: &RunningLaw<3>| law.matrices().expect("the printed law").iter().copied().collect();
    check(AdaptiveLaw::Printed, PairChoice::Given(0), &y.as_slice()[4 * (PAIRS + 1)..], numbers);
}

#[test]
fn filtered_least_squares_and_regressor_mixing_are_independent_integrations_of_their_equations() {
    for (law, prior) in [(AdaptiveLaw::FilteredLeastSquares, 1e-6), (AdaptiveLaw::RegressorMixing, 0.0)] {
        let mut begun = Vec::new();
        for first in START {
            begun.extend([0.0; 16].into_iter().chain(first));
        }
        begun.extend((Matrix3::identity() * prior).iter());
        begun.extend(INITIAL.map(|value| prior * value).into_iter().chain(INITIAL));
        let y = integrated(begun, filtered);
        let own = &y.as_slice()[24 * PAIRS..];
        let sums = Matrix3::from_column_slice(&own[..9]);
        let solved = sums.try_inverse().expect("excited") * Vector3::from_column_slice(&own[9..12]);
        let expected = if prior > 0.0 { solved } else { Vector3::from_column_slice(&own[12..]) };
        check(law, PairChoice::All, expected.as_slice(), parameters);
    }
}
