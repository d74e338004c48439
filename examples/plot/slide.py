# SPDX-License-Identifier: MIT
"""Pictures of centrifuge_slope and clay_slope: python3 slide.py BASE [folder with the results] [folder
for the pictures] [time in s]...

BASE is centrifuge or clay. Needs matplotlib. Draws displacement and suction at four times (those of the
files that are nearest to the given ones) and the histories.
"""

import glob
import os
import sys

import numpy as np

from slope import plt, read_csv, read_points, read_series

SCENES = {
    "centrifuge": {"outline": [(0, 0.3), (0.3, 0.3), (0.5, 0.1), (1, 0.1)], "unit": "mm",
                   "factor": 1e3, "suction": 10, "height": 0.34},
    "clay": {"outline": [(0, 12), (10, 12), (21, 5), (36, 5)], "unit": "m", "factor": 1,
             "suction": 500, "height": 13},
}


def mean_by_cell(values, positions, cell):
    """Every point's value replaced by the mean of its cell."""
    cells = np.floor(positions[:, :2] / cell).astype(np.int64)
    _, number = np.unique(cells, axis=0, return_inverse=True)
    number = number.ravel()
    return (np.bincount(number, values) / np.bincount(number))[number]


def draw(states, scene, value, label, limits, colours, path):
    """One panel per state."""
    width = scene["outline"][-1][0]
    figure, axes = plt.subplots(2, 2, figsize=(12, 0.9 + 10.4 * scene["height"] / width),
                                sharex=True, sharey=True)
    figure.subplots_adjust(left=0.055, right=0.89, bottom=0.12, top=0.96, wspace=0.07, hspace=0.12)
    start = states[0][1]["Points"][:, :2] - states[0][1].get("displacement", np.zeros((1, 3)))[:, :2]
    spacing = float(f"{2 * start[:, 0].min():.2g}")  # the first points are half of it from the wall
    for axis, (time, points) in zip(axes.flat, states):
        axis.set_aspect("equal")
        axis.set_xlim(0, width)
        axis.set_ylim(0, scene["height"])
        figure.canvas.draw()
        edge = axis.transData.transform([(0, 0), (spacing, 0)])
        size = 1.2 * (edge[1, 0] - edge[0, 0]) * 72 / figure.dpi
        drawn = axis.scatter(points["Points"][:, 0], points["Points"][:, 1], c=value(points, spacing),
                             s=size ** 2, marker="s", linewidths=0, cmap=colours, vmin=limits[0],
                             vmax=limits[1])
        axis.plot(*zip(*scene["outline"]), "--", color="0.35", linewidth=0.9)
        axis.text(0.98, 0.93, f"t = {time:.3g} s", transform=axis.transAxes, ha="right", va="top")
    for axis in axes[1]:
        axis.set_xlabel("x [m]")
    for axis in axes[:, 0]:
        axis.set_ylabel("y [m]")
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.905, 0.14, 0.018, 0.8]), extend="max")
    bar.set_label(label)
    figure.savefig(path)
    plt.close(figure)


def draw_history(folder, base, scene, path):
    """Displacement and depth of the slide, suction, water."""
    def together(name):
        files = sorted(glob.glob(os.path.join(folder, f"{base}_{name}*.csv")),
                       key=lambda file: read_csv(file)["time"][0])
        tables = [read_csv(file) for file in files]
        return {key: np.concatenate([table[key] for table in tables]) for key in tables[0]}

    figure, axes = plt.subplots(3, 1, figsize=(8, 9), sharex=True)
    figure.subplots_adjust(left=0.12, right=0.88, bottom=0.07, top=0.98, hspace=0.1)
    slide, gauges, balance = together("slide"), together("gauges"), together("balance")
    axes[0].plot(slide["time"], scene["factor"] * slide["largest"], color="C0")
    axes[0].set_ylabel(f"largest displacement [{scene['unit']}]", color="C0")
    twin = axes[0].twinx()
    twin.plot(slide["time"], scene["factor"] * slide["depth"], color="C1", linewidth=1)
    twin.set_ylabel(f"depth of the slide [{scene['unit']}]", color="C1")
    for name in gauges:
        if name.endswith(".suction"):
            axes[1].plot(gauges["time"], 1e-3 * gauges[name], label=name[:-8].replace("_", " "))
    axes[1].set_ylabel("suction [kPa]")
    axes[2].plot(balance["time"], balance["water_inflow"], label="inflow")
    axes[2].plot(balance["time"], balance["water_outflow"], label="outflow")
    axes[2].plot(balance["time"], balance["pore_water"], label="stored")
    axes[2].set_ylabel("water [kg per m]")
    axes[2].set_xlabel("time since the rain started [s]")
    for axis in axes:
        axis.grid(color="0.9")
    for axis in axes[1:]:
        axis.legend(frameon=False, fontsize=9)
    figure.savefig(path)
    plt.close(figure)


def main():
    base = sys.argv[1]
    folder = sys.argv[2] if len(sys.argv) > 2 else "."
    target = sys.argv[3] if len(sys.argv) > 3 else folder
    times = [float(word) for word in sys.argv[4:8]]
    scene = SCENES[base]
    os.makedirs(target, exist_ok=True)
    series = read_series(os.path.join(folder, f"{base}_solid.pvd"))
    last = len(series) - 1
    chosen = ([min(series, key=lambda entry: abs(entry[0] - t)) for t in times] or
              [series[i] for i in (last // 4, last // 2, 3 * last // 4, last)])
    states = [(time, read_points(file)) for time, file in chosen]

    def suction(points, spacing):
        return mean_by_cell(1e-3 * points["suction"], points["Points"], 2 * spacing)

    if "displacement" in states[0][1]:
        def displacement(points, _):
            return scene["factor"] * np.linalg.norm(points["displacement"], axis=1)

        largest = max(np.percentile(displacement(states[-1][1], 0), 99), 1e-9)
        draw(states, scene, displacement, f"displacement [{scene['unit']}]", (0, largest), "viridis",
             os.path.join(target, f"{base}_displacement.png"))
        draw_history(folder, base, scene, os.path.join(target, f"{base}_history.png"))
    draw(states, scene, suction, "suction, mean of each cell [kPa]", (0, scene["suction"]),
         "viridis_r", os.path.join(target, f"{base}_suction.png"))
    print("pictures in", os.path.abspath(target))


if __name__ == "__main__":
    main()
