#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Richards' equation for a rigid column of 2 m of sand; writes richards_profiles.csv and
richards_history.csv beside this file.

Finite volumes in the mixed form, backward Euler, full Newton, conductivity of a face the mean of
its two cells; standard library only. Sand: Tarantino's curve ([Zhan] Eq. (14)) at the fixed void ratio
e = n / (1 - n), that is van Genuchten with alpha = a e^((1 - m)/m), a = 3 1/m, m = 0.63, S_res = 0;
n = 0.4; Mualem, k_sat = 1e-4 m/s; g = 9.81 m/s2. Cases:
  rain0.3, rain3  rain of 0.3 and 3 k_sat on S = 0.3; what does not enter is a pond of depth d whose
                  pressure gamma d acts on the ground; closed base
  zero_suction    p = 0 held at the top of S = 0.3; closed base
  drainage, rise  closed column, S = 0.9 in the upper (lower) half, 0.2 in the other
  1:2, 1:1        rain of 0.3 and 3 k_sat on infinite slopes of 26.6 and 45 degrees, along the normal:
                  gravity g cos, rain r cos per slope area; what does not enter runs off and leaves p = 0
                  at the ground; written to richards_slope.csv (--slopes writes this one alone)
Run with --check for the dependence on the grid and on the step.
"""
import csv
import math
import os
import sys

HEIGHT, N_POROSITY, K_SAT, M = 2.0, 0.4, 1e-4, 0.63
A = 3.0 * (N_POROSITY / (1 - N_POROSITY)) ** ((1 - M) / M)
GAMMA = 9810.0
PROFILE_AT = [0.0125 + 0.025 * i for i in range(80)]


def saturation(p):
    """S and dS/dp."""
    if p >= 0:
        return 1.0, 0.0
    x = (-p * A / GAMMA) ** (1 / (1 - M))
    s = (1 + x) ** -M
    return s, M / (1 - M) * s * x / (1 + x) / -p


def pressure(s):
    return -GAMMA / A * (s ** (-1 / M) - 1) ** (1 - M)


def conductivity(s):
    if s >= 1:
        return K_SAT
    return K_SAT * math.sqrt(s) * (1 - (1 - s ** (1 / M)) ** M) ** 2


class Column:
    def __init__(self, cells, start, rain=None, held_top=False, fall=None):
        self.n, self.dz = cells, HEIGHT / cells
        self.p = [pressure(start((i + 0.5) * self.dz)) for i in range(cells)]
        self.rain, self.held_top = rain, held_top
        self.runs_off, self.down = fall is not None, 1.0  # down: g and rain along the normal
        if self.runs_off:
            self.down = 1 / math.sqrt(1 + fall * fall)
            self.rain *= self.down
        self.runoff = 0.0
        self.pond = self.inflow = self.time = 0.0
        self.ponding = None

    def content(self):
        return sum(N_POROSITY * saturation(p)[0] for p in self.p) * self.dz

    def attempt(self, dt, surface):
        """One step. surface: 'held', 'flux' or 'pond'. Returns (p, pond, inflow rate) or None."""
        n, dz = self.n, self.dz
        old = [N_POROSITY * saturation(p)[0] for p in self.p]
        p, pond = list(self.p), self.pond
        for _ in range(25):
            s = [saturation(v) for v in p]
            k = [conductivity(v[0]) for v in s]
            dk = []
            for v, (sv, _), kv in zip(p, s, k):
                e = 1e-4 + 1e-6 * abs(v)
                dk.append((kv - conductivity(saturation(v - e)[0])) / e)
            # 1e-12 1/Pa: the compressibility that keeps full columns regular.
            diagonal = [(N_POROSITY * sv[1] + 1e-12) * dz / dt for sv in s]
            lower, upper = [0.0] * n, [0.0] * n
            r = [-(N_POROSITY * s[i][0] - old[i] + 1e-12 * (p[i] - self.p[i])) * dz / dt
                 for i in range(n)]
            for i in range(n - 1):
                mean = 0.5 * (k[i] + k[i + 1])
                h = (p[i + 1] - p[i]) / (GAMMA * dz) + self.down
                q = mean * h  # downwards
                a = -mean / (GAMMA * dz) + 0.5 * dk[i] * h
                b = mean / (GAMMA * dz) + 0.5 * dk[i + 1] * h
                r[i] += q
                r[i + 1] -= q
                diagonal[i] -= a
                upper[i] -= b
                diagonal[i + 1] += b
                lower[i + 1] += a
            if surface == "flux":
                q = self.rain + self.pond / dt
            else:
                top = 0.0 if surface == "held" else GAMMA * pond
                mean = 0.5 * (K_SAT + k[-1])
                h = (top - p[-1]) / (GAMMA * 0.5 * dz) + self.down
                q = mean * h
                diagonal[-1] -= -mean / (GAMMA * 0.5 * dz) + 0.5 * dk[-1] * h
                if surface == "pond":
                    # pond = old + dt (rain - q) couples the last row to itself.
                    pond = max(0.0, self.pond + dt * (self.rain - q))
            r[-1] += q
            for i in range(1, n):
                f = lower[i] / diagonal[i - 1]
                diagonal[i] -= f * upper[i - 1]
                r[i] -= f * r[i - 1]
            d = [0.0] * n
            d[-1] = r[-1] / diagonal[-1]
            for i in range(n - 2, -1, -1):
                d[i] = (r[i] - upper[i] * d[i + 1]) / diagonal[i]
            for i in range(n):
                limit = max(2000.0, 0.4 * abs(p[i]))
                step = max(-limit, min(limit, d[i]))
                if p[i] < -5 and p[i] + step > 0:
                    step = -0.9 * p[i]
                p[i] += step
            if max(abs(v) for v in d) < 1e-3:
                return p, pond, q
        return None

    def step(self, dt):
        surface = "held" if self.held_top else "flux"
        if self.rain is None and not self.held_top:
            self.rain = 0.0
        result = self.attempt(dt, surface)
        if surface == "flux" and self.rain > 0:
            # Given more than it can take, the surface cell would need p > 0 at the ground.
            over = result is None
            if not over:
                p, _, q = result
                k = 0.5 * (K_SAT + conductivity(saturation(p[-1])[0]))
                over = q > k * (-p[-1] / (GAMMA * 0.5 * self.dz) + self.down)
            if over:
                result = self.attempt(dt, "held" if self.runs_off else "pond")
                if result is not None and self.ponding is None:
                    self.ponding = self.time + 0.5 * dt
            elif result is not None:
                result = (result[0], 0.0, result[2])
        if result is None:
            return False
        self.p, self.pond, q = result
        if self.runs_off:
            self.runoff += dt * (self.rain - q)
        self.inflow += dt * q
        self.time += dt
        return True

    def run_to(self, t, dt_max):
        dt = getattr(self, "dt", 1e-3)
        while self.time < t - 1e-9:
            d = min(dt, dt_max, t - self.time)
            if self.step(d):
                dt = min(dt_max, 1.2 * max(d, dt if d < dt else d))
            else:
                dt = 0.4 * d
                if dt < 1e-9:
                    raise RuntimeError("step collapsed at t = %g s" % self.time)
        self.dt = dt

    def profile(self):
        """S at PROFILE_AT, linear between cell centres."""
        s = [saturation(p)[0] for p in self.p]
        out = []
        for z in PROFILE_AT:
            x = z / self.dz - 0.5
            i = max(0, min(self.n - 2, int(math.floor(x))))
            out.append(s[i] + (x - i) * (s[i + 1] - s[i]))
        return out


CASES = {
    "rain0.3": (dict(start=lambda z: 0.3, rain=0.3 * K_SAT), [600, 1500, 3000, 4500]),
    "rain3": (dict(start=lambda z: 0.3, rain=3 * K_SAT), [100, 300, 600, 1200]),
    "zero_suction": (dict(start=lambda z: 0.3, held_top=True), [100, 300, 600, 900, 1200, 1800]),
    "drainage": (dict(start=lambda z: 0.9 if z > 1 else 0.2), [600, 1800, 5400]),
    "rise": (dict(start=lambda z: 0.2 if z > 1 else 0.9), [600, 1800, 5400]),
}


SLOPES = {
    name + " " + rain: (dict(start=lambda z: 0.3, rain=factor * K_SAT, fall=fall),
                        [100, 200, 300, 600])
    for name, fall in (("1:2", 0.5), ("1:1", 1.0)) for rain, factor in (("rain0.3", 0.3),
                                                                        ("rain3", 3))
}


def write_slopes(folder):
    with open(os.path.join(folder, "richards_slope.csv"), "w", newline="") as f:
        rows = csv.writer(f)
        rows.writerow(["case", "t_s", "inflow_m", "runoff_m", "ponding_s"])
        for name, (arguments, times) in SLOPES.items():
            column = Column(400, **arguments)
            w0 = column.content()
            for t in times:
                column.run_to(t, 1.0)
                closure = column.content() - w0 - column.inflow
                assert abs(closure) < 1e-5, (name, t, closure)
                rows.writerow([name, t, "%.6f" % column.inflow, "%.6f" % column.runoff,
                               "" if column.ponding is None else "%.2f" % column.ponding])
            print(name, column.inflow, column.runoff, "ponding", column.ponding, flush=True)


def run(name, cells, dt_max):
    arguments, times = CASES[name]
    column = Column(cells, **arguments)
    w0 = column.content()
    out = []
    for t in times:
        column.run_to(t, dt_max)
        closure = column.content() - w0 - column.inflow
        out.append((t, column.inflow, column.pond, closure, column.profile()))
    return column, out


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    if "--check" in sys.argv:
        for name in CASES:
            for cells, dt in ((100, 2.0), (200, 2.0), (200, 1.0), (400, 1.0)):
                column, out = run(name, cells, dt)
                print(name, cells, dt, "ponding", column.ponding,
                      ["%g: %.5f %.5f %.1e" % o[:4] for o in out], flush=True)
        return
    write_slopes(here)
    if "--slopes" in sys.argv:
        return
    with open(os.path.join(here, "richards_profiles.csv"), "w", newline="") as f, \
            open(os.path.join(here, "richards_history.csv"), "w", newline="") as g:
        profiles, history = csv.writer(f), csv.writer(g)
        profiles.writerow(["case", "t_s", "z_m", "S"])
        history.writerow(["case", "t_s", "inflow_m", "pond_m", "ponding_s"])
        for name in CASES:
            column, out = run(name, 400, 1.0)
            for t, inflow, pond, closure, profile in out:
                assert abs(closure) < 1e-5, (name, t, closure)
                history.writerow([name, t, "%.6f" % inflow, "%.6f" % pond,
                                  "" if column.ponding is None else "%.2f" % column.ponding])
                for z, s in zip(PROFILE_AT, profile):
                    profiles.writerow([name, t, "%.4f" % z, "%.5f" % s])
            print(name, ["%g: %.5f %.5f" % o[:3] for o in out], "ponding", column.ponding,
                  flush=True)


if __name__ == "__main__":
    main()
