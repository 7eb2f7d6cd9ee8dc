use nalgebra::{Point2, Vector2};
use rand::{Rng, RngExt as _};
use rand_distr::{Distribution as _, StandardNormal, UnitDisc};

use super::course::direction;
use super::fields::{along_contour, between_cells, carry, of_cell};

/// One thing that is wrong with the outlines. Lengths are in sizes. What is "on one side" is so in a direction of the picture that is
/// drawn for every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// Errors of both coordinates that are smooth along the contour over so many points, and new in every frame.
    Smooth { deviation: f64, points: f64 },
    /// Errors across the contour that go along with the body: smooth over so many points (0: each point by itself), and kept from
    /// frame to frame by the share `keep`.
    Slow { deviation: f64, points: f64, keep: f64 },
    /// The whole outline is shifted, both coordinates by this deviation, and the shift is kept from frame to frame by a share.
    Shake { deviation: f64, keep: f64 },
    /// The whole outline moves in or out across the contour, kept from frame to frame by a share.
    Flicker { deviation: f64, keep: f64 },
    /// Points move outwards by `depth max(0, n.l)`: light from the side l (inwards where the depth is below 0: a shadow).
    Light { depth: f64 },
    /// A share of the points, all on one side, lies up to twice `distance` outside the contour.
    Clustered { share: f64, distance: f64 },
    /// A straight edge in the picture hides a share of the contour half way through the sequence; the outline is closed along it.
    Occluder { share: f64 },
    /// A share of the contour is hidden, somewhere else in every frame, and known to be.
    HiddenArc { share: f64 },
    /// A share of the points is moved within a radius.
    Outliers { share: f64, radius: f64 },
    /// Coordinates are rounded to a grid of so many pixels to a size.
    Rounding { pixels: f64 },
    /// A share of the frames shows another object in the same place.
    WrongFrames { share: f64 },
    /// A share of the frames is missing.
    DroppedFrames { share: f64 },
}

/// A fault and what it keeps from frame to frame.
#[derive(Debug, Clone)]
pub(super) struct FaultInTime {
    pub(super) fault: Fault,
    /// The side.
    side: Vector2<f64>,
    /// What is kept: along the contour, or of the whole outline.
    kept: Vec<f64>,
}

impl FaultInTime {
    /// The fault at the first frame of a run.
    pub(super) fn new(fault: Fault, points: usize, rng: &mut impl Rng) -> Self {
        let side = direction(rng.random());
        let kept = match fault {
            Fault::Slow { points: reach, .. } => along_contour(points, reach, rng),
            Fault::Shake { .. } | Fault::Flicker { .. } => along_contour(2, 0.0, rng),
            _ => Vec::new(),
        };
        Self { fault, side, kept }
    }

    /// Goes on to the next frame.
    pub(super) fn advance(&mut self, rng: &mut impl Rng) {
        let (reach, keep) = match self.fault {
            Fault::Slow { points, keep, .. } => (points, keep),
            Fault::Shake { keep, .. } | Fault::Flicker { keep, .. } => (0.0, keep),
            _ => return,
        };
        let fresh = along_contour(self.kept.len(), reach, rng);
        carry(&mut self.kept, keep, &fresh);
    }

    /// How far a point of the contour is off across it, with its outward normal in the picture.
    pub(super) fn across(&self, place: f64, normal: &Vector2<f64>) -> f64 {
        match self.fault {
            Fault::Slow { deviation, points, .. } if points > 0.0 => deviation * between_cells(&self.kept, place),
            Fault::Slow { deviation, .. } => deviation * of_cell(&self.kept, place),
            Fault::Flicker { deviation, .. } => deviation * self.kept[0],
            Fault::Light { depth } => depth * normal.dot(&self.side).max(0.0),
            _ => 0.0,
        }
    }

    /// The height along its side at which an edge hides its share of these points; `None` for other faults.
    pub(super) fn edge(&self, half_way: &[Point2<f64>]) -> Option<f64> {
        let Fault::Occluder { share } = self.fault else { return None };
        let mut heights: Vec<f64> = half_way.iter().map(|p| self.side.dot(&p.coords)).collect();
        heights.sort_by(f64::total_cmp);
        let visible = ((1.0 - share) * heights.len() as f64) as usize;
        heights.get(visible).copied()
    }

    /// Puts points beyond an edge at this height onto it.
    pub(super) fn close_along_edge(&self, points: &mut [Point2<f64>], edge: f64) {
        for point in points {
            *point -= (self.side.dot(&point.coords) - edge).max(0.0) * self.side;
        }
    }

