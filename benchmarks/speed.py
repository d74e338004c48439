#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what the programs of benchmarks/speed measured and prints tables in Markdown.

    python3 benchmarks/speed.py FOLDER

FOLDER holds the JSON files of the programs; pictures and tables.md go there too.
"""
import json
import pathlib
import sys
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
passes = {
    "pressures": "cells and pressures", "limits": "step limit", "faces": "faces",
    "liquid_p2g": "liquid to nodes", "solid_p2g": "solid to nodes", "nodes": "nodes",
    "exchange": "fluxes", "solid_g2p": "nodes to solid", "liquid_g2p": "nodes to liquid",
}
colours = plt.get_cmap("tab10").colors


def runs_of(path):
    """{name without points and threads: [(points, threads, counters)]}."""
    result = defaultdict(list)
    with open(path, encoding="utf-8") as file:
        data = json.load(file)
    for run in data["benchmarks"]:
        if run.get("error_occurred"):
            print(f"failed: {run['name']}")
            continue
        parts = run["name"].split("/")
        keys = dict(p.split(":") for p in parts if ":" in p)
        name = "/".join(p for p in parts if ":" not in p and p != "manual_time")
        result[name].append((int(keys.get("points", 0)), int(keys.get("threads", 1)), run))
    return result


runs = defaultdict(list)
for path in sorted(folder.glob("*.json")):
    for run_name, list_ in runs_of(path).items():
        runs[run_name] += list_
steps = {n: r for n, r in runs.items() if any("points/s" in c for _, _, c in r)}
races = {n: r for n, r in runs.items() if any("ratio" in c for _, _, c in r)}
kernels = {n: r for n, r in runs.items() if n not in steps and n not in races}


def save(figure, name):
    figure.tight_layout()
    figure.savefig(folder / name, dpi=80)
    plt.close(figure)
    print(f"picture: {folder / name}")


def draw_sizes():
    """Time per point over the number of points, one and two threads."""
    figure, axes = plt.subplots(figsize=(8, 5))
    for i, (name, list_) in enumerate(n for n in steps.items() if len({p for p, _, _ in n[1]}) > 2):
        for threads, style in ((1, "-o"), (2, "--s")):
            points = sorted((p, c["ns"]) for p, t, c in list_ if t == threads)
            if points:
                axes.loglog(*zip(*points), style, color=colours[i % 10],
                            label=f"{name}, {threads} thread{'s' if threads > 1 else ''}")
    axes.set_xlabel("points (solid, or pairs)")
    axes.set_ylabel("ns per point and step")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize=7)
    save(figure, "speed_sizes.png")


def largest(list_, threads=1):
    """Counters of the run nearest to 1e6 points."""
    found = [(abs(p - 1000000), c) for p, t, c in list_ if t == threads]
    return min(found, key=lambda f: f[0])[1] if found else None


def draw_passes():
    """Where the time of a step goes."""
    figure, axes = plt.subplots(figsize=(9, 0.45 * len(steps) + 1.5))
    names = sorted(steps, reverse=True)
    for row, name in enumerate(names):
        counters = largest(steps[name])
        left = 0
        for i, key in enumerate(passes):
            width = counters.get(f"ns_{key}", 0) if counters else 0
            axes.barh(row, width, left=left, color=colours[i % 10])
            left += width
        if counters and left == 0:  # a scheme without these passes
            axes.barh(row, counters["ns"], color="lightgray")
    axes.set_yticks(range(len(names)), names, fontsize=8)
    for i, label in enumerate(passes.values()):
        axes.barh(0, 0, color=colours[i % 10], label=label)
    axes.set_xlabel("ns per point and step, one thread, 1e6 points")
    axes.legend(fontsize=7)
    save(figure, "speed_passes.png")


def draw_roofline():
    """Operations per byte of point data against operations per second: dry models."""
    figure, axes = plt.subplots(figsize=(7, 5))
    some = None
    for i, (name, list_) in enumerate(sorted(steps.items())):
        counters = largest(list_)
        if not counters or "of_fma" not in counters:
            continue
        some = counters
        rate = counters["of_fma"] * counters["Gflop/s_fma"]
        traffic = counters["of_bandwidth"] * counters["GB/s_triad"]
        axes.loglog(rate / traffic, rate, "o", color=colours[i % 10], label=name)
    if some:
        x = [0.1, some["Gflop/s_fma"] / some["GB/s_triad"], 100]
        axes.loglog(x, [min(some["Gflop/s_fma"], v * some["GB/s_triad"]) for v in x], "k-",
                    label="machine: triad, multiply-adds")
    axes.set_xlabel("operations per byte")
    axes.set_ylabel("Gflop/s")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize=7)
    save(figure, "speed_roofline.png")


def draw_memory():
    """Bytes per point of the models, and of the whole run."""
    figure, axes = plt.subplots(figsize=(8, 0.4 * len(steps) + 1.5))
    names = sorted(steps, reverse=True)
    for row, name in enumerate(names):
        counters = largest(steps[name])
        if counters:
            axes.barh(row + 0.2, counters["bytes"], 0.4, color=colours[0])
            axes.barh(row - 0.2, 1e6 * counters["MB"] / counters["points"], 0.4, color=colours[1])
    axes.barh(0, 0, color=colours[0], label="points")
    axes.barh(0, 0, color=colours[1], label="points and grid")
    axes.set_yticks(range(len(names)), names, fontsize=8)
    axes.set_xlabel("bytes per point")
    axes.legend(fontsize=8)
    save(figure, "speed_memory.png")


def tables():
    """Markdown."""
    lines = ["| steps | points | threads | ns | cells and faces | instructions | bytes | of triad | of FMA |",
             "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    for name, list_ in sorted(steps.items()):
        for points, threads, c in sorted(list_, key=lambda r: r[:2]):
            cells = sum(c.get(f"ns_{k}", 0) for k in ("pressures", "limits", "faces", "exchange"))
            lines.append(f"| {name} | {points} | {threads} | {c['ns']:.1f} | {cells:.1f} | "
                         f"{c.get('instructions', 0):.0f} | {c['bytes']:.0f} | "
                         f"{c['of_bandwidth']:.2f} | {c.get('of_fma', 0):.2f} |")
    lines += ["", "| against the straightforward implementation | points | ns | its ns | ratio |",
              "| --- | --- | --- | --- | --- |"]
    for name, list_ in sorted(races.items()):
        for points, _, c in sorted(list_, key=lambda r: r[:2]):
            lines.append(f"| {name} | {points} | {c['ns']:.1f} | {c['ns_naive']:.0f} | "
                         f"{c['ratio']:.1f} |")
    if kernels:
        lines += ["", "| kernels | ns |", "| --- | --- |"]
        for name, list_ in sorted(kernels.items()):
            for _, _, c in list_:
                lines.append(f"| {name} | {c.get('ns', 0):.2f} |")
    return "\n".join(lines) + "\n"


if steps:
    draw_sizes()
    draw_passes()
    draw_roofline()
    draw_memory()
text = tables()
(folder / "tables.md").write_text(text, encoding="utf-8")
print(text)
