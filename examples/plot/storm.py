# SPDX-License-Identifier: MIT
"""Picture of storm_slope: python3 storm.py [folder with the results] [folder for the picture].

Needs matplotlib. Draws displacement, speed and length of the step against time, over the storm and over the
minutes around the slide.
"""

import os
import sys

import numpy as np

from slope import plt, read_csv

HOUR = 3600.0


def draw(axes, course, unit, start, first):
    """Three rows against time from `start`, in `unit` seconds."""
    time = (course["time"] - start) / unit
    axes[0].plot(time, 1e3 * course["displacement"], color="C0")
    axes[1].semilogy(time, course["speed"], color="C3", linewidth=0.7)
    axes[2].semilogy(time, course["step"], color="C2", linewidth=0.7)
    if first:
        axes[0].set_ylabel("largest displacement [mm]")
        axes[1].set_ylabel("largest speed [m/s]")
        axes[2].set_ylabel("length of the step [s]")


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    target = sys.argv[2] if len(sys.argv) > 2 else folder
    course = read_csv(os.path.join(folder, "storm_course.csv"))
    course = {key: np.asarray(value) for key, value in course.items()}
    figure, axes = plt.subplots(3, 2, figsize=(9, 7), sharex="col", sharey="row")
    figure.subplots_adjust(left=0.1, right=0.98, bottom=0.08, top=0.98, hspace=0.08, wspace=0.05)
    draw(axes[:, 0], course, HOUR, 0.0, True)
    axes[2, 0].set_xlabel("time since the rain began [h]")
    moved = np.flatnonzero(course["displacement"] > 0.01)
    if moved.size:
        start = course["time"][moved[0]]
        near = (course["time"] > start - 30) & (course["time"] < start + 60)
        draw(axes[:, 1], {key: value[near] for key, value in course.items()}, 1.0, start, False)
        axes[2, 1].set_xlabel(f"seconds from {start / HOUR:.2f} h")
        axes[2, 1].set_xlim(-30, 60)
    path = os.path.join(target, "storm.png")
    figure.savefig(path, dpi=110)
    print(path)


if __name__ == "__main__":
    main()
