"""Tables of what was measured: CSV files that are whole at any moment."""
import csv
import os
import platform


def machine():
    """Its processor."""
    model = platform.machine()
    with open("/proc/cpuinfo") as file:
        model = next((line.split(":")[1].strip() for line in file if line.startswith("model name")), model)
    return f"{model}; {os.cpu_count()} cores"


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def cell(value):
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def read_rows(path):
    """A dict of numbers and words for each row."""
    with open(path, newline="") as file:
        return [{name: number(text) for name, text in row.items()} for row in csv.DictReader(file)]


def write_rows(path, rows):
    """Each with the machine that it was measured on, unless it says so itself."""
    stamped = [{"machine": machine(), **row} for row in rows]
    names = [*dict.fromkeys(name for row in stamped for name in row if name != "machine"), "machine"]
    aside = path.with_suffix(".part")
    with open(aside, "w", newline="") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows([{name: cell(value) for name, value in row.items()} for row in stamped])
    aside.replace(path)


class Table:
    """Rows by the points they were measured at. Cells are compared as they stand in the file, so that a point is found
    again."""

    def __init__(self, path, keys):
        self.path, self.keys = path, keys
        self.rows = read_rows(path) if path.exists() else []

    def has(self, point):
        wanted = {key: number(cell(point[key])) for key in self.keys}
        return any(all(row[key] == wanted[key] for key in self.keys) for row in self.rows)

    def add(self, rows):
        self.rows += [{name: number(cell(value)) for name, value in {**row, "machine": machine()}.items()}
                      for row in rows]
        write_rows(self.path, self.rows)
