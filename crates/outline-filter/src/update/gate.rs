//! Whether a frame shows the outline that is known, where it is expected.
use std::fmt;

use super::solve::Proposal;
use crate::{
    map::median_about,
    measurement::{Columns, Frame, View, spread, weighted_median},
    tuning::{
        measurement::MEDIAN_TO_DEVIATION, noise::NEVER_TOO_MUCH, registration::FEWEST_ON_OUTLINE, update as tuning,
    },
    vectors::vectorised,
};

/// Comparison of one frame with the known outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameMeasurement {
    /// Share of the points that agree with the known outline: agreeing / (known + new / 3), in [0, 1]. "Known" points have a cell of the
    /// outline, "new" ones lie beyond an end of it. Points that state standard deviations count by their inverse variances.
    pub agreement: f64,
    /// Points that lie beyond the known ends of the outline.
    pub new_points: usize,
    /// Normalised innovation squared (NIS): the innovation of the pose, squared in units of its covariance. On average about the number of
    /// parameters, if the motion has not changed.
    #[doc(alias = "NIS")]
    pub innovation: f64,
    /// Linearisations taken.
    pub iterations: usize,
    /// Standard deviation of the noise of this frame, image lengths; `None` if too few cells have been seen before. Where points state
    /// deviations of their own, that of a typical one of this frame.
    pub noise: Option<f64>,
    /// Robust spread of all points about the outline, including points left out, image lengths; infinite if there are none.
    pub spread: f64,
    /// What a point counts for by the deviation that it states, in the mean; in (0, 1], 1 for good points and where none state any.
    pub weight: f64,
}

/// Why a [`MotionFilter`](crate::MotionFilter) has not used a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rejection {
    /// Too few points lie on the known outline.
    AgreementTooSmall {
        /// Share of the points on the outline, in [0, 1].
        agreement: f64,
        /// Share needed, [`FilterSettings::smallest_agreement`](crate::FilterSettings::smallest_agreement).
        smallest: f64,
    },
    /// The frame shows the outline, but not at the place predicted by the motion, as linearisations tell it.
    InnovationTooLarge {
        /// Normalised innovation squared (NIS) of the pose, as in [`FrameMeasurement::innovation`].
        innovation: f64,
        /// Largest accepted value.
        largest: f64,
    },
    /// The frame shows all of the outline, but away from where it was expected: there too few of its points lie on it, or they scatter too much. A
    /// search from there has found it.
    Elsewhere {
        /// Distance of the outline from where it was expected, root mean square over the outline, image lengths. The next frame may refute it.
        distance: f64,
    },
    /// The frame shows the outline, but its points scatter about it more than those of other frames.
    NoiseTooLarge {
        /// Standard deviation of this frame's noise, image lengths.
        noise: f64,
    },
    /// The frame repeats the one before it to the last digit, and the object is not known to be at rest: a picture that was stored twice shows
    /// nothing of the time that it is given with. After three in a row the object rests.
    Repeated,
    /// All but a few points lie along [edges](crate::MotionFilter::standing_edges) that are not of the object, which may be behind them. That says
    /// nothing against what is known of it.
    Hidden,
    /// No pose was found, or none that linearisations settle in; or none was looked for, as too many frames have been searched in vain, or as the
    /// frame has too few points to confirm the step between two frames that show parts of the object; or a third frame does not bear out that step,
    /// the only one known, so that the map is begun anew with it.
    NotFound,
}

impl Rejection {
    /// Whether points were compared with the known outline, and did not agree with it where it was expected.
    pub(crate) fn is_disagreement(self) -> bool {
        matches!(
            self,
            Self::AgreementTooSmall { .. }
                | Self::InnovationTooLarge { .. }
                | Self::Elsewhere { .. }
                | Self::NoiseTooLarge { .. }
        )
    }
}

/// Conditions for accepting a frame. The limits are set by the `supervisor` (`gates::gate`, `gates::Gates`); that on noise is
/// [`View::largest_noise`], which `Track::verdict` widens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gate {
    /// Smallest share of points that agree.
    pub(crate) smallest_agreement: f64,
    /// Largest squared innovation of the pose, where it matters.
    pub(crate) largest_innovation: Option<f64>,
    /// Largest deviation of the noise of good points in image lengths, where it matters.
    pub(crate) largest_noise: Option<f64>,
}

