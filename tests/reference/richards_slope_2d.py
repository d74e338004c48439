#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Richards' equation in the section of [Zhan] 4.5: a slope of rigid sandy clay, 7 m high, 11 m long, on
5 m of the same, whose surface is held at p = 0 from t = 0 on. Writes richards_clay_slope.csv beside
this file: means over the square cells of 0.5 m that lie in the soil as a whole.

Linear finite elements on a Delaunay triangulation with lumped storage (control volumes), so that water is
conserved; mixed form, backward Euler, full Newton; conductivity between two nodes is the mean of theirs.
Needs numpy and scipy. Clay: [Zhan] Table 4, Eq. (12) at n = 0.4, S_res = 0.26, Mualem with lambda =
0.19, a straight line in S_e below the scaled suction 1e-3; K = 2.2 GPa in the storage. Start: suction of
500 kPa at the surface and water at rest below it. Cases: k_sat = 0.082 m/s to 5 s, and the printed 5 m/s,
which is the same run with time over 61.
Options: --spacing H (0.1 m near the surface); --check prints the inflow for two spacings.
"""
import csv
import os
import sys

import numpy as np
from scipy.interpolate import LinearNDInterpolator
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay

BASE, HEIGHT, CREST, TOE, LENGTH = 5.0, 7.0, 10.0, 21.0, 36.0
POROSITY, RESIDUAL, LAMBDA, A, K_SAT, K_WATER, GAMMA = 0.4, 0.26, 0.19, 15.2, 0.082, 2.2e9, 9810.0
E = POROSITY / (1 - POROSITY)
ALPHA = A * E ** ((1 - LAMBDA) / LAMBDA) / GAMMA  # [1/Pa]
N = 1 / (1 - LAMBDA)
TIMES = [0.5, 1.0, 2.0, 5.0]
CELL = 0.5


def ground(x):
    return BASE + HEIGHT * (1 - np.clip((x - CREST) / (TOE - CREST), 0, 1))


def effective(p):
    """S_e and dS_e/dp."""
    x = np.maximum(-p, 0) * ALPHA
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (1 + x ** N) ** -LAMBDA
        slope = np.where(x > 0, LAMBDA * N * x ** (N - 1) * ALPHA * s / (1 + x ** N), 0.0)
    return s, slope


def content(p):
    """n S exp(p / K) and its slope."""
    s, ds = effective(p)
    s, ds = RESIDUAL + (1 - RESIDUAL) * s, (1 - RESIDUAL) * ds
    return POROSITY * (s + p / K_WATER), POROSITY * (ds + 1 / K_WATER)


LINE_AT = float(effective(np.array(-1e-3 / ALPHA))[0])


def mualem(s):
    return np.sqrt(s) * (1 - (1 - s ** (1 / LAMBDA)) ** LAMBDA) ** 2


def relative(p):
    s = effective(p)[0]
    low = mualem(LINE_AT)
    return np.where(s < LINE_AT, mualem(np.minimum(s, LINE_AT)),
                    low + (1 - low) * (s - LINE_AT) / (1 - LINE_AT))


class Slope:
    def __init__(self, spacing):
        self.points, surface = self.seed(spacing)
        triangles = Delaunay(self.points).simplices
        corners = self.points[triangles]
        centre = corners.mean(axis=1)
        inside = centre[:, 1] < ground(centre[:, 0]) - 1e-9
        edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * np.abs(edge1[:, 0] * edge2[:, 1] - edge1[:, 1] * edge2[:, 0])
        keep = inside & (area > 1e-8)
        triangles, corners, area = triangles[keep], corners[keep], area[keep]
        count = len(self.points)
        self.volume = np.bincount(triangles.ravel(), np.repeat(area / 3, 3), count)
        rows, columns, weights = [], [], []
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            # -integral of grad N_i . grad N_j = half the cotangent of the angle opposite.
            a, b = corners[:, i] - corners[:, k], corners[:, j] - corners[:, k]
            weights.append(0.5 * (a * b).sum(axis=1) / (2 * area))
            rows.append(np.minimum(triangles[:, i], triangles[:, j]))
            columns.append(np.maximum(triangles[:, i], triangles[:, j]))
        whole = coo_matrix((np.concatenate(weights),
                            (np.concatenate(rows), np.concatenate(columns))), (count, count)).tocsr().tocoo()
        self.i, self.j, self.weight = whole.row, whole.col, whole.data
        self.free = np.ones(count, bool)
        self.free[surface] = False
        self.total_area = area.sum()

    @staticmethod
    def seed(spacing):
        length = np.hypot(TOE - CREST, HEIGHT)
        along = []
        for (x0, y0), (x1, y1), size in (((0, BASE + HEIGHT), (CREST, BASE + HEIGHT), CREST),
                                         ((CREST, BASE + HEIGHT), (TOE, BASE), length),
                                         ((TOE, BASE), (LENGTH, BASE), LENGTH - TOE)):
            t = np.linspace(0, 1, int(round(size / spacing)) + 1)
            along.append(np.column_stack([x0 + t * (x1 - x0), y0 + t * (y1 - y0)]))
        surface = np.unique(np.concatenate(along).round(9), axis=0)
        inner = []
        for step, least, most in ((spacing, 0.6 * spacing, 3.5), (4 * spacing, 3.5, 99)):
            x, y = np.meshgrid(np.linspace(0, LENGTH, int(round(LENGTH / step)) + 1),
                               np.linspace(0, BASE + HEIGHT, int(round((BASE + HEIGHT) / step)) + 1))
            x, y = x.ravel(), y.ravel()
            depth = np.min(np.hypot(x[:, None] - surface[:, 0], y[:, None] - surface[:, 1]), axis=1)
            keep = (y < ground(x)) & (depth > least) & (depth <= most)
            inner.append(np.column_stack([x, y])[keep])
        points = np.concatenate([surface] + inner)
        return points, np.arange(len(surface))

    def run(self, times, report=None):
        x, y = self.points.T
        p = -5e5 + GAMMA * (ground(x) - y)
        p[~self.free] = 0.0
        start = content(np.where(self.free, p, -5e5))[0]
        time, dt, states = 0.0, 1e-5, []
        for target in times:
            while time < target - 1e-12:
                step = min(dt, target - time)
                new, rounds = self.attempt(p, step)
                if new is None:
                    dt = 0.5 * step
                    continue
                p, time = new, time + step
                if rounds <= 6:
                    dt = 1.4 * step if step == dt else max(dt, step)
                elif rounds > 10:
                    dt = 0.7 * step
            states.append(p.copy())
            if report:
                report(time, p)
        inflow = ((content(p)[0] - start) * self.volume).sum()
        return states, inflow

    def attempt(self, old, dt):
        p = old.copy()
        before = content(old)[0]
        i, j, w = self.i, self.j, self.weight * K_SAT / GAMMA
        rise = GAMMA * self.points[:, 1]
        for round_ in range(15):
            theta, slope = content(p)
            k = relative(p)
            eps = 1e-4 + 1e-6 * np.abs(p)
            dk = (k - relative(p - eps)) / eps
            head = p + rise
            drop = head[i] - head[j]
            mean = 0.5 * (k[i] + k[j])
            flux = w * mean * drop  # from i to j
            r = (theta - before) * self.volume / dt
            np.add.at(r, i, flux)
            np.subtract.at(r, j, flux)
            di, dj = w * (mean + 0.5 * dk[i] * drop), w * (-mean + 0.5 * dk[j] * drop)
            n = len(p)
            rows = np.concatenate([np.arange(n), i, i, j, j])
            columns = np.concatenate([np.arange(n), i, j, i, j])
            values = np.concatenate([slope * self.volume / dt, di, dj, -di, -dj])
            free = self.free
            keep = free[rows] & free[columns]
            number = np.cumsum(free) - 1
            matrix = coo_matrix((values[keep], (number[rows[keep]], number[columns[keep]]))).tocsc()
            change = np.zeros(n)
            change[free] = splu(matrix).solve(-r[free])
            limit = np.maximum(2000.0, 0.4 * np.abs(p))
            change = np.clip(change, -limit, limit)
            change = np.where((p < -5) & (p + change > 0), -0.9 * p, change)
            p = p + change
            if not np.isfinite(p).all():
                return None, 0
            if np.abs(change).max() < 1e-2 + 1e-7 * np.abs(p).max():
                return p, round_ + 1
        return None, 0

    def cells(self, p):
        """Mean S of the cells in the soil at 4 x 4 places each; the suction that belongs to it; centres."""
        s = LinearNDInterpolator(self.points, RESIDUAL + (1 - RESIDUAL) * effective(p)[0])
        part = CELL * (np.arange(4) - 1.5) / 4
        for x in CELL * (np.arange(int(LENGTH / CELL)) + 0.5):
            for y in CELL * (np.arange(int((BASE + HEIGHT) / CELL)) + 0.5):
                if y + 0.5 * CELL > ground(x + 0.5 * CELL) + 1e-9:
                    continue
                mean = float(s(x + part[:, None], y + part[None, :]).mean())
                e = min(max((mean - RESIDUAL) / (1 - RESIDUAL), 1e-12), 1)
                yield x, y, mean, (e ** (-1 / LAMBDA) - 1) ** (1 / N) / ALPHA


def main():
    spacing = float(sys.argv[sys.argv.index("--spacing") + 1]) if "--spacing" in sys.argv else 0.1
    if "--check" in sys.argv:
        for h in (2 * spacing, spacing):
            slope = Slope(h)
            _, inflow = slope.run([1.0, 5.0], lambda t, p: print(f"  t = {t} s", flush=True))
            print(f"spacing {h} m: {len(slope.points)} nodes, area {slope.total_area:.4f} m2, "
                  f"inflow in 5 s {inflow:.4f} m2")
        return
    slope = Slope(spacing)
    states, inflow = slope.run(TIMES, lambda t, p: print(f"  t = {t} s", flush=True))
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "richards_clay_slope.csv")
    with open(path, "w", newline="", encoding="utf-8") as file:
        file.write(f"# richards_slope_2d.py, spacing {spacing} m, inflow in 5 s {inflow:.4f} m2\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["t_s", "x_m", "y_m", "S", "suction_Pa"])
        for t, p in zip(TIMES, states):
            for x, y, s, suction in slope.cells(p):
                rows.writerow([t, x, y, f"{s:.4f}", f"{suction:.0f}"])


if __name__ == "__main__":
    main()
