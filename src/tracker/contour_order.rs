//! Whether the points of an outline follow each other along the contour.
use freeform_curve_fit::{Outline, Piece};
use freeform_outline_io::OutlineFrame;
use nalgebra::{Point2, distance};

use crate::Warning;

/// Frames of an object that are looked at.
pub(super) const FRAMES: usize = 5;

/// Points may be out of order if the line through them is longer than this many perimeters of their bounding box. Fewer than 40 points in
/// random order may have a shorter line and pass. Deep notches make a contour about as long as seven perimeters.
const LONG: f64 = 5.0;

/// They are out of order if the line is also longer than this many perimeters per point. Points in random order give 0.1 to 0.16, points
/// in order with noise of a fifth of the size of the object 0.055, and contours the less the more points they have.
const LONG_PER_POINT: f64 = 0.08;

/// As `LONG`, for outlines in which a coordinate never decreases, such as pixels listed row by row.
const LONG_IF_SORTED: f64 = 2.0;

/// Looks at the first frames of an object, whose rows should be in the order of the contour.
#[derive(Debug, Clone, Default)]
pub(super) struct ContourOrder {
    pub(super) seen: usize,
    pub(super) warning: Option<Warning>,
}

impl ContourOrder {
    /// Looks at a frame; returns the warning with the frame that first gives reason for it.
    pub(super) fn look_at(&mut self, frame: &OutlineFrame) -> Option<&Warning> {
        if self.warning.is_some() || self.seen == FRAMES {
            return None;
        }
        self.seen += 1;
        let perimeters = hops(&frame.outline)?;
        self.warning = Some(Warning::PointsOutOfOrder { frame: frame.frame, perimeters });
        self.warning()
    }

    /// What a user should know of the order, if anything.
    pub(super) fn warning(&self) -> Option<&Warning> {
        self.warning.as_ref()
    }
}

/// Length of the line through the points over the perimeter of their bounding box; `None` if they follow the contour.
fn hops(outline: &Outline) -> Option<f64> {
    let length: f64 = outline.pieces().map(|piece| way_through(&piece)).sum();
    let times = length / (2.0 * outline.bounding_box().size().sum());
    let limit = LONG.max(LONG_PER_POINT * outline.point_count() as f64);
    let is_sorted = || outline.pieces().all(|piece| piece.closed && is_sorted(piece.points));
    (times > limit || times > LONG_IF_SORTED && is_sorted()).then_some(times)
}

fn way_through(piece: &Piece) -> f64 {
    let steps = piece.points.windows(2).map(|pair| distance(&pair[0], &pair[1]));
    let closing = piece.closed.then(|| piece.points.last().zip(piece.points.first())).flatten();
    steps.chain(closing.map(|(last, first)| distance(last, first))).sum()
}