impl Gate {
    /// This gate without the limit on the noise, for a frame that is known to show the object.
    pub(crate) fn without_noise(self) -> Self {
        Self { largest_noise: None, ..self }
    }

    /// This gate for a frame of so many points that another pose shows to be one of the object, where this pose has too few of them on the outline
    /// only because others lie beyond its ends: they may be anything, but are not another object. `None` where that is not so.
    pub(crate) fn vouched_for(self, measurement: &FrameMeasurement, points: usize) -> Option<Self> {
        let new = measurement.new_points as f64;
        let known = points as f64 - new;
        let of_known = known / (known + new / tuning::NEW_POINTS_PER_POINT);
        let is_shown = known >= FEWEST_ON_OUTLINE * points as f64
            && measurement.agreement >= self.smallest_agreement * of_known
            && measurement.agreement < self.smallest_agreement;
        is_shown.then(|| Self { smallest_agreement: self.smallest_agreement * of_known, ..self.without_noise() })
    }

    /// Tests the measurement of a frame.
    ///
    /// # Errors
    /// The first condition that is not met.
    pub(crate) fn verdict(&self, measurement: &FrameMeasurement) -> Result<(), Rejection> {
        let FrameMeasurement { agreement, innovation, .. } = *measurement;
        let smallest = self.smallest_agreement;
        // Not a number does not agree either.
        if agreement.is_nan() || agreement < smallest {
            return Err(Rejection::AgreementTooSmall { agreement, smallest });
        }
        if let Some(largest) = self.largest_innovation.filter(|largest| innovation > *largest || innovation.is_nan()) {
            return Err(Rejection::InnovationTooLarge { innovation, largest });
        }
        let of_good = measurement.of_good_points(measurement.noise.unwrap_or(0.0));
        match (measurement.noise, self.largest_noise) {
            (Some(noise), Some(largest)) if of_good > largest || noise.is_nan() => {
                Err(Rejection::NoiseTooLarge { noise })
            }
            _ => Ok(()),
        }
    }
}

impl FrameMeasurement {
    /// Of a frame that no pose was found for.
    pub(crate) const fn unsolved(iterations: usize) -> Self {
        Self {
            agreement: 0.0,
            new_points: 0,
            innovation: f64::INFINITY,
            iterations,
            noise: None,
            spread: f64::INFINITY,
            weight: 1.0,
        }
    }

    /// What noise of a typical point of this frame is for a good point.
    pub(crate) fn of_good_points(&self, noise: f64) -> f64 {
        noise * self.weight.sqrt()
    }
}

/// What the residual of a point that agrees with the outline may be, normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Agreeing {
    by_noise: f64,
    /// The most that points may state of themselves, in deviations of a good point.
    widest: f64,
    least: f64,
}

impl Agreeing {
    /// Of a point with a deviation in units of that of a good one.
    #[inline(always)]
    pub(super) fn of(&self, ratio: f64) -> f64 {
        (self.by_noise * ratio.min(self.widest)).max(self.least)
    }
}

impl View<'_> {
    /// What agrees in a frame of such a spread.
    pub(super) fn agreeing(&self, frame: &Frame, spread: f64) -> Agreeing {
        let by_noise = tuning::AGREEING * spread.clamp(self.noise.sigma, self.noise.tolerated());
        Agreeing { by_noise, widest: frame.deviations.widest(), least: tuning::BEND * self.map.spacing() }
    }

    /// Most noise of good points in a frame that shows the known outline, in image lengths; `radius` is that of the first outline.
    pub(crate) fn largest_noise(&self, radius: f64) -> f64 {
        self.noise.tolerated().max(NEVER_TOO_MUCH * self.map.spacing()) * radius
    }

    /// The frame compared with the outline, in the pose of a proposal, and what agrees in it. Lengths are multiplied by `radius`.
    pub(crate) fn compare(
        &self,
        frame: &mut Frame,
        proposal: &Proposal,
        innovation: f64,
        radius: f64,
    ) -> (FrameMeasurement, Agreeing) {
        let spread = spread(frame, self.noise.sigma);
        let limit = self.agreeing(frame, spread);
        let Frame { columns, values, weighted, cells_with_frame: cells, deviations, .. } = frame;
        values.resize(columns.len(), 0.0);
        weighted.clear();
        let Told { known, agreeing, new, new_points, told } = match deviations.ratios() {
            None => vectorised(
                #[inline(always)]
                || told_alike(columns, cells.own(), limit.of(1.0), values),
            ),
            Some(ratios) => told_by_deviations((columns, ratios), cells.own(), |ratio| limit.of(ratio), weighted),
        };
        let enough = told * tuning::ONE_IN_TELLS > columns.len();
        // Points count by their weights: what those that count most scatter by must not hide behind others that say too much of theirs.
        let guess = self.noise.sigma / MEDIAN_TO_DEVIATION;
        let middle =
            if weighted.is_empty() { median_about(guess, &mut values[..told]) } else { weighted_median(weighted) };
        let typical = deviations.typical();
        let noise = middle.filter(|_| enough).map(|m| MEDIAN_TO_DEVIATION * m * radius * typical);
        let total = known + new / tuning::NEW_POINTS_PER_POINT;
        let agreement = if total > 0.0 { agreeing / total } else { 0.0 };
        let iterations = proposal.iterations;
        let (spread, weight) = (spread * radius * typical, deviations.weight());
        (FrameMeasurement { agreement, new_points, innovation, iterations, noise, spread, weight }, limit)
    }
}

