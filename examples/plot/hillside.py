# SPDX-License-Identifier: MIT
"""Picture of hillside_rain: python3 hillside.py [folder with the results] [folder for the picture]

Needs matplotlib. Seen from above: how far the ground has moved, over its contour lines at the start; and
the suction in a section along the middle. Half time and end.
"""

import os
import sys

import numpy as np

from slope import mean_of_cells, plt, read_points, read_series


def surface(points, value, cell):
    """Value and height at the start of the highest point in every column of cells."""
    start = points["Points"] - points["displacement"]
    column = np.floor(start[:, :2] / cell).astype(int)
    order = np.argsort(start[:, 2])
    shape = tuple(column.max(axis=0) + 1)
    field, height = np.full(shape, np.nan), np.full(shape, np.nan)
    field[column[order, 0], column[order, 1]] = value[order]
    height[column[order, 0], column[order, 1]] = start[order, 2]
    return field, height


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    target = sys.argv[2] if len(sys.argv) > 2 else folder
    os.makedirs(target, exist_ok=True)
    series = read_series(os.path.join(folder, "hillside_solid.pvd"))
    last = len(series) - 1
    figure, axes = plt.subplots(2, 2, figsize=(12, 7.2))
    figure.subplots_adjust(left=0.05, right=0.9, bottom=0.08, top=0.97, wspace=0.12, hspace=0.15)
    states = [(series[i][0], read_points(series[i][1])) for i in ((last + 1) // 2, last)]
    moved = [np.linalg.norm(points["displacement"], axis=1) for _, points in states]
    largest = np.percentile(moved[-1], 99.5)
    for column, ((time, points), distance) in enumerate(zip(states, moved)):
        start = points["Points"] - points["displacement"]
        spacing = float(f"{2 * start[:, 0].min():.2g}")  # the first points are half of it from the wall
        field, height = surface(points, distance, 2 * spacing)
        x, y = (2 * spacing * (np.arange(n) + 0.5) for n in field.shape)
        above = axes[0, column].pcolormesh(x, y, field.T, cmap="viridis", vmin=0, vmax=largest,
                                           shading="nearest")
        axes[0, column].contour(x, y, height.T, levels=np.arange(0, 40, 1), colors="w",
                                linewidths=0.5)
        axes[0, column].set_title(f"t = {time:.1f} s")
        axes[0, column].set_ylabel("y [m]")
        middle = 0.5 * (start[:, 1].min() + start[:, 1].max())
        cut = np.abs(points["Points"][:, 1] - middle) < spacing
        suction = 1e-3 * mean_of_cells(points["suction"], points["Points"], 2 * spacing)
        section = axes[1, column].scatter(points["Points"][cut, 0], points["Points"][cut, 2],
                                          c=suction[cut], s=14, marker="s",
                                          linewidths=0, cmap="viridis_r", vmin=0, vmax=10)
        axes[1, column].set_xlabel("x [m]")
        axes[1, column].set_ylabel("z [m]")
        for axis in axes[:, column]:
            axis.set_aspect("equal")
    figure.colorbar(above, cax=figure.add_axes([0.915, 0.56, 0.014, 0.4])).set_label(
        "displacement of the ground [m]")
    figure.colorbar(section, cax=figure.add_axes([0.915, 0.08, 0.014, 0.4])).set_label("suction, mean of cells [kPa]")
    path = os.path.join(target, "hillside_rain.png")
    figure.savefig(path)
    print("picture:", os.path.abspath(path))


if __name__ == "__main__":
    main()
