"""Imported first by every script: goes on in Debian's Python, whose packages it installs, where this one lacks them."""
import importlib
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

PACKAGES = {"h5py": "python3-h5py", "matplotlib": "python3-matplotlib", "numpy": "python3-numpy",
            "yaml": "python3-yaml"}
DEBIAN = "/usr/bin/python3"


def missing():
    return [package for module, package in PACKAGES.items() if importlib.util.find_spec(module) is None]


def install():
    script = Path(__file__).resolve().parent / "packages.sh"
    subprocess.run(["bash", "-c", 'source "$0"; install_missing "$@" >&2', script, *missing()], check=False)
    importlib.invalidate_caches()


if missing():
    # another Python, or a virtual environment, is first in the PATH
    if sys.prefix != "/usr" and os.path.exists(DEBIAN):
        os.execv(DEBIAN, [DEBIAN, *sys.argv])
    install()
    if missing():
        sys.exit(f"{Path(sys.argv[0]).name} needs the Debian packages {' '.join(missing())}")