/// Whether a coordinate never falls or never rises from point to point.
fn is_sorted(points: &[Point2<f64>]) -> bool {
    (0..2).any(|axis| points.is_sorted_by_key(|point| point[axis]) || points.is_sorted_by_key(|point| -point[axis]))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use freeform_outline_io::DEFAULT_OBJECT;
    use freeform_riccati::RigidMotion;
    use freeform_sim_camera::{BuiltInShape, Camera, Occlusion, Scene, SequenceLength, Settings, Simulator};
    use rand::SeedableRng as _;
    use rand::seq::SliceRandom as _;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    const COUNTS: [usize; 4] = [20, 40, 100, 400];

    fn simulated(shape: BuiltInShape, points: usize, settings: &Settings) -> Vec<Outline> {
        let motion = RigidMotion { omega: 1.0, b1: 0.0, b2: 0.0 };
        let settings = Settings { points, length: SequenceLength::Frames(FRAMES), ..settings.clone() };
        let simulator = Simulator::new(Scene::new(shape.shape(), motion, Camera::default()), settings);
        simulator.expect("settings that can be simulated").frames().map(|frame| frame.outline).collect()
    }

    /// A star with notches to a fifth of its radius, with so many points on it.
    fn star(spikes: usize, points: usize) -> Outline {
        let corner = |index: usize| {
            let (angle, radius) = (PI * index as f64 / spikes as f64, if index.is_multiple_of(2) { 1.0 } else { 0.2 });
            Point2::new(radius * angle.cos(), radius * angle.sin())
        };
        let on_edges = (0..points).map(|index| {
            let along = (2 * spikes * index) as f64 / points as f64;
            let (edge, share) = (along as usize, along.fract());
            corner(edge) + share * (corner(edge + 1) - corner(edge))
        });
        Outline::closed(on_edges.collect()).expect("a star")
    }

    fn reordered(outline: &Outline, reorder: impl FnOnce(&mut Vec<Point2<f64>>)) -> Outline {
        let mut points: Vec<_> = outline.points().copied().collect();
        reorder(&mut points);
        Outline::closed(points).expect("the same points")
    }

    #[test]
    fn no_outline_whose_points_follow_the_contour_hops() {
        let disturbances = [
            Settings { noise: 0.0, ..Settings::default() },
            Settings { outliers: 0.05, ..Settings::default() },
            Settings { noise: 0.05, outliers: 0.05, ..Settings::default() },
            Settings { noise: 0.15, ..Settings::default() },
            Settings { occlusion: Occlusion { fraction: 0.3, ..Occlusion::default() }, ..Settings::default() },
        ];
        for (shape, points) in BuiltInShape::ALL.iter().flat_map(|shape| COUNTS.map(|points| (*shape, points))) {
            for settings in &disturbances {
                for outline in simulated(shape, points, settings) {
                    assert_eq!(hops(&outline), None, "{} with {points} points, {settings:?}", shape.name());
                }
            }
        }
        for (spikes, points) in [(5, 20), (10, 40), (20, 100), (40, 400), (40, 4000)] {
            assert_eq!(hops(&star(spikes, points)), None, "{spikes} spikes, {points} points");
        }
    }

    #[test]
    fn points_in_any_order_or_sorted_by_a_coordinate_hop() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let shapes = BuiltInShape::ALL.map(|shape| simulated(shape, 400, &Settings::default()).remove(0));
        for outline in shapes.iter().chain(&[star(5, 100), star(20, 400)]) {
            let shuffled = reordered(outline, |points| points.shuffle(&mut random));
            assert!(hops(&shuffled).is_some_and(|times| times > LONG));
            for axis in 0..2 {
                let rising = reordered(outline, |points| points.sort_by(|p, q| p[axis].total_cmp(&q[axis])));
                let falling = reordered(&rising, |points| points.reverse());
                assert!(hops(&rising).is_some() && hops(&falling).is_some());
            }
        }
    }

    #[test]
    fn points_out_of_order_are_told_once_and_of_the_first_frames_alone() {
        let in_order = star(5, 100);
        let shuffled = reordered(&in_order, |points| points.shuffle(&mut ChaCha8Rng::seed_from_u64(1)));
        let frame = |frame: u64, outline: &Outline| OutlineFrame {
            frame,
            time: frame as f64,
            object: DEFAULT_OBJECT.to_owned(),
            outline: outline.clone(),
        };
        let mut order = ContourOrder::default();
        assert_eq!(order.look_at(&frame(0, &in_order)), None);
        assert!(
            order.look_at(&frame(7, &shuffled)).is_some_and(|warning| warning.to_string().starts_with("frame 7: "))
        );
        assert_eq!(order.look_at(&frame(8, &shuffled)), None);
        assert!(order.warning().is_some_and(|warning| warning.to_string().starts_with("frame 7: ")));

        let mut order = ContourOrder::default();
        (0..FRAMES as u64).for_each(|k| assert_eq!(order.look_at(&frame(k, &in_order)), None));
        assert_eq!(order.look_at(&frame(99, &shuffled)), None);
    }
}
