"""Outlines as values."""

import pickle

import numpy as np

import freeform_motion as ff

SQUARE = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])


def test_an_outline_knows_its_geometry():
    outline = ff.Outline(SQUARE)
    assert outline.is_closed and len(outline) == 4 and outline.signed_area == 4.0
    np.testing.assert_array_equal(outline.points, SQUARE)
    np.testing.assert_array_equal(outline.centroid, [1, 1])
    assert outline.rms_radius == np.sqrt(2)
    shift = np.array([[1, 0, 5], [0, 1, -3], [0, 0, 1]])
    np.testing.assert_array_equal(outline.moved(shift).points, SQUARE + [5, -3])
    assert ff.Outline(SQUARE) == outline != ff.Outline(SQUARE + 1)


def test_a_repeated_last_point_is_dropped():
    assert ff.Outline([*SQUARE, SQUARE[0]]) == ff.Outline(SQUARE)


def test_arcs_are_turned_the_same_way_round():
    lower, upper = SQUARE[:2], SQUARE[2:]
    outline = ff.Outline.from_arcs([lower, upper[::-1]])
    assert not outline.is_closed and len(outline.pieces) == 2
    np.testing.assert_array_equal(outline.points, SQUARE)
    assert "2 open arc(s)" in repr(outline)


def test_normals_point_outwards():
    angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    for points in circle, circle[::-1]:
        np.testing.assert_allclose(ff.Outline(points).normals(), points, atol=1e-2)


def test_outlines_can_be_pickled():
    for outline in ff.Outline(SQUARE), ff.Outline.from_arcs([SQUARE[:2], SQUARE[2:]]):
        again = pickle.loads(pickle.dumps(outline))
        assert again == outline and again.is_closed == outline.is_closed
    hole = [[0.25, 0.25], [0.25, 0.75], [0.75, 0.75]]
    body = ff.Outline._from_pieces([np.asarray(SQUARE, dtype=float), np.asarray(hole)], True)
    again = pickle.loads(pickle.dumps(body))
    assert again == body and [len(piece) for piece in again.pieces] == [len(SQUARE), 3]


def test_outlines_become_a_table_and_come_back():
    outlines = [("a", 0, 0.0, ff.Outline(SQUARE)), ("b", 0, 0.0, ff.Outline.from_arcs([SQUARE[:2], SQUARE[2:]]))]
    table = ff.outline_table(outlines)
    assert table["object"].tolist() == ["a"] * 4 + ["b"] * 4
    assert table["arc"].tolist() == [-1] * 4 + [0, 0, 1, 1]
    assert all(len(column) == 0 for column in ff.outline_table([]).values())
