"""A case as dicts and lists, from YAML and back.

A number with a unit is text, and so is one such as 1e-5; the program reads both.
"""
import json
from pathlib import Path

import yaml


def read_case(path):
    return yaml.safe_load(Path(path).read_text())


def plain(value):
    """Numbers and arrays of numpy as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"a case holds no {type(value).__name__}")


def write_case(path, case):
    """The path, of what may be given to `taut run`."""
    if not isinstance(case, dict):
        raise TypeError("a case is a dict of its keys, e.g. {**run.case, \"gravity\": [0, 0, -1.6]}")
    path = Path(path)
    path.write_text(json.dumps(case, indent=1, default=plain) + "\n")  # JSON is YAML
    return path