/// What the points of a frame say of whether it shows the outline.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Told {
    /// Points on the outline, those of them that agree, and points beyond its ends, by what they count for.
    known: f64,
    agreeing: f64,
    new: f64,
    new_points: usize,
    /// Points that tell of the noise.
    told: usize,
}

/// Of points that count by their deviations, over that of a good one, with what each may be off by; those that tell of the noise are listed.
fn told_by_deviations(
    (columns, ratios): (&Columns, &[f64]),
    own: &[f64],
    limit: impl Fn(f64) -> f64,
    weighted: &mut Vec<(f64, f64)>,
) -> Told {
    let mut all = Told { known: 0.0, agreeing: 0.0, new: 0.0, new_points: 0, told: 0 };
    for (m, ratio) in columns.points().zip(ratios) {
        // Points that count for next to nothing need not agree.
        let share = (ratio * ratio).recip();
        let Some(own) = own.get(m.cell) else {
            all.new_points += 1;
            all.new += share;
            continue;
        };
        all.known += share;
        all.agreeing += if m.residual.abs() < limit(*ratio) { share } else { 0.0 };
        let (factor, is_told) = without_leverage(m.weight, m.by_offset, *own);
        if is_told {
            weighted.push((m.residual.abs() * factor.sqrt() / ratio, share));
        }
    }
    all.told = weighted.len();
    all
}

/// As [`told_by_deviations`], which a test compares it with, of points that are all good ones; sizes of those that tell of the noise come
/// first among the values.
#[inline(always)]
fn told_alike(columns: &Columns, own: &[f64], limit: f64, values: &mut [f64]) -> Told {
    let Columns { numbers, residuals, weights, by_offsets, .. } = columns;
    // What lies anywhere is looked up first: the loop after that runs in vectors. None has a number beyond all cells.
    for (value, number) in values.iter_mut().zip(numbers) {
        *value = own.get(*number as usize).copied().unwrap_or(NONE);
    }
    let (mut known, mut agreeing, mut told) = (0_u64, 0_u64, 0_u64);
    let of_points = values.iter_mut().zip(residuals).zip(weights.iter().zip(by_offsets));
    for ((value, residual), (weight, by_offset)) in of_points {
        let (own, size) = (*value, residual.abs());
        let (factor, is_told) = without_leverage(*weight, *by_offset, own);
        known += u64::from(own != NONE);
        agreeing += u64::from((own != NONE) & (size < limit));
        told += u64::from(is_told);
        let value_told = size * factor.sqrt();
        *value = if is_told { value_told } else { NONE };
    }
    let (told, new_points) = (told as usize, numbers.len() - known as usize);
    if told < numbers.len() {
        let mut kept = 0;
        for i in 0..values.len() {
            let value = values[i];
            values[kept] = value;
            kept += usize::from(value != NONE);
        }
    }
    Told { known: known as f64, agreeing: agreeing as f64, new: new_points as f64, new_points, told }
}

/// Sentinel for "no cell" (in place of its information) or "tells nothing" (in place of the size or square of a residual) in vectorised loops, where
/// an `Option` would branch. Real values are never negative.
pub(super) const NONE: f64 = -1.0;

