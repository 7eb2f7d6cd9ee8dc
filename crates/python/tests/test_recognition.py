"""Which known outline an object has."""

import numpy as np
import pytest

import freeform_motion as ff

NAMES = ("plane", "phone", "hat", "bird")
MAP = np.array([[0.9, 0.5, 3.0], [-0.3, 1.2, 1.0], [0, 0, 1]])


@pytest.fixture(scope="module")
def known():
    return {name: ff.Outline(ff.simulate(name).true_outline()) for name in NAMES}


@pytest.fixture(scope="module")
def recogniser(known):
    learnt = ff.Recogniser()
    for name, outline in known.items():
        learnt.learn(name, outline)
    return learnt


@pytest.mark.parametrize("name", NAMES)
def test_a_known_outline_is_recognised_under_an_affine_map(recogniser, known, name):
    recognition = recogniser.recognise(known[name].moved(MAP))
    assert recognition.name == name and recognition.probability > 0.99
    np.testing.assert_allclose(recognition.map, MAP, atol=0.02)
    names, probabilities = zip(*recognition.candidates, strict=True)
    assert names[0] == name and sorted(names) == sorted(NAMES)
    assert probabilities[0] == recognition.probability and list(probabilities) == sorted(probabilities, reverse=True)


def test_an_unknown_outline_is_none_of_them(recogniser):
    recognition = recogniser.recognise(ff.simulate("van").true_outline())
    assert recognition.name is None and recognition.map is None and recognition.probability > 0.5
    assert "none of them" in repr(recognition)


def test_frames_that_cannot_be_compared_are_counted(recogniser, known):
    evidence = ff.Evidence(recogniser)
    assert evidence.recognition is None
    with pytest.raises(ValueError, match="a part of the outline is hidden"):
        evidence.add(ff.Outline.from_arcs([known["hat"].points[:50]]))
    evidence.add(known["hat"])
    recognition = evidence.recognition
    assert (recognition.name, recognition.frames, recognition.frames_rejected) == ("hat", 1, 1)
    assert "hidden" in recognition.first_rejection
    assert len(recogniser) == 4 and recogniser.names == list(NAMES)


def test_the_objects_of_masks_and_tables_are_recognised(known, recogniser):
    simulations = {name: ff.simulate(name, omega=1.0, seconds=0.2) for name in ("hat", "phone")}
    masks = np.concatenate([simulations["hat"].masks(), 2 * simulations["phone"].masks()], axis=2)
    found = ff.recognise(masks, known)
    assert {name: of.name for name, of in found.items()} == {"1": "hat", "2": "phone"}
    assert found["1"].frames == 6
    rows = [(name, f.index, f.time, f.outline) for name, frames in simulations.items() for f in frames]
    from_table = ff.recognise(ff.outline_table(rows), recogniser)
    assert {name: of.name for name, of in from_table.items()} == {"hat": "hat", "phone": "phone"}
    hidden = ff.outline_table(ff.simulate("hat", seconds=0.2, occlusion=0.3))
    assert ff.recognise(hidden, recogniser) == {"0": None}


def test_options_that_do_not_belong_are_refused(recogniser, bird):
    with pytest.raises(TypeError, match="unexpected arguments: motion"):
        ff.recognise(ff.outline_table(bird), recogniser, motion="rigid")
    with pytest.raises(TypeError, match="link: only for masks"):
        ff.recognise(ff.outline_table(bird), recogniser, link="labels")
    with pytest.raises(ValueError, match="encloses no region"):
        ff.recognise(ff.outline_table(bird), {"eight": [[0, 0], [1, 1], [1, 0], [0, 1]]})
