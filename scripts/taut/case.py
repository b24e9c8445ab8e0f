"""A case as dicts and lists, from YAML and back.

A number with a unit is text, and so is one such as 1e-5; the program reads both.
"""
import json
from pathlib import Path

import yaml


def read_case(path):
    return yaml.safe_load(Path(path).read_text())


def write_case(path, case):
    """The path, of what may be given to `taut run`."""
    path = Path(path)
    path.write_text(json.dumps(case, indent=1) + "\n")  # JSON is YAML
    return path
