#!/usr/bin/env python3
"""How Taut scales, by what is counted: messages, bytes, reductions, neighbours, iterations and work of each phase of a
step.

    scripts/scaling.py strong     one cloth on 1, 2, 4 ... 64 ranks
    scripts/scaling.py weak       as many vertices on every rank
    scripts/scaling.py model      what both say of 1024 and 4096 ranks on a network of the given kind

Counts do not need more cores: ranks may outnumber them. What a step takes on the clock does, so it is predicted: work
of the processor, as measured, and a LogGP model [Alexandrov 1995] of what was counted. The model is fitted to at most
16 ranks and compared with what was counted on more. Tables and plots go to cases/scaling.
"""
import argparse
import itertools
import json
import math
import sys
import tempfile
from pathlib import Path

import debian_python  # noqa: F401
import matplotlib
import numpy as np

from studies.table import read_rows, write_rows
from taut import launch

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

CASE = launch.find_case("drape")
PHASES = ("velocity", "projection", "other")  # of a step; what is written and set up is not part of it
FITTED = 16  # ranks up to which the model is fitted
LARGE = (1024, 4096)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("strong", "weak", "model"))
    parser.add_argument("--quick", action="store_true", help="a small cloth, up to 8 ranks")
    parser.add_argument("--out", type=Path, default=launch.ROOT / "cases/scaling", help="where tables and plots go")
    launch.add_program(parser)
    parser.add_argument("--latency", type=float, default=1.5e-6, help="s a message is under way (1.5e-6)")
    parser.add_argument("--overhead", type=float, default=0.5e-6,
                        help="s a message costs its sender, and its receiver (0.5e-6)")
    parser.add_argument("--bandwidth", type=float, default=12.5e9, help="bytes/s of a rank (12.5e9)")
    parser.add_argument("--side", type=int, help="vertices along a side of the cloth that the model predicts (1000)")
    options = parser.parse_args()
    if min(options.latency, options.overhead) < 0 or options.bandwidth <= 0:
        sys.exit("scaling: latency and overhead cannot be negative, and bandwidth must be above 0")
    options.suffix = "-quick" if options.quick else ""
    options.side = options.side or (200 if options.quick else 1000)
    return options


def start(options, ranks, *words):
    done = launch.run(launch.command(options.program, *words, ranks=ranks))
    if done.returncode:
        sys.exit(f"scaling: {' '.join(map(str, words))} on {ranks} ranks: {done.stderr.strip()}")


def settings(side):
    return launch.settings({"cloth.grid.vertices": [side, side]})


def steps_of(side):
    """Four, as long as the mesh lets them be: 0.7 s over the vertices of a side."""
    end = 4 * 0.7 / side
    return launch.settings({"time.max_step": 0.7 / side, "time.end": end, "time.frame_rate": 1 / end,
                            "inextensibility.method": "fast_projection"})


def figures(options, side, ranks):
    """Of the partition, by `taut partition`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "figures.json")
        start(options, 1, "partition", CASE, "--ranks", ranks, "--json", path, *settings(side))
        f = json.loads(path.read_text())
    return {"vertices_of_rank": f["vertices"]["mean"], "imbalance_of_vertices": f["imbalance"],
            "ghosts": f["ghosts"]["mean"],
            "ghost_edges": f["ghost_edges"]["mean"], "neighbours_of_part": f["neighbours"]["mean"],
            "yarn_segments": f["yarn_segments"]["mean"]}


def measure(options, side, ranks):
    """A row a phase: means over the ranks of what a step counts, rejected ones included."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "counters.json")
        start(options, ranks, "run", CASE, "--out", f"{folder}/out", "--counters", path, *steps_of(side),
              *launch.settings({"output.fields": ["position"]}), *settings(side))
        counted = json.loads(path.read_text())
    steps = counted["steps"] + counted["rejected_steps"]
    part = figures(options, side, ranks)
    rows = []
    for name in PHASES:
        phase = counted["phases"][name]
        a_step = {key: phase[key]["mean"] / steps
                  for key in ("seconds", "work_seconds", "messages", "bytes", "reductions", "halo_updates",
                              "halo_messages")}
        rows.append({"side": side, "ranks": ranks, "phase": name, "steps": steps,
                     "solves": phase.get("solves", 0) / steps, "iterations": phase.get("iterations", 0) / steps,
                     **a_step, "messages_max": phase["messages"]["max"] / steps,
                     "bytes_max": phase["bytes"]["max"] / steps,
                     "neighbours": phase["neighbours"]["mean"], "imbalance": phase["imbalance"], **part})
        if name != "other":
            print(f"{ranks:>4} ranks  {side} x {side}  {name:<10}  {rows[-1]['solves']:4.1f} solves "
                  f" {rows[-1]['iterations']:6.1f} iterations  {a_step['messages']:8.1f} messages  "
                  f"{a_step['bytes'] / 1000:9.1f} kB  {a_step['reductions']:6.1f} reductions "
                  f" {rows[-1]['neighbours']:5.1f} neighbours  "
                  f"{1000 * a_step['work_seconds']:8.2f} ms of work", flush=True)
    return rows


