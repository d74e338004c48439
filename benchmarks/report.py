#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what the report programs wrote and prints a table in Markdown.

    python3 benchmarks/report.py FOLDER

FOLDER holds *_norms.csv and *_values.csv; pictures and table.md go there too.
"""
import csv
import math
import pathlib
import sys
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
reference = pathlib.Path(__file__).resolve().parent.parent / "tests" / "reference"
standard = "gimp flip explicit"


def rows_of(path):
    """Rows of a CSV file as dictionaries; lines that begin with # are skipped."""
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def all_rows(kind):
    """Rows of all programs, numbers as float."""
    result = []
    for path in sorted(folder.glob(f"*_{kind}.csv")):
        for row in rows_of(path):
            for key, value in row.items():
                if key not in ("case", "variant", "quantity"):
                    row[key] = float(value)
            result.append(row)
    return result


def save(figure, name):
    figure.savefig(folder / name, dpi=80)
    plt.close(figure)
    print(f"picture: {folder / name}")


def short(variant):
    """A variant by what differs from the standard one."""
    words = variant.split()
    changed = [w for w, s in zip(words, standard.split()) if w != s] + words[3:]
    return " ".join(changed).replace("_", " ") or standard


norms = all_rows("norms")
values = all_rows("values")


def runs(case):
    """{variant: [(cells, seconds, rms, point-steps)]} of the first quantity at the first time."""
    result = defaultdict(list)
    first = next(((r["quantity"], r["time"]) for r in norms if r["case"] == case), None)
    for r in norms:
        if r["case"] == case and (r["quantity"], r["time"]) == first and not r["failed"]:
            result[r["variant"]].append((r["cells"], r["seconds"], r["rms"]))
    return first, {v: sorted(line) for v, line in result.items()}


def draw_lines(axes, case, column, label):
    """Error over cell size (0) or time (1) for every choice."""
    first, lines = runs(case)
    if first is None:
        axes.set_visible(False)
        return
    for variant, line in lines.items():
        x = [1 / p[0] if column == 0 else max(p[1], 1e-4) for p in line]
        axes.loglog(x, [p[2] for p in line], "o-", ms=3, label=short(variant))
    if column == 0 and standard in lines:
        x = [1 / p[0] for p in lines[standard]]
        y = lines[standard][0][2]
        for order in (1, 2):
            axes.loglog(x, [y * (i / x[0]) ** order for i in x], ":", color="grey", lw=0.8)
            axes.text(x[-1], y * (x[-1] / x[0]) ** order, f" {order}", color="grey", fontsize=7)
        cells = sorted({p[0] for line in lines.values() for p in line})
        axes.set_xticks([1 / n for n in cells], [f"1/{n:.0f}" for n in cells])
        axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(matplotlib.ticker.NullFormatter())
    axes.set_title(f"{case}\n{first[0]} at {first[1]:g}", fontsize=7)
    axes.set_xlabel(label, fontsize=7)
    axes.set_ylabel("rms error", fontsize=7)
    axes.tick_params(labelsize=6)
    axes.legend(fontsize=6)


def draw_work_precision():
    """Errors over cell size, with slopes, and over wall time."""
    cases = ["Terzaghi k = 1e-4 m/s", "manufactured S = 1", "large strain k = k0 J^2",
             "Srivastava and Yeh"]
    figure, axes = plt.subplots(2, len(cases), figsize=(11.5, 5.6), layout="constrained")
    for i, case in enumerate(cases):
        draw_lines(axes[0][i], case, 0, "cell size over length")
        draw_lines(axes[1][i], case, 1, "wall time [s]")
    save(figure, "work_precision.png")


def draw_schemes():
    """Errors of the schemes over wall time; as labels, steps."""
    cases = ["schemes: Terzaghi", "schemes: unsaturated consolidation", "schemes: infiltration"]
    figure, axes = plt.subplots(1, 3, figsize=(11.5, 3.4), layout="constrained")
    for ax, case in zip(axes, cases):
        draw_lines(ax, case, 1, "wall time [s]")
        for r in norms:
            if r["case"] == case and (r["quantity"], r["time"]) == runs(case)[0]:
                if not r["failed"]:
                    ax.annotate(f"{r['steps']:.0f}", (max(r["seconds"], 1e-4), r["rms"]),
                                xytext=(3, 3), textcoords="offset points", fontsize=6)
    save(figure, "schemes.png")


