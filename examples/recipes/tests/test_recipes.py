"""The recipes, as far as they can be tested without a screen and without ROS."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import freeform_motion as ff

RECIPES = Path(__file__).parents[1]
sys.path.insert(0, str(RECIPES))


def test_rerun_gets_outlines_and_bands_of_every_parameter(tmp_path, monkeypatch):
    pytest.importorskip("rerun")
    chunk = pytest.importorskip("rerun.chunk", reason="this version of rerun cannot read its files")
    import rerun_view

    path = tmp_path / "motion.rrd"
    monkeypatch.setattr(sys, "argv", ["rerun_view.py", str(path)])
    rerun_view.main()
    rows = {}
    for piece in chunk.RrdReader(path).stream():
        rows.setdefault(str(piece.entity_path), []).extend(piece.to_record_batch().to_pylist())
    assert {"/outline/seen", "/outline/known", "/motion/omega", "/motion/b1", "/motion/b2"} <= set(rows)
    frames = list(ff.simulate("glider", omega=1.0, seconds=3.0))
    seen = {row["frame"]: row["LineStrips2D:strips"] for row in rows["/outline/seen"]}
    points = frames[7].outline.points
    assert len(seen) == len(frames)
    assert np.allclose(seen[7][0], np.vstack([points, points[:1]]), atol=1e-6)
    known = sorted((row["frame"], row["Scalars:scalars"]) for row in rows["/motion/omega"])
    assert len(known) > len(frames) - 5
    low, omega, high = known[-1][1]
    assert low < omega < high and omega == pytest.approx(1.0, abs=0.02)


def test_tracks_of_napari_are_sorted_and_lie_on_their_masks():
    import napari_tracks

    masks = ff.simulate("glider", omega=1.0, seconds=1.0).masks()
    both = np.concatenate([masks, np.where(masks > 0, 2, 0).astype(masks.dtype)], axis=2)
    data, properties = napari_tracks.tracks_of(both, fps=30)
    assert data.shape[1] == 4 and set(data[:, 0]) == {0.0, 1.0}
    assert (np.lexsort([data[:, 1], data[:, 0]]) == np.arange(len(data))).all()
    assert len(data) > 1.8 * len(masks)
    for (_, frame, row, column), label in zip(data[::7], properties["label"][::7], strict=True):
        assert both[int(frame), round(row), round(column)] == label
    assert all(len(values) == len(data) for values in properties.values())
    last = properties["omega"][data[:, 1] == len(masks) - 1]
    assert np.allclose(last, -1.0, atol=0.02)  # y runs down


def test_napari_takes_the_tracks():
    layers = pytest.importorskip("napari.layers")
    import napari_tracks

    data, properties = napari_tracks.tracks_of(ff.simulate("glider", omega=1.0, seconds=1.0).masks(), fps=30)
    layer = layers.Tracks(data, properties=properties, color_by="omega")
    assert np.array_equal(layer.data, data)


def followed(shape, seconds=1.0, **settings):
    motion_filter = ff.MotionFilter(**settings)
    simulation = ff.simulate(shape, omega=1.5, b=(0.2, -0.1), seconds=seconds)
    for frame in simulation:
        motion_filter.step(frame.time, frame.outline)
    return motion_filter, simulation


@pytest.mark.parametrize("settings", [{}, {"edge_uncertainty": 0.02}, {"process_noise": (0.1, 0.1)}])
def test_the_twist_of_ros_has_its_units_signs_and_covariance(settings):
    import ros_node

    motion_filter, _ = followed("bird", **settings)
    twist, covariance = ros_node.twist_of(motion_filter, units_per_metre=10.0)
    velocity, omega = motion_filter.velocity, motion_filter.estimate["omega"]
    assert np.allclose(twist, [*(velocity.velocity / 10.0), 0.0, 0.0, 0.0, -omega.value], rtol=1e-12)
    # Found by propagation, the covariance agrees with what the filter says of velocity and omega.
    assert np.allclose(covariance[:2, :2], velocity.covariance / 100.0, rtol=1e-9)
    assert covariance[5, 5] == pytest.approx(omega.std**2, rel=1e-9)
    assert np.allclose(covariance, covariance.T, rtol=1e-9)
    known = covariance[np.ix_([0, 1, 5], [0, 1, 5])]
    assert np.linalg.eigvalsh(known).min() > 0.0 and not covariance[2:5].any()


def test_correlation_of_velocity_and_turn_is_that_of_many_simulations():
    import ros_node

    found = []
    for seed in range(120):
        motion_filter = ff.MotionFilter()
        for frame in ff.simulate("boomerang", omega=1.5, b=(0.6, -0.4), seconds=1.0, points=60, noise=0.01, seed=seed):
            motion_filter.step(frame.time, frame.outline)
        twist, covariance = ros_node.twist_of(motion_filter, units_per_metre=1.0)
        found.append([twist[0], twist[1], twist[5]])
    spread = np.corrcoef(np.array(found).T)
    deviations = np.sqrt(np.diag(covariance)[[0, 1, 5]])
    stated = covariance[np.ix_([0, 1, 5], [0, 1, 5])] / np.outer(deviations, deviations)
    assert np.abs(stated[:2, 2]).max() > 0.6, "a correlation whose sign can be seen"
    assert np.abs(spread - stated).max() < 0.3


def test_a_turn_that_outlines_do_not_show_has_a_large_variance_in_ros():
    import ros_node

    motion_filter, _ = followed("circle")
    twist, covariance = ros_node.twist_of(motion_filter, units_per_metre=1.0)
    assert twist[5] == 0.0 and covariance[5, 5] == ros_node.UNKNOWN
    assert np.allclose(twist[:2], motion_filter.velocity.velocity)
    assert ros_node.twist_of(ff.MotionFilter(), 1.0) is None


def test_messages_of_ros_are_filled_and_read_as_their_definitions_say():
    import ros_node

    # Stand-ins with the fields of the message definitions; ROS is not on the package index.
    def vector():
        return SimpleNamespace(x=0.0, y=0.0, z=0.0)

    twist = SimpleNamespace(linear=vector(), angular=vector())
    message = SimpleNamespace(header=None, twist=SimpleNamespace(twist=twist, covariance=[0.0] * 36))
    covariance = np.arange(36.0).reshape(6, 6)
    filled = ros_node.fill(message, "header", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], covariance)
    assert filled.header == "header"
    assert (twist.linear.y, twist.angular.z) == (2.0, 6.0)
    assert message.twist.covariance[11] == covariance[1, 5] and len(message.twist.covariance) == 36
    polygon = SimpleNamespace(points=[SimpleNamespace(x=1.0, y=2.0, z=0.0), SimpleNamespace(x=3.0, y=4.0, z=0.0)])
    assert ros_node.points_of(polygon).tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert ros_node.seconds_of(SimpleNamespace(sec=3, nanosec=250_000_000)) == 3.25
