/// What became of one run.
#[derive(Debug, Clone, Default)]
pub(super) struct Outcome {
    /// In the order of the parameters, `None` for one that the method calls unobservable; `None` as a whole where the run was
    /// lost.
    pub(super) errors: Option<Vec<Option<ParameterError>>>,
    pub(super) frames: usize,
    pub(super) rejected: usize,
    /// Time spent.
    pub(super) seconds: f64,
}

/// How far off one parameter was.
#[derive(Debug, Clone, Copy)]
pub(super) struct ParameterError {
    pub(super) error: f64,
    /// As stated by the method.
    pub(super) deviation: Option<f64>,
}

/// All runs of one shape.
#[derive(Debug)]
pub(super) struct Cell {
    /// Smallest standard deviation of each parameter, `None` for one that is not observable.
    pub(super) bounds: Vec<Option<f64>>,
    pub(super) outcomes: Vec<Outcome>,
}

/// What all runs of one or several shapes say together. `None` where they say nothing.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Statistics {
    /// Runs in all.
    pub runs: usize,
    /// Runs without an estimate, or with one that leads the outline astray; they count in no error below.
    pub lost: usize,
    /// Share of all frames.
    pub frames_rejected: Option<f64>,
    /// Mean time of a frame on one core; the only number that differs from run to run.
    pub microseconds_per_frame: Option<f64>,
    /// Root mean square of error over bound, all parameters together.
    pub ratio: Option<f64>,
    /// Share of all 95 % intervals that held the truth.
    pub coverage: Option<f64>,
    /// Root mean square of bias over its standard error, over shapes and parameters: 1 is expected without bias.
    pub bias_in_errors: Option<f64>,
    /// Each parameter by itself, in the order of the model.
    pub parameters: Vec<ParameterStatistics>,
}

/// What all runs say of one parameter, in its unit. `None` where they say nothing.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParameterStatistics {
    /// Root mean square error.
    pub rmse: Option<f64>,
    /// The Cramer-Rao bound, root mean square over the shapes.
    pub bound: Option<f64>,
    /// Root mean square of error over bound.
    pub ratio: Option<f64>,
    /// Mean error.
    pub bias: Option<f64>,
    /// Standard error of `bias`.
    pub bias_standard_error: Option<f64>,
    /// Share of the 95 % intervals (1.96 standard deviations either side) that held the truth.
    pub coverage: Option<f64>,
}

/// Half of a 95 % interval in standard deviations.
const HALF_INTERVAL: f64 = 1.959_964;

impl Statistics {
    /// Of the runs of one shape, or of several together.
    pub(super) fn of(cells: &[Cell]) -> Self {
        let outcomes = || cells.iter().flat_map(|cell| &cell.outcomes);
        let count = cells.first().map_or(0, |cell| cell.bounds.len());
        let samples: Vec<Samples> = (0..count).map(|index| Samples::of(cells, index)).collect();
        let frames = outcomes().map(|outcome| outcome.frames).sum::<usize>() as f64;
        let rejected = outcomes().map(|outcome| outcome.rejected).sum::<usize>() as f64;
        let seconds = outcomes().map(|outcome| outcome.seconds).sum::<f64>();
        Self {
            runs: outcomes().count(),
            lost: cells.iter().map(|cell| cell.outcomes.len() - cell.kept().count()).sum(),
            frames_rejected: finite(rejected / frames),
            microseconds_per_frame: finite(1e6 * seconds / frames),
            ratio: root_mean_square(samples.iter().flat_map(|s| &s.ratios).copied()),
            coverage: mean(samples.iter().flat_map(|s| &s.covered).copied()),
            bias_in_errors: root_mean_square(samples.iter().flat_map(Samples::biases_in_errors)),
            parameters: samples.iter().map(Samples::statistics).collect(),
        }
    }
}

impl Cell {
    /// The errors of the runs that were not lost: a run that calls a parameter unobservable which is not has lost it.
    fn kept(&self) -> impl Iterator<Item = &[Option<ParameterError>]> {
        let complete = |errors: &&[Option<ParameterError>]| {
            self.bounds.iter().zip(*errors).all(|(bound, error)| bound.is_none() || error.is_some())
        };
        self.outcomes.iter().filter_map(|outcome| outcome.errors.as_deref()).filter(complete)
    }
}

/// What the runs say of one parameter.
struct Samples {
    /// One list of errors per shape in which the parameter is observable.
    errors: Vec<Vec<f64>>,
    bounds: Vec<f64>,
    /// Errors over bound.
    ratios: Vec<f64>,
    /// 1 where the interval held the truth, else 0.
    covered: Vec<f64>,
}