def draw_choices():
    """Errors of every choice at the same resolution; a choice whose run failed has no bar."""
    cases = [("Terzaghi k = 1e-4 m/s", 20), ("two waves k = 9.8e-4 m/s", 50),
             ("large strain k = k0 J^2", 20), ("unsaturated E = 10 MPa S(n) k(n)", 10),
             ("sloshing", 20), ("manufactured S = 1", 16), ("Philip", 40), ("pond rigid", 20)]
    figure, axes = plt.subplots(2, 4, figsize=(14, 5), layout="constrained")
    for ax, (case, cells) in zip(axes.flat, cases):
        first, lines = runs(case)
        bars = {short(r["variant"]) + " (failed)": 0 for r in norms
                if r["case"] == case and r["cells"] == cells and r["failed"]}
        bars = {short(v): p[2] for v, line in lines.items() for p in line
                if p[0] == cells} | bars
        ax.barh(list(bars), [100 * b for b in bars.values()], color="tab:blue")
        ax.set_xscale("symlog", linthresh=0.1)
        ax.set_title(f"{case}, {cells} cells\n{first[0] if first else ''}", fontsize=7)
        ax.set_xlabel("rms error [%]", fontsize=7)
        ax.tick_params(labelsize=6)
        ax.invert_yaxis()
    save(figure, "choices.png")


def draw_consolidation():
    """[Zhan] Figs. 6 and 7: profiles at S = 1 and 0.86, history at 0.25 m."""
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.4), layout="constrained")
    colours = plt.cm.viridis([0, 0.25, 0.5, 0.75, 0.9])
    for ax, case, title, times in (
        (axes[0], "Terzaghi k = 9.8e-4 m/s", "saturated, 20 cells", (0.05, 0.1, 0.3, 0.6)),
        (axes[1], "figures 6 and 7 E = 10 MPa S(n) k(n)", "S = 0.86, E = 10 MPa, 20 cells",
         (0.05, 0.1, 0.2, 0.5, 1)),
    ):
        for colour, time in zip(colours, times):
            line = [r for r in values if r["case"] == case and r["time"] == time
                    and r["cells"] == 20 and r["quantity"] == "pressure"]
            ax.plot([r["reference"] for r in line], [r["place"] for r in line], "-", color=colour,
                    lw=1, label=f"$T_v$ = {time:g}")
            ax.plot([r["computed"] for r in line], [r["place"] for r in line], "o", color=colour,
                    ms=3, mfc="none")
        ax.set_title(f"Fig. 6, {title}\nline: reference, circles: computed", fontsize=7)
        ax.set_xlabel("excess pressure over load", fontsize=7)
        ax.set_ylabel("height [m]", fontsize=7)
        ax.legend(fontsize=6)
    ax = axes[2]
    history = rows_of(reference / "r2_fig7_history.csv")
    for stiffness, colour in (("3", "tab:red"), ("10", "tab:blue")):
        for mode, style, laws in (("frozen", "-", "S and k at n0"), ("full", "--", "S(n) k(n)"),
                                  ("paper", ":", "")):
            line = [r for r in history if r["E_MPa"] == stiffness and r["mode"] == mode]
            ax.plot([float(r["Tv"]) for r in line], [float(r["dp_over_q_z0.25"]) for r in line],
                    style, color=colour, lw=1)
            name = f"figures 6 and 7 E = {stiffness} MPa {laws}"
            mine = [r for r in values if r["case"] == name and r["cells"] == 20
                    and r["quantity"] == "pressure at 0.25 m"]
            ax.plot([r["time"] for r in mine], [r["computed"] for r in mine],
                    "o" if mode == "frozen" else "s", color=colour, ms=3, mfc="none")
    for style, text in (("-", "S, k at $n_0$"), ("--", "S(n), k(n), n dS/dn"),
                        (":", "S(n), k(n), Eq. 9 as printed")):
        ax.plot([], [], style, color="k", lw=1, label=text)
    ax.plot([], [], "o", color="k", ms=3, mfc="none", label="computed")
    ax.set_xlim(0, 3)
    ax.set_title("Fig. 7, height 0.25 m\nred: 3 MPa, blue: 10 MPa", fontsize=7)
    ax.set_xlabel("$T_v$", fontsize=7)
    ax.set_ylabel("excess pressure over load", fontsize=7)
    ax.legend(fontsize=6)
    for ax in axes:
        ax.tick_params(labelsize=6)
    save(figure, "figures_6_7.png")


