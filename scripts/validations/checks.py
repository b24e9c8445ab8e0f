"""The verdicts of validations, and the table of all of them."""
import csv
import math
import textwrap
from typing import NamedTuple

from studies.table import machine


class Check(NamedTuple):
    """A measured value against an expected one. `reference` says where the expected one is from."""
    quantity: str
    unit: str
    expected: float
    tolerance: float  # of the difference, in the unit
    measured: float
    reference: str

    @property
    def missed(self):
        return not math.isnan(self.expected) and not abs(self.measured - self.expected) <= self.tolerance

    @property
    def verdict(self):
        return "no reference" if math.isnan(self.expected) else "missed" if self.missed else "met"

    def cells(self):
        numbers = ("" if math.isnan(value) else f"{value:.6g}"
                   for value in (self.expected, self.measured, self.tolerance))
        return [self.quantity, self.unit, *numbers, self.verdict, self.reference]

    def __str__(self):
        expected = f"{self.expected:.6g} +- {self.tolerance:.3g}"
        return f"{self.verdict}: {self.quantity}: {self.measured:.6g} {self.unit}, expected {expected}"


def band(quantity, unit, low, high, measured, reference):
    """A value that is to lie between two."""
    return Check(quantity, unit, (low + high) / 2, (high - low) / 2, measured, reference)


def unjudged(quantity, unit, measured, reason):
    """A value that nothing is known to compare with."""
    return Check(quantity, unit, math.nan, math.nan, measured, reason)


COLUMNS = ["quantity", "unit", "expected", "measured", "tolerance", "verdict", "reference"]


def write_table(folder, judged):
    """table.csv and table.md from [(validation, checks)]."""
    with open(folder / "table.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["validation", *COLUMNS])
        for validation, checks in judged:
            writer.writerows([validation.name, *check.cells()] for check in checks)
    checks = [check for _, some in judged for check in some]
    missed = sum(check.missed for check in checks)
    lines = ["# Expected and measured", "",
             f"{len(checks)} values, {missed} of them outside their tolerance. Machine: {machine()}. Made by "
             f"`scripts/validate`."]
    for validation, checks in judged:
        lines += ["", f"## {validation.name}", "", textwrap.fill(validation.about, 118), "",
                  f"![{validation.name}]({validation.name}.png)", "",
                  "| " + " | ".join(COLUMNS) + " |", "| --- " * len(COLUMNS) + "|"]
        lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in check.cells()).replace("| missed |",
                                                                                                "| **missed** |") + " |"
                  for check in checks]
    (folder / "table.md").write_text("\n".join(lines) + "\n")
