"""Runs of the program for the tests that see it as a user does. COMMAND is what starts it: LAUNCHER... RANKS PROGRAM."""
import csv
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np

COMMAND = []
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_orte_execute_quiet": "1"}
SMALL = """\
name: small
cloth: {grid: {size: [1, 1], vertices: [11, 11]}}
pins: [{vertices: [0]}, {vertices: [10], release: 0.25}]
time: {end: 0.5, frame_rate: 20, max_step: 0.005}
"""


def take_command(words):
    """Programs by their absolute path: tests run in folders of their own."""
    COMMAND[:] = [os.path.abspath(word) if os.path.exists(word) else word for word in words]


def on_ranks(ranks):
    """COMMAND with another number of ranks; on one rank without a launcher."""
    if ranks == 1:
        return COMMAND[-1:]
    return [*COMMAND[:-2], str(ranks), COMMAND[-1]]


class Job:
    """The program at work in `folder`."""

    def __init__(self, folder, arguments, ranks=1):
        self.words = [*on_ranks(ranks), *arguments]
        self.process = subprocess.Popen(self.words, cwd=folder, env=ENVIRONMENT, text=True, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, start_new_session=True)

    def end(self, limit=60):
        """Exit code, stdout, stderr. What takes longer than `limit` s is ended and fails the test."""
        try:
            out, err = self.process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            self.kill_all()
            self.process.communicate()
            raise AssertionError(f"no end after {limit} s: {' '.join(self.words)}") from None
        return self.process.returncode, out, err.strip()

    def ranks(self):
        """Process ids of the program's ranks, those of this job alone."""
        found, parents = [], [self.process.pid]
        if program_of(self.process.pid) == os.path.realpath(COMMAND[-1]):
            return parents
        while parents:
            parents = [child for parent in parents for child in children(parent)]
            found += [pid for pid in parents if program_of(pid) == os.path.realpath(COMMAND[-1])]
        return found

    def kill_all(self):
        for pid in [*self.ranks(), self.process.pid] if self.process.poll() is None else []:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def wait_for(self, ready, limit=30):
        """Until `ready()`; False if the job has ended before."""
        deadline = time.monotonic() + limit
        while not ready():
            if self.process.poll() is not None:
                return False
            if time.monotonic() > deadline:
                self.kill_all()
                raise AssertionError(f"nothing after {limit} s: {' '.join(self.words)}")
            time.sleep(0.002)
        return True


def children(pid):
    try:
        return [int(word) for task in Path(f"/proc/{pid}/task").iterdir()
                for word in (task / "children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []


def program_of(pid):
    try:
        return os.readlink(f"/proc/{pid}/exe")
    except (FileNotFoundError, ProcessLookupError, PermissionError):
        return ""


def rows(run):
    """Complete rows of steps.csv so far."""
    try:
        text = (run / "steps.csv").read_text()
    except FileNotFoundError:
        return 0
    return max(0, text.count("\n") - 1)


def table(run):
    """steps.csv without what the clock says."""
    with open(run / "steps.csv", newline="") as file:
        return [{k: v for k, v in row.items() if k not in ("velocity_s", "projection_s")} for row in csv.DictReader(file)]


def listed_frames(run):
    """[(file, time)] of each frame in frames.xdmf."""
    grids = [g for g in ElementTree.parse(run / "frames.xdmf").getroot().iter("Grid") if g.get("GridType") == "Uniform"]
    return [(g.find("Geometry/DataItem").text.strip().split(":")[0], float(g.find("Time").get("Value"))) for g in grids]


def frame(run, file):
    """All datasets of a frame, or of mesh.h5, and its time."""
    data = {}
    with h5py.File(run / file, "r") as h5:
        h5.visititems(lambda name, item: data.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None)
        data.update({name: np.array(value) for name, value in h5.attrs.items()})
    return data


class Folder(unittest.TestCase):
    """A test in a folder of its own, which holds the small case."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "case.yaml").write_text(SMALL)

    def taut(self, *arguments, ranks=1, limit=60):
        return Job(self.folder, arguments, ranks).end(limit)

    def run_case(self, out, *options, ranks=1):
        """The folder of a run that has come to its end."""
        code, _, err = self.taut("run", "case.yaml", "--out", out, *options, ranks=ranks)
        self.assertEqual((code, err), (0, ""))
        return self.folder / out

    def stop_run(self, out, steps, *options, sent=signal.SIGTERM, ranks=1):
        """The folder of a run that was asked to stop after some steps."""
        job = Job(self.folder, ("run", "case.yaml", "--out", out, *options), ranks)
        run = self.folder / out
        self.assertTrue(job.wait_for(lambda: rows(run) >= steps), "the run was over too early")
        os.kill(job.ranks()[-1], sent)
        code, _, err = job.end()
        self.assertEqual(code, 4, err)
        self.assertIn("taut: stopped by a signal at t = ", err)
        self.assertIn(f"go on with: taut resume {out}", err)
        return run

    def assert_readable(self, run):
        """Every frame that is listed is there, whole and finite."""
        for file, time_of_frame in listed_frames(run):
            data = frame(run, file)
            self.assertEqual(float(data["time"]), time_of_frame)
            self.assertEqual(data["positions"].shape, frame(run, "mesh.h5")["rest_positions"].shape)
            for name, values in data.items():
                self.assertTrue(np.isfinite(values).all(), f"{file}: {name}")

    def assert_same_run(self, run, whole, tolerance=0.0):
        """The same steps, list of frames and fields, the latter up to `tolerance`; 0: to the bit."""
        self.assertEqual(listed_frames(run), listed_frames(whole))
        self.assertEqual([r["step"] for r in table(run)], [r["step"] for r in table(whole)])
        if tolerance == 0.0:
            self.assertEqual(table(run), table(whole))
        for file, _ in listed_frames(whole):
            found, expected = frame(run, file), frame(whole, file)
            self.assertEqual(found.keys(), expected.keys())
            for name in ["positions"] if tolerance else expected:
                error = float(np.abs(found[name] - expected[name]).max())
                self.assertLessEqual(error, tolerance, f"{file}: {name}")


def main(description):
    if len(sys.argv) < 2:
        sys.exit(description)
    take_command(sys.argv[1:])
    unittest.main(argv=sys.argv[:1])
