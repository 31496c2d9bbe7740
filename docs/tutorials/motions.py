# %% [markdown]
# # Motions
#
# A motion is a spline in time through poses. It is called with times, as the splines of scipy are. [Motions](../motion.md)
# explains the options.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial.transform import Rotation, RotationSpline

import batten

# %% [markdown]
# ## Rotations
#
# Rotations of scipy go in and come out. A notebook shows a strip of poses, with the angular speed below.

# %%
times = np.array([0.0, 1.0, 1.5, 3.0, 4.0])
angles = [[0, 0, 0], [60, 20, 0], [90, 40, 30], [150, 10, 60], [240, 0, 0]]
rotations = Rotation.from_euler("zyx", angles, degrees=True)
turn = batten.Motion(times, rotations)
turn

# %%
turn(0.5).as_euler("zyx", degrees=True), turn.velocity(0.5)

# %% [markdown]
# scipy's `RotationSpline` beside it, both through ten samples of a known motion. The error is the angle to that motion.

# %%
def truth(t):
    turn = [np.sin(t), np.cos(2 * t) - 1, 0.5 * t]
    return Rotation.from_rotvec(np.stack(turn, axis=-1))


keys, at = np.linspace(0, 3, 10), np.linspace(0, 3, 400)
figure, axes = plt.subplots(figsize=(8, 3.2))
for name, kind in [("scipy", RotationSpline), ("batten", batten.Motion)]:
    spline = kind(keys, truth(keys))
    errors = (spline(at).inv() * truth(at)).magnitude()
    axes.plot(at, np.degrees(errors), label=name)
axes.set(xlabel="time", ylabel="error in degrees")
axes.legend();

# %% [markdown]
# ## Poses
#
# A rigid motion has a place and a rotation: seven numbers, or a matrix of four rows. The picture shows frames of the body
# along the path. The keyframes are those of a camera that circles a table.

# %%
table = np.loadtxt("../../examples/data/camera-keyframes.csv", delimiter=",", skiprows=3)
moments = table[:, 0]
poses = batten.Space("rigid").project(table[:, 1:8])  # quaternions of six digits
camera = batten.Motion(moments, poses, space="rigid")
camera

# %% [markdown]
# Velocities are those of the translation, then the angular ones in the body's frame.

# %%
camera.velocity([0.0, 5.0]).round(3)

# %% [markdown]
# ## Noise and outliers
#
# `sigma` states the noise of the poses, or finds it: the motion passes near them. With a rule for outliers, wrong poses
# count less.

# %%
random = np.random.default_rng(1)
t = np.linspace(0, 6, 60)
noisy = np.stack([np.cos(t), np.sin(t)], axis=1) + random.normal(0, 0.02, size=(60, 2))
noisy[25] += [0.3, 0.3]
batten.Motion(t, noisy, sigma="auto", outliers="tukey")

# %% [markdown]
# ## From a recording and a gyroscope to a trajectory
#
# A file of TUM holds poses of a visual odometry, ten a second, with noise. A gyroscope measures the angular rate 200 times a
# second, with noise and an unknown bias. Both are made here from a known motion, so that the result can be judged. The body
# shakes faster than the poses tell.

# %%
def place(t):
    return np.stack([2 * np.cos(0.4 * t), 2 * np.sin(0.4 * t), 0.3 * np.sin(t)], axis=-1)


def attitude(t):
    shake = 0.05 * np.sin(40 * t)
    return Rotation.from_rotvec(np.stack([shake, 0.3 * np.sin(0.7 * t), 0.4 * t], axis=-1))


def rate(t, step=1e-4):
    return (attitude(t - step).inv() * attitude(t + step)).as_rotvec() / (2 * step)


random, bias = np.random.default_rng(7), np.array([0.02, -0.05, 0.08])
seen, felt = np.arange(0, 20, 0.1), np.arange(0, 20, 0.005)
noisy = attitude(seen) * Rotation.from_rotvec(random.normal(0, 0.02, (len(seen), 3)))
rows = np.column_stack([seen, place(seen) + random.normal(0, 0.03, (len(seen), 3)), noisy.as_quat()])
odometry = Path(tempfile.mkdtemp()) / "odometry.tum"
np.savetxt(odometry, rows, fmt="%.6f")
rates = rate(felt) + bias + random.normal(0, 0.01, (len(felt), 3))

# %% [markdown]
# The poses alone, smoothed by the noise that they tell, and both together. `bias` is what was found of the gyroscope, with
# its standard deviation.

# %%
alone = batten.Motion.read(odometry, sigma="auto")
fused = batten.Motion.read(odometry, sigma="auto", gyro=(felt, rates))
fused.noise, fused.bias

# %%
at = np.linspace(0.5, 19.3, 3000)


def turned(motion):
    return Rotation.from_quat(motion(at)[:, [4, 5, 6, 3]]).inv() * attitude(at)


figure, axes = plt.subplots(figsize=(8, 3.2))
for name, motion in [("poses alone", alone), ("with the gyroscope", fused)]:
    axes.plot(at, np.degrees(turned(motion).magnitude()), label=name, lw=0.8)
axes.set(xlabel="time", ylabel="error in degrees")
axes.legend();

# %% [markdown]
# An accelerometer beside the gyroscope tells the places between the poses. Its bias and gravity are found, too; `explained`
# is the share of the poses' accelerations that it tells. Mean errors of the places follow, in millimetres.

# %%
pull = (place(felt + 1e-3) - 2 * place(felt) + place(felt - 1e-3)) / 1e-6 + [0, 0, 9.81]
forces = attitude(felt).inv().apply(pull) + [0.1, -0.05, 0.15] + random.normal(0, 0.1, (len(felt), 3))
inertial = batten.Motion.read(odometry, sigma="auto", gyro=(felt, rates, forces))
found = inertial.accelerometer
found["bias"].round(2), found["gravity"].round(2), round(found["explained"], 3)

# %%
[float((1000 * np.linalg.norm(made(at)[:, :3] - place(at), axis=1)).mean().round(1)) for made in (fused, inertial)]

# %% [markdown]
# The stated intervals of 95 % and what they cover, for the three axes of the rotation. Errors change slowly, so one recording
# tells little: here are twenty.

# %%
covered = []
for seed in range(20):
    random = np.random.default_rng(seed)
    noisy = attitude(seen) * Rotation.from_rotvec(random.normal(0, 0.02, (len(seen), 3)))
    rates = rate(felt) + bias + random.normal(0, 0.01, (len(felt), 3))
    motion = batten.Motion(seen, noisy, gyro=(felt, rates))
    errors = (motion(at).inv() * attitude(at)).as_rotvec()
    covered.append((abs(errors) < 1.96 * motion.uncertainty(at)).mean(axis=0))
np.mean(covered, axis=0).round(2)
