"""Curves, lines and the paper's method."""

import numpy as np
import pytest

import freeform_motion as ff


def turn(angle, shift=(0.0, 0.0)):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, shift[0]], [-s, c, shift[1]], [0, 0, 1]])


def test_a_fit_is_negative_inside_and_zero_near_the_outline(bird):
    outline = ff.Outline(bird.true_outline())
    fit = ff.fit(outline, degree=6)
    assert fit.is_bounded and fit.boundedness_margin > 0 and fit.residual < 0.05
    values = fit.polynomial.evaluate([outline.centroid, [5, 5]])
    assert values[0] < 0 < values[1]
    np.testing.assert_allclose(fit.centre, outline.centroid)
    np.testing.assert_allclose(fit.radius, outline.rms_radius)
    working = (outline.points - fit.centre) / fit.radius
    np.testing.assert_allclose(fit.working.evaluate(working), fit.polynomial.evaluate(outline.points), atol=1e-6)
    assert all(part.shape[1] == 2 for part in fit.curve())


def test_the_gradient_is_that_of_the_values():
    polynomial = ff.ImplicitPolynomial(2, [-1, 0.5, 0, 1, 0.2, 2])
    p, step = np.array([0.3, -0.7]), 1e-6
    values = polynomial.evaluate([p + [step, 0], p - [step, 0], p + [0, step], p - [0, step]])
    expected = [(values[0] - values[1]) / (2 * step), (values[2] - values[3]) / (2 * step)]
    np.testing.assert_allclose(polynomial.gradient([p])[0], expected, rtol=1e-8)


def test_lines_multiply_out_to_the_polynomial_and_related_points_move_with_it():
    coefficients = [-1, 0.2, 0, -0.2, 0.5, 0, 0, 1, 0.5, 0, 2, 0, 5, 0, 2]
    polynomial = ff.ImplicitPolynomial(4, coefficients)
    lines = ff.Decomposition(polynomial)
    np.testing.assert_allclose(lines.expand().coefficients, coefficients, atol=1e-12)
    assert lines.lines().shape == (4, 2) and lines.lines(2).shape == (2, 2) and lines.lines(3).shape == (0, 2)
    assert lines.conjugate_pairs().shape == (2, 2) and (lines.conjugate_pairs()[:, 0].imag > 0).all()
    np.testing.assert_allclose(lines.alpha, lines.coefficients[1] / lines.coefficients[0])
    np.testing.assert_allclose(lines.beta, lines.coefficients[2] / lines.coefficients[0])
    matrix = turn(0.1, (0.05, 0.02))
    moved = ff.Decomposition(polynomial.moved(matrix))
    points = np.column_stack([lines.related_points, np.ones(3)]) @ matrix.T
    order = ff.Correspondence(lines, moved, 1.0)
    assert order.agrees and sorted(order.permutation.tolist()) == [0, 1]
    np.testing.assert_allclose(moved.related_points[:2][order.permutation], points[:2, :2], atol=1e-9)
    np.testing.assert_allclose(moved.invariants, lines.invariants, atol=1e-9)
    np.testing.assert_allclose(lines.moved(matrix).expand().coefficients, polynomial.moved(matrix).coefficients, atol=1e-9)


def test_a_circle_has_no_lines_of_its_own():
    with pytest.raises(ValueError, match="circular|direction"):
        ff.Decomposition(ff.ImplicitPolynomial(4, [-1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 2, 0, 1]))


def test_the_papers_method_finds_the_motion():
    pipeline = ff.Pipeline(law="filtered")
    simulation = ff.simulate("bird", omega=1.5, b=(-0.3, 0.4), seconds=5.0, noise=0.001)
    for frame in simulation:
        pipeline.push(frame.time, frame.outline)
    estimate = pipeline.estimate
    assert abs(estimate["omega"].value - 1.5) < 0.1 and estimate["omega"].std is None
    assert np.isnan(estimate.std).all() and estimate.covariance is None
    assert pipeline.frames == 150 and pipeline.frames_rejected == 0


def test_the_identifier_finds_the_motion_from_lines():
    start = np.array([[0.2 + 0.9j, -0.1 + 0.3j], [-0.6 + 1.2j, 0.4 - 0.2j]])
    identifier = ff.AdaptiveIdentifier(law="filtered")
    for frame in range(200):
        time = frame / 100
        # A line is a covector: it moves with the inverse of the map of the points.
        moved = np.column_stack([np.ones(2), start]) @ np.linalg.inv(turn(0.5 * time))
        identifier.step(time, moved[:, 1:] / moved[:, :1])
    assert identifier.frames == 200 and identifier.is_observable
    assert abs(identifier.estimate["omega"].value - 0.5) < 0.01


def test_the_bound_is_near_the_deviations_of_the_filter(bird):
    bound = ff.CramerRaoBound("rigid", [1.5, 0.2, -0.1])
    for frame in bird:
        exact = ff.Outline(bird.true_outline(frame.time))
        bound.add_frame(frame.time, exact.points, exact.normals(), noise=0.005)
    motion_filter = ff.MotionFilter()
    for frame in bird:
        motion_filter.step(frame.time, frame.outline)
    ratio = motion_filter.estimate.std / bound.std
    assert (ratio > 0.8).all() and (ratio < 3.0).all(), ratio
    np.testing.assert_allclose(np.sqrt(np.diag(bound.covariance)), bound.std)
    assert bound.observable.all()


def test_the_bound_of_a_circle_knows_that_its_turn_cannot_be_seen():
    bound = ff.CramerRaoBound("rigid", [1.0, 0.0, 0.0])
    angles = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    for frame in range(10):
        bound.add_frame(frame / 10, normals, normals, 0.01, weight=2.0)
    assert not bound.observable[0] and np.isnan(bound.std[0])
    with pytest.raises(ValueError, match="100 points and 99 normals"):
        bound.add_frame(1.0, normals, normals[1:], 0.01)
    with pytest.raises(ValueError, match="noise of 0"):
        bound.add_frame(1.0, normals, normals, 0.0)
