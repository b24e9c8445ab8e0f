"""Runs of the program for the tests that see it as a user does. taut.launch says which program, and what starts it.

Python finds this and the package taut by PYTHONPATH=scripts:tests, which ctest sets.
"""
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

from taut import Datasets, Run, launch

SMALL = """\
name: small
cloth: {grid: {size: [1, 1], vertices: [11, 11]}}
pins: [{vertices: [0]}, {vertices: [10], release: 0.25}]
time: {end: 0.5, frame_rate: 20, max_step: 0.005}
"""
PNG = b"\x89PNG\r\n\x1a\n"  # how such a file begins


def script(name, *arguments, **options):
    """What a script said, once it has come to its end."""
    return subprocess.run([launch.ROOT / "scripts" / name, *map(str, arguments)], capture_output=True, text=True,
                          **options)


class Job:
    """The program at work in `folder`."""

    def __init__(self, folder, arguments, ranks=1):
        self.words = launch.command(launch.PROGRAM, *arguments, ranks=ranks)
        self.process = subprocess.Popen(self.words, cwd=folder, env=launch.ENVIRONMENT, text=True,
                                        stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, start_new_session=True)

    def end(self, limit=60):
        """Exit code, stdout, stderr. What takes longer than `limit` s is ended and fails the test."""
        try:
            out, err = self.process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            self.kill_all()
            self.process.communicate()
            raise AssertionError(f"no end after {limit} s: {' '.join(self.words)}") from None
        return self.process.returncode, out, without_epoll(err).strip()

    def ranks(self):
        """Process ids of the program's ranks, those of this job alone."""
        found, parents = [], [self.process.pid]
        if program_of(self.process.pid) == str(launch.PROGRAM):
            return parents
        while parents:
            parents = [child for parent in parents for child in children(parent)]
            found += [pid for pid in parents if program_of(pid) == str(launch.PROGRAM)]
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


def without_epoll(text):
    """Without what mpirun's event loop sometimes says of a pipe that a rank has just closed."""
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith("[warn] Epoll"))


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
    return [{k: v for k, v in row.items() if k not in ("velocity_s", "projection_s", "contact_s")}
            for row in Run(run).read_steps()[1]]


def listed_frames(run):
    """[(file, time)] of each frame in frames.xdmf."""
    return Run(run).listed_frames()


def frame(run, file):
    """All datasets of a frame, or of mesh.h5, and its time."""
    data = Datasets(run / file)
    return {**data.read_all(), **{name: np.array(value) for name, value in data.attributes.items()}}


class Temporary(unittest.TestCase):
    """A test in a folder of its own."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)


class Folder(Temporary):
    """A test in a folder of its own, which holds the small case."""

    def setUp(self):
        super().setUp()
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