def draw_infiltration():
    """[Zhan] Fig. 9: profiles of S below a pond, rigid and elastic."""
    figure, axes = plt.subplots(1, 2, figsize=(6.4, 3.4), sharey=True, layout="constrained")
    for ax, case in zip(axes, ("pond rigid", "pond elastic")):
        for colour, time in zip(plt.cm.viridis([0, 0.4, 0.8]), (50, 100, 200)):
            line = [r for r in values if r["case"] == case and r["time"] == time
                    and r["cells"] == 20 and r["quantity"] == "saturation"]
            ax.plot([r["reference"] for r in line], [r["place"] for r in line], "-", color=colour,
                    lw=1, label=f"{time} s")
            ax.plot([r["computed"] for r in line], [r["place"] for r in line], "o", color=colour,
                    ms=3, mfc="none")
        ax.set_title(f"Fig. 9, {case}, 20 cells\nline: reference, circles: computed", fontsize=7)
        ax.set_xlabel("degree of saturation", fontsize=7)
        ax.tick_params(labelsize=6)
        ax.legend(fontsize=6)
    axes[0].set_ylabel("height [m]", fontsize=7)
    save(figure, "figures_8_9.png")


def order_of(case, quantity, time):
    """Orders between the resolutions of the standard choices."""
    wanted = (case, usual(case), quantity, time)
    line = sorted((r["cells"], r["rms"]) for r in norms
                  if (r["case"], r["variant"], r["quantity"], r["time"]) == wanted)
    return ", ".join(f"{math.log(a[1] / b[1]) / math.log(b[0] / a[0]):.1f}"
                     for a, b in zip(line, line[1:]) if a[1] > 0 and b[1] > 0)


def percent(value):
    """A part of one in percent; nothing where there is no bound."""
    return "" if math.isinf(value) else f"{100 * value:.2g} %"


def usual(case):
    """The variant that stands for a case: the standard one, or the first of those it has."""
    variants = [r["variant"] for r in norms if r["case"] == case]
    return standard if standard in variants else variants[0]


def table():
    """One line per case, quantity and resolution: largest rms over the times."""
    lines = ["| case | quantity | cells | largest rms at | measured | bound | order | steps | s |",
             "|---|---|---|---|---|---|---|---|---|"]
    groups = defaultdict(list)
    for r in norms:
        if r["variant"] == usual(r["case"]):
            groups[r["case"], r["quantity"], r["cells"]].append(r)
    for (case, quantity, cells), group in groups.items():
        worst = max(group, key=lambda r: math.inf if math.isnan(r["rms"]) else r["rms"])
        missed = [r for r in group if not r["rms"] <= r["bound"]]
        finest = cells == max(k[2] for k in groups if k[:2] == (case, quantity))
        order = order_of(case, quantity, worst["time"]) if finest else ""
        choice = "" if usual(case) == standard else f", {short(usual(case))}"
        lines.append(
            f"| {case}{choice} | {quantity} | {cells:.0f} | {worst['time']:.3g} "
            f"| {percent(worst['rms'])} | {percent(worst['bound'])}{' MISSED' if missed else ''} | {order} "
            f"| {worst['steps']:.0f} | {worst['seconds']:.2g} |")
    lines += ["", "| case | cells | choice | rms | s | million point-steps per s |",
              "|---|---|---|---|---|---|"]
    for case in dict.fromkeys(r["case"] for r in norms):
        first, by_variant = runs(case)
        if len(by_variant) < 2:
            continue
        for r in norms:
            if r["case"] == case and (r["quantity"], r["time"]) == first:
                speed = r["points"] * r["steps"] / r["seconds"] * 1e-6
                lines.append(f"| {case} | {r['cells']:.0f} | {short(r['variant'])} | "
                             f"{percent(r['rms'])} | {r['seconds']:.2g} | {speed:.2g} |")
    failures = [f"{r['case']}, {short(r['variant'])}, {r['cells']:.0f} cells" for r in norms
                if r["failed"]]
    for failure in dict.fromkeys(failures):
        lines.append(f"\nFAILED: {failure}")
    return "\n".join(lines) + "\n"


draw_work_precision()
draw_schemes()
draw_choices()
draw_consolidation()
draw_infiltration()
text = table()
(folder / "table.md").write_text(text, encoding="utf-8")
print(text)