    /// What happens to the points of a frame in the picture.
    pub(super) fn disturb(&self, points: &mut [Point2<f64>], rng: &mut impl Rng) {
        match self.fault {
            Fault::Smooth { deviation, points: reach } => {
                let [x, y] = [0, 1].map(|_| along_contour(points.len(), reach, rng));
                for ((point, x), y) in points.iter_mut().zip(x).zip(y) {
                    *point += deviation * Vector2::new(x, y);
                }
            }
            Fault::Shake { deviation, .. } => {
                let shift = deviation * Vector2::new(self.kept[0], self.kept[1]);
                points.iter_mut().for_each(|point| *point += shift);
            }
            Fault::Clustered { share, distance } => {
                // Twice as many as are moved lie on that side.
                let mut order: Vec<usize> = (0..points.len()).collect();
                order.sort_by(|i, j| self.side.dot(&points[*j].coords).total_cmp(&self.side.dot(&points[*i].coords)));
                for &index in order.iter().take((2.0 * share * points.len() as f64).round() as usize) {
                    let [x, y]: [f64; 2] = UnitDisc.sample(rng);
                    if rng.random::<f64>() < 0.5 {
                        points[index] += distance * (self.side + Vector2::new(x, y));
                    }
                }
            }
            Fault::Outliers { share, radius } => {
                for point in points {
                    let [x, y]: [f64; 2] = UnitDisc.sample(rng);
                    if rng.random::<f64>() < share {
                        *point += radius * Vector2::new(x, y);
                    }
                }
            }
            Fault::Rounding { pixels } => {
                points.iter_mut().for_each(|point| *point = point.map(|value| (pixels * value).round() / pixels));
            }
            Fault::Slow { .. }
            | Fault::Flicker { .. }
            | Fault::Light { .. }
            | Fault::Occluder { .. }
            | Fault::HiddenArc { .. }
            | Fault::WrongFrames { .. }
            | Fault::DroppedFrames { .. } => {}
        }
    }
}

/// Adds independent errors of both coordinates.
pub(super) fn add_noise(points: &mut [Point2<f64>], deviation: f64, rng: &mut impl Rng) {
    for point in points {
        *point += deviation * Vector2::new(rng.sample(StandardNormal), rng.sample(StandardNormal));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;

    fn circle(count: usize) -> Vec<Point2<f64>> {
        (0..count).map(|k| Point2::from(0.5 * direction(k as f64 / count as f64))).collect()
    }

    fn started(fault: Fault) -> (FaultInTime, ChaCha8Rng) {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        (FaultInTime::new(fault, 200, &mut rng), rng)
    }

    #[test]
    fn light_from_one_side_moves_the_points_of_that_side_and_no_others() {
        let (fault, _) = started(Fault::Light { depth: 0.1 });
        assert!((fault.across(0.0, &fault.side) - 0.1).abs() < 1e-12);
        assert_eq!(fault.across(0.0, &-fault.side), 0.0);
    }

    #[test]
    fn an_edge_hides_its_share_of_the_contour_and_closes_it() {
        let (fault, _) = started(Fault::Occluder { share: 0.15 });
        let mut points = circle(1000);
        let edge = fault.edge(&points).expect("an edge");
        let hidden = points.iter().filter(|p| fault.side.dot(&p.coords) > edge).count();
        assert!((149..=150).contains(&hidden), "{hidden}");
        fault.close_along_edge(&mut points, edge);
        assert!(points.iter().all(|p| fault.side.dot(&p.coords) < edge + 1e-12));
    }

    #[test]
    fn clustered_outliers_lie_on_one_side_and_are_as_many_as_asked_for() {
        let (fault, mut rng) = started(Fault::Clustered { share: 0.1, distance: 0.05 });
        let (before, mut points) = (circle(2000), circle(2000));
        fault.disturb(&mut points, &mut rng);
        let moved: Vec<_> = before.iter().zip(&points).filter(|(a, b)| a != b).collect();
        assert!((160..240).contains(&moved.len()), "{}", moved.len());
        assert!(moved.iter().all(|(a, b)| fault.side.dot(&a.coords) > 0.3 && fault.side.dot(&(*b - *a)) >= 0.0));
    }

    #[test]
    fn a_slow_field_changes_little_from_frame_to_frame() {
        let (mut fault, mut rng) = started(Fault::Slow { deviation: 0.01, points: 10.0, keep: 0.98 });
        let at = |fault: &FaultInTime, k: usize| fault.across(k as f64 / 200.0, &Vector2::zeros());
        let first: Vec<f64> = (0..200).map(|k| at(&fault, k)).collect();
        fault.advance(&mut rng);
        let size = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
        let change = size(&mut (0..200).map(|k| at(&fault, k) - first[k]));
        assert!(change > 0.0 && change < 0.4 * size(&mut first.iter().copied()), "{change}");
    }
}
