"""Taut from Python: what starts it, and what its runs leave.

    from taut import Run
    run = Run("out/drape")
    run.summary["strain"]["max"], run.steps["depth_m"][-1], run.frames[-1].positions
"""
from taut.run import Datasets, Frame, Run, RunError

__all__ = ["Datasets", "Frame", "Run", "RunError"]
