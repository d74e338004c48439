# SPDX-License-Identifier: MIT
"""Pictures of the 1D examples of water: python3 columns.py [folder with the results] [folder for the pictures]

Draws rain_column.png from rain_column_*.csv and pond.png from pond.csv, where they are. Needs
matplotlib.
"""

import os
import sys

import numpy as np

from slope import plt, read_csv


def draw_rain(folder, path):
    """Profiles of S and where the water is, for both rains."""
    profiles = read_csv(os.path.join(folder, "rain_column_profiles.csv"))
    balance = read_csv(os.path.join(folder, "rain_column_balance.csv"))
    figure, axes = plt.subplots(2, 2, figsize=(11, 8))
    for row, rain in enumerate(np.unique(balance["rain"])):
        for time in np.unique(profiles["time"]):
            here = (profiles["rain"] == rain) & (profiles["time"] == time)
            axes[row, 0].plot(profiles["saturation"][here], profiles["height"][here], ".-",
                              label=f"{time:.0f} s")
        axes[row, 0].set(xlim=(0, 1.02), xlabel="degree of saturation [-]", ylabel="height [m]",
                         title=f"rain of {rain:g} k_sat")
        here = balance["rain"] == rain
        for name in ("fallen", "infiltrated", "film", "free_water"):
            axes[row, 1].plot(balance["time"][here], balance[name][here],
                              label=name.replace("_", " "))
        axes[row, 1].set(xlabel="time [s]", ylabel="water [kg/m2]")
    for axis in axes.flat:
        axis.grid(color="0.9")
        axis.legend(frameon=False, fontsize=10.5)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def draw_pond(folder, path):
    """Depth of the pond and heave of the clay."""
    history = read_csv(os.path.join(folder, "pond.csv"))
    figure, axis = plt.subplots(figsize=(8, 4.5))
    axis.plot(history["time"], history["pond"], label="pond")
    axis.plot(history["time"], history["heave"], label="heave")
    axis.set(xlabel="time [s]", ylabel="[m]")
    axis.grid(color="0.9")
    axis.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "."
    target = sys.argv[2] if len(sys.argv) > 2 else folder
    os.makedirs(target, exist_ok=True)
    for needs, draw, name in (("rain_column_balance.csv", draw_rain, "rain_column.png"),
                              ("pond.csv", draw_pond, "pond.png")):
        if os.path.exists(os.path.join(folder, needs)):
            draw(folder, os.path.join(target, name))
            print("picture:", os.path.abspath(os.path.join(target, name)))


if __name__ == "__main__":
    main()
