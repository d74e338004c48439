# SPDX-License-Identifier: MIT
"""Pictures of a run of sand_slope: python3 slope.py [folder with the results] [folder for the pictures]

Needs matplotlib. Reads the .pvd, .vtp and .csv files that sand_slope wrote.
"""

import csv
import os
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

plt.rcParams.update({"font.size": 12, "savefig.dpi": 110, "axes.titlesize": 12})


def read_series(path):
    """Times [s] and files of a .pvd file."""
    with open(path, encoding="utf-8") as file:
        found = re.findall(r'timestep="([^"]+)".*?file="([^"]+)"', file.read())
    folder = os.path.dirname(path)
    return [(float(time), os.path.join(folder, name)) for time, name in found]


def read_points(path):
    """Arrays of a .vtp file with raw appended data, by name without unit."""
    with open(path, "rb") as file:
        content = file.read()
    mark = b'<AppendedData encoding="raw">\n_'
    start = content.index(mark)
    head = content[:start].decode("utf-8")
    data = start + len(mark)
    types = {"Float64": "<f8", "Int64": "<i8"}
    arrays = {}
    pattern = r'<DataArray type="(\w+)" Name="([^"]+)" NumberOfComponents="(\d+)".*?offset="(\d+)"'
    for kind, name, components, offset in re.findall(pattern, head):
        at = data + int(offset)
        size = int(np.frombuffer(content, "<u8", 1, at)[0])
        values = np.frombuffer(content, types[kind], size // 8, at + 8)
        arrays[name.split(" [")[0]] = values.reshape(-1, int(components)).squeeze()
    return arrays


def read_csv(path):
    """Columns of a .csv file by name without unit."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    values = np.array(rows[1:], dtype=float)
    return {name.split(" [")[0]: values[:, i] for i, name in enumerate(rows[0])}


def mean_of_cells(values, positions, cell_size):
    """Every point's value replaced by the mean over the points of its cell."""
    cells = np.floor(positions / cell_size).astype(np.int64)
    _, cell = np.unique(cells, axis=0, return_inverse=True)
    cell = cell.ravel()
    return (np.bincount(cell, values) / np.bincount(cell))[cell]


def draw_field(states, outline, top, value, label, limits, colours, path, spacing):
    """One panel per state up to the height `top`, points coloured by value(points); the outline is that
    of the start, from left to right."""
    width = outline[-1][0]
    figure, axes = plt.subplots(2, 2, figsize=(12, 1.35 + 10.4 * top / width), sharex=True, sharey=True)
    figure.subplots_adjust(left=0.055, right=0.89, bottom=0.11, top=0.95, wspace=0.07, hspace=0.16)
    for axis, (time, points) in zip(axes.flat, states):
        axis.set_aspect("equal")
        axis.set_xlim(0, width)
        axis.set_ylim(0, top)
        figure.canvas.draw()
        scale = axis.transData.transform([(0, 0), (spacing, 0)])
        size = 1.2 * (scale[1, 0] - scale[0, 0]) * 72 / figure.dpi
        x, y = points["Points"][:, 0], points["Points"][:, 1]
        drawn = axis.scatter(x, y, c=value(points), s=size**2, marker="s", linewidths=0,
                             cmap=colours, vmin=limits[0], vmax=limits[1])
        axis.plot(*zip(*outline), color="0.35", linewidth=0.9, linestyle="--")
        axis.text(0.98, 0.9, f"t = {time:.3g} s", transform=axis.transAxes, ha="right", va="top")
    for axis in axes[1]:
        axis.set_xlabel("x [m]")
    for axis in axes[:, 0]:
        axis.set_ylabel("y [m]")
    bar = figure.colorbar(drawn, cax=figure.add_axes([0.905, 0.13, 0.018, 0.8]),
                          extend="max" if limits[2] else "neither")
    bar.set_label(label)
    figure.savefig(path)
    plt.close(figure)


def draw_water(axis, balance):
    """What came, went and is there, over time; the last of the panels of a history."""
    axis.plot(balance["time"], balance["water_inflow"], label="inflow")
    axis.plot(balance["time"], balance["water_outflow"], label="outflow")
    axis.plot(balance["time"], balance["pore_water"], label="stored")
    axis.set_ylabel("water [kg per m]")
    axis.set_xlabel("time since the rain started [s]")


def finish(figure, axes, time, path):
    for axis in axes:
        axis.grid(color="0.9")
        axis.set_xlim(0, time[-1])
    figure.savefig(path)
    plt.close(figure)


def draw_history(folder, path):
    """Crest and front, suction in the soil, water."""
    gauges = read_csv(os.path.join(folder, "slope_gauges.csv"))
    front = read_csv(os.path.join(folder, "slope_run_out.csv"))
    balance = read_csv(os.path.join(folder, "slope_balance.csv"))
    time = gauges["time"]
    figure, axes = plt.subplots(3, 1, figsize=(8, 9), sharex=True)
    figure.subplots_adjust(left=0.11, right=0.97, bottom=0.07, top=0.98, hspace=0.12)

    moved = np.hypot(gauges["crest.displacement_x"], gauges["crest.displacement_y"])
    axes[0].plot(time, 1e3 * moved, label="crest")
    for column, style, name in (("front_99_percent", "-", "front (99 % of the slope behind it)"),
                                ("front_last_point", ":", "last point")):
        axes[0].plot(front["time"], 1e3 * (front[column] - front[column][0]), style, label=name)
    axes[0].set_ylabel("displacement [mm]")

    depths = [name for name in gauges if name.endswith("liquid_pressure")]
    for name in depths:
        depth = re.search(r"(\d+)mm", name).group(1)
        axes[1].plot(time, 1e-3 * gauges[name], label=f"{depth} mm deep")
    axes[1].axhline(0, color="0.6", linewidth=0.8)
    axes[1].set_ylabel("liquid pressure [kPa]")

    draw_water(axes[2], balance)
    for axis in axes:
        axis.legend(frameon=False, fontsize=10.5)
    finish(figure, axes, time, path)


def pick(series):
    """Four states: the start, a fifth of the run, half of it and its end."""
    last = len(series) - 1
    return [(series[i][0], read_points(series[i][1])) for i in (0, last // 5, last // 2, last)]


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    target = sys.argv[2] if len(sys.argv) > 2 else folder
    os.makedirs(target, exist_ok=True)
    choices = read_csv(os.path.join(folder, "slope_choices.csv"))
    cell_size = choices["cell_size"][0]
    spacing = cell_size / np.sqrt(choices["points_per_cell"][0])
    states = pick(read_series(os.path.join(folder, "slope_solid.pvd")))

    def displacement(points):
        return 1e3 * np.linalg.norm(points["displacement"], axis=1)

    def suction(points):
        return 1e-3 * mean_of_cells(points["suction"], points["Points"], cell_size)

    def saturation(points):
        return points["saturation"]

    largest = np.percentile(displacement(states[-1][1]), 99)
    for name, value, label, limits, colours in (
            ("displacement", displacement, "displacement [mm]", (0, largest, True), "viridis"),
            ("suction", suction, "suction, mean of each cell [kPa]", (0, 10, True), "viridis_r"),
            ("saturation", saturation, "degree of saturation [-]", (0.2, 1, False), "YlGnBu")):
        path = os.path.join(target, f"slope_{name}.png")
        draw_field(states, [(0, 0.3), (0.3, 0.3), (0.5, 0.1), (1, 0.1)], 0.34, value, label, limits,
                   colours, path, spacing)
    draw_history(folder, os.path.join(target, "slope_history.png"))
    print("pictures in", os.path.abspath(target))


if __name__ == "__main__":
    main()
