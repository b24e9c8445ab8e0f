"""Runs a case in a temporary folder and compares the run with the case's expected.yaml. Started by scripts/check-case.

expected.yaml holds `checks`, a list of
    {quantity: strain.max, at_most: 0.01}                          a path in summary.json
    {quantity: depth, at: 0.3, value: 0.441, tolerance: 5 %}       a column of steps.csv at a time in s (between two
                                                                   steps: linear); its unit is left out: depth_m
    {quantity: pin0_z, between: [0.5, 2], value: -0.066, tolerance: 5 %}   the mean of a column over a time
each with one or more of at_most, at_least, equals, and value with a tolerance (absolute, or in %); and `options`:
    set: {time.end: 0.5}     keys of the case that are replaced, e.g. to shorten it
    ranks: [1, 2]            the numbers of ranks to run at (default: 1)
    timeout: 60              s for a run (default: 120)
Whatever the case, the files of the run are checked too: datasets, strain, list of frames.
"""
import argparse
import csv
import json
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import h5py
import numpy as np
import yaml

ROOT = Path(__file__).resolve().parent.parent
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
MESH = ["rest_positions", "faces", "face_offsets", "constraints/edges", "constraints/rest_lengths"]
FRAME = ["positions", "velocities", "strain", "tension"]


class Row(NamedTuple):
    """A line of the verdict."""
    quantity: str
    expected: str
    measured: str
    passed: bool


