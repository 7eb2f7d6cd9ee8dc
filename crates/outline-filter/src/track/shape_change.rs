//! Whether the outline has changed its shape since the map became known.
//!
//! An outline that deforms slowly is learnt anew from frame to frame (shape process noise), so that single frames show little of it: the
//! tests of what the family of motions leaves out may miss a deformation that is large in the end. Here the offsets of now are compared
//! with those of an early frame, after the motion that moves the outline as a whole has been taken off.
use super::Track;
use crate::{
    map::median,
    measurement::Frame,
    tuning::{family::MAP_KNOWN, measurement::MEDIAN_TO_DEVIATION, shape_change as tuning},
};

/// The offsets of the cells as they were when the map became known, and the information on them; empty before that. How far the outline has
/// been from that.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct EarlyShape {
    offsets: Vec<f64>,
    information: Vec<f64>,
    /// Largest change of the shape, normalised, less what has been forgotten of it: an outline that is seen from aside looks the same again
    /// after half a turn.
    largest: f64,
}

impl Track {
    /// Keeps the offsets of the frame in which the map becomes known, and compares later ones with them.
    pub(super) fn look_for_change_of_shape(&mut self, frame: &mut Frame) {
        if self.frames == MAP_KNOWN {
            let EarlyShape { offsets, information, largest } = &mut self.early_shape;
            offsets.clone_from(&self.belief.offsets);
            information.clear();
            information.extend_from_slice(self.belief.information.cells.own());
            *largest = 0.0;
        } else if self.shape.is_seen() && self.frames.is_multiple_of(tuning::EVERY) {
            // A shape that is not forgotten does not change.
            let change = self.shape_change(&mut frame.values).unwrap_or(0.0);
            let kept = 1.0 - tuning::EVERY as f64 / tuning::MEMORY;
            self.early_shape.largest = change.max(kept * self.early_shape.largest);
        }
    }

    /// How far the points of the outline have moved against each other since the map became known, or had before they moved back; a robust
    /// root mean square in the image, normalised. `None` where that is no more than noise.
    pub(super) fn change_of_shape(&self) -> Option<f64> {
        let largest = self.early_shape.largest;
        // Where the turn is not known, it changes the outline too.
        (!self.turn_is_unseen() && largest > tuning::LEAST * self.noise.sigma).then_some(largest)
    }

    /// As it is now, with a buffer for numbers. `None` where that is no more than noise, or where too little of the outline was known early.
    fn shape_change(&self, values: &mut Vec<f64>) -> Option<f64> {
        let EarlyShape { offsets: early, information: early_information, .. } = &self.early_shape;
        let (known, offsets) = (self.belief.information.cells.own(), &self.belief.offsets);
        // Cells that are newer than the early shape have no weight.
        let moved_of = |number: usize| match (known[number], early_information.get(number)) {
            (now, Some(&then)) if now > 0.0 && then > 0.0 => {
                ((1.0 / now + 1.0 / then).recip(), offsets[number] - early[number])
            }
            _ => (0.0, 0.0),
        };
        let moved = (0..known.len()).map(moved_of);
        let compared = moved.clone().filter(|(weight, _)| *weight > 0.0).count();
        if compared < tuning::FEWEST_CELLS || (compared as f64) < tuning::LEAST_SHARE * known.len() as f64 {
            return None;
        }
        let motion = self.motion_of_outline(moved_of);
        let (model, k) = (self.belief.model, self.belief.parameter_count());
        let scale = self.belief.scale();
        let left = self.map.cells().iter().zip(moved).filter(|(_, (weight, _))| *weight > 0.0);
        let left = left.map(|(cell, (weight, moved))| {
            let along = model.normal_velocities(&cell.centre, &cell.normal);
            (weight, scale * (moved - (0..k).map(|j| along[j] * motion[j]).sum::<f64>()).abs())
        });
        let mut robust = |size: fn(f64, f64) -> f64| {
            values.clear();
            values.extend(left.clone().map(|(weight, left)| size(weight, left)));
            MEDIAN_TO_DEVIATION * median(values).unwrap_or(0.0)
        };
        let (size, in_deviations) =
            (robust(|_, left| left), robust(|weight, left| left * weight.sqrt()) / self.noise.sigma);
        (size > tuning::LEAST * self.noise.sigma && in_deviations > tuning::SIGNIFICANT).then_some(size)
    }
}

impl EarlyShape {
    /// Makes room for so many cells, so that the frame that is kept needs none.
    pub(super) fn reserve(&mut self, cells: usize) {
        let Self { offsets, information, .. } = self;
        offsets.reserve(cells.saturating_sub(offsets.len()));
        information.reserve(cells.saturating_sub(information.len()));
    }
}

#[cfg(feature = "serde")]
impl EarlyShape {
    /// Whether it is that of a map with at most so many cells, and all its numbers are finite.
    pub(super) fn is_valid(&self, cells: usize) -> bool {
        let numbers = self.offsets.iter().chain(&self.information).chain([&self.largest]);
        self.offsets.len() == self.information.len()
            && self.offsets.len() <= cells
            && numbers.into_iter().all(|n| n.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{
        drawn_curves::{lobed, outline, polar},
        track::Comparison,
        update::Gate,
    };

    /// A body that turns, seen after a stretch along x in the picture by `1 + stretch` times the number of the frame; and with noise.
    fn change_of(stretch: f64) -> Option<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut buffers = Frame::default();
        let mut track: Option<Track> = None;
        for frame in 0..40 {
            let elapsed = f64::from(frame) / 30.0;
            let outline = outline(400, |t| {
                let r = lobed(t, &[(3.0, [0.25, 0.0]), (2.0, [0.0, 0.15])]) + rng.random_range(-0.01..0.01);
                let p = polar(r, t + elapsed);
                Point2::new(p.x * (1.0 + stretch * f64::from(frame)), p.y)
            });
            match &mut track {
                None => track = Track::begin(MotionModel::Rigid, &outline, 0.0, &mut buffers),
                Some(track) => {
                    assert!(track.predict(1.0 / 30.0));
                    buffers.load(&outline, track.reference());
                    let gate = Gate { smallest_agreement: 0.5, largest_innovation: None, largest_noise: None };
                    assert!(track.update(&mut buffers, &gate, Comparison::NotAsked).is_accepted(), "{frame}");
                }
            }
        }
        track.expect("frames").change_of_shape()
    }

    #[test]
    fn a_rigid_body_has_not_changed_its_shape() {
        assert_eq!(change_of(0.0), None);
    }

    #[test]
    fn an_outline_that_is_stretched_slowly_has_changed_by_about_as_much() {
        // A fifth in all after the first frames: points are moved by up to that, half of it as a mean, and no turn or shift takes it off.
        let size = change_of(0.005).expect("a change");
        assert!((0.03..0.2).contains(&size), "{size}");
    }
}
