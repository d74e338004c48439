# SPDX-License-Identifier: MIT
"""Pictures of a sweep of sand_column_collapse: python3 column.py [folder of the sweep] [folder for the
pictures]

Needs matplotlib. The folder has column_sweep.csv and the folders w0.00, w1.00, w3.00, ... of the runs; a
second sweep in the folder `other` beside them (the other height, or without damping) is drawn too.
"""

import glob
import os
import sys

import numpy as np

from slope import plt, read_csv, read_points, read_series

TIMES = (0.1, 0.15, 0.3, 0.5)


def draw_collapse(folder, path):
    """Plastic strain at four times for w = 0, 1, 3 %."""
    shown = [w for w in ("w0.00", "w1.00", "w3.00")
             if os.path.exists(os.path.join(folder, w, "column_solid.pvd"))]
    figure, axes = plt.subplots(len(shown), 4, figsize=(13, 0.6 + 1.75 * len(shown)), sharex=True,
                                sharey=True, squeeze=False)
    figure.subplots_adjust(left=0.05, right=0.91, bottom=0.11, top=0.94, wspace=0.06, hspace=0.08)
    for row, name in zip(axes, shown):
        series = read_series(os.path.join(folder, name, "column_solid.pvd"))
        start = read_points(series[0][1])["Points"]
        spacing = np.diff(np.unique(start[:, 0].round(9)))[0]
        box = start[:, :2].max(axis=0) + 0.5 * spacing
        for axis, time in zip(row, TIMES):
            at, file = min(series, key=lambda entry: abs(entry[0] - time))
            points = read_points(file)
            axis.set_aspect("equal")
            axis.set_xlim(0, box[0] + 1.6 * box[1])
            axis.set_ylim(0, 1.1 * box[1])
            axis.plot([0, box[0], box[0]], [box[1], box[1], 0], "--", color="0.4", linewidth=0.8)
            drawn = axis.scatter(points["Points"][:, 0], points["Points"][:, 1],
                                 c=points["plastic_shear_strain"], s=1.4, marker="s", linewidths=0,
                                 cmap="viridis", vmin=0, vmax=2)
            axis.text(0.97, 0.92, f"w = {float(name[1:]):g} %, {at:.2f} s",
                      transform=axis.transAxes, ha="right", va="top", fontsize=10)
        row[0].set_ylabel("y [m]")
    for axis in axes[-1]:
        axis.set_xlabel("x [m]")
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.925, 0.14, 0.014, 0.77]), extend="max")
    bar.set_label("plastic shear strain [-]")
    figure.savefig(path)
    plt.close(figure)


def draw_run_out(folder, path):
    """R(w), and the height that a vertical face can have."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4))
    figure.subplots_adjust(left=0.07, right=0.98, bottom=0.14, top=0.97, wspace=0.22)
    tables = sorted(glob.glob(os.path.join(folder, "**", "column_sweep.csv"), recursive=True))
    for table in tables:
        sweep = read_csv(table)
        name = os.path.relpath(os.path.dirname(table), folder)
        left.plot(sweep["water_content"], sweep["run_out"], "o-", markersize=4,
                  label="H0 = 0.08 m, L0 = 0.07 m, damping 0.05" if name == "." else name)
    left.set_ylabel("run-out R = (L1 - L0) / H0 [-]")
    left.set_ylim(bottom=0)
    right.plot(sweep["water_content"], 1e3 * sweep["critical_height"], "o-", markersize=4,
               label="4 c / γ tan(45° + φ/2), c = S s tan φ")
    right.axhline(80, color="0.5", linestyle="--", linewidth=0.9, label="H0 = 80 mm")
    right.axhline(70, color="0.5", linestyle=":", linewidth=0.9, label="H0 = 70 mm")
    right.set_ylabel("height of a face that stands [mm]")
    for axis in (left, right):
        axis.set_xlabel("water content w [%]")
        axis.grid(color="0.9")
        axis.legend(frameon=False, fontsize=9.5)
    figure.savefig(path)
    plt.close(figure)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    target = sys.argv[2] if len(sys.argv) > 2 else folder
    os.makedirs(target, exist_ok=True)
    draw_collapse(folder, os.path.join(target, "column_collapse.png"))
    draw_run_out(folder, os.path.join(target, "column_run_out.png"))
    print("pictures in", os.path.abspath(target))


if __name__ == "__main__":
    main()
