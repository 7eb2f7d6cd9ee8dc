# %% [markdown]
# # A stream that is interrupted and goes on
#
# A filter keeps all that it knows in constant memory, and `to_bytes` saves it. A filter restored from the bytes goes on with the same results
# to the last bit: in another process, on another machine with a processor of the same kind, on another day. This notebook interrupts a
# stream and compares the results with those of a stream without an interruption.

# %%
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np

import freeform_motion as ff

OMEGA = 1.5
frames = [(frame.time, frame.outline.points) for frame in ff.simulate("bird", omega=OMEGA, b=(0.2, -0.1), seconds=4.0)]


def follow(motion_filter, frames):
    """What is known of omega after each frame."""
    known = []
    for time, points in frames:
        motion_filter.step(time, points)
        estimate = motion_filter.estimate
        known.append((np.nan, np.nan) if estimate is None else (estimate.values[0], estimate.std[0]))
    return np.array(known)


# %% [markdown]
# First without an interruption:

# %%
straight = ff.MotionFilter()
expected = follow(straight, frames)
print(straight.estimate["omega"])

# %% [markdown]
# Now the same with an interruption after 45 frames. The state is saved to a file. A new process, which knows nothing else, takes the
# rest of the frames and saves its own state.

# %%
HALT = 45
folder = Path(tempfile.mkdtemp())
interrupted = ff.MotionFilter()
before = follow(interrupted, frames[:HALT])
(folder / "state").write_bytes(interrupted.to_bytes())
np.savez(folder / "rest.npz", times=[time for time, _ in frames[HALT:]], points=np.stack([points for _, points in frames[HALT:]]))
del interrupted

PROGRAM = """
import sys
from pathlib import Path
import numpy as np
import freeform_motion as ff

folder = Path(sys.argv[1])
motion_filter = ff.MotionFilter.from_bytes((folder / "state").read_bytes())
rest = np.load(folder / "rest.npz")
known = []
for time, points in zip(rest["times"], rest["points"]):
    motion_filter.step(time, points)
    known.append((motion_filter.estimate.values[0], motion_filter.estimate.std[0]))
np.save(folder / "known.npy", known)
(folder / "state").write_bytes(motion_filter.to_bytes())
"""
subprocess.run([sys.executable, "-c", PROGRAM, str(folder)], check=True)
after = np.load(folder / "known.npy")
resumed = np.vstack([before, after])
print("values and deviations equal to the last bit:", np.array_equal(resumed, expected, equal_nan=True))
print("states at the end equal to the last bit:", (folder / "state").read_bytes() == straight.to_bytes())
assert np.array_equal(resumed, expected, equal_nan=True) and (folder / "state").read_bytes() == straight.to_bytes()

# %% [markdown]
# A filter that began anew after the interruption would have to learn the outline and the motion again. It is drawn too, for comparison:

# %%
anew = follow(ff.MotionFilter(), frames[HALT:])
times = np.array([time for time, _ in frames])

figure, axes = plt.subplots(figsize=(9, 3.4), layout="constrained")
for time, known, label in ((times, resumed, "resumed"), (times[HALT:], anew, "begun anew")):
    (line,) = axes.plot(time, known[:, 0], label=label)
    axes.fill_between(time, known[:, 0] - 2 * known[:, 1], known[:, 0] + 2 * known[:, 1], color=line.get_color(), alpha=0.25, lw=0)
axes.axhline(OMEGA, color="black", lw=0.8)
axes.axvline(times[HALT] - 0.5 / 30, color="black", ls=":", lw=1, label="interruption")
axes.set(xlabel="time in s", ylabel="omega in rad/s", ylim=(OMEGA - 0.05, OMEGA + 0.05))
axes.legend()
plt.show()

# %% [markdown]
# ## Many objects, size and time
#
# A `Tracker` holds the filters of many objects. Pickling uses the same bytes, so you can send trackers through queues and process pools, and
# keep them in the states of stream engines. The state does not grow with the number of frames.

# %%
tracker = ff.Tracker()
sizes = []
for number, (time, points) in enumerate(frames):
    for name, shift in (("left", -2.0), ("right", 2.0)):
        tracker.push(name, number, time, points + [shift, 0.0])
    sizes.append(len(tracker.to_bytes()))
    if number % 30 == 29:
        tracker = pickle.loads(pickle.dumps(tracker))
for result in tracker.results():
    print(result.object, result.estimate["omega"])

state = straight.to_bytes()
began = perf_counter()
for _ in range(20):
    ff.MotionFilter.from_bytes(state)
restored = (perf_counter() - began) / 20

figure, axes = plt.subplots(figsize=(6, 2.6), layout="constrained")
axes.plot(times, np.array(sizes) / 1e3 / 2)
axes.set(xlabel="time in s", ylabel="kB for each object", ylim=(0, None))
plt.show()
print(f"one filter: {len(state) / 1e3:.0f} kB, restored in {1e3 * restored:.1f} ms")
assert max(sizes[60:]) < 1.2 * sizes[59]

# %% [markdown]
# ## Bytes that are refused
#
# The bytes begin with the version of their format and have a checksum. Bytes that are damaged, or were written by another version, are
# refused, and the error says why. A state is never restored in part.

# %%
for what, data in (
    ("cut off", state[:1000]),
    ("changed", state[:5000] + b"\x00\x01\x02" + state[5003:]),
    ("another version", bytes([state[0] + 1]) + state[1:]),
    ("a tracker", tracker.to_bytes()),
):
    try:
        ff.MotionFilter.from_bytes(data)
    except ValueError as error:
        print(f"{what}: {error}")
    else:
        raise AssertionError(what)
