#!/usr/bin/env python3
"""Repeats the figures of the papers, and what else is worth comparing: a table, a plot and a verdict each.

  scripts/study.py figure-4a            writes cases/studies/figure-4a.csv, .png and .txt (the verdict)
  scripts/study.py figure-5a --quick    a small version in under a minute: figure-5a-quick.csv, ...

A row that is in the table already is not run again: a study that was interrupted goes on where it was. Costs are CPU
seconds of the time steps, without set-up and output. Ends with 0 if the verdict is that the claim holds, else with 1.
"""
import argparse
import sys
from pathlib import Path

import debian_python  # noqa: F401

from studies import (contact_models, figure_1, figure_3, figure_4, figure_5, figure_6, figure_7, locking, resolution,
                     shake_failures)
from studies.experiment import Experiment, Laboratory
from taut import launch

SINGLE = (figure_1, figure_3, figure_6, figure_7, shake_failures, locking, resolution, contact_models)
STUDIES = {study.name: study for study in (*map(Experiment.of, SINGLE), *figure_4.STUDIES, *figure_5.STUDIES)}


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=sorted(STUDIES))
    parser.add_argument("--quick", action="store_true", help="a small version")
    parser.add_argument("--limit", type=float, default=300,
                        help="seconds for a run; one that takes longer is stopped and counts as far as it came "
                             "(default: 300)")
    parser.add_argument("--out", type=Path, default=launch.ROOT / "cases/studies", help="default: %(default)s")
    launch.add_program(parser)
    return parser.parse_args()


def main():
    options = parse()
    study = STUDIES[options.study]
    options.out.mkdir(parents=True, exist_ok=True)
    stem = options.out / (study.name + ("-quick" if options.quick else ""))
    with Laboratory(options.program, stem, options.limit) as laboratory:
        rows = study.fill(stem.with_suffix(".csv"), laboratory, options.quick).rows
    study.plot(rows, stem.with_suffix(".png"))
    holds, findings = study.judge(rows)
    text = f"{study.name}: {study.about}\n{findings}\nThe claim {'holds' if holds else 'does not hold'} here.\n"
    stem.with_suffix(".txt").write_text(text)
    print(text, end="")
    sys.exit(0 if holds else 1)


main()
