"""Draws how a run went: strain, iterations, energies and seconds by phase over simulated time. Started by scripts/plot.

Strain is drawn with the limit of the run, where its summary.json tells one. Energies are drawn relative to the first
step; what the solver carries from step to step (carried_...) is no energy of the cloth and left out. Seconds are those
on the clock for each simulated second, so that runs with different steps compare.
"""
import argparse
import csv
import json
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import MaxNLocator

ITERATIONS = {"projection_iterations": "projections", "projection_ksp_iterations": "CG, projections",
              "velocity_ksp_iterations": "CG, velocity"}
REQUIRED = ["time_s", "dt_s", "rejected", "strain_max", "strain_rms", *ITERATIONS]


class PlotError(Exception):
    """What the user can mend, in words."""


def number(text):
    return float(text) if text else math.nan  # empty: a column that an earlier part of the run did not have


def read_steps(path):
    """{column: values} of the rows that are whole."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            rows = [row for row in reader if None not in row and None not in row.values()]
            names = reader.fieldnames or []
    except FileNotFoundError:
        raise PlotError(f"{path}: no such file; give the output folder of a run") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise PlotError(f"{path}: cannot be read: {error}") from None
    missing = [name for name in REQUIRED if name not in names]
    if missing:
        raise PlotError(f"{path}: no table of the steps of a run: it has no column {missing[0]}")
    if not rows:
        raise PlotError(f"{path}: holds no steps yet")
    try:
        return {name: [number(row[name]) for row in rows] for name in names}
    except ValueError as error:
        raise PlotError(f"{path}: {error}") from None


def read_limit(path):
    """The largest strain the run allowed, or None: it keeps no limit, or has not come to its end."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))["strain"]["limit"]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def draw_strain(axes, steps, limit):
    axes.semilogy(steps["time_s"], steps["strain_max"], label="largest")
    axes.semilogy(steps["time_s"], steps["strain_rms"], label="root mean square")
    if limit is not None:
        axes.axhline(limit, color="0.3", linestyle="--", linewidth=1, label=f"limit, {limit:g}")
    axes.set_ylabel("strain")


def draw_iterations(axes, steps):
    for name, label in ITERATIONS.items():
        axes.plot(steps["time_s"], steps[name], drawstyle="steps-pre", label=label)
    rejected = [(t, n) for t, n in zip(steps["time_s"], steps["rejected"]) if n > 0]
    if rejected:
        axes.plot([t for t, _ in rejected], [n for _, n in rejected], "kx", markersize=5, label="rejected attempts")
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylabel("a step")


def energies_of(steps):
    """{label: values} of what the cloth has, and of its sum."""
    parts = {name[:-2]: values for name, values in steps.items()
             if name.endswith("_J") and not name.startswith("carried_")}
    relative = {name: [v - values[0] for v in values] for name, values in parts.items()}
    return {**relative, "sum": [math.fsum(v) for v in zip(*relative.values())]}


def draw_energies(axes, steps):
    for name, values in energies_of(steps).items():
        axes.plot(steps["time_s"], values, label=name.replace("_", " "),
                  **({"color": "black", "linewidth": 1} if name == "sum" else {}))
    axes.set_ylabel("J, since the first step")


def draw_seconds(axes, steps):
    phases = [name for name in ("velocity_s", "projection_s", "contact_s") if name in steps and any(steps[name])]
    costs = [[s / dt for s, dt in zip(steps[name], steps["dt_s"])] for name in phases]
    axes.stackplot(steps["time_s"], costs, labels=[name[:-2] for name in phases], step="pre", alpha=0.85)
    axes.set_ylabel("s on the clock per simulated s")


def draw(steps, limit, title):
    figure, ((strain, iterations), (energies, seconds)) = plt.subplots(2, 2, figsize=(11, 7.5), sharex=True,
                                                                       layout="constrained")
    draw_strain(strain, steps, limit)
    draw_iterations(iterations, steps)
    draw_energies(energies, steps)
    draw_seconds(seconds, steps)
    for axes, name in ((strain, "strain"), (iterations, "iterations"), (energies, "energies"), (seconds, "seconds by phase")):
        axes.set_title(name, loc="left", fontsize="medium")
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small")
    for axes in (energies, seconds):
        axes.set_xlabel("simulated time (s)")
    figure.suptitle(f"{title}: {len(steps['time_s'])} steps, {sum(steps['rejected']):.0f} rejected attempts")
    return figure


def main():
    parser = argparse.ArgumentParser(prog="scripts/plot", description="Draws strain, iterations, energies and seconds by phase of a run.")
    parser.add_argument("run_folder", type=Path)
    parser.add_argument("--output", type=Path, help="default: steps.png in the run's folder")
    options = parser.parse_args()
    output = options.output or options.run_folder / "steps.png"
    try:
        steps = read_steps(options.run_folder / "steps.csv")
        figure = draw(steps, read_limit(options.run_folder / "summary.json"), options.run_folder.resolve().name)
        figure.savefig(output, dpi=110)
    except PlotError as error:
        sys.exit(f"plot: {error}")
    except (OSError, ValueError) as error:
        sys.exit(f"plot: {output}: cannot be written: {error}")
    print(output)


main()
