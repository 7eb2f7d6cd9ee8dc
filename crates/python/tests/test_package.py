"""The package as a whole."""

import doctest
import importlib
import pkgutil
import subprocess
import sys

import numpy as np
import pytest

import freeform_motion as ff


def test_examples_in_docstrings_hold():
    for name in ["freeform_motion", *(f"freeform_motion.{m.name}" for m in pkgutil.iter_modules(ff.__path__))]:
        module = importlib.import_module(name)
        failed, _ = doctest.testmod(module)
        assert failed == 0, name
    runner, finder = doctest.DocTestRunner(), doctest.DocTestFinder()
    tests = [test for name in ff.__all__ for test in finder.find(getattr(ff, name), name) if test.examples]
    assert len(tests) >= 4
    for test in tests:
        assert runner.run(test).failed == 0, test.name


def test_everything_public_has_a_docstring():
    for name in ff.__all__:
        public = getattr(ff, name)
        assert public.__doc__, name
        if isinstance(public, type):
            for member in vars(public):
                if not member.startswith("_"):
                    assert getattr(public, member).__doc__, f"{name}.{member}"


def test_the_version_is_that_of_the_package():
    assert ff.__version__.count(".") == 2


@pytest.mark.parametrize("missing", ["matplotlib", "tqdm", "pandas", "polars", "pyarrow"])
def test_what_is_optional_is_not_needed(missing):
    program = f"""
import sys
sys.modules[{missing!r}] = None
import freeform_motion as ff
masks = ff.simulate("bird", seconds=0.2).masks()
assert len(ff.identify(masks, fps=30)) == 1
assert len(ff.track(ff.outline_table(ff.simulate("bird", seconds=0.2)))["omega"]) == 6
"""
    subprocess.run([sys.executable, "-c", program], check=True)


def test_importing_does_not_import_what_is_optional():
    program = "import sys, freeform_motion; print([m for m in ('matplotlib', 'tqdm', 'pandas', 'polars', 'pyarrow') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", program], check=True, capture_output=True).stdout.strip() == b"[]"


def test_plots_show_outlines_and_parameters(masks, bird):
    import matplotlib.pyplot as plt

    axes = ff.plot(bird[0].outline)
    assert len(axes.lines) == 1
    tracked = ff.track(masks, fps=30)
    _, axes = plt.subplots()
    assert ff.plot(tracked, parameters=["omega", "b1"], ax=axes) is axes
    assert len(axes.lines) == 2 and len(axes.collections) == 2
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), tracked["omega"])
    with pytest.raises(ValueError, match="'2' is none of 1"):
        ff.plot(tracked, objects=["2"])
    plt.close("all")


def test_an_interrupt_ends_a_long_call():
    program = """
import signal, threading, time
import freeform_motion as ff
table = ff.outline_table(ff.simulate("bird", seconds=60.0))
threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
started = time.monotonic()
try:
    for _ in range(1000):
        ff.identify(table, progress=False)
except KeyboardInterrupt:
    print("interrupted", time.monotonic() - started < 5)
"""
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, timeout=60)
    assert done.stdout.strip() == b"interrupted True"
