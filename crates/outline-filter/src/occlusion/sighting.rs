//! Where straight edges have been seen, and how they move.
use nalgebra::{Point2, Vector2};

use super::line::Line;
#[cfg(feature = "serde")]
use super::places::Places;
use crate::tuning::occlusion::{DRIFTS, SAME_DIRECTION, SAME_LINE};

/// One pair of frames that show a straight edge that is not of the object.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Sighting {
    /// s.
    pub(super) time: f64,
    /// How many pairs had told all that they can before it.
    pub(super) pair: usize,
    pub(super) line: Line,
    /// How far it reaches along the line.
    pub(super) reach: [f64; 2],
    pub(super) noise: f64,
    pub(super) points_each: usize,
}

impl Sighting {
    pub(super) fn middle(&self) -> Point2<f64> {
        self.line.at(0.5 * (self.reach[0] + self.reach[1]))
    }

    pub(super) fn is_along(&self, line: &Line) -> bool {
        line.normal().dot(&self.line.along).abs() < SAME_DIRECTION
    }

    pub(super) fn is_of(&self, line: &Line) -> bool {
        self.is_along(line) && line.distance(&self.middle()).abs() < SAME_LINE * self.noise
    }

    /// Standard deviation of single points, those of one place being independent.
    pub(super) fn noise_of_points(&self) -> f64 {
        self.noise * (self.points_each as f64).sqrt()
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        let [low, high] = self.reach;
        self.line.is_valid()
            && [self.time, low, high, self.noise].iter().all(|x| x.is_finite())
            && low <= high
            && self.noise >= 0.0
            && Places::COUNTS.contains(&self.points_each)
    }
}

/// A line that stands still, or moves along its normal at a constant velocity.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Path {
    line: Line,
    /// Velocity along its normal, image lengths/s; 0 if it stands still.
    drift: f64,
    /// Time that the line is of, s.
    time: f64,
    /// From when on it is held where it would be then: a velocity is not known for longer than it has been seen for.
    until: f64,
}

impl Path {
    pub(super) fn line_at(&self, time: f64) -> Line {
        self.line.moved(self.drift * (time.min(self.until) - self.time))
    }

    /// The path that lines seen agree on: a regression of where their middles lie across their mean direction; at rest unless they have moved beyond
    /// doubt. `None` where they do not agree.
    pub(super) fn of<'a>(sightings: &(impl Iterator<Item = &'a Sighting> + Clone)) -> Option<Self> {
        let sightings = || sightings.clone();
        let last = sightings().last()?;
        let aligned = |seen: &Sighting| seen.line.along * seen.line.along.dot(&last.line.along).signum();
        let along = sightings().map(aligned).sum::<Vector2<f64>>().try_normalize(0.0)?;
        let count = sightings().count() as f64;
        let mean = sightings().map(|seen| seen.time).sum::<f64>() / count;
        let through = sightings().map(|seen| seen.middle().coords).sum::<Vector2<f64>>() / count;
        let line = Line { through: through.into(), along };
        let (mut moment, mut square) = (0.0, 0.0);
        for seen in sightings() {
            let time = seen.time - mean;
            moment += time * line.distance(&seen.middle());
            square += time * time;
        }
        let slope = if square > 0.0 { moment / square } else { 0.0 };
        let moves = slope.abs() * square.sqrt() > DRIFTS * last.noise;
        let [first, latest] = extent(sightings().map(|seen| seen.time));
        let path = Self { line, drift: if moves { slope } else { 0.0 }, time: mean, until: latest + (latest - first) };
        sightings().all(|seen| seen.is_of(&path.line_at(seen.time))).then_some(path)
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        self.line.is_valid() && [self.drift, self.time, self.until].iter().all(|x| x.is_finite())
    }
}

/// The least and the largest of some values.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(time: f64, offset: f64, along: Vector2<f64>) -> Sighting {
        let line = Line { through: Point2::new(0.3, offset), along };
        Sighting { time, pair: 0, line, reach: [-0.5, 0.5], noise: 0.01, points_each: 1 }
    }

    #[test]
    fn lines_that_agree_stand_still_or_move_evenly_and_others_are_no_path() {
        let offset_in = |path: &Path, time| path.line_at(time).distance(&Point2::origin()).abs();
        // At uneven times.
        let times = [0.0, 0.5, 2.0];
        let path_of = |offsets: [f64; 3]| {
            // Either way along is the same line.
            let ways = [Vector2::x(), -Vector2::x(), Vector2::x()];
            let all: Vec<_> = (0..3).map(|i| seen(times[i], offsets[i], ways[i])).collect();
            Path::of(&all.iter())
        };
        let standing = path_of([1.0, 1.004, 1.001]).expect("a line that stands still");
        assert!((offset_in(&standing, 1000.0) - 1.0).abs() < 0.005, "it stays there");
        let moving = path_of([1.0, 1.05, 1.2]).expect("a line that moves");
        assert!((offset_in(&moving, 3.0) - 1.3).abs() < 1e-9);
        assert!((offset_in(&moving, 1000.0) - 1.4).abs() < 1e-9, "it is held where nothing has shown it for long");
        assert!(path_of([1.0, 1.3, 1.1]).is_none(), "there and back");
        let turned = [seen(0.0, 1.0, Vector2::x()), seen(1.0, 1.0, Vector2::new(0.8, 0.6))];
        assert!(Path::of(&turned.iter()).is_none(), "another direction");
    }
}