/// What a squared residual would be without its point's own share of the information on the offset of its cell, in units of what it is, and
/// whether that share is small enough to tell. `own` is all of that information; there is none where it is not positive.
#[inline(always)]
pub(crate) fn without_leverage(weight: f64, by_offset: f64, own: f64) -> (f64, bool) {
    let of_point = weight * by_offset * by_offset;
    (own / (own - of_point), (of_point < tuning::LARGEST_LEVERAGE * own) & (weight > 0.0))
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AgreementTooSmall { agreement, .. } => {
                write!(
                    f,
                    "does not fit the object where it was expected, {:.0} % of the points lie on its outline",
                    100.0 * agreement
                )
            }
            Self::InnovationTooLarge { innovation, .. } => {
                let deviations = innovation.sqrt();
                write!(f, "jumps away from where it was expected ({deviations:.0} standard deviations)")
            }
            Self::Elsewhere { distance } => {
                let decimals = decimals_of(*distance);
                write!(f, "shows the object at a distance of {distance:.decimals$} from where it was expected")
            }
            Self::NoiseTooLarge { noise } => {
                let decimals = decimals_of(*noise);
                write!(
                    f,
                    "its points scatter by {noise:.decimals$} about the outline known, more than those of other frames"
                )
            }
            Self::Repeated => f.write_str("repeats the frame before it"),
            Self::Hidden => f.write_str("shows little but an edge in front of the object"),
            Self::NotFound => f.write_str("the object was not found"),
        }
    }
}

/// Decimals that show two figures of a length.
fn decimals_of(length: f64) -> usize {
    (1.0 - length.log10().floor()).clamp(0.0, 300.0) as usize
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::measurement::{Measurement, NO_CELL};

    #[test]
    fn a_frame_that_another_pose_vouches_for_is_judged_by_the_points_that_are_known() {
        const POINTS: usize = 100;
        let gate = Gate { smallest_agreement: 0.7, largest_innovation: Some(75.0), largest_noise: Some(0.1) };
        // Of so many points that lie beyond ends, and so many others that do not agree.
        let measured = |new_points: usize, off: usize| {
            let (new, known) = (new_points as f64, (POINTS - new_points) as f64);
            let agreement = (known - off as f64) / (known + new / tuning::NEW_POINTS_PER_POINT);
            FrameMeasurement { agreement, new_points, innovation: 1.0, ..FrameMeasurement::unsolved(1) }
        };
        let judged = |measurement: &FrameMeasurement| Some(gate.vouched_for(measurement, POINTS)?.verdict(measurement));
        for (new, off) in [(60, 0), (70, 5), (60, 10)] {
            let measurement = measured(new, off);
            assert!(gate.verdict(&measurement).is_err(), "{new} {off}");
            assert_eq!(judged(&measurement), Some(Ok(())), "{new} {off}");
        }
        // Too few are known, or those that are do not agree, or nothing was wrong.
        for (new, off) in [(80, 0), (60, 15), (0, 40), (30, 0)] {
            assert_eq!(judged(&measured(new, off)), None, "{new} {off}");
        }
    }

    #[test]
    fn good_points_tell_what_points_of_deviations_that_are_all_one_do() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let own: Vec<f64> = (0..40).map(|_| rng.random_range(0.0..5.0)).collect();
        let measurements: Vec<_> = (0..203)
            .map(|i| Measurement {
                cell: if i % 13 == 0 { NO_CELL } else { rng.random_range(0..own.len()) },
                residual: rng.random_range(-1.0..1.0),
                by_offset: rng.random_range(0.5..1.5),
                weight: if i % 7 == 0 { 0.0 } else { rng.random_range(0.0..1.0) },
                ..Measurement::NOTHING
            })
            .collect();
        let mut columns = Columns::default();
        columns.take(&measurements);
        let mut weighted = Vec::new();
        let ratios = vec![1.0; measurements.len()];
        let expected = told_by_deviations((&columns, &ratios), &own, |_| 0.4, &mut weighted);
        let mut values = vec![0.0; measurements.len()];
        let found = told_alike(&columns, &own, 0.4, &mut values);
        assert_eq!(found, expected);
        assert!(found.told > 50 && found.told < measurements.len());
        assert!(values.iter().zip(&weighted).all(|(value, (size, _))| value == size));
    }
}
