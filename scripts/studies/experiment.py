"""What is measured at the points of a plan, drawn and judged; and where its runs are made."""
import json
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Callable, NamedTuple

import matplotlib
import numpy as np

from studies.table import Table
from taut import Run, launch, write_case

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

NAME = Path(sys.argv[0]).stem
GRACE = 30  # s for a run that was told to stop


class Experiment(NamedTuple):
    name: str
    about: str  # what is claimed, or compared with what
    keys: list  # the columns that tell the points of the plan apart
    plan: Callable  # (quick) -> points: dicts with the keys
    measure: Callable  # (laboratory, point) -> a row, or a list of rows: what was measured there
    draw: Callable  # (axes, rows)
    judge: Callable  # (rows) -> a study: (whether the claim holds, the findings in words); a validation: checks

    @classmethod
    def of(cls, module):
        """That of a module, which has the name of the experiment and defines the rest."""
        name = module.__name__.rsplit(".", 1)[-1].replace("_", "-")
        return cls(name, module.ABOUT, module.KEYS, module.plan, module.measure, module.draw, module.judge)

    def fill(self, path, laboratory, quick):
        """The table in `path`, after what is missing of the plan has been measured."""
        table = Table(path, self.keys)
        for point in self.plan(quick):
            if table.has(point):
                continue
            print(f"{self.name}:", "  ".join(f"{key} {value}" for key, value in point.items()), flush=True)
            found = self.measure(laboratory, point)
            table.add([{**point, **row} for row in (found if isinstance(found, list) else [found])])
        return table

    def plot(self, rows, path):
        figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
        self.draw(axes, rows)
        figure.savefig(path, dpi=120)
        plt.close(figure)


class Trial(Run):
    """A run, and what it is measured by."""

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
        return {"status": s["status"], "simulated_s": time, "steps": steps, "rejected": s["rejected_steps"],
                "cpu_s_per_s": s["seconds"]["cpu"] / time, "iterations_per_step": iterations / steps,
                "solver_work_per_s": iterations * (inner or 1.0) / time,
                "velocity_work_per_s": s["velocity"]["ksp_iterations_mean"] * steps / time,
                "strain_had": self.strain, "depth_m": self.steps["depth_m"][-1]}


class Laboratory:
    """Where cases are run, in a temporary folder. A run is given `limit` s."""

    def __init__(self, program, stem, limit, ranks=1):
        self.program, self.stem, self.limit, self.ranks = program, stem, limit, ranks
        self.runs = {}

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
        return write_case(self.path(f"case{len(self.runs)}.yaml"), case)

    def run(self, case, petsc=()):
        """The run of a case; the same case is run only once."""
        known = json.dumps([case, petsc])
        if known not in self.runs:
            folder = self.path(f"run{len(self.runs)}")
            words = ["run", self.write(case), "--out", folder, "--progress", "lines",
                     *(["--", *petsc] if petsc else [])]
            self.finish(subprocess.Popen(launch.command(self.program, *words, ranks=self.ranks), env=launch.ENVIRONMENT,
                                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True))
            self.runs[known] = Trial(folder)
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
