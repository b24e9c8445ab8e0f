"""A study, and its table: a CSV file that is whole at any moment."""
import csv
import os
import platform
from typing import Callable, NamedTuple


class Study(NamedTuple):
    name: str
    claim: str  # of the paper, or of Taut
    keys: list  # the columns that tell the points of the plan apart
    plan: Callable  # (quick) -> points: dicts with the keys
    measure: Callable  # (laboratory, point) -> a row, or a list of rows: what was measured there
    draw: Callable  # (axes, rows)
    judge: Callable  # (rows) -> (whether the claim holds, the findings in words)


def machine():
    model = platform.machine()
    with open("/proc/cpuinfo") as file:
        model = next((line.split(":")[1].strip() for line in file if line.startswith("model name")), model)
    return f"{model}; {os.cpu_count()} cores"


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


class Table:
    """Rows are dicts of numbers and words. Cells are compared as they stand in the file, so that a point is found again."""

    def __init__(self, path, keys):
        self.path, self.keys, self.rows = path, keys, []
        if path.exists():
            with open(path, newline="") as file:
                self.rows = [{name: number(cell) for name, cell in row.items()} for row in csv.DictReader(file)]

    def has(self, point):
        wanted = {key: number(self.cell(point[key])) for key in self.keys}
        return any(all(row[key] == wanted[key] for key in self.keys) for row in self.rows)

    def add(self, rows):
        stamped = [{**row, "machine": machine()} for row in rows]
        self.rows += [{name: number(self.cell(value)) for name, value in row.items()} for row in stamped]
        names = [*dict.fromkeys(name for row in self.rows for name in row if name != "machine"), "machine"]
        aside = self.path.with_suffix(".part")
        with open(aside, "w", newline="") as file:
            writer = csv.DictWriter(file, names, lineterminator="\n")
            writer.writeheader()
            writer.writerows([{name: self.cell(value) for name, value in row.items()} for row in self.rows])
        aside.replace(self.path)

    @staticmethod
    def cell(value):
        return f"{value:.6g}" if isinstance(value, float) else str(value)