impl Samples {
    fn of(cells: &[Cell], index: usize) -> Self {
        let mut samples = Self { errors: Vec::new(), bounds: Vec::new(), ratios: Vec::new(), covered: Vec::new() };
        for cell in cells {
            let Some(bound) = cell.bounds[index] else { continue };
            let found = || cell.kept().filter_map(|errors| errors[index]);
            samples.bounds.push(bound);
            samples.errors.push(found().map(|e| e.error).collect());
            samples.ratios.extend(found().filter_map(|e| finite(e.error / bound)));
            let held = found().filter_map(|e| e.deviation.map(|std| e.error.abs() <= HALF_INTERVAL * std));
            samples.covered.extend(held.map(|held| f64::from(u8::from(held))));
        }
        samples
    }

    /// Mean error of each shape and its standard error; the latter needs two runs.
    fn biases(&self) -> impl Iterator<Item = (f64, Option<f64>)> + '_ {
        self.errors.iter().filter(|errors| !errors.is_empty()).map(|errors| {
            let count = errors.len() as f64;
            let mean = errors.iter().sum::<f64>() / count;
            let spread = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>();
            (mean, finite((spread / (count - 1.0) / count).sqrt()))
        })
    }

    fn biases_in_errors(&self) -> impl Iterator<Item = f64> + '_ {
        self.biases().filter_map(|(bias, error)| finite(bias / error?))
    }

    fn statistics(&self) -> ParameterStatistics {
        let biases: Vec<_> = self.biases().collect();
        let variance = biases.iter().map(|(_, error)| error.map(|e| e * e)).sum::<Option<f64>>();
        ParameterStatistics {
            rmse: root_mean_square(self.errors.iter().flatten().copied()),
            bound: root_mean_square(self.bounds.iter().copied()),
            ratio: root_mean_square(self.ratios.iter().copied()),
            bias: mean(biases.iter().map(|(bias, _)| *bias)),
            bias_standard_error: variance.and_then(|v| finite(v.sqrt() / biases.len() as f64)),
            coverage: mean(self.covered.iter().copied()),
        }
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
    finite(sum / count)
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    mean(values.map(|value| value * value)).map(f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(bound: f64, errors: &[Option<f64>]) -> Cell {
        let outcome = |error: &Option<f64>| Outcome {
            errors: error.map(|error| vec![Some(ParameterError { error, deviation: Some(1.0) }), None]),
            frames: 10,
            rejected: 1,
            seconds: 1e-3,
        };
        Cell { bounds: vec![Some(bound), None], outcomes: errors.iter().map(outcome).collect() }
    }

    #[test]
    fn the_figures_are_those_of_their_definitions() {
        let statistics = Statistics::of(&[cell(2.0, &[Some(1.0), Some(-3.0), None])]);
        assert_eq!((statistics.runs, statistics.lost, statistics.frames_rejected), (3, 1, Some(0.1)));
        assert!((statistics.microseconds_per_frame.expect("frames") - 100.0).abs() < 1e-9);
        let omega = statistics.parameters[0];
        assert_eq!((omega.rmse, omega.ratio), (Some(5.0_f64.sqrt()), Some(1.25_f64.sqrt())));
        assert_eq!((omega.bias, omega.bias_standard_error), (Some(-1.0), Some(2.0)));
        assert_eq!((omega.coverage, statistics.bias_in_errors), (Some(0.5), Some(0.5)));
        assert_eq!(statistics.parameters[1].rmse, None);
    }

    #[test]
    fn a_run_that_calls_an_observable_parameter_unobservable_is_lost() {
        let mut runs = cell(2.0, &[Some(1.0), Some(-3.0)]);
        runs.outcomes[1].errors = Some(vec![None, None]);
        let statistics = Statistics::of(&[runs]);
        assert_eq!((statistics.lost, statistics.parameters[0].rmse), (1, Some(1.0)));
    }

    #[test]
    fn shapes_are_pooled_by_error_over_their_own_bound() {
        let cells = [cell(1.0, &[Some(1.0), Some(-1.0)]), cell(10.0, &[Some(20.0), Some(-20.0)])];
        let pooled = Statistics::of(&cells);
        assert_eq!(pooled.ratio, Some(2.5_f64.sqrt()));
        assert_eq!(pooled.parameters[0].bias, Some(0.0));
        assert_eq!(pooled.parameters[0].bias_standard_error, Some(401.0_f64.sqrt() / 2.0));
    }

    #[test]
    fn without_noise_there_is_no_ratio_and_without_a_run_left_nothing() {
        let exact = Statistics::of(&[cell(0.0, &[Some(0.0)])]);
        assert_eq!((exact.ratio, exact.parameters[0].rmse), (None, Some(0.0)));
        let lost = Statistics::of(&[cell(1.0, &[None, None])]);
        assert_eq!((lost.lost, lost.ratio, lost.coverage, lost.bias_in_errors), (2, None, None, None));
    }
}
