"""The output folder of a run: its summary, its steps, its frames."""
import csv
import json
import math
import sys
import zlib
from functools import cached_property
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

try:
    import h5py
    import numpy as np
except ModuleNotFoundError as error:
    raise ImportError(f"taut reads its files with h5py and numpy, and {sys.executable} has no {error.name}: pip "
                      "install h5py numpy pyyaml, or use Debian's /usr/bin/python3 with python3-h5py and "
                      "python3-yaml") from None

from taut.case import read_case


class RunError(Exception):
    """A folder does not hold what a run leaves."""


def find_damage(path):
    """What is wrong with a file by the checksum behind its bytes, in words; None if it is sound, or has none."""
    data = Path(path).read_bytes()
    body, mark, line = data.rpartition(b"\ntaut crc32 ")
    if not mark or len(line) != 9 or line == f"{zlib.crc32(body):08x}\n".encode():
        return None
    return f"{path}: damaged: its bytes have the checksum {zlib.crc32(body):08x}, not {line.decode().strip()}"


class Datasets:
    """An HDF5 file, whose datasets are read by name: `mesh["constraints/edges"]`. RunError if it is damaged."""

    def __init__(self, path):
        self.path = Path(path)
        self.verified = False

    def open(self):
        if not self.verified and (damage := find_damage(self.path)):
            raise RunError(damage)
        self.verified = True
        return h5py.File(self.path, "r")

    def __getitem__(self, name):
        with self.open() as file:
            if name not in file:
                raise KeyError(f"{self.path} has no {name}; there are {', '.join(self.fields)}")
            return file[name][()]

    def __contains__(self, name):
        with self.open() as file:
            return name in file

    @property
    def attributes(self):
        with self.open() as file:
            return dict(file.attrs)

    @property
    def fields(self):
        """{name: Field} of all datasets; nothing is read."""
        found = {}
        with self.open() as file:
            file.visititems(lambda name, item: found.update({name: Field(item.shape, UNITS.get(name, ""))})
                            if isinstance(item, h5py.Dataset) else None)
        return found

    def read_all(self):
        """{name: values}"""
        found = {}
        with self.open() as file:
            file.visititems(lambda name, item: found.update({name: item[()]}) if isinstance(item, h5py.Dataset)
                            else None)
        return found


# Of the datasets of frames and of mesh.h5; others are plain numbers.
UNITS = {"positions": "m", "velocities": "m/s", "reactions": "N", "contact_forces": "N", "gaps": "m", "clearance": "m",
         "tension": "N", "cells/tension_warp": "N", "cells/tension_weft": "N", "stress_warp": "N/m",
         "stress_weft": "N/m", "rest_positions": "m", "constraints/rest_lengths": "m", "obstacles/positions": "m",
         "texture": "m", "rest_shape": "m", "texture_of_vertices": "m"}


class Field(NamedTuple):
    """What a dataset holds: how many rows and columns, and in which unit; an empty one is a plain number."""
    shape: tuple
    unit: str


class Frame(Datasets):
    """The cloth at one time. Fields besides those with a name of their own: `frame["strain"]`, of each constraint."""

    @property
    def time(self):
        """s"""
        return float(self.attributes["time"])

    @property
    def positions(self):
        """m, a row a vertex"""
        return self["positions"]

    @property
    def velocities(self):
        """m/s, a row a vertex"""
        return self["velocities"]


class Columns(dict):
    """{name: values}; one that is not there is told with those that are."""

    def __missing__(self, name):
        raise KeyError(f"there is no column {name}; there are {', '.join(self)}")


class Run:
    """What a run left in its folder; one that was killed has no summary, or that of an earlier part of it."""

    def __init__(self, folder):
        self.folder = Path(folder)

    @cached_property
    def summary(self):
        """summary.json, or None."""
        try:
            return json.loads((self.folder / "summary.json").read_text())
        except FileNotFoundError:
            return None

    @property
    def status(self):
        return self.summary["status"] if self.summary else "killed"

    @property
    def completed(self):
        return self.status == "completed"

    @cached_property
    def frames(self):
        """In the order of time."""
        if not self.folder.is_dir():
            raise RunError(f"{self.folder}: no such folder; give the output folder of a run")
        return [Frame(path) for path in sorted((self.folder / "frames").glob("frame_*.h5"))]

    @cached_property
    def case(self):
        """As it was run, all defaults filled in."""
        return read_case(self.folder / "case.yaml")

    @property
    def mesh(self):
        return Datasets(self.folder / "mesh.h5")

    @cached_property
    def steps(self):
        """steps.csv as {column: values}, in SI units, which the names end in. An empty cell is no number."""
        path = self.folder / "steps.csv"
        names, rows = self.read_steps()
        try:
            return Columns({name: np.array([float(row[name] or math.nan) for row in rows]) for name in names})
        except ValueError as error:
            raise RunError(f"{path}: {error}") from None

    def read_steps(self):
        """The columns of steps.csv, and its rows as they stand there; a last one that is being written is left out."""
        path = self.folder / "steps.csv"
        try:
            with open(path, newline="", encoding="utf-8") as file:
                reader = csv.DictReader(file)
                rows = [row for row in reader if None not in row and None not in row.values()]
                return list(reader.fieldnames or []), rows
        except FileNotFoundError:
            raise RunError(f"{path}: no such file; give the output folder of a run") from None
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise RunError(f"{path}: cannot be read: {error}") from None

    def listed_frames(self, name="frames.xdmf"):
        """[(file of the positions, time)] of each frame that ParaView is told of."""
        return [(grid.find("Geometry/DataItem").text.strip().split(":")[0], float(grid.find("Time").get("Value")))
                for grid in uniform_grids(self.folder / name)]


def uniform_grids(xdmf):
    """The element of each frame in an XDMF file."""
    return [grid for grid in ElementTree.parse(xdmf).getroot().iter("Grid") if grid.get("GridType") == "Uniform"]
