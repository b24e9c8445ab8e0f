#!/usr/bin/env python3
"""Compares Taut with formulas, published bands and solutions found without it: scripts/validate [NAME...]

  scripts/validate                      all of them; writes cases/validation/table.csv and .md, and of each its points
                                        (NAME.csv) and a plot (NAME.png)
  scripts/validate cantilever --quick   small versions, in seconds; they go to out/validation

A point that is in NAME.csv already is not run again: what was interrupted goes on where it was. Ends with 0 if every
value is within its tolerance, else with 1.
"""
import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from studies.runs import ROOT, Laboratory
from studies.table import Table
from validations import VALIDATIONS
from validations.checks import write_table

NAMES = {validation.name: validation for validation in VALIDATIONS}


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {' '.join(NAMES)}")
    parser.add_argument("--quick", action="store_true", help="small versions")
    parser.add_argument("--limit", type=float, default=600, help="seconds for a run (default: %(default)g)")
    parser.add_argument("--out", type=Path, help="default: cases/validation; with --quick: out/validation")
    parser.add_argument("--program", type=Path, default=ROOT / "build/taut", help="default: %(default)s")
    parser.add_argument("--launch", default="", help="what starts a run on its ranks, e.g. 'mpirun -n 2'; default: one rank")
    options = parser.parse_args()
    if unknown := [name for name in options.names if name not in NAMES]:
        parser.error(f"no validation is called {unknown[0]}; there are {', '.join(NAMES)}")
    options.out = options.out or ROOT / ("out/validation" if options.quick else "cases/validation")
    return options


def points_of(validation, options):
    return Table(options.out / f"{validation.name}.csv", validation.keys)


def run(validation, options):
    table = points_of(validation, options)
    with Laboratory(options.program, options.out / validation.name, options.limit, options.launch.split()) as laboratory:
        for point in validation.plan(options.quick):
            if table.has(point):
                continue
            print(f"{validation.name}:", "  ".join(f"{key} {value}" for key, value in point.items()), flush=True)
            found = validation.measure(laboratory, point)
            table.add([{**point, **row} for row in (found if isinstance(found, list) else [found])])
    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    validation.draw(axes, table.rows)
    figure.savefig(options.out / f"{validation.name}.png", dpi=110)
    plt.close(figure)
    for check in validation.judge(table.rows):
        print(f"  {check}", flush=True)


def main():
    options = parse()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.names or NAMES:
        run(NAMES[name], options)
    complete = []
    for validation in VALIDATIONS:
        table = points_of(validation, options)
        if all(table.has(point) for point in validation.plan(options.quick)):
            complete.append((validation, validation.judge(table.rows)))
    write_table(options.out, complete)
    chosen = [check for validation, checks in complete if not options.names or validation.name in options.names for check in checks]
    missed = [check for check in chosen if check.missed]
    print(f"{len(chosen) - len(missed)} of {len(chosen)} values are within their tolerance or have none")
    sys.exit(1 if missed else 0)


main()
