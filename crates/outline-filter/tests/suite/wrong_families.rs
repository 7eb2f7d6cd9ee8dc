//! What the motion model leaves out, beside what the edges may do.
use crate::filter_support::{frames_of, settings};
use freeform_curve_fit::Outline;
use freeform_outline_filter::{FilterSettings, MotionFilter, WrongFamily};
use freeform_riccati::RigidMotion;
use freeform_sim_camera::BuiltInShape;
use nalgebra::Point2;

#[test]
fn growth_is_told_where_it_moves_points_by_more_than_the_edges_may_lie_off() {
    let motion = RigidMotion { omega: 1.5, b1: -0.3, b2: 0.4 };
    let mut frames = frames_of(BuiltInShape::Bird, motion, settings(60, 3));
    for frame in &mut frames {
        let grown = frame.outline.points().map(|p| Point2::from((1.0 + 0.02 * frame.time) * p.coords));
        frame.outline = Outline::closed(grown.collect()).expect("an outline");
    }
    // The outline that is learnt follows the growth, so that a part of it is seen in a frame.
    let told = [0.0, 2e-4, 0.05].map(|edge_uncertainty| {
        let mut filter =
            MotionFilter::new(FilterSettings { edge_uncertainty, ..FilterSettings::default() }).expect("settings");
        for frame in &frames {
            filter.step(frame.time, &frame.outline).expect("an outline");
        }
        filter.wrong_family()
    });
    assert_eq!(told, [Some(WrongFamily::Growth), Some(WrongFamily::Growth), None]);
}
