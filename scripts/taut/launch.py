"""How the program is started: on one rank as it is, on more by mpirun.

The program is build/taut of the sources, or that of the installation which this is part of, or the taut of the PATH.
The variable TAUT names another, TAUT_LAUNCH what stands before -n RANKS.
"""
import argparse
import json
import os
import shlex
import shutil
import signal
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def find_program():
    if "TAUT" in os.environ:
        return Path(os.environ["TAUT"]).resolve()
    built, installed = ROOT / "build/taut", ROOT.parents[1] / "bin/taut"
    for path in (built, installed, shutil.which("taut")):
        if path and os.access(path, os.X_OK):
            return Path(path).resolve()
    return built


PROGRAM = find_program()
LAUNCHER = shlex.split(os.environ.get("TAUT_LAUNCH",
                                      "mpirun --oversubscribe --bind-to none --mca mpi_yield_when_idle 1"))


def variables():
    """Those of mpi.env."""
    lines = (Path(__file__).parent / "mpi.env").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if line and not line.startswith("#"))


# The program itself says what is wrong; mpirun would repeat it.
ENVIRONMENT = {**variables(), "OMPI_MCA_orte_execute_quiet": "1", **os.environ}


def command(program, *words, ranks=1):
    """The words that start `program`, with `words`, on so many ranks; one needs no launcher."""
    return [*((*LAUNCHER, "-n", str(ranks)) if ranks > 1 else ()), *map(str, (program, *words))]


def run(words, limit=None, **options):
    """The completed process, with what it said on stderr. What takes longer than `limit` s is ended: TimeoutExpired."""
    process = subprocess.Popen(words, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               start_new_session=True, **options)
    try:
        stderr = process.communicate(timeout=limit)[1]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGTERM)  # mpirun ends its ranks, which still write
        process.communicate()
        raise
    return subprocess.CompletedProcess(words, process.returncode, None, stderr)


def settings(changes):
    """The options that replace keys of a case, from {key: value}."""
    return [word for key, value in changes.items() for word in ("--set", f"{key}={json.dumps(value)}")]


def program(text):
    """The absolute path of a program; a type of argparse."""
    path = Path(text).resolve()
    if not os.access(path, os.X_OK) or path.is_dir():
        raise argparse.ArgumentTypeError(f"{text}: no such program; build it with scripts/build, or name another")
    return path


def add_program(parser):
    parser.add_argument("--program", type=program, default=str(PROGRAM), help="default: %(default)s")


def find_case(text):
    """A name under cases/, a folder with a case.yaml, or a case file; a type of argparse."""
    for case in (Path(text), Path(text) / "case.yaml", ROOT / "cases" / text / "case.yaml"):
        if case.is_file():
            return case
    raise argparse.ArgumentTypeError(f"{text}: no case file, no folder with a case.yaml, and no name under cases/")


def all_cases(large=False):
    """Those under cases/, by name; without the large ones unless asked for."""
    found = sorted((ROOT / "cases").glob("*/case.yaml"))
    return [case for case in found if large or not case.parent.name.endswith("-large")]