class Run:
    """The output folder of a run that has ended."""

    def __init__(self, folder):
        self.folder = folder
        self.summary = json.loads((folder / "summary.json").read_text())
        with open(folder / "steps.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.steps = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]} if rows else {}
        self.frames = sorted((folder / "frames").glob("frame_*.h5"))

    def quantity(self, name, time, between=None):
        if time is None and between is None:
            value = self.summary
            for key in name.split("."):
                value = value[key]
            return value
        columns = [c for c in self.steps if c == name or re.fullmatch(re.escape(name) + "_[A-Za-z]+", c)]
        if len(columns) != 1:
            raise KeyError(f"steps.csv has no column {name}; it has {', '.join(self.steps)}")
        times = self.steps["time_s"]
        if between is not None:
            inside = (times > between[0]) & (times <= between[1])
            if not inside.any():
                raise KeyError(f"the run has no step between {between[0]} and {between[1]} s")
            return float(np.average(self.steps[columns[0]][inside], weights=self.steps["dt_s"][inside]))
        if not times[0] <= time <= times[-1] + 1e-9:
            raise KeyError(f"the run has no step at {time} s")
        return float(np.interp(time, times, self.steps[columns[0]]))


def allowance(tolerance, value):
    text = str(tolerance).strip()
    return float(text[:-1]) / 100 * abs(value) if text.endswith("%") else float(text)


def judge(check, measured):
    """What was expected in words, and whether it holds. Numbers may be text: YAML 1.1 reads 1e-06 so."""
    words, passed = [], True
    if "value" in check:
        value = float(check["value"])
        words.append(f"{value:g} +- {check['tolerance']}")
        passed &= abs(measured - value) <= allowance(check["tolerance"], value)
    if "at_most" in check:
        words.append(f"<= {check['at_most']}")
        passed &= measured <= float(check["at_most"])
    if "at_least" in check:
        words.append(f">= {check['at_least']}")
        passed &= measured >= float(check["at_least"])
    if "equals" in check:
        words.append(str(check["equals"]))
        passed &= measured == check["equals"]
    if not words:
        raise KeyError("give at_most, at_least, equals, or value and tolerance")
    return ", ".join(words), bool(passed)


def checked(run, check):
    name, time = check["quantity"], check.get("at")
    label = name if time is None else f"{name} at {time} s"
    try:
        measured = run.quantity(name, None if time is None else float(time), check.get("between"))
        expected, passed = judge(check, measured)
    except (KeyError, TypeError) as error:
        return Row(label, "", f"cannot be told: {error}", False)
    return Row(label, expected, f"{measured:.6g}" if isinstance(measured, float) else str(measured), passed)


def contract(run):
    """The rows about the files of a run."""
    with h5py.File(run.folder / "mesh.h5") as mesh:
        missing = [f"mesh.h5/{name}" for name in MESH if name not in mesh]
        edges, rest = mesh["constraints/edges"][:], mesh["constraints/rest_lengths"][:]
        points, corners, offsets = (mesh[name][:] for name in MESH[:3])
    sizes = {"positions": points.shape, "velocities": points.shape, "strain": rest.shape, "tension": rest.shape}
    times = []
    for path in run.frames:
        with h5py.File(path) as frame:
            missing += [f"{path.name}/{n}" for n in FRAME if n not in frame or frame[n].shape != sizes[n]]
            missing += [f"{path.name}: {n} not finite" for n in FRAME if n in frame and not np.isfinite(frame[n]).all()]
            times.append(float(frame.attrs["time"]))
    yield Row("datasets", "all there, finite", ", ".join(missing) or f"{len(run.frames)} frames", not missing)
    yield Row("frames", f"{run.summary['frames']}, times rising", f"{len(run.frames)} up to {times[-1]:g} s",
              len(run.frames) == run.summary["frames"] and bool(np.all(np.diff(times) > 0)) and
              abs(times[-1] - run.summary["end_time"]) < 1e-9)
    sound = offsets[0] == 0 and offsets[-1] == len(corners) and set(np.diff(offsets)) <= {2, 3, 4}
    yield Row("cells", "name vertices", f"{len(offsets) - 1} cells",
              bool(sound and corners.min() >= 0 and corners.max() < len(points) and edges.max() < len(points)))
    lengths = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    error = float(np.abs(lengths / rest - 1).max())
    yield Row("rest lengths", "<= 1e-12 off", f"{error:.2g}", error <= 1e-12)
    yield from strain_rows(run, edges, rest)
    listed = xdmf_frames(run.folder / "frames.xdmf")
    expected = [(f"frames/{p.name}", t) for p, t in zip(run.frames, times)]
    yield Row("frames.xdmf", "lists each frame", f"{len(listed)} frames",
              [f for f, _ in listed] == [f for f, _ in expected] and
              bool(np.allclose([t for _, t in listed], times, rtol=0, atol=1e-12)))


def strain_rows(run, edges, rest):
    """The strain of the last frame, from its positions alone."""
    with h5py.File(run.frames[-1]) as frame:
        x, told = frame["positions"][:], frame["strain"][:]
        cells = max(np.abs(frame[f"cells/strain_{direction}"][:]).max() for direction in ("warp", "weft"))
    strain = np.linalg.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1) / rest - 1
    error, largest = float(np.abs(strain - told).max()), float(np.abs(strain).max())
    yield Row("/strain", "<= 1e-12 off", f"{error:.2g}", error <= 1e-12)
    limit = run.summary["strain"]["limit"]
    if limit is None:  # the method keeps none
        return
    if run.summary["strain"]["of"] == "vertices":  # edges and single triangles may strain more
        limit, largest = run.summary["strain"]["faces_max"], float(cells)
    yield Row("strain recomputed", f"<= {limit:g}", f"{largest:.6g}", largest <= limit * (1 + 1e-9))  # it was measured before it was stored


def xdmf_frames(path):
    """[(file of the positions, time)] of each frame that ParaView is told of."""
    frames = []
    for grid in ElementTree.parse(path).getroot().iter("Grid"):
        time, item = grid.find("Time"), grid.find("Geometry/DataItem")
        if time is not None and item is not None:
            frames.append((item.text.strip().split(":")[0], float(time.get("Value"))))
    return frames


