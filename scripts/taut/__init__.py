"""Taut from Python: what starts it, and what its runs leave.

    from taut import Run
    run = Run("out/drape")
    run.summary["strain"]["max"], run.steps["depth_m"][-1], run.frames[-1].positions
    write_case("windy.yaml", {**run.case, "air": {"wind": [0, 3, 0]}})
"""
from taut.case import read_case, write_case
from taut.run import Datasets, Field, Frame, Run, RunError

__all__ = ["Datasets", "Field", "Frame", "Run", "RunError", "read_case", "write_case"]
