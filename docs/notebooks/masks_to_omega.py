# %% [markdown]
# # From masks to angular velocity
#
# A segmentation gives a mask for each frame. This notebook finds from masks the angular velocity over time, with its standard
# deviation, and compares both with the truth.

# %%
import matplotlib.pyplot as plt
import numpy as np

import freeform_motion as ff

# %% [markdown]
# Masks are an array of shape (frames, height, width) with 0 for the ground (the background). These are simulated: a glider that turns at
# 1 rad/s and drifts, 240 x 320 pixels, 30 frames/s. A mask has no grey levels; its edge is a staircase.

# %%
OMEGA, FPS = 1.0, 30
simulation = ff.simulate("glider", omega=OMEGA, b=(0.15, 0.0), seconds=4.0)
masks = simulation.masks(240, 320)

figure, panels = plt.subplots(1, 4, figsize=(10, 2.2), layout="constrained")
for axes, frame in zip(panels, (0, 40, 80, 119), strict=True):
    axes.imshow(masks[frame], cmap="gray", extent=(0, 320, 0, 240))
    ff.plot(ff.outlines(masks[frame])[1], ax=axes)
    axes.set_title(f"{frame / FPS:.1f} s")
plt.show()

# %% [markdown]
# `identify` gives one motion for each object, from all frames. `b1` and `b2` are the velocity at the origin of the image, in pixels per second:
# the velocity that the object would have there if it reached that far. They are large because the origin, the lower left corner, is far from
# the object. `result.velocity` is the velocity of the object's middle.

# %%
result = ff.identify(masks, fps=FPS)["1"]
for name in result.estimate:
    print(result.estimate[name])
print("middle:", result.velocity.velocity.round(2), "+-", result.velocity.std.round(3), "pixels/s")
print("warnings:", [warning.code for warning in result.warnings])

# %% [markdown]
# `track` gives pose and motion after each frame: what was known at that time. The band shows two standard deviations to either
# side. It narrows with the number of frames. What is known after one frame hardly differs from what is known after the next. So omega
# stays within two deviations of the truth for many frames, or outside for many.

# %%
motion = ff.track(masks, fps=FPS)

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.2), layout="constrained")
ff.plot(motion, ax=left)
left.axhline(OMEGA, color="black", lw=0.8)
left.set(ylim=(OMEGA - 0.005, OMEGA + 0.005), ylabel="omega in rad/s")
truth = OMEGA * motion["time"]
right.plot(motion["time"], np.rad2deg(motion["angle"] - truth))
right.set(xlabel="time in s", ylabel="error of the angle in degrees")
plt.show()

apart = np.abs(motion["omega"] - OMEGA) / motion["omega_std"]
known = np.isfinite(apart)
print(f"omega within two deviations in {np.mean(apart[known] < 2):.0%} of {known.sum()} frames")
print(f"largest error of the angle: {np.rad2deg(np.nanmax(np.abs(motion['angle'] - truth))):.3f} degrees")
assert np.abs(motion["omega"][10:] - OMEGA).max() < 0.005

# %% [markdown]
# ## Are the deviations right?
#
# One recording says little about that. Here are forty, each with another motion and another ragged edge: the edge of every
# mask is moved in and out by about a pixel, smoothly along the contour. If the deviations are right, the error of omega at the end is
# smaller than two deviations in about 95 % of the recordings, and the root mean square of error over deviation is 1. It is smaller if the
# deviations are wider than they need be.

# %%
from scipy import ndimage


def ragged(masks, random, pixels=1.0, length=2.0):
    """The masks with edges that are moved in and out by so many pixels, smoothly over a length."""
    moved = []
    for mask in masks:
        noise = ndimage.gaussian_filter(random.standard_normal(mask.shape), length)
        inside = ndimage.distance_transform_edt(mask) - ndimage.distance_transform_edt(1 - mask)
        moved.append(inside + pixels * noise / noise.std() > 0)
    return np.array(moved)


random = np.random.default_rng(1)
omegas = random.uniform(-2.0, 2.0, 40)
errors, deviations = [], []
for omega in omegas:
    clean = ff.simulate("glider", omega=omega, b=(0.15, 0.0), seconds=2.0).masks(180, 240)
    estimate = ff.identify(ragged(clean, random), fps=FPS, link="largest")[0].estimate
    errors.append(estimate["omega"].value - omega)
    deviations.append(estimate["omega"].std)
errors, deviations = np.array(errors), np.array(deviations)
inside = np.mean(np.abs(errors) < 2 * deviations)

figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
order = np.argsort(omegas)
axes.errorbar(omegas[order], 1e3 * errors[order], 2e3 * deviations[order], fmt="o", ms=3, lw=1)
axes.axhline(0.0, color="black", lw=0.8)
axes.set(xlabel="true omega in rad/s", ylabel="error in 0.001 rad/s")
plt.show()
print(f"{inside:.0%} of the intervals of two deviations hold the truth; RMS error {1e3 * np.sqrt(np.mean(errors**2)):.2f}e-3 rad/s")
print(f"RMS of error over deviation: {np.sqrt(np.mean((errors / deviations) ** 2)):.2f}")
assert inside > 0.8

# %% [markdown]
# ## What outlines do not show
#
# The angular velocity of a disc cannot be seen. It is NaN in arrays and None as a value, and a warning says so. The velocity
# of the middle of the disc is known all the same. This example has the points of outlines instead of masks:

# %%
table = ff.outline_table(ff.simulate("circle", omega=1.0, b=(0.3, 0.0), seconds=2.0))
disc = ff.identify(table)[0]
print(disc.estimate["omega"], "|", [warning.code for warning in disc.warnings])
print("middle:", disc.velocity.velocity.round(3), "+-", disc.velocity.std.round(3), "lengths/s")
assert disc.estimate["omega"].value is None
