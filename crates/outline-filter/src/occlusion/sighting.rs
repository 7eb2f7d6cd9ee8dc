//! Where straight edges have been seen, and how they move.
use nalgebra::{Point2, Vector2};

use super::line::Line;
use crate::tuning::occlusion::{DRIFTS, SAME_DIRECTION, SAME_LINE};

/// One pair of frames that show a straight edge that is not of the object.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Sighting {
    pub(super) frame: usize,
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
    pub(super) fn is_valid(&self, last_frame: usize) -> bool {
        let each = 1..=usize::from(u16::MAX);
        self.line.is_valid() && self.frame <= last_frame && self.noise >= 0.0 && each.contains(&self.points_each)
    }
}

/// A line that stands still, or moves along its normal at a constant velocity.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Path {
    line: Line,
    /// How far it moves along its normal in a frame; 0 if it stands still.
    drift: f64,
    /// Frame that the line is of.
    frame: f64,
}

impl Path {
    pub(super) fn line_in(&self, frame: usize) -> Line {
        self.line.moved(self.drift * (frame as f64 - self.frame))
    }

    /// The path that lines seen agree on: a regression of where their middles lie across their mean direction; at rest unless they have moved beyond
    /// doubt. `None` where they do not agree.
    pub(super) fn of(sightings: &[Sighting]) -> Option<Self> {
        let last = sightings.last()?;
        let aligned = |seen: &Sighting| seen.line.along * seen.line.along.dot(&last.line.along).signum();
        let along = sightings.iter().map(aligned).sum::<Vector2<f64>>().try_normalize(0.0)?;
        let count = sightings.len() as f64;
        let frame = sightings.iter().map(|seen| seen.frame as f64).sum::<f64>() / count;
        let through = sightings.iter().map(|seen| seen.middle().coords).sum::<Vector2<f64>>() / count;
        let line = Line { through: through.into(), along };
        let (mut moment, mut square) = (0.0, 0.0);
        for seen in sightings {
            let time = seen.frame as f64 - frame;
            moment += time * line.distance(&seen.middle());
            square += time * time;
        }
        let slope = if square > 0.0 { moment / square } else { 0.0 };
        let moves = slope.abs() * square.sqrt() > DRIFTS * last.noise;
        let path = Self { line, drift: if moves { slope } else { 0.0 }, frame };
        sightings.iter().all(|seen| seen.is_of(&path.line_in(seen.frame))).then_some(path)
    }

    #[cfg(feature = "serde")]
    pub(super) fn is_valid(&self) -> bool {
        self.line.is_valid() && self.drift.is_finite() && self.frame.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(frame: usize, offset: f64, along: Vector2<f64>) -> Sighting {
        let line = Line { through: Point2::new(0.3, offset), along };
        Sighting { frame, line, reach: [-0.5, 0.5], noise: 0.01, points_each: 1 }
    }

    #[test]
    fn lines_that_agree_stand_still_or_move_evenly_and_others_are_no_path() {
        let offset_in = |path: &Path, frame| path.line_in(frame).distance(&Point2::origin()).abs();
        let path_of = |offsets: [f64; 3]| {
            // Either way along is the same line.
            let ways = [Vector2::x(), -Vector2::x(), Vector2::x()];
            let all: Vec<_> = (0..3).map(|i| seen(10 * i, offsets[i], ways[i])).collect();
            Path::of(&all)
        };
        let standing = path_of([1.0, 1.004, 1.001]).expect("a line that stands still");
        assert!((offset_in(&standing, 1000) - 1.0).abs() < 0.005, "it stays there");
        let moving = path_of([1.0, 1.1, 1.2]).expect("a line that moves");
        assert!((offset_in(&moving, 40) - 1.4).abs() < 1e-9);
        assert!(path_of([1.0, 1.3, 1.1]).is_none(), "there and back");
        let turned = [seen(0, 1.0, Vector2::x()), seen(1, 1.0, Vector2::new(0.8, 0.6))];
        assert!(Path::of(&turned).is_none(), "another direction");
    }
}