def jittered_start(folder, seed, shape):
    """Writes the start of a run as OBJ files, every vertex moved at random by about a ten thousandth of an edge."""
    with h5py.File(folder / "mesh.h5") as mesh, h5py.File(folder / "frames/frame_000000.h5") as frame:
        size = 1e-4 * mesh["constraints/rest_lengths"][:].mean()
        positions = frame["positions"][:]
    positions += size * np.random.default_rng(seed).standard_normal(positions.shape)
    case = yaml.safe_load((folder / "case.yaml").read_text())
    sizes = [cloth["vertices"] for cloth in json.loads((folder / "summary.json").read_text())["cloths"]]
    keys = [f"cloths.{k}" for k in range(len(sizes))] if "cloths" in case else ["cloth"]
    starts = {}
    for k, (key, rows) in enumerate(zip(keys, np.split(positions, np.cumsum(sizes)[:-1]))):
        scale = float((case["cloths"][k] if "cloths" in case else case["cloth"]).get("scale", 1))
        file = shape.with_stem(f"{shape.stem}_{k}")
        file.write_text("".join(f"v {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in rows / scale))
        starts[f"{key}.start"] = {"shape": str(file)}
    return starts


def run_case(case, folder, options, arguments, ranks):
    """The rows of one run."""
    command = [*shlex.split(arguments.launch), "-n", str(ranks), str(Path(arguments.program).resolve()), "run", str(case),
               "--out", str(folder)]
    for key, value in options.get("set", {}).items():
        command += ["--set", f"{key}={json.dumps(value)}"]
    print(" ".join(shlex.quote(word) for word in command), flush=True)
    limit = float(options.get("timeout", 120))
    process = subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)
    try:
        stderr = process.communicate(timeout=limit)[1]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGTERM)  # mpirun ends its ranks, which still write
        process.communicate()
        return [Row("end of the run", f"within {limit:g} s", "none", False)]
    rows = [Row("exit code", "0", str(process.returncode), process.returncode == 0)]
    if process.returncode != 0:
        print(stderr, file=sys.stderr)
    if not (folder / "summary.json").is_file():
        return rows
    run = Run(folder)
    return [*rows, *contract(run), *(checked(run, check) for check in options["checks"])]


def show(rows):
    table = [("quantity", "expected", "measured", ""), *((r.quantity, r.expected, r.measured, "ok" if r.passed else "WRONG")
                                                         for r in rows)]
    widths = [max(len(line[k]) for line in table) for k in range(4)]
    for line in table:
        print("  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def find_case(text):
    for case in (Path(text), Path(text) / "case.yaml", ROOT / "cases" / text / "case.yaml"):
        if case.is_file():
            return case
    sys.exit(f"check-case: {text}: no case file, no folder with a case.yaml, and no name under cases/")


def main():
    parser = argparse.ArgumentParser(prog="scripts/check-case",
                                     description="Runs cases and compares each run with the expected.yaml of its case.")
    parser.add_argument("case", nargs="+", help="a name under cases/, a folder with a case.yaml, or a case file")
    parser.add_argument("--ranks", type=int, help="default: those of expected.yaml")
    parser.add_argument("--program", default=ROOT / "build/taut", help="default: %(default)s")
    parser.add_argument("--launch", default="mpirun --oversubscribe --bind-to none",
                        help="what starts MPI programs, before -n RANKS (default: %(default)s)")
    parser.add_argument("--jitter", type=int, default=0, metavar="N",
                        help="then N runs more, every vertex of the start moved at random by a ten thousandth of an edge")
    arguments = parser.parse_args()
    passed = [passes(find_case(case), arguments) for case in arguments.case]
    sys.exit(0 if all(passed) else 1)


def passes(case, arguments):
    expected = yaml.safe_load((case.parent / "expected.yaml").read_text())
    options = {**expected.get("options", {}), "checks": expected["checks"]}
    passed = [run_and_show(case, options, arguments, ranks)
              for ranks in ([arguments.ranks] if arguments.ranks else options.get("ranks", [1]))]
    return all(passed)


def run_and_show(case, options, arguments, ranks):
    """The case once, then with jittered starts; whether every run is as expected."""
    passed = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "run"
        for seed in range(arguments.jitter + 1):
            here = folder if seed == 0 else Path(temporary) / f"jittered{seed}"
            start = jittered_start(folder, seed, Path(temporary) / f"start{seed}.obj") if seed > 0 else {}
            rows = run_case(case, here, {**options, "set": {**options.get("set", {}), **start}}, arguments, ranks)
            show(rows)
            passed.append(all(row.passed for row in rows))
            if not passed[0]:
                return False
    if arguments.jitter:
        print(f"{case}, {ranks} ranks: {sum(passed[1:])} of {arguments.jitter} jittered runs are as expected")
    return all(passed)


main()
