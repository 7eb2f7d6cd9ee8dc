"""Planes that a camera looks at from aside."""

import numpy as np

import freeform_motion as ff

#: From the plane to a picture that it is seen in from aside.
PICTURE = np.array([[900.0, 40.0, 320.0], [-30.0, 700.0, 240.0], [0.05, 0.2, 1.0]])
CORNERS = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def seen(points):
    moved = np.column_stack([points, np.ones(len(points))]) @ PICTURE.T
    return moved[:, :2] / moved[:, 2:]


def test_a_homography_takes_points_to_points():
    found = ff.homography(seen(CORNERS), CORNERS) @ PICTURE
    np.testing.assert_allclose(found / found[2, 2], np.eye(3), atol=1e-9)


def test_a_rigid_motion_in_the_plane_keeps_its_parameters(bird):
    table = ff.outline_table(("bird", f.index, f.time, ff.Outline(seen(f.outline.points))) for f in bird)
    found = ff.identify(table, rectify=ff.homography(seen(CORNERS), CORNERS))["bird"].estimate
    straight = ff.identify(ff.outline_table(bird))[0].estimate
    np.testing.assert_allclose(found.values, straight.values, atol=1e-6)
    np.testing.assert_allclose(found.std, straight.std, rtol=1e-4)


def test_a_tracker_that_rectifies_goes_on_where_it_was(bird):
    tracker = ff.Tracker(rectify=ff.homography(seen(CORNERS), CORNERS))
    for frame in bird:
        tracker = ff.Tracker.from_bytes(tracker.to_bytes())
        observation = tracker.push("bird", frame.index, frame.time, seen(frame.outline.points))
        assert observation.is_accepted and observation.segment == 0
    assert abs(tracker.results()[0].estimate["omega"].value - 1.5) < 0.01


def test_an_outline_beyond_the_horizon_is_rejected_with_the_reason(bird):
    tracker = ff.Tracker(rectify=ff.homography(seen(CORNERS), CORNERS))
    assert "horizon" in tracker.push("bird", 0, 0.0, 1e5 * bird[0].outline.points).rejection