def write(path, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    write_rows(path, rows)


def read(path):
    if not path.exists():
        sys.exit(f"scaling: {path}: no such table; make it with scripts/scaling.py {path.stem.split('-')[0]}")
    return read_rows(path)


def study(options):
    ranks = (1, 2, 4, 8) if options.quick else (1, 2, 4, 8, 16, 32, 64)
    side = (lambda p: 41) if options.quick else (lambda p: 141)
    if options.what == "weak":
        base = 20 if options.quick else 36
        side = lambda p: round(base * math.sqrt(p))  # noqa: E731
    rows = [row for p in ranks for row in measure(options, side(p), p)]
    stem = options.out / f"{options.what}{options.suffix}"
    write(stem.with_suffix(".csv"), rows)
    draw_counts(stem.with_suffix(".png"), rows)
    print(f"{stem}.csv, {stem}.png")


def draw_counts(path, rows):
    figure, axes = plt.subplots(2, 3, figsize=(13, 7), layout="constrained")
    kinds = (("iterations", "CG iterations of all solves"), ("messages", "messages of a rank"),
             ("bytes", "bytes of a rank"),
             ("reductions", "reductions"), ("neighbours", "neighbours"), ("work_seconds", "work of a rank, s"))
    for panel, (key, label) in zip(axes.flat, kinds):
        for name in ("velocity", "projection"):
            mine = [row for row in rows if row["phase"] == name]
            panel.plot([r["ranks"] for r in mine], [r[key] for r in mine], "o-", label=name)
        panel.set(xscale="log", xlabel="ranks", title=label + ("" if key == "neighbours" else " a step"))
        panel.set_xticks(sorted({r["ranks"] for r in rows}), [str(int(p)) for p in sorted({r["ranks"] for r in rows})])
        if key == "work_seconds":
            panel.set_yscale("log")
        else:
            panel.set_ylim(bottom=0)
        panel.grid(alpha=0.3)
    axes[0, 0].legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


# What each count of a phase may be made of: non-negative multiples of these.
FEATURES = {
    "iterations": {"solves": lambda r: r["solves"],
                   "solves x log2 ranks": lambda r: r["solves"] * math.log2(r["ranks"]),
                   "solves x log2 side": lambda r: r["solves"] * math.log2(r["side"])},
    "reductions": {"1": lambda r: 1.0, "iterations": lambda r: r["iterations"]},
    "halo_updates": {"1": lambda r: 1.0, "iterations": lambda r: r["iterations"]},
    "messages": {"iterations x neighbours": lambda r: r["iterations"] * r["neighbours_of_part"],
                 "iterations x sqrt ranks": lambda r: r["iterations"] * min(r["yarn_segments"], math.sqrt(r["ranks"]))},
    "bytes": {"iterations x ghosts": lambda r: r["iterations"] * r["ghosts"],
              "iterations x yarn segments": lambda r: r["iterations"] * (r["yarn_segments"]
                                                                         if r["ranks"] > 1 else 0.0)},
    "work_seconds": {"vertices": lambda r: r["vertices_of_rank"], "1": lambda r: 1.0,
                     "iterations x vertices": lambda r: r["iterations"] * r["vertices_of_rank"],
                     "iterations x ghosts": lambda r: r["iterations"] * r["ghosts"],
                     "iterations": lambda r: r["iterations"]},
}


def fit(key, rows):
    """The coefficients that miss least, relative to what was counted. With so few features all subsets can be tried."""
    kept = [r for r in rows if r[key] > 0]
    names = list(FEATURES[key])
    if not kept:
        return dict.fromkeys(names, 0.0)
    matrix = np.array([[FEATURES[key][n](r) / r[key] for n in names] for r in kept])
    best, least = dict.fromkeys(names, 0.0), math.inf
    for size in range(1, len(names) + 1):
        for chosen in itertools.combinations(range(len(names)), size):
            solution = np.linalg.lstsq(matrix[:, chosen], np.ones(len(kept)), rcond=None)[0]
            miss = np.abs(matrix[:, chosen] @ solution - 1).sum()
            if (solution >= 0).all() and miss < least - 1e-12:
                best, least = {n: 0.0 for n in names} | {names[c]: float(x) for c, x in zip(chosen, solution)}, miss
    return best


def predict(fits, row):
    """The counts of a phase where only the partition, and how many systems a step solves, is known."""
    row = dict(row)
    for key in FEATURES:
        row[key] = sum(c * FEATURES[key][n](row) for n, c in fits[key].items())
        if row["ranks"] == 1 and key in ("messages", "bytes", "reductions"):
            row[key] = 0.0
    return row


def seconds(row, options):
    """LogGP: a message costs its two ends `overhead` each and is under way for `latency`; messages of one exchange are
    under way together; a reduction is ceil(log2 ranks) messages one after the other. Whoever has most vertices sets the
    pace."""
    work = row["work_seconds"] * row["imbalance_of_vertices"]
    rounds = row["halo_updates"] if row["ranks"] > 1 else 0
    halos = 2 * options.overhead * row["messages"] + options.latency * rounds + row["bytes"] / options.bandwidth
    reductions = row["reductions"] * math.ceil(math.log2(row["ranks"])) * (options.latency + 2 * options.overhead)
    return {"work": work, "halos": halos, "reductions": reductions}


def model(options):
    rows = [row for what in ("strong", "weak") for row in read(options.out / f"{what}{options.suffix}.csv")]
    fitted = 4 if options.quick else FITTED
    fits = {p: {key: fit(key, [r for r in rows if r["phase"] == p and r["ranks"] <= fitted]) for key in FEATURES}
            for p in PHASES}
    lines = [f"Fitted to at most {fitted} ranks. Predicted over counted on more:", ""]
    errors = []
    for row in (r for r in rows if r["ranks"] > fitted and r["phase"] != "other"):
        guess = predict(fits[row["phase"]], row)
        ratios = {key: guess[key] / row[key] for key in FEATURES if row[key] > 0}
        errors.append({"side": row["side"], "ranks": row["ranks"], "phase": row["phase"], **ratios})
        lines.append(f"  {row['side']:>5.0f}² on {row['ranks']:>3.0f}  {row['phase']:<10}  " +
                     "  ".join(f"{key.split('_')[0]} {ratio:.2f}" for key, ratio in ratios.items()))
    for key in FEATURES:
        off = [abs(e[key] - 1) for e in errors if key in e]
        lines.append(f"  {key}: off by {100 * np.mean(off):.0f} % on average, {100 * max(off):.0f} % at most")
    lines += ["", f"A step of {options.side} x {options.side} vertices, ms "
              f"(latency {options.latency * 1e6:g} us, overhead {options.overhead * 1e6:g} us, "
              f"{options.bandwidth / 1e9:g} GB/s a rank):", "",
              f"  {'ranks':>5} {'vertices':>9} {'work':>9} {'halos':>9} {'reductions':>10} {'step':>9} {'speed-up':>9} "
              f"{'efficiency':>10}"]
    solves = {p: float(np.mean([r["solves"] for r in rows if r["phase"] == p and r["side"] == rows[0]["side"]]))
              for p in PHASES}
    lines.insert(-2, f"  with {solves['projection']:.1f} projections, as many as at {rows[0]['side']:.0f} x "
                     f"{rows[0]['side']:.0f}")
    table, alone = [], None
    for ranks in (1, 4, 16, 64, 256, *LARGE):
        part = {**figures(options, options.side, ranks), "ranks": ranks, "side": options.side}
        terms = [seconds(predict(fits[p], {**part, "solves": solves[p]}), options) for p in PHASES]
        total = {key: sum(t[key] for t in terms) for key in terms[0]}
        step = sum(total.values())
        alone = alone or step
        table.append({"side": options.side, "ranks": ranks, **total, "step": step, "efficiency": alone / step / ranks})
        lines.append(f"  {ranks:>5} {part['vertices_of_rank']:>9.0f} " + " ".join(f"{1000 * total[k]:>{w}.3f}"
                                                                                  for k, w in
                     (("work", 9), ("halos", 9), ("reductions", 10))) +
                     f" {1000 * step:>9.3f} {alone / step:>9.0f} {100 * alone / step / ranks:>9.0f}%")
    stem = options.out / f"model{options.suffix}"
    write(stem.with_suffix(".csv"), table)
    stem.with_suffix(".txt").write_text("\n".join(lines) + "\n")
    draw_model(stem.with_suffix(".png"), table)
    print("\n".join(lines))


def draw_model(path, table):
    figure, axis = plt.subplots(figsize=(7, 5), layout="constrained")
    ranks = [row["ranks"] for row in table]
    for key in ("step", "work", "halos", "reductions"):
        axis.plot(ranks, [1000 * row[key] if row[key] else float("nan") for row in table], "o-", label=key)
    axis.plot(ranks, [1000 * table[0]["step"] / p for p in ranks], "k:", label="ideal")
    axis.set(xscale="log", yscale="log", xlabel="ranks", ylabel="ms a step",
             title=f"{table[0]['side']} x {table[0]['side']} vertices, predicted")
    axis.set_xticks(ranks, [str(p) for p in ranks])
    axis.grid(alpha=0.3)
    axis.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


if __name__ == "__main__":
    chosen = arguments()
    model(chosen) if chosen.what == "model" else study(chosen)
