# SPDX-License-Identifier: MIT
"""Picture of water in and on rigid ground, from the VTK series of the numbered examples:
python3 water.py BASE [folder with the results] [folder for the picture]

BASE is rain_slope, reservoir_drawdown or dam_break. Needs matplotlib. Pore water is coloured by the
degree of saturation or its pressure, points of free water are drawn in orange.
"""

import os
import sys

import numpy as np

from slope import plt, read_points, read_series

FREE = "#e07b00"
SATURATION = ("saturation", 1, "degree of saturation [-]; orange: free water", (0, 1), "YlGnBu")
PRESSURE = ("liquid_pressure", 1e-3, "liquid pressure [kPa]", (-10, 10), "RdYlBu")


def panel(axis, points, time, what):
    """One state; free water has porosity 1."""
    name, factor, _, limits, colours = what
    position, values = points["Points"], factor * points[name]
    free = points["porosity"] > 0.999
    axis.set_aspect("equal")
    drawn = axis.scatter(position[~free, 0], position[~free, 1], c=values[~free], s=3, marker="s",
                         linewidths=0, cmap=colours, vmin=limits[0], vmax=limits[1])
    axis.scatter(position[free, 0], position[free, 1], s=3, color=FREE, linewidths=0)
    axis.text(0.98, 0.93, f"t = {time:.1f} s", transform=axis.transAxes, ha="right", va="top")
    axis.set_ylabel("y [m]")
    return drawn


def main():
    base = sys.argv[1]
    what = PRESSURE if base == "reservoir_drawdown" else SATURATION
    folder = sys.argv[2] if len(sys.argv) > 2 else "."
    target = sys.argv[3] if len(sys.argv) > 3 else folder
    os.makedirs(target, exist_ok=True)
    series = read_series(os.path.join(folder, f"{base}_liquid.pvd"))
    last = len(series) - 1
    chosen = [series[i] for i in (0, last // 4, last // 2, last)]
    states = [(time, read_points(path)) for time, path in chosen]
    everything = np.concatenate([points["Points"] for _, points in states])
    figure, axes = plt.subplots(2, 2, figsize=(12, 5.2), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.055, right=0.89, bottom=0.1, top=0.97, wspace=0.1, hspace=0.1)
    for axis, (time, points) in zip(axes.flat, states):
        drawn = panel(axis, points, time, what)
    axes[0, 0].set_xlim(0, np.ceil(10 * everything[:, 0].max()) / 10)
    axes[0, 0].set_ylim(0, np.ceil(10 * everything[:, 1].max() + 1) / 10)
    for axis in axes[1]:
        axis.set_xlabel("x [m]")
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.905, 0.12, 0.018, 0.8]))
    bar.set_label(what[2])
    path = os.path.join(target, f"{base}.png")
    figure.savefig(path)
    print("picture:", os.path.abspath(path))


if __name__ == "__main__":
    main()
