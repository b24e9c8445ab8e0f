"""Runs of Taut, and what they are measured by."""
import csv
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NAME = Path(sys.argv[0]).stem
GRACE = 30  # s for a run that was told to stop
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


class Run:
    """What a run left. Without a summary it was killed within a step, and measured nothing."""

    def __init__(self, folder):
        self.folder = folder
        path = folder / "summary.json"
        self.summary = json.loads(path.read_text()) if path.exists() else None

    @property
    def status(self):
        return self.summary["status"] if self.summary else "killed"

    @property
    def completed(self):
        return self.status == "completed"

    @property
    def stopped(self):
        """Whether it took longer than it was given."""
        return self.status in ("interrupted", "killed")

    @property
    def strain(self):
        return self.summary["strain"]["max"] if self.summary else float("inf")

    def measures(self):
        """The columns that all studies of cost share. Work of the linear solver of velocities, and of that of the
        projection (of sweeps or substeps, where there is none), per simulated second."""
        if not self.summary or not self.summary["steps"]:
            return {"status": self.status}
        s = self.summary
        steps, time, projection = s["steps"], s["end_time"], s["projection"]
        iterations = projection["iterations_mean"] * steps
        inner = projection["ksp_iterations_mean"]
        depth = self.steps()[-1]["depth_m"]
        return {"status": s["status"], "simulated_s": time, "steps": steps, "rejected": s["rejected_steps"],
                "cpu_s_per_s": s["seconds"]["cpu"] / time, "iterations_per_step": iterations / steps,
                "solver_work_per_s": iterations * (inner or 1.0) / time,
                "velocity_work_per_s": s["velocity"]["ksp_iterations_mean"] * steps / time,
                "strain_had": self.strain, "depth_m": depth}

    def frames(self, field="positions"):
        """[(time, field)] of the frames."""
        result = []
        for path in sorted((self.folder / "frames").glob("frame_*.h5")):
            with h5py.File(path) as frame:
                result.append((float(frame.attrs["time"]), frame[field][:]))
        return result

    def last(self, field="positions"):
        """A field of the last frame."""
        with h5py.File(max((self.folder / "frames").glob("frame_*.h5"))) as frame:
            return frame[field][:]

    def steps(self):
        """The rows of steps.csv, as numbers."""
        with open(self.folder / "steps.csv", newline="") as file:
            return [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]


class Laboratory:
    """Where cases are run, in a temporary folder. A run is given `limit` s; `launcher` is what starts it on its ranks."""

    def __init__(self, program, stem, limit, launcher=()):
        self.program, self.stem, self.limit, self.launcher, self.runs = Path(program).resolve(), stem, limit, launcher, {}
        if not self.program.is_file():
            sys.exit(f"{NAME}: {program}: no such program; build it, or name it with --program")

    def __enter__(self):
        self.temporary = tempfile.TemporaryDirectory()
        return self

    def __exit__(self, *_):
        self.temporary.cleanup()

    def path(self, name):
        return Path(self.temporary.name) / name

    def beside(self, name):
        """Another program of the build."""
        program = self.program.parent / name
        if not program.is_file():
            sys.exit(f"{NAME}: {program}: no such program; build all of Taut")
        return program

    def write(self, case):
        path = self.path(f"case{len(self.runs)}.yaml")
        path.write_text(json.dumps(case))  # JSON is YAML
        return path

    def run(self, case, petsc=()):
        """The run of a case; the same case is run only once."""
        known = json.dumps([case, petsc])
        if known not in self.runs:
            folder = self.path(f"run{len(self.runs)}")
            command = [*self.launcher, self.program, "run", self.write(case), "--out", folder, "--progress", "lines"]
            self.finish(subprocess.Popen([*map(str, command), *(["--", *petsc] if petsc else [])], env=ENVIRONMENT,
                                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True))
            self.runs[known] = Run(folder)
        return self.runs[known]

    def whole_run(self, case):
        """The run of a case that makes no sense unless it comes to its end."""
        run = self.run(case)
        if not run.completed:
            reason = run.summary["reason"] if run.summary else "it was killed"
            sys.exit(f"{NAME}: a run did not come to its end ({reason}); give it more time with --limit")
        return run

    def finish(self, process):
        """Waits; a run that takes too long is told to stop after the step it is in, then killed."""
        for seconds, end in ((self.limit, signal.SIGUSR1), (GRACE, signal.SIGKILL), (None, None)):
            try:
                stderr = process.communicate(timeout=seconds)[1]
                break
            except subprocess.TimeoutExpired:
                process.send_signal(end)
        if process.returncode in (1, 2):  # neither a result nor the end of the steps
            sys.exit(f"{NAME}: {' '.join(process.args)}\n{stderr}")


def smallest(values, good):
    """The first of the rising values for which `good(value)` gives a run, with that run; (None, None) if none does."""
    for value in values:
        run = good(value)
        if run:
            return value, run
    return None, None


def rms(a, b):
    return float(np.sqrt(np.mean(np.sum((a - b) ** 2, axis=1))))
