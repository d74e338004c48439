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

from slope import (draw_field, draw_water, finish, mean_of_cells, plt, read_csv, read_points,
                   read_series)

SCENES = {
    "centrifuge": {"outline": [(0, 0.3), (0.3, 0.3), (0.5, 0.1), (1, 0.1)], "unit": "mm",
                   "factor": 1e3, "suction": 10, "height": 0.34},
    "clay": {"outline": [(0, 12), (10, 12), (21, 5), (36, 5)], "unit": "m", "factor": 1,
             "suction": 500, "height": 13},
}


def spacing_of(points):
    """Distance of the points at the start: the first are half of it from the wall."""
    start = points["Points"][:, :2] - points.get("displacement", np.zeros((1, 3)))[:, :2]
    return float(f"{2 * start[:, 0].min():.2g}")


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
    draw_water(axes[2], balance)
    for axis in axes[1:]:
        axis.legend(frameon=False, fontsize=9)
    finish(figure, axes, slide["time"], path)


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

    spacing = spacing_of(states[0][1])

    def draw(name, value, label, limits, colours):
        draw_field(states, scene["outline"], scene["height"], value, label, limits, colours,
                   os.path.join(target, f"{base}_{name}.png"), spacing)

    def displacement(points):
        return scene["factor"] * np.linalg.norm(points["displacement"], axis=1)

    def suction(points):
        return mean_of_cells(1e-3 * points["suction"], points["Points"], 2 * spacing)

    if "displacement" in states[0][1]:
        largest = max(np.percentile(displacement(states[-1][1]), 99), 1e-9)
        draw("displacement", displacement, f"displacement [{scene['unit']}]", (0, largest, True),
             "viridis")
        draw_history(folder, base, scene, os.path.join(target, f"{base}_history.png"))
    draw("suction", suction, "suction, mean of each cell [kPa]", (0, scene["suction"], True),
         "viridis_r")
    print("pictures in", os.path.abspath(target))


if __name__ == "__main__":
    main()
